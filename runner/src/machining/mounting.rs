//! How part and tools stand to the slide.

use std::collections::BTreeMap;

use gsk_core::command::Frame;
use gsk_core::units::Point;
use gsk_workpiece::job::{DiameterPoint, Job};

/// Where each tool's tip meets the zero of the part, as machine coordinates of the slide.
///
/// What the job does not say is taken from the control, once: when a tool first cuts, it
/// is believed to stand where the control has it. From then on the lathe is as it is; an
/// offset or a work zero that is changed later moves the cut, as on the machine. A zero
/// offset is no other zero of the part: it counts from there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mounting {
    zero: Option<Point>,
    lengths: BTreeMap<u8, Point>,
    settled: BTreeMap<u8, Point>,
}

impl Mounting {
    pub(super) fn of(job: &Job) -> Self {
        Self {
            zero: job.zero.map(DiameterPoint::point),
            lengths: job
                .lengths
                .iter()
                .map(|(tool, length)| (*tool, length.point()))
                .collect(),
            settled: BTreeMap::new(),
        }
    }

    /// Slide position at which the tip of a tool stands on the zero of the part.
    pub fn zero_of(&self, tool: u8, frame: &Frame) -> Point {
        if let Some(settled) = self.settled.get(&tool) {
            return *settled;
        }
        let length = self.lengths.get(&tool).copied();
        let zero = frame.zero - frame.zero_offset.point();
        self.zero.unwrap_or(zero) + length.unwrap_or(frame.offset)
    }

    /// A tool's tip in the part, with the slide at a machine position.
    pub fn tip(&self, tool: u8, machine: Point, frame: &Frame) -> Point {
        machine - self.zero_of(tool, frame)
    }

    /// A tool begins to cut: where it stands now it stays.
    pub(super) fn settle(&mut self, tool: u8, frame: &Frame) {
        let zero = self.zero_of(tool, frame);
        self.settled.entry(tool).or_insert(zero);
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
        let mounting = Mounting::of(&Job::new(Stock::bar(50.0, 0.0, 60.0)));
        let slide = Point::new(-80.0, -310.0);
        let by = Point::new(1.0, -30.0);
        let moved = Frame {
            zero: frame(0.0).zero + by,
            zero_offset: ZeroOffset::from_point(by),
            ..frame(0.0)
        };
        let tip = mounting.tip(1, slide, &moved);
        assert_eq!(tip, mounting.tip(1, slide, &frame(0.0)));
    }

    #[test]
    fn a_tool_stands_where_the_control_has_it_until_it_cuts() {
        let mut mounting = Mounting::of(&Job::new(Stock::bar(50.0, 0.0, 60.0)));
        let slide = Point::new(-80.0, -310.0);
        assert_eq!(mounting.tip(1, slide, &frame(0.0)), Point::new(20.0, -10.0));
        mounting.settle(1, &frame(0.5));
        // Another offset moves the tip of the control, not that of the tool.
        for offset in [0.5, 0.0, 1.5] {
            let tip = mounting.tip(1, slide, &frame(offset));
            assert_eq!(tip, Point::new(19.5, -10.0));
        }
    }

    #[test]
    fn a_job_that_knows_better_is_believed() {
        let mut job = Job::new(Stock::bar(50.0, 0.0, 60.0));
        job.zero = Some(DiameterPoint::from(Point::new(-90.0, -290.0)));
        job.lengths
            .insert(2, DiameterPoint::from(Point::new(1.0, -2.0)));
        let mounting = Mounting::of(&job);
        let tip = mounting.tip(2, Point::new(-90.0, -290.0), &frame(7.0));
        assert_eq!(tip, Point::new(-1.0, 2.0));
    }
}
