//! Keeps the flight recorders of the kernel up to date.

use gsk_messages::Message;

use super::{Kernel, Notice};
use crate::flight::{FlightRecorder, join_inputs};

impl Kernel {
    /// Adds a recorder. It follows the learner's own machine, also during a lesson.
    pub fn add_flight_recorder(&mut self, recorder: FlightRecorder) {
        let (own, _) = match &mut self.lesson {
            Some(lesson) => lesson.own_and_part(),
            None => (&mut self.emulator, &mut self.part),
        };
        own.record_inputs();
        self.recorders.push(recorder);
        self.follow_with_recorders();
    }

    /// Passes the inputs since the last call to the recorders. A pulse board interrupts them:
    /// its exchange is not recorded.
    pub(super) fn follow_with_recorders(&mut self) {
        let is_linked = self.drive.is_some();
        let (own, part) = match &mut self.lesson {
            Some(lesson) => lesson.own_and_part(),
            None => (&mut self.emulator, &mut self.part),
        };
        let inputs = join_inputs(own.ticks(), own.take_inputs(), part.take_inputs());
        for recorder in &mut self.recorders {
            if is_linked {
                recorder.interrupt();
            } else {
                recorder.follow(own, part.state(), &inputs);
            }
        }
    }

    /// Hands what was recorded over to the disk. A recorder whose disk has failed ends, with a
    /// notice.
    pub(super) fn flush_recorders(&mut self) {
        self.follow_with_recorders();
        let failures: Vec<Message> = self
            .recorders
            .iter_mut()
            .filter_map(FlightRecorder::flush)
            .collect();
        for failure in failures {
            tracing::error!("{failure}");
            self.notify(Notice::Message(failure));
        }
    }

    /// Ends all recordings.
    pub(super) fn finish_recorders(&mut self) {
        self.follow_with_recorders();
        for recorder in self.recorders.drain(..) {
            recorder.finish();
        }
    }
}
