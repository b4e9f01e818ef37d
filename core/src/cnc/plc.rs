//! The part of a tick that concerns the PLC: samples the contacts, runs a slot of the ladder, and
//! exchanges signals with the control.

use super::{Cnc, SerialPort};
use crate::alarm::{Alarm, number};
use crate::command::Action;
use crate::machine::{MachineInputs, TrippedLimit, pins};
use crate::model::{AxisEnd, EdgeAction, InputSignal, LadderOutput, MCode, WiredContact, ncb08};
use crate::motion::JogRate;
use crate::operation::{FromPlc, InputFilter, OperatingMode, RunState, ToPlc, ZeroReturnStage};
use crate::program::DncBuffer;
use crate::units::{Axis, PerAxis, Point};

/// Combines output numbers (from 0) to a bit mask.
fn output_mask(outputs: &[u8]) -> u32 {
    outputs.iter().fold(0, |bits, output| bits | 1 << output)
}

/// The limit switch at an end of an axis.
const fn limit_at(side: AxisEnd) -> TrippedLimit {
    match side {
        AxisEnd::Plus => TrippedLimit::Plus,
        AxisEnd::Minus => TrippedLimit::Minus,
    }
}

/// First F byte of the outputs that a program switches directly: F54 to F56.
const PROGRAM_OUTPUTS: u16 = 54;
/// X byte of the keys that only the panel of another model has.
const MODEL_KEYS: u16 = 27;

impl Cnc {
    /// Switches outputs for a program. `on` and `off` are masks with Y0 in bit 0; after
    /// `ms` (0 = never) the outputs in `on` switch off again.
    pub(super) fn switch_outputs(&mut self, on: u32, off: u32, ms: u32) {
        let before = self.program_outputs();
        let after = self.plc.output_timers.switch(before, on, off, ms);
        self.set_program_outputs(after);
    }

    /// Switches off the outputs whose time has elapsed.
    pub(super) fn advance_output_timers(&mut self) {
        let elapsed = self.plc.output_timers.tick();
        if elapsed != 0 {
            self.set_program_outputs(self.program_outputs() & !elapsed);
        }
    }

    /// The outputs that are active, as a mask with Y0 in bit 0. An inverted one is then off.
    pub(super) fn program_outputs(&self) -> u32 {
        let f = |byte| self.plc.engine.memory().f(PROGRAM_OUTPUTS + byte);
        u32::from_le_bytes([f(0), f(1), f(2), 0]) ^ self.memory.model.inverted_outputs()
    }

    pub(super) fn set_program_outputs(&mut self, outputs: u32) {
        let outputs = outputs ^ self.memory.model.inverted_outputs();
        let memory = self.plc.engine.memory_mut();
        let [low, middle, high, _] = outputs.to_le_bytes();
        memory.set_f(PROGRAM_OUTPUTS, low);
        memory.set_f(PROGRAM_OUTPUTS + 1, middle);
        memory.set_f(PROGRAM_OUTPUTS + 2, high);
    }

    /// Whether the input with the number `input`, from 0, of the control model has the level `high`
    /// (true = on).
    pub(super) fn has_input_level(&self, input: u8, high: bool) -> bool {
        self.input_level(input) == high
    }

    /// The F byte and bit of the output with the number `output`, from 0, of the control model.
    pub const fn output_signal(output: u8) -> (u16, u8) {
        (PROGRAM_OUTPUTS + output as u16 / 8, output % 8)
    }

    /// Whether the output with the number `output`, from 0, of the control model is on.
    pub fn model_output(&self, output: u8) -> bool {
        let (byte, bit) = Self::output_signal(output);
        output < 24 && self.plc.engine.memory().f(byte) >> bit & 1 == 1
    }

    /// Whether the input with the number `input`, from 0, of the control model is on.
    pub fn input_level(&self, input: u8) -> bool {
        let contact = self.memory.model.record().first_input + input;
        let byte = self.plc.engine.memory().x(u16::from(contact / 8));
        byte >> (contact % 8) & 1 == 1
    }

