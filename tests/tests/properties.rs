//! Runs random legal programs through the full kernel: no NaN, no axis faster than allowed,
//! every end point where the words put it.
//!
//! `PROPTEST_CASES=2000 cargo test -p gsk980td-tests --test subjects properties` runs more.

use std::fmt::Write as _;

use gsk_core::cnc::{Cnc, Event};
use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::preview::preview;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::{Feed, Point};
use gsk_tests::setup;
use proptest::prelude::*;

/// Factory parameters 022, 023 and 027, mm/min; X is a radius rate.
const RAPID: (f64, f64) = (3800.0, 7600.0);
const FEED_LIMIT: f64 = 8000.0;

const AUTO: BitAddress = BitAddress::new(Area::X, 20, 1);
const CYCLE_START: BitAddress = BitAddress::new(Area::X, 25, 0);
const FEED_DOWN: BitAddress = BitAddress::new(Area::X, 24, 6);
const RAPID_DOWN: BitAddress = BitAddress::new(Area::X, 24, 5);

/// One block or two, in thousandths of a millimetre; X as a diameter.
#[derive(Clone, Debug)]
enum ProgramStep {
    Go {
        x: Option<i64>,
        z: Option<i64>,
        incremental: bool,
        rapid: bool,
        feed: i64,
    },
    ArcByR {
        du: i64,
        dw: i64,
        slack: i64,
        clockwise: bool,
        feed: i64,
    },
    Circle {
        i: i64,
        k: i64,
        clockwise: bool,
        feed: i64,
    },
    Turning {
        u: i64,
        w: i64,
        r: i64,
        facing: bool,
        feed: i64,
    },
    Dwell {
        ms: i64,
    },
    Zero {
        x: i64,
        z: i64,
    },
    Offset {
        number: i64,
    },
}

fn any_step() -> impl Strategy<Value = ProgramStep> {
    let feed = || 300..9000i64;
    let go = (
        proptest::option::of(-100_000..300_000i64),
        proptest::option::of(-150_000..150_000i64),
        any::<bool>(),
        any::<bool>(),
        feed(),
    );
    prop_oneof![
        4 => go.prop_map(|(x, z, incremental, rapid, feed)| ProgramStep::Go { x, z, incremental, rapid, feed }),
        2 => (-40_000..40_000i64, -40_000..40_000i64, 0..30_000i64, any::<bool>(), feed())
            .prop_map(|(du, dw, slack, clockwise, feed)| ProgramStep::ArcByR { du, dw, slack, clockwise, feed }),
        1 => (-15_000..15_000i64, -15_000..15_000i64, any::<bool>(), feed())
            .prop_map(|(i, k, clockwise, feed)| ProgramStep::Circle { i, k, clockwise, feed }),
        1 => (1..40_000i64, 1..40_000i64, -20_000..20_000i64, any::<bool>(), feed())
            .prop_map(|(u, w, r, facing, feed)| ProgramStep::Turning { u, w, r, facing, feed }),
        1 => (0..400i64).prop_map(|ms| ProgramStep::Dwell { ms }),
        1 => (-200_000..200_000i64, -200_000..200_000i64).prop_map(|(x, z)| ProgramStep::Zero { x, z }),
        1 => (0..3i64).prop_map(|number| ProgramStep::Offset { number }),
    ]
}

/// A program with its expected end point.
#[derive(Debug)]
struct ExpectedPart {
    text: String,
    /// Absolute end point: X as a diameter, Z, thousandths.
    end: (i64, i64),
    /// Machine end point, in the same form.
    machine: (i64, i64),
}

/// Offsets 01 and 02: X, Z, thousandths.
const OFFSETS: [(i64, i64); 3] = [(0, 0), (1_200, -3_400), (-20_000, 15_500)];

fn format_mm(thousandths: i64) -> String {
    let sign = if thousandths < 0 { "-" } else { "" };
    let value = thousandths.unsigned_abs();
    format!("{sign}{}.{:03}", value / 1000, value % 1000)
}

