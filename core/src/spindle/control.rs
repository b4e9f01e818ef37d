//! Commanded spindle speed with its limits, gears, and the analog output voltage.

use core::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::encoder::Encoder;
use crate::command::SpindleCommand;
use crate::memory::ControlParameters;
use crate::units::percent_to_factor;

/// The S word in force, with its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum SpeedMode {
    /// The spindle keeps this rotational speed, r/min (G97).
    Speed(f64),
    /// The tool keeps this surface speed, m/min (G96).
    Surface(f64),
}

/// A speed that temporarily replaces the commanded one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum SubstituteSpeed {
    /// The speed of 067, during a gear change.
    GearChange,
    /// The spindle has the speed of parameter 109, during spindle jog.
    Jog,
}

/// Inputs of the spindle control in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpindleInputs {
    /// Encoder count since the start, four per line.
    pub encoder: i64,
    /// Speed measured by a pulse board, r/min, which replaces the encoder; `None`: the
    /// encoder applies.
    #[serde(rename = "measured")]
    pub measured_rpm: Option<f64>,
    /// Radius for G96, mm: the programmed X without offset, sign ignored. During a rapid it
    /// is the radius of the end point.
    #[serde(rename = "radius")]
    pub radius_mm: f64,
    /// Spindle override, %; 100 = the programmed speed.
    pub override_percent: u8,
}

/// Parameters of the spindle, converted once for all ticks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct SpindleSettings {
    analog: bool,
    gears_usable: bool,
    #[serde(rename = "top")]
    top_rpm: [f64; 4],
    #[serde(rename = "lowest_surface")]
    min_surface_rpm: f64,
    #[serde(rename = "gear_change")]
    gear_change_rpm: f64,
    #[serde(rename = "jog")]
    jog_rpm: f64,
    gain: f64,
    zero_volts: f64,
    encoder_scale: f64,
}

impl SpindleSettings {
    fn new(parameters: &ControlParameters) -> Self {
        Self {
            analog: parameters.has_analog_spindle(),
            gears_usable: parameters.has_automatic_gears(),
            top_rpm: [1, 2, 3, 4].map(|gear| parameters.gear_top_speed(gear)),
            min_surface_rpm: parameters.lowest_surface_speed_rpm(),
            gear_change_rpm: parameters.gear_change_speed(),
            jog_rpm: parameters.spindle_jog_speed(),
            gain: f64::from(parameters.analog_gain()) / 625.0,
            zero_volts: f64::from(parameters.analog_zero()) * 10.0 / 8192.0,
            encoder_scale: Encoder::rpm_per_count(parameters),
        }
    }
}

/// The control's side of the spindle: commanded speed, gear and measured speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpindleControl {
    settings: SpindleSettings,
    mode: SpeedMode,
    /// Highest speed under G96 (G50 S), r/min; `None` until a G50 S is executed.
    limit: Option<f64>,
    /// Gear 1–4 whose top speed determines the voltage.
    gear: u8,
    /// Gear 1–4 of the last M41–M44; it comes into force at the end of the gear change.
    selected: u8,
    /// Whether the gear outputs match `selected`. False at power-on, when no output is on,
    /// and after an abandoned change.
    engaged: bool,
    #[serde(rename = "instead")]
    substitute: Option<SubstituteSpeed>,
    encoder: Encoder,
    #[serde(rename = "commanded")]
    rpm_commanded: f64,
    volts: f64,
    radius: f64,
    /// Spindle override as a factor; 1 = 100 %.
    factor: f64,
}

impl SpindleControl {
    /// State at power-on: no speed, gear 1, no limit.
    pub fn new(parameters: &ControlParameters) -> Self {
        let mut new = Self {
            settings: SpindleSettings::new(parameters),
            mode: SpeedMode::Speed(0.0),
            limit: None,
            gear: 1,
            selected: 1,
            engaged: false,
            substitute: None,
            encoder: Encoder::default(),
            rpm_commanded: 0.0,
            volts: 0.0,
            radius: 0.0,
            factor: 1.0,
        };
        new.volts = new.voltage();
        new
    }

    /// Applies changed parameters of the spindle.
    pub(crate) fn reconfigure(&mut self, parameters: &ControlParameters) {
        self.settings = SpindleSettings::new(parameters);
        self.volts = self.voltage();
    }

    /// Executes an S function. Speed steps (S00–S04) are handled by the PLC and change nothing in
    /// this struct.
    pub fn command(&mut self, command: SpindleCommand) {
        match command {
            SpindleCommand::Step(_) => {}
            SpindleCommand::Speed(speed) => self.mode = SpeedMode::Speed(speed.max(0.0)),
            SpindleCommand::Surface(speed) => self.mode = SpeedMode::Surface(speed.max(0.0)),
            SpindleCommand::Limit(limit) => self.limit = Some(limit.max(0.0)),
        }
        self.update_command();
    }

    /// Highest speed under G96 (G50 S), r/min; `None` until a G50 S is executed.
    pub const fn limit(&self) -> Option<f64> {
        self.limit
    }

    /// Whether constant surface speed (G96) is in force.
    pub const fn is_surface_mode(&self) -> bool {
        matches!(self.mode, SpeedMode::Surface(_))
    }

    /// The S value in force: r/min, or m/min under G96.
    pub const fn s_word(&self) -> f64 {
        match self.mode {
            SpeedMode::Speed(value) | SpeedMode::Surface(value) => value,
        }
    }

