//! The control: owns the program, the motion and the PLC; one millisecond a tick.

mod ladder;
mod request;
mod soft_panel;
mod view;
mod world;

use std::collections::VecDeque;
use std::sync::Arc;

use gsk_plc::address::{Area, BitAddress};
use gsk_plc::{Ladder, Plc};
use serde::{Deserialize, Serialize};

pub use ladder::LadderStep;
use ladder::{TIMER_PRESETS, preset_plc};
pub use request::{OffsetEntry, Received, Request, SerialPort};
pub use view::Cursor;
pub(crate) use world::World;

use crate::alarm::Alarm;
use crate::axis::{AxisChain, SoftLimits};
use crate::command::{Action, ExecutedMove, Frame, Source, SpindleCommand};
use crate::interpreter::{Explanation, Interpreter, MachineCodes, Modal};
use crate::machine::{Inputs, Outputs};
use crate::memory::{
    Authority, Counters, Disks, Offsets, Parameters, PitchTable, Settings, Variables,
};
use crate::motion::{DryRun, Interpolator, JogRate, MotionInputs, MotionLimits, RapidOverride};
use crate::operation::{
    ActiveAlarms, Automatic, BoardDrives, DriveWatch, FromPlc, Handshake, InputFilter,
    JOG_RATE_MAX, Mode, Return, RunState, Sensors, Strobe, ToPlc, WheelCounter, X_BYTES, jog_rate,
};
use crate::program::{MdiBlock, ProgramMemory};
use crate::setup::{Setup, TOOL_IN_POSITION, TOOL_PARAMETER};
use crate::spindle::{SpindleAngle, SpindleControl, SpindleInputs};
use crate::units::{Axis, PerAxis, Point, Pulses};

/// Contacts are sampled, and outputs refreshed, every so many ticks.
const SAMPLE_TICKS: u64 = 4;
/// The PLC has its slot every so many ticks.
const SLOT_TICKS: u64 = 8;
/// Motions shorter than a tick that are carried out in one.
const MOTIONS_PER_TICK: usize = 16;
/// X0.5, *ESP: closed when all is well.
const ESP_BYTE: usize = 0;
const ESP_MASK: u8 = 1 << 5;
/// Y1.2, M03: the spindle turns forward.
const M03_OUTPUT: BitAddress = BitAddress::new(Area::Y, 1, 2);

/// Y0.7, SPZD: spindle brake.
const BRAKE_OUTPUT: BitAddress = BitAddress::new(Area::Y, 0, 7);

/// What happened during a tick.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A piece of motion was finished or broken off.
    Moved(ExecutedMove),
    /// A block begins, with the modal state it leaves.
    BlockBegan(Source, Modal),
    /// Why the move that begins is where it is; only while the control explains.
    Explained(Explanation),
    /// A block was finished.
    BlockEnded(Source),
    /// An alarm came up.
    AlarmRaised(Alarm),
    /// The part counter counted.
    PartFinished,
    /// A program came to its end; `m30` tells M30 from the end of the text.
    ProgramEnded {
        /// By M30.
        m30: bool,
    },
}

