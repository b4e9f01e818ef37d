//! Conventions of a control model: the meaning of words and codes besides the effect of each
//! code. They cover units of X, increments, planes, feeds, tools, variables and groups of
//! codes. `dialect` and the help read them.

use serde::Deserialize;

/// The conventions by which a control model reads the words of a program.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Conventions {
    /// Whether X measures a diameter or the travel of the slide.
    pub x: XMeasure,
    /// How a program marks increments: by letters, by a code, or both.
    pub increments: Increments,
    /// The plane of arcs and radius compensation that is active after power-on.
    pub plane: WorkPlane,
    /// Whether a T word selects tool and offset, or the tool only.
    pub tool: ToolForm,
    /// The macro language that programs may use.
    pub macros: MacroForm,
    /// The feed that is active after power-on, mm/min; `None` if a cut needs an F word.
    pub first_feed: Option<u32>,
    /// Greatest cutting feed as delivered, mm/min.
    pub greatest_feed: u32,
    /// Whether an S word in the block of the code that sets coordinates limits the spindle
    /// speed.
    #[serde(default)]
    pub limits_speed_by_coordinates: bool,
    /// Whether the repeat count of M98 is its L word.
    #[serde(default)]
    pub counts_calls_by_l: bool,
    /// Modal groups of G codes; the codes of a group cancel each other. A G code in no group
    /// acts only in its block.
    pub groups: Vec<Vec<u8>>,
}

impl Conventions {
    /// Index in `groups` of the modal group of a G code; `None` for a code that acts only in
    /// its block.
    pub fn group(&self, code: u8) -> Option<usize> {
        self.groups.iter().position(|group| group.contains(&code))
    }
}

/// Whether X values of a program are diameters or slide travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum XMeasure {
    /// X values are diameters: the slide moves half of them.
    Diameter,
    /// X values are the travel of the slide.
    Distance,
}

/// How a program marks a coordinate as an increment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Increments {
    /// By the letters U and W instead of X and Z.
    Letters,
    /// The modal code G91 marks coordinates as increments.
    Codes,
    /// By the letters U and W, or by G91.
    Both,
}

/// The plane in which arcs and radius compensation act.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum WorkPlane {
    /// Arcs are in the plane of X and Y.
    Xy,
    /// Arcs are in the plane of Z and X.
    Zx,
}

/// The meaning of the digits of a T word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum ToolForm {
    /// Tool and offset. The payload is the number of digits of the word; each has half of
    /// them.
    ToolAndOffset(u8),
    /// The tool only; H and D words select the offsets.
    Tool,
}

/// The macro language of a control model: A or B.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum MacroForm {
    /// Macro A: operations G65 H on integers.
    A,
    /// Macro B: formulas, jumps, loops and calls with arguments.
    B,
    /// Formulas and assignments only, with the variables #1 to #99.
    Formulas,
}

impl WorkPlane {
    /// The letters of the axes, in the order that defines the positive direction of rotation.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Xy => "XY",
            Self::Zx => "ZX",
        }
    }
}
