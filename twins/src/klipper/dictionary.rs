//! The data dictionary: commands, responses, shutdown reasons and pins of the firmware.

use std::fmt::Write;

use miniz_oxide::deflate::compress_to_vec_zlib;

use super::pins::PORTS;

macro_rules! messages {
    ($kind:ident $table:ident: $($name:ident $text:literal)*) => {
        /// The kinds of messages of the protocol.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum $kind { $($name),* }

        /// Each kind of message with its format text in the dictionary.
        pub(super) const $table: &[($kind, &str)] = &[$(($kind::$name, $text)),*];
    };
}

messages! { Command COMMANDS:
    Identify "identify offset=%u count=%c"
    GetConfig "get_config"
    GetUptime "get_uptime"
    AllocateOids "allocate_oids count=%c"
    FinalizeConfig "finalize_config crc=%u"
    EmergencyStop "emergency_stop"
    ClearShutdown "clear_shutdown"
    Reset "reset"
    ConfigReset "config_reset"
    ConfigStepper "config_stepper oid=%c step_pin=%c dir_pin=%c invert_step=%c step_pulse_ticks=%u"
    ResetStepClock "reset_step_clock oid=%c clock=%u"
    SetNextStepDir "set_next_step_dir oid=%c dir=%c"
    QueueStep "queue_step oid=%c interval=%u count=%hu add=%hi"
    StepperGetPosition "stepper_get_position oid=%c"
    StepperStopOnTrigger "stepper_stop_on_trigger oid=%c trsync_oid=%c"
    ConfigTrsync "config_trsync oid=%c"
    TrsyncStart "trsync_start oid=%c report_clock=%u report_ticks=%u expire_reason=%c"
    TrsyncSetTimeout "trsync_set_timeout oid=%c clock=%u"
    TrsyncTrigger "trsync_trigger oid=%c reason=%c"
    ConfigEndstop "config_endstop oid=%c pin=%c pull_up=%c"
    EndstopHome "endstop_home oid=%c clock=%u sample_ticks=%u sample_count=%c rest_ticks=%u pin_value=%c trsync_oid=%c trigger_reason=%c"
    EndstopQueryState "endstop_query_state oid=%c"
    ConfigDigitalOut "config_digital_out oid=%c pin=%u value=%c default_value=%c max_duration=%u"
    QueueDigitalOut "queue_digital_out oid=%c clock=%u on_ticks=%u"
    ConfigPwmOut "config_pwm_out oid=%c pin=%u cycle_ticks=%u value=%hu default_value=%hu max_duration=%u"
    QueuePwmOut "queue_pwm_out oid=%c clock=%u value=%hu"
    ConfigCounter "config_counter oid=%c pin=%u pull_up=%c"
    QueryCounter "query_counter oid=%c clock=%u poll_ticks=%u sample_ticks=%u"
}

messages! { Response RESPONSES:
    Identify "identify_response offset=%u data=%.*s"
    Config "config is_config=%c crc=%u is_shutdown=%c move_count=%hu"
    Uptime "uptime high=%u clock=%u"
    StepperPosition "stepper_position oid=%c pos=%i"
    TrsyncState "trsync_state oid=%c can_trigger=%c trigger_reason=%c clock=%u"
    EndstopState "endstop_state oid=%c homing=%c next_clock=%u pin_value=%c"
    CounterState "counter_state oid=%c next_clock=%u count=%u count_clock=%u"
    Shutdown "shutdown clock=%u static_string_id=%hu"
    IsShutdown "is_shutdown static_string_id=%hu"
    Starting "starting"
    Stats "stats count=%u sum=%u sumsq=%u"
}

