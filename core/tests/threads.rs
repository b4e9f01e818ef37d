//! Threads and tapping on the simulated lathe: program, control, ladder, spindle.

use gsk_core::cnc::{Event, Request};
use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::machine::Fault;
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::preview::preview;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;

const MINUTE: u32 = 60_000;
/// One pulse of Z, mm.
const PULSE: f64 = 0.001;

const SINGLE_BLOCK: BitAddress = BitAddress::new(Area::X, 20, 6);
const DRY_RUN: BitAddress = BitAddress::new(Area::X, 21, 2);
const FEED_HOLD: BitAddress = BitAddress::new(Area::X, 24, 7);
const CYCLE_START: BitAddress = BitAddress::new(Area::X, 25, 0);
const RESET: BitAddress = BitAddress::new(Area::X, 26, 0);
const SPINDLE_FASTER: BitAddress = BitAddress::new(Area::X, 24, 1);

/// A simulation with what happened in it.
struct Run {
    simulation: Simulation,
    moves: Vec<ExecutedMove>,
}

impl Run {
    fn new(text: &str, changes: &[(u16, i32)]) -> Self {
        let mut setup = Setup::default();
        for (number, value) in changes {
            assert!(setup.parameters.set(*number, *value).is_ok());
        }
        let mut run = Self {
            simulation: Simulation::new(setup),
            moves: Vec::new(),
        };
        run.wait(100);
        let program = Request::OpenExternal(Program::new(text));
        assert_eq!(run.simulation.cnc.request(program), Ok(()));
        run
    }

    fn started(text: &str, changes: &[(u16, i32)]) -> Self {
        let mut run = Self::new(text, changes);
        run.start();
        run
    }

    fn start(&mut self) {
        self.simulation.start_automatic();
    }

    fn tick(&mut self) {
        self.simulation.tick();
        for event in self.simulation.cnc.events() {
            if let Event::Moved(piece) = event {
                self.moves.push(*piece);
            }
        }
    }