    /// Combines the inputs of the control model with the contacts of the machine, in `contacts`: a
    /// switch acts through either of them, and both show its state.
    fn combine_inputs(&self, inputs: &MachineInputs, contacts: &mut [u8]) {
        let record = self.memory.model.record();
        let is_on = |(byte, bit): pins::ContactPin| {
            let levels = inputs.x.get(usize::from(byte)).copied();
            levels.unwrap_or(0) >> bit & 1 == 1
        };
        let mut set = |(byte, bit): pins::ContactPin, on: bool| {
            if let Some(levels) = contacts.get_mut(usize::from(byte)) {
                *levels = *levels & !(1 << bit) | u8::from(on) << bit;
            }
        };
        let pressed = self.memory.parameters.is_deceleration_closed();
        for assigned in self.memory.model.assigned_inputs() {
            let InputSignal::Wire(wire) = assigned.signal else {
                continue;
            };
            let contact = record.first_input + assigned.input;
            let input_contact = (contact / 8, contact % 8);
            let active = !assigned.inverted;
            let (pin, operated) = match wire {
                // The contact of the emergency-stop loop opens.
                WiredContact::EmergencyStop => (pins::EMERGENCY_STOP, false),
                WiredContact::Limit(axis, side) => {
                    if *inputs.over_limit.get(axis) == Some(limit_at(side)) {
                        set(input_contact, active);
                    }
                    (pins::EMERGENCY_STOP, false)
                }
                WiredContact::Deceleration(Axis::X) => (pins::DECELERATION_X, pressed),
                WiredContact::Deceleration(Axis::Z) => (pins::DECELERATION_Z, pressed),
            };
            if is_on(input_contact) == active {
                set(pin, operated);
            } else if matches!(wire, WiredContact::Deceleration(_)) && is_on(pin) == operated {
                set(input_contact, active);
            }
        }
    }

    /// The limit switch of an axis that an input of the model reports as tripped; `None`
    /// without one.
    pub(super) fn limit_reported_by_input(&self, axis: Axis) -> Option<TrippedLimit> {
        let mut assigned = self.memory.model.assigned_inputs();
        assigned.find_map(|it| match it.signal {
            InputSignal::Wire(WiredContact::Limit(of, side))
                if of == axis && self.input_level(it.input) != it.inverted =>
            {
                Some(limit_at(side))
            }
            _ => None,
        })
    }

    /// Switches the outputs of the model that follow outputs of the ladder.
    fn update_following_outputs(&mut self) {
        let record = self.memory.model.record();
        if record.followers.is_empty() && record.followed.is_empty() {
            return;
        }
        let memory = self.plc.engine.memory();
        let is_on = |(byte, bit): pins::ContactPin| memory.y(u16::from(byte)) >> bit & 1 == 1;
        let pin = |output: LadderOutput| match output {
            LadderOutput::Coolant => pins::COOLANT,
            LadderOutput::SpindleForward => pins::FORWARD,
            LadderOutput::SpindleReverse => pins::REVERSE,
            LadderOutput::Brake => pins::BRAKE,
            LadderOutput::Lubrication => pins::LUBRICATION,
        };
        let by_codes = record.followers.iter().map(|it| it.output);
        let by_outputs = record.followed.iter().map(|(output, _)| *output);
        let levels = by_codes
            .chain(by_outputs)
            .map(|output| is_on(pin(output)))
            .enumerate()
            .fold(0_u32, |levels, (index, on)| levels | u32::from(on) << index);
        let before = core::mem::replace(&mut self.plc.followed_levels, levels);
        let changed = |index: usize| (levels ^ before) >> index & 1 == 1;
        let is_on_now = |index: usize| levels >> index & 1 == 1;
        for (index, follower) in record.followers.iter().enumerate() {
            if changed(index) {
                self.switch_m_outputs(if is_on_now(index) {
                    follower.on
                } else {
                    follower.off
                });
            }
        }
        for (index, (_, output)) in record.followed.iter().enumerate() {
            let index = index + record.followers.len();
            let bit = self.memory.model.outputs_of(1 << output);
            match (changed(index), is_on_now(index)) {
                (true, true) => self.switch_outputs(bit, 0, 0),
                (true, false) => self.switch_outputs(0, bit, 0),
                (false, _) => {}
            }
        }
    }