/// The control.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cnc {
    pub(crate) parameters: Parameters,
    pub(crate) offsets: Offsets,
    pub(crate) pitch: PitchTable,
    pub(crate) variables: Variables,
    pub(crate) settings: Settings,
    pub(crate) authority: Authority,
    pub(crate) disks: Disks,
    /// 参数开关.
    pub(crate) parameter_switch: bool,
    /// 程序开关.
    pub(crate) program_switch: bool,
    /// The parameters as they were when the power was switched on.
    at_power_on: Parameters,
    pub(crate) programs: ProgramMemory,
    pub(crate) counters: Counters,
    pub(crate) mdi: MdiBlock,
    pub(crate) interpreter: Interpreter,
    pub(crate) plc: Plc,
    pub(crate) from_plc: FromPlc,
    pub(crate) filter: InputFilter,
    panel_keys: [u8; X_BYTES],
    /// A soft switch on its way.
    turning: Option<soft_panel::Turning>,
    output_key: bool,
    serial_port: SerialPort,
    /// The soft machine panel, as F75 has it.
    pub(crate) soft_switches: u8,
    /// The ladder stands still, for stepping.
    plc_halted: bool,
    /// The ladder that the next power-on loads.
    next_ladder: Option<Arc<Ladder>>,
    pub(crate) plc_message: bool,
    pub(crate) sensors: Sensors,
    pub(crate) drives: DriveWatch,

    pub(crate) mode: Mode,
    pub(crate) automatic: Automatic,
    pub(crate) handshake: Handshake,
    pub(crate) alarms: ActiveAlarms,
    pub(crate) emergency_stop: bool,
    pub(crate) reset_left: u32,
    pub(crate) modal: Modal,
    pub(crate) tool: (u8, u8),
    /// The tool-change key turns the tool post.
    indexing_by_hand: bool,

    pub(crate) interpolator: Interpolator,
    pub(crate) limits: MotionLimits,
    /// The rest of a held block while the axes are moved by hand.
    pub(crate) held: Option<Interpolator>,
    pub(crate) jog_blocked: PerAxis<bool>,
    pub(crate) jog_command: PerAxis<Option<(bool, JogRate)>>,
    /// Axis keys that were down at the last tick.
    pub(crate) axis_keys: PerAxis<bool>,
    pub(crate) wheel: WheelCounter,
    /// Returns to a zero under way.
    pub(crate) returns: PerAxis<Option<Return>>,
    pub(crate) axes: AxisChain,
    pub(crate) soft_limits: SoftLimits,
    /// Real drives behind a pulse board, if they make the motion.
    pub(crate) board: Option<BoardDrives>,
    pub(crate) spindle: SpindleControl,
    pub(crate) angle: SpindleAngle,
    /// Spindle override in force, %; a change waits for the end of a thread.
    spindle_override: u8,
    /// Programmed X minus that of the tip, at the end of the last move.
    pub(crate) programmed_ahead: f64,

    pub(crate) frame: Frame,
    /// Absolute coordinate at which the relative display shows zero.
    pub(crate) relative_zero: Point,
    /// Machine coordinate of the program zero point, once a G50 has run.
    pub(crate) program_zero: Option<Point>,
    pub(crate) referenced: PerAxis<bool>,
    /// Coordinate of the reference point an axis stands at.
    pub(crate) at_reference: PerAxis<Option<f64>>,
    negative: PerAxis<bool>,
    last_rapid: bool,

    pub(crate) cursor_line: u32,
    pub(crate) rewind_at_start: bool,
    pub(crate) ticks: u64,
    y: Vec<u8>,
    /// Explanations of what was read and has not begun yet; `None`: nobody asked.
    #[serde(skip)]
    pub(crate) explanations: Option<VecDeque<Option<Explanation>>>,
    #[serde(skip)]
    pub(crate) events: Vec<Event>,
}

