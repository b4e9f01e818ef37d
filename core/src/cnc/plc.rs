//! The PLC's part of a tick: samples the contacts, runs its slot, and exchanges signals
//! with the control.

use super::{Cnc, SerialPort};
use crate::alarm::{Alarm, number};
use crate::command::Action;
use crate::machine::{Inputs, OverLimit, pins};
use crate::model::{Edge, LadderOutput, MCode, Side, Wire, ncb08};
use crate::motion::JogRate;
use crate::operation::{FromPlc, InputFilter, Mode, Return, RunState, ToPlc};
use crate::program::Inflow;
use crate::units::{Axis, PerAxis, Point};

/// Bit mask of output numbers.
fn mask(outputs: &[u8]) -> u32 {
    outputs.iter().fold(0, |bits, output| bits | 1 << output)
}

/// The limit switch at a side of an axis.
const fn over_limit(side: Side) -> OverLimit {
    match side {
        Side::Plus => OverLimit::Plus,
        Side::Minus => OverLimit::Minus,
    }
}

/// F54 to F56: outputs that a program switches directly.
const PROGRAM_OUTPUTS: u16 = 54;

impl Cnc {
    /// Switches outputs of a program; after `ms` those in `on` switch off again.
    pub(super) fn switch_outputs(&mut self, on: u32, off: u32, ms: u32) {
        let now = self.program_outputs();
        let then = self.plc.output_timers.switch(now, on, off, ms);
        self.set_program_outputs(then);
    }

    /// Switches off the outputs whose time has elapsed.
    pub(super) fn output_tick(&mut self) {
        let over = self.plc.output_timers.tick();
        if over != 0 {
            self.set_program_outputs(self.program_outputs() & !over);
        }
    }

    fn program_outputs(&self) -> u32 {
        let f = |byte| self.plc.engine.memory().f(PROGRAM_OUTPUTS + byte);
        u32::from_le_bytes([f(0), f(1), f(2), 0])
    }

    fn set_program_outputs(&mut self, outputs: u32) {
        let memory = self.plc.engine.memory_mut();
        let [low, middle, high, _] = outputs.to_le_bytes();
        memory.set_f(PROGRAM_OUTPUTS, low);
        memory.set_f(PROGRAM_OUTPUTS + 1, middle);
        memory.set_f(PROGRAM_OUTPUTS + 2, high);
    }

    /// Whether a machine input has a level: 0 is X0.0, 8 is X1.0.
    pub(super) fn input_is(&self, input: u8, high: bool) -> bool {
        self.input(input) == high
    }

    /// Level of an input by its number on the model.
    fn input(&self, input: u8) -> bool {
        let contact = self.memory.model.record().first_input + input;
        let byte = self.plc.engine.memory().x(u16::from(contact / 8));
        byte >> (contact % 8) & 1 == 1
    }

    /// Combines the inputs of the model with the contacts of the machine: a switch acts
    /// through either of them, and both show it.
    fn join_wires(&self, inputs: &Inputs, contacts: &mut [u8]) {
        let record = self.memory.model.record();
        let is_on = |(byte, bit): pins::Pin| {
            let levels = inputs.x.get(usize::from(byte)).copied();
            levels.unwrap_or(0) >> bit & 1 == 1
        };
        let mut set = |(byte, bit): pins::Pin, on: bool| {
            if let Some(levels) = contacts.get_mut(usize::from(byte)) {
                *levels = *levels & !(1 << bit) | u8::from(on) << bit;
            }
        };
        let pressed = self.memory.parameters.closed_means_deceleration();
        for (input, wire) in &record.wires {
            let contact = record.first_input + input;
            let own = (contact / 8, contact % 8);
            let (pin, operated) = match *wire {
                // The contact of the emergency-stop loop opens.
                Wire::EmergencyStop => (pins::EMERGENCY_STOP, false),
                Wire::Limit(axis, side) => {
                    if *inputs.over_limit.get(axis) == Some(over_limit(side)) {
                        set(own, true);
                    }
                    (pins::EMERGENCY_STOP, false)
                }
                Wire::Deceleration(Axis::X) => (pins::DECELERATION_X, pressed),
                Wire::Deceleration(Axis::Z) => (pins::DECELERATION_Z, pressed),
            };
            if is_on(own) {
                set(pin, operated);
            } else if matches!(wire, Wire::Deceleration(_)) && is_on(pin) == operated {
                set(own, true);
            }
        }
    }

