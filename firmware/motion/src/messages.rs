//! The messages of the protocol with their formats, as the dictionary announces them.

macro_rules! messages {
    ($(#[$text:meta])* $kind:ident $table:ident: $($name:ident $format:literal)*) => {
        $(#[$text])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[allow(missing_docs, reason = "the format says what the message is")]
        #[repr(u8)]
        pub enum $kind { $($name),* }

        /// The messages, each with its format.
        pub const $table: &[($kind, &str)] = &[$(($kind::$name, $format)),*];
    };
}

messages! {
    /// A command of the host. Up to `QueryCounter` they are Klipper's.
    Command COMMANDS:
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
    RenewLease "renew_lease crc=%u clock=%u"
    ConfigGuard "config_guard oid=%c pin=%c pull_up=%c pin_value=%c ticks=%u"
    ConfigSpindle "config_spindle oid=%c pin_a=%c index_pin=%c counts_per_turn=%u"
    ConfigAxisEncoder "config_axis_encoder oid=%c pin_a=%c stepper_oid=%c counts=%u steps=%u limit=%u"
    QueryEncoder "query_encoder oid=%c clock=%u rest_ticks=%u"
    BeginAngle "begin_angle oid=%c clock=%u start=%u denominator=%u phase=%u reverse=%c"
    QueueAngle "queue_angle oid=%c length=%u numerator=%i add=%i"
    EndAngle "end_angle oid=%c"
    ConfigWheel "config_wheel oid=%c pin_a=%c"
    QueryWheel "query_wheel oid=%c clock=%u rest_ticks=%u"
    BeginTap "begin_tap oid=%c clock=%u start=%u denominator=%u phase=%u reverse=%c depth=%u"
}

messages! {
    /// A reply of the board. Up to `Starting` they are Klipper's.
    Response RESPONSES:
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
    EncoderState "encoder_state oid=%c clock=%u count=%i index_count=%i"
    AngleState "angle_state oid=%c state=%c count=%i"
    LeaseExpired "lease_expired clock=%u"
    AngleError "angle_error oid=%c error=%u"
    WheelState "wheel_state oid=%c clock=%u count=%i"
}

macro_rules! reasons {
    ($($name:ident $text:literal)*) => {
        /// Why the board has shut down.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[allow(missing_docs, reason = "the text says what the reason is")]
        #[repr(u8)]
        pub enum Reason { $($name),* }

        /// The texts of the shutdown reasons, in the order of [`Reason`].
        pub const REASONS: &[&str] = &[$($text),*];
    };
}

reasons! {
    TimerTooClose "Timer too close"
    StepperPast "Stepper too far in past"
    QueueOverflow "Move queue overflow"
    InvalidCount "Invalid count parameter"
    StepperActive "Can't reset time when stepper active"
    ParserError "Command parser error"
    InvalidCommand "Invalid command"
    MissedDigital "Missed scheduling of next digital out event"
    MissedPwm "Missed scheduling of next hard pwm event"
    ExceedsDigital "Scheduled digital out event will exceed max_duration"
    ExceedsPwm "Scheduled pwm event will exceed max_duration"
    CommandRequest "Command request"
    InvalidOidType "Invalid oid type"
    SignalActive "Can't add signal that is already active"
    NotShutdown "Shutdown cleared when not shutdown"
    ResetNotShutdown "config_reset only available when shutdown"
    OidsAllocated "oids already allocated"
    AssignOid "Can't assign oid"
    AlreadyFinalized "Already finalized"
    NoOutputPin "Not an output pin"
    NoInputPin "Not a valid input pin"
    NotConfigured "Motion before the configuration is final"
    NoLease "Motion without lease or armed trsync"
    LeaseHash "Lease for another configuration"
    LeaseExpired "Lease expired"
    GuardTripped "Guard input tripped"
    NoSpindle "Angle entry without spindle encoder"
    AngleUnderrun "Angle queue empty"
    ClockUnset "Step clock not set after a thread"
    AngleMissing "Angle entry without begin_angle"
    AngleReversed "Spindle reversed too far"
    CannotFollow "Axis cannot follow the spindle"
    SpindleOverrun "Spindle encoder overrun"
    IndexMoved "Spindle index at another count"
    FollowingError "Following error too large"
    TapTooDeep "Tap beyond its last segment"
}

/// Id (`static_string_id`) of the first shutdown reason.
pub const FIRST_REASON_ID: u32 = 2;

/// Returns the message id of a command: `identify` has 1.
pub const fn command_id(command: Command) -> i32 {
    command as i32 + 1
}

/// Returns the message id of a reply: `identify_response` has 0. The others follow the commands.
pub const fn response_id(response: Response) -> i32 {
    match response as i32 {
        0 => 0,
        index => COMMANDS.len() as i32 + index,
    }
}

/// Returns the number of parameters in a format.
pub const fn parameter_count(format: &str) -> usize {
    let bytes = format.as_bytes();
    let (mut index, mut count) = (0, 0);
    while index < bytes.len() {
        if bytes[index] == b'=' {
            count += 1;
        }
        index += 1;
    }
    count
}

/// Name of the processor. The host knows the step rate of this firmware by it.
pub const PROCESSOR: &str = "gsk980td-rp2040";
/// Rate of the board clock, ticks per second: an eighth of the processor's 125 MHz.
pub const CLOCK_HZ: u32 = 15_625_000;
/// Size of the queue of steps, entries of both axes.
pub const QUEUE_SIZE: usize = 1024;
/// Size of the receive buffer, bytes.
pub const RECEIVE_WINDOW: usize = 256;
/// Value of a PWM output that is always on.
pub const PWM_MAX: u32 = 255;
/// Number of GPIO pins.
pub const PINS: u32 = 30;
/// The pins of the serial port.
pub const SERIAL_PINS: &str = "gpio0,gpio1";
