//! The handwheel retraces the path of a held run on a board: back over blocks, forwards to the
//! point of the hold, and the run continues as if nothing had been.

use std::collections::HashSet;

use gsk_core::cnc::{ControlRequest, Event};
use gsk_core::command::ProgramId;
use gsk_core::operation::RunState;
use gsk_core::plc::address::BitAddress;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_messages::{Message, say};
use gsk_twins::grbl::Variant;

use super::assert_counts_agree;
use crate::bench::board::{BenchBoard, LinkedMachine};
use crate::bench::keys::{AUTO, CYCLE_START, FEED_HOLD, JOG, RESET, Z_MINUS};

/// A line, an arc and two lines without a function between them.
const CONTOUR: &str = "O9\nN10 G50 X60 Z20\nN20 G98 G97 S500 M03\nN30 G00 X40 Z5\n\
    N40 G01 Z-10 F300\nN50 G02 X50 Z-15 R5\nN60 G01 X52\nN65 Z-25\nN70 G04 X0.2\n\
    N80 G00 X60 Z20\nN90 M05\nN99 M30\n";
/// Z at which the hold begins, within N65.
const HOLD_AT_Z: f64 = -20.0;
/// Greatest time until standstill after the last turn of the handwheel, ms.
const STANDSTILL_MS: u32 = 600;
/// Time after standstill in which no pulse may follow, ms.
const REST_MS: u32 = 1000;

fn z<T: BenchBoard>(machine: &LinkedMachine<T>) -> f64 {
    machine.simulation.cnc.position_absolute().z
}

/// Whether the slides stand, at the board too.
fn stands<T: BenchBoard>(machine: &LinkedMachine<T>) -> bool {
    !machine.simulation.cnc.is_moving() && !machine.linked.has_pending_motion()
}

/// Switches the retracing on, starts a program and holds it.
fn held<T: BenchBoard>(ready: &LinkedMachine<T>, text: &str, hold_at_z: f64) -> LinkedMachine<T> {
    let mut machine = ready.clone();
    machine.load(text, None);
    let switch = ControlRequest::SetRetrace(true);
    machine.simulation.cnc.request(switch).unwrap();
    machine.record_path();
    machine.start_program();
    let is_there = machine.run_until(60_000, |machine| {
        machine.simulation.cnc.cursor().line >= 6 && z(machine) < hold_at_z
    });
    assert!(is_there, "{} {:?}", z(&machine), machine.alarms());
    machine.press(FEED_HOLD);
    assert!(machine.run_until(3000, stands), "the hold does not end");
    assert_eq!(machine.simulation.cnc.run_state(), RunState::Hold);
    machine
}

/// Turns the handwheel one graduation in each 10 ms until a state, or for a time.
fn turn<T: BenchBoard>(
    machine: &mut LinkedMachine<T>,
    graduation: i32,
    limit_ms: u32,
    until: impl Fn(&LinkedMachine<T>) -> bool,
) -> bool {
    for _ in 0..limit_ms / 10 {
        if until(machine) {
            return true;
        }
        machine.simulation.lathe.turn_handwheel(graduation);
        machine.run_ms(10);
    }
    until(machine)
}

/// Runs until the slides stand; returns the messages of the control.
fn rest<T: BenchBoard>(machine: &mut LinkedMachine<T>) -> Vec<Message> {
    let mut advice = Vec::new();
    let mut stood = machine.made_pulses();
    for at_ms in 0..STANDSTILL_MS + REST_MS {
        if at_ms == STANDSTILL_MS {
            stood = machine.made_pulses();
        }
        machine.run_one_ms();
        for event in machine.simulation.cnc.events() {
            if let Event::Advised(message) = event {
                advice.push(message.clone());
            }
        }
    }
    assert_eq!(machine.made_pulses(), stood, "motion without the handwheel");
    assert!(stands(machine), "{:?}", machine.linked.state());
    advice
}

