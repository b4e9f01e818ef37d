//! The result of a program as one JSON object, and in words.

use std::collections::BTreeMap;

use gsk_core::alarm::{Alarm, AlarmClass};
use gsk_core::interpreter::Modal;
use gsk_core::memory::Parameters;
use gsk_core::program::ProgramMemory;
use gsk_core::units::Point;
use serde::Serialize;

use crate::moves::diameter_z;

/// An alarm in a result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AlarmReport {
    /// PS, SYS, OT, ESTOP, SERVO, LINK or PLC.
    pub class: &'static str,
    /// Number.
    pub number: u16,
    /// The text of the screen.
    pub text: String,
    /// Line of the block, from 1.
    pub line: Option<u32>,
    /// The block.
    pub block: Option<String>,
    /// The rule that was broken, in English.
    pub detail: Option<String>,
}

/// Positions at the end: X as a diameter.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Final {
    /// Absolute coordinates.
    pub abs: (f64, f64),
    /// Machine coordinates.
    pub machine: (f64, f64),
    /// Relative coordinates.
    pub rel: (f64, f64),
}

impl Final {
    /// From points as the control holds them.
    pub fn new(absolute: Point, machine: Point, relative: Point) -> Self {
        Self {
            abs: diameter_z(absolute),
            machine: diameter_z(machine),
            rel: diameter_z(relative),
        }
    }
}

/// The result of `run` and `check`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The file.
    pub file: String,
    /// M30, M99, EOF, alarm or limit.
    pub end: &'static str,
    /// The alarm that ended it.
    pub alarm: Option<AlarmReport>,
    /// Machine time, s.
    pub time_s: f64,
    /// Of that, with a cutting feed, s.
    pub cutting_s: f64,
    /// Blocks executed.
    pub blocks: u64,
    /// Moves executed.
    pub moves: u64,
    /// Parts counted.
    pub parts: u32,
    /// M00 answered with cycle start.
    pub stops: u32,
    /// Where everything stands.
    #[serde(rename = "final")]
    pub position: Final,
    /// G codes in force.
    pub modal: Vec<String>,
    /// F word in force.
    pub f: f64,
    /// S word in force.
    pub s: f64,
    /// Tool and offset in force.
    pub t: String,
    /// cw, ccw or stop.
    pub spindle: &'static str,
    /// Whether the coolant runs.
    pub coolant: bool,
    /// Parameters that the program changed, with their values now.
    pub parameters_changed: BTreeMap<String, i32>,
    /// What `check` knows besides.
    #[serde(flatten)]
    pub path: Option<PathReport>,
}

/// Lengths, tools and the box around the path.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PathReport {
    /// Path length of each kind of move, mm.
    pub lengths: BTreeMap<&'static str, f64>,
    /// Tools called, as T words.
    pub tools: Vec<String>,
    /// Smallest and largest X (diameter) and Z of the path.
    #[serde(rename = "box")]
    pub bounds: Option<Bounds>,
}

/// A box; X as diameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bounds {
    /// From, to.
    pub x: (f64, f64),
    /// From, to.
    pub z: (f64, f64),
}

/// The short name of a class of alarms.
pub const fn class_name(class: AlarmClass) -> &'static str {
    match class {
        AlarmClass::Ps => "PS",
        AlarmClass::System => "SYS",
        AlarmClass::Overtravel => "OT",
        AlarmClass::EmergencyStop => "ESTOP",
        AlarmClass::Servo => "SERVO",
        AlarmClass::Link => "LINK",
        AlarmClass::Plc => "PLC",
    }
}

impl AlarmReport {
    /// An alarm with the block that raised it.
    pub fn new(alarm: &Alarm, programs: &ProgramMemory) -> Self {
        let block = alarm.source.and_then(|source| {
            programs
                .get(source.program)
                .map(|program| program.line(source.line).trim().to_owned())
        });
        Self {
            class: class_name(alarm.class()),
            number: alarm.number,
            text: alarm.text().to_owned(),
            line: alarm.source.map(|source| source.line),
            block,
            detail: alarm.detail.clone(),
        }
    }

