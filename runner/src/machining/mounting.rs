//! The position of part and tools relative to the slide.

use std::collections::BTreeMap;

use gsk_core::command::Frame;
use gsk_core::units::Point;
use gsk_workpiece::job::{DiameterPoint, Job};

/// Maps slide positions to positions of each tool's tip in the part.
///
/// If the job does not give a tool length or the zero, the value of the control is used: the
/// tool is assumed to be set correctly when it first cuts. After that a changed offset or work
/// zero moves the cut, as on the machine. A zero offset does not move the zero of the part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mounting {
    zero: Option<Point>,
    lengths: BTreeMap<u8, Point>,
    fixed_zeros: BTreeMap<u8, Point>,
}

impl Mounting {
    /// The mounting that a job describes, before a program has cut.
    pub fn from_job(job: &Job) -> Self {
        Self {
            zero: job.zero.map(DiameterPoint::point),
            lengths: job
                .lengths
                .iter()
                .map(|(tool, length)| (*tool, length.point()))
                .collect(),
            fixed_zeros: BTreeMap::new(),
        }
    }

    /// Takes the lengths of another job with the same zero. A tool that it lacks is removed, and
    /// counts as not yet set when it returns.
    pub(super) fn change_tools(&mut self, job: &Job) {
        self.lengths = Self::from_job(job).lengths;
        self.fixed_zeros
            .retain(|tool, _| job.tools.contains_key(tool));
    }

    /// Slide position, machine coordinates, mm, at which the tip of `tool` is at the zero of the
    /// part.
    pub fn slide_at_part_zero(&self, tool: u8, frame: &Frame) -> Point {
        if let Some(zero) = self.fixed_zeros.get(&tool) {
            return *zero;
        }
        let length = self.lengths.get(&tool).copied();
        let zero = frame.zero - frame.zero_offset.to_point();
        self.zero.unwrap_or(zero) + length.unwrap_or(frame.offset)
    }

    /// Whether the position of the part relative to the tool is known: the job gives the zero,
    /// or the tool has cut. Otherwise the work zero of the control is an assumption.
    pub(super) fn is_part_located(&self, tool: u8) -> bool {
        self.zero.is_some() || self.fixed_zeros.contains_key(&tool)
    }

    /// Position of the tip of a tool in part coordinates, mm, with the slide at the machine
    /// position `machine`, mm.
    pub fn tip_in_part(&self, tool: u8, machine: Point, frame: &Frame) -> Point {
        machine - self.slide_at_part_zero(tool, frame)
    }

    /// Stores the position of a tool relative to the part at its first cut; later calls have no
    /// effect. Later changes of offset or work zero then move the cut.
    pub(super) fn fix_tool(&mut self, tool: u8, frame: &Frame) {
        let zero = self.slide_at_part_zero(tool, frame);
        self.fixed_zeros.entry(tool).or_insert(zero);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::command::ZeroOffset;
    use gsk_workpiece::stock::Stock;

    fn frame(offset: f64) -> Frame {
        Frame {
            zero: Point::new(-100.0, -300.0),
            offset: Point::new(offset, 0.0),
            ..Frame::default()
        }
    }

    #[test]
    fn a_zero_offset_leaves_the_part_where_it_is() {
        let mounting = Mounting::from_job(&Job::new(Stock::bar(50.0, 0.0, 60.0)));
        let slide = Point::new(-80.0, -310.0);
        let by = Point::new(1.0, -30.0);
        let moved = Frame {
            zero: frame(0.0).zero + by,
            zero_offset: ZeroOffset::from_point(by),
            ..frame(0.0)
        };
        let tip = mounting.tip_in_part(1, slide, &moved);
        assert_eq!(tip, mounting.tip_in_part(1, slide, &frame(0.0)));
    }

    #[test]
    fn a_tool_stands_where_the_control_has_it_until_it_cuts() {
        let mut mounting = Mounting::from_job(&Job::new(Stock::bar(50.0, 0.0, 60.0)));
        let slide = Point::new(-80.0, -310.0);
        assert_eq!(
            mounting.tip_in_part(1, slide, &frame(0.0)),
            Point::new(20.0, -10.0)
        );
        mounting.fix_tool(1, &frame(0.5));
        // Another offset moves the tip in the control, not that of the tool.
        for offset in [0.5, 0.0, 1.5] {
            let tip = mounting.tip_in_part(1, slide, &frame(offset));
            assert_eq!(tip, Point::new(19.5, -10.0));
        }
    }

    #[test]
    fn a_job_that_knows_better_is_believed() {
        let mut job = Job::new(Stock::bar(50.0, 0.0, 60.0));
        job.zero = Some(DiameterPoint::from(Point::new(-90.0, -290.0)));
        job.lengths
            .insert(2, DiameterPoint::from(Point::new(1.0, -2.0)));
        let mounting = Mounting::from_job(&job);
        let tip = mounting.tip_in_part(2, Point::new(-90.0, -290.0), &frame(7.0));
        assert_eq!(tip, Point::new(-1.0, 2.0));
    }
}