fn check_back_and_forwards<T: BenchBoard>(ready: &LinkedMachine<T>) {
    let mut whole = ready.clone();
    whole.load(CONTOUR, None);
    whole.record_path();
    whole.start_program();
    whole.run_to_end(600_000);
    let course: HashSet<[i64; 2]> = whole.path.iter().copied().collect();

    let mut machine = held(ready, CONTOUR, HOLD_AT_Z);
    let hold = machine.made_pulses();
    let mut only_held = machine.clone();
    only_held.press(CYCLE_START);
    let continued_from = only_held.path.len();
    only_held.run_to_end(600_000);

    assert!(turn(&mut machine, -1, 60_000, |it| z(it) > -6.0), "no way");
    rest(&mut machine);
    assert_counts_agree(&machine);
    assert!(z(&machine) > -6.0 && z(&machine) < 5.0);
    let back = machine.made_pulses();
    assert_eq!(machine.simulation.cnc.cursor().line, 8, "block of the hold");

    let refusal = machine.simulation.cnc.start_refusal();
    assert_eq!(refusal, Some(say::retrace_return_first()));
    machine.press(CYCLE_START);
    machine.run_ms(500);
    assert_eq!(machine.simulation.cnc.run_state(), RunState::Hold);
    assert_eq!(machine.made_pulses(), back, "cycle start moves nothing");

    assert!(turn(&mut machine, 1, 60_000, |it| !it
        .simulation
        .cnc
        .is_off_hold()));
    turn(&mut machine, 1, 500, |_| false);
    rest(&mut machine);
    assert_eq!(machine.made_pulses(), hold, "never beyond the hold");
    assert_counts_agree(&machine);
    for point in &machine.path {
        let near = |dx: i64| (-1..=1).any(|dz| course.contains(&[point[0] + dx, point[1] + dz]));
        assert!((-1..=1).any(near), "{point:?} is off the path");
    }

    let retraced = machine.path.len();
    machine.press(CYCLE_START);
    machine.run_to_end(600_000);
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_counts_agree(&machine);
    assert_eq!(machine.made_pulses(), whole.made_pulses());
    let after = |machine: &LinkedMachine<T>, from: usize| machine.path[from..].to_vec();
    let ends = |path: Vec<[i64; 2]>| path.iter().rev().take(1000).copied().collect::<Vec<_>>();
    assert_eq!(
        ends(after(&machine, retraced)),
        ends(after(&only_held, continued_from)),
        "the rest of the path"
    );
}

#[test]
fn back_over_an_arc_and_forwards_again_the_run_ends_on_the_pulse() {
    check_back_and_forwards(&LinkedMachine::referenced(Variant::Grbl));
    check_back_and_forwards(&LinkedMachine::timed_referenced());
}

#[test]
fn the_path_ends_at_a_function_with_one_sentence() {
    let ready = LinkedMachine::referenced(Variant::Grbl);
    let mut machine = held(&ready, CONTOUR, HOLD_AT_Z);
    let begin = |it: &LinkedMachine| (z(it) - 20.0).abs() < 1e-6;
    assert!(turn(&mut machine, -1, 60_000, begin), "{}", z(&machine));
    let mut advice = Vec::new();
    for _ in 0..30 {
        machine.simulation.lathe.turn_handwheel(-1);
        advice.extend(rest(&mut machine));
    }
    assert_eq!(advice, [say::retrace_begin_function()]);
    assert!(begin(&machine), "not beyond the begin");
    assert_counts_agree(&machine);
}

/// Turns on, and checks that nothing moves.
fn check_stands<T: BenchBoard>(machine: &mut LinkedMachine<T>) {
    let stood = machine.made_pulses();
    turn(machine, -1, 500, |_| false);
    turn(machine, 1, 1000, |_| false);
    assert_eq!(machine.made_pulses(), stood);
}