    /// The inputs whose edges act and whose signal is active, as bits.
    pub(super) fn edge_levels(&self) -> u32 {
        let assigned = self.memory.model.assigned_inputs();
        let edges = assigned.filter(|it| matches!(it.signal, InputSignal::Edge(_)));
        edges.fold(0, |levels, it| {
            levels | u32::from(self.input_level(it.input) != it.inverted) << it.input
        })
    }

    /// Handles inputs and keys of the model that have a function in manual operation: their
    /// rising edges switch outputs, or start an M function.
    fn handle_input_edges(&mut self) {
        let record = self.memory.model.record();
        if record.key_edges.is_empty() {
            return;
        }
        let keys = u32::from(self.plc.engine.memory().x(MODEL_KEYS));
        let key_risen = keys & !core::mem::replace(&mut self.plc.model_keys, keys);
        let levels = self.edge_levels();
        let before = core::mem::replace(&mut self.plc.input_levels, levels);
        // An inverted input that is open at power-on is no edge.
        let risen = if self.ticks == 1 { 0 } else { levels & !before };
        if risen | key_risen == 0 {
            return;
        }
        let is_manual = self.run.mode.is_manual() && !self.run.automatic.is_operating();
        if !is_manual || self.is_alarm_active() {
            return;
        }
        let by_input = self.memory.model.assigned_inputs();
        let by_input = by_input.filter_map(|it| match it.signal {
            InputSignal::Edge(edge) if risen >> it.input & 1 == 1 => Some(edge),
            _ => None,
        });
        let by_key = record.key_edges.iter();
        let by_key = by_key.filter(|(key, _)| key_risen >> **key & 1 == 1);
        let edges: Vec<_> = by_input.chain(by_key.map(|(_, edge)| *edge)).collect();
        for edge in edges {
            match edge {
                EdgeAction::Toggles(first, second) => {
                    let function = record.m_function(first);
                    let on = function.map_or(0, |function| output_mask(&function.on));
                    let on = self.memory.model.outputs_of(on);
                    let is_on = self.program_outputs() & on == on;
                    self.switch_m_outputs(if is_on { second } else { first });
                }
                EdgeAction::Does(code) => {
                    self.switch_m_outputs(code);
                    self.output_m(code);
                }
            }
        }
    }

    /// Switches the outputs of an M code of the control model, as a program does.
    fn switch_m_outputs(&mut self, code: u8) {
        let model = &self.memory.model;
        let Some(function) = model.record().m_function(code) else {
            return;
        };
        let ms = match function.meaning {
            MCode::Clamp => model.parameter(ncb08::CLAMP_TIME).unsigned_abs(),
            _ => 0,
        };
        let [on, off] = [&function.on, &function.off].map(|it| model.outputs_of(output_mask(it)));
        self.switch_outputs(on, off, ms);
    }

    pub(super) fn sample_contacts(&mut self, inputs: &MachineInputs) {
        let mut contacts = inputs.x;
        for (contact, key) in contacts.iter_mut().zip(self.plc.panel_keys) {
            *contact |= key;
        }
        self.combine_inputs(inputs, &mut contacts);
        if self.ticks == 1 {
            self.plc.filter = InputFilter::from_contacts(&contacts);
        }
        self.plc
            .filter
            .sample(&contacts, self.memory.parameters.debounce_width());
        let accepted = self.plc.filter.accepted();
        self.plc.engine.memory_mut().set_inputs(accepted);
        self.handle_input_edges();
        self.update_following_outputs();
        let outputs = self.plc.engine.memory().outputs();
        for (byte, output) in self.plc.y.iter_mut().zip(outputs) {
            *byte = *output;
        }
    }

