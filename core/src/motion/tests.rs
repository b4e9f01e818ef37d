//! Property tests of the interpolator over random moves, and tests of the figures of the speed
//! laws.

use proptest::prelude::*;

use super::ramp::{Ramp, SpeedLaw};
use super::*;
use crate::command::MoveKind;
use crate::memory::ControlParameters;
use crate::units::{Axis, Feed, Point, TICK_S};

/// Mean speed along the path in the last tick, mm/min.
fn speed(interpolator: &Interpolator) -> f64 {
    interpolator.velocity().length() * 60.0
}

fn limits() -> MotionLimits {
    MotionLimits::from(&ControlParameters::default())
}

/// Generates limits from random parameters over their whole ranges.
fn any_limits() -> impl Strategy<Value = MotionLimits> {
    (
        (6i32..15_000, 6i32..15_000, 8i32..4000, 8i32..4000),
        (
            6i32..15_000,
            prop_oneof![Just(0), 1i32..400],
            prop_oneof![Just(0), 1i32..8000],
        ),
    )
        .prop_map(
            |((rapid_x, rapid_z, time_x, time_z), (top, time, lowest))| {
                let mut parameters = ControlParameters::default();
                let values = [
                    (22, rapid_x),
                    (23, rapid_z),
                    (24, time_x),
                    (25, time_z),
                    (27, top),
                    (29, time),
                    (30, lowest),
                ];
                for (number, value) in values {
                    parameters.set(number, value).unwrap();
                }
                MotionLimits::from(&parameters)
            },
        )
}

/// A random block for the property tests.
#[derive(Clone, Copy, Debug)]
enum RandomBlock {
    Rapid(Point),
    Line(Point, f64),
    /// Angle of the centre, rad; radius, mm; angle swept, rad (positive counter-clockwise); feed,
    /// mm/min.
    Arc(f64, f64, f64, f64),
}

fn any_point() -> impl Strategy<Value = Point> {
    (-40_000i32..40_000, -40_000i32..40_000)
        .prop_map(|(x, z)| Point::new(f64::from(x) / 2000.0, f64::from(z) / 1000.0))
}

fn any_block() -> impl Strategy<Value = RandomBlock> {
    prop_oneof![
        any_point().prop_map(RandomBlock::Rapid),
        (any_point(), 1.0..12_000.0).prop_map(|(to, feed)| RandomBlock::Line(to, feed)),
        (0.0..6.2f64, 0.05..30.0f64, -6.2..6.2f64, 50.0..9000.0).prop_map(
            |(angle, radius, sweep, feed)| {
                let sweep = if sweep.abs() < 0.01 { 0.01 } else { sweep };
                RandomBlock::Arc(angle, radius, sweep, feed)
            }
        ),
    ]
}

/// A started block: kind, start, end, centre and feed.
struct StartedBlock {
    kind: MoveKind,
    from: Point,
    to: Point,
    center: Option<Point>,
    feed: f64,
}

fn point_on_circle(center: Point, radius: f64, angle: f64) -> Point {
    center + Point::new(libm::sin(angle) * radius, libm::cos(angle) * radius)
}

fn start_block(interpolator: &mut Interpolator, block: RandomBlock) -> StartedBlock {
    let from = interpolator.position();
    match block {
        RandomBlock::Rapid(to) => {
            interpolator.start_rapid(to, &limits());
            StartedBlock {
                kind: MoveKind::Rapid,
                from,
                to,
                center: None,
                feed: 0.0,
            }
        }
        RandomBlock::Line(to, feed) => {
            interpolator.start_line(to, Feed::PerMinute(feed));
            StartedBlock {
                kind: MoveKind::Feed,
                from,
                to,
                center: None,
                feed,
            }
        }
        RandomBlock::Arc(angle, radius, sweep, feed) => {
            let center = point_on_circle(from, -radius, angle);
            let to = point_on_circle(center, radius, angle + sweep);
            let clockwise = sweep < 0.0;
            interpolator.start_arc(to, center, clockwise, Feed::PerMinute(feed));
            let kind = if clockwise {
                MoveKind::Clockwise
            } else {
                MoveKind::CounterClockwise
            };
            StartedBlock {
                kind,
                from,
                to,
                center: Some(center),
                feed,
            }
        }
    }
}

