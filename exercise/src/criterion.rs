//! The criteria of a task: what is marked, with points and sentences.

use gsk_core::machine::LatheFault;
use gsk_lesson::LessonText;
use gsk_panel::script::Expectation;

/// A criterion of an exercise: a rule that gives points when it is met.
#[derive(Clone, Debug)]
pub struct ExerciseCriterion {
    /// Name of the criterion, unique in its task.
    pub id: String,
    /// Points that the criterion gives if it is met, at least 1.
    pub points: u32,
    /// Sentence that the report shows if the criterion is met.
    pub yes: LessonText,
    /// Sentence that the report shows if the criterion is not met.
    pub no: LessonText,
    /// The rule that decides whether the criterion is met.
    pub rule: CriterionRule,
}

impl ExerciseCriterion {
    /// Returns whether the rule forbids something instead of requiring it. Idle learners meet such
    /// criteria, so their points count only if a requiring criterion is met.
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
    /// The condition as written in the task file.
    pub text: String,
    pub(crate) expectation: Expectation,
}

/// A size on the drawing with its limits, mm or degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TolerancedSize {
    /// The size that the drawing shows, mm or degrees.
    pub nominal: f64,
    /// Greatest permitted size, mm or degrees.
    pub max: f64,
    /// Least permitted size, mm or degrees.
    pub min: f64,
}

impl TolerancedSize {
    /// Returns whether a measured size is within the limits, with a tolerance of 0.5 µm, because
    /// the grid of the part is 0.1 µm.
    pub fn contains(&self, measured: f64) -> bool {
        const ROUNDING: f64 = 0.000_5;
        (self.min - ROUNDING..=self.max + ROUNDING).contains(&measured)
    }
}

/// Whether a dimension belongs to the outside or to the bore of the part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PartSurface {
    /// The outer surface of the part.
    #[default]
    Outside,
    /// The inner surface of the part, in its bore.
    Bore,
}

/// A dimension measured on the part. `z` is the distance from the front of the part, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartDimension {
    /// Diameter of the cylinder at the position `z`, mm.
    Diameter {
        /// Distance from the front of the part, mm.
        z: f64,
        /// Whether the outside or the bore is measured.
        surface: PartSurface,
    },
    /// Distance from the front of the part to the face that crosses a diameter, mm.
    Length {
        /// Diameter at which the position of the face is measured, mm.
        diameter: f64,
        /// Whether the outside or the bore is measured.
        surface: PartSurface,
    },
    /// Length of the cylinder at the position `z`, mm: width of a groove or of a collar.
    Width {
        /// Distance from the front of the part, mm.
        z: f64,
        /// Whether the outside or the bore is measured.
        surface: PartSurface,
    },
    /// Angle between the taper at the position `z` and the spindle axis, degrees.
    Angle {
        /// Distance from the front of the part, mm.
        z: f64,
        /// Whether the outside or the bore is measured.
        surface: PartSurface,
    },
    /// Radius of the arc at the position `z`, mm; negative if the arc is concave.
    Radius {
        /// Distance from the front of the part, mm.
        z: f64,
        /// Whether the outside or the bore is measured.
        surface: PartSurface,
    },
    /// Pitch of the thread at the position `z`, mm.
    Pitch {
        /// Distance from the front of the part, mm.
        z: f64,
        /// Whether the outside or the bore is measured.
        surface: PartSurface,
    },
    /// Depth of the thread at the position `z`, mm: half the difference of its diameters.
    ThreadDepth {
        /// Distance from the front of the part, mm.
        z: f64,
        /// Whether the outside or the bore is measured.
        surface: PartSurface,
    },
}

/// The rule that decides whether a criterion is met.
#[derive(Clone, Debug)]
pub enum CriterionRule {
    /// A dimension of the finished part is within its limits.
    Size(PartDimension, TolerancedSize),
    /// All these conditions hold when the solution ends.
    AtEnd(Vec<MachineCondition>),
    /// All these conditions hold together at any moment of the solution.
    Reached(Vec<MachineCondition>),
    /// These groups of conditions hold one after another; each group holds together at a moment.
    InOrder(Vec<Vec<MachineCondition>>),
    /// These groups of conditions hold one after another, while none of the task's faults is
    /// present.
    WorksAfterRepair(Vec<Vec<MachineCondition>>),
    /// All these conditions hold together at no moment.
    Never(Vec<MachineCondition>),
    /// A macro variable has a value in this range when the solution ends.
    Variable {
        /// Number of the macro variable.
        number: u16,
        /// Least and greatest permitted value of the variable.
        range: (f64, f64),
    },
    /// Whenever a program was started, both axes were referenced; and a program was started.
    ReferencedBeforeStart,
    /// The tool offset with this number was measured in X and Z before its tool first cut in
    /// automatic operation.
    ToolMeasured(u8),
    /// A program ran to its end under machine lock before the first cut in automatic operation.
    TriedBeforeCut,
    /// No tool collided during the solution.
    NoCrash,
    /// No alarm was raised during the solution.
    NoAlarm,
    /// Cycle start was never pressed while an alarm was active, and no alarm is active at the end.
    NoIgnoredAlarm,
    /// The solution took at most this machine time, ms.
    Within(u64),
    /// The first fault that the learner repaired was this one.
    FirstRepair(LatheFault),
    /// The lathe fault is repaired and remains repaired until the end.
    Repaired(LatheFault),
    /// These conditions held at each moment at which the learner repaired a fault.
    RepairedWhile(Vec<MachineCondition>),
}
