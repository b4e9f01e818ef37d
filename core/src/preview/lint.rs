//! The kinds of probable mistakes with their codes and names: the one table of them.

use gsk_messages::{Message, say};

/// A kind of probable mistake in a program that raises no alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Lint {
    /// A cut under G98 below 1 mm/min.
    SlowFeed,
    /// A cut while the spindle is stopped.
    SpindleStopped,
    /// A cut after a T word while no tool offset is active.
    NoOffset,
    /// G28 while the position of the work on the machine is unknown.
    MachineZero,
    /// The program does not end where its first G50 sets the tool.
    EndElsewhere,
    /// A word that no code of its block uses.
    IgnoredWord,
    /// A block follows a `;` at the beginning of its line.
    AfterSemicolon,
    /// Text follows the `%` at the end of the program.
    AfterEnd,
    /// The name of the program begins with `:` instead of O.
    ColonName,
    /// The run-in of a thread is too short for the acceleration of the axis.
    ThreadRunIn,
    /// A thread is cut at constant surface speed (G96).
    ThreadSurfaceSpeed,
    /// The speed changes between two passes of the same thread.
    ThreadSpeedChanged,
    /// A dwell of a few milliseconds.
    ShortDwell,
    /// A taper or an arc is cut without compensation by a tool with a nose radius.
    NoseUncompensated,
    /// No block leads to this one.
    UnreachableBlock,
    /// G41 or G42 with a tool whose nose radius is 0.
    NoseRadiusZero,
    /// A cut needs more power than the spindle has.
    SpindlePower,
    /// A cut needs more torque than the spindle has.
    SpindleTorque,
    /// A cut is deeper than the edge of its insert may cut.
    InsertEdge,
    /// A feed of more than two thirds of the nose radius.
    InsertFeed,
    /// A boring bar or the stock protrudes far for its diameter.
    LongOverhang,
    /// Boring bar and stock give way, so that the diameter is wrong.
    SizeError,
    /// A cut needs more feed force than a slide has.
    AxisForce,
    /// A cut needs more torque than the chuck holds.
    ChuckGrip,
    /// A tool of the library cuts longer than its edge still lasts.
    ToolLife,
    /// On a mill: a word that no code of its block uses.
    MillWord,
    /// On a mill: an M code whose effect only the ladder knows.
    LadderCode,
}

impl Lint {
    /// All kinds in the order of their codes.
    pub const ALL: [Self; 27] = [
        Self::SlowFeed,
        Self::SpindleStopped,
        Self::NoOffset,
        Self::MachineZero,
        Self::EndElsewhere,
        Self::IgnoredWord,
        Self::AfterSemicolon,
        Self::AfterEnd,
        Self::ColonName,
        Self::ThreadRunIn,
        Self::ThreadSurfaceSpeed,
        Self::ThreadSpeedChanged,
        Self::ShortDwell,
        Self::NoseUncompensated,
        Self::UnreachableBlock,
        Self::NoseRadiusZero,
        Self::SpindlePower,
        Self::SpindleTorque,
        Self::InsertEdge,
        Self::InsertFeed,
        Self::LongOverhang,
        Self::SizeError,
        Self::AxisForce,
        Self::ChuckGrip,
        Self::ToolLife,
        Self::MillWord,
        Self::LadderCode,
    ];

