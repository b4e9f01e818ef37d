//! Tests of cuts that continue into each other (007.3 = 0) against the theory of the lag.

use proptest::prelude::*;

use super::*;
use crate::command::MoveKind;
use crate::memory::ControlParameters;
use crate::units::{Axis, Feed, Point, TICK_S};

/// Mean speed along the path in the last tick, mm/min.
fn speed(interpolator: &Interpolator) -> f64 {
    interpolator.velocity().length() * 60.0
}

fn limits(exact: bool, time: i32, lowest: i32) -> MotionLimits {
    let mut parameters = ControlParameters::default();
    parameters.set_bit(7, 3, exact).unwrap();
    parameters.set(29, time).unwrap();
    parameters.set(30, lowest).unwrap();
    MotionLimits::from(&parameters)
}

const FEED: f64 = 3000.0;
/// The feed [`FEED`], converted to mm/s.
const RATE: f64 = 50.0;

fn continuing_inputs() -> MotionInputs {
    MotionInputs {
        cut_continues: true,
        ..MotionInputs::default()
    }
}

/// Runs a cut to the end of its command, then starts the next one in the rest of the tick.
fn start_next_cut(
    interpolator: &mut Interpolator,
    limits: &MotionLimits,
    start: impl Fn(&mut Interpolator),
) {
    while !interpolator.is_finished() {
        interpolator.tick(limits, &continuing_inputs());
    }
    start(interpolator);
}

#[test]
fn one_straight_cut_is_the_same_with_and_without_exact_corners() {
    let run = |exact| {
        let limits = limits(exact, 100, 40);
        let mut interpolator = Interpolator::new(Point::new(1.0, 2.0));
        interpolator.start_line(Point::new(9.0, -4.0), Feed::PerMinute(FEED));
        let mut places = Vec::new();
        while !interpolator.is_finished() {
            places.push(interpolator.tick(&limits, &MotionInputs::default()));
        }
        places
    };
    let (exact, rounded) = (run(true), run(false));
    assert_eq!(exact.len(), rounded.len());
    for (a, b) in exact.iter().zip(&rounded) {
        assert!((*a - *b).length() < 1e-8, "{a:?} {b:?}");
    }
    assert_eq!(exact.last(), rounded.last());
}

/// A right-angled corner at full speed, without 030: with L = F T and s = t / T after
/// the command turned, the tool is at (L e^-s) before the corner on the old leg and
/// L (s - 1 + e^-s) past it on the new one.
#[test]
fn a_corner_is_rounded_as_the_exponential_law_says() {
    let limits = limits(false, 50, 0);
    let mut interpolator = Interpolator::new(Point::default());
    interpolator.start_line(Point::new(0.0, 100.0), Feed::PerMinute(FEED));
    start_next_cut(&mut interpolator, &limits, |interpolator| {
        interpolator.start_line(Point::new(60.0, 100.0), Feed::PerMinute(FEED));
    });
    let since = interpolator.leftover_time();
    interpolator.continue_tick(&limits, &MotionInputs::default());
    let (constant, lag) = (0.05, RATE * 0.05);
    let theory = |time: f64| {
        let rest = libm::exp(-time / constant);
        Point::new(lag * (time / constant - 1.0 + rest), 100.0 - lag * rest)
    };
    let corner = Point::new(0.0, 100.0);
    let mut nearest = f64::INFINITY;
    for tick in 0..600 {
        let time = since + f64::from(tick) * TICK_S;
        let off = (interpolator.position() - theory(time)).length();
        assert!(off <= 0.001, "{off} mm off after {time} s");
        nearest = nearest.min((interpolator.position() - corner).length());
        interpolator.tick(&limits, &MotionInputs::default());
    }
    let rounding = (0..2000)
        .map(|step| (theory(f64::from(step) * 1e-4) - corner).length())
        .fold(f64::INFINITY, f64::min);
    assert!((nearest - rounding).abs() < 0.01 && rounding > 1.0);
}

/// On a circle the tool settles on a smaller one: `R² = r² + lag²` with
/// `ω r = FL + lag / T`; without FL `r = R / √(1 + (F T / R)²)`.
#[test]
fn a_circle_shrinks_as_the_exponential_law_says() {
    for (lowest, expected) in [(0, 10.0 / (1.0f64 + 0.0625).sqrt()), (500, 0.0)] {
        let limits = limits(false, 50, lowest);
        let mut interpolator = Interpolator::new(Point::new(0.0, 10.0));
        interpolator.start_arc(
            Point::new(0.0, 10.0),
            Point::default(),
            false,
            Feed::PerMinute(FEED),
        );
        for _ in 0..800 {
            interpolator.tick(&limits, &continuing_inputs());
        }
        let (spin, floor) = (RATE / 10.0, f64::from(lowest).max(1.0) / 60.0);
        // (FL + e/T)² / ω² + e² = R²
        let (a, b) = (1.0 / 0.05 / spin, floor / spin);
        let lag =
            (-a * b + (a * a * b * b - (a * a + 1.0) * (b * b - 100.0)).sqrt()) / (a * a + 1.0);
        let radius = (100.0 - lag * lag).sqrt();
        let measured_radius = interpolator.position().length();
        assert!(
            (measured_radius - radius).abs() < 0.001,
            "{measured_radius} mm, {radius} by theory"
        );
        if expected > 0.0 {
            assert!((radius - expected).abs() < 0.001);
        }
        assert!(!interpolator.is_finished());
    }
}

