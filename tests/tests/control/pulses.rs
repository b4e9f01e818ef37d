//! Compares pulses with commanded positions over very many moves: gear, backlash and pitch
//! errors. `PULSE_MOVES=10000000 cargo test -p gsk980td-tests --test control pulses` makes them all.

use std::fmt::Write as _;

use gsk_core::axis::AxisChain;
use gsk_core::battery::BatteryMemory;
use gsk_core::cnc::ControlRequest;
use gsk_core::machine::{LatheConfig, ServoConfig};
use gsk_core::memory::{ControlParameters, PitchTable};
use gsk_core::operation::RunState;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::{Axis, PerAxis, Point};

/// A random number generator (Knuth's linear congruential generator).
struct PulseRandom(u64);

impl PulseRandom {
    fn below(&mut self, bound: i64) -> i64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        i64::try_from(self.0 >> 33).unwrap_or(0) % bound
    }

    fn between(&mut self, low: i64, high: i64) -> i64 {
        low + self.below(high - low + 1)
    }
}

/// The settings of an axis, and its expected pulses: integers, straight from the manual. X
/// counts half thousandths.
struct AxisModel {
    per_thousandth: i64,
    gear: (i64, i64),
    reversed: bool,
    backlash: i64,
    first_negative: bool,
    points: [i64; 256],
    origin: i64,
    interval: i64,
    at: i64,
    negative: bool,
}

impl AxisModel {
    /// The pitch error from point to point between the reference and here.
    fn pitch(&self) -> i64 {
        let point = |number: i64| {
            let place = usize::try_from(number).unwrap_or(0);
            self.points.get(place).copied().unwrap_or(0)
        };
        let passed = self.at.abs() / self.interval;
        let reach = |number: i64| number.clamp(0, 255);
        let sum: i64 = if self.at >= 0 {
            (self.origin + 1..=reach(self.origin + passed))
                .map(point)
                .sum()
        } else {
            -(reach(self.origin - passed) + 1..=self.origin)
                .map(point)
                .sum::<i64>()
        };
        sum * self.per_thousandth
    }

    fn go(&mut self, to: i64) {
        if to != self.at {
            self.negative = to < self.at;
        }
        self.at = to;
    }

    fn pulses(&self, from: i64, from_pitch: i64) -> i64 {
        let backlash = match (self.negative, self.first_negative) {
            (true, false) => -self.backlash,
            (false, true) => self.backlash,
            _ => 0,
        };
        let increments = self.at - from + self.pitch() - from_pitch + backlash;
        let geared = increments * self.gear.0 / self.gear.1;
        if self.reversed { -geared } else { geared }
    }

    fn mm(&self) -> f64 {
        self.at as f64 / (1000 * self.per_thousandth) as f64
    }
}

struct PulseMachine {
    parameters: ControlParameters,
    table: PitchTable,
    models: PerAxis<AxisModel>,
}

fn random_machine(random: &mut PulseRandom, gears: bool) -> PulseMachine {
    const GEARS: [(i64, i64); 8] = [
        (1, 1),
        (2, 1),
        (1, 2),
        (3, 7),
        (1, 5),
        (127, 126),
        (5, 127),
        (100, 3),
    ];
    let mut parameters = ControlParameters::default();
    let mut table = PitchTable::default();
    let mut set = |number: u16, value: i64| {
        let value = i32::try_from(value).unwrap_or(0);
        assert!(parameters.set(number, value).is_ok(), "{number} {value}");
    };
    let first = random.below(4);
    let motors = random.below(4);
    set(6, first);
    set(8, 4 + motors);
    set(11, 0x82 - 0x80 * random.below(2));
    set(10, random.below(16));
    let mut model = |axis: Axis, offset: u16, per_thousandth: i64| {
        let gear = if gears {
            GEARS[usize::try_from(random.below(8)).unwrap_or(0)]
        } else {
            (1, 1)
        };
        let (multiply, divide) = gear;
        let backlash = random.below(60);
        let origin = random.between(0, 255);
        let interval = random.between(500, 20_000);
        for (number, value) in [
            (15, multiply),
            (17, divide),
            (34, backlash),
            (98, origin),
            (102, interval),
        ] {
            set(number + offset, value);
        }
        let mut points = [0; 256];
        for (number, value) in (0..=255u8).zip(&mut points) {
            *value = random.between(-20, 20);
            let kept = table.set(axis, number, i16::try_from(*value).unwrap_or(0));
            assert_eq!(kept, Ok(()));
        }
        let first_negative = first >> offset & 1 == 1;
        AxisModel {
            per_thousandth,
            gear,
            reversed: motors >> offset & 1 == 0,
            backlash: backlash * per_thousandth,
            first_negative,
            points,
            origin,
            interval: interval * per_thousandth,
            at: 0,
            negative: first_negative,
        }
    };
    let models = PerAxis::new(model(Axis::X, 0, 2), model(Axis::Z, 1, 1));
    PulseMachine {
        parameters,
        table,
        models,
    }
}

