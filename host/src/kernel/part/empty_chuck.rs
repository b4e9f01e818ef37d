//! The lathe of an exercise without a part: its chuck holds nothing, and its slides move in front
//! of the chuck, so that the learner sees them.

use std::sync::Arc;

use gsk_core::machine::LatheConfig;
use gsk_core::units::{Axis, Point};
use gsk_panel::emulator::Emulator;
use gsk_runner::machining::Mounting;
use gsk_runner::machining::guess::empty_chuck_job;
use gsk_workpiece::job::Job;

use super::{PartView, active_tool};

/// Chuck and tools of a lathe without a part.
#[derive(Debug)]
pub(super) struct EmptyChuck {
    job: Arc<Job>,
    mounting: Mounting,
    /// The tip at the positive ends of the slides, part coordinates, mm.
    far_tip: Point,
}

impl EmptyChuck {
    /// The lathe with its chuck where no position of the slides is in it.
    pub(super) fn of_lathe(lathe: &LatheConfig) -> Self {
        let (x, z) = (lathe.x.slide_ends(Axis::X), lathe.z.slide_ends(Axis::Z));
        let job = empty_chuck_job(lathe);
        Self {
            mounting: Mounting::from_job(&job),
            job: Arc::new(job),
            far_tip: Point::new((x.plus - x.minus) / 2.0, z.plus - z.minus),
        }
    }

    /// The lathe with its tool where the slides are.
    pub(super) fn view(&self, emulator: &Emulator) -> PartView {
        let (cnc, tool) = (emulator.cnc(), active_tool(emulator));
        // A machine zero return changes the coordinates of the control, and not the slides.
        let slide = match cnc.has_board() {
            true => cnc.position_machine(),
            false => emulator.lathe().slide_position(),
        };
        let tip = self.mounting.tip_in_part(tool, slide, &cnc.frame());
        PartView {
            empty_chuck: Some(self.far_tip),
            ..PartView::of_lathe(emulator, &self.job, tip)
        }
    }
}

#[cfg(test)]
mod tests {
    use crossbeam::queue::ArrayQueue;
    use gsk_core::setup::Setup;
    use gsk_panel::keys::Key;
    use gsk_workpiece::stock::Stock;

    use super::*;
    use crate::job::SelectedJob;
    use crate::kernel::part::KernelPart;

    #[test]
    fn the_tool_moves_in_front_of_an_empty_chuck_until_there_is_a_part() {
        let mut emulator = Emulator::new(Setup::default());
        let lathe = emulator.lathe().config().clone();
        let views = Arc::new(ArrayQueue::new(1));
        let mut part = KernelPart::new(Arc::clone(&views)).with_empty_chuck(&lathe);
        part.set_visible(true);
        assert!(part.publish(&emulator));
        let before = views.pop().unwrap();
        let far = before.empty_chuck.unwrap();
        assert!(before.tip.x < far.x && before.tip.z < far.z);
        assert!(before.section.bounds().is_none());
        assert!(before.tip.x > 0.0 && before.tip.z > 0.0, "{:?}", before.tip);
        (0..3000).for_each(|_| emulator.tick());
        emulator.press(Key::Jog);
        (0..300).for_each(|_| emulator.tick());
        emulator.press(Key::ZLeft);
        (0..500).for_each(|_| emulator.tick());
        assert!(part.publish(&emulator));
        let after = views.pop().unwrap();
        assert!(
            after.tip.z < before.tip.z && after.tip.z > 0.0,
            "{:?}",
            after.tip
        );
        let job = Job::new(Stock::bar(40.0, 0.0, 60.0));
        part.set_job(Some(SelectedJob { job, file: None }), &lathe);
        assert!(part.publish(&emulator));
        assert_eq!(views.pop().unwrap().empty_chuck, None);
        // A program that cuts nothing has no part either.
        part.set_job(None, &lathe);
        assert!(part.publish(&emulator));
        assert_eq!(views.pop().unwrap().empty_chuck, Some(far));
    }
}