impl Cnc {
    /// A control at power-on.
    pub fn new(setup: Setup) -> Self {
        let tool = setup.tool_in_position();
        let referenced = PerAxis::new(setup.is_referenced(Axis::X), setup.is_referenced(Axis::Z));
        let mut parameters = setup.parameters;
        parameters.power_on();
        let mut authority = setup.authority;
        authority.power_on();
        let mut plc = Plc::new(setup.ladder);
        if let Some(retained) = &setup.plc_retained {
            plc.memory_mut().restore_retained(retained);
        }
        plc.power_on();
        plc.memory_mut().set_k(TOOL_IN_POSITION, tool);
        preset_plc(plc.memory_mut(), &parameters);
        let mut interpreter = Interpreter::new(&parameters);
        interpreter.set_inch_input(setup.settings.inch);
        interpreter.set_tool(tool);
        interpreter.set_machine_codes(MachineCodes::of(plc.ladder()));
        let modal = *interpreter.modal();
        let start = setup.start.unwrap_or_default();
        let mut axes = AxisChain::new(&parameters, &setup.pitch);
        axes.preset(Axis::X, start.x);
        axes.preset(Axis::Z, start.z);
        let mut spindle = SpindleControl::new(&parameters);
        if let Some(speed) = setup.spindle_rpm {
            spindle.command(SpindleCommand::Speed(speed));
            plc.memory_mut().set_bit(M03_OUTPUT, true);
        }
        let from_plc = FromPlc::read(plc.memory());
        let absolute = setup
            .absolute
            .filter(|_| !parameters.power_off_loses_coordinates());
        let mut cnc = Self {
            limits: MotionLimits::from(&parameters),
            soft_limits: SoftLimits::new(&parameters),
            spindle,
            angle: SpindleAngle::new(&parameters),
            spindle_override: 100,
            programmed_ahead: 0.0,
            at_power_on: parameters.clone(),
            parameter_switch: false,
            program_switch: parameters.bit(174, 3),
            parameters,
            offsets: setup.offsets,
            pitch: setup.pitch,
            variables: setup.variables,
            settings: setup.settings,
            authority,
            disks: setup.disks,
            programs: setup.programs,
            counters: setup.counters,
            mdi: MdiBlock::default(),
            interpreter,
            plc,
            from_plc,
            filter: InputFilter::default(),
            panel_keys: [0; X_BYTES],
            turning: None,
            output_key: false,
            serial_port: SerialPort::Idle,
            soft_switches: 0,
            plc_halted: false,
            next_ladder: None,
            plc_message: false,
            sensors: Sensors::default(),
            drives: DriveWatch::default(),
            mode: Mode::Mdi,
            automatic: Automatic::default(),
            handshake: Handshake::default(),
            alarms: ActiveAlarms::default(),
            emergency_stop: false,
            reset_left: 0,
            modal,
            tool: (tool, 0),
            indexing_by_hand: false,
            interpolator: Interpolator::new(start),
            held: None,
            jog_blocked: PerAxis::default(),
            jog_command: PerAxis::default(),
            axis_keys: PerAxis::default(),
            wheel: WheelCounter::default(),
            returns: PerAxis::default(),
            axes,
            board: None,
            frame: Frame::default(),
            relative_zero: Point::default(),
            program_zero: None,
            referenced,
            at_reference: PerAxis::default(),
            negative: PerAxis::default(),
            last_rapid: false,
            cursor_line: 1,
            rewind_at_start: false,
            ticks: 0,
            y: vec![0; 20],
            explanations: None,
            events: Vec::new(),
        };
        if let Some(absolute) = absolute {
            cnc.frame.zero = start - absolute;
            cnc.settle_coordinates();
        }
        for alarm in setup.alarms {
            cnc.raise(alarm);
        }
        cnc
    }

    /// Power off and on: what is retained stays, all else starts anew. The
    /// absolute coordinates stay with 004.7 ABOT = 0 (manual III-2.1).
    pub fn power_cycle(&mut self) {
        let position = self.position();
        let setup = Setup {
            parameters: self.parameters.clone(),
            offsets: self.offsets.clone(),
            pitch: self.pitch.clone(),
            variables: self.variables.clone(),
            settings: self.settings,
            authority: self.authority.clone(),
            disks: self.disks.clone(),
            ladder: self.ladder_at_power_on(),
            plc_retained: Some(self.plc.memory().retained()),
            programs: self.programs.clone(),
            counters: self.counters,
            start: Some(position),
            absolute: Some(self.frame.program(position)),
            referenced: false,
            zero_kept: self.reference_without_switch(),
            ..Setup::default()
        };
        *self = Self::new(setup);
    }

    /// One millisecond of the control.
    pub fn tick(&mut self, inputs: &Inputs) -> Outputs {
        self.events.clear();
        self.ticks += 1;
        self.sensors.sense(inputs, &self.parameters);
        self.soft_switch_tick();
        if self.ticks % SAMPLE_TICKS == 1 {
            self.sample_contacts(inputs);
        }
        if self.ticks % SLOT_TICKS == 1 {
            self.plc_slot();
        }
        let masked = self.parameters.emergency_stop_masked();
        let closed = self.filter.accepted()[ESP_BYTE] & ESP_MASK != 0;
        self.watch_reset(closed || masked);
        self.watch_drives(inputs);
        self.automatic_tick();
        self.manual_tick(inputs);
        self.return_tick(inputs);
        self.spindle_tick(inputs);
        self.motion_tick();
        self.watch_travel();
        self.watch_limit_signals();
        self.watch_reference();
        if self.automatic.state == RunState::Run {
            self.counters.count_cutting_ms(1);
        }
        self.outputs()
    }

