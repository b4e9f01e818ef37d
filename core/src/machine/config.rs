//! The lathe a user may describe in a file (RON); every field has a default.

use serde::{Deserialize, Serialize};

use crate::units::{Axis, Diameter, Point};
use gsk_link::LinkConfig;

/// How far behind its limit switches a slide meets its end, mm of slide travel.
const OVERRUN_MM: f64 = 10.0;
/// The longest stroke that a program can name (alarm 043).
const STROKE_MM: f64 = 9999.999;
/// Where the limit switches of the training lathe trip.
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
/// Lengths of X are slide travel on the *diameter* scale of the displays, as they
/// stand on a machine's plate; all places are machine coordinates, zero = reference
/// point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LatheConfig {
    /// Name shown to the user.
    pub name: String,
    /// Rear tool post (behind the spindle axis), as the pictures of the manual.
    pub rear_tool_post: bool,
    /// Cross slide; lengths in diameter.
    #[serde(with = "CrossSlide")]
    pub x: AxisConfig,
    /// Carriage.
    pub z: AxisConfig,
    /// Tool post.
    pub turret: TurretConfig,
    /// Main spindle.
    pub spindle: SpindleConfig,
    /// Chuck and tailstock.
    pub chuck: ChuckConfig,
    /// The pulse board of a real lathe.
    pub link: Option<LinkConfig>,
}

impl Default for LatheConfig {
    /// The training lathe: 4 stations, dogs, limit switches, ends behind them.
    fn default() -> Self {
        Self {
            name: "training lathe".to_owned(),
            rear_tool_post: true,
            x: AxisConfig::cross_slide(),
            z: AxisConfig::default(),
            turret: TurretConfig::default(),
            spindle: SpindleConfig::default(),
            chuck: ChuckConfig::default(),
            link: None,
        }
    }
}

impl LatheConfig {
    /// A lathe without dogs and limit switches, standing at its machine zero, whose
    /// slides end with the longest stroke: for runs whose coordinates have nothing to
    /// do with a real machine.
    pub fn free() -> Self {
        let unbound = |axis: AxisConfig| AxisConfig {
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
            x: unbound(lathe.x),
            z: unbound(lathe.z),
            ..lathe
        }
    }

    /// Where the slides stand at the beginning, machine coordinates.
    pub const fn start(&self) -> Point {
        Point::from_diameter(Diameter(self.x.start), self.z.start)
    }

    /// The training lathe with long slides to both sides of its machine zero: for
    /// operator scripts that name no machine. It stands at its machine zero.
    pub fn roomy() -> Self {
        let long = |axis: AxisConfig, to: f64| AxisConfig {
            start: 0.0,
            limits: Some(LimitSwitches {
                minus: -to,
                plus: to,
            }),
            ..axis
        };
        let lathe = Self::default();
        Self {
            name: "training lathe with long slides".to_owned(),
            x: long(lathe.x, 1000.0),
            // The longest pitch error table reaches 2550 mm.
            z: long(lathe.z, 2600.0),
            ..lathe
        }
    }
}

/// One slide.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AxisConfig {
    /// Where the slide stands at the beginning, mm.
    pub start: f64,
    /// Limit switches; they open the emergency-stop loop.
    pub limits: Option<LimitSwitches>,
    /// Where the slide meets its end; `None`: 10 mm of slide travel behind the limit
    /// switches, without those where the training lathe has its ends.
    pub ends: Option<SlideEnds>,
    /// Deceleration dog of the reference point.
    pub dog: Option<Dog>,
    /// Travel of one motor turn, mm: the zero signal comes once in it, at zero.
    pub motor_turn: f64,
    /// Slide travel of one pulse, mm in radius; `None`: set to fit the parameters
    /// (CMR, CMD, direction) found when the lathe is wired.
    pub pulse: Option<f64>,
    /// Play of the screw, mm: what 034 and 035 make up for.
    pub backlash: f64,
    /// Errors of the screw, from minus to plus; in between they are evenly spread, beyond
    /// the last ones they stay: what the pitch error table makes up for.
    pub pitch_errors: Vec<ScrewError>,
    /// The drive's position loop; `None`: a stepper, which follows every pulse.
    pub servo: Option<ServoConfig>,
    /// The motor is mounted the other way round than 008 takes for granted: the
    /// slide moves against its command until 008 is set for it.
    pub reversed: bool,
    /// The drive gives a one-turn signal; without it zero return needs one switch
    /// for deceleration and zero (007 ZC = 1).
    pub one_turn_signal: bool,
    /// The drive's alarm output is wired to the control.
    pub alarm_line: bool,
}

/// The fields of the cross slide in a file: what is left out is that of the
/// training lathe's cross slide, not of its carriage.
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
    /// Where the slide meets its ends, those of the machine file or those that go
    /// without saying.
    pub fn slide_ends(&self, axis: Axis) -> SlideEnds {
        self.ends.unwrap_or_else(|| {
            let (usual, overrun) = match axis {
                Axis::X => (X_LIMITS, 2.0 * OVERRUN_MM),
                Axis::Z => (Z_LIMITS, OVERRUN_MM),
            };
            let limits = self.limits.unwrap_or(usual);
            SlideEnds {
                minus: limits.minus - overrun,
                plus: limits.plus + overrun,
            }
        })
    }

    /// The cross slide of the training lathe.
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
    /// The carriage of the training lathe.
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

/// The position loop of a servo drive: the motor follows the pulses at a distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ServoConfig {
    /// Speed for a following error, (mm/s)/mm; 1 to 1000.
    pub gain: f64,
    /// Following error that trips the drive, mm.
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

/// An error of the screw at one place, mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScrewError {
    /// Where the turns of the screw say that the slide is.
    pub at: f64,
    /// How far the slide is beyond that, towards plus.
    pub error: f64,
}

/// Where the limit switches trip, mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LimitSwitches {
    /// Negative end.
    pub minus: f64,
    /// Positive end.
    pub plus: f64,
}

/// Where a slide can go no farther, mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlideEnds {
    /// Negative end.
    pub minus: f64,
    /// Positive end.
    pub plus: f64,
}

/// A stretch on which the deceleration switch is pressed, mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dog {
    /// Its negative end.
    pub from: f64,
    /// Its positive end.
    pub to: f64,
}

/// The tool post.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TurretConfig {
    /// Number of stations; `None`: as many as 084 says when the lathe is wired.
    pub stations: Option<u8>,
    /// The post tells its station as a binary number on T01, T02, T03 …, and
    /// nothing between stations; otherwise each station has a contact of its own.
    pub coded: bool,
    /// Station in place at the beginning, from 1.
    pub first: u8,
    /// Time from station to station, ms.
    pub station_ms: u32,
    /// Time TL- needs to clamp, ms.
    pub clamp_ms: u32,
    /// Part of a pitch, to either side, in which a station switch is closed.
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
    /// Speed at 10 V in gears 1–4, r/min; `None`: as 037–040 say when the lathe is
    /// wired, so that commanded and real speed agree.
    pub top: Option<[f64; 4]>,
    /// Speeds of the steps S1–S4 without inverter, r/min.
    pub steps: [f64; 4],
    /// Time to come within 1 % of a new speed, ms.
    pub settle_ms: u32,
    /// Encoder lines; `None`: as 070 says.
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

/// Times of chuck, tailstock and gears.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChuckConfig {
    /// From the output to «in position», ms.
    pub travel_ms: u32,
}

impl Default for ChuckConfig {
    fn default() -> Self {
        Self { travel_ms: 500 }
    }
}
