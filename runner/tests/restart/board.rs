//! A restart on a machine whose spindle does not reach its speed.

use gsk_core::command::{ExecutedMove, ProgramId};
use gsk_core::interpreter::{Explanation, ModalState};
use gsk_core::machine::LatheFault;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_messages::Message;
use gsk_runner::board::{BoardRestart, PulseBoard, RestartPlanner};
use gsk_runner::execution::{
    ExecutionLimits, ExecutionWatcher, SupervisedBoard, WatcherStop, execute,
};
use gsk_runner::report::RunEnd;
use gsk_runner::restart::{LineWatcher, RestartWords, find_block, plan_restart};

use super::programs::TestProgram;
use super::setup;

const TURNED: TestProgram = TestProgram {
    name: "stalled spindle",
    text: "O0001;\nG50 X100 Z100;\nG97 G98 S800 M03;\nT0101;\nG00 X52 Z2;\nG01 X40 F120;\n\
           Z-10;\nG00 X100 Z100;\nM30;\n",
    subprograms: &[],
    macro_b: false,
};
/// The last cut.
const LINE: u32 = 7;

/// A board that follows the control at once. With `stalls` its spindle stops before it reaches
/// its speed.
struct InstantBoard {
    stalls: bool,
    has_stalled: bool,
}

impl PulseBoard for InstantBoard {
    fn wait_for_tick(&mut self, _: &mut Simulation) -> bool {
        true
    }

    fn finish_tick(&mut self, simulation: &mut Simulation) {
        self.has_stalled |= self.stalls && simulation.cnc.spindle_actual() > 600.0;
        let fault = LatheFault::SpindleBlocked;
        simulation.lathe.set_fault(fault, self.has_stalled);
    }

    fn close(self: Box<Self>, _: &mut Simulation) {}
}

/// Plans the restart at a line, confirmed by an option.
struct LinePlanner(Option<BoardRestart>);

impl RestartPlanner for LinePlanner {
    fn begin(&mut self, simulation: &Simulation) {
        let program = simulation.cnc.programs().get(ProgramId::External).unwrap();
        let mut watcher = LineWatcher::new(ProgramId::External, program, LINE);
        let found = find_block(simulation, None, &mut watcher, None).unwrap();
        let plan = plan_restart(simulation, None, &found, &RestartWords::default()).unwrap();
        self.0 = Some(BoardRestart {
            plan,
            part: None,
            block_lines: Vec::new(),
            is_confirmed: true,
        });
    }

    fn poll(&mut self) -> Option<Result<BoardRestart, Message>> {
        self.0.take().map(Ok)
    }
}

/// Counts the cuts, and the time after the last motion, ms.
#[derive(Default)]
struct MotionWatcher {
    cuts: usize,
    last: Option<Point>,
    still_ms: u64,
}

impl ExecutionWatcher for MotionWatcher {
    fn on_move(&mut self, executed: &ExecutedMove) {
        self.cuts += usize::from(executed.feed.is_some());
    }

    fn on_tick(&mut self, _: u64, machine: Point, _: &Simulation) -> Option<WatcherStop> {
        match self.last == Some(machine) {
            true => self.still_ms += 1,
            false => self.still_ms = 0,
        }
        self.last = Some(machine);
        None
    }

    fn on_block(&mut self, _: u32, _: &str, _: &ModalState) {}

    fn on_pass(&mut self, _: &Explanation) {}

    fn wants_explanations(&self) -> bool {
        false
    }

    fn show(&mut self, _: &Message) {}
}

#[test]
fn a_restart_ends_when_the_spindle_does_not_reach_its_speed() {
    for stalls in [false, true] {
        let has_stalled = false;
        let board = Box::new(InstantBoard {
            stalls,
            has_stalled,
        });
        let board =
            SupervisedBoard::new(board, false, None).with_restart(Box::new(LinePlanner(None)));
        let limits = ExecutionLimits {
            parts: 1,
            time_ms: 600_000,
        };
        let simulation = Simulation::new(setup(&TURNED));
        let mut watcher = MotionWatcher::default();
        let (report, _) = execute(
            "turned",
            simulation,
            limits,
            None,
            Some(board),
            &mut watcher,
            None,
        )
        .unwrap();
        let waits = report.waits_for.clone().unwrap_or_default();
        if stalls {
            assert_eq!(report.end, RunEnd::Stop, "{waits}");
            assert!(report.has_failed());
            assert_eq!(
                waits,
                "the spindle to reach S (800 r/min within 2 %): it turns at 0 r/min"
            );
            assert_eq!(watcher.cuts, 0);
            assert!(watcher.still_ms >= 30_000, "{}", watcher.still_ms);
        } else {
            assert_eq!(report.end, RunEnd::M30, "{waits}");
            assert_eq!(watcher.cuts, 1);
        }
    }
}
