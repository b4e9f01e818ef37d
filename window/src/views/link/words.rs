//! Advice and names of the link page for states, inputs, outputs and settings.

use gsk_link::{Input, LinkState, Output};

use gsk_messages::{Message, say};

/// Returns advice for the operator in this state of the link; `None` if no action is needed.
pub fn advice(state: LinkState) -> Option<Message> {
    Some(match state {
        LinkState::Configure => say::link_page_advice_configure(),
        LinkState::Locked => say::link_page_advice_locked(),
        LinkState::Tripped => say::link_page_advice_tripped(),
        LinkState::Fault => say::link_page_advice_fault(),
        LinkState::Lost | LinkState::Off => say::link_page_advice_lost(),
        LinkState::Opening
        | LinkState::Identify
        | LinkState::Ready
        | LinkState::Moving
        | LinkState::Homing
        | LinkState::Verify => return None,
    })
}

/// The inputs of the board in each row of the page, with the name of the row.
pub fn input_rows() -> [(&'static [Input], Message); 5] {
    [
        (
            &[Input::LimitX, Input::LimitZ],
            say::link_page_limit_inputs(),
        ),
        (
            &[Input::DecelerationX, Input::DecelerationZ],
            say::link_page_deceleration_inputs(),
        ),
        (&[Input::ZeroX, Input::ZeroZ], say::link_page_zero_inputs()),
        (&[Input::EmergencyStop], say::link_page_emergency_stop()),
        (&[Input::DriveAlarm], say::link_page_drive_alarm()),
    ]
}

/// Returns the signal name of an output of the board.
pub const fn output_name(output: Output) -> &'static str {
    match output {
        Output::Enable => "nEN",
        Output::SpindleForward => "M03",
        Output::SpindleReverse => "M04",
        Output::SpindleSpeed => "SVC",
        Output::Coolant => "M08",
    }
}

/// Name of a setting of a board that speaks the line protocol, by its number; `None` if it is
/// unknown.
pub fn setting_name(number: u16) -> Option<Message> {
    Some(match number {
        0 => say::link_page_setting_pulse_length(),
        1 => say::link_page_setting_drives_stay_on(),
        2 => say::link_page_setting_pulse_level(),
        3 => say::link_page_setting_directions(),
        4 => say::link_page_setting_enable_level(),
        5 => say::link_page_setting_limit_level(),
        10 => say::link_page_setting_report(),
        11 => say::link_page_setting_corners(),
        13 => say::link_page_setting_millimetres(),
        20 => say::link_page_setting_soft_limits(),
        21 => say::link_page_setting_hard_limits(),
        22 => say::link_page_setting_homing(),
        23..=27 => say::link_page_setting_homing_speeds(),
        30 | 31 => say::link_page_setting_spindle_range(),
        32 => say::link_page_setting_modes(),
        100 => say::link_page_setting_x_pulses(),
        102 => say::link_page_setting_z_pulses(),
        110 => say::link_page_setting_x_rate(),
        112 => say::link_page_setting_z_rate(),
        120 => say::link_page_setting_x_acceleration(),
        122 => say::link_page_setting_z_acceleration(),
        1000 => say::link_page_setting_own_motion(),
        1001 => say::link_page_setting_kinematics(),
        _ => return None,
    })
}
