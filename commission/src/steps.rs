//! The steps of commissioning, each from its readings to what is to be written
//! (manual III-12.3 to III-12.8).

use gsk_core::axis::{gear_speed_limit, pulse_weight};
use gsk_core::memory::{Parameters, PitchTable, parameter};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

use crate::change::{Change, Proposal, name, of};
use crate::gear::{Drive, nearest_ratio};
use crate::measurement::Travel;

/// A step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Step {
    /// Direction of the motors.
    Direction,
    /// Electronic gear.
    Gear,
    /// Rapid rate and acceleration.
    Acceleration,
    /// Machine zero.
    Reference,
    /// Spindle speed.
    Spindle,
    /// Backlash.
    Backlash,
    /// Pitch errors.
    Pitch,
}

impl Step {
    /// All of them, in the order in which they are made: each needs those before it.
    pub const ALL: [Self; 7] = [
        Self::Direction,
        Self::Gear,
        Self::Acceleration,
        Self::Reference,
        Self::Spindle,
        Self::Backlash,
        Self::Pitch,
    ];

    /// Its name.
    pub fn name(self) -> Message {
        match self {
            Self::Direction => say::commission_step_direction(),
            Self::Gear => say::commission_step_gear(),
            Self::Acceleration => say::commission_step_acceleration(),
            Self::Reference => say::commission_step_reference(),
            Self::Spindle => say::commission_step_spindle(),
            Self::Backlash => say::commission_step_backlash(),
            Self::Pitch => say::commission_step_pitch(),
        }
    }

    /// What is done in it, and with which keys.
    pub fn explanation(self) -> Message {
        match self {
            Self::Direction => say::commission_explain_direction(),
            Self::Gear => say::commission_explain_gear(),
            Self::Acceleration => say::commission_explain_acceleration(),
            Self::Reference => say::commission_explain_reference(),
            Self::Spindle => say::commission_explain_spindle(),
            Self::Backlash => say::commission_explain_backlash(),
            Self::Pitch => say::commission_explain_pitch(),
        }
    }
}

fn proposal(
    changes: Vec<Change>,
    notes: Vec<Message>,
    parameters: &Parameters,
) -> Result<Proposal, Message> {
    Proposal::of(changes, notes, parameters, &PitchTable::default())
}

const fn value(number: u16, value: i32) -> Change {
    Change::Value { number, value }
}

const fn bit(number: u16, bit: u8, on: bool) -> Change {
    Change::Bit { number, bit, on }
}

/// The bit of the two that belongs to an axis.
const fn bit_of(axis: Axis) -> u8 {
    match axis {
        Axis::X => 0,
        Axis::Z => 1,
    }
}

/// The slide moved against the key: 008 is turned over.
///
/// # Errors
/// None; the control takes it.
pub fn direction(axis: Axis, parameters: &Parameters) -> Result<Proposal, Message> {
    let on = parameters.bit(8, bit_of(axis));
    let notes = vec![say::commission_power_cycle()];
    proposal(vec![bit(8, bit_of(axis), !on)], notes, parameters)
}

/// What was commanded, and what the slide made of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GearMeasured {
    /// Commanded slide travel, mm; X in radius.
    pub commanded: Travel,
    /// Measured slide travel.
    pub measured: Travel,
}

/// The gear of an axis from the plates of its drive.
///
/// # Errors
/// Numbers that are none, a ratio out of reach.
pub fn gear_from_drive(
    axis: Axis,
    drive: &Drive,
    parameters: &Parameters,
) -> Result<Proposal, Message> {
    let (multiply, divide) = parameters.gear(axis);
    let increment = pulse_weight(axis, parameters) * f64::from(multiply) / f64::from(divide);
    gear(axis, drive.ratio(Travel(increment))?, 0.0, parameters)
}

/// What the lead of a screw, and a measurement of it, may be off: a ratio of small numbers
/// within that is the one the wheels have (decision COMMISSION-2).
const LEAD_TOLERANCE: f64 = 200e-6;

/// The gear of an axis from a long move.
///
/// # Errors
/// A measurement that cannot be, a ratio out of reach.
pub fn gear_measured(
    axis: Axis,
    made: GearMeasured,
    parameters: &Parameters,
) -> Result<Proposal, Message> {
    let (commanded, measured) = (made.commanded.0, made.measured.0);
    if !(commanded.is_finite() && measured.is_finite()) || commanded.abs() < 1.0 {
        return Err(say::commission_move_short());
    }
    if measured == 0.0 || (commanded > 0.0) != (measured > 0.0) {
        return Err(say::commission_move_reversed(name(axis)));
    }
    let (multiply, divide) = parameters.gear(axis);
    let stands = f64::from(multiply) / f64::from(divide);
    gear(
        axis,
        stands * commanded / measured,
        LEAD_TOLERANCE,
        parameters,
    )
}

