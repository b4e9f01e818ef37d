//! The criteria of a task: what is marked, with points and sentences.

use gsk_core::machine::LatheFault;
use gsk_lesson::LessonText;
use gsk_panel::script::Expectation;

/// Something that gives points.
#[derive(Clone, Debug)]
pub struct ExerciseCriterion {
    /// Name of the criterion, unique in its task.
    pub id: String,
    /// Points if it is met, at least 1.
    pub points: u32,
    /// The sentence if it is met.
    pub yes: LessonText,
    /// The sentence if it is not met.
    pub no: LessonText,
    /// When it is met.
    pub rule: CriterionRule,
}

impl ExerciseCriterion {
    /// Returns whether the criterion excludes something instead of demanding it. A learner who
    /// does nothing would meet it, so it counts only if a demanding criterion is met.
    pub const fn is_exclusion(&self) -> bool {
        matches!(
            self.rule,
            CriterionRule::Never(_)
                | CriterionRule::NoCrash
                | CriterionRule::NoIgnoredAlarm
                | CriterionRule::NoAlarm
                | CriterionRule::Within(_)
        )
    }
}

/// A condition on the machine, as written after `expect` in an operator script.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineCondition {
    /// The condition as written in the task.
    pub text: String,
    pub(crate) expectation: Expectation,
}

/// A dimension of the drawing with its limits, mm or degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TolerancedSize {
    /// The dimension on the drawing.
    pub nominal: f64,
    /// Greatest permitted size.
    pub max: f64,
    /// Least permitted size.
    pub min: f64,
}

impl TolerancedSize {
    /// Returns whether a measured size is within the limits. The grid of the part is 0.1 µm: half
    /// a micrometre is no error of the learner.
    pub fn contains(&self, measured: f64) -> bool {
        const ROUNDING: f64 = 0.000_5;
        (self.min - ROUNDING..=self.max + ROUNDING).contains(&measured)
    }
}

/// The surface of the part that a dimension belongs to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PartSurface {
    /// The outer surface.
    #[default]
    Outside,
    /// The bore.
    Bore,
}

/// A dimension measured on the part. `z` is the distance from the front of the part, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartDimension {
    /// Diameter of the cylinder at `z`.
    Diameter {
        /// Distance from the front of the part, mm.
        z: f64,
        /// The surface that is measured.
        surface: PartSurface,
    },
    /// Distance from the front of the part to the face that crosses a diameter.
    Length {
        /// The diameter at which the face is measured, mm.
        diameter: f64,
        /// The surface that is measured.
        surface: PartSurface,
    },
    /// Length of the cylinder at `z`: of a groove or of a collar.
    Width {
        /// Distance from the front of the part, mm.
        z: f64,
        /// The surface that is measured.
        surface: PartSurface,
    },
    /// Angle between the taper at `z` and the spindle axis, degrees.
    Angle {
        /// Distance from the front of the part, mm.
        z: f64,
        /// The surface that is measured.
        surface: PartSurface,
    },
    /// Radius of the arc at `z`; negative if the arc is concave.
    Radius {
        /// Distance from the front of the part, mm.
        z: f64,
        /// The surface that is measured.
        surface: PartSurface,
    },
    /// Pitch of the thread at `z`.
    Pitch {
        /// Distance from the front of the part, mm.
        z: f64,
        /// The surface that is measured.
        surface: PartSurface,
    },
    /// Depth of the thread at `z`: half the difference of its diameters.
    ThreadDepth {
        /// Distance from the front of the part, mm.
        z: f64,
        /// The surface that is measured.
        surface: PartSurface,
    },
}

/// When a criterion is met.
#[derive(Clone, Debug)]
pub enum CriterionRule {
    /// A dimension of the part at the end is within its limits.
    Size(PartDimension, TolerancedSize),
    /// These conditions hold at the end.
    AtEnd(Vec<MachineCondition>),
    /// These conditions hold at one moment.
    Reached(Vec<MachineCondition>),
    /// These groups of conditions hold one after the other.
    InOrder(Vec<Vec<MachineCondition>>),
    /// These groups of conditions hold one after the other, and none of the task's faults is
    /// present meanwhile.
    WorksAfterRepair(Vec<Vec<MachineCondition>>),
    /// These conditions never hold together.
    Never(Vec<MachineCondition>),
    /// A macro variable has a value in this range at the end.
    Variable {
        /// Number of the variable.
        number: u16,
        /// The permitted values, both included.
        range: (f64, f64),
    },
    /// Both axes were referenced at every start of a program, and a program was started.
    ReferencedBeforeStart,
    /// The offset with this number was measured in X and Z before its tool cut in automatic
    /// operation.
    ToolMeasured(u8),
    /// A program ran to its end under machine lock before the first cut in automatic operation.
    TriedBeforeCut,
    /// No tool collided.
    NoCrash,
    /// No alarm was raised.
    NoAlarm,
    /// No cycle start was pressed while an alarm was active, and none is active at the end.
    NoIgnoredAlarm,
    /// The solution took at most this machine time, ms.
    Within(u64),
    /// The first fault that the learner repaired was this one.
    FirstRepair(LatheFault),
    /// The fault is repaired and stays so.
    Repaired(LatheFault),
    /// These conditions held whenever the learner repaired a fault.
    RepairedWhile(Vec<MachineCondition>),
}