fn build_part(steps: &[ProgramStep]) -> ExpectedPart {
    let start = (300_000, 300_000);
    let mut text = "O0001;\n".to_owned();
    // `shift` = machine minus absolute.
    let (mut at, mut shift, mut offset) = (start, (0, 0), 0usize);
    for step in steps {
        match *step {
            ProgramStep::Go {
                x,
                z,
                incremental,
                rapid,
                feed,
            } => {
                text += if rapid { "G00" } else { "G01" };
                if let Some(x) = x {
                    let (letter, value) = if incremental { ("U", x / 2) } else { ("X", x) };
                    let _ = write!(text, " {letter}{}", format_mm(value));
                    at.0 = if incremental { at.0 + x / 2 } else { x };
                }
                if let Some(z) = z {
                    let (letter, value) = if incremental { ("W", z / 2) } else { ("Z", z) };
                    let _ = write!(text, " {letter}{}", format_mm(value));
                    at.1 = if incremental { at.1 + z / 2 } else { z };
                }
                let _ = writeln!(text, " F{feed};");
            }
            ProgramStep::ArcByR {
                du,
                dw,
                slack,
                clockwise,
                feed,
            } => {
                let chord = ((du as f64 / 2.0).powi(2) + (dw as f64).powi(2)).sqrt();
                let radius = (chord / 2.0).ceil() as i64 + 1 + slack;
                let code = if clockwise { "G02" } else { "G03" };
                let _ = writeln!(
                    text,
                    "{code} U{} W{} R{} F{feed};",
                    format_mm(du),
                    format_mm(dw),
                    format_mm(radius)
                );
                at = (at.0 + du, at.1 + dw);
            }
            ProgramStep::Circle {
                i,
                k,
                clockwise,
                feed,
            } => {
                let code = if clockwise { "G02" } else { "G03" };
                // A circle without radius is invalid.
                let i = if i == 0 && k == 0 { 1000 } else { i };
                let _ = writeln!(text, "{code} I{} K{} F{feed};", format_mm(i), format_mm(k));
            }
            ProgramStep::Turning {
                u,
                w,
                r,
                facing,
                feed,
            } => {
                // |R| within the limit for either sign.
                let r = if facing { r % w } else { r % (u / 2).max(1) };
                let code = if facing { "G94" } else { "G90" };
                let (u, w, r) = (format_mm(-u), format_mm(-w), format_mm(r));
                let _ = writeln!(text, "{code} U{u} W{w} R{r} F{feed};\nG01;");
            }
            ProgramStep::Dwell { ms } => {
                let _ = writeln!(text, "G04 P{ms};");
            }
            ProgramStep::Zero { x, z } => {
                let machine = (at.0 + shift.0, at.1 + shift.1);
                shift = (machine.0 - x, machine.1 - z);
                at = (x, z);
                let _ = writeln!(text, "G50 X{} Z{};", format_mm(x), format_mm(z));
            }
            ProgramStep::Offset { number } => {
                let new = number as usize;
                let change = (
                    OFFSETS[new].0 - OFFSETS[offset].0,
                    OFFSETS[new].1 - OFFSETS[offset].1,
                );
                offset = new;
                // The offset is executed with the motion of its block, to the same absolute
                // point.
                let _ = writeln!(
                    text,
                    "T01{number:02} G00 X{} Z{};",
                    format_mm(at.0),
                    format_mm(at.1)
                );
                shift = (shift.0 + change.0, shift.1 + change.1);
            }
        }
    }
    text += "M30;\n";
    ExpectedPart {
        text,
        end: at,
        machine: (at.0 + shift.0, at.1 + shift.1),
    }
}

fn start(part: &ExpectedPart) -> Setup {
    let mut start = Setup::default();
    start.memory.programs = setup::build_memory(std::slice::from_ref(&part.text)).expect("program");
    for (number, (x, z)) in OFFSETS.into_iter().enumerate().skip(1) {
        let row = gsk_core::memory::ToolOffset {
            x: x as f64 / 1000.0,
            z: z as f64 / 1000.0,
            ..Default::default()
        };
        start.memory.offsets.set(number as u8, row).expect("offset");
    }
    start
}

fn diameter_z(point: Point) -> (f64, f64) {
    (point.diameter().0 * 1000.0, point.z * 1000.0)
}

fn assert_at(name: &str, seen: Point, expected: (i64, i64)) -> Result<(), TestCaseError> {
    let (x, z) = diameter_z(seen);
    let near = (x - expected.0 as f64).abs() < 0.01 && (z - expected.1 as f64).abs() < 0.01;
    prop_assert!(near, "{name}: {expected:?} expected, ({x}, {z}) seen");
    Ok(())
}

/// Length of a move, mm of path.
fn path_length(executed: &ExecutedMove) -> f64 {
    let chord = executed.to - executed.from;
    let Some(center) = executed.center else {
        return chord.length();
    };
    let (a, b) = (executed.from - center, executed.to - center);
    let turned = (b.x.atan2(b.z) - a.x.atan2(a.z)).rem_euclid(core::f64::consts::TAU);
    let turned = match executed.kind {
        _ if chord == Point::default() => core::f64::consts::TAU,
        MoveKind::Clockwise => core::f64::consts::TAU - turned,
        _ => turned,
    };
    turned * a.length()
}

