//! The modal state that the foreign control has before a block, as far as the text shows it.

use crate::dialect::{CodeSet, PlainNumbers};
use crate::number::{Number, divide_rounded, round_to};

/// The code to which the axis words of a block without a G code belong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ActiveCode {
    /// G00: rapid.
    Rapid,
    /// G01: straight line at the feed.
    Line,
    /// G02 or G03: arc.
    Arc {
        /// Whether it is G03.
        is_left: bool,
    },
    /// G32 or G34: thread of one pass.
    Thread,
    /// The turning cycle, which is G90 on this control.
    Turn,
    /// The thread cycle of one pass, which is G92 on this control.
    ThreadTurn,
    /// The facing cycle, which is G94 on this control.
    Face,
    /// A drilling cycle; the value is its G code in tenths: G83 is 830.
    Drill(i64),
}

/// Position of one axis, with the rounding error of the words written for it so far.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TrackedAxis {
    /// Position in millionths of a millimetre (X as a diameter); `None` if the text does not
    /// show it.
    pub position: Option<i64>,
    /// Written position minus true position, millionths of a millimetre.
    pub rounding: i64,
}

impl TrackedAxis {
    /// Moves the axis to `position` and returns the rounded value to write, both in millionths of a
    /// millimetre.
    pub fn move_to(&mut self, position: i64) -> i64 {
        let written = round_to(position, 3);
        self.position = Some(position);
        self.rounding = written - position;
        written
    }

    /// Moves the axis by `distance` and returns the rounded value to write, both in millionths of a
    /// millimetre.
    pub fn move_by(&mut self, distance: i64) -> i64 {
        let written = self.written_distance(distance);
        self.position = self.position.map(|it| it + distance);
        self.rounding += written - distance;
        written
    }

    /// Returns the value to write for a distance, rounded so that rounding errors do not add up;
    /// millionths of a millimetre.
    pub const fn written_distance(self, distance: i64) -> i64 {
        round_to(distance - self.rounding, 3)
    }

    /// The position to which the written words lead, which a corner shifts; `None` if the text does
    /// not show it.
    pub fn written_position(&self) -> Option<i64> {
        Some(self.position? + self.rounding)
    }

    /// Whether the tool is at the end of a corner, beside the programmed position.
    pub const fn follows_corner(&self) -> bool {
        self.rounding.abs() > 1_000
    }

    /// Marks the position as unknown.
    pub const fn forget(&mut self) {
        self.position = None;
        self.rounding = 0;
    }
}

/// The range of blocks that a roughing cycle reads as its profile.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoughProfile {
    /// G code of the roughing cycle, in tenths: G71 is 710.
    pub cycle: i64,
    /// Sequence number of the first block of the profile.
    pub first: i64,
    /// Sequence number of the last block of the profile.
    pub last: i64,
    /// Positions of X and Z at which the roughing cycle ends.
    pub resume: [TrackedAxis; 2],
    /// The code that is modal after the roughing cycle.
    pub active: ActiveCode,
    /// Whether the first block of the profile was reached.
    pub is_inside: bool,
}

/// The modal words of a drilling cycle, which apply to each following hole.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DrillWords {
    /// Z at the bottom of the hole, millionths of a millimetre.
    pub bottom: Option<i64>,
    /// Z at which the drill changes from rapid to feed (R), millionths of a millimetre.
    pub level: Option<i64>,
    /// Depth of one peck (Q), millionths of a millimetre.
    pub peck: Option<i64>,
    /// Dwell at the bottom of the hole (P), millionths of a second.
    pub dwell: Option<i64>,
    /// Z before the drilling cycle, millionths of a millimetre.
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
    /// The code that the next block needs because a corner block has replaced it; `None` without
    /// one.
    pub next_code: Option<&'static str>,
    /// Whether the feed is per revolution; `None` before the first code that selects it.
    pub per_revolution: Option<bool>,
    pub has_surface_speed: bool,
    /// The tracked positions of X and Z.
    pub axes: [TrackedAxis; 2],
    pub profile: Option<RoughProfile>,
    pub drill: DrillWords,
    /// Tool, spindle and coordinate system that the program has selected.
    pub machine: MachineState,
}

/// Tool, spindle and coordinate system that a foreign program has selected, and its M switches.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MachineState {
    /// Number of the tool that T selected for the next M06; `None` without one.
    pub pending_tool: Option<i64>,
    /// Coordinate system that the program selected: its G code in tenths, times 1000, plus P of
    /// G54.1; `None` before the first selection.
    pub work_offset: Option<i64>,
    /// The last M code that turns or stops the spindle, in tenths: M03 is 30; `None` before the
    /// first one.
    pub spindle: Option<i64>,
    /// Whether threads get a run-out, as M23 and M24 select; `None` before the first of them.
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
            next_code: None,
            per_revolution: None,
            has_surface_speed: false,
            axes: [TrackedAxis::default(); 2],
            profile: None,
            drill: DrillWords::default(),
            machine: MachineState::default(),
        }
    }

    /// Returns a length in millionths of a millimetre; without a point it may count least
    /// increments.
    pub fn length(&self, number: Number) -> i64 {
        let units = if number.has_point || self.plain == PlainNumbers::AsWritten {
            number.micro
        } else {
            self.increments(number)
        };
        self.to_metric(units)
    }

    /// Returns a length in millionths of a millimetre, where a number without a point counts least
    /// increments on controls that know them, such as D of cycles.
    pub fn cycle_length(&self, number: Number) -> i64 {
        let units = match number.has_point || self.set.is_rs274() {
            true => number.micro,
            false => self.increments(number),
        };
        self.to_metric(units)
    }

    /// Returns a length along X as a diameter, millionths of a millimetre.
    pub fn diameter(&self, number: Number) -> i64 {
        self.length(number) * if self.is_radius { 2 } else { 1 }
    }

    fn increments(&self, number: Number) -> i64 {
        divide_rounded(number.micro, if self.is_inch { 10_000 } else { 1_000 })
    }

    /// Converts a length to millionths of a millimetre: from millionths of an inch if the program
    /// is in inches.
    pub fn to_metric(&self, units: i64) -> i64 {
        match self.is_inch {
            true => divide_rounded(units * 254, 10),
            false => units,
        }
    }

    /// Whether a length must be rewritten because it is in inches or in least increments without a
    /// point.
    pub fn changes_length(&self, number: Number) -> bool {
        let counts = !number.has_point && self.plain == PlainNumbers::Increments;
        number.micro != 0 && (self.is_inch || counts)
    }

    /// Whether feeds are per revolution: as selected, or as at power-on.
    pub fn is_per_revolution(&self) -> bool {
        self.per_revolution.unwrap_or(!self.set.is_rs274())
    }

    /// Returns a feed in millionths of mm/min or mm/rev.
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

    /// Returns a thread lead in millionths of a millimetre.
    pub fn lead(&self, number: Number) -> i64 {
        let units = if number.has_point || self.plain == PlainNumbers::AsWritten {
            number.micro
        } else {
            divide_rounded(number.micro, 10_000)
        };
        self.to_metric(units)
    }
}