    /// Code, and the stable name for tools that sort findings, e.g. `slow-feed`.
    const fn row(self) -> (&'static str, &'static str) {
        match self {
            Self::SlowFeed => ("W01", "slow-feed"),
            Self::SpindleStopped => ("W02", "spindle-stands"),
            Self::NoOffset => ("W03", "no-offset"),
            Self::MachineZero => ("W04", "machine-zero"),
            Self::EndElsewhere => ("W05", "end-elsewhere"),
            Self::IgnoredWord => ("W06", "ignored-word"),
            Self::AfterSemicolon => ("W07", "after-semicolon"),
            Self::AfterEnd => ("W08", "after-end"),
            Self::ColonName => ("W09", "colon-name"),
            Self::ThreadRunIn => ("W10", "thread-run-in"),
            Self::ThreadSurfaceSpeed => ("W11", "thread-surface-speed"),
            Self::ThreadSpeedChanged => ("W12", "thread-speed-changed"),
            Self::ShortDwell => ("W13", "short-dwell"),
            Self::NoseUncompensated => ("W14", "nose-uncompensated"),
            Self::UnreachableBlock => ("W15", "unreachable-block"),
            Self::NoseRadiusZero => ("W16", "nose-radius-zero"),
            Self::SpindlePower => ("W21", "spindle-power"),
            Self::SpindleTorque => ("W22", "spindle-torque"),
            Self::InsertEdge => ("W23", "insert-edge"),
            Self::InsertFeed => ("W24", "insert-feed"),
            Self::LongOverhang => ("W25", "long-overhang"),
            Self::SizeError => ("W26", "size-error"),
            Self::AxisForce => ("W27", "axis-force"),
            Self::ChuckGrip => ("W28", "chuck-grip"),
            Self::ToolLife => ("W29", "tool-life"),
            Self::MillWord => ("W31", "word-without-effect"),
            Self::LadderCode => ("W32", "ladder-code"),
        }
    }

    /// The code, e.g. `W01`: a letter and two digits.
    pub const fn code(self) -> &'static str {
        self.row().0
    }

    /// The stable name, e.g. `slow-feed`.
    pub const fn id(self) -> &'static str {
        self.row().1
    }

    /// One sentence about the kind.
    pub fn summary(self) -> Message {
        match self {
            Self::SlowFeed => say::lint_slow_feed(),
            Self::SpindleStopped => say::lint_spindle_stopped(),
            Self::NoOffset => say::lint_no_offset(),
            Self::MachineZero => say::lint_machine_zero(),
            Self::EndElsewhere => say::lint_end_elsewhere(),
            Self::IgnoredWord => say::lint_ignored_word(),
            Self::AfterSemicolon => say::lint_after_semicolon(),
            Self::AfterEnd => say::lint_after_end(),
            Self::ColonName => say::lint_colon_name(),
            Self::ThreadRunIn => say::lint_thread_run_in(),
            Self::ThreadSurfaceSpeed => say::lint_thread_surface_speed(),
            Self::ThreadSpeedChanged => say::lint_thread_speed_changed(),
            Self::ShortDwell => say::lint_short_dwell(),
            Self::NoseUncompensated => say::lint_nose_uncompensated(),
            Self::UnreachableBlock => say::lint_unreachable_block(),
            Self::NoseRadiusZero => say::lint_nose_radius_zero(),
            Self::SpindlePower => say::lint_spindle_power(),
            Self::SpindleTorque => say::lint_spindle_torque(),
            Self::InsertEdge => say::lint_insert_edge(),
            Self::InsertFeed => say::lint_insert_feed(),
            Self::LongOverhang => say::lint_long_overhang(),
            Self::SizeError => say::lint_size_error(),
            Self::AxisForce => say::lint_axis_force(),
            Self::ChuckGrip => say::lint_chuck_grip(),
            Self::ToolLife => say::lint_tool_life(),
            Self::MillWord => say::lint_mill_word(),
            Self::LadderCode => say::lint_ladder_code(),
        }
    }

    /// The kind with this name (`slow-feed`) or code (`W01`, in either case); `None` if there
    /// is none.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|it| it.id() == name || it.code().eq_ignore_ascii_case(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn each_kind_is_found_by_its_name_and_its_code() {
        for lint in Lint::ALL {
            assert_eq!(Lint::from_name(lint.id()), Some(lint));
            assert_eq!(Lint::from_name(&lint.code().to_lowercase()), Some(lint));
        }
        let codes: BTreeSet<_> = Lint::ALL.into_iter().map(Lint::code).collect();
        assert_eq!(codes.len(), Lint::ALL.len());
        assert_eq!(Lint::from_name("W99"), None);
        assert_eq!(Lint::from_name("slow"), None);
    }
}