    fn sample_contacts(&mut self, inputs: &Inputs) {
        let mut contacts = inputs.x;
        for (contact, key) in contacts.iter_mut().zip(self.panel_keys) {
            *contact |= key;
        }
        if self.ticks == 1 {
            self.filter = InputFilter::standing(&contacts);
        }
        self.filter.sample(&contacts, self.parameters.value(20));
        for (index, byte) in self.filter.accepted().iter().enumerate() {
            self.plc.memory_mut().set_x(index as u16, *byte);
        }
        for (index, byte) in self.y.iter_mut().enumerate() {
            *byte = self.plc.memory().y(index as u16);
        }
    }

    fn plc_slot(&mut self) {
        let was = self.from_plc.clone();
        self.tell_plc(&was);
        if !self.plc_halted {
            self.plc.slot();
            self.hear_plc(&was);
        }
    }

    /// What the ladder has decided acts.
    fn hear_plc(&mut self, was: &FromPlc) {
        self.from_plc = FromPlc::read(self.plc.memory());
        if self.parameters.override_code_is_inverted() {
            self.from_plc.feed_override = 150 - self.from_plc.feed_override;
        }
        self.plc_message = self.plc.active_messages().next().is_some();
        if let Some(fault) = self.plc.fault() {
            let detail = fault.to_string();
            self.raise(Alarm::new(0).because(detail));
        }
        self.follow_mode();
        self.follow_tool(was.current_tool);
        if self.from_plc.feed_hold || self.plc_message {
            self.feed_hold();
        }
        if was.start && !self.from_plc.start {
            self.cycle_start();
        }
        if self.from_plc.next_tool && !was.next_tool {
            self.index_tool();
        }
    }

    fn tell_plc(&mut self, g: &FromPlc) {
        let velocity = self.interpolator.velocity();
        let moving = PerAxis::new(velocity.x != 0.0, velocity.z != 0.0);
        for axis in [Axis::X, Axis::Z] {
            if *moving.get(axis) {
                *self.negative.get_mut(axis) = velocity.get(axis) < 0.0;
            }
        }
        let state = self.automatic.state;
        let rapid = self
            .automatic
            .action()
            .map(|action| matches!(action, Action::Rapid { .. }));
        self.last_rapid = rapid.unwrap_or(self.last_rapid && !self.automatic.operating());
        let cutting = matches!(
            self.automatic.action(),
            Some(
                Action::Line { .. }
                    | Action::Arc { .. }
                    | Action::Thread { .. }
                    | Action::Tap { .. }
            )
        );
        let message = ToPlc {
            mode: self.mode,
            started: state == RunState::Run,
            holding: state == RunState::Hold,
            operating: self.automatic.operating(),
            alarm: self.alarm_state(),
            reset: self.resetting(),
            distribution_end: self.automatic.distribution_end(),
            servo_ready: !self.emergency_stop && self.board.is_none_or(|board| board.known),
            rapid: self.last_rapid,
            cutting: cutting && state == RunState::Run,
            dwelling: self.automatic.dwelling(),
            tapping: matches!(self.automatic.action(), Some(Action::Tap { .. })),
            decoded_m00: self.automatic.decoded == Some(0),
            decoded_m30: self.automatic.decoded == Some(30),
            handshake: &self.handshake,
            gear: self.spindle.selected_gear(),
            at_reference: PerAxis::new(
                self.at_reference.x.is_some(),
                self.at_reference.z.is_some(),
            ),
            referenced: self.referenced,
            at_program_zero: self.at_program_zero(),
            moving,
            negative: self.negative,
            output_key: self.output_key,
            sending: self.serial_port == SerialPort::Sending,
            receiving: self.serial_port == SerialPort::Receiving,
            soft_switches: self.soft_switches,
            ready: !self.alarms.contains(0),
            spindle_jog: self.spindle_jog(),
            parameters: &self.parameters,
        };
        message.write(self.plc.memory_mut(), g);
    }

