//! The table of what the scope can draw.

use egui::Color32;
use gsk_core::units::Axis;

use gsk_messages::{Language, say};

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
    pub fn name(self, language: Language) -> String {
        let name = match self {
            Self::Position => say::scope_position(),
            Self::Speed => say::scope_speed(),
            Self::Acceleration => say::scope_acceleration(),
            Self::Following => say::scope_following_error(),
            Self::Spindle => say::scope_spindle(),
        };
        name.text(language)
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
    pub fn name(&self, language: Language) -> String {
        let name = match (self.quantity, self.of, self.commanded) {
            (_, Of::Axis(Axis::X), false) => return "X".to_owned(),
            (_, Of::Axis(Axis::Z), false) => return "Z".to_owned(),
            (_, Of::Axis(Axis::X), true) => say::scope_x_command(),
            (_, Of::Axis(Axis::Z), true) => say::scope_z_command(),
            (Quantity::Spindle, Of::Path, true) => say::scope_spindle_command(),
            (Quantity::Spindle, Of::Path, false) => say::scope_spindle_actual(),
            (_, Of::Path, _) => say::scope_along_path(),
        };
        name.text(language)
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
