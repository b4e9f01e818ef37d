//! Tests of threads and taps on a spindle that turns exactly as commanded.

use proptest::prelude::*;

use super::*;
use crate::command::{MoveKind, ThreadStart};
use crate::memory::ControlParameters;
use crate::spindle::{SpindleAngle, SpindleControl, SpindleInputs};
use crate::units::{Axis, Point, TICK_S};

const COUNTS: f64 = 4096.0;
/// Travel of one command pulse of Z, mm.
const PULSE: f64 = 0.001;

struct Rig {
    limits: MotionLimits,
    interpolator: Interpolator,
    angle: SpindleAngle,
    spindle: SpindleControl,
    rpm: f64,
    turns: f64,
    inputs: MotionInputs,
}

impl Rig {
    /// Creates a test rig whose spindle has been turning at `rpm`, r/min, for some time; `changes`
    /// are parameters with their values.
    fn new(rpm: f64, changes: &[(u16, i32)]) -> Self {
        let mut parameters = ControlParameters::default();
        for (number, value) in changes {
            parameters.set(*number, *value).unwrap();
        }
        let mut rig = Self {
            limits: MotionLimits::from(&parameters),
            interpolator: Interpolator::new(Point::default()),
            angle: SpindleAngle::new(&parameters),
            spindle: SpindleControl::new(&parameters),
            rpm,
            turns: 0.37,
            inputs: MotionInputs::default(),
        };
        rig.wait(800);
        rig
    }

    /// Advances by one tick and returns the distance travelled in it, mm.
    fn tick(&mut self) -> f64 {
        self.turns += self.rpm / 60.0 * TICK_S;
        let encoder = (self.turns * COUNTS).floor() as i64;
        let index = self.turns.floor() as i64 * COUNTS as i64;
        self.angle.tick(encoder, index);
        self.spindle.tick(&SpindleInputs {
            measured_rpm: None,
            encoder,
            radius_mm: 0.0,
            override_percent: 100,
        });
        self.inputs.spindle = self.angle.turn();
        self.inputs.spindle_rpm = self.spindle.actual_rpm();
        let before = self.interpolator.position();
        let position = self.interpolator.tick(&self.limits, &self.inputs);
        assert!(position.x.is_finite() && position.z.is_finite());
        (position - before).length()
    }

