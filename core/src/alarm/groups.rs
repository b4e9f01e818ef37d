//! Groups of alarms that the control treats alike.

use super::number;

/// Alarms of a board that is not connected. The next successful connection clears them.
pub(crate) const CONNECTION_ALARMS: [u16; 4] = [
    number::BOARD_SILENT,
    number::BOARD_UNSUPPORTED,
    number::BOARD_SETTINGS,
    number::LINK_LOST,
];

/// Whether a board can raise this alarm before it has been identified, that is before
/// it has moved the slides.
pub(crate) const fn can_precede_motion(number: u16) -> bool {
    matches!(number, number::BOARD_SILENT..=number::BOARD_CANNOT)
}

/// Whether the alarm stays in force after RESET. 207 ends when the emergency-stop
/// contact closes, 100 with the parameter switch, 000 at the next power-on.
pub const fn survives_reset(number: u16) -> bool {
    matches!(
        number,
        number::POWER_CYCLE | number::EMERGENCY_STOP | number::PARAMETER_SWITCH
    )
}

/// Whether the alarm's line on the screen names the damaged part of the memory.
pub const fn is_memory_alarm(number: u16) -> bool {
    matches!(number, number::MEMORY_DAMAGED | number::WRITE_INTERRUPTED)
}

/// Whether the alarm concerns the corner between a move and the arc after it. That move does
/// not begin then.
pub(crate) const fn is_corner_alarm(number: u16) -> bool {
    matches!(
        number,
        number::NOSE_CENTER_AT_START | number::NOSE_CENTER_AT_END
    )
}

/// Whether a call, a jump, a profile or a macro raises the alarm: its block would have
/// changed which block follows.
pub(crate) const fn is_control_flow_alarm(number: u16) -> bool {
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

/// Whether the alarm reports an unsuitable speed or direction of the spindle.
pub(crate) const fn is_spindle_alarm(number: u16) -> bool {
    matches!(
        number,
        number::NO_FEED | number::THREAD_SPEED | number::TAILSTOCK_WHILE_TURNING
            ..=number::CHUCK_WHILE_TURNING
    )
}