fn expected_duration(begun: &StartedBlock, limits: &MotionLimits) -> f64 {
    let (displacement, kind) = (begun.to - begun.from, begun.kind);
    let length = path_length(kind, begun.from, begun.to, begun.center);
    move_duration(kind, displacement, length, begun.feed, limits)
}

/// Checks the speeds of a tick against the limits of the block.
fn check_speed(interpolator: &Interpolator, begun: &StartedBlock, limits: &MotionLimits) {
    let velocity = interpolator.velocity();
    assert!(velocity.x.is_finite() && velocity.z.is_finite());
    if begun.kind == MoveKind::Rapid {
        for axis in [Axis::X, Axis::Z] {
            let rate = velocity.get(axis).abs() * 60.0;
            assert!(
                rate <= limits.rapid_rate(axis) + 1e-6,
                "{axis:?} at {rate} mm/min"
            );
        }
    } else {
        let rate = speed(interpolator);
        let limit = begun.feed.min(limits.cutting_rate());
        assert!(rate <= limit + 1e-6, "{rate} of {limit} mm/min");
    }
}

/// Checks that the distance of the commanded position from the programmed path is far below 0.001
/// mm.
fn check_path(position: Point, begun: &StartedBlock) {
    if let Some(center) = begun.center {
        let off = (position - center).length() - (begun.from - center).length();
        assert!(off.abs() < 1e-6, "{off} mm off the circle");
    } else if begun.kind != MoveKind::Rapid {
        let (displacement, travelled) = (begun.to - begun.from, position - begun.from);
        let off = (displacement.x * travelled.z - displacement.z * travelled.x)
            / displacement.length().max(1e-9);
        assert!(off.abs() < 1e-6, "{off} mm off the line");
    }
}

const TICKS_MAX: u32 = 4_000_000;