    fn wait(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    fn start(&mut self, to: Point, lead: f64, degrees: f64) {
        let thread = thread(to, lead, ThreadStart::AtIndex { degrees });
        self.interpolator.start_thread(&thread, &self.limits);
    }

    fn finish(&mut self) -> u32 {
        let mut ticks = 0;
        while !self.interpolator.is_finished() {
            self.tick();
            ticks += 1;
            assert!(ticks < 1_000_000, "the thread never ends");
        }
        ticks
    }

    /// Cuts until Z has reached `z`. Returns the part of the spindle angle there, as a
    /// fraction of a turn, that the lead does not explain.
    fn phase_at(&mut self, z: f64, lead: f64) -> f64 {
        while self.interpolator.position().z > z {
            self.tick();
        }
        let thread_turns = -self.interpolator.position().z / lead;
        let phase = self.turns.abs() - thread_turns;
        phase - phase.floor()
    }
}

fn thread(to: Point, lead: f64, start: ThreadStart) -> ThreadMove {
    ThreadMove {
        to,
        lead_axis: Axis::Z,
        lead,
        increase: 0.0,
        start,
        run_out: false,
    }
}

/// Distance of two spindle angles, given as fractions of a turn; at most half a turn.
fn turn_distance(one: f64, other: f64) -> f64 {
    let distance = (one - other).abs();
    distance.min(1.0 - distance)
}

#[test]
fn passes_meet_the_same_groove() {
    for rpm in [120.0, 500.0, 1500.0] {
        for starts in [1u32, 2, 5] {
            let lead = 3.0;
            let mut rig = Rig::new(rpm, &[]);
            let mut first = vec![None; starts as usize];
            for pass in 0..12u32 {
                let start = pass % starts;
                let fraction = f64::from(start) / f64::from(starts);
                rig.interpolator = Interpolator::new(Point::new(10.0, 0.0));
                rig.wait(17 * pass + 3);
                rig.start(Point::new(10.0, -40.0), lead, fraction * 360.0);
                let phase = rig.phase_at(-20.0, lead);
                let reference = *first[start as usize].get_or_insert(phase);
                let error = turn_distance(phase, reference) * lead;
                assert!(error <= PULSE, "{error} mm at {rpm} r/min, start {start}");
                let shift = turn_distance(phase, first[0].unwrap());
                let expected = fraction.min(1.0 - fraction);
                assert!(
                    (shift - expected).abs() * lead <= PULSE,
                    "start {start} of {starts}: {shift} turns instead of {fraction}"
                );
                rig.finish();
            }
        }
    }
}

#[test]
fn a_reversed_spindle_threads_too() {
    let mut rig = Rig::new(-300.0, &[]);
    rig.start(Point::new(0.0, -10.0), 1.5, 90.0);
    rig.finish();
    assert_eq!(rig.interpolator.position(), Point::new(0.0, -10.0));
}

#[test]
fn a_faster_start_shortens_the_lead_in_and_the_exponential_law_lengthens_it() {
    let lag = |changes: &[(u16, i32)]| {
        let mut rig = Rig::new(500.0, changes);
        rig.start(Point::new(0.0, -60.0), 3.0, 0.0);
        rig.phase_at(-40.0, 3.0)
    };
    let slow = lag(&[(28, 6)]);
    let fast = lag(&[(28, 800)]);
    let exponential = lag(&[(28, 6), (175, 0b1_0000)]);
    // The lag in turns is 8.33 r/s times half of 029, times it when exponential.
    assert!((slow - 8.333 * 0.05).abs() < 0.02, "{slow}");
    assert!(fast < slow && (exponential - 8.333 * 0.1).abs() < 0.02);
}

#[test]
fn the_lead_grows_as_programmed() {
    let mut rig = Rig::new(300.0, &[(28, 8000)]);
    let mut growing = thread(
        Point::new(0.0, -52.0),
        2.0,
        ThreadStart::AtIndex { degrees: 0.0 },
    );
    growing.increase = 0.5;
    rig.interpolator.start_thread(&growing, &rig.limits);
    while rig.interpolator.position().z == 0.0 {
        rig.tick();
    }
    let begun = rig.turns.floor();
    while !rig.interpolator.is_finished() {
        rig.tick();
        let turns = rig.turns - begun;
        let distance = 2.0 * turns + 0.25 * turns * turns;
        let off = (-rig.interpolator.position().z - distance.min(52.0)).abs();
        assert!(off < 0.003, "{off} mm off after {turns} turns");
    }
    // 2 n + n² / 4 = 52.
    assert!((growing.turns(Point::default()) - 10.966_629_547_1).abs() < 1e-9);
}

#[test]
fn a_continued_thread_keeps_phase_and_speed() {
    for tick_later in [false, true] {
        let mut rig = Rig::new(480.0, &[]);
        rig.start(Point::new(10.0, -12.3), 2.0, 0.0);
        rig.inputs.thread_continues = true;
        let mut slowest = f64::INFINITY;
        let mut joined = false;
        let mut phases = Vec::new();
        while !(joined && rig.interpolator.is_finished()) {
            let moved = rig.tick();
            if rig.interpolator.is_finished() && !joined {
                joined = true;
                let next = thread(Point::new(12.0, -30.0), 2.0, ThreadStart::Continued);
                rig.interpolator.start_thread(&next, &rig.limits);
                if !tick_later {
                    let inputs = rig.inputs;
                    rig.interpolator.continue_tick(&rig.limits, &inputs);
                }
            }
            let z = rig.interpolator.position().z;
            if (-25.0..-5.0).contains(&z) && (tick_later || !joined || moved > 0.0) {
                let phase = rig.turns + z / 2.0;
                phases.push(phase - phase.floor());
                if !tick_later {
                    slowest = slowest.min(moved);
                }
            }
            if joined {
                rig.inputs.thread_continues = false;
            }
        }
        assert_eq!(rig.interpolator.position(), Point::new(12.0, -30.0));
        let spread = phases.iter().fold(0.0f64, |worst, phase| {
            worst.max(turn_distance(*phase, phases[0]))
        });
        if !tick_later {
            assert!(spread * 2.0 <= 2.0 * PULSE, "{} mm", spread * 2.0);
            assert!(slowest > 0.9 * 16.0 * TICK_S, "slowed down to {slowest}");
        }
        let last = *phases.last().unwrap();
        assert!(turn_distance(last, phases[0]) * 2.0 <= PULSE);
    }
}

#[test]
fn a_thread_continued_too_late_waits_for_its_angle() {
    let mut rig = Rig::new(480.0, &[]);
    rig.start(Point::new(10.0, -12.3), 2.0, 0.0);
    let before = rig.phase_at(-8.0, 2.0);
    rig.finish();
    rig.wait(1);
    let next = thread(Point::new(10.0, -30.0), 2.0, ThreadStart::Continued);
    rig.interpolator.start_thread(&next, &rig.limits);
    let after = rig.phase_at(-20.0, 2.0);
    assert!(
        turn_distance(before, after) * 2.0 <= PULSE,
        "{before} {after}"
    );
}

#[test]
fn hold_and_overrides_do_not_act_on_a_thread() {
    let mut rig = Rig::new(480.0, &[]);
    let mut ticks = Vec::new();
    for disturbed in [false, true] {
        rig.interpolator = Interpolator::new(Point::default());
        rig.start(Point::new(0.0, -20.0), 2.0, 0.0);
        while !rig.interpolator.is_moving() {
            rig.tick();
        }
        if disturbed {
            rig.inputs.hold = true;
            rig.inputs.feed_override = 0.0;
        }
        ticks.push(rig.finish());
    }
    assert!(ticks[0].abs_diff(ticks[1]) <= 1, "{ticks:?}");
}

#[test]
fn reset_stops_a_thread_on_its_line() {
    let mut rig = Rig::new(480.0, &[]);
    rig.start(Point::new(5.0, -20.0), 2.0, 0.0);
    while rig.interpolator.position().z > -10.0 {
        rig.tick();
    }
    rig.interpolator.decelerate();
    rig.wait(1000);
    let at = rig.interpolator.position();
    assert!(rig.interpolator.is_finished() && !rig.interpolator.is_moving());
    assert!(at.z < -10.0 && at.z > -14.0, "{at:?}");
    assert!((at.x / at.z + 0.25).abs() < 1e-6);
}

#[test]
fn a_run_out_with_its_own_speed_moves_x_at_it() {
    let mut rig = Rig::new(480.0, &[(107, 1200), (26, 50)]);
    let mut tail = thread(
        Point::new(12.0, -2.0),
        2.0,
        ThreadStart::AtIndex { degrees: 0.0 },
    );
    tail.run_out = true;
    rig.interpolator = Interpolator::new(Point::new(10.0, 0.0));
    rig.interpolator.start_thread(&tail, &rig.limits);
    let (continuing, stopping) = tail.duration(Point::new(10.0, 0.0), 480.0, &rig.limits);
    while rig.interpolator.position() == Point::new(10.0, 0.0) {
        rig.tick();
    }
    let ticks = rig.finish();
    assert_eq!(rig.interpolator.position(), Point::new(12.0, -2.0));
    let expected = continuing + stopping;
    // 2 mm at 20 mm/s and the time constant of 50 ms; Z takes 2 mm at 16 mm/s.
    assert!(expected > 0.125, "{expected}");
    assert!((f64::from(ticks) * TICK_S - expected).abs() < 0.005);
}

#[test]
fn a_tap_follows_the_spindle_in_and_out() {
    let mut rig = Rig::new(600.0, &[]);
    rig.interpolator
        .start_tap(Point::new(0.0, -15.0), 1.25, 0.0);
    while !rig.interpolator.is_tap_at_bottom() {
        rig.tick();
    }
    let phase = |rig: &Rig| rig.turns + rig.interpolator.position().z / 1.25;
    let locked = phase(&rig);
    // The spindle stops and turns back, each as a first-order lag.
    let mut deepest = 0.0f64;
    for (target, ticks) in [(0.0, 1000), (-600.0, 500)] {
        for _ in 0..ticks {
            rig.rpm += (target - rig.rpm) * 0.01;
            rig.tick();
            deepest = deepest.min(rig.interpolator.position().z);
            let off = (phase(&rig) - locked).abs() * 1.25;
            assert!(off < 0.006, "{off} mm out of phase");
        }
        rig.interpolator.reverse_tap();
    }
    assert!(deepest < -15.5, "{deepest}");
    rig.finish();
    assert_eq!(rig.interpolator.position(), Point::default());
}

#[test]
fn threads_wait_while_the_spindle_stands_still() {
    let mut rig = Rig::new(0.0, &[]);
    rig.start(Point::new(0.0, -10.0), 2.0, 0.0);
    rig.wait(1000);
    assert!(!rig.interpolator.is_finished() && !rig.interpolator.is_moving());
    assert_eq!(rig.interpolator.position(), Point::default());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// At any spindle motion a thread stays on its line and ends at its end point.
    #[test]
    fn threads_end_at_their_end_point(
        (x, z) in (-20_000i32..20_000, -40_000i32..40_000),
        lead in 5i32..500,
        increase in -20i32..20,
        degrees in 0u16..360,
        (floor, time, exponential) in (6i32..8000, 0i32..4000, any::<bool>()),
        speeds in prop::collection::vec((-3000i32..3000, 1u32..400), 0..8),
        rpm in prop_oneof![-3000i32..-30, 30i32..3000],
    ) {
        let changes = [(28, floor), (29, time), (175, i32::from(exponential) << 4)];
        let mut rig = Rig::new(f64::from(rpm), &changes);
        let to = Point::new(f64::from(x) / 2000.0, f64::from(z) / 1000.0);
        let long = if to.x.abs() > to.z.abs() { Axis::X } else { Axis::Z };
        let lead = f64::from(lead) / 100.0;
        // The lead stays above zero to the end (alarm 043 otherwise).
        let way = to.get(long).abs().max(1e-3);
        let least = -0.4 * lead * lead / way;
        let cut = ThreadMove {
            to,
            lead_axis: long,
            lead,
            increase: (f64::from(increase) / 100.0).max(least),
            start: ThreadStart::AtIndex { degrees: f64::from(degrees) },
            run_out: false,
        };
        rig.interpolator.start_thread(&cut, &rig.limits);
        let on_line = |at: Point| {
            let off = (at.x * to.z - at.z * to.x).abs() / to.length().max(1e-9);
            assert!(off < 1e-9 && at.length() <= to.length() + 1e-9, "{at:?}");
        };
        for (speed, ticks) in speeds {
            rig.rpm = f64::from(speed);
            for _ in 0..ticks {
                rig.tick();
                on_line(rig.interpolator.position());
            }
        }
        let forward = if rig.interpolator.position() == Point::default() || rpm > 0 { 3000.0 } else { -3000.0 };
        // If the spindle turned back before the start, the thread waits for all those
        // turns.
        for (direction, ticks) in [(forward, 60_000), (-forward, 130_000)] {
            rig.rpm = direction;
            for _ in 0..ticks {
                if rig.interpolator.is_finished() {
                    break;
                }
                rig.tick();
                on_line(rig.interpolator.position());
            }
        }
        prop_assert_eq!(rig.interpolator.position(), to);
    }

    /// The duration of the preview is the duration of the motion.
    #[test]
    fn the_duration_is_predicted(
        way in 1i32..60_000,
        lead in 10i32..600,
        part in -0.4..0.4,
        rpm in 60i32..1200,
        (floor, time, exponential) in (6i32..3000, 0i32..300, any::<bool>()),
    ) {
        let way = f64::from(way) / 1000.0;
        let lead = f64::from(lead) / 100.0;
        // The lead stays above zero to the end (alarm 043 otherwise).
        let increase = part * lead * lead / way;
        check_predicted_duration(way, (lead, increase), rpm, (floor, time, exponential))?;
    }
}

/// Cuts a thread and compares its duration with the predicted one. The parameters are the distance,
/// mm, the lead, mm per turn, and its change, the spindle speed, r/min, and the values of 028, 029
/// and 175.4.
fn check_predicted_duration(
    distance: f64,
    (lead, increase): (f64, f64),
    rpm: i32,
    (floor, time, exponential): (i32, i32, bool),
) -> Result<(), TestCaseError> {
    let changes = [(28, floor), (29, time), (175, i32::from(exponential) << 4)];
    let mut rig = Rig::new(f64::from(rpm), &changes);
    let to = Point::new(0.0, -distance);
    let cut = ThreadMove {
        increase,
        ..thread(to, lead, ThreadStart::AtIndex { degrees: 0.0 })
    };
    rig.interpolator.start_thread(&cut, &rig.limits);
    let (continuing, stopping) = cut.duration(Point::default(), f64::from(rpm), &rig.limits);
    let expected = continuing + stopping;
    let mut ticks = 0;
    while !rig.interpolator.is_finished() {
        rig.tick();
        ticks += u32::from(rig.interpolator.position() != Point::default());
    }
    let duration = f64::from(ticks) * TICK_S;
    prop_assert!(
        (duration - expected).abs() < 0.004 + 0.01 * expected,
        "{duration} s instead of {expected}"
    );
    let length = path_length(MoveKind::Thread, Point::default(), to, None);
    prop_assert_eq!(length, to.length());
    Ok(())
}

/// The measured speed varies by one count of the encoder, so that the rate is just below
/// its final value: the rest of the distance was once halved tick by tick.
#[test]
fn a_thread_does_not_creep_to_its_end() {
    for exponential in [true, false] {
        check_predicted_duration(0.546, (4.44, 0.0), 646, (1424, 234, exponential)).unwrap();
    }
}