    /// One line: `P/S 011 … in line 3: N30 G01 X50;`.
    pub fn sentence(&self) -> String {
        let class = if self.class == "PS" {
            "P/S"
        } else {
            self.class
        };
        let mut out = format!("{class} {:03} {}", self.number, self.text);
        if let Some(line) = self.line {
            out.push_str(&format!(", line {line}"));
        }
        if let Some(block) = &self.block {
            out.push_str(&format!(": {block}"));
        }
        if let Some(detail) = &self.detail {
            out.push_str(&format!("\n  {detail}"));
        }
        out
    }
}

/// The G codes in force, one of each group.
pub fn modal_codes(modal: &Modal) -> Vec<String> {
    vec![
        format!("G{:02}", modal.motion),
        if modal.surface_speed { "G96" } else { "G97" }.to_owned(),
        if modal.feed_per_revolution {
            "G99"
        } else {
            "G98"
        }
        .to_owned(),
        format!("G{:02}", modal.nose_compensation),
    ]
}

/// The T word of a tool and an offset.
pub fn tool_word((tool, offset): (u8, u8)) -> String {
    format!("{tool:02}{offset:02}")
}

/// The parameters that differ, by their three-digit numbers.
pub fn changed(before: &Parameters, after: &Parameters) -> BTreeMap<String, i32> {
    (0..1000)
        .filter(|number| before.value(*number) != after.value(*number))
        .map(|number| (format!("{number:03}"), after.value(number)))
        .collect()
}

/// Seconds as `1:02:03` or `2:03.4`.
pub fn clock(seconds: f64) -> String {
    let whole = seconds as u64;
    let (hours, minutes) = (whole / 3600, whole / 60 % 60);
    if hours > 0 {
        return format!("{hours}:{minutes:02}:{:02}", whole % 60);
    }
    format!("{minutes}:{:04.1}", seconds - 60.0 * (whole / 60) as f64)
}

impl Report {
    /// Lines for people.
    pub fn words(&self) -> String {
        let mut out = String::new();
        let end = match self.end {
            "alarm" => "ALARM".to_owned(),
            "limit" => {
                "stopped: no end within the limit of time, or of 1.5 million blocks without motion"
                    .to_owned()
            }
            end => format!("ended normally ({end})"),
        };
        out.push_str(&format!("{}: {end}\n", self.file));
        if let Some(alarm) = &self.alarm {
            out.push_str(&format!("  {}\n", alarm.sentence()));
        }
        out.push_str(&format!(
            "  machine time {}, of that cutting {}; {} blocks, {} moves, {} part(s)",
            clock(self.time_s),
            clock(self.cutting_s),
            self.blocks,
            self.moves,
            self.parts
        ));
        if self.stops > 0 {
            out.push_str(&format!(", {} stop(s) M00", self.stops));
        }
        out.push('\n');
        if let Some(path) = &self.path {
            out.push_str(&path.words());
        }
        let (x, z) = self.position.abs;
        out.push_str(&format!(
            "  at the end X{x} Z{z}, T{}, {}\n",
            self.t,
            self.modal.join(" ")
        ));
        out
    }
}

impl PathReport {
    fn words(&self) -> String {
        let mut out = String::new();
        if let Some(bounds) = self.bounds {
            out.push_str(&format!(
                "  path within X {} … {}, Z {} … {} mm\n",
                bounds.x.0, bounds.x.1, bounds.z.0, bounds.z.1
            ));
        }
        let lengths: Vec<String> = self
            .lengths
            .iter()
            .filter(|(_, length)| **length > 0.0)
            .map(|(kind, length)| format!("{kind} {length:.3} mm"))
            .collect();
        if !lengths.is_empty() {
            out.push_str(&format!("  length: {}\n", lengths.join(", ")));
        }
        if !self.tools.is_empty() {
            let tools: Vec<String> = self.tools.iter().map(|tool| format!("T{tool}")).collect();
            out.push_str(&format!("  tools: {}\n", tools.join(" ")));
        }
        out
    }
}
