//! The commands and replies that the link uses: Klipper's, and those of our own firmware.

/// In which cases a board must have a command or reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Requirement {
    /// The board must have the command or reply in all cases.
    Always,
    /// The board must have at least one of the commands with this requirement, which restart it.
    Restart,
    /// The board must have the command or reply if the spindle speed output is wired.
    Speed,
    /// The board must have the command or reply if the spindle's one-turn signal is wired to a
    /// counter.
    Index,
    /// The board must have the command or reply if a spindle encoder is wired.
    Angle,
    /// The board must have the command if the encoder of an axis is wired.
    AxisEncoder,
    /// The board must have the command or reply if a handwheel is wired.
    Wheel,
    /// The link uses the command or reply if the board has it.
    Optional,
}

macro_rules! commands {
    ($($name:ident $need:ident $text:literal)*) => {
        /// A command that the link sends to the board.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Command { $($name),* }

        /// All commands with their requirement and their exact text in the dictionary.
        pub(super) const COMMANDS: &[(Command, Requirement, &str)] =
            &[$((Command::$name, Requirement::$need, $text)),*];
    };
}

commands! {
    Identify Always "identify offset=%u count=%c"
    GetConfig Always "get_config"
    GetUptime Always "get_uptime"
    AllocateOids Always "allocate_oids count=%c"
    FinalizeConfig Always "finalize_config crc=%u"
    EmergencyStop Always "emergency_stop"
    ClearShutdown Always "clear_shutdown"
    Reset Restart "reset"
    ConfigReset Restart "config_reset"
    ConfigStepper Always "config_stepper oid=%c step_pin=%c dir_pin=%c invert_step=%c step_pulse_ticks=%u"
    ResetStepClock Always "reset_step_clock oid=%c clock=%u"
    SetNextStepDir Always "set_next_step_dir oid=%c dir=%c"
    QueueStep Always "queue_step oid=%c interval=%u count=%hu add=%hi"
    StepperGetPosition Always "stepper_get_position oid=%c"
    StepperStopOnTrigger Always "stepper_stop_on_trigger oid=%c trsync_oid=%c"
    ConfigTrsync Always "config_trsync oid=%c"
    TrsyncStart Always "trsync_start oid=%c report_clock=%u report_ticks=%u expire_reason=%c"
    TrsyncSetTimeout Always "trsync_set_timeout oid=%c clock=%u"
    TrsyncTrigger Always "trsync_trigger oid=%c reason=%c"
    ConfigEndstop Always "config_endstop oid=%c pin=%c pull_up=%c"
    EndstopHome Always "endstop_home oid=%c clock=%u sample_ticks=%u sample_count=%c rest_ticks=%u pin_value=%c trsync_oid=%c trigger_reason=%c"
    EndstopQueryState Always "endstop_query_state oid=%c"
    ConfigDigitalOut Always "config_digital_out oid=%c pin=%u value=%c default_value=%c max_duration=%u"
    QueueDigitalOut Always "queue_digital_out oid=%c clock=%u on_ticks=%u"
    ConfigPwmOut Speed "config_pwm_out oid=%c pin=%u cycle_ticks=%u value=%hu default_value=%hu max_duration=%u"
    QueuePwmOut Speed "queue_pwm_out oid=%c clock=%u value=%hu"
    ConfigCounter Index "config_counter oid=%c pin=%u pull_up=%c"
    QueryCounter Index "query_counter oid=%c clock=%u poll_ticks=%u sample_ticks=%u"
    RenewLease Optional "renew_lease crc=%u clock=%u"
    ConfigGuard Optional "config_guard oid=%c pin=%c pull_up=%c pin_value=%c ticks=%u"
    ConfigSpindle Angle "config_spindle oid=%c pin_a=%c index_pin=%c counts_per_turn=%u"
    ConfigAxisEncoder AxisEncoder "config_axis_encoder oid=%c pin_a=%c stepper_oid=%c counts=%u steps=%u limit=%u"
    QueryEncoder Angle "query_encoder oid=%c clock=%u rest_ticks=%u"
    BeginAngle Angle "begin_angle oid=%c clock=%u start=%u denominator=%u phase=%u reverse=%c"
    QueueAngle Angle "queue_angle oid=%c length=%u numerator=%i add=%i"
    EndAngle Angle "end_angle oid=%c"
    ConfigWheel Wheel "config_wheel oid=%c pin_a=%c"
    QueryWheel Wheel "query_wheel oid=%c clock=%u rest_ticks=%u"
    BeginTap Optional "begin_tap oid=%c clock=%u start=%u denominator=%u phase=%u reverse=%c depth=%u"
}

/// All replies with their requirement and their exact text in the dictionary.
pub(super) const REPLIES: [(ReplyKind, Requirement, &str); 15] = [
    (
        ReplyKind::Identify,
        Requirement::Always,
        "identify_response offset=%u data=%.*s",
    ),
    (
        ReplyKind::Config,
        Requirement::Always,
        "config is_config=%c crc=%u is_shutdown=%c move_count=%hu",
    ),
    (
        ReplyKind::Uptime,
        Requirement::Always,
        "uptime high=%u clock=%u",
    ),
    (
        ReplyKind::Position,
        Requirement::Always,
        "stepper_position oid=%c pos=%i",
    ),
    (
        ReplyKind::Group,
        Requirement::Always,
        "trsync_state oid=%c can_trigger=%c trigger_reason=%c clock=%u",
    ),
    (
        ReplyKind::Endstop,
        Requirement::Always,
        "endstop_state oid=%c homing=%c next_clock=%u pin_value=%c",
    ),
    (
        ReplyKind::Shutdown,
        Requirement::Always,
        "shutdown clock=%u static_string_id=%hu",
    ),
    (
        ReplyKind::IsShutdown,
        Requirement::Always,
        "is_shutdown static_string_id=%hu",
    ),
    (
        ReplyKind::Counter,
        Requirement::Index,
        "counter_state oid=%c next_clock=%u count=%u count_clock=%u",
    ),
    // Sent by a board that has just started; not in all versions.
    (ReplyKind::Starting, Requirement::Restart, "starting"),
    (
        ReplyKind::Encoder,
        Requirement::Angle,
        "encoder_state oid=%c clock=%u count=%i index_count=%i",
    ),
    (
        ReplyKind::Angle,
        Requirement::Angle,
        "angle_state oid=%c state=%c count=%i",
    ),
    (
        ReplyKind::LeaseExpired,
        Requirement::Optional,
        "lease_expired clock=%u",
    ),
    (
        ReplyKind::AngleError,
        Requirement::Optional,
        "angle_error oid=%c error=%u",
    ),
    (
        ReplyKind::Wheel,
        Requirement::Wheel,
        "wheel_state oid=%c clock=%u count=%i",
    ),
];

/// The kind of a reply of the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ReplyKind {
    Identify,
    Config,
    Uptime,
    Position,
    Group,
    Endstop,
    Counter,
    Shutdown,
    IsShutdown,
    Starting,
    Encoder,
    Angle,
    LeaseExpired,
    AngleError,
    Wheel,
}

/// A reply of the board; `numbers` are in the order of the reply's text in the dictionary.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Reply {
    pub(super) kind: ReplyKind,
    pub(super) numbers: [u32; 4],
    pub(super) data: Vec<u8>,
}