fn check_stops<T: BenchBoard>(ready: &LinkedMachine<T>) {
    let mut moving = held(ready, CONTOUR, HOLD_AT_Z);
    turn(&mut moving, -1, 1500, |_| false);
    assert!(moving.simulation.cnc.is_moving());
    rest(&mut moving.clone());

    let mut dropped = moving.clone();
    let drop = ControlRequest::DropWheel;
    dropped.simulation.cnc.request(drop).unwrap();
    rest(&mut dropped);
    assert_counts_agree(&dropped);

    let mut left = moving.clone();
    left.press(JOG);
    rest(&mut left);
    assert_counts_agree(&left);

    let mut holding = moving.clone();
    holding.simulation.cnc.set_panel_key(FEED_HOLD, true);
    rest(&mut holding);
    check_stands(&mut holding);
    assert_counts_agree(&holding);

    let mut reset = moving.clone();
    reset.press(RESET);
    rest(&mut reset);
    assert_counts_agree(&reset);
    let cnc = &reset.simulation.cnc;
    assert_eq!(cnc.run_state(), RunState::Reset);
    assert!(!cnc.is_off_hold(), "the path is forgotten");
    check_stands(&mut reset);

    let mut emergency = moving.clone();
    emergency.twin.press_emergency(true);
    rest(&mut emergency);
    assert!(!emergency.alarms().is_empty());
    check_stands(&mut emergency);

    let mut cut = moving.clone();
    cut.cut_cable();
    cut.run_ms(5000);
    check_stands(&mut cut);
    assert!(!cut.alarms().is_empty());
}

/// Each stop ends the motion: the handwheel rests, its turns are dropped, another mode, the feed
/// hold key, RESET, the emergency stop, a cut cable.
#[test]
fn the_slides_stand_when_the_handwheel_or_the_link_is_in_doubt() {
    check_stops(&LinkedMachine::referenced(Variant::Grbl));
    check_stops(&LinkedMachine::referenced(Variant::GrblHal));
    check_stops(&LinkedMachine::timed_referenced());
}

/// Slides that were jogged off the path do not follow it, and the run does not continue.
#[test]
fn off_the_path_only_reset_ends_the_hold() {
    let ready = LinkedMachine::referenced(Variant::Grbl);
    let mut machine = held(&ready, CONTOUR, HOLD_AT_Z);
    turn(&mut machine, -1, 1500, |_| false);
    rest(&mut machine);
    machine.press(JOG);
    machine.hold_key(Z_MINUS, 300);
    rest(&mut machine);
    machine.press(AUTO);
    let stood = machine.made_pulses();
    turn(&mut machine, 1, 1000, |_| false);
    machine.press(CYCLE_START);
    machine.run_ms(500);
    assert_eq!(machine.made_pulses(), stood);
    let refusal = machine.simulation.cnc.start_refusal();
    assert_eq!(refusal, Some(say::retrace_return_first()));
    machine.press(RESET);
    machine.run_ms(500);
    assert!(!machine.simulation.cnc.is_off_hold());
}

/// Without the switch the handwheel moves nothing in a hold.
#[test]
fn without_the_switch_nothing_is_retraced() {
    let ready = LinkedMachine::referenced(Variant::Grbl);
    let mut machine = held(&ready, CONTOUR, HOLD_AT_Z);
    let off = ControlRequest::SetRetrace(false);
    machine.simulation.cnc.request(off).unwrap();
    let stood = machine.made_pulses();
    turn(&mut machine, -1, 1000, |_| false);
    assert_eq!(machine.made_pulses(), stood);
}

/// The simulated lathe with its positions tick by tick and the messages of the control.
struct RecordedLathe {
    simulation: Simulation,
    positions: Vec<Point>,
    advice: Vec<Message>,
}