proptest! {
    #[test]
    fn single_blocks_keep_path_speed_end_and_time(block in any_block(), limits in any_limits()) {
        let inputs = MotionInputs::default();
        let mut interpolator = Interpolator::new(Point::new(3.25, -7.5));
        let begun = start_block(&mut interpolator, block);
        let mut ticks = 0;
        while !interpolator.is_finished() && ticks < TICKS_MAX {
            let position = interpolator.tick(&limits, &inputs);
            check_speed(&interpolator, &begun, &limits);
            check_path(position, &begun);
            ticks += 1;
        }
        prop_assert_eq!(interpolator.position(), begun.to);
        let expected = expected_duration(&begun, &limits);
        let ticked = f64::from(ticks) * TICK_S;
        prop_assert!((ticked - expected).abs() < 0.0015, "{} s instead of {}", ticked, expected);
    }

    /// Blocks chained within the tick: no end point is missed, no time is lost, no limit is
    /// exceeded.
    #[test]
    fn chains_lose_neither_time_nor_position(
        blocks in prop::collection::vec(any_block(), 2..12),
        short in any::<bool>(),
        at_once in any::<bool>(),
        limits in any_limits(),
    ) {
        let inputs = MotionInputs::default();
        let mut interpolator = Interpolator::new(Point::default());
        let mut expected = 0.0;
        let mut shortest = f64::INFINITY;
        let mut ticks = 0;
        let scale = if short { 0.001 } else { 1.0 };
        for block in blocks {
            let block = match block {
                RandomBlock::Rapid(to) => RandomBlock::Rapid(to * scale),
                RandomBlock::Line(to, feed) => RandomBlock::Line(to * scale, feed),
                arc @ RandomBlock::Arc(..) => arc,
            };
            let begun = start_block(&mut interpolator, block);
            let time = expected_duration(&begun, &limits);
            expected += time;
            shortest = time.min(shortest);
            if at_once {
                interpolator.continue_tick(&limits, &inputs);
            }
            while !interpolator.is_finished() && ticks < TICKS_MAX {
                interpolator.tick(&limits, &inputs);
                ticks += 1;
            }
            prop_assert_eq!(interpolator.position(), begun.to);
        }
        // Blocks started tick by tick take at least one tick each.
        if at_once || shortest > 2.0 * TICK_S {
            let ticked = f64::from(ticks) * TICK_S;
            prop_assert!((ticked - expected).abs() < 0.0015, "{} s instead of {}", ticked, expected);
        }
    }

    /// Holds, resumes and overrides at any moment do not change path and end point.
    #[test]
    fn holds_and_overrides_keep_the_path(
        block in any_block(),
        events in prop::collection::vec((1u32..400, any::<bool>(), 0u8..=15, 0u8..=4), 1..30),
    ) {
        let limits = limits();
        let mut inputs = MotionInputs::default();
        let mut interpolator = Interpolator::new(Point::default());
        let begun = start_block(&mut interpolator, block);
        let path = path_length(begun.kind, begun.from, begun.to, begun.center);
        let mut travelled = 0.0;
        let mut tick = |interpolator: &mut Interpolator, inputs: &MotionInputs| {
            let before = interpolator.position();
            let position = interpolator.tick(&limits, inputs);
            assert!(position.x.is_finite() && position.z.is_finite());
            travelled += (position - before).length();
            check_path(position, &begun);
            if begun.kind != MoveKind::Rapid {
                assert!(speed(interpolator) <= limits.cutting_rate() + 1e-6);
            }
        };
        for (ticks, hold, feed, rapid) in events {
            inputs.hold = hold;
            inputs.feed_override = f64::from(feed) / 10.0;
            inputs.rapid_override = RapidOverride::from_percent(25 * rapid);
            for _ in 0..ticks {
                tick(&mut interpolator, &inputs);
            }
        }
        inputs = MotionInputs::default();
        for _ in 0..TICKS_MAX {
            if interpolator.is_finished() {
                break;
            }
            tick(&mut interpolator, &inputs);
        }
        prop_assert_eq!(interpolator.position(), begun.to);
        if begun.kind != MoveKind::Rapid {
            prop_assert!(travelled <= path + 1e-6, "{} mm of {}", travelled, path);
        }
    }

    /// Steps and turns of the handwheel in both directions end at their sum.
    #[test]
    fn steps_add_up(steps in prop::collection::vec((-200i32..200, 1u32..120), 1..20)) {
        let limits = limits();
        let inputs = MotionInputs::default();
        let mut interpolator = Interpolator::new(Point::default());
        let mut sum = 0.0;
        for (thousandths, ticks) in steps {
            let distance = f64::from(thousandths) / 1000.0;
            sum += distance;
            interpolator.start_step(Axis::Z, distance, JogRate::Feed(1260.0));
            for _ in 0..ticks {
                interpolator.tick(&limits, &inputs);
            }
        }
        for _ in 0..100_000 {
            interpolator.tick(&limits, &inputs);
        }
        prop_assert!(!interpolator.is_stepping(Axis::Z) && !interpolator.is_moving());
        prop_assert!((interpolator.position().z - sum).abs() < 1e-9);
    }
}

/// Runs ticks until nothing moves. Returns the distance of the axes and the number of
/// ticks.
fn run_to_standstill(interpolator: &mut Interpolator, inputs: &MotionInputs) -> (Point, u32) {
    let from = interpolator.position();
    let mut ticks = 0;
    while interpolator.is_moving() && ticks < TICKS_MAX {
        interpolator.tick(&limits(), inputs);
        ticks += 1;
    }
    (interpolator.position() - from, ticks)
}

fn ticks(interpolator: &mut Interpolator, inputs: &MotionInputs, count: u32) {
    for _ in 0..count {
        interpolator.tick(&limits(), inputs);
    }
}

#[test]
fn a_rapid_takes_distance_over_rate_plus_time_constant() {
    // Z 100 mm at 7600 mm/min with 300 ms.
    let limits = limits();
    let displacement = Point::new(0.0, 100.0);
    let time = move_duration(
        MoveKind::Rapid,
        displacement,
        displacement.length(),
        0.0,
        &limits,
    );
    assert!((time - (100.0 / (7600.0 / 60.0) + 0.3)).abs() < 1e-12);
}

#[test]
fn the_axes_of_a_rapid_do_not_wait_for_each_other() {
    let mut interpolator = Interpolator::new(Point::default());
    interpolator.start_rapid(Point::new(10.0, 100.0), &limits());
    ticks(&mut interpolator, &MotionInputs::default(), 500);
    assert_eq!(interpolator.position().x, 10.0);
    assert!(interpolator.position().z < 90.0 && !interpolator.is_finished());
}