    /// The limit switch of an axis that an input of the model reports.
    pub(super) fn wired_limit(&self, axis: Axis) -> Option<OverLimit> {
        let wires = &self.memory.model.record().wires;
        wires.iter().find_map(|(input, wire)| match *wire {
            Wire::Limit(of, side) if of == axis && self.input(*input) => Some(over_limit(side)),
            _ => None,
        })
    }

    /// Switches the outputs of the model that follow outputs of the ladder.
    fn follow_outputs(&mut self) {
        let record = self.memory.model.record();
        if record.followers.is_empty() && record.brake_output.is_none() {
            return;
        }
        let memory = self.plc.engine.memory();
        let is_on = |(byte, bit): pins::Pin| memory.y(u16::from(byte)) >> bit & 1 == 1;
        let pin = |output: LadderOutput| match output {
            LadderOutput::Coolant => pins::COOLANT,
            LadderOutput::SpindleForward => pins::FORWARD,
            LadderOutput::SpindleReverse => pins::REVERSE,
        };
        let followed = record.followers.iter().map(|it| is_on(pin(it.output)));
        let levels = followed
            .chain([is_on(pins::BRAKE)])
            .enumerate()
            .fold(0_u32, |levels, (index, on)| levels | u32::from(on) << index);
        let before = core::mem::replace(&mut self.plc.followed, levels);
        let changed = |index: usize| (levels ^ before) >> index & 1 == 1;
        let now_on = |index: usize| levels >> index & 1 == 1;
        for (index, follower) in record.followers.iter().enumerate() {
            if changed(index) {
                self.act_by_hand(if now_on(index) {
                    follower.on
                } else {
                    follower.off
                });
            }
        }
        let brake = record.followers.len();
        if let Some(output) = record.brake_output.filter(|_| changed(brake)) {
            let bit = 1 << output;
            match now_on(brake) {
                true => self.switch_outputs(bit, 0, 0),
                false => self.switch_outputs(0, bit, 0),
            }
        }
    }

    /// Handles inputs with an own function during manual operation: their edges switch
    /// outputs, or start an M function.
    fn watch_edges(&mut self) {
        let record = self.memory.model.record();
        if record.edges.is_empty() {
            return;
        }
        let levels = record.edges.keys().fold(0_u32, |levels, input| {
            levels | u32::from(self.input(*input)) << input
        });
        let risen = levels & !core::mem::replace(&mut self.plc.input_levels, levels);
        let by_hand = self.run.mode.is_manual() && !self.run.automatic.operating();
        if !by_hand || self.alarm_state() {
            return;
        }
        for (input, edge) in &record.edges {
            if risen >> input & 1 == 0 {
                continue;
            }
            match *edge {
                Edge::Toggles(first, second) => {
                    let on = record.m_function(first).map_or(0, |it| mask(&it.on));
                    let stands = self.program_outputs() & on == on;
                    self.act_by_hand(if stands { second } else { first });
                }
                Edge::Does(code) => {
                    self.act_by_hand(code);
                    self.output_m(code);
                }
            }
        }
    }

    /// Switches the outputs of an M code, as a program does.
    fn act_by_hand(&mut self, code: u8) {
        let model = &self.memory.model;
        let Some(function) = model.record().m_function(code) else {
            return;
        };
        let ms = match function.does {
            MCode::Clamp => model.parameter(ncb08::CLAMP_TIME).unsigned_abs(),
            _ => 0,
        };
        self.switch_outputs(mask(&function.on), mask(&function.off), ms);
    }

