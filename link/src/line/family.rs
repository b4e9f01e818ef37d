//! The firmwares that read lines, and in what they differ.

/// A firmware.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FirmwareFamily {
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
pub(super) enum StopCause {
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

impl FirmwareFamily {
    /// What a board is asked at the opening, one question after the other; first of all who
    /// it is.
    pub(super) const fn questions(self) -> &'static [&'static str] {
        match self {
            Self::Grbl | Self::GrblHal => &["$I", "$$", "$#", "$G"],
            Self::FluidNc => &["$I", "$CD", "$10"],
        }
    }

    /// The meaning of `ALARM:number`.
    pub(super) const fn cause(self, number: u16) -> StopCause {
        match number {
            1 => StopCause::Limit,
            2 | 4 | 5 => StopCause::Order,
            3 => StopCause::Reset,
            6..=9 => StopCause::Homing,
            _ if matches!(self, Self::FluidNc) => match number {
                10 | 11 | 16..=18 => StopCause::Order,
                12 => StopCause::Homing,
                13 => StopCause::EmergencyStop,
                _ => StopCause::Locked,
            },
            10 => StopCause::EmergencyStop,
            11 | 15 | 18 => StopCause::Homing,
            12 | 13 | 22 => StopCause::Order,
            14 => StopCause::Spindle,
            17 => StopCause::Motor,
            _ => StopCause::Locked,
        }
    }

    /// Whether an alarm may come on the way back from a reset that the link has asked for.
    pub(super) const fn excuses(self, number: u16) -> bool {
        // What was moving; not referenced any more; a return that the reset broke off.
        number == 3 || matches!(self, Self::FluidNc) && matches!(number, 6 | 14)
    }
}