    /// Gear 1–4 whose top speed (037–040) applies; always 1 with 164.7 AGER = 0.
    pub const fn gear(&self) -> u8 {
        if self.settings.gears_usable {
            self.gear
        } else {
            1
        }
    }

    /// Returns the gear 1–4 that the signals GR10–GR40 report.
    pub(crate) const fn selected_gear(&self) -> u8 {
        self.selected
    }

    /// Selects a gear, 1–4 (M41–M44). Returns whether a gear change begins; the spindle
    /// then turns at the speed of 067 until [`Self::end_gear_change`].
    pub(crate) fn begin_gear_change(&mut self, gear: u8) -> bool {
        if !(1..=4).contains(&gear) || (self.engaged && self.selected == gear) {
            return false;
        }
        self.selected = gear;
        self.engaged = false;
        self.substitute = Some(SubstituteSpeed::GearChange);
        true
    }

    /// Ends the gear change (FIN of the ladder): the new gear applies from now on.
    pub(crate) fn end_gear_change(&mut self) {
        if self.is_changing_gear() {
            self.gear = self.selected;
            self.engaged = true;
            self.substitute = None;
            self.volts = self.voltage();
        }
    }

    /// Abandons the gear change at RESET: the old gear still applies, and the next M41–M44
    /// is always executed.
    pub(crate) fn abandon_gear_change(&mut self) {
        if self.is_changing_gear() {
            self.selected = self.gear;
            self.substitute = None;
        }
    }

    /// Whether a gear change is in progress.
    pub fn is_changing_gear(&self) -> bool {
        self.substitute == Some(SubstituteSpeed::GearChange)
    }

    /// Switches spindle jog on or off; on, the speed of 109 replaces the S word.
    pub(crate) fn set_jog(&mut self, active: bool) {
        if active && !self.is_changing_gear() {
            self.substitute = Some(SubstituteSpeed::Jog);
        } else if self.substitute == Some(SubstituteSpeed::Jog) {
            self.substitute = None;
        }
    }

    /// Speed at 10 V in the gear in force, r/min.
    pub const fn top_speed(&self) -> f64 {
        self.settings.top_rpm[(self.gear() - 1) as usize]
    }

    /// Spindle speed for a surface speed in m/min: n = 1000 v / (π d), at most the top
    /// speed of the gear, r/min.
    fn surface_rpm(&self, surface: f64) -> f64 {
        let circumference = 2.0 * PI * self.radius.abs();
        let top = self.top_speed();
        if surface <= 0.0 {
            0.0
        } else if 1000.0 * surface >= top * circumference {
            top
        } else {
            1000.0 * surface / circumference
        }
    }

    /// Limits a speed under G96, r/min: at least 043, at most G50 S, which takes
    /// precedence.
    fn limit_surface_rpm(&self, speed: f64) -> f64 {
        let raised = if speed > 0.0 {
            speed.max(self.settings.min_surface_rpm)
        } else {
            0.0
        };
        raised.min(self.limit.unwrap_or(f64::INFINITY))
    }

    /// Advances by one tick (1 ms): measures the speed and updates the commanded one.
    pub fn tick(&mut self, inputs: &SpindleInputs) {
        match inputs.measured_rpm {
            Some(rpm) => self.encoder.set_measured_rpm(rpm),
            None => self
                .encoder
                .tick(inputs.encoder, self.settings.encoder_scale),
        }
        self.radius = inputs.radius_mm;
        self.factor = percent_to_factor(inputs.override_percent);
        self.update_command();
    }

    fn update_command(&mut self) {
        let commanded = match (self.substitute, self.mode) {
            (Some(SubstituteSpeed::GearChange), _) => self.settings.gear_change_rpm,
            (Some(SubstituteSpeed::Jog), _) => self.settings.jog_rpm,
            (None, SpeedMode::Speed(speed)) => speed * self.factor,
            (None, SpeedMode::Surface(speed)) => {
                self.limit_surface_rpm(self.surface_rpm(speed) * self.factor)
            }
        };
        if commanded != self.rpm_commanded {
            self.rpm_commanded = commanded;
            self.volts = self.voltage();
        }
    }

    /// Voltage SVC for the commanded speed, 0–10 V; 0 with switched speeds (001.4 = 0). It
    /// stays valid until the speed, the gear or a parameter changes.
    fn voltage(&self) -> f64 {
        let top = self.top_speed();
        if !self.settings.analog || top <= 0.0 {
            return 0.0;
        }
        (10.0 * self.rpm_commanded / top * self.settings.gain + self.settings.zero_volts)
            .clamp(0.0, 10.0)
    }

    /// Returns the commanded speed after override and limits, r/min.
    pub(crate) const fn commanded_rpm(&self) -> f64 {
        self.rpm_commanded
    }

    /// Returns the analog output SVC in force, 0–10 V.
    pub const fn volts(&self) -> f64 {
        self.volts
    }

    /// Returns the measured speed, r/min; negative in reverse.
    pub const fn actual_rpm(&self) -> f64 {
        self.encoder.rpm()
    }

    /// Whether the encoder has counted since power-on, which shows that one is fitted.
    pub(crate) const fn has_encoder(&self) -> bool {
        self.encoder.has_counted()
    }
}
