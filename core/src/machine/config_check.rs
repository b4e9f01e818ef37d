//! Checks the rules of a machine file.

use core::fmt;

use super::config::{AxisConfig, LatheConfig};
use super::load_limits::LoadLimits;
use super::picture_config::{LatheConstruction, PictureConfig};
use crate::units::Axis;
use gsk_link::LinkConfig;
use gsk_messages::{Message, say};

/// A field of the machine file with an invalid value, and the rule it breaks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfigError {
    /// Path of the field in the machine file, such as `x.limits.minus`.
    pub field: String,
    /// Message about what is wrong, and which values are valid.
    pub rule: Message,
}

impl ConfigError {
    /// Joins the field and its rule to one message.
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

/// Greatest length that is accepted, mm. The next constants are the limits of the spindle speed and
/// of times.
const MAX_LENGTH_MM: f64 = 9999.999;
const MAX_SPEED_RPM: f64 = 99_999.0;
const MAX_TIME_MS: u32 = 600_000;
/// Greatest error of a screw, and its greatest change, mm per mm.
const MAX_SCREW_ERROR_MM: f64 = 1.0;
const MAX_SCREW_SLOPE: f64 = 0.01;

/// Number of station contacts T01 to T08, and highest number of stations in 084.
const STATION_CONTACTS: u8 = 8;
const MAX_STATIONS: u8 = 32;
/// Greatest distance of a steady rest from the chuck, mm.
const MAX_STEADY_REST_MM: f64 = 5000.0;

struct ConfigCheck(Vec<ConfigError>);

impl ConfigCheck {
    fn check_rule(&mut self, is_met: bool, field: impl Into<String>, rule: Message) {
        if !is_met {
            self.0.push(ConfigError {
                field: field.into(),
                rule,
            });
        }
    }

    fn check_length(&mut self, value: f64, field: String) {
        let rule = say::machine_length_wrong(value);
        self.check_rule(
            value.is_finite() && value.abs() <= MAX_LENGTH_MM,
            field,
            rule,
        );
    }

    fn check_time(&mut self, ms: u32, min_ms: u32, field: &str) {
        let rule = say::machine_time_wrong(ms, min_ms, MAX_TIME_MS);
        self.check_rule((min_ms..=MAX_TIME_MS).contains(&ms), field, rule);
    }

    fn check_load(&mut self, load: &LoadLimits) {
        let values = [
            ("load.power_kw", load.power_kw),
            ("load.base_rpm", load.base_rpm),
            ("load.stock_overhang", load.stock_overhang),
            ("load.bar_overhang", Some(load.bar_overhang)),
            ("load.size_error_mm", Some(load.size_error_mm)),
            ("load.axis_force_n", load.axis_force_n),
            ("load.grip_nm", load.grip_nm),
        ];
        for (field, value) in values {
            let Some(value) = value else { continue };
            let is_met = value > 0.0 && value <= MAX_SPEED_RPM;
            self.check_rule(is_met, field, say::machine_load_wrong(value));
        }
    }

    fn check_picture(&mut self, picture: &PictureConfig, rear_tool_post: bool) {
        let is_slant = |it: LatheConstruction| it == LatheConstruction::SlantBed;
        self.check_rule(
            picture
                .construction
                .is_none_or(|it| is_slant(it) == rear_tool_post),
            "picture.construction",
            say::machine_construction_wrong(),
        );
        if let Some(distance) = picture.steady_rest {
            self.check_rule(
                distance > 0.0 && distance <= MAX_STEADY_REST_MM,
                "picture.steady_rest",
                say::machine_steady_rest_wrong(distance, MAX_STEADY_REST_MM),
            );
        }
        if let Err((lamp, address)) = picture.tower.addresses() {
            self.check_rule(
                false,
                format!("picture.tower.{lamp}"),
                say::machine_lamp_wrong(address),
            );
        }
    }