    /// Follows the mode that the ladder commands.
    fn follow_mode(&mut self) {
        let handwheel = self.parameters.handwheel();
        let Some(mode) = Mode::from_code(self.from_plc.mode_code, handwheel) else {
            return;
        };
        if mode == self.mode {
            return;
        }
        let left = core::mem::replace(&mut self.mode, mode);
        if left.is_manual() {
            self.manual_mode_left();
        }
        if mode.is_manual() {
            self.feed_hold();
        } else if self.automatic.operating() && self.automatic.mdi != (mode == Mode::Mdi)
            || mode == Mode::Edit
        {
            self.automatic.request_stop();
        }
    }

    /// The T display follows the tool post when it was turned by hand.
    fn follow_tool(&mut self, before: u8) {
        let now = self.from_plc.current_tool;
        if now != before && (self.indexing_by_hand || !self.handshake.strobe(Strobe::T)) {
            self.indexing_by_hand = false;
            self.tool = (now, 0);
            self.interpreter.set_tool(now);
        }
        if now != before {
            self.remember_tool(now);
        }
    }

    /// 075 holds the tool in position; numbers beyond its range are not kept.
    pub(crate) fn remember_tool(&mut self, tool: u8) {
        let _ = self.parameters.set(TOOL_PARAMETER, tool.into());
    }

    /// The tool-change key: the next station, after the last the first.
    fn index_tool(&mut self) {
        let stations = self.parameters.value(84);
        if self.handshake.busy() || stations == 0 {
            return;
        }
        let now = i32::from(self.from_plc.current_tool);
        let next = if now >= stations { 1 } else { now + 1 };
        self.handshake.start(Strobe::T, next as u8);
        self.indexing_by_hand = true;
    }

    fn spindle_tick(&mut self, inputs: &Inputs) {
        let at = Point::new(self.surface_x(), 0.0);
        self.spindle.set_jog(self.spindle_jog());
        if !(41..=44).contains(&self.handshake.m) {
            self.spindle.end_gear_change();
        }
        if !self.automatic.threading() {
            self.spindle_override = self.from_plc.spindle_override;
        }
        self.spindle.tick(&SpindleInputs {
            encoder: inputs.encoder,
            radius: self.frame.program(at).x,
            override_percent: self.spindle_override,
        });
        self.angle.tick(inputs.encoder, inputs.encoder_index);
    }

    /// SPHD counts with an analog spindle and in the modes of manual motion
    /// (manual PLC-II 9.2).
    fn spindle_jog(&self) -> bool {
        self.from_plc.spindle_jog && self.mode.is_manual() && self.parameters.analog_spindle()
    }

    /// SPZD: the ladder brakes the spindle.
    pub(crate) fn brake_output(&self) -> bool {
        self.plc.memory().bit(BRAKE_OUTPUT)
    }

    /// The X that the surface speed counts on, machine coordinate: the programmed
    /// one, and in a rapid that of its end (manual I-2.6.2).
    fn surface_x(&mut self) -> f64 {
        let position = self.position();
        let Some(current) = &self.automatic.current else {
            return position.x + self.programmed_ahead;
        };
        let programmed = current.command.programmed_x.as_deref();
        let (x, tip) = match (&current.command.action, programmed) {
            (Action::Rapid { to }, None) => (to.x, to.x),
            (Action::Rapid { to }, Some(programmed)) => (programmed.end(), to.x),
            (Action::Line { to, .. } | Action::Arc { to, .. }, Some(programmed)) => {
                (programmed.at(position, current.from, *to), position.x)
            }
            (Action::Line { .. } | Action::Arc { .. } | Action::Thread { .. }, None) => {
                (position.x, position.x)
            }
            _ => return position.x + self.programmed_ahead,
        };
        self.programmed_ahead = x - tip;
        x
    }

