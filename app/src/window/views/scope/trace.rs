//! The table of what the scope can draw.

use egui::Color32;
use gsk_core::units::Axis;

use crate::cli::Language;
use crate::window::texts::say;

/// What is measured; each has a lane with an axis of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// mm.
    Position,
    /// mm/min.
    Speed,
    /// m/s².
    Acceleration,
    /// mm.
    Following,
    /// r/min.
    Spindle,
}

impl Quantity {
    /// All, from top to bottom.
    pub const ALL: [Self; 5] = [
        Self::Position,
        Self::Speed,
        Self::Acceleration,
        Self::Following,
        Self::Spindle,
    ];

    /// Its name.
    pub const fn name(self, language: Language) -> &'static str {
        match self {
            Self::Position => say(language, "位置", "Position"),
            Self::Speed => say(language, "速度", "Speed"),
            Self::Acceleration => say(language, "加速度", "Acceleration"),
            Self::Following => say(language, "跟随误差", "Following error"),
            Self::Spindle => say(language, "主轴", "Spindle"),
        }
    }

    /// Its unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Position | Self::Following => "mm",
            Self::Speed => "mm/min",
            Self::Acceleration => "m/s²",
            Self::Spindle => "r/min",
        }
    }

    /// Decimals of a reading.
    pub const fn decimals(self) -> usize {
        match self {
            Self::Position | Self::Acceleration => 3,
            Self::Following => 4,
            Self::Speed | Self::Spindle => 1,
        }
    }

    /// The least range that an automatic scale spreads over the lane.
    pub const fn least_range(self) -> f64 {
        match self {
            Self::Position => 0.01,
            Self::Following => 0.002,
            Self::Speed => 10.0,
            Self::Spindle => 20.0,
            Self::Acceleration => 0.1,
        }
    }
}

/// Whose it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// One axis.
    Axis(Axis),
    /// Along the path, or the spindle.
    Path,
}

/// One line of the scope.
#[derive(Debug)]
pub struct Trace {
    /// Column of the exported table.
    pub id: &'static str,
    /// What is measured.
    pub quantity: Quantity,
    /// Whose.
    pub of: Of,
    /// As commanded, or as it is.
    pub commanded: bool,
    /// Shown when the scope is opened.
    pub on: bool,
    colour: [u8; 3],
}

impl Trace {
    const fn new(
        id: &'static str,
        quantity: Quantity,
        of: Of,
        commanded: bool,
        on: bool,
        colour: [u8; 3],
    ) -> Self {
        Self {
            id,
            quantity,
            of,
            commanded,
            on,
            colour,
        }
    }

    /// Its colour.
    pub const fn colour(&self) -> Color32 {
        let [red, green, blue] = self.colour;
        Color32::from_rgb(red, green, blue)
    }

    /// `X`, `X 指令`, …; short, for a list under the name of the quantity.
    pub const fn name(&self, language: Language) -> &'static str {
        match (self.quantity, self.of, self.commanded) {
            (_, Of::Axis(Axis::X), false) => "X",
            (_, Of::Axis(Axis::Z), false) => "Z",
            (_, Of::Axis(Axis::X), true) => say(language, "X 指令", "X command"),
            (_, Of::Axis(Axis::Z), true) => say(language, "Z 指令", "Z command"),
            (Quantity::Spindle, Of::Path, true) => say(language, "指令", "command"),
            (Quantity::Spindle, Of::Path, false) => say(language, "实际", "actual"),
            (_, Of::Path, _) => say(language, "合成", "along path"),
        }
    }

    /// Quantity and name, for screen readers.
    pub fn full_name(&self, language: Language) -> String {
        format!("{} {}", self.quantity.name(language), self.name(language))
    }
}

const X: Of = Of::Axis(Axis::X);
const Z: Of = Of::Axis(Axis::Z);
const BLUE: [u8; 3] = [92, 190, 255];
const PALE_BLUE: [u8; 3] = [64, 118, 158];
const ORANGE: [u8; 3] = [255, 176, 72];
const PALE_ORANGE: [u8; 3] = [164, 118, 58];
const GREEN: [u8; 3] = [140, 222, 120];
const PINK: [u8; 3] = [238, 130, 208];
const PALE_PINK: [u8; 3] = [150, 88, 132];

/// Everything but PLC bits. Commands come first, so that they lie below.
pub static TRACES: [Trace; 15] = [
    Trace::new(
        "x_command_mm",
        Quantity::Position,
        X,
        true,
        false,
        PALE_BLUE,
    ),
    Trace::new(
        "z_command_mm",
        Quantity::Position,
        Z,
        true,
        false,
        PALE_ORANGE,
    ),
    Trace::new("x_mm", Quantity::Position, X, false, true, BLUE),
    Trace::new("z_mm", Quantity::Position, Z, false, true, ORANGE),
    Trace::new(
        "vx_command_mm_min",
        Quantity::Speed,
        X,
        true,
        false,
        PALE_BLUE,
    ),
    Trace::new(
        "vz_command_mm_min",
        Quantity::Speed,
        Z,
        true,
        false,
        PALE_ORANGE,
    ),
    Trace::new("vx_mm_min", Quantity::Speed, X, false, true, BLUE),
    Trace::new("vz_mm_min", Quantity::Speed, Z, false, true, ORANGE),
    Trace::new("v_mm_min", Quantity::Speed, Of::Path, false, false, GREEN),
    Trace::new("ax_m_s2", Quantity::Acceleration, X, false, true, BLUE),
    Trace::new("az_m_s2", Quantity::Acceleration, Z, false, true, ORANGE),
    Trace::new("ex_mm", Quantity::Following, X, false, true, BLUE),
    Trace::new("ez_mm", Quantity::Following, Z, false, true, ORANGE),
    Trace::new(
        "s_command_rpm",
        Quantity::Spindle,
        Of::Path,
        true,
        true,
        PALE_PINK,
    ),
    Trace::new("s_rpm", Quantity::Spindle, Of::Path, false, true, PINK),
];