    fn check_axis(&mut self, which: Axis, axis: &AxisConfig) {
        let name = match which {
            Axis::X => 'x',
            Axis::Z => 'z',
        };
        let field = |part: &str| format!("{name}.{part}");
        self.check_length(axis.start, field("start"));
        self.check_ends(which, axis, &field);
        if let Some(limits) = axis.limits {
            self.check_length(limits.minus, field("limits.minus"));
            self.check_length(limits.plus, field("limits.plus"));
            self.check_rule(
                limits.minus < limits.plus,
                field("limits"),
                say::machine_ends_reversed(limits.minus, limits.plus),
            );
            self.check_rule(
                (limits.minus..=limits.plus).contains(&axis.start),
                field("start"),
                say::machine_start_beyond_limits(axis.start, limits.minus, limits.plus),
            );
        }
        if let Some(dog) = axis.dog {
            self.check_length(dog.from, field("dog.from"));
            self.check_length(dog.to, field("dog.to"));
            self.check_rule(
                dog.from < dog.to,
                field("dog"),
                say::machine_dog_reversed(dog.from, dog.to),
            );
            if let Some(limits) = axis.limits {
                self.check_rule(
                    limits.minus <= dog.from && dog.to <= limits.plus,
                    field("dog"),
                    say::machine_dog_beyond_limits(dog.from, dog.to, limits.minus, limits.plus),
                );
            }
        }
        let turn = axis.motor_turn;
        self.check_rule(
            turn.is_finite() && turn > 0.0 && turn <= 1000.0,
            field("motor_turn"),
            say::machine_motor_turn_wrong(turn),
        );
        if let Some(pulse) = axis.pulse {
            self.check_rule(
                pulse.is_finite() && pulse > 0.0 && pulse <= 1.0,
                field("pulse"),
                say::machine_pulse_wrong(pulse),
            );
        }
        self.check_rule(
            axis.backlash.is_finite() && (0.0..=10.0).contains(&axis.backlash),
            field("backlash"),
            say::machine_backlash_wrong(axis.backlash),
        );
        self.check_screw(axis, &field);
        if let Some(servo) = axis.servo {
            self.check_rule(
                servo.gain.is_finite() && (1.0..=1000.0).contains(&servo.gain),
                field("servo.gain"),
                say::machine_gain_wrong(servo.gain),
            );
            self.check_rule(
                servo.largest_error.is_finite() && servo.largest_error > 0.0,
                field("servo.largest_error"),
                say::machine_error_wrong(servo.largest_error),
            );
        }
    }
}

impl ConfigCheck {
    /// Checks that the screw errors are in order, and none is large enough to reverse a
    /// motion.
    fn check_screw(&mut self, axis: &AxisConfig, field: &impl Fn(&str) -> String) {
        for point in &axis.pitch_errors {
            self.check_length(point.at, field("pitch_errors.at"));
            self.check_rule(
                point.error.is_finite() && point.error.abs() <= MAX_SCREW_ERROR_MM,
                field("pitch_errors.error"),
                say::machine_screw_error_wrong(point.error, MAX_SCREW_ERROR_MM),
            );
        }
        for (previous, next) in axis
            .pitch_errors
            .iter()
            .zip(axis.pitch_errors.iter().skip(1))
        {
            self.check_rule(
                next.at > previous.at,
                field("pitch_errors"),
                say::machine_screw_order(next.at, previous.at),
            );
            let change = (next.error - previous.error).abs();
            self.check_rule(
                next.at <= previous.at || change <= MAX_SCREW_SLOPE * (next.at - previous.at),
                field("pitch_errors"),
                say::machine_screw_steep(change, previous.at, next.at),
            );
        }
    }

    /// Checks that start, switches and dog are within the travel of the slide.
    fn check_ends(&mut self, which: Axis, axis: &AxisConfig, field: &impl Fn(&str) -> String) {
        if let Some(ends) = axis.ends {
            self.check_length(ends.minus, field("ends.minus"));
            self.check_length(ends.plus, field("ends.plus"));
            self.check_rule(
                ends.minus < ends.plus,
                field("ends"),
                say::machine_ends_reversed(ends.minus, ends.plus),
            );
        }
        let ends = axis.slide_ends(which);
        let within = ends.minus..=ends.plus;
        let ends_text = || say::machine_slide_ends(ends.minus, ends.plus);
        if let Some(limits) = axis.limits {
            self.check_rule(
                within.contains(&limits.minus) && within.contains(&limits.plus),
                field("limits"),
                say::machine_limits_beyond_slide(limits.minus, limits.plus, ends_text()),
            );
            // The limits include the start and the dog.
            return;
        }
        self.check_rule(
            within.contains(&axis.start),
            field("start"),
            say::machine_start_beyond_slide(axis.start, ends_text()),
        );
        if let Some(dog) = axis.dog {
            self.check_rule(
                within.contains(&dog.from) && within.contains(&dog.to),
                field("dog"),
                say::machine_dog_beyond_slide(dog.from, dog.to, ends_text()),
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
        let mut check = ConfigCheck(Vec::new());
        check.check_rule(
            !self.name.trim().is_empty(),
            "name",
            say::machine_name_missing(),
        );
        check.check_axis(Axis::X, &self.x);
        check.check_axis(Axis::Z, &self.z);
        let turret = &self.turret;
        let (max_stations, rule) = if turret.coded {
            (MAX_STATIONS, say::machine_stations_of_code())
        } else {
            (STATION_CONTACTS, say::machine_stations_of_contacts())
        };
        let stations = turret.stations.unwrap_or(max_stations);
        check.check_rule(
            stations <= max_stations,
            "turret.stations",
            say::machine_too_many_stations(stations, max_stations, rule),
        );
        check.check_rule(
            turret.first >= 1 && turret.first <= stations.max(1),
            "turret.first",
            say::machine_station_wrong(turret.first, stations),
        );
        check.check_time(turret.station_ms, 1, "turret.station_ms");
        check.check_time(turret.clamp_ms, 0, "turret.clamp_ms");
        let window = turret.window;
        check.check_rule(
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
            check.check_rule(
                speed.is_finite() && (0.0..=MAX_SPEED_RPM).contains(&speed),
                name,
                say::machine_speed_wrong(speed),
            );
        }
        check.check_time(spindle.settle_ms, 1, "spindle.settle_ms");
        if let Some(lines) = spindle.encoder_lines {
            check.check_rule(
                lines == 0 || (100..=5000).contains(&lines),
                "spindle.encoder_lines",
                say::machine_encoder_lines_wrong(lines),
            );
        }
        check.check_time(self.chuck.travel_ms, 1, "chuck.travel_ms");
        check.check_load(&self.load);
        check.check_picture(&self.picture, self.rear_tool_post);
        if let Some(Err(error)) = self.link.as_ref().map(LinkConfig::check) {
            check.check_rule(
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
