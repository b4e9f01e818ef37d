//! Stock and tools of a lathe whose program determines no part.

use gsk_core::machine::LatheConfig;
use gsk_core::units::{Axis, Diameter};
use gsk_workpiece::job::{DiameterPoint, Job};
use gsk_workpiece::stock::Stock;
use gsk_workpiece::tool::Tool;

/// Creates a bar and tools for practice without a program. With the slides where a lathe has them
/// at power-on, the tip of the first tool is in front of the bar. No offset is right, so the
/// operator sets the tools by trial cuts.
pub fn practice_job(lathe: &LatheConfig) -> Job {
    let length = |x: f64, z: f64| DiameterPoint { x: Diameter(x), z };
    let tools = [
        (1, Tool::turning(), length(0.0, 0.0)),
        (2, Tool::grooving(3.0), length(6.4, -2.7)),
        (3, Tool::threading(60.0), length(-3.2, 4.1)),
    ];
    let mut job = Job::new(Stock::bar(50.0, 1.0, 81.0));
    job.zero = Some(length(lathe.x.start - 64.0, lathe.z.start - 10.0));
    for (number, tool, length) in tools {
        job.tools.insert(number, tool);
        job.lengths.insert(number, length);
    }
    job
}

/// Creates chuck and tools of a lathe whose chuck holds nothing; the stock of the job is not there.
/// No position of the slides is in the chuck: at their negative ends the tip is on the spindle axis,
/// in front of the jaws.
///
/// ```text
///   chuck ]jaws|
///   -----------+- - - - - - - spindle axis
///              ^ tip at the negative ends of X and Z
/// ```
pub fn empty_chuck_job(lathe: &LatheConfig) -> Job {
    let mut job = practice_job(lathe);
    job.zero = Some(DiameterPoint {
        x: Diameter(lathe.x.slide_ends(Axis::X).minus),
        z: lathe.z.slide_ends(Axis::Z).minus,
    });
    job.lengths.clear();
    job
}
