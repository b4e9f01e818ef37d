//! Conventions of a control model: the meaning of words and codes besides the effect of each
//! code. They cover units of X, increments, planes, feeds, tools, variables and groups of
//! codes. `dialect` and the help read them.

use serde::Deserialize;

/// The conventions of a model.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Conventions {
    /// Whether X is a diameter or a travel.
    pub x: XMeasure,
    /// The notation of increments.
    pub increments: Increments,
    /// The plane of arcs and radius compensation after power-on.
    pub plane: WorkPlane,
    /// The meaning of a T word.
    pub tool: ToolForm,
    /// The macro language of programs.
    pub macros: MacroForm,
    /// The feed after power-on, mm/min; `None`: a cut needs F.
    pub first_feed: Option<u32>,
    /// Limit of the cutting feed as delivered, mm/min.
    pub greatest_feed: u32,
    /// Whether an S word beside the code that sets coordinates limits the spindle speed.
    #[serde(default)]
    pub limits_speed_by_coordinates: bool,
    /// Whether the L word is the repeat count of M98.
    #[serde(default)]
    pub counts_calls_by_l: bool,
    /// Modal groups: the G codes of a list cancel each other. All other G codes act only in
    /// their own block.
    pub groups: Vec<Vec<u8>>,
}

impl Conventions {
    /// Index of the modal group of a G code; `None` for a code that acts only in its block.
    pub fn group(&self, code: u8) -> Option<usize> {
        self.groups.iter().position(|group| group.contains(&code))
    }
}

/// The quantity that X measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum XMeasure {
    /// A diameter: the slide travels half of it.
    Diameter,
    /// The travel of the slide.
    Distance,
}

/// The notation of increments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Increments {
    /// The letters U and W.
    Letters,
    /// The modal code G91.
    Codes,
    /// Both notations.
    Both,
}

/// The plane of arcs and radius compensation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum WorkPlane {
    /// X and Y.
    Xy,
    /// Z and X.
    Zx,
}

/// The meaning of a T word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum ToolForm {
    /// Tool and offset. The value is the total number of digits; each has half of them.
    ToolAndOffset(u8),
    /// The tool only; the offsets are H and D words.
    Tool,
}

/// The macro language of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum MacroForm {
    /// Macro A: G65 H with integers.
    A,
    /// Macro B: formulas and statements.
    B,
    /// Only formulas, with the variables #1 to #99.
    Formulas,
}

impl WorkPlane {
    /// The axes of the plane, in the order that defines the positive direction of rotation.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Xy => "XY",
            Self::Zx => "ZX",
        }
    }
}
