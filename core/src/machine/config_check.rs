//! Checks the rules of a machine file.

use core::fmt;

use super::config::{AxisConfig, LatheConfig};
use crate::units::Axis;
use gsk_link::LinkConfig;
use gsk_messages::{Message, say};

/// A field of the machine file with an invalid value, and the rule it breaks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfigError {
    /// Path of the field, such as `x.limits.minus`.
    pub field: String,
    /// What is wrong and which values are valid.
    pub rule: Message,
}

impl ConfigError {
    /// Field and rule as one message.
    pub fn message(&self) -> Message {
        say::machine_field(&self.field, self.rule.clone())
    }
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.message().fmt(f)
    }
}

impl core::error::Error for ConfigError {}

/// Longest slide, fastest spindle and longest time that are accepted.
const LONGEST_MM: f64 = 9999.999;
const FASTEST_RPM: f64 = 99_999.0;
const LONGEST_MS: u32 = 600_000;
/// Greatest error of a screw, and its greatest change, mm per mm.
const LARGEST_SCREW_ERROR_MM: f64 = 1.0;
const STEEPEST_SCREW: f64 = 0.01;

/// Number of station contacts T01 to T08, and highest number of stations in 084.
const CONTACTS: u8 = 8;
const MOST_STATIONS: u8 = 32;

struct Check(Vec<ConfigError>);

impl Check {
    fn rule(&mut self, holds: bool, field: impl Into<String>, rule: Message) {
        if !holds {
            self.0.push(ConfigError {
                field: field.into(),
                rule,
            });
        }
    }

    fn length(&mut self, value: f64, field: String) {
        let rule = say::machine_length_wrong(value);
        self.rule(value.is_finite() && value.abs() <= LONGEST_MM, field, rule);
    }

    fn time(&mut self, ms: u32, least: u32, field: &str) {
        let rule = say::machine_time_wrong(ms, least, LONGEST_MS);
        self.rule((least..=LONGEST_MS).contains(&ms), field, rule);
    }

    fn axis(&mut self, which: Axis, axis: &AxisConfig) {
        let name = match which {
            Axis::X => 'x',
            Axis::Z => 'z',
        };
        let field = |part: &str| format!("{name}.{part}");
        self.length(axis.start, field("start"));
        self.ends(which, axis, &field);
        if let Some(limits) = axis.limits {
            self.length(limits.minus, field("limits.minus"));
            self.length(limits.plus, field("limits.plus"));
            self.rule(
                limits.minus < limits.plus,
                field("limits"),
                say::machine_ends_reversed(limits.minus, limits.plus),
            );
            self.rule(
                (limits.minus..=limits.plus).contains(&axis.start),
                field("start"),
                say::machine_start_beyond_limits(axis.start, limits.minus, limits.plus),
            );
        }
        if let Some(dog) = axis.dog {
            self.length(dog.from, field("dog.from"));
            self.length(dog.to, field("dog.to"));
            self.rule(
                dog.from < dog.to,
                field("dog"),
                say::machine_dog_reversed(dog.from, dog.to),
            );
            if let Some(limits) = axis.limits {
                self.rule(
                    limits.minus <= dog.from && dog.to <= limits.plus,
                    field("dog"),
                    say::machine_dog_beyond_limits(dog.from, dog.to, limits.minus, limits.plus),
                );
            }
        }
        let turn = axis.motor_turn;
        self.rule(
            turn.is_finite() && turn > 0.0 && turn <= 1000.0,
            field("motor_turn"),
            say::machine_motor_turn_wrong(turn),
        );
        if let Some(pulse) = axis.pulse {
            self.rule(
                pulse.is_finite() && pulse > 0.0 && pulse <= 1.0,
                field("pulse"),
                say::machine_pulse_wrong(pulse),
            );
        }
        self.rule(
            axis.backlash.is_finite() && (0.0..=10.0).contains(&axis.backlash),
            field("backlash"),
            say::machine_backlash_wrong(axis.backlash),
        );
        self.screw(axis, &field);
        if let Some(servo) = axis.servo {
            self.rule(
                servo.gain.is_finite() && (1.0..=1000.0).contains(&servo.gain),
                field("servo.gain"),
                say::machine_gain_wrong(servo.gain),
            );
            self.rule(
                servo.largest_error.is_finite() && servo.largest_error > 0.0,
                field("servo.largest_error"),
                say::machine_error_wrong(servo.largest_error),
            );
        }
    }
}