    fn wait(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    fn press(&mut self, key: BitAddress) {
        for down in [true, false] {
            self.simulation.cnc.set_panel_key(key, down);
            self.wait(100);
        }
    }

    /// Ticks until the condition holds.
    #[track_caller]
    fn until(&mut self, what: &str, mut reached: impl FnMut(&Simulation) -> bool) {
        let come = (0..5 * MINUTE).any(|_| {
            self.tick();
            reached(&self.simulation)
        });
        assert!(
            come,
            "never {what}: line {} {:?} at {:?} {:?}",
            self.line(),
            self.state(),
            self.simulation.cnc.position_absolute(),
            self.simulation.cnc.alarms()
        );
    }

    #[track_caller]
    fn finish(&mut self) {
        self.until("stopped", |simulation| {
            simulation.cnc.run_state() != RunState::Run && !simulation.cnc.is_moving()
        });
    }

    #[track_caller]
    fn until_z(&mut self, z: f64) {
        self.until("at that Z", |simulation| {
            simulation.cnc.position_absolute().z <= z
        });
    }

    fn state(&self) -> RunState {
        self.simulation.cnc.run_state()
    }

    fn line(&self) -> u32 {
        self.simulation.cnc.cursor().line
    }

    fn z(&self) -> f64 {
        self.simulation.cnc.position_absolute().z
    }

    fn alarm(&self) -> Option<u16> {
        self.simulation
            .cnc
            .alarms()
            .first()
            .map(|alarm| alarm.number)
    }
}

/// Distance of two parts of a turn.
fn apart(one: f64, other: f64) -> f64 {
    let apart = (one - other).abs().fract();
    apart.min(1.0 - apart)
}

#[test]
fn passes_meet_the_same_groove_at_every_speed_and_start() {
    const LEAD: f64 = 2.0;
    let direct = [(110, 1), (111, 1)];
    for (rpm, starts, gearing) in [
        (200, 1u32, direct),
        (200, 2, direct),
        (200, 5, direct),
        (600, 1, direct),
        (600, 2, direct),
        (600, 5, direct),
        (1500, 1, direct),
        (1500, 2, direct),
        (1500, 5, direct),
        (500, 3, [(110, 2), (111, 1)]),
        (500, 3, [(110, 3), (111, 2)]),
        (500, 3, [(110, 1), (111, 2)]),
    ] {
        let text = format!(
            "O0001\nM03 S{rpm}\nG04 X2\nG00 X40 Z5\n\
                 G92 X39 Z-30 F{LEAD} J0 L{starts}\nX38.5\nX38.2\nM30\n"
        );
        let mut run = Run::started(&text, &gearing);
        let mut phases = Vec::new();
        let mut before = run.z();
        while run.state() == RunState::Run {
            run.tick();
            let slides = run.simulation.lathe.slides();
            if before > -10.0 && slides.z <= -10.0 && run.simulation.cnc.modal().motion == 92 {
                let turns = run.simulation.lathe.spindle_degrees() / 360.0;
                phases.push((turns + slides.z / LEAD).rem_euclid(1.0));
            }
            before = slides.z;
        }
        assert_eq!(run.alarm(), None);
        assert_eq!(phases.len() as u32, 3 * starts);
        for (pass, phase) in phases.iter().enumerate() {
            let share = f64::from(pass as u32 % starts) / f64::from(starts);
            let error = apart(phase - phases[0], share) * LEAD;
            assert!(
                error <= PULSE + 1e-6,
                "{error} mm in pass {pass} at {rpm} r/min, {starts} starts, {gearing:?}"
            );
        }
    }
}

#[test]
fn threads_end_exactly_and_are_reported() {
    let mut run = Run::started(
        "O0001\nM03 S500\nG04 X1\nG00 X40 Z5\nG32 Z-20 F2\nX42 Z-30\nJ2 K3 Z-40\nG00 X60\nM30\n",
        &[],
    );
    run.finish();
    assert_eq!(run.alarm(), None);
    let kinds: Vec<_> = run
        .moves
        .iter()
        .filter(|piece| piece.kind != MoveKind::Dwell)
        .map(|piece| (piece.source.line, piece.kind, piece.to.x * 2.0, piece.to.z))
        .collect();
    assert_eq!(
        kinds,
        [
            (4, MoveKind::Rapid, 40.0, 5.0),
            (5, MoveKind::Thread, 40.0, -20.0),
            (6, MoveKind::Thread, 42.0, -30.0),
            (7, MoveKind::Thread, 42.0, -37.0),
            (7, MoveKind::RunOut, 46.0, -40.0),
            (8, MoveKind::Rapid, 60.0, -40.0),
        ]
    );
    // 500 r/min at 2 mm: the second thread is neither late nor slow.
    let second = run.moves.iter().find(|piece| piece.source.line == 6);
    assert!((second.unwrap().duration_s - 10.0 / (1000.0 / 60.0)).abs() < 0.002);
}

#[test]
fn the_preview_knows_the_time_of_threads_and_taps() {
    same_time(
        "O0001\nG00 X40 Z5\nG92 X39 Z-30 F2 J1 K2 L2\nX38.5\nG32 Z-20 F1.5\nG00 X60\nM30\n",
        150.0,
    );
    same_time("O0001\nG00 X0 Z5\nG33 Z-20 F1.5\nM30\n", 49.0);
}

#[track_caller]
fn same_time(text: &str, thread_length: f64) {
    let setup = Setup {
        spindle_rpm: Some(600.0),
        ..Setup::default()
    };
    let mut simulation = Simulation::new(setup.clone());
    let request = Request::OpenExternal(Program::new(text));
    assert_eq!(simulation.cnc.request(request), Ok(()));
    let estimate = preview(&setup, simulation.cnc.programs(), &mut |_| {});
    assert_eq!(estimate.alarm, None);
    for _ in 0..500 {
        simulation.tick();
    }
    simulation.start_automatic();
    let begun = simulation.cnc.ticks();
    let mut moves = 0;
    while simulation.cnc.run_state() == RunState::Run {
        simulation.tick();
        let moved = |event: &&Event| matches!(event, Event::Moved(_));
        moves += simulation.cnc.events().iter().filter(moved).count();
    }
    assert!(simulation.cnc.alarms().is_empty());
    let took = (simulation.cnc.ticks() - begun) as f64 / 1000.0;
    let off = (took - estimate.time_s).abs();
    assert!(
        off < 0.6 + 0.02 * took,
        "{took} s, {} foreseen",
        estimate.time_s
    );
    assert!(
        moves as u64 + 1 >= estimate.moves,
        "{moves} {}",
        estimate.moves
    );
    assert!(estimate.lengths.thread > thread_length);
}

const G32: &str = "O0001\nM03 S500\nG04 X1\nG00 X40 Z5\nG32 Z-20 F2\nG32 Z-30\nG00 X60\nZ5\nM30\n";

#[test]
fn feed_hold_waits_for_the_first_block_after_a_thread() {
    let mut run = Run::started(G32, &[]);
    run.until_z(-5.0);
    run.press(FEED_HOLD);
    assert_eq!(run.state(), RunState::Hold, "SPL stands at once");
    run.until("stopped", |simulation| {
        simulation.cnc.run_state() == RunState::Stop
    });
    let at = run.simulation.cnc.position_absolute();
    assert_eq!((at.diameter().0, at.z), (60.0, -30.0));
    assert_eq!(run.line(), 7);
    run.press(CYCLE_START);
    run.finish();
    assert_eq!(run.z(), 5.0);
}

#[test]
fn hold_that_is_still_pressed_stops_in_the_block_after_a_thread() {
    let mut run = Run::started(&G32.replace("G00 X60", "G01 X160 F300"), &[]);
    run.until_z(-5.0);
    run.simulation.cnc.set_panel_key(FEED_HOLD, true);
    run.wait(6000);
    run.simulation.cnc.set_panel_key(FEED_HOLD, false);
    assert_eq!((run.state(), run.line()), (RunState::Hold, 7));
    let at = run.simulation.cnc.position_absolute();
    assert!(at.z == -30.0 && at.x < 60.0 && !run.simulation.cnc.is_moving());
    run.press(CYCLE_START);
    run.finish();
    assert_eq!((run.z(), run.alarm()), (5.0, None));
}

#[test]
fn feed_hold_lets_a_thread_cycle_retract() {
    let text = "O0001\nM03 S500\nG04 X1\nG00 X40 Z5\nG92 X36 Z-20 F2\nX35\nM30\n";
    let mut run = Run::started(text, &[]);
    run.until_z(-5.0);
    run.press(FEED_HOLD);
    assert_eq!(run.state(), RunState::Hold);
    run.until("stopped", |simulation| {
        simulation.cnc.run_state() == RunState::Stop
    });
    let at = run.simulation.cnc.position_absolute();
    assert_eq!((at.diameter().0, at.z), (40.0, -20.0), "after the retract");
    run.press(CYCLE_START);
    run.finish();
    assert_eq!((run.z(), run.alarm()), (5.0, None));
}

#[test]
fn single_block_stops_after_the_first_block_that_is_no_thread() {
    let mut run = Run::new(G32, &[]);
    run.press(SINGLE_BLOCK);
    run.start();
    let mut stops = Vec::new();
    while run.state() != RunState::Reset {
        run.finish();
        stops.push(run.line());
        run.press(CYCLE_START);
    }
    stops.dedup();
    assert_eq!(stops[..4], [2, 3, 4, 7]);
}

#[test]
fn reset_stops_a_thread_at_once() {
    let mut run = Run::started(G32, &[]);
    run.until_z(-5.0);
    run.press(RESET);
    run.wait(500);
    assert_eq!(run.state(), RunState::Reset);
    assert!(
        !run.simulation.cnc.is_moving() && run.z() > -12.0,
        "{}",
        run.z()
    );
}

#[test]
fn threads_need_a_turning_spindle_and_a_usable_encoder() {
    let text = "O0001\nG00 X40 Z5\nG32 Z-20 F2\nM30\n";
    let alarm = |text: &str, changes: &[(u16, i32)]| {
        let mut run = Run::started(text, changes);
        run.finish();
        let alarms = run.simulation.cnc.alarms();
        (alarms[0].number, alarms[0].source.unwrap().line, run.z())
    };
    assert_eq!(alarm(text, &[]), (94, 3, 5.0));
    let turning = text.replace("G00", "M03 S500\nG04 X1\nG00");
    assert_eq!(alarm(&turning, &[(70, 50)]), (92, 5, 5.0));
    // 20 mm at 500 r/min are 10 m/min, more than 023.
    let fast = turning.replace("F2", "F20");
    assert_eq!(alarm(&fast, &[]), (94, 5, 5.0));
    let tap = turning.replace("G32", "G33");
    assert_eq!(alarm(&tap.replace("M03", "M05"), &[]), (94, 5, 5.0));
}

#[test]
fn the_preview_raises_the_same_alarms() {
    let alarm = |text: &str, lines: i32| {
        let mut setup = Setup::default();
        setup.parameters.set(70, lines).unwrap();
        let mut simulation = Simulation::new(setup.clone());
        let request = Request::OpenExternal(Program::new(text));
        assert_eq!(simulation.cnc.request(request), Ok(()));
        let preview = preview(&setup, simulation.cnc.programs(), &mut |_| {});
        preview
            .alarm
            .map(|alarm| (alarm.number, alarm.source.unwrap().line))
    };
    let text = "O0001\nG00 X40 Z5\nG32 Z-20 F2\nM30\n";
    assert_eq!(alarm(text, 1024), Some((94, 3)));
    let turning = text.replace("G00", "M03 S500 G00");
    assert_eq!(alarm(&turning, 1024), None);
    assert_eq!(alarm(&turning, 99), Some((92, 3)));
    assert_eq!(alarm(&turning.replace("F2", "F20"), 1024), Some((94, 3)));
}

#[test]
fn a_spindle_that_changes_its_speed_or_stops_is_noticed() {
    for (changes, number) in [
        ([(106, 10), (175, 0)], Some(91)),
        ([(106, 0), (175, 0b100)], Some(98)),
        ([(106, 0), (175, 0)], None),
    ] {
        let mut run = Run::started(G32, &changes);
        run.until_z(-5.0);
        run.simulation.lathe.set_fault(Fault::SpindleBlocked, true);
        run.wait(3000);
        assert_eq!(run.alarm(), number);
        assert!(run.z() > -12.0 && !run.simulation.cnc.is_moving());
        let state = if number.is_some() {
            RunState::Stop
        } else {
            RunState::Run
        };
        assert_eq!(run.state(), state);
    }
    // A cut per minute would go on; it too stops with 098.
    let text = "O0001\nM03 S500\nG04 X1\nG00 X40 Z5\nG98 G01 Z-90 F300\nM30\n";
    let mut run = Run::started(text, &[(175, 0b100)]);
    run.until_z(-5.0);
    run.simulation.lathe.set_fault(Fault::SpindleBlocked, true);
    run.wait(2000);
    assert_eq!((run.alarm(), run.state()), (Some(98), RunState::Stop));
}

#[test]
fn a_change_of_the_spindle_override_waits_for_the_end_of_the_thread() {
    let mut run = Run::started(G32, &[]);
    run.until_z(0.0);
    run.press(SPINDLE_FASTER);
    run.wait(300);
    assert!(run.z() > -18.0);
    assert!((run.simulation.cnc.spindle_commanded() - 500.0).abs() < 1e-9);
    let chosen = f64::from(run.simulation.cnc.spindle_override()) / 100.0;
    assert!(chosen > 1.0, "the key acts");
    run.until("out", |simulation| {
        simulation.cnc.position_absolute().x > 25.0
    });
    assert!((run.simulation.cnc.spindle_commanded() - 500.0 * chosen).abs() < 1e-9);
}

#[test]
fn dry_run_cuts_threads_and_taps_without_the_spindle() {
    let text = "O0001\nG00 X40 Z5\nG32 Z-2 F2\nG00 X0\nG33 Z-5 F1\nM30\n";
    let mut run = Run::new(text, &[]);
    run.press(DRY_RUN);
    run.start();
    run.until_z(4.0);
    assert!((run.simulation.cnc.feed_actual() - 126.0).abs() < 1.0);
    run.finish();
    assert_eq!((run.alarm(), run.z()), (None, -2.0));
    let threads = run
        .moves
        .iter()
        .filter(|piece| piece.kind == MoveKind::Thread)
        .map(|piece| piece.to.z);
    assert_eq!(threads.collect::<Vec<_>>(), [-2.0, -5.0, -2.0]);
}

#[test]
fn tapping_follows_the_spindle_through_its_reversal() {
    for (code, starts) in [("M03", 1), ("M04", 1), ("M03", 2)] {
        let text = format!(
            "O0001\n{code} S300\nG04 X1\nG00 X0 Z5\nG33 Z-20 F1.5 L{starts}\nG00 Z50\nM30\n"
        );
        let mut run = Run::started(&text, &[]);
        let (mut deepest, mut fastest) = (0.0f64, 0.0f64);
        let sign = if code == "M03" { 1.0 } else { -1.0 };
        while run.state() == RunState::Run && run.alarm().is_none() {
            run.tick();
            if run.line() == 5 {
                deepest = deepest.min(run.z());
                fastest = fastest.min(run.simulation.lathe.spindle_rpm() * sign);
            }
        }
        assert_eq!((run.alarm(), run.z()), (None, 50.0));
        // It runs out: deeper than programmed, by less than three turns.
        assert!((-24.5..-20.2).contains(&deepest), "{deepest}");
        assert!(fastest < -250.0, "the spindle was reversed");
        assert!(run.simulation.lathe.spindle_rpm().abs() < 1.0);
        let taps: Vec<_> = run
            .moves
            .iter()
            .filter(|piece| piece.source.line == 5)
            .map(|piece| (piece.kind, piece.to.z == 5.0))
            .collect();
        let both = [(MoveKind::Thread, false), (MoveKind::Thread, true)];
        assert_eq!(taps, both.repeat(starts));
    }
}

#[test]
fn face_and_taper_threads_end_exactly() {
    let text = "O0001\nM03 S300\nG04 X1\nG00 X80 Z5\nG32 X20 F3\nG00 Z-5\nG32 X-10 Z-20 F2\n\
                G32 X70 F2\nG34 Z-60 F2 R0.3\nM30\n";
    let mut run = Run::started(text, &[]);
    run.finish();
    assert_eq!(run.alarm(), None);
    let ends: Vec<_> = run
        .moves
        .iter()
        .filter(|piece| piece.kind == MoveKind::Thread)
        .map(|piece| (piece.to.x * 2.0, piece.to.z))
        .collect();
    assert_eq!(
        ends,
        [(20.0, 5.0), (-10.0, -20.0), (70.0, -20.0), (70.0, -60.0)]
    );
}

#[test]
fn feed_hold_waits_for_the_end_of_a_tap() {
    let text = "O0001\nM03 S300\nG04 X1\nG00 X0 Z5\nG33 Z-20 F1.5\nG00 Z50\nM30\n";
    let mut run = Run::started(text, &[]);
    run.until_z(0.0);
    run.press(FEED_HOLD);
    assert_eq!(run.state(), RunState::Hold);
    run.until("stopped", |simulation| {
        simulation.cnc.run_state() == RunState::Stop
    });
    assert_eq!((run.z(), run.line()), (5.0, 5));
    run.press(CYCLE_START);
    run.finish();
    assert_eq!(run.z(), 50.0);
}

#[test]
fn a_saved_thread_goes_on_bit_for_bit() {
    let mut one = Run::started(G32, &[]);
    one.until_z(-5.0);
    let mut other = one.simulation.clone();
    for _ in 0..3000 {
        one.simulation.tick();
        other.tick();
    }
    assert_eq!(one.simulation, other);
}
