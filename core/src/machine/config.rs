//! The machine file (RON), which describes a lathe; all fields have defaults.

use serde::{Deserialize, Serialize};

use super::load_limits::LoadLimits;
use super::picture_config::PictureConfig;
use crate::units::{Axis, Diameter, Point};
use gsk_link::LinkConfig;

/// Default distance from a limit switch to the end of the slide, mm of slide travel.
const OVERRUN_MM: f64 = 10.0;
/// The longest travel that a program can command, mm (alarm 043).
const STROKE_MM: f64 = 9999.999;
/// Limit switches of the training lathe's cross slide, mm (diameter).
const X_LIMITS: LimitSwitches = LimitSwitches {
    minus: -310.0,
    plus: 10.0,
};
const Z_LIMITS: LimitSwitches = LimitSwitches {
    minus: -505.0,
    plus: 5.0,
};

/// Description of a simulated lathe.
///
/// Lengths of X are slide travel on the *diameter* scale of the displays, as on a machine's
/// rating plate. All positions are machine coordinates, zero = reference point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LatheConfig {
    /// Name of the lathe in lists and titles.
    pub name: String,
    /// Whether the tool post is on the rear side of the spindle axis, where X+ points up the
    /// picture (manual I-3.1.1 to I-3.1.3). The lathe as delivered has a front tool post: the
    /// keys of parameter 175.0 = 0 agree with its picture.
    pub rear_tool_post: bool,
    /// Parameters that the control of this lathe needs, each `N=V` or `N.B=0|1`. A control whose
    /// parameters are still as delivered gets them at power-on.
    pub parameters: Vec<String>,
    /// The cross slide; its lengths are diameters, mm.
    #[serde(with = "CrossSlide")]
    pub x: AxisConfig,
    /// The carriage; its lengths are in mm.
    pub z: AxisConfig,
    /// The tool post, with the number of its stations.
    pub turret: TurretConfig,
    /// The main spindle with inverter, gears and encoder.
    pub spindle: SpindleConfig,
    /// Time that chuck, tailstock and gears take to move.
    pub chuck: ChuckConfig,
    /// Limits of spindle and bars under the load of a cut.
    pub load: LoadLimits,
    /// The appearance of the lathe in the 3D view.
    pub picture: PictureConfig,
    /// The pulse board of a real lathe; `None`: the lathe is simulated only.
    pub link: Option<LinkConfig>,
}

impl Default for LatheConfig {
    /// The training lathe: 4 stations, dogs, limit switches, and slide ends beyond them.
    fn default() -> Self {
        Self {
            name: "training lathe".to_owned(),
            rear_tool_post: false,
            parameters: Vec::new(),
            x: AxisConfig::cross_slide(),
            z: AxisConfig::default(),
            turret: TurretConfig::default(),
            spindle: SpindleConfig::default(),
            chuck: ChuckConfig::default(),
            load: LoadLimits::default(),
            picture: PictureConfig::default(),
            link: None,
        }
    }
}

impl LatheConfig {
    /// A lathe without dogs and limit switches, at its machine zero, with the longest
    /// possible slides: for runs whose coordinates do not belong to a real machine.
    pub fn without_limits() -> Self {
        let remove_limits = |axis: AxisConfig| AxisConfig {
            start: 0.0,
            limits: None,
            ends: Some(SlideEnds {
                minus: -STROKE_MM,
                plus: STROKE_MM,
            }),
            dog: None,
            ..axis
        };
        let lathe = Self::default();
        Self {
            name: "lathe without limits".to_owned(),
            x: remove_limits(lathe.x),
            z: remove_limits(lathe.z),
            ..lathe
        }
    }

    /// Positions of the slides at the start, machine coordinates in mm, X as a radius.
    pub const fn start(&self) -> Point {
        Point::from_diameter(Diameter(self.x.start), self.z.start)
    }

