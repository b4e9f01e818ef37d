//! The table of traces that the scope can draw.

use egui::Color32;
use gsk_core::units::Axis;

use gsk_messages::{Language, say};

use crate::theme;

/// A quantity that traces of the scope show. Each quantity has its lane and a scale in its unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// The position of an axis, mm; X as a radius.
    Position,
    /// The speed of an axis or along the path, mm/min.
    Speed,
    /// The acceleration of an axis or along the path, m/s².
    Acceleration,
    /// The following error of an axis, mm.
    FollowingError,
    /// The spindle speed, r/min.
    Spindle,
}

impl Quantity {
    /// All quantities in the order of their lanes, from top to bottom.
    pub const ALL: [Self; 5] = [
        Self::Position,
        Self::Speed,
        Self::Acceleration,
        Self::FollowingError,
        Self::Spindle,
    ];

    pub fn name(self, language: Language) -> String {
        let name = match self {
            Self::Position => say::scope_position(),
            Self::Speed => say::scope_speed(),
            Self::Acceleration => say::scope_acceleration(),
            Self::FollowingError => say::scope_following_error(),
            Self::Spindle => say::scope_spindle(),
        };
        name.text(language)
    }

    /// Name and unit as a heading; a position says in which coordinates it is.
    pub fn heading(self, language: Language) -> String {
        let (name, unit) = (self.name(language), self.unit());
        match self {
            Self::Position => say::scope_x_as_radius(name, unit).text(language),
            _ => format!("{name}  {unit}"),
        }
    }

    pub const fn unit(self) -> &'static str {
        match self {
            Self::Position | Self::FollowingError => "mm",
            Self::Speed => "mm/min",
            Self::Acceleration => "m/s²",
            Self::Spindle => "r/min",
        }
    }

    /// Returns the number of decimals with which values of this quantity are shown.
    pub const fn decimals(self) -> usize {
        match self {
            Self::Position | Self::Acceleration => 3,
            Self::FollowingError => 4,
            Self::Speed | Self::Spindle => 1,
        }
    }

    /// The smallest range that the automatic scale shows, in the unit of the quantity.
    pub const fn least_range(self) -> f64 {
        match self {
            Self::Position => 0.01,
            Self::FollowingError => 0.002,
            Self::Speed => 10.0,
            Self::Spindle => 20.0,
            Self::Acceleration => 0.1,
        }
    }
}

/// The axis, path or spindle whose values a trace shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceSubject {
    Axis(Axis),
    /// The trace shows the path of both axes together, or the spindle.
    Path,
}

/// A curve that the scope can draw.
#[derive(Debug)]
pub struct Trace {
    /// Heading of the trace's column in an exported table.
    pub id: &'static str,
    pub quantity: Quantity,
    pub subject: TraceSubject,
    /// True for the commanded value, false for the actual one.
    pub is_commanded: bool,
    /// Whether the trace is shown when the scope is opened for the first time.
    pub on_at_start: bool,
    colour: Color32,
}

impl Trace {
    const fn new(
        id: &'static str,
        quantity: Quantity,
        subject: TraceSubject,
        is_commanded: bool,
        on_at_start: bool,
        colour: Color32,
    ) -> Self {
        Self {
            id,
            quantity,
            subject,
            is_commanded,
            on_at_start,
            colour,
        }
    }

    pub const fn colour(&self) -> Color32 {
        self.colour
    }

    /// The short name of the trace in a list under its quantity: `X`, `X 指令`, …
    pub fn name(&self, language: Language) -> String {
        let name = match (self.quantity, self.subject, self.is_commanded) {
            (_, TraceSubject::Axis(Axis::X), false) => return "X".to_owned(),
            (_, TraceSubject::Axis(Axis::Z), false) => return "Z".to_owned(),
            (_, TraceSubject::Axis(Axis::X), true) => say::scope_x_command(),
            (_, TraceSubject::Axis(Axis::Z), true) => say::scope_z_command(),
            (Quantity::Spindle, TraceSubject::Path, true) => say::scope_spindle_command(),
            (Quantity::Spindle, TraceSubject::Path, false) => say::scope_spindle_actual(),
            (_, TraceSubject::Path, _) => say::scope_along_path(),
        };
        name.text(language)
    }

    /// The name of the trace with its quantity, for screen readers.
    pub fn full_name(&self, language: Language) -> String {
        format!("{} {}", self.quantity.name(language), self.name(language))
    }
}

const X: TraceSubject = TraceSubject::Axis(Axis::X);
const Z: TraceSubject = TraceSubject::Axis(Axis::Z);

/// All traces except the PLC bits. Commanded values come first, so that they are drawn below
/// the actual ones.
pub static TRACES: [Trace; 15] = [
    Trace::new(
        "x_command_mm",
        Quantity::Position,
        X,
        true,
        false,
        theme::SCOPE_X_COMMAND,
    ),
    Trace::new(
        "z_command_mm",
        Quantity::Position,
        Z,
        true,
        false,
        theme::SCOPE_Z_COMMAND,
    ),
    Trace::new("x_mm", Quantity::Position, X, false, true, theme::SCOPE_X),
    Trace::new("z_mm", Quantity::Position, Z, false, true, theme::SCOPE_Z),
    Trace::new(
        "vx_command_mm_min",
        Quantity::Speed,
        X,
        true,
        false,
        theme::SCOPE_X_COMMAND,
    ),
    Trace::new(
        "vz_command_mm_min",
        Quantity::Speed,
        Z,
        true,
        false,
        theme::SCOPE_Z_COMMAND,
    ),
    Trace::new("vx_mm_min", Quantity::Speed, X, false, true, theme::SCOPE_X),
    Trace::new("vz_mm_min", Quantity::Speed, Z, false, true, theme::SCOPE_Z),
    Trace::new(
        "v_mm_min",
        Quantity::Speed,
        TraceSubject::Path,
        false,
        false,
        theme::SCOPE_PATH,
    ),
    Trace::new(
        "ax_m_s2",
        Quantity::Acceleration,
        X,
        false,
        true,
        theme::SCOPE_X,
    ),
    Trace::new(
        "az_m_s2",
        Quantity::Acceleration,
        Z,
        false,
        true,
        theme::SCOPE_Z,
    ),
    Trace::new(
        "ex_mm",
        Quantity::FollowingError,
        X,
        false,
        true,
        theme::SCOPE_X,
    ),
    Trace::new(
        "ez_mm",
        Quantity::FollowingError,
        Z,
        false,
        true,
        theme::SCOPE_Z,
    ),
    Trace::new(
        "s_command_rpm",
        Quantity::Spindle,
        TraceSubject::Path,
        true,
        true,
        theme::SCOPE_SPINDLE_COMMAND,
    ),
    Trace::new(
        "s_rpm",
        Quantity::Spindle,
        TraceSubject::Path,
        false,
        true,
        theme::SCOPE_SPINDLE,
    ),
];
