//! Checks that the plotted path ends where the board stopped: the motion that the board has
//! not made is not drawn.

#[allow(dead_code, reason = "the whole bench of the link")]
#[path = "control/bench/board.rs"]
pub mod board;
#[path = "control/bench/keys.rs"]
mod keys;

use std::time::Duration;

use board::{BenchBoard, LinkedMachine, TimedBoard};
use gsk_core::linked::LinkedControl;
use gsk_core::setup::Setup;
use gsk_core::units::Point;
use gsk_link::LinkState;
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;
use gsk_panel::trace::PathSegment;
use gsk_twins::grbl::{GrblTwin, Variant};

/// 10 mm/s along Z, then along X. The control is past the corner long before the board reaches
/// it.
const CORNER_PROGRAM: &str = "O1\nG98 G01 W-10 F600\nU-40\nM30\n";

/// A panel at a control with a board.
#[derive(Clone)]
struct PlottedLathe<T> {
    emulator: Emulator,
    linked: LinkedControl,
    twin: T,
}

impl<T: BenchBoard> PlottedLathe<T> {
    fn new(machine: LinkedMachine<T>) -> Self {
        let mut emulator = Emulator::new(Setup::default());
        *emulator.board_simulation() = machine.simulation;
        let mut lathe = Self {
            emulator,
            linked: machine.linked,
            twin: machine.twin,
        };
        lathe.run_ms(4000);
        lathe
    }

    fn run_ms(&mut self, ms: u32) {
        for _ in 0..ms {
            self.twin.advance(1_000_000);
            let bytes = self.twin.read();
            let now = Duration::from_nanos(self.twin.now());
            self.linked.pump(&bytes, now);
            while self.linked.can_tick() {
                self.linked.before_tick(self.emulator.board_simulation());
                self.emulator.tick();
                self.linked.after_tick(self.emulator.board_simulation());
            }
            let bytes = self.linked.tx().to_vec();
            self.twin.write(&bytes);
            self.linked.mark_written(bytes.len());
        }
    }

    fn press(&mut self, key: Key) {
        self.emulator.key_down(key);
        self.run_ms(100);
        self.emulator.key_up(key);
        self.run_ms(100);
    }

    fn position(&self) -> Point {
        self.emulator.cnc().position_absolute()
    }

    fn path(&self) -> Vec<PathSegment> {
        self.emulator
            .panel()
            .view()
            .trace
            .segments()
            .copied()
            .collect()
    }

    /// Draws until the control is past the corner and the board is not.
    fn draw_past_corner(&mut self) -> Point {
        self.press(Key::Auto);
        let program = gsk_core::program::Program::new(CORNER_PROGRAM);
        self.emulator.load_external(program).unwrap();
        let far = Point::new(100.0, 100.0);
        self.emulator.fit_graphic(far * -1.0, far);
        let begins = self.position();
        let from = self.twin.pulses();
        self.press(Key::CycleStart);
        for _ in 0..5000 {
            self.run_ms(1);
            if self.position().x < begins.x {
                break;
            }
        }
        let [x, z] = self.twin.pulses();
        assert!(
            x == from[0] && z != from[1],
            "the board is before the corner"
        );
        assert!(self.position().x < begins.x, "the control is ahead of it");
        begins
    }
}

/// After a stop before the corner nothing of the path after it is drawn.
#[track_caller]
fn check_path_end<T: BenchBoard>(ready: &PlottedLathe<T>, stop: impl Fn(&mut PlottedLathe<T>)) {
    let mut lathe = ready.clone();
    let begins = lathe.draw_past_corner();
    stop(&mut lathe);
    lathe.run_ms(2500);
    let (path, stands) = (lathe.path(), lathe.position());
    assert!(
        stands.z < begins.z - 5.0 && stands.z > begins.z - 9.999,
        "{stands:?}"
    );
    let (first, last) = (path.first().unwrap(), path.last().unwrap());
    assert!((first.from - begins).length() < 1e-9, "{path:?}");
    assert!((last.to - stands).length() < 1e-9, "{stands:?} {path:?}");
    for piece in &path {
        // At the point of the reading, the path may be off by a pulse.
        assert!((piece.to.x - begins.x).abs() < 0.006, "{path:?}");
        assert!(piece.to.z > stands.z - 0.006, "{path:?}");
    }
    assert!(path.len() < 5, "one line, but for its last bits: {path:?}");
}

fn check_board<T: BenchBoard>(ready: &PlottedLathe<T>) {
    check_path_end(ready, |lathe| lathe.press(Key::Reset));
    check_path_end(ready, |lathe| lathe.press(Key::EmergencyStop));
    check_path_end(ready, |lathe| lathe.twin.press_limit(true));
    check_path_end(ready, |lathe| lathe.twin.fail());
    check_path_end(ready, |lathe| {
        for wire in lathe.twin.wires() {
            wire.set_cut(true);
        }
    });
}

#[test]
fn the_path_of_a_line_board_ends_where_it_stopped() {
    check_board::<GrblTwin>(&PlottedLathe::new(LinkedMachine::referenced(Variant::Grbl)));
}

#[test]
fn the_path_of_a_board_of_timed_steps_ends_where_it_stopped() {
    check_board::<TimedBoard>(&PlottedLathe::new(LinkedMachine::timed_referenced()));
}

/// Without a stop the whole path is drawn, with as few segments as otherwise.
#[test]
fn a_path_that_was_made_is_drawn_to_its_end() {
    let mut lathe = PlottedLathe::new(LinkedMachine::referenced(Variant::Grbl));
    let begins = lathe.draw_past_corner();
    lathe.run_ms(6000);
    assert_eq!(lathe.linked.state(), LinkState::Ready);
    let corner = begins + Point::new(0.0, -10.0);
    let end = corner + Point::new(-20.0, 0.0);
    let path = lathe.path();
    assert!((path.last().unwrap().to - end).length() < 1e-6, "{path:?}");
    assert!(path.iter().any(|piece| (piece.to - corner).length() < 0.05));
    assert!(path.len() < 40, "{}", path.len());
}