fn gear(
    axis: Axis,
    wanted: f64,
    tolerance: f64,
    parameters: &Parameters,
) -> Result<Proposal, Message> {
    let ratio = nearest_ratio(wanted, tolerance)?;
    let mut changes = vec![
        value(
            of(axis, parameter::X_MULTIPLIER, parameter::Z_MULTIPLIER),
            ratio.multiply,
        ),
        value(
            of(axis, parameter::X_DIVISOR, parameter::Z_DIVISOR),
            ratio.divide,
        ),
    ];
    let mut notes = vec![say::commission_gear_off(
        ratio.multiply,
        ratio.divide,
        ratio.off,
    )];
    let mut then = parameters.clone();
    let mut none = PitchTable::default();
    for change in &changes {
        change.apply(&mut then, &mut none)?;
    }
    if let Some(limit) = gear_speed_limit(axis, &then) {
        let approach = approach_limit(axis, limit);
        let rapid = of(axis, parameter::X_RAPID, parameter::Z_RAPID);
        for (number, most) in [(rapid, limit), (parameter::ZERO_HIGH_SPEED, approach)] {
            if f64::from(parameters.value(number)) > most {
                changes.push(value(number, most.floor() as i32));
            }
        }
        notes.push(say::commission_gear_slow(name(axis), limit.floor()));
    }
    notes.push(say::pitch_zero_return_needed());
    proposal(changes, notes, parameters)
}

/// The largest rate of the approach (113) for the largest rate of an axis: it is halved for X.
const fn approach_limit(axis: Axis, limit: f64) -> f64 {
    match axis {
        Axis::X => 2.0 * limit,
        Axis::Z => limit,
    }
}

/// A rate of the approach that neither axis is too slow for: 113 is that of both.
fn approach(wanted: i32, parameters: &Parameters) -> i32 {
    let limits = [Axis::X, Axis::Z].into_iter().filter_map(|axis| {
        let limit = gear_speed_limit(axis, parameters)?;
        Some(approach_limit(axis, limit).floor() as i32)
    });
    limits.fold(wanted, i32::min)
}

/// The kind of the drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveKind {
    /// Stepping motors.
    Stepper,
    /// Servo motors.
    Servo,
}

/// Rates and acceleration that suit the drives (manual III-12.5). What is within the limits
/// of the manual stays.
///
/// # Errors
/// None; the control takes them.
pub fn acceleration(kind: DriveKind, parameters: &Parameters) -> Result<Proposal, Message> {
    let at_most = |number, limit| value(number, parameters.value(number).min(limit));
    let at_least = |number, limit| value(number, parameters.value(number).max(limit));
    let changes = match kind {
        DriveKind::Stepper => vec![
            at_most(parameter::X_RAPID, 2500),
            at_most(parameter::Z_RAPID, 5000),
            at_least(parameter::X_RAPID_TIME, 450),
            at_least(parameter::Z_RAPID_TIME, 450),
            at_least(parameter::THREAD_TIME, 250),
            at_most(parameter::THREAD_LOW_SPEED, 50),
            at_least(parameter::FEED_TIME, 250),
            at_most(parameter::FEED_LOW_SPEED, 50),
            bit(7, 3, true),
        ],
        DriveKind::Servo => vec![
            value(parameter::X_RAPID, 3800),
            value(parameter::Z_RAPID, 7600),
            at_most(parameter::X_RAPID_TIME, 50),
            at_most(parameter::Z_RAPID_TIME, 50),
            at_most(parameter::THREAD_TIME, 50),
            at_most(parameter::THREAD_LOW_SPEED, 500),
            at_most(parameter::FEED_TIME, 50),
            at_most(parameter::FEED_LOW_SPEED, 500),
        ],
    };
    // With a gear that multiplies the pulses set the limit.
    let capped = |change: Change| match change {
        Change::Value {
            number,
            value: rate,
        } if [parameter::X_RAPID, parameter::Z_RAPID].contains(&number) => {
            let axis = if number == parameter::X_RAPID {
                Axis::X
            } else {
                Axis::Z
            };
            let limit = gear_speed_limit(axis, parameters).map_or(rate, |it| it.floor() as i32);
            value(number, rate.min(limit))
        }
        other => other,
    };
    let changes = changes.into_iter().map(capped).collect();
    proposal(changes, Vec::new(), parameters)
}