impl Check {
    /// Checks the screw errors: in order, and none large enough to reverse a motion.
    fn screw(&mut self, axis: &AxisConfig, field: &impl Fn(&str) -> String) {
        for point in &axis.pitch_errors {
            self.length(point.at, field("pitch_errors.at"));
            self.rule(
                point.error.is_finite() && point.error.abs() <= LARGEST_SCREW_ERROR_MM,
                field("pitch_errors.error"),
                say::machine_screw_error_wrong(point.error, LARGEST_SCREW_ERROR_MM),
            );
        }
        for (one, next) in axis
            .pitch_errors
            .iter()
            .zip(axis.pitch_errors.iter().skip(1))
        {
            self.rule(
                next.at > one.at,
                field("pitch_errors"),
                say::machine_screw_order(next.at, one.at),
            );
            let change = (next.error - one.error).abs();
            self.rule(
                next.at <= one.at || change <= STEEPEST_SCREW * (next.at - one.at),
                field("pitch_errors"),
                say::machine_screw_steep(change, one.at, next.at),
            );
        }
    }

    /// Checks that start, switches and dog are within the travel of the slide.
    fn ends(&mut self, which: Axis, axis: &AxisConfig, field: &impl Fn(&str) -> String) {
        if let Some(ends) = axis.ends {
            self.length(ends.minus, field("ends.minus"));
            self.length(ends.plus, field("ends.plus"));
            self.rule(
                ends.minus < ends.plus,
                field("ends"),
                say::machine_ends_reversed(ends.minus, ends.plus),
            );
        }
        let ends = axis.slide_ends(which);
        let within = ends.minus..=ends.plus;
        let said = || say::machine_slide_ends(ends.minus, ends.plus);
        if let Some(limits) = axis.limits {
            self.rule(
                within.contains(&limits.minus) && within.contains(&limits.plus),
                field("limits"),
                say::machine_limits_beyond_slide(limits.minus, limits.plus, said()),
            );
            // The limits include the start and the dog.
            return;
        }
        self.rule(
            within.contains(&axis.start),
            field("start"),
            say::machine_start_beyond_slide(axis.start, said()),
        );
        if let Some(dog) = axis.dog {
            self.rule(
                within.contains(&dog.from) && within.contains(&dog.to),
                field("dog"),
                say::machine_dog_beyond_slide(dog.from, dog.to, said()),
            );
        }
    }
}

impl LatheConfig {
    /// Checks all rules of the machine file.
    ///
    /// # Errors
    /// All fields that break a rule, in the order of the file.
    pub fn check(&self) -> Result<(), Vec<ConfigError>> {
        let mut check = Check(Vec::new());
        check.rule(
            !self.name.trim().is_empty(),
            "name",
            say::machine_name_missing(),
        );
        check.axis(Axis::X, &self.x);
        check.axis(Axis::Z, &self.z);
        let turret = &self.turret;
        let (most, rule) = if turret.coded {
            (MOST_STATIONS, say::machine_stations_of_code())
        } else {
            (CONTACTS, say::machine_stations_of_contacts())
        };
        let stations = turret.stations.unwrap_or(most);
        check.rule(
            stations <= most,
            "turret.stations",
            say::machine_too_many_stations(stations, most, rule),
        );
        check.rule(
            turret.first >= 1 && turret.first <= stations.max(1),
            "turret.first",
            say::machine_station_wrong(turret.first, stations),
        );
        check.time(turret.station_ms, 1, "turret.station_ms");
        check.time(turret.clamp_ms, 0, "turret.clamp_ms");
        let window = turret.window;
        check.rule(
            window > 0.0 && window < 0.5,
            "turret.window",
            say::machine_window_wrong(window),
        );
        let spindle = &self.spindle;
        let tops = spindle.top.into_iter().flatten();
        for (name, speed) in tops
            .map(|speed| ("spindle.top", speed))
            .chain(spindle.steps.map(|speed| ("spindle.steps", speed)))
        {
            check.rule(
                speed.is_finite() && (0.0..=FASTEST_RPM).contains(&speed),
                name,
                say::machine_speed_wrong(speed),
            );
        }
        check.time(spindle.settle_ms, 1, "spindle.settle_ms");
        if let Some(lines) = spindle.encoder_lines {
            check.rule(
                lines == 0 || (100..=5000).contains(&lines),
                "spindle.encoder_lines",
                say::machine_encoder_lines_wrong(lines),
            );
        }
        check.time(self.chuck.travel_ms, 1, "chuck.travel_ms");
        if let Some(Err(error)) = self.link.as_ref().map(LinkConfig::check) {
            check.rule(
                false,
                format!("link.{}", error.field),
                error.fault.message(),
            );
        }
        if check.0.is_empty() {
            Ok(())
        } else {
            Err(check.0)
        }
    }
}
