//! A restart in the middle of a thread: the passes that follow meet the groove of those before.

use gsk_core::cnc::ControlRequest;
use gsk_core::operation::RunState;
use gsk_core::simulation::Simulation;

use super::lathe::referenced_lathe;
use super::machine::StepMachine;
use super::threads::{FIVE_PASSES, GROOVE_TOLERANCE_MM, groove_spread, pass_grooves, program_head};
use crate::bench::keys::{AUTO, CYCLE_START, FEED_HOLD, RESET};
use crate::linked::restart::plan_at;

/// A thread that is interrupted and restarted.
pub struct RestartedThread {
    /// Spindle words.
    pub spindle: &'static str,
    /// The blocks of the thread, from line 5.
    pub text: &'static str,
    /// Line of the restart, and pass of the cycle there.
    pub restart: (u32, Option<u64>),
    /// Passes of the whole run, and of the run from the restart on.
    pub passes: (usize, usize),
    /// Distance of the grooves of all starts, mm, and number of the starts.
    pub pitch: f64,
    pub starts: f64,
}

const fn thread(
    spindle: &'static str,
    text: &'static str,
    restart: (u32, Option<u64>),
    passes: (usize, usize),
    pitch: f64,
    starts: f64,
) -> RestartedThread {
    RestartedThread {
        spindle,
        text,
        restart,
        passes,
        pitch,
        starts,
    }
}

/// The cut after the thread is under G96 and G99.
const G76_AND_G96: &str = "G76 P010060 Q100 R0.1\nG76 X28.6 Z-20 P700 Q300 F1.5\nG96 S60\n\
                           G99 G01 X29 Z4 F0.4\nG97 S600\nG98 G00 X40 Z5\nM30\n";

pub const THREADS: [RestartedThread; 7] = [
    thread("M03 S600", FIVE_PASSES, (7, None), (5, 3), 2.0, 1.0),
    thread("M04 S500", FIVE_PASSES, (9, None), (5, 1), 2.0, 1.0),
    thread(
        "M03 S500",
        "G92 X29 Z-20 F2 L2\nX28.6\nX28.3\nG00 X40 Z5\nM30\n",
        (6, None),
        (6, 4),
        1.0,
        2.0,
    ),
    // From the second start of the first block on.
    thread(
        "M03 S500",
        "G92 X29 Z-20 F2 L2\nX28.6\nX28.3\nG00 X40 Z5\nM30\n",
        (5, Some(2)),
        (6, 5),
        1.0,
        2.0,
    ),
    thread("M03 S600", G76_AND_G96, (6, Some(3)), (5, 3), 1.5, 1.0),
    thread("M03 S600", G76_AND_G96, (6, None), (5, 5), 1.5, 1.0),
    // The second block of a chain begins with the first one.
    thread(
        "M03 S400",
        "G00 X29\nG32 Z-8 F2\nG32 X30 Z-20\nG00 X34\nZ5\nX28.6\nG32 Z-8 F2\n\
         G32 X29.6 Z-20\nG00 X40\nZ5\nM30\n",
        (12, None),
        (2, 1),
        2.0,
        1.0,
    ),
];

impl RestartedThread {
    pub fn program(&self) -> String {
        program_head(self.spindle) + self.text
    }

    /// The direction in which the helix turns, times the number of its starts.
    pub fn direction(&self) -> f64 {
        match self.spindle.starts_with("M04") {
            true => -self.starts,
            false => self.starts,
        }
    }

    /// Requests the restart of a machine that stands still.
    #[track_caller]
    pub fn request(&self, simulation: &mut Simulation) {
        let plan = plan_at(simulation, self.restart, None);
        let plan = plan.unwrap_or_else(|why| panic!("{}: {why}", self.text));
        let request = ControlRequest::Restart(plan.restart);
        simulation.cnc.request(request).unwrap();
    }
}

/// Presses cycle start and waits until nothing runs any more.
fn start(lathe: &mut StepMachine) {
    lathe.press(CYCLE_START);
    lathe.finish(300_000);
    assert_eq!(lathe.alarms(), [""; 0]);
}

#[test]
fn the_passes_after_a_restart_meet_the_groove() {
    for thread in &THREADS {
        let text = thread.text;
        let mut lathe = referenced_lathe(true, &[]);
        lathe.start_program(&thread.program());
        lathe.finish(300_000);
        assert_eq!(lathe.alarms(), [""; 0], "{text}");
        let (end, whole) = (lathe.twin.pulses(), lathe.cuts.len());
        lathe.press(AUTO);
        lathe.press(CYCLE_START);
        let is_in_thread = lathe.run_until(60_000, |lathe| {
            lathe.simulation.cnc.position_absolute().z < -10.0
        });
        assert!(is_in_thread, "{text}");
        // The thread is cut to its end first.
        lathe.press(FEED_HOLD);
        lathe.finish(60_000);
        lathe.press(RESET);
        lathe.run_ms(500);
        assert_eq!(lathe.alarms(), [""; 0], "{text}");
        lathe.cuts.truncate(whole);
        let stood = lathe.twin.pulses();
        thread.request(&mut lathe.simulation);
        lathe.run_ms(500);
        assert_eq!(lathe.twin.pulses(), stood, "the request moves nothing");
        start(&mut lathe);
        assert!(!lathe.simulation.cnc.has_restart(), "{text}");
        assert_eq!(lathe.simulation.cnc.run_state(), RunState::Stop, "{text}");
        lathe.cuts.truncate(whole);
        start(&mut lathe);
        lathe.assert_agrees();
        assert_eq!(lathe.twin.pulses(), end, "{text}");
        let grooves = pass_grooves(&lathe, thread.pitch, (-18.0, -9.0), thread.direction());
        let (all, rest) = thread.passes;
        assert_eq!(grooves.len(), all + rest, "{text}");
        // G76 moves each pass along the flank: each is compared with the same pass of before.
        let (whole, restarted) = grooves.split_at(all);
        for (made, wanted) in restarted.iter().zip(&whole[all - rest..]) {
            let spread = groove_spread(&[*made, *wanted]);
            assert!(spread <= GROOVE_TOLERANCE_MM, "{text}: {grooves:#.5?}");
        }
    }
}