#[test]
fn hold_brings_the_tool_to_rest_where_the_command_stopped() {
    let limits = limits(false, 100, 30);
    let mut interpolator = Interpolator::new(Point::default());
    interpolator.start_line(Point::new(0.0, 50.0), Feed::PerMinute(FEED));
    start_next_cut(&mut interpolator, &limits, |interpolator| {
        interpolator.start_line(Point::new(30.0, 50.0), Feed::PerMinute(FEED));
    });
    for _ in 0..30 {
        interpolator.tick(&limits, &continuing_inputs());
    }
    let command = interpolator.stopping_point(&limits);
    assert!(command.z == 50.0 && interpolator.position().z < 49.0);
    let distance = (command - interpolator.position()).length();
    let time = 0.1 * libm::log1p(distance / (0.1 * 0.5));
    let hold = MotionInputs {
        hold: true,
        ..continuing_inputs()
    };
    let mut ticks = 0;
    while interpolator.is_moving() {
        interpolator.tick(&limits, &hold);
        ticks += 1;
    }
    assert_eq!(interpolator.position(), command);
    assert!((f64::from(ticks) * TICK_S - time).abs() < 0.003, "{ticks}");
    while !interpolator.is_finished() {
        interpolator.tick(&limits, &MotionInputs::default());
    }
    assert_eq!(interpolator.position(), Point::new(30.0, 50.0));
}

#[test]
fn a_reset_in_a_corner_drops_the_rest_and_comes_to_rest() {
    let limits = limits(false, 100, 30);
    let mut interpolator = Interpolator::new(Point::default());
    interpolator.start_line(Point::new(0.0, 50.0), Feed::PerMinute(FEED));
    start_next_cut(&mut interpolator, &limits, |interpolator| {
        interpolator.start_line(Point::new(30.0, 50.0), Feed::PerMinute(FEED));
    });
    interpolator.tick(&limits, &continuing_inputs());
    let command = interpolator.commanded();
    interpolator.decelerate();
    for _ in 0..1000 {
        interpolator.tick(&limits, &continuing_inputs());
    }
    assert!(interpolator.is_finished() && !interpolator.is_moving());
    assert_eq!(interpolator.position(), command);
}

/// Speed one tick after the feed override changed, for both laws of corners: the mean
/// of `F₂ + (F₁ - F₂) e^(-t/T)` over the tick.
#[test]
fn the_feed_override_acts_within_a_tick() {
    for exact in [true, false] {
        let limits = limits(exact, 100, 10);
        let mut interpolator = Interpolator::new(Point::default());
        interpolator.start_line(Point::new(0.0, 500.0), Feed::PerMinute(FEED));
        let mut inputs = MotionInputs::default();
        for _ in 0..2500 {
            interpolator.tick(&limits, &inputs);
        }
        for factor in [0.5, 1.5, 0.0] {
            let before = speed(&interpolator);
            inputs.feed_override = factor;
            interpolator.tick(&limits, &inputs);
            let target = FEED * factor;
            let half = libm::exp(-0.0005 / 0.1);
            let expected = target + (before - target) * half;
            // The speed was constant before; the first tick is half a tick later.
            let measured = speed(&interpolator);
            assert!(
                (measured - expected).abs() < 0.001 * FEED,
                "{measured} {expected}"
            );
            for _ in 0..2500 {
                interpolator.tick(&limits, &inputs);
            }
            assert!((speed(&interpolator) - target).abs() < 0.01, "{exact}");
        }
    }
}

/// Rapid and its override: constant acceleration from the first tick on.
#[test]
fn the_rapid_override_acts_within_a_tick() {
    let limits = limits(true, 100, 10);
    let mut interpolator = Interpolator::new(Point::default());
    interpolator.start_rapid(Point::new(0.0, 900.0), &limits);
    let mut inputs = MotionInputs::default();
    for _ in 0..1000 {
        interpolator.tick(&limits, &inputs);
    }
    let rate = limits.rapid_rate(Axis::Z);
    let tick = rate / 300.0;
    assert!((speed(&interpolator) - rate).abs() < 1e-6);
    inputs.rapid_override = RapidOverride::Percent(25);
    for step in 1..=225 {
        interpolator.tick(&limits, &inputs);
        let expected = rate - (f64::from(step) - 0.5) * tick;
        assert!((speed(&interpolator) - expected).abs() < 1e-6);
    }
    interpolator.tick(&limits, &inputs);
    assert!((speed(&interpolator) - rate / 4.0).abs() < 1e-6);
}

/// A random cut that begins at the end of the previous one.
#[derive(Clone, Copy, Debug)]
enum RandomCut {
    Line(Point, f64),
    Arc(f64, f64, f64, f64),
}