/// The largest following error that was seen in a rapid move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// What was seen, mm of slide travel.
    pub seen: Travel,
    /// What the drive allows.
    pub allowed: Travel,
}

/// The part of the allowed following error that a rapid move may use.
const LAG_SHARE: f64 = 0.8;

/// A rapid rate for which the following error keeps a fifth of what is allowed in reserve:
/// it grows as the rate does.
///
/// # Errors
/// Numbers that are none.
pub fn largest_lag(axis: Axis, lag: Lag, parameters: &Parameters) -> Result<Proposal, Message> {
    let (seen, allowed) = (lag.seen.0.abs(), lag.allowed.0);
    if !(seen.is_finite() && allowed.is_finite() && seen > 0.0 && allowed > 0.0) {
        return Err(say::commission_lag_numbers());
    }
    let rate = parameters.rapid_rate(axis);
    let gain = rate / 60.0 / seen;
    let mut notes = vec![say::commission_lag(seen, allowed, gain)];
    let most = rate * LAG_SHARE * allowed / seen;
    let mut changes = Vec::new();
    if most < rate {
        let least = 6.0;
        changes.push(value(
            of(axis, parameter::X_RAPID, parameter::Z_RAPID),
            most.floor().max(least) as i32,
        ));
    } else {
        notes.push(say::commission_lag_fine());
    }
    proposal(changes, notes, parameters)
}

/// How the machine zero is found (manual III-12.6).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ZeroMethod {
    /// A: there is no switch.
    NoSwitch,
    /// B: a switch for deceleration, then the one-turn signal.
    SwitchAndSignal,
    /// C: one proximity switch.
    OneSwitch,
}

/// The parameters of a method, the approach towards plus.
///
/// # Errors
/// None; the control takes them.
pub fn reference(
    axis: Axis,
    method: ZeroMethod,
    parameters: &Parameters,
) -> Result<Proposal, Message> {
    let own = bit_of(axis);
    let changes = match method {
        ZeroMethod::NoSwitch => vec![bit(14, own, false)],
        ZeroMethod::SwitchAndSignal => vec![
            bit(4, 5, false),
            bit(6, own, false),
            bit(7, own, false),
            bit(11, 2, true),
            bit(14, own, true),
            value(parameter::ZERO_LOW_SPEED, 200),
            value(parameter::ZERO_HIGH_SPEED, approach(7600, parameters)),
        ],
        ZeroMethod::OneSwitch => vec![
            bit(4, 5, false),
            bit(6, own, false),
            bit(7, own, true),
            bit(11, 2, false),
            bit(14, own, true),
            value(parameter::ZERO_LOW_SPEED, 200),
            value(parameter::ZERO_HIGH_SPEED, approach(5000, parameters)),
        ],
    };
    let notes = match method {
        ZeroMethod::NoSwitch => vec![say::commission_zero_by_hand()],
        _ => vec![say::commission_zero_dog()],
    };
    proposal(changes, notes, parameters)
}

/// The speed of the spindle at S9999, 10 V.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleSpeed {
    /// The gear, 1 to 4.
    pub gear: u8,
    /// What was read, r/min.
    pub rpm: f64,
    /// What a voltmeter read, V, if it did.
    pub volts: Option<f64>,
}

/// Speed at 10 V of a gear (037–040), and the voltage set right (021).
///
/// # Errors
/// Numbers that are none, a spindle without analog output (001.4 = 0).
pub fn spindle(read: SpindleSpeed, parameters: &Parameters) -> Result<Proposal, Message> {
    if !parameters.analog_spindle() {
        return Err(say::commission_spindle_switched());
    }
    if !(1..=4).contains(&read.gear) || !(1.0..=9999.0).contains(&read.rpm) {
        return Err(say::commission_spindle_numbers());
    }
    let volts = match read.volts {
        Some(volts) if !(1.0..=20.0).contains(&volts) => {
            return Err(say::commission_spindle_volts(volts));
        }
        volts => volts.unwrap_or(10.0),
    };
    let gain = (f64::from(parameters.value(parameter::SPINDLE_GAIN)) * 10.0 / volts).round();
    // With the voltage set right the speed changes with it.
    let rpm = (read.rpm * 10.0 / volts).round();
    let gear = parameter::GEAR_SPEED_1 + u16::from(read.gear) - 1;
    let mut changes = vec![value(gear, rpm as i32)];
    if read.volts.is_some() {
        changes.insert(0, value(parameter::SPINDLE_GAIN, gain as i32));
    }
    proposal(changes, Vec::new(), parameters)
}

