//! Alarms that belong together, by what the control does with them.

use super::number;

/// Alarms of a board that is not connected: its connection ends them.
pub(crate) const OF_OPENING: [u16; 4] = [
    number::BOARD_SILENT,
    number::BOARD_UNSUPPORTED,
    number::BOARD_SETTINGS,
    number::LINK_LOST,
];

/// Whether a board that is not known yet can have raised it: one that has moved
/// nothing.
pub(crate) const fn comes_before_motion(number: u16) -> bool {
    matches!(number, number::BOARD_SILENT..=number::BOARD_CANNOT)
}

/// Whether RESET leaves it: the emergency stop goes with its contact alone, 100 with
/// the parameter switch and 000 with the power.
pub const fn outlives_reset(number: u16) -> bool {
    matches!(
        number,
        number::POWER_CYCLE | number::EMERGENCY_STOP | number::PARAMETER_SWITCH
    )
}

/// Whether its line on the screen names what was damaged in the memory.
pub const fn is_of_memory(number: u16) -> bool {
    matches!(number, number::MEMORY_DAMAGED | number::WRITE_INTERRUPTED)
}

/// Whether it belongs to the corner before its arc: the move before is not begun.
pub(crate) const fn is_of_corner(number: u16) -> bool {
    matches!(
        number,
        number::NOSE_CENTER_AT_START | number::NOSE_CENTER_AT_END
    )
}

/// Alarms of calls, jumps, profiles and macros: the block would have led elsewhere.
pub(crate) const fn leads_elsewhere(number: u16) -> bool {
    matches!(
        number,
        number::PROFILE_RANGE
            | number::PROGRAM_MISSING
            | number::PROFILE_WORDS..=number::PROFILE_IN_MDI
            | number::CALL_WITHOUT_P..=number::TARGET_MISSING
            | number::MACRO_RANGE..=number::BAD_ARGUMENT
            | number::USER_ALARM..=number::USER_ALARM_LAST
            | number::MACRO_ALARM..=number::MACRO_ALARM_LAST
    )
}

/// Speed and direction of the spindle do not suit.
pub(crate) const fn is_of_spindle(number: u16) -> bool {
    matches!(
        number,
        number::NO_FEED | number::THREAD_SPEED | number::TAILSTOCK_WHILE_TURNING
            ..=number::CHUCK_WHILE_TURNING
    )
}