#[test]
fn a_cut_starts_at_the_lowest_speed_and_approaches_the_feed() {
    let mut interpolator = Interpolator::new(Point::default());
    interpolator.start_line(Point::new(0.0, -50.0), Feed::PerMinute(600.0));
    ticks(&mut interpolator, &MotionInputs::default(), 1);
    assert!(speed(&interpolator) > 10.0 && speed(&interpolator) < 20.0);
    ticks(&mut interpolator, &MotionInputs::default(), 99);
    // After one time constant (100 ms): 600 - 590 / e, as the mean of a tick.
    assert!(
        (speed(&interpolator) - 383.0).abs() < 2.0,
        "{}",
        speed(&interpolator)
    );
}

#[test]
fn feed_per_revolution_follows_the_measured_speed() {
    let inputs = MotionInputs {
        spindle_rpm: -180.0,
        ..MotionInputs::default()
    };
    let mut interpolator = Interpolator::new(Point::default());
    interpolator.start_line(Point::new(0.0, -50.0), Feed::PerRevolution(0.3));
    ticks(&mut interpolator, &inputs, 2000);
    assert!((speed(&interpolator) - 54.0).abs() < 1e-3);
    ticks(&mut interpolator, &MotionInputs::default(), 2000);
    assert!(!interpolator.is_moving() && !interpolator.is_finished());
}

#[test]
fn an_override_acts_within_the_tick() {
    let mut inputs = MotionInputs::default();
    let mut interpolator = Interpolator::new(Point::default());
    interpolator.start_line(Point::new(0.0, -500.0), Feed::PerMinute(1000.0));
    ticks(&mut interpolator, &inputs, 1500);
    let before = speed(&interpolator);
    inputs.feed_override = 0.5;
    ticks(&mut interpolator, &inputs, 1);
    assert!(speed(&interpolator) < before - 1.0);
    ticks(&mut interpolator, &inputs, 1500);
    assert!((speed(&interpolator) - 500.0).abs() < 1e-3);
    inputs.feed_override = 0.0;
    let (distance, _) = run_to_standstill(&mut interpolator, &inputs);
    assert!(distance.z < 0.0 && !interpolator.is_finished());
}

#[test]
fn dry_run_passes_through_standstill() {
    let mut inputs = MotionInputs::default();
    let mut interpolator = Interpolator::new(Point::default());
    interpolator.start_line(Point::new(0.0, -500.0), Feed::PerMinute(100.0));
    ticks(&mut interpolator, &inputs, 1000);
    inputs.dry_run = Some(DryRun {
        cutting_mm_per_min: 1260.0,
        rapid_mm_per_min: None,
    });
    let mut slowest = f64::INFINITY;
    for _ in 0..2000 {
        ticks(&mut interpolator, &inputs, 1);
        slowest = slowest.min(speed(&interpolator));
    }
    // It stands still between two ticks, and starts again at the lowest speed.
    assert!(slowest <= 10.0, "{slowest}");
    assert!((speed(&interpolator) - 1260.0).abs() < 1.0);
}

#[test]
fn reset_decelerates_and_drops_the_rest() {
    let mut interpolator = Interpolator::new(Point::default());
    interpolator.start_rapid(Point::new(0.0, -500.0), &limits());
    let inputs = MotionInputs::default();
    ticks(&mut interpolator, &inputs, 1000);
    let stop = interpolator.stopping_point(&limits());
    interpolator.decelerate();
    let (distance, ticks_used) = run_to_standstill(&mut interpolator, &inputs);
    assert!((300..=301).contains(&ticks_used), "{ticks_used} ticks");
    assert!(
        (distance.z + 7600.0 / 60.0 * 0.15).abs() < 1e-6,
        "{distance:?}"
    );
    assert!((interpolator.position() - stop).length() < 1e-9);
    ticks(&mut interpolator, &inputs, 1);
    assert!(interpolator.is_finished());
}

