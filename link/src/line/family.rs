//! The firmwares that read lines, and in what they differ.

/// A firmware.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Family {
    /// Grbl 1.1f and later.
    #[default]
    Grbl,
    /// grblHAL: a switch for each field of a report, threads, axes that return alone.
    GrblHal,
    /// FluidNC: settings with names, alarm numbers of its own.
    FluidNc,
}

/// Why a board has stopped by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cause {
    /// A limit input.
    Limit,
    /// It was reset while it moved.
    Reset,
    /// A reference return that failed or was broken off.
    Homing,
    /// An emergency stop.
    EmergencyStop,
    /// The spindle does not turn.
    Spindle,
    /// A drive.
    Motor,
    /// Something it was never asked for, or could not carry out.
    Order,
    /// It is locked.
    Locked,
}

impl Family {
    /// What a board is asked at the opening, one question after the other; first of all who
    /// it is.
    pub(super) const fn questions(self) -> &'static [&'static str] {
        match self {
            Self::Grbl | Self::GrblHal => &["$I", "$$", "$#", "$G"],
            Self::FluidNc => &["$I", "$CD", "$10"],
        }
    }

    /// The meaning of `ALARM:number`.
    pub(super) const fn cause(self, number: u16) -> Cause {
        match number {
            1 => Cause::Limit,
            2 | 4 | 5 => Cause::Order,
            3 => Cause::Reset,
            6..=9 => Cause::Homing,
            _ if matches!(self, Self::FluidNc) => match number {
                10 | 11 | 16..=18 => Cause::Order,
                12 => Cause::Homing,
                13 => Cause::EmergencyStop,
                _ => Cause::Locked,
            },
            10 => Cause::EmergencyStop,
            11 | 15 | 18 => Cause::Homing,
            12 | 13 | 22 => Cause::Order,
            14 => Cause::Spindle,
            17 => Cause::Motor,
            _ => Cause::Locked,
        }
    }

    /// Whether an alarm may come on the way back from a reset that the link has asked for.
    pub(super) const fn excuses(self, number: u16) -> bool {
        // What was moving; not referenced any more; a return that the reset broke off.
        number == 3 || matches!(self, Self::FluidNc) && matches!(number, 6 | 14)
    }
}