/// Checks that no move was faster than allowed, on average over its length.
fn assert_rate(executed: &ExecutedMove, feed: f64, rapid: f64) -> Result<(), TestCaseError> {
    let seconds = executed.duration_s;
    let way = executed.to - executed.from;
    let least = match (executed.kind, executed.feed) {
        (MoveKind::Rapid, _) => {
            (way.x.abs() / (RAPID.0 * rapid)).max(way.z.abs() / (RAPID.1 * rapid)) * 60.0
        }
        (MoveKind::Dwell, _) => 0.0,
        (_, Some(Feed::PerMinute(rate))) => {
            path_length(executed) / (rate * feed).min(FEED_LIMIT) * 60.0
        }
        (kind, feed) => panic!("{kind:?} with {feed:?}"),
    };
    prop_assert!(
        seconds >= least * 0.999_9 - 1e-6,
        "{executed:?} takes at least {least} s"
    );
    Ok(())
}

/// Checks that the preview and the kernel make the same moves; without overrides they take the
/// same time.
fn assert_same(
    previewed: &[ExecutedMove],
    executed: &[ExecutedMove],
    timed: bool,
) -> Result<(), TestCaseError> {
    let real = |executed: &&ExecutedMove| {
        executed.center.is_some() || executed.from != executed.to || executed.duration_s > 0.0
    };
    let previewed: Vec<_> = previewed.iter().filter(real).collect();
    let executed: Vec<_> = executed.iter().filter(real).collect();
    prop_assert_eq!(previewed.len(), executed.len());
    for (a, b) in previewed.into_iter().zip(executed) {
        let near = |a: Point, b: Point| (a - b).length() < 1e-6;
        let alike = (a.source, a.kind, a.feed) == (b.source, b.kind, b.feed)
            && near(a.from, b.from)
            && near(a.to, b.to)
            && match (a.center, b.center) {
                (Some(a), Some(b)) => near(a, b),
                (a, b) => a == b,
            };
        prop_assert!(alike, "preview: {a:?}\nkernel: {b:?}");
        let late = (a.duration_s - b.duration_s).abs();
        let slack = 0.002 + 0.005 * b.duration_s;
        prop_assert!(!timed || late <= slack, "{late} s between {a:?} and {b:?}");
    }
    Ok(())
}

struct RunRecord {
    simulation: Simulation,
    moves: Vec<ExecutedMove>,
    blocks: u64,
}

/// Runs a program to its end with overrides turned down and records every tick.
fn run_recorded(
    start: &Setup,
    feed_down: u32,
    rapid_down: u32,
    limits: (f64, f64),
) -> Result<RunRecord, TestCaseError> {
    let mut simulation = Simulation::new(start.clone());
    // The ladder sees the edge of a key only after its first scan.
    (0..100).for_each(|_| simulation.tick());
    for (key, times) in [(FEED_DOWN, feed_down), (RAPID_DOWN, rapid_down)] {
        for _ in 0..times {
            for down in [true, false] {
                simulation.cnc.set_panel_key(key, down);
                (0..100).for_each(|_| simulation.tick());
            }
        }
    }
    simulation.cnc.set_panel_key(AUTO, true);
    (0..100).for_each(|_| simulation.tick());
    simulation.cnc.set_panel_key(AUTO, false);
    simulation.cnc.set_panel_key(CYCLE_START, true);
    (0..100).for_each(|_| simulation.tick());
    // The run begins when the key is released.
    simulation.cnc.set_panel_key(CYCLE_START, false);
    let mut ended = false;
    let mut moves = Vec::new();
    let mut blocks = 0;
    let mut before = simulation.cnc.position_machine();
    for _ in 0..3_600_000 {
        simulation.tick();
        let cnc: &Cnc = &simulation.cnc;
        let now = cnc.position_machine();
        prop_assert!(now.x.is_finite() && now.z.is_finite());
        let way = now - before;
        let (x, z) = (way.x.abs() * 60_000.0, way.z.abs() * 60_000.0);
        prop_assert!(
            x <= limits.0 * 1.000_1 + 1e-6,
            "X at {x} mm/min, limit {}",
            limits.0
        );
        prop_assert!(
            z <= limits.1 * 1.000_1 + 1e-6,
            "Z at {z} mm/min, limit {}",
            limits.1
        );
        before = now;
        for event in cnc.events() {
            match event {
                Event::MoveEnded(executed) => moves.push(*executed),
                Event::BlockEnded(_) => blocks += 1,
                Event::AlarmRaised(alarm) => prop_assert!(false, "{}", alarm.line_text()),
                _ => {}
            }
        }
        ended |= cnc
            .events()
            .iter()
            .any(|event| matches!(event, Event::ProgramEnded { .. }));
        if ended && !cnc.is_moving() {
            return Ok(RunRecord {
                simulation,
                moves,
                blocks,
            });
        }
    }
    prop_assert!(false, "no end within an hour");
    unreachable!()
}