/// Readings of the gauge at the same position: approached towards plus, and towards minus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Backlash {
    /// A, after N20, mm of slide travel.
    pub a: Travel,
    /// B, after N40.
    pub b: Travel,
}

/// |A − B| of several readings becomes 034 or 035. What stands there must be 0 while it is
/// measured; without readings that is proposed.
///
/// # Errors
/// A compensation that is in force, readings that differ too much, a play beyond 2 mm.
pub fn backlash(
    axis: Axis,
    readings: &[Backlash],
    parameters: &Parameters,
) -> Result<Proposal, Message> {
    const LARGEST_UM: f64 = 2000.0;
    const SPREAD_UM: f64 = 10.0;
    let number = of(axis, parameter::X_BACKLASH, parameter::Z_BACKLASH);
    if readings.is_empty() {
        let notes = vec![say::commission_backlash_zero(number)];
        return proposal(vec![value(number, 0)], notes, parameters);
    }
    if parameters.value(number) != 0 {
        return Err(say::commission_backlash_not_zero(number));
    }
    let plays: Vec<f64> = readings
        .iter()
        .map(|it| (it.a.0 - it.b.0).abs() * 1000.0)
        .collect();
    let least = plays.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = plays.iter().copied().fold(0.0, f64::max);
    if !largest.is_finite() || largest > LARGEST_UM {
        return Err(say::commission_backlash_large(largest, LARGEST_UM));
    }
    let mean = plays.iter().sum::<f64>() / plays.len() as f64;
    let mut notes = vec![say::commission_backlash_mean(
        plays.len(),
        mean,
        largest - least,
    )];
    if largest - least > SPREAD_UM {
        notes.push(say::commission_backlash_spread());
    }
    let units = mean / 1000.0 / parameters.least_increment();
    proposal(vec![value(number, units.round() as i32)], notes, parameters)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changed(proposal: &Proposal) -> Vec<(u16, i32)> {
        let changes = proposal.changes.iter();
        changes
            .map(|change| match change {
                Change::Value { number, value } => (*number, *value),
                Change::Bit { number, bit, on } => (*number, i32::from(*on) << bit),
                Change::Pitch { .. } => panic!("no step but pitch"),
            })
            .collect()
    }

    #[test]
    fn a_gear_that_multiplies_slows_the_rapid() {
        let parameters = Parameters::default();
        let made = |commanded, measured| GearMeasured {
            commanded: Travel(commanded),
            measured: Travel(measured),
        };
        let half = gear_measured(Axis::Z, made(-100.0, -50.0), &parameters).unwrap();
        assert_eq!(
            changed(&half),
            [
                (parameter::Z_MULTIPLIER, 2),
                (parameter::Z_RAPID, 3800),
                (parameter::ZERO_HIGH_SPEED, 3800)
            ]
        );
        let twice = gear_measured(Axis::X, made(100.0, 200.0), &parameters).unwrap();
        assert_eq!(changed(&twice), [(parameter::X_DIVISOR, 2)]);
        for (commanded, measured) in [(100.0, -100.0), (100.0, 0.0), (0.0, 0.0), (f64::NAN, 1.0)] {
            assert!(gear_measured(Axis::X, made(commanded, measured), &parameters).is_err());
        }
        // X: 0.0005 mm an increment, 5 mm a turn of 10000 pulses.
        let drive = Drive {
            pulses: 10_000.0,
            lead: Travel(5.0),
            screw_teeth: 1,
            motor_teeth: 1,
        };
        let plates = gear_from_drive(Axis::X, &drive, &parameters).unwrap();
        assert_eq!(changed(&plates), []);
    }

    /// 113 is that of both axes, and twice that of X.
    #[test]
    fn the_approach_to_the_zero_keeps_below_the_limit_of_the_gears() {
        let approach = |parameters: &Parameters, method| {
            let proposal = reference(Axis::X, method, parameters).unwrap();
            let (mut then, mut none) = (parameters.clone(), PitchTable::default());
            for change in proposal.changes {
                change.apply(&mut then, &mut none).unwrap();
            }
            then.value(parameter::ZERO_HIGH_SPEED)
        };
        let mut parameters = Parameters::default();
        let both = ZeroMethod::SwitchAndSignal;
        assert_eq!(approach(&parameters, both), 7600);
        parameters.set(parameter::Z_MULTIPLIER, 2).unwrap();
        let limit = gear_speed_limit(Axis::Z, &parameters).unwrap().floor() as i32;
        assert_eq!(approach(&parameters, both), limit);
        assert_eq!(
            approach(&parameters, ZeroMethod::OneSwitch),
            limit.min(5000)
        );
        parameters.set(parameter::Z_MULTIPLIER, 1).unwrap();
        parameters.set(parameter::X_MULTIPLIER, 4).unwrap();
        let limit = (2.0 * gear_speed_limit(Axis::X, &parameters).unwrap()).floor() as i32;
        assert_eq!(approach(&parameters, both), limit.min(7600));
    }

    #[test]
    fn the_sets_of_the_manual() {
        let parameters = Parameters::default();
        let stepper = acceleration(DriveKind::Stepper, &parameters).unwrap();
        let stepper = changed(&stepper);
        for row in [
            (parameter::X_RAPID, 2500),
            (parameter::Z_RAPID, 5000),
            (parameter::X_RAPID_TIME, 450),
            (parameter::THREAD_TIME, 250),
            (parameter::THREAD_LOW_SPEED, 50),
            (parameter::FEED_TIME, 250),
        ] {
            assert!(stepper.contains(&row), "{row:?} in {stepper:?}");
        }
        let one = reference(Axis::Z, ZeroMethod::OneSwitch, &parameters).unwrap();
        assert!(
            changed(&one).contains(&(7, 0b10))
                && changed(&one).contains(&(parameter::ZERO_HIGH_SPEED, 5000))
        );
        let none = reference(Axis::X, ZeroMethod::NoSwitch, &parameters).unwrap();
        assert_eq!(changed(&none), [(14, 0)]);
    }

    #[test]
    fn a_servo_keeps_a_fifth_in_reserve() {
        let parameters = Parameters::default();
        let lag = |seen, allowed| Lag {
            seen: Travel(seen),
            allowed: Travel(allowed),
        };
        let slower = largest_lag(Axis::Z, lag(3.0, 3.0), &parameters).unwrap();
        assert_eq!(changed(&slower), [(parameter::Z_RAPID, 6080)]);
        let fine = largest_lag(Axis::Z, lag(-1.0, 3.0), &parameters).unwrap();
        assert_eq!(changed(&fine), []);
        assert!(largest_lag(Axis::Z, lag(0.0, 3.0), &parameters).is_err());
    }

    #[test]
    fn the_voltage_is_set_right_before_the_speed() {
        let mut parameters = Parameters::default();
        let read = SpindleSpeed {
            gear: 2,
            rpm: 2200.0,
            volts: Some(11.0),
        };
        assert!(spindle(read, &parameters).is_err());
        parameters.set_bit(1, 4, true).unwrap();
        let right = spindle(read, &parameters).unwrap();
        assert_eq!(
            changed(&right),
            [
                (parameter::SPINDLE_GAIN, 568),
                (parameter::GEAR_SPEED_1 + 1, 2000)
            ]
        );
        assert!(spindle(SpindleSpeed { gear: 5, ..read }, &parameters).is_err());
    }

    #[test]
    fn the_play_is_measured_without_compensation() {
        let mut parameters = Parameters::default();
        let reading = |a, b| Backlash {
            a: Travel(a),
            b: Travel(b),
        };
        let readings = [reading(0.0, 0.022), reading(1.001, 1.025)];
        let play = backlash(Axis::X, &readings, &parameters).unwrap();
        assert_eq!(changed(&play), [(parameter::X_BACKLASH, 23)]);
        let said = play
            .notes
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>();
        assert_eq!(said, ["mean of 2 readings 23.0 µm, spread 2.0 µm"]);
        parameters.set(parameter::X_BACKLASH, 5).unwrap();
        assert!(backlash(Axis::X, &readings, &parameters).is_err());
        assert_eq!(
            changed(&backlash(Axis::X, &[], &parameters).unwrap()),
            [(parameter::X_BACKLASH, 0)]
        );
        assert!(backlash(Axis::Z, &[reading(0.0, 3.0)], &parameters).is_err());
    }
}
