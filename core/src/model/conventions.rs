//! What a model means by words and codes besides what each code does: units of X, increments,
//! planes, feeds, tools, variables, groups of codes. Read by `dialect` and by the help.

use serde::Deserialize;

/// The conventions of a model.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Conventions {
    /// What X and its increments measure.
    pub x: XMeasure,
    /// How increments are written.
    pub increments: Increments,
    /// The plane of arcs and radius compensation after power-on.
    pub plane: WorkPlane,
    /// What a T word names.
    pub tool: ToolForm,
    /// How programs calculate.
    pub macros: MacroForm,
    /// The feed with which the control begins, mm/min; none: a cut needs F.
    pub first_feed: Option<u32>,
    /// The greatest cutting feed as delivered, mm/min.
    pub greatest_feed: u32,
    /// Whether S beside the code that sets coordinates limits the speed of the spindle.
    #[serde(default)]
    pub limits_speed_by_coordinates: bool,
    /// Whether L counts the runs of M98.
    #[serde(default)]
    pub counts_calls_by_l: bool,
    /// G codes that cancel each other and stay in force, a list for each group; all others
    /// act in their own block.
    pub groups: Vec<Vec<u8>>,
}

impl Conventions {
    /// The modal group of a G code; none of one that acts in its own block.
    pub fn group(&self, code: u8) -> Option<usize> {
        self.groups.iter().position(|group| group.contains(&code))
    }
}

/// What X measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum XMeasure {
    /// A diameter: the slide goes half as far.
    Diameter,
    /// How far the slide goes.
    Distance,
}

/// How increments are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Increments {
    /// U and W.
    Letters,
    /// G91.
    Codes,
    /// Either.
    Both,
}

/// A plane of two axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum WorkPlane {
    /// X Y.
    Xy,
    /// Z X.
    Zx,
}

/// What a T word names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum ToolForm {
    /// Tool and offset, half of so many digits each.
    ToolAndOffset(u8),
    /// The tool; offsets are H and D.
    Tool,
}

/// How programs calculate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum MacroForm {
    /// G65 H, whole numbers.
    A,
    /// Formulas and statements.
    B,
    /// Formulas alone, with variables #1 to #99.
    Formulas,
}

impl WorkPlane {
    /// Its axes, in the order of their sense.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Xy => "XY",
            Self::Zx => "ZX",
        }
    }
}
