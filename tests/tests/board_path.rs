//! Checks that the plotted path ends where the board stopped: the motion that the board has
//! not made is not drawn.

#[allow(dead_code, reason = "the whole bench of the link")]
#[path = "control/bench/board.rs"]
mod board;
#[path = "control/bench/keys.rs"]
mod keys;

use std::time::Duration;

use board::{Board, Machine, Timed};
use gsk_core::linked::Linked;
use gsk_core::units::Point;
use gsk_link::LinkState;
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;
use gsk_panel::panel::Panel;
use gsk_panel::trace::PathSegment;
use gsk_twins::grbl::{GrblTwin, Variant};

/// 10 mm/s along Z, then along X. The control is past the corner long before the board reaches
/// it.
const CORNER: &str = "O1\nG98 G01 W-10 F600\nU-40\nM30\n";

/// A panel at a control with a board.
#[derive(Clone)]
struct Lathe<T> {
    emulator: Emulator,
    linked: Linked,
    twin: T,
}

impl<T: Board> Lathe<T> {
    fn new(machine: Machine<T>) -> Self {
        let mut lathe = Self {
            emulator: Emulator {
                simulation: machine.simulation,
                panel: Panel::new(),
            },
            linked: machine.linked,
            twin: machine.twin,
        };
        lathe.pass(4000);
        lathe
    }

    fn pass(&mut self, ms: u32) {
        for _ in 0..ms {
            self.twin.advance(1_000_000);
            let bytes = self.twin.read();
            let now = Duration::from_nanos(self.twin.now());
            self.linked.pump(&bytes, now);
            while self.linked.may_tick() {
                self.linked.before(&mut self.emulator.simulation);
                self.emulator.tick();
                self.linked.after(&mut self.emulator.simulation);
            }
            let bytes = self.linked.tx().to_vec();
            self.twin.write(&bytes);
            self.linked.consumed(bytes.len());
        }
    }

    fn press(&mut self, key: Key) {
        self.emulator.key_down(key);
        self.pass(100);
        self.emulator.key_up(key);
        self.pass(100);
    }

    fn place(&self) -> Point {
        self.emulator.simulation.cnc.position_absolute()
    }

    fn path(&self) -> Vec<PathSegment> {
        self.emulator
            .panel
            .view()
            .trace
            .segments()
            .copied()
            .collect()
    }

    /// Draws until the control is past the corner and the board is not.
    fn cuts_the_corner(&mut self) -> Point {
        self.press(Key::Auto);
        let program = gsk_core::program::Program::new(CORNER);
        self.emulator.load_external(program).unwrap();
        let far = Point::new(100.0, 100.0);
        self.emulator.fit_graphic(far * -1.0, far);
        let begins = self.place();
        let from = self.twin.pulses();
        self.press(Key::CycleStart);
        for _ in 0..5000 {
            self.pass(1);
            if self.place().x < begins.x {
                break;
            }
        }
        let [x, z] = self.twin.pulses();
        assert!(
            x == from[0] && z != from[1],
            "the board is before the corner"
        );
        assert!(self.place().x < begins.x, "the control is behind it");
        begins
    }
}

/// After a stop before the corner nothing of the path after it is drawn.
#[track_caller]
fn ends_where_it_stopped<T: Board>(ready: &Lathe<T>, stop: impl Fn(&mut Lathe<T>)) {
    let mut lathe = ready.clone();
    let begins = lathe.cuts_the_corner();
    stop(&mut lathe);
    lathe.pass(2500);
    let (path, stands) = (lathe.path(), lathe.place());
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

fn common<T: Board>(ready: &Lathe<T>) {
    ends_where_it_stopped(ready, |lathe| lathe.press(Key::Reset));
    ends_where_it_stopped(ready, |lathe| lathe.press(Key::EmergencyStop));
    ends_where_it_stopped(ready, |lathe| lathe.twin.press_limit(true));
    ends_where_it_stopped(ready, |lathe| lathe.twin.fail());
    ends_where_it_stopped(ready, |lathe| {
        for wire in lathe.twin.wires() {
            wire.set_cut(true);
        }
    });
}

#[test]
fn the_path_of_a_line_board_ends_where_it_stopped() {
    common::<GrblTwin>(&Lathe::new(Machine::referenced(Variant::Grbl)));
}

#[test]
fn the_path_of_a_board_of_timed_steps_ends_where_it_stopped() {
    common::<Timed>(&Lathe::new(Machine::timed_referenced()));
}

/// Without a stop the whole path is drawn, with as few segments as otherwise.
#[test]
fn a_path_that_was_made_is_drawn_to_its_end() {
    let mut lathe = Lathe::new(Machine::referenced(Variant::Grbl));
    let begins = lathe.cuts_the_corner();
    lathe.pass(6000);
    assert_eq!(lathe.linked.state(), LinkState::Ready);
    let corner = begins + Point::new(0.0, -10.0);
    let end = corner + Point::new(-20.0, 0.0);
    let path = lathe.path();
    assert!((path.last().unwrap().to - end).length() < 1e-6, "{path:?}");
    assert!(path.iter().any(|piece| (piece.to - corner).length() < 0.05));
    assert!(path.len() < 40, "{}", path.len());
}