    pub(super) fn run_plc_slot(&mut self) {
        let before = self.plc.signals.clone();
        self.write_signals(&before);
        if !self.plc.halted {
            self.plc.engine.run_slot();
            self.read_signals(&before);
        }
    }

    /// Reads the signals of the ladder and acts on their changes since `before`.
    pub(super) fn read_signals(&mut self, before: &FromPlc) {
        self.plc.signals = FromPlc::read(self.plc.engine.memory());
        if self.memory.parameters.is_override_code_inverted() {
            self.plc.signals.feed_override = 150 - self.plc.signals.feed_override;
        }
        if let Some(minimum) = self.memory.model.record().least_rapid_override {
            let percent = &mut self.plc.signals.rapid_override;
            *percent = minimum.max(*percent);
        }
        self.plc.message = self.plc.engine.memory().has_message_request()
            && self.plc.engine.active_messages().next().is_some();
        if let Some(fault) = self.plc.engine.fault() {
            let detail = fault.message();
            self.raise(Alarm::new(number::POWER_CYCLE).with_detail(detail));
        }
        self.follow_mode();
        self.follow_tool(before.current_tool);
        if self.plc.message {
            self.start_feed_hold();
        } else if self.plc.signals.feed_hold {
            self.handle_feed_hold_signal();
        }
        if before.start && !self.plc.signals.start {
            self.handle_cycle_start();
        }
        if self.plc.signals.next_tool && !before.next_tool {
            self.index_tool();
        }
    }

    fn write_signals(&mut self, g: &FromPlc) {
        let state = self.run.automatic.state;
        let within_block = self.run.automatic.is_stopped_within_block();
        let message = ToPlc {
            mode: self.run.mode,
            started: state == RunState::Run,
            holding: state == RunState::Hold || self.run.automatic.hold_deferred || within_block,
            operating: self.run.automatic.is_operating() || within_block,
            alarm: self.is_alarm_active(),
            reset: self.is_resetting(),
            distribution_end: self.run.automatic.is_distribution_end(),
            servo_ready: self.is_servo_ready(),
            rapid: self.plc.last_rapid,
            cutting: self.run.automatic.is_cutting(),
            dwelling: self.run.automatic.is_dwelling(),
            tapping: matches!(
                self.run.automatic.current_action(),
                Some(Action::Tap { .. })
            ),
            decoded: self.run.automatic.decoded_m,
            handshake: &self.run.handshake,
            gear: self.spindle.control.selected_gear(),
            at_reference: PerAxis::new(
                self.coordinates.at_reference.x.is_some(),
                self.coordinates.at_reference.z.is_some(),
            ),
            referenced: self.coordinates.referenced,
            at_program_zero: self.at_program_zero(),
            moving: self.moving_axes(),
            negative: self.plc.negative,
            output_key: self.plc.output_key && self.run.mode == OperatingMode::Mdi,
            sending: self.serial_port == SerialPort::Sending,
            receiving: self.serial_port == SerialPort::Receiving || self.dnc.is_receiving(),
            receiving_in_background: self
                .memory
                .programs
                .dnc_buffer()
                .is_some_and(DncBuffer::has_more),
            stopped_by_override: self.feed_override_factor() <= 0.0,
            board_lags: self.run.automatic.is_operating() && self.is_board_lagging(),
            soft_switches: self.plc.soft_switches,
            ready: !self.alarms.contains(number::POWER_CYCLE),
            spindle_jog: self.is_spindle_jogging(),
            parameters: &self.memory.parameters,
        };
        message.write(self.plc.engine.memory_mut(), g);
    }