/// Texts of the shutdown reasons, in the order of their `static_string_id`.
pub(super) const SHUTDOWN_REASONS: [&str; 24] = [
    "Timer too close",
    "Stepper too far in past",
    "Rescheduled timer in the past",
    "Move queue overflow",
    "Invalid count parameter",
    "Can't reset time when stepper active",
    "Command parser error",
    "Invalid command",
    "Missed scheduling of next digital out event",
    "Missed scheduling of next hard pwm event",
    "Scheduled digital out event will exceed max_duration",
    "Scheduled pwm event will exceed max_duration",
    "Command request",
    "Invalid oid type",
    "Can't add signal that is already active",
    "Shutdown cleared when not shutdown",
    "config_reset only available when shutdown",
    "oids already allocated",
    "Can't assign oid",
    "Already finalized",
    "Not an output pin",
    "Not a valid input pin",
    "Not a valid PWM pin",
    "Can not use timer1 for PWM; timer1 is used for timers",
];
/// Id (`static_string_id`) of the first shutdown reason.
const FIRST_REASON_ID: usize = 2;
/// Number of random letters, bytes, that stand for the build information of a real dictionary.
const FILLER_BYTES: usize = 3773;

/// Returns the message id of a command. As on real boards, some ids are negative and some have
/// two bytes.
pub(super) fn command_id(command: Command) -> i64 {
    match command as i64 {
        0 => 1,
        index @ 1..=12 => -index * 4,
        index @ 13..=20 => index + 40,
        index => index + 80,
    }
}

pub(super) fn response_id(response: Response) -> i64 {
    match response as i64 {
        0 => 0,
        index @ 1..=4 => index - 10,
        index => index + 88,
    }
}

/// Returns the command with a message id, and its number of parameters; `None` for an unknown
/// id.
pub(super) fn find_command(id: u32) -> Option<(Command, usize)> {
    let named = COMMANDS
        .iter()
        .find(|(name, _)| command_id(*name) as u32 == id);
    named.map(|(name, text)| (*name, text.matches('=').count()))
}

pub(super) fn static_string_id(text: &str) -> i64 {
    let index = SHUTDOWN_REASONS.iter().position(|known| *known == text);
    (FIRST_REASON_ID + index.unwrap_or(0)) as i64
}

/// Returns the dictionary of an ATmega2560 board, compressed as the host receives it. `rate`
/// is the rate of the serial line, bits/s, `window` the size of the receive buffer, bytes.
pub(super) fn compressed_dictionary(rate: u32, window: u32, has_reset_command: bool) -> Vec<u8> {
    let mut text = String::from("{\"build_versions\":\"");
    let mut state = 12_345_u32;
    for _ in 0..FILLER_BYTES {
        state = state.wrapping_mul(1_103_515_245).wrapping_add(12_345);
        text.push(char::from(b'a' + (state >> 16 & 0x0F) as u8));
    }
    // Writing to a `String` cannot fail.
    text.push_str("\",\"commands\":{");
    let known = |name: &Command| has_reset_command || *name != Command::Reset;
    for (index, (name, form)) in COMMANDS.iter().filter(|(name, _)| known(name)).enumerate() {
        let comma = if index == 0 { "" } else { "," };
        let _ = write!(text, "{comma}\"{form}\":{}", command_id(*name));
    }
    text.push_str("},\"responses\":{");
    for (index, (name, form)) in RESPONSES.iter().enumerate() {
        let comma = if index == 0 { "" } else { "," };
        let _ = write!(text, "{comma}\"{form}\":{}", response_id(*name));
    }
    text.push_str("},\"enumerations\":{\"pin\":{");
    for (index, (port, first)) in PORTS.iter().enumerate() {
        let comma = if index == 0 { "" } else { "," };
        let _ = write!(text, "{comma}\"{port}0\":[{first},8]");
    }
    text.push_str("},\"static_string_id\":{");
    for (index, reason) in SHUTDOWN_REASONS.iter().enumerate() {
        let comma = if index == 0 { "" } else { "," };
        let _ = write!(text, "{comma}\"{reason}\":{}", index + FIRST_REASON_ID);
    }
    let _ = write!(
        text,
        "}}}},\"config\":{{\"CLOCK_FREQ\":{rate},\"MCU\":\"atmega2560\",\"PWM_MAX\":255,\
         \"RECEIVE_WINDOW\":{window},\"RESERVE_PINS_serial\":\"PE0,PE1\",\"STATS_SUMSQ_BASE\":256}},\"version\":\"v0.13.0-730\"}}"
    );
    compress_to_vec_zlib(text.as_bytes(), 9)
}
