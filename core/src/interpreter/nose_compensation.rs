//! Passes the commands of a run through the nose radius compensation (manual II, C
//! compensation).

use crate::alarm::{Alarm, groups};
use crate::command::{Action, ControlCommand};
use crate::compensation::CommandContext;
use crate::interpreter::context::CompensationMode;
use crate::interpreter::exact::ExactPoint;
use crate::interpreter::host::Host;
use crate::interpreter::reader::{AdvanceResult, Interpreter};
use crate::interpreter::state::State;
use crate::interpreter::words::SortedWords;
use crate::memory::{ControlParameters, ControlSettings, Counters, Offsets, Registers, Variables};
use crate::program::ProgramMemory;
use crate::units::{PerAxis, Point};

impl Interpreter {
    /// Reads blocks up to the next command, like [`next`](Self::next), and stores it in
    /// `command`: it is large, and each block of a program makes one.
    ///
    /// # Errors
    /// The alarm of the block.
    pub(crate) fn advance<H: Host>(
        &mut self,
        host: &mut H,
        command: &mut Option<ControlCommand>,
    ) -> Result<AdvanceResult, Alarm> {
        if self.mdi.is_some() {
            let mut host = LookaheadHost {
                host,
                is_holding: false,
            };
            return self.next_programmed(&mut host, command);
        }
        if self.suspended_position.is_some() {
            if !host.is_settled() {
                return Ok(AdvanceResult::Wait);
            }
            self.resume_compensation(host.machine_position());
        }
        loop {
            if let Some(ready) = self.compensation.take() {
                *command = Some(ready?);
                return Ok(AdvanceResult::Command);
            }
            let is_holding = self.compensation.has_pending();
            match self.next_programmed(&mut LookaheadHost { host, is_holding }, command) {
                Ok(AdvanceResult::Command) => {
                    let is_on = self.compensation.is_on();
                    let is_compensated = |it: &mut ControlCommand| {
                        (is_on || it.modal.nose_compensation != 40) && !is_idle_command(it)
                    };
                    let Some(programmed) = command.take_if(is_compensated) else {
                        return Ok(AdvanceResult::Command);
                    };
                    self.compensation.push(
                        programmed,
                        CommandContext {
                            contour: self.main.is_contour,
                            nose: self.state.nose,
                            offset_by_shift: host.parameters().is_offset_by_shift(),
                        },
                    );
                }
                Err(alarm) if is_holding && groups::is_corner_alarm(alarm.number) => {
                    self.compensation.refuse(alarm);
                }
                // The corner depends on the block that has not arrived yet.
                Ok(AdvanceResult::Starved) => return Ok(AdvanceResult::Starved),
                // The reader reads the block again when every earlier command is finished.
                Ok(AdvanceResult::Wait | AdvanceResult::Ended) | Err(_) if is_holding => {
                    self.compensation.flush();
                }
                answer => return answer,
            }
        }
    }

    /// Sets the start position of the compensation to the tool position before the block just
    /// read, if this block may start the compensation.
    pub(super) fn set_compensation_start(&mut self, before: &State) {
        if self.state.modal.nose_compensation != 40 && !self.compensation.is_on() {
            let machine = before.to_machine(before.position).to_point();
            self.compensation.set_position(machine, before.frame());
        }
    }

    /// The mode of the nose radius compensation before the next block.
    pub(super) fn compensation_mode(&self) -> CompensationMode {
        match (&self.mdi, self.compensation.is_on()) {
            (Some(_), _) => CompensationMode::Never,
            (None, true) => CompensationMode::On,
            (None, false) => CompensationMode::Off,
        }
    }

    /// Whether the reader may read a block that needs a standstill although the compensation
    /// holds back earlier moves. The effects of the block keep their order.
    pub(super) fn can_read_early(&self, words: &SortedWords) -> bool {
        self.mdi.is_none()
            && self.compensation.has_pending()
            && !matches!(words.m, Some(0 | 30 | 98 | 99))
    }

    /// Suspends a compensated run before MDI or manual motion moves the tool: stores the
    /// programmed end of the run.
    pub(super) fn suspend_compensation(&mut self) {
        if self.compensation.is_on() || self.compensation.has_pending() {
            let position = self.state.to_machine(self.state.position);
            self.suspended_position.get_or_insert(position);
        }
    }

    /// Continues the suspended run from the machine position `machine` (mm, X as a radius).
    fn resume_compensation(&mut self, machine: Point) {
        let Some(position) = self.suspended_position.take() else {
            return;
        };
        let displacement = self.compensation.displace(machine);
        let resumed_position = if self.compensation.has_pending() {
            position
        } else {
            position + ExactPoint::from_point(displacement)
        };
        self.state.set_machine_position(resumed_position);
    }

    /// Ends the compensation without motion: drops its vector and the moves that it holds
    /// back.
    pub(super) fn drop_compensation(&mut self) {
        self.compensation.clear();
        self.suspended_position = None;
    }
}

/// Whether a command does nothing and ends no block, so that it needs no compensation.
fn is_idle_command(command: &ControlCommand) -> bool {
    matches!(command.action, Action::Nothing) && !command.block_end
}

/// A host that reports no command as finished while the compensation holds back moves
/// (`is_holding`).
struct LookaheadHost<'a, H> {
    host: &'a mut H,
    is_holding: bool,
}

impl<H: Host> Host for LookaheadHost<'_, H> {
    fn offsets_mut(&mut self) -> &mut Offsets {
        self.host.offsets_mut()
    }
    fn registers(&self) -> &Registers {
        self.host.registers()
    }
    fn registers_mut(&mut self) -> &mut Registers {
        self.host.registers_mut()
    }
    fn counters(&self) -> &Counters {
        self.host.counters()
    }
    fn counters_mut(&mut self) -> &mut Counters {
        self.host.counters_mut()
    }
    fn started_ms(&self) -> u64 {
        self.host.started_ms()
    }
    fn set_started_ms(&mut self, ms: u64) {
        self.host.set_started_ms(ms);
    }
    fn settings(&self) -> &ControlSettings {
        self.host.settings()
    }
    fn settings_mut(&mut self) -> &mut ControlSettings {
        self.host.settings_mut()
    }
    fn now_ms(&self) -> u64 {
        self.host.now_ms()
    }
    fn parameters(&self) -> &ControlParameters {
        self.host.parameters()
    }
    fn parameters_mut(&mut self) -> &mut ControlParameters {
        self.host.parameters_mut()
    }
    fn offsets(&self) -> &Offsets {
        self.host.offsets()
    }
    fn variables(&self) -> &Variables {
        self.host.variables()
    }
    fn variables_mut(&mut self) -> &mut Variables {
        self.host.variables_mut()
    }
    fn interface_inputs(&self) -> u16 {
        self.host.interface_inputs()
    }
    fn interface_outputs(&self) -> u64 {
        self.host.interface_outputs()
    }
    fn set_interface_outputs(&mut self, outputs: u64) {
        self.host.set_interface_outputs(outputs);
    }
    fn programs(&self) -> &ProgramMemory {
        self.host.programs()
    }
    fn machine_position(&self) -> Point {
        self.host.machine_position()
    }
    fn referenced(&self) -> PerAxis<bool> {
        self.host.referenced()
    }
    fn is_block_skip_on(&self) -> bool {
        self.host.is_block_skip_on()
    }
    fn is_settled(&self) -> bool {
        !self.is_holding && self.host.is_settled()
    }

    fn is_at_standstill(&self) -> bool {
        !self.is_holding && self.host.is_at_standstill()
    }
}