    /// The training lathe with long slides on both sides of its machine zero, for operator
    /// scripts that name no machine. It starts at its machine zero.
    pub fn with_long_slides() -> Self {
        let extend = |axis: AxisConfig, end: f64| AxisConfig {
            start: 0.0,
            limits: Some(LimitSwitches {
                minus: -end,
                plus: end,
            }),
            ..axis
        };
        let lathe = Self::default();
        Self {
            name: "training lathe with long slides".to_owned(),
            x: extend(lathe.x, 1000.0),
            // The longest pitch error table reaches 2550 mm.
            z: extend(lathe.z, 2600.0),
            ..lathe
        }
    }
}

/// One slide with its screw, drive and switches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AxisConfig {
    /// Position of the slide at the start, machine coordinate in mm.
    pub start: f64,
    /// Positions of the limit switches, which open the emergency-stop loop; `None`: no
    /// limit switches.
    pub limits: Option<LimitSwitches>,
    /// Mechanical ends of the slide. `None`: 10 mm of slide travel beyond the limit
    /// switches; without switches, the ends of the training lathe.
    pub ends: Option<SlideEnds>,
    /// Range of the deceleration dog for the reference return; `None`: no dog.
    pub dog: Option<Dog>,
    /// Travel per motor revolution, mm. The zero signal comes once per revolution, at zero.
    pub motor_turn: f64,
    /// Slide travel of one pulse, mm in radius. `None`: set to match the parameters (CMR,
    /// CMD, direction) at the time of wiring.
    pub pulse: Option<f64>,
    /// Play of the screw, mm, which 034 and 035 compensate.
    pub backlash: f64,
    /// Errors of the screw, from minus to plus, which the pitch error table compensates.
    /// Between two points the error is interpolated, beyond the last ones it stays
    /// constant.
    pub pitch_errors: Vec<ScrewError>,
    /// Position loop of the drive; `None`: a stepper, which follows each pulse.
    pub servo: Option<ServoConfig>,
    /// Whether the motor turns opposite to the default of 008: the slide moves against its
    /// command until 008 is changed.
    pub reversed: bool,
    /// Whether the drive has a one-turn signal. Without it reference return needs one
    /// switch for deceleration and zero (007 ZC = 1).
    pub one_turn_signal: bool,
    /// Whether the drive's alarm output is wired to the control.
    pub alarm_line: bool,
}

/// Fields of the cross slide in a file. Missing fields have the values of the training
/// lathe's cross slide, not of its carriage.
#[derive(Serialize, Deserialize)]
#[serde(
    remote = "AxisConfig",
    default = "AxisConfig::cross_slide",
    deny_unknown_fields
)]
struct CrossSlide {
    start: f64,
    limits: Option<LimitSwitches>,
    ends: Option<SlideEnds>,
    dog: Option<Dog>,
    motor_turn: f64,
    pulse: Option<f64>,
    backlash: f64,
    pitch_errors: Vec<ScrewError>,
    servo: Option<ServoConfig>,
    reversed: bool,
    one_turn_signal: bool,
    alarm_line: bool,
}

impl AxisConfig {
    /// The mechanical ends of the slide: from the machine file, or else their defaults.
    pub fn slide_ends(&self, axis: Axis) -> SlideEnds {
        self.ends.unwrap_or_else(|| {
            let (default_limits, overrun) = match axis {
                Axis::X => (X_LIMITS, 2.0 * OVERRUN_MM),
                Axis::Z => (Z_LIMITS, OVERRUN_MM),
            };
            let limits = self.limits.unwrap_or(default_limits);
            SlideEnds {
                minus: limits.minus - overrun,
                plus: limits.plus + overrun,
            }
        })
    }

    /// Returns the values of the training lathe's cross slide.
    fn cross_slide() -> Self {
        Self {
            start: -100.0,
            limits: Some(X_LIMITS),
            dog: Some(Dog {
                from: -60.0,
                to: -10.0,
            }),
            motor_turn: 20.0,
            ..Self::default()
        }
    }
}

