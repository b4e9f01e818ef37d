//! The firmwares of line boards and their differences.

/// The firmware of a line board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FirmwareFamily {
    /// Firmware Grbl, version 1.1f and later.
    #[default]
    Grbl,
    /// Firmware grblHAL: selectable report fields, thread passes, homing of single axes.
    GrblHal,
    /// Firmware FluidNC: named settings and different alarm numbers.
    FluidNc,
}

/// The cause for which a board has stopped without a command of the link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StopCause {
    /// The board has stopped because a limit switch was operated.
    Limit,
    /// The board has stopped because it was reset during motion.
    Reset,
    /// The board has stopped because homing has failed or was aborted.
    Homing,
    /// The board has stopped because the emergency stop input was operated.
    EmergencyStop,
    /// The board has stopped because the spindle does not turn as commanded.
    Spindle,
    /// The board has stopped because a drive reports a fault.
    Motor,
    /// The board has stopped because it has received an unexpected or impossible command.
    Order,
    /// The board is locked since its start or an earlier alarm.
    Locked,
}

impl FirmwareFamily {
    /// Returns the queries of the opening dialogue in their order; the answer to the first one
    /// identifies the board.
    pub(super) const fn queries(self) -> &'static [&'static str] {
        match self {
            Self::Grbl | Self::GrblHal => &["$I", "$$", "$#", "$G"],
            Self::FluidNc => &["$I", "$CD", "$10"],
        }
    }

    /// Returns the cause for which a board with this firmware reports `ALARM:number`.
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

    /// Whether the alarm with this number is a normal consequence of a reset that the link has
    /// sent.
    pub(super) const fn excuses(self, number: u16) -> bool {
        // Reset during motion; aborted homing; homing required.
        number == 3 || matches!(self, Self::FluidNc) && matches!(number, 6 | 14)
    }
}
