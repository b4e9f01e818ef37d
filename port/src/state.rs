//! The modal state that the foreign control has before a block, as far as the text shows it.

use crate::dialect::{CodeSet, PlainNumbers};
use crate::number::{Number, divide_rounded, round_to};

/// The code that the axis words of a block without a G code belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ActiveCode {
    /// G00.
    Rapid,
    /// G01.
    Line,
    /// G02 or G03.
    Arc,
    /// G32, G34.
    Thread,
    /// G90 here.
    Turn,
    /// G92 here.
    ThreadTurn,
    /// G94 here.
    Face,
    /// A drilling cycle, tenths of its number.
    Drill(i64),
}

/// An axis: its position and the rounding that the written words carry.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TrackedAxis {
    /// Position in millionths of a millimetre (X as a diameter); `None` if the text does not
    /// show it.
    pub position: Option<i64>,
    /// Written position minus true position.
    pub rounding: i64,
}

impl TrackedAxis {
    /// Moves to a position and returns what to write for it.
    pub fn move_to(&mut self, position: i64) -> i64 {
        let written = round_to(position, 3);
        self.position = Some(position);
        self.rounding = written - position;
        written
    }

    /// Moves by a distance and returns what to write for it.
    pub fn move_by(&mut self, distance: i64) -> i64 {
        let written = self.written_distance(distance);
        self.position = self.position.map(|it| it + distance);
        self.rounding += written - distance;
        written
    }

    /// What to write for a distance from the position.
    pub const fn written_distance(self, distance: i64) -> i64 {
        round_to(distance - self.rounding, 3)
    }

    /// Forgets the position.
    pub const fn forget(&mut self) {
        self.position = None;
        self.rounding = 0;
    }
}

/// The blocks that a roughing cycle reads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoughProfile {
    /// Code of the cycle in tenths.
    pub cycle: i64,
    /// Sequence number of the first block.
    pub first: i64,
    /// Sequence number of the last block.
    pub last: i64,
    /// Positions at which the cycle ends.
    pub resume: [TrackedAxis; 2],
    /// Code that is modal after the cycle.
    pub active: ActiveCode,
    /// Whether the first block was reached.
    pub is_inside: bool,
}

/// The words that a drilling cycle keeps.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DrillWords {
    /// Bottom, in millionths of a millimetre.
    pub bottom: Option<i64>,
    /// Level from which the drill feeds.
    pub level: Option<i64>,
    /// Depth of one peck.
    pub peck: Option<i64>,
    /// Dwell at the bottom, millionths of a second.
    pub dwell: Option<i64>,
    /// Level before the cycle.
    pub initial: Option<i64>,
}

/// The modal state of the foreign control.
#[derive(Clone, Debug)]
pub(crate) struct ForeignState {
    pub set: CodeSet,
    pub plain: PlainNumbers,
    pub is_inch: bool,
    pub is_incremental: bool,
    pub is_radius: bool,
    pub has_absolute_centers: bool,
    pub active: ActiveCode,
    /// Feed per revolution; `None` before the first code.
    pub per_revolution: Option<bool>,
    pub has_surface_speed: bool,
    /// X and Z.
    pub axes: [TrackedAxis; 2],
    pub profile: Option<RoughProfile>,
    pub drill: DrillWords,
    /// Switches and selections of the machine.
    pub machine: MachineState,
}

/// Selections of the machine.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MachineState {
    /// Tool that T selected for the next M06.
    pub pending_tool: Option<i64>,
    /// Coordinate system that the program selected.
    pub work_offset: Option<i64>,
    /// Direction of the spindle: the M code in tenths.
    pub spindle: Option<i64>,
    /// Run-out of threads by M23 and M24; `None` before the first one.
    pub run_out: Option<bool>,
    /// Whether the porter wrote J0 and K0 since the last M24.
    pub wrote_run_out: bool,
    /// Whether the program has ended, so that only calls reach the blocks that follow.
    pub has_ended: bool,
}

impl ForeignState {
    pub fn new(set: CodeSet, plain: PlainNumbers, is_inch: bool) -> Self {
        Self {
            set,
            plain,
            is_inch,
            is_incremental: false,
            is_radius: false,
            has_absolute_centers: false,
            active: ActiveCode::Rapid,
            per_revolution: None,
            has_surface_speed: false,
            axes: [TrackedAxis::default(); 2],
            profile: None,
            drill: DrillWords::default(),
            machine: MachineState::default(),
        }
    }

    /// A length in millionths of a millimetre.
    pub fn length(&self, number: Number) -> i64 {
        let units = if number.has_point || self.plain == PlainNumbers::AsWritten {
            number.micro
        } else {
            self.increments(number)
        };
        self.to_metric(units)
    }

    /// A length whose numbers without a point always count least increments, such as D of
    /// cycles.
    pub fn cycle_length(&self, number: Number) -> i64 {
        let units = match number.has_point {
            true => number.micro,
            false => self.increments(number),
        };
        self.to_metric(units)
    }

    /// A length along X in the diameter of this control.
    pub fn diameter(&self, number: Number) -> i64 {
        self.length(number) * if self.is_radius { 2 } else { 1 }
    }

    fn increments(&self, number: Number) -> i64 {
        divide_rounded(number.micro, if self.is_inch { 10_000 } else { 1_000 })
    }

    /// Converts inches to millimetres.
    pub fn to_metric(&self, units: i64) -> i64 {
        match self.is_inch {
            true => divide_rounded(units * 254, 10),
            false => units,
        }
    }

    /// Whether a length without a point must be rewritten.
    pub fn changes_length(&self, number: Number) -> bool {
        let counts = !number.has_point && self.plain == PlainNumbers::Increments;
        number.micro != 0 && (self.is_inch || counts)
    }

    /// Whether feeds are per revolution.
    pub fn is_per_revolution(&self) -> bool {
        self.per_revolution.unwrap_or(!self.set.is_rs274())
    }

    /// A feed in millionths of mm/min or mm/rev.
    pub fn feed(&self, number: Number) -> i64 {
        let units = if number.has_point || self.plain == PlainNumbers::AsWritten {
            number.micro
        } else {
            divide_rounded(number.micro, self.feed_divisor())
        };
        self.to_metric(units)
    }

    fn feed_divisor(&self) -> i64 {
        match (self.set, self.is_per_revolution(), self.is_inch) {
            (CodeSet::Haas, _, true) | (_, true, true) => 10_000,
            (CodeSet::Haas, _, false) => 1_000,
            (_, false, false) => 1,
            (_, false, true) | (_, true, false) => 100,
        }
    }

    /// A thread lead in millionths of a millimetre.
    pub fn lead(&self, number: Number) -> i64 {
        let units = if number.has_point || self.plain == PlainNumbers::AsWritten {
            number.micro
        } else {
            divide_rounded(number.micro, 10_000)
        };
        self.to_metric(units)
    }
}