    pub(super) fn sample_contacts(&mut self, inputs: &Inputs) {
        let mut contacts = inputs.x;
        for (contact, key) in contacts.iter_mut().zip(self.plc.panel_keys) {
            *contact |= key;
        }
        self.join_wires(inputs, &mut contacts);
        if self.ticks == 1 {
            self.plc.filter = InputFilter::standing(&contacts);
        }
        self.plc
            .filter
            .sample(&contacts, self.memory.parameters.debounce());
        let accepted = self.plc.filter.accepted();
        self.plc.engine.memory_mut().set_inputs(accepted);
        self.watch_edges();
        self.follow_outputs();
        let outputs = self.plc.engine.memory().outputs();
        for (byte, output) in self.plc.y.iter_mut().zip(outputs) {
            *byte = *output;
        }
    }

    pub(super) fn plc_slot(&mut self) {
        let was = self.plc.signals.clone();
        self.write_signals(&was);
        if !self.plc.halted {
            self.plc.engine.run_slot();
            self.read_signals(&was);
        }
    }

    /// Applies the signals of the ladder.
    pub(super) fn read_signals(&mut self, was: &FromPlc) {
        self.plc.signals = FromPlc::read(self.plc.engine.memory());
        if self.memory.parameters.override_code_is_inverted() {
            self.plc.signals.feed_override = 150 - self.plc.signals.feed_override;
        }
        if let Some(least) = self.memory.model.record().least_rapid_override {
            let percent = &mut self.plc.signals.rapid_override;
            *percent = least.max(*percent);
        }
        self.plc.message = self.plc.engine.memory().has_message_request()
            && self.plc.engine.active_messages().next().is_some();
        if let Some(fault) = self.plc.engine.fault() {
            let detail = fault.message();
            self.raise(Alarm::new(number::POWER_CYCLE).because(detail));
        }
        self.follow_mode();
        self.follow_tool(was.current_tool);
        if self.plc.message {
            self.feed_hold();
        } else if self.plc.signals.feed_hold {
            self.feed_hold_signal();
        }
        if was.start && !self.plc.signals.start {
            self.cycle_start();
        }
        if self.plc.signals.next_tool && !was.next_tool {
            self.index_tool();
        }
    }

    fn write_signals(&mut self, g: &FromPlc) {
        let state = self.run.automatic.state;
        let within_block = self.run.automatic.stands_within_block();
        let message = ToPlc {
            mode: self.run.mode,
            started: state == RunState::Run,
            holding: state == RunState::Hold || self.run.automatic.hold_put_off || within_block,
            operating: self.run.automatic.operating() || within_block,
            alarm: self.alarm_state(),
            reset: self.resetting(),
            distribution_end: self.run.automatic.distribution_end(),
            servo_ready: self.servo_ready(),
            rapid: self.plc.last_rapid,
            cutting: self.run.automatic.is_cutting(),
            dwelling: self.run.automatic.dwelling(),
            tapping: matches!(self.run.automatic.action(), Some(Action::Tap { .. })),
            decoded: self.run.automatic.decoded,
            handshake: &self.run.handshake,
            gear: self.spindle.control.selected_gear(),
            at_reference: PerAxis::new(
                self.coordinates.at_reference.x.is_some(),
                self.coordinates.at_reference.z.is_some(),
            ),
            referenced: self.coordinates.referenced,
            at_program_zero: self.at_program_zero(),
            moving: self.axes_moving(),
            negative: self.plc.negative,
            output_key: self.plc.output_key && self.run.mode == Mode::Mdi,
            sending: self.serial_port == SerialPort::Sending,
            receiving: self.serial_port == SerialPort::Receiving || self.dnc.receives(),
            reading_in: self.memory.programs.inflow().is_some_and(Inflow::goes_on),
            stopped_by_override: self.feed_override_factor() <= 0.0,
            checking: self.run.automatic.operating() && self.is_board_behind(),
            soft_switches: self.plc.soft_switches,
            ready: !self.alarms.contains(number::POWER_CYCLE),
            spindle_jog: self.spindle_jog(),
            parameters: &self.memory.parameters,
        };
        message.write(self.plc.engine.memory_mut(), g);
    }