#[test]
fn emergency_stop_stops_at_once() {
    let mut interpolator = Interpolator::new(Point::default());
    interpolator.start_rapid(Point::new(0.0, -500.0), &limits());
    ticks(&mut interpolator, &MotionInputs::default(), 1000);
    let position = interpolator.position();
    interpolator.stop_now();
    ticks(&mut interpolator, &MotionInputs::default(), 10);
    assert_eq!(interpolator.position(), position);
    assert!(interpolator.is_finished() && !interpolator.is_moving());
}

#[test]
fn jog_reaches_its_rate_and_decelerates() {
    let inputs = MotionInputs::default();
    let mut interpolator = Interpolator::new(Point::default());
    interpolator.set_jog(Axis::X, Some((false, JogRate::Feed(790.0))));
    ticks(&mut interpolator, &inputs, 2000);
    assert!((interpolator.velocity().x * 60.0 + 790.0).abs() < 1e-3);
    assert!(interpolator.is_finished());
    interpolator.set_jog(Axis::X, None);
    let (distance, _) = run_to_standstill(&mut interpolator, &inputs);
    // T (v - 041): 0.1 s · (790 - 100) mm/min.
    assert!(
        (distance.x + 0.1 * 690.0 / 60.0).abs() < 1e-6,
        "{distance:?}"
    );
}

#[test]
fn manual_rapid_and_jog_change_over_at_standstill() {
    let inputs = MotionInputs::default();
    let mut interpolator = Interpolator::new(Point::default());
    interpolator.set_jog(Axis::Z, Some((true, JogRate::Rapid)));
    ticks(&mut interpolator, &inputs, 1000);
    assert!((interpolator.velocity().z * 60.0 - 7600.0).abs() < 1e-6);
    interpolator.set_jog(Axis::Z, Some((true, JogRate::Feed(1260.0))));
    let mut slowest = f64::INFINITY;
    for _ in 0..2000 {
        ticks(&mut interpolator, &inputs, 1);
        slowest = slowest.min(interpolator.velocity().z);
    }
    assert!(slowest < 0.5, "{slowest}");
    assert!((interpolator.velocity().z * 60.0 - 1260.0).abs() < 1e-3);
}

#[test]
fn translation_moves_the_rest_of_a_block_along() {
    let inputs = MotionInputs::default();
    let mut interpolator = Interpolator::new(Point::default());
    interpolator.start_arc(
        Point::new(10.0, -10.0),
        Point::new(10.0, 0.0),
        false,
        Feed::PerMinute(500.0),
    );
    ticks(&mut interpolator, &inputs, 700);
    interpolator.translate(Point::new(1.0, 2.0));
    while !interpolator.is_finished() {
        ticks(&mut interpolator, &inputs, 1);
    }
    assert_eq!(interpolator.position(), Point::new(11.0, -8.0));
}

#[test]
fn start_and_end_in_one_point_make_a_full_circle() {
    let center = Point::new(0.0, 5.0);
    let length = path_length(
        MoveKind::Clockwise,
        Point::default(),
        Point::default(),
        Some(center),
    );
    assert!((length - 10.0 * core::f64::consts::PI).abs() < 1e-9);
}

#[test]
fn blocks_without_distance_take_no_time() {
    let inputs = MotionInputs::default();
    let mut interpolator = Interpolator::new(Point::default());
    interpolator.start_rapid(Point::default(), &limits());
    interpolator.tick(&limits(), &inputs);
    assert!(interpolator.is_finished());
    interpolator.start_line(Point::new(0.0, 1.0), Feed::PerMinute(100.0));
    interpolator.continue_tick(&limits(), &inputs);
    assert!(interpolator.position().z > 0.0);
}

#[test]
fn a_parameter_changed_while_braking_still_meets_the_end() {
    let slow = SpeedLaw::exponential(0.1, 0.1);
    let mut ramp = Ramp::new(2.0);
    for _ in 0..100 {
        ramp.advance(&slow, 15.0, TICK_S);
    }
    for law in [
        SpeedLaw::exponential(1.0, 0.1),
        SpeedLaw::exponential(0.0, 0.1),
    ] {
        let mut ramp = ramp;
        let mut distance = 0.0;
        for _ in 0..10_000 {
            distance += ramp.advance(&law, 15.0, TICK_S).distance;
        }
        assert!(ramp.is_finished() && distance > 0.0 && distance < 2.0);
    }
}