    /// MV: whether each axis moves. Under machine lock an axis does not move.
    fn moving_axes(&self) -> PerAxis<bool> {
        let velocity = self.drives.interpolator.velocity();
        let locked = self.plc.signals.machine_lock;
        PerAxis::new(
            velocity.x != 0.0 && !locked.x,
            velocity.z != 0.0 && !locked.z,
        )
    }

    /// Updates MVD and RPDO from the last motion; once per tick.
    pub(super) fn update_motion_signals(&mut self) {
        let velocity = self.drives.interpolator.velocity();
        if velocity == Point::default() {
            return;
        }
        let moving = self.moving_axes();
        for axis in [Axis::X, Axis::Z] {
            if *moving.get(axis) {
                *self.plc.negative.get_mut(axis) = velocity.get(axis) < 0.0;
            }
        }
        if let Some(rapid) = self.is_at_rapid_rate() {
            self.plc.last_rapid = rapid;
        }
    }

    /// Whether the current motion, programmed or manual, is at a rapid rate; `None` while the axes
    /// only decelerate.
    fn is_at_rapid_rate(&self) -> Option<bool> {
        let returns = [Axis::X, Axis::Z].map(|axis| *self.coordinates.returns.get(axis));
        if returns.iter().any(Option::is_some) {
            let is_rapid = |stage: &Option<ZeroReturnStage>| {
                matches!(
                    stage,
                    Some(
                        ZeroReturnStage::Approach
                            | ZeroReturnStage::Straight
                            | ZeroReturnStage::BoardHoming
                    )
                )
            };
            return Some(returns.iter().any(is_rapid));
        }
        // Motion suspended for manual motion is not under way.
        let programmed = self.run.automatic.current_action();
        if let Some(action) = programmed.filter(|_| self.run.held_motion.is_none()) {
            // A dry run without manual rapid executes rapids at the jog rate.
            let at_rapid_rate = self
                .dry_run()
                .is_none_or(|dry| dry.rapid_mm_per_min.is_none());
            return match action {
                Action::Rapid { .. } => Some(at_rapid_rate),
                action => action.is_motion().then_some(false),
            };
        }
        let manual_rapid = |axis: Axis| match *self.hand.jog.get(axis) {
            Some((_, rate)) => Some(rate == JogRate::Rapid),
            None if !self.drives.interpolator.is_stepping(axis) => None,
            None => {
                let steps = self.run.mode.motion_mode() == OperatingMode::Step;
                Some(steps && self.manual_rate(axis) == JogRate::Rapid)
            }
        };
        match (manual_rapid(Axis::X), manual_rapid(Axis::Z)) {
            (None, None) => None,
            (x, z) => Some(x == Some(true) || z == Some(true)),
        }
    }

    /// Signal SA: true while no emergency stop and no servo alarm is active, both drives are
    /// ready, and the position of a connected board is known.
    fn is_servo_ready(&self) -> bool {
        !self.emergency_stop
            && !self.is_not_ready()
            && self.drives.watch.ready
            && self.drives.board.is_none_or(|board| board.position_known)
    }

    /// Changes to the operating mode that the ladder commands, and stops motion or the run that the
    /// new mode does not permit.
    fn follow_mode(&mut self) {
        let handwheel = self.memory.parameters.has_handwheel();
        let Some(mode) = OperatingMode::from_code(self.plc.signals.mode_code, handwheel) else {
            return;
        };
        if mode == self.run.mode {
            return;
        }
        let previous = core::mem::replace(&mut self.run.mode, mode);
        if previous.is_manual() {
            self.leave_manual_mode();
        }
        if mode.is_manual() {
            self.start_feed_hold();
        } else if mode == OperatingMode::Edit
            || self.run.automatic.is_operating() && !self.belongs_to_mode(mode)
        {
            self.run.automatic.request_stop();
        }
    }
}