/// Every move ends on its pulse, wherever it came from: no error accumulates.
#[test]
fn pulses_are_exact_after_random_moves() {
    const MACHINES: u32 = 20;
    let moves = std::env::var("PULSE_MOVES")
        .ok()
        .and_then(|moves| moves.parse().ok())
        .unwrap_or(1_000_000u32);
    let free = PerAxis::new(false, false);
    let mut random = PulseRandom(980);
    for _ in 0..MACHINES {
        let mut machine = random_machine(&mut random, true);
        let mut chain = AxisChain::new(&machine.parameters, &machine.table);
        let mut compared = 0;
        for number in 0..moves / MACHINES {
            let models = &mut machine.models;
            let from = Point::new(models.x.mm(), models.z.mm());
            let reach = if number % 4 == 0 { 300_000 } else { 40 };
            let x = models.x.at + random.between(-reach, reach);
            let z = models.z.at + random.between(-reach, reach);
            models.x.go(x.clamp(-400_000, 400_000));
            models.z.go(z.clamp(-400_000, 400_000));
            let to = Point::new(models.x.mm(), models.z.mm());
            // One tick or two of motion, then at the end point.
            chain.advance(from + (to - from) * 0.4, free);
            chain.advance(to, free);
            if number % 1000 == 0 {
                while chain.is_settling() {
                    chain.advance(to, free);
                }
            }
            if !chain.is_settling() {
                let pulses = chain.pulses();
                compared += 1;
                assert_eq!(pulses.x.0, models.x.pulses(0, 0), "X in move {number}");
                assert_eq!(pulses.z.0, models.z.pulses(0, 0), "Z in move {number}");
            }
        }
        assert!(compared >= moves / MACHINES / 1000, "{compared}");
    }
}

/// The same through programs, with rapids and cuts in all directions.
#[test]
fn programs_end_on_the_pulse() {
    let mut random = PulseRandom(5);
    for _ in 0..4 {
        let mut machine = random_machine(&mut random, false);
        let mut text = String::from("O1;\nG98;\n");
        let start = Point::new(150.0, 300.0);
        machine.models.x.at = 300_000;
        machine.models.z.at = 300_000;
        let from = (machine.models.x.pitch(), machine.models.z.pitch());
        for number in 0..80 {
            let (x, z) = (
                random.between(290_000, 310_000),
                random.between(290_000, 310_000),
            );
            machine.models.x.go(x);
            machine.models.z.go(z);
            let code = if number % 3 == 0 { "G00" } else { "G01" };
            let (x, z) = (x as f64 / 1000.0, z as f64 / 1000.0);
            let _ = writeln!(text, "{code} X{x:.3} Z{z:.3} F6000;");
        }
        text.push_str("G04 X3;\nM30;\n");
        let setup = Setup {
            memory: BatteryMemory {
                parameters: machine.parameters,
                pitch: machine.table,
                ..BatteryMemory::default()
            },
            start: Some(start),
            ..Setup::default()
        };
        let simulation = run_program(setup, &text);
        let pulses = simulation.cnc.pulses();
        let models = &machine.models;
        assert_eq!(pulses.x.0, models.x.pulses(300_000, from.0));
        assert_eq!(pulses.z.0, models.z.pulses(300_000, from.1));
    }
}

fn run_program(setup: Setup, text: &str) -> Simulation {
    let mut simulation = Simulation::new(setup);
    let request = ControlRequest::OpenExternal(Program::new(text));
    assert_eq!(simulation.cnc.request(request), Ok(()));
    simulation.start_automatic();
    for _ in 0..600_000 {
        simulation.tick();
        assert_eq!(simulation.cnc.alarms(), []);
        if simulation.cnc.run_state() != RunState::Run {
            return simulation;
        }
    }
    panic!("no end of\n{text}");
}

/// A screw with 0.04 mm of backlash. Without 035 the slide is off by the backlash after a
/// reversal. With it the slide is at its commanded position, with servos too.
#[test]
fn compensation_makes_up_for_the_play_of_the_screw() {
    let text = "O1;\nG98 G01 W10 F2000;\nW-4;\nG04 X1;\nM30;\n";
    let position_error = |value: i32, servo: Option<ServoConfig>| {
        let mut setup = Setup::default();
        assert!(setup.memory.parameters.set(35, value).is_ok());
        let mut lathe = LatheConfig::without_limits();
        lathe.z.backlash = 0.04;
        lathe.z.servo = servo;
        setup.lathe = lathe;
        let simulation = run_program(setup, text);
        (simulation.lathe.slide_position().z - 306.0) * 1000.0
    };
    assert_eq!(position_error(0, None).round(), 40.0);
    assert_eq!(position_error(40, None).round(), 0.0);
    assert_eq!(position_error(25, None).round(), 15.0);
    assert_eq!(
        position_error(40, Some(ServoConfig::default())).round(),
        0.0
    );
}