fn any_cut() -> impl Strategy<Value = RandomCut> {
    prop_oneof![
        (-8000i32..8000, -8000i32..8000, 20.0..9000.0f64).prop_map(|(x, z, feed)| {
            RandomCut::Line(Point::new(f64::from(x), f64::from(z)) * 0.001, feed)
        }),
        (0.0..6.2f64, 0.1..20.0f64, -6.2..6.2f64, 50.0..9000.0f64)
            .prop_map(|(angle, radius, sweep, feed)| RandomCut::Arc(angle, radius, sweep, feed)),
    ]
}

proptest! {
    /// Holds and overrides at any moment do not change the end points.
    #[test]
    fn holds_and_overrides_keep_the_ends(
        ways in prop::collection::vec((-4000i32..4000, -4000i32..4000), 2..6),
        events in prop::collection::vec((1u32..200, any::<bool>(), 0u8..=15), 1..30),
        lowest in 0i32..3000,
    ) {
        let limits = limits(false, 80, lowest);
        let mut interpolator = Interpolator::new(Point::default());
        let mut events = events.into_iter();
        let (mut inputs, mut left) = (continuing_inputs(), 0);
        let (mut end, mut ticks) = (Point::default(), 0u32);
        for (x, z) in ways {
            end = end + Point::new(f64::from(x), f64::from(z)) * 0.001;
            interpolator.start_line(end, Feed::PerMinute(FEED));
            interpolator.continue_tick(&limits, &inputs);
            while !interpolator.is_finished() {
                if left == 0 {
                    let next = events.next();
                    let (time, hold, feed) = next.unwrap_or((u32::MAX, false, 10));
                    left = time;
                    inputs.hold = hold;
                    inputs.feed_override = f64::from(feed) / 10.0;
                }
                left -= 1;
                interpolator.tick(&limits, &inputs);
                ticks += 1;
                prop_assert!(ticks < 1_000_000);
                prop_assert!(speed(&interpolator) <= 1.5 * FEED * 1.0001);
            }
            prop_assert!((interpolator.commanded() - end).length() < 1e-9);
        }
        for _ in 0..5000 {
            interpolator.tick(&limits, &inputs);
        }
        prop_assert!((interpolator.position() - end).length() < 1e-9 && !interpolator.is_moving());
    }

    /// No end is missed, no speed exceeded, and the duration is the predicted one.
    #[test]
    fn chains_of_cuts_keep_end_speed_and_time(
        cuts in prop::collection::vec(any_cut(), 1..12),
        scale in prop_oneof![Just(1.0), Just(0.1), Just(0.002)],
        time in 0i32..400,
        lowest in prop_oneof![Just(0), 1i32..2000],
    ) {
        let limits = limits(false, time, lowest);
        let mut interpolator = Interpolator::new(Point::default());
        let mut sequel = CutChain::default();
        let (mut expected, mut top, mut ticks) = (0.0, 0.0f64, 0u32);
        // Greatest turn of an arc in a tick, rad: the chord replaces the arc, and where two
        // small arcs meet the tool cuts the corner in few ticks.
        let mut turn = 0.0f64;
        let count = cuts.len();
        for (index, cut) in cuts.into_iter().enumerate() {
            let from = interpolator.commanded();
            let (kind, to, center, feed) = match cut {
                RandomCut::Line(way, feed) => {
                    let to = from + way * scale;
                    interpolator.start_line(to, Feed::PerMinute(feed));
                    (MoveKind::Feed, to, None, feed)
                }
                RandomCut::Arc(angle, radius, sweep, feed) => {
                    let sweep = if sweep.abs() < 0.01 { 0.01 } else { sweep };
                    let arm = |angle: f64| Point::new(libm::sin(angle), libm::cos(angle)) * (radius * scale);
                    let center = from - arm(angle);
                    let to = center + arm(angle + sweep);
                    turn = turn.max(feed / 60.0 * TICK_S / (radius * scale));
                    interpolator.start_arc(to, center, sweep < 0.0, Feed::PerMinute(feed));
                    (MoveKind::arc(sweep < 0.0), to, Some(center), feed)
                }
            };
            expected += sequel.add_cut(kind, from, to, center, feed, &limits);
            top = top.max(feed.min(limits.cutting_rate()));
            let inputs = MotionInputs { cut_continues: index + 1 < count, ..MotionInputs::default() };
            interpolator.continue_tick(&limits, &inputs);
            while !interpolator.is_finished() {
                interpolator.tick(&limits, &inputs);
                ticks += 1;
                prop_assert!(ticks < 4_000_000);
                let most = top * (1.1 + 0.1 * turn);
                prop_assert!(speed(&interpolator) <= most, "{} of {}", speed(&interpolator), top);
            }
            prop_assert!((interpolator.commanded() - to).length() < 1e-9);
        }
        prop_assert!(!interpolator.is_moving());
        expected += sequel.finish(&limits);
        let ticked = f64::from(ticks) * TICK_S;
        // Arcs that take only a few ticks are estimated roughly; whole programs stay within
        // half a percent (tests of the transitions).
        let tolerance = 0.02 + 0.02 * expected;
        prop_assert!((ticked - expected).abs() < tolerance, "{} s instead of {}", ticked, expected);
    }
}