fn config() -> ProptestConfig {
    let cases = std::env::var("PROPTEST_CASES")
        .ok()
        .and_then(|cases| cases.parse().ok());
    ProptestConfig {
        cases: cases.unwrap_or(48),
        failure_persistence: None,
        max_shrink_iters: 400,
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn programs_end_where_the_words_say(
        steps in proptest::collection::vec(any_step(), 1..14),
        feed_down in 0..6u32,
        rapid_down in 0..3u32,
    ) {
        let part = build_part(&steps);
        let start = start(&part);
        let feed = 1.0 - 0.1 * f64::from(feed_down);
        let rapid = [1.0, 0.5, 0.25][rapid_down as usize];
        let cut = (9000.0 * feed).min(FEED_LIMIT);
        let limits = ((RAPID.0 * rapid).max(cut), (RAPID.1 * rapid).max(cut));
        let watched = run_recorded(&start, feed_down, rapid_down, limits)
            .map_err(|error| TestCaseError::fail(format!("{error}\n{}", part.text)))?;
        let cnc = &watched.simulation.cnc;
        assert_at("absolute", cnc.position_absolute(), part.end)?;
        assert_at("machine", cnc.position_machine(), part.machine)?;
        for executed in watched.moves.iter().filter(|executed| path_length(executed) > 0.0) {
            assert_rate(executed, feed, rapid)?;
        }
        let mut previewed = Vec::new();
        let seen = preview(&start, &start.memory.programs, &mut |executed| previewed.push(*executed));
        assert_same(&previewed, &watched.moves, feed_down + rapid_down == 0)?;
        assert_at("preview", seen.absolute, part.end)?;
        assert_at("preview, machine", seen.machine, part.machine)?;
        prop_assert_eq!(seen.alarm, None);
        prop_assert_eq!(seen.blocks, watched.blocks);
    }

    #[test]
    fn cuts_never_exceed_their_feed_in_any_tick(
        ends in proptest::collection::vec((0..60_000i64, -60_000..0i64), 1..8),
        feed in 200..8000i64,
    ) {
        let mut text = format!("O0001;\nG50 X30 Z0;\nG01 F{feed};\n");
        for (x, z) in &ends {
            let _ = writeln!(text, "X{} Z{};", format_mm(*x), format_mm(*z));
        }
        text += "M30;\n";
        let part = ExpectedPart { text, end: ends[ends.len() - 1], machine: (0, 0) };
        let start = start(&part);
        let mut simulation = Simulation::new(start);
        simulation.start_automatic();
        let mut before = simulation.cnc.position_machine();
        while simulation.cnc.run_state() == RunState::Run {
            simulation.tick();
            let now = simulation.cnc.position_machine();
            let rate = (now - before).length() * 60_000.0;
            prop_assert!(rate <= feed as f64 * 1.000_1 + 1e-6, "{rate} mm/min at F{feed}");
            before = now;
        }
        assert_at("absolute", simulation.cnc.position_absolute(), part.end)?;
    }

    #[test]
    fn arcs_stay_on_their_circle(
        i in -30_000..30_000i64,
        k in -30_000..30_000i64,
        clockwise in any::<bool>(),
        feed in 200..8000i64,
    ) {
        prop_assume!(i != 0 || k != 0);
        let code = if clockwise { "G02" } else { "G03" };
        let text = format!("O0001;\n{code} I{} K{} F{feed};\nM30;\n", format_mm(i), format_mm(k));
        let part = ExpectedPart { text, end: (300_000, 300_000), machine: (300_000, 300_000) };
        let mut simulation = Simulation::new(start(&part));
        simulation.start_automatic();
        let center = Point::new(150.0 + i as f64 / 1000.0, 300.0 + k as f64 / 1000.0);
        let radius = (Point::new(150.0, 300.0) - center).length();
        while simulation.cnc.run_state() == RunState::Run {
            simulation.tick();
            let off = (simulation.cnc.position_machine() - center).length() - radius;
            prop_assert!(off.abs() <= 1e-6, "{off} mm off the circle of {radius}");
        }
        assert_at("machine", simulation.cnc.position_machine(), part.machine)?;
    }
}