impl Default for AxisConfig {
    /// Returns the values of the training lathe's carriage.
    fn default() -> Self {
        Self {
            start: -150.0,
            limits: Some(Z_LIMITS),
            ends: None,
            dog: Some(Dog {
                from: -30.0,
                to: -5.0,
            }),
            motor_turn: 10.0,
            pulse: None,
            backlash: 0.0,
            pitch_errors: Vec::new(),
            servo: None,
            reversed: false,
            one_turn_signal: true,
            alarm_line: true,
        }
    }
}

/// Position loop of a servo drive: the motor follows the pulses with a following error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ServoConfig {
    /// Speed of the motor per following error, (mm/s)/mm; 1 to 1000.
    pub gain: f64,
    /// Following error above which the drive switches off, mm.
    pub largest_error: f64,
}

impl Default for ServoConfig {
    fn default() -> Self {
        Self {
            gain: 40.0,
            largest_error: 10.0,
        }
    }
}

/// Error of the screw at one position, mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScrewError {
    /// Position of the slide according to the turns of the screw, mm.
    pub at: f64,
    /// Distance of the slide beyond that position, towards plus, mm.
    pub error: f64,
}

/// Machine coordinates at which the limit switches trip, mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LimitSwitches {
    /// Machine coordinate of the switch at the negative end, mm.
    pub minus: f64,
    /// Machine coordinate of the switch at the positive end, mm.
    pub plus: f64,
}

/// Machine coordinates of the mechanical ends of a slide, mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlideEnds {
    /// Machine coordinate of the negative end, mm.
    pub minus: f64,
    /// Machine coordinate of the positive end, mm.
    pub plus: f64,
}

/// Range of machine coordinates in which the deceleration switch is pressed, mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dog {
    /// Machine coordinate of the negative end of the range, mm.
    pub from: f64,
    /// Machine coordinate of the positive end of the range, mm.
    pub to: f64,
}

/// The tool post: stations, station switches and times.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TurretConfig {
    /// Number of stations; `None`: the value of 084 at the time of wiring.
    pub stations: Option<u8>,
    /// Whether the post reports its station as a binary number on T01, T02, T03 …, with all
    /// of them inactive between stations. Otherwise each station has its own contact.
    pub coded: bool,
    /// Station in position at the start, from 1.
    pub first: u8,
    /// Time in which the post turns from station to station, ms.
    pub station_ms: u32,
    /// Time for which TL- must press before the post is clamped, ms.
    pub clamp_ms: u32,
    /// Range to either side of a station in which its switch is active, as a fraction of
    /// the distance between stations.
    pub window: f64,
}

impl Default for TurretConfig {
    fn default() -> Self {
        Self {
            stations: None,
            coded: false,
            first: 1,
            station_ms: 600,
            clamp_ms: 100,
            window: 0.08,
        }
    }
}

/// The main spindle with its inverter, gears and encoder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SpindleConfig {
    /// Speed at 10 V in gears 1–4, r/min. `None`: the values of 037–040 at the time of
    /// wiring, so that commanded and real speed agree.
    pub top: Option<[f64; 4]>,
    /// Speeds of the steps S1–S4 without inverter, r/min.
    pub steps: [f64; 4],
    /// Time until the speed is within 1 % of a new command, ms.
    pub settle_ms: u32,
    /// Lines of the encoder per revolution; `None`: the value of 070 at the time of wiring.
    pub encoder_lines: Option<u32>,
}

impl Default for SpindleConfig {
    fn default() -> Self {
        Self {
            top: None,
            steps: [250.0, 500.0, 1000.0, 2000.0],
            settle_ms: 500,
            encoder_lines: None,
        }
    }
}

/// Time that chuck, tailstock and gears take to move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChuckConfig {
    /// Time from the output to the in-position signal, ms.
    pub travel_ms: u32,
}

impl Default for ChuckConfig {
    fn default() -> Self {
        Self { travel_ms: 500 }
    }
}