impl RecordedLathe {
    fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.simulation.tick();
            let cnc = &self.simulation.cnc;
            self.positions.push(cnc.position_machine());
            for event in cnc.events() {
                if let Event::Advised(message) = event {
                    self.advice.push(message.clone());
                }
            }
        }
    }

    fn press(&mut self, key: BitAddress) {
        for is_down in [true, false] {
            self.simulation.cnc.set_panel_key(key, is_down);
            self.run(100);
        }
    }

    /// Starts a program and holds it 400 ms after the begin of a line.
    fn held(text: &str, line: u32) -> Self {
        let mut setup = Setup::default();
        let programs = &mut setup.memory.programs;
        programs.open_external(Program::new(text));
        programs.select(ProgramId::External);
        let mut lathe = Self {
            simulation: Simulation::new(setup),
            positions: Vec::new(),
            advice: Vec::new(),
        };
        let switch = ControlRequest::SetRetrace(true);
        lathe.simulation.cnc.request(switch).unwrap();
        lathe.press(AUTO);
        lathe.press(CYCLE_START);
        for _ in 0..60_000 {
            if lathe.simulation.cnc.cursor().line == line {
                break;
            }
            lathe.run(1);
        }
        lathe.run(400);
        lathe.press(FEED_HOLD);
        lathe.run(1000);
        let cnc = &lathe.simulation.cnc;
        assert_eq!((cnc.run_state(), cnc.is_moving()), (RunState::Hold, false));
        assert_eq!(cnc.cursor().line, line, "{:?}", cnc.alarms());
        lathe
    }

    /// Turns the handwheel back until the slides have stood for a second.
    fn turn_back(&mut self) {
        let mut stood = 0;
        while stood < 1000 {
            assert!(self.positions.len() < 200_000, "no begin");
            self.simulation.lathe.turn_handwheel(-2);
            self.run(10);
            stood = match self.simulation.cnc.is_moving() {
                true => 0,
                false => stood + 10,
            };
        }
    }

    /// Greatest speed and change of speed of both axes from a tick on, mm per tick.
    fn greatest_from(&self, first: usize) -> [f64; 4] {
        let path = &self.positions[first..];
        let speeds: Vec<Point> = path.windows(2).map(|it| it[1] - it[0]).collect();
        let greatest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let change = |it: &[Point]| it[1] - it[0];
        [
            greatest(&mut speeds.iter().map(|it| it.x.abs())),
            greatest(&mut speeds.iter().map(|it| it.z.abs())),
            greatest(&mut speeds.windows(2).map(|it| change(it).x.abs())),
            greatest(&mut speeds.windows(2).map(|it| change(it).z.abs())),
        ]
    }
}

#[test]
fn speed_and_acceleration_stay_below_those_of_the_run() {
    let text = "O9\nG50 X200 Z100\nG98 G97 S500 M03\nG00 X40 Z5\nG01 Z-10 F600\nG00 X120 Z60\n\
                G01 Z40 F600\nM30\n";
    let mut lathe = RecordedLathe::held(text, 7);
    let made = lathe.greatest_from(0);
    let back = lathe.positions.len();
    lathe.turn_back();
    let retraced = lathe.greatest_from(back);
    assert_eq!(lathe.advice, [say::retrace_begin_function()]);
    for (index, (made, retraced)) in made.iter().zip(retraced).enumerate() {
        let share = if index < 2 { 0.501 } else { 1.001 };
        assert!(retraced > 0.1 * made, "{index}: {retraced} {made}");
        assert!(retraced <= share * made, "{index}: {retraced} {made}");
    }
}

#[test]
fn the_path_ends_at_threads_dwells_and_coordinates() {
    for (before, sentence) in [
        ("G92 X39 Z-5 F1", say::retrace_begin_thread()),
        ("G04 X0.1", say::retrace_begin_function()),
        ("G50 X40 Z5", say::retrace_begin_coordinates()),
    ] {
        let text = format!(
            "O9\nG50 X60 Z20\nG98 G97 S500 M03\nG00 X40 Z5\n{before}\nG00 X44\nG01 Z-10 F300\nM30\n"
        );
        let mut lathe = RecordedLathe::held(&text, 7);
        lathe.turn_back();
        assert_eq!(lathe.advice, [sentence], "{before}");
    }
}
