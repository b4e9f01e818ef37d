//! The rules of a machine file.

use core::fmt;

use super::config::{AxisConfig, LatheConfig};
use super::link::LinkConfig;

/// A field of the machine file that cannot be, and the rule it breaks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfigError {
    /// The field, as `x.limits.minus`.
    pub field: String,
    /// What is wrong and what is wanted.
    pub rule: String,
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.field, self.rule)
    }
}

impl core::error::Error for ConfigError {}

/// Longest slide, and fastest spindle, that make sense.
const LONGEST_MM: f64 = 9999.999;
const FASTEST_RPM: f64 = 99_999.0;
const LONGEST_MS: u32 = 600_000;

/// Station contacts T01 to T08, and stations that 084 can say.
const CONTACTS: u8 = 8;
const MOST_STATIONS: u8 = 32;

struct Check(Vec<ConfigError>);

impl Check {
    fn rule(&mut self, holds: bool, field: impl Into<String>, rule: impl Into<String>) {
        if !holds {
            self.0.push(ConfigError {
                field: field.into(),
                rule: rule.into(),
            });
        }
    }

    fn length(&mut self, value: f64, field: String) {
        let rule = format!("{value} is no place: lengths go from -9999.999 to 9999.999 mm");
        self.rule(value.is_finite() && value.abs() <= LONGEST_MM, field, rule);
    }

    fn time(&mut self, ms: u32, least: u32, field: &str) {
        let rule = format!("{ms} ms is not from {least} to {LONGEST_MS} ms");
        self.rule((least..=LONGEST_MS).contains(&ms), field, rule);
    }

    fn axis(&mut self, name: &str, axis: &AxisConfig) {
        let field = |part: &str| format!("{name}.{part}");
        self.length(axis.start, field("start"));
        if let Some(limits) = axis.limits {
            self.length(limits.minus, field("limits.minus"));
            self.length(limits.plus, field("limits.plus"));
            self.rule(
                limits.minus < limits.plus,
                field("limits"),
                format!("minus {} must lie below plus {}", limits.minus, limits.plus),
            );
            self.rule(
                (limits.minus..=limits.plus).contains(&axis.start),
                field("start"),
                format!(
                    "{} lies beyond the limit switches {} to {}",
                    axis.start, limits.minus, limits.plus
                ),
            );
        }
        if let Some(dog) = axis.dog {
            self.length(dog.from, field("dog.from"));
            self.length(dog.to, field("dog.to"));
            self.rule(
                dog.from < dog.to,
                field("dog"),
                format!("from {} must lie below to {}", dog.from, dog.to),
            );
            if let Some(limits) = axis.limits {
                self.rule(
                    limits.minus <= dog.from && dog.to <= limits.plus,
                    field("dog"),
                    format!(
                        "{} to {} does not lie within the limit switches {} to {}",
                        dog.from, dog.to, limits.minus, limits.plus
                    ),
                );
            }
        }
        let turn = axis.motor_turn;
        self.rule(
            turn.is_finite() && turn > 0.0 && turn <= 1000.0,
            field("motor_turn"),
            format!("{turn} is not above 0 and at most 1000 mm"),
        );
        if let Some(pulse) = axis.pulse {
            self.rule(
                pulse.is_finite() && pulse > 0.0 && pulse <= 1.0,
                field("pulse"),
                format!("{pulse} is not above 0 and at most 1 mm; `reversed` gives the direction"),
            );
        }
        self.rule(
            axis.backlash.is_finite() && (0.0..=10.0).contains(&axis.backlash),
            field("backlash"),
            format!("{} is not from 0 to 10 mm", axis.backlash),
        );
        if let Some(servo) = axis.servo {
            self.rule(
                servo.gain.is_finite() && (1.0..=1000.0).contains(&servo.gain),
                field("servo.gain"),
                format!("{} is not from 1 to 1000", servo.gain),
            );
            self.rule(
                servo.largest_error.is_finite() && servo.largest_error > 0.0,
                field("servo.largest_error"),
                format!("{} is not above 0 mm", servo.largest_error),
            );
        }
    }
}

impl LatheConfig {
    /// Checks every rule.
    ///
    /// # Errors
    /// All fields that break one, in the order of the file.
    pub fn check(&self) -> Result<(), Vec<ConfigError>> {
        let mut check = Check(Vec::new());
        check.rule(!self.name.trim().is_empty(), "name", "must not be empty");
        check.axis("x", &self.x);
        check.axis("z", &self.z);
        let turret = &self.turret;
        let (most, rule) = if turret.coded {
            (MOST_STATIONS, "084 counts no more")
        } else {
            (
                CONTACTS,
                "there is a contact T01 to T08 for each station; `coded: true` and a ladder that reads the code serve 32",
            )
        };
        let stations = turret.stations.unwrap_or(most);
        check.rule(
            stations <= most,
            "turret.stations",
            format!("{stations} is more than {most}: {rule}"),
        );
        check.rule(
            turret.first >= 1 && turret.first <= stations.max(1),
            "turret.first",
            format!("{} is no station: they are 1 to {stations}", turret.first),
        );
        check.time(turret.station_ms, 1, "turret.station_ms");
        check.time(turret.clamp_ms, 0, "turret.clamp_ms");
        let window = turret.window;
        check.rule(
            window > 0.0 && window < 0.5,
            "turret.window",
            format!("{window} is not between 0 and 0.5 of a pitch"),
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
                format!("{speed} is not from 0 to 99999 r/min"),
            );
        }
        check.time(spindle.settle_ms, 1, "spindle.settle_ms");
        if let Some(lines) = spindle.encoder_lines {
            check.rule(
                lines == 0 || (100..=5000).contains(&lines),
                "spindle.encoder_lines",
                format!("{lines} is neither 0 (no encoder) nor 100 to 5000"),
            );
        }
        check.time(self.chuck.travel_ms, 1, "chuck.travel_ms");
        if let Some(Err(error)) = self.link.as_ref().map(LinkConfig::check) {
            check.rule(
                false,
                format!("link.{}", error.field),
                error.fault.to_string(),
            );
        }
        if check.0.is_empty() {
            Ok(())
        } else {
            Err(check.0)
        }
    }
}