    /// MV: axes that move. Machine lock keeps an axis at its position.
    fn axes_moving(&self) -> PerAxis<bool> {
        let velocity = self.drives.interpolator.velocity();
        let locked = self.plc.signals.machine_lock;
        PerAxis::new(
            velocity.x != 0.0 && !locked.x,
            velocity.z != 0.0 && !locked.z,
        )
    }

    /// Updates MVD and RPDO from the last motion; once per tick.
    pub(super) fn note_motion(&mut self) {
        let velocity = self.drives.interpolator.velocity();
        if velocity == Point::default() {
            return;
        }
        let moving = self.axes_moving();
        for axis in [Axis::X, Axis::Z] {
            if *moving.get(axis) {
                *self.plc.negative.get_mut(axis) = velocity.get(axis) < 0.0;
            }
        }
        if let Some(rapid) = self.selects_rapid() {
            self.plc.last_rapid = rapid;
        }
    }

    /// Whether the motion under way is at a rapid rate, programmed or manual; `None` while
    /// the axes decelerate after it.
    fn selects_rapid(&self) -> Option<bool> {
        let returns = [Axis::X, Axis::Z].map(|axis| *self.coordinates.returns.get(axis));
        if returns.iter().any(Option::is_some) {
            let rapid = |stage: &Option<Return>| {
                matches!(
                    stage,
                    Some(Return::Approach | Return::Straight | Return::Board)
                )
            };
            return Some(returns.iter().any(rapid));
        }
        // Motion suspended for manual motion is not under way.
        let programmed = self.run.automatic.action();
        if let Some(action) = programmed.filter(|_| self.run.held.is_none()) {
            // A dry run without manual rapid executes rapids at the jog rate.
            let at_rapid_rate = self.dry_run().is_none_or(|dry| dry.rapid.is_none());
            return match action {
                Action::Rapid { .. } => Some(at_rapid_rate),
                action => action.is_motion().then_some(false),
            };
        }
        let by_hand = |axis: Axis| match *self.hand.jog.get(axis) {
            Some((_, rate)) => Some(rate == JogRate::Rapid),
            None if !self.drives.interpolator.stepping(axis) => None,
            None => {
                let steps = self.run.mode.motion() == Mode::Step;
                Some(steps && self.manual_rate(axis) == JogRate::Rapid)
            }
        };
        match (by_hand(Axis::X), by_hand(Axis::Z)) {
            (None, None) => None,
            (x, z) => Some(x == Some(true) || z == Some(true)),
        }
    }

    /// SA: the drives are enabled and ready, and none has an alarm.
    fn servo_ready(&self) -> bool {
        !self.emergency_stop
            && !self.is_not_ready()
            && self.drives.watch.ready
            && self.drives.board.is_none_or(|board| board.known)
    }

    /// Follows the mode that the ladder commands.
    fn follow_mode(&mut self) {
        let handwheel = self.memory.parameters.handwheel();
        let Some(mode) = Mode::from_code(self.plc.signals.mode_code, handwheel) else {
            return;
        };
        if mode == self.run.mode {
            return;
        }
        let left = core::mem::replace(&mut self.run.mode, mode);
        if left.is_manual() {
            self.manual_mode_left();
        }
        if mode.is_manual() {
            self.feed_hold();
        } else if mode == Mode::Edit || self.run.automatic.operating() && !self.runs_in(mode) {
            self.run.automatic.request_stop();
        }
    }
}