    fn motion_tick(&mut self) {
        let held = self.automatic.state == RunState::Hold
            && self.held.is_none()
            && !self.automatic.protected();
        let mut inputs = MotionInputs {
            feed_override: self.feed_override_factor(),
            rapid_override: RapidOverride::from_percent(self.from_plc.rapid_override),
            spindle_rpm: self.spindle.actual_rpm(),
            spindle: self.angle.turn(),
            thread_continues: self.automatic.thread_continues(),
            cut_continues: self.cut_continues(),
            hold: held || self.run_interlocked(),
            dry_run: self.dry_run(),
        };
        self.interpolator.tick(&self.limits, &inputs);
        for _ in 0..MOTIONS_PER_TICK {
            if !self.begin_within_tick() {
                break;
            }
            inputs.thread_continues = self.automatic.thread_continues();
            inputs.cut_continues = self.cut_continues();
            inputs.hold = held || self.run_interlocked();
            self.interpolator.continue_tick(&self.limits, &inputs);
        }
        self.axes
            .advance(self.position(), self.from_plc.machine_lock);
        self.watch_gear_speed();
    }

    pub(crate) fn feed_override_factor(&self) -> f64 {
        if self.from_plc.override_cancel {
            return 1.0;
        }
        f64::from(self.from_plc.feed_override) / 100.0
    }

    /// Rates of the dry run (manual III-5.3.3): cuts at the jog rate, or at its
    /// highest step with manual rapid on; rapids at the jog rate unless manual
    /// rapid is on or 004.6 RDRN = 1.
    pub(crate) fn dry_run(&self) -> Option<DryRun> {
        if !self.from_plc.dry_run || self.mode != Mode::Auto {
            return None;
        }
        let jog = jog_rate(self.from_plc.jog_code);
        let rapid = self.from_plc.rapid;
        Some(DryRun {
            cutting: if rapid { JOG_RATE_MAX } else { jog },
            rapid: (!rapid && !self.parameters.dry_run_keeps_rapid()).then_some(jog),
        })
    }

    /// The zero lamps go out when an axis leaves its reference point.
    fn watch_reference(&mut self) {
        let now = self.position();
        for axis in [Axis::X, Axis::Z] {
            let at = self.at_reference.get_mut(axis);
            *at = at.filter(|at| *at == now.get(axis));
        }
    }

    fn at_program_zero(&self) -> PerAxis<bool> {
        let Some(zero) = self.program_zero else {
            return PerAxis::default();
        };
        let position = self.position();
        PerAxis::new(position.x == zero.x, position.z == zero.z)
    }

    pub(crate) const fn machine_locked(&self) -> bool {
        self.from_plc.machine_lock.x && self.from_plc.machine_lock.z
    }

    /// Before a run: the distance that machine lock kept from the slides moves from
    /// the motion into the frame. The display stays, the slides stay, and machine
    /// coordinates are true again.
    pub(crate) fn settle_coordinates(&mut self) {
        let slide = self.axes.slide();
        let away = self.position() - slide;
        self.interpolator.translate(-away);
        self.axes.preset(Axis::X, slide.x);
        self.axes.preset(Axis::Z, slide.z);
        self.frame.zero = self.frame.zero - away;
        let frame = self.frame;
        let (interpreter, world) = self.interpreter_and_world(true);
        interpreter.set_frame(frame, &world);
    }

    /// Where the slides really are, machine coordinates.
    pub(crate) fn slide(&self) -> Point {
        self.axes.slide()
    }

    /// Where the axes would come to rest if they braked now.
    pub(crate) fn stopping_point(&self) -> Point {
        self.interpolator.stopping_point(&self.limits)
    }

    /// Pulses commanded so far.
    pub fn pulses(&self) -> PerAxis<Pulses> {
        self.axes.pulses()
    }

    fn outputs(&self) -> Outputs {
        Outputs {
            y: core::array::from_fn(|index| self.y.get(index).copied().unwrap_or(0)),
            pulses: self.pulses(),
            spindle_volts: self.spindle.volts(),
            enable: PerAxis::new(!self.emergency_stop, !self.emergency_stop),
        }
    }
}
