//! Passes the commands of a run through the nose radius compensation (manual II, C
//! compensation).

use crate::alarm::{Alarm, groups};
use crate::command::{Action, Command};
use crate::compensation::Origin;
use crate::interpreter::context::Compensated;
use crate::interpreter::context::exact::Exact;
use crate::interpreter::context::host::Host;
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::Words;
use crate::interpreter::reader::{Advance, Interpreter};
use crate::memory::{Counters, Offsets, Parameters, Registers, Settings, Variables};
use crate::program::ProgramMemory;
use crate::units::{PerAxis, Point};

impl Interpreter {
    /// Reads up to the next command, like [`next`](Self::next), but without a heap allocation.
    ///
    /// # Errors
    /// The alarm of the block.
    pub(crate) fn advance<H: Host>(&mut self, host: &mut H) -> Result<Advance, Alarm> {
        if self.mdi.is_some() {
            return self.step(&mut Ahead { host, held: false });
        }
        if self.aside.is_some() {
            if !host.settled() {
                return Ok(Advance::Wait);
            }
            self.come_back(host.machine_position());
        }
        loop {
            if let Some(ready) = self.compensation.take() {
                return ready.map(Advance::Command);
            }
            let held = self.compensation.holds();
            match self.step(&mut Ahead { host, held }) {
                Ok(Advance::Command(command)) => {
                    let attends =
                        command.modal.nose_compensation != 40 || self.compensation.is_on();
                    if !attends || is_a_turn_only(&command) {
                        return Ok(Advance::Command(command));
                    }
                    self.compensation.push(
                        command,
                        Origin {
                            contour: self.main.contour,
                            nose: self.state.nose,
                            offset_by_shift: host.parameters().offset_by_shift(),
                        },
                    );
                }
                Err(alarm) if held && groups::is_of_corner(alarm.number) => {
                    self.compensation.refuse(alarm);
                }
                // The corner depends on the block that has not arrived yet.
                Ok(Advance::Starved) => return Ok(Advance::Starved),
                // The reader reads the block again when every earlier command is finished.
                Ok(Advance::Wait | Advance::Ended) | Err(_) if held => self.compensation.flush(),
                answer => return answer,
            }
        }
    }

    /// Sets the start position of the compensation to that before a block, if the block just
    /// read may start the compensation.
    pub(super) fn stand_as(&mut self, before: &State) {
        if self.state.modal.nose_compensation != 40 && !self.compensation.is_on() {
            let machine = before.machine(before.position).point();
            self.compensation.stand_at(machine, before.frame());
        }
    }

    /// The mode of the compensation before the next block.
    pub(super) fn compensated(&self) -> Compensated {
        match (&self.mdi, self.compensation.is_on()) {
            (Some(_), _) => Compensated::Never,
            (None, true) => Compensated::On,
            (None, false) => Compensated::Off,
        }
    }

    /// Whether a block that otherwise waits may be read while earlier moves wait for their
    /// ends. Its effects keep their order.
    pub(super) fn reads_early(&self, words: &Words) -> bool {
        self.mdi.is_none()
            && self.compensation.holds()
            && !matches!(words.m, Some(0 | 30 | 98 | 99))
    }

    /// Suspends a compensated run while something else moves the tool: stores its programmed
    /// end.
    pub(super) fn lay_aside(&mut self) {
        if self.compensation.is_on() || self.compensation.holds() {
            let position = self.state.machine(self.state.position);
            self.aside.get_or_insert(position);
        }
    }

    /// Continues the compensated run from the current machine position.
    fn come_back(&mut self, machine: Point) {
        let Some(position) = self.aside.take() else {
            return;
        };
        let by = self.compensation.displace(machine);
        let moved = if self.compensation.holds() {
            position
        } else {
            position + Exact::from_point(by)
        };
        self.state.stand_at(moved);
    }

    /// Drops the compensation vector without motion.
    pub(super) fn drop_compensation(&mut self) {
        self.compensation.clear();
        self.aside = None;
    }
}

/// Whether a command only gives the control a turn between silent blocks.
fn is_a_turn_only(command: &Command) -> bool {
    matches!(command.action, Action::Nothing) && !command.block_end
}

/// The host as the reader sees it while moves wait for their ends: nothing counts as finished.
struct Ahead<'a, H> {
    host: &'a mut H,
    held: bool,
}

impl<H: Host> Host for Ahead<'_, H> {
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
    fn settings(&self) -> &Settings {
        self.host.settings()
    }
    fn settings_mut(&mut self) -> &mut Settings {
        self.host.settings_mut()
    }
    fn now_ms(&self) -> u64 {
        self.host.now_ms()
    }
    fn parameters(&self) -> &Parameters {
        self.host.parameters()
    }
    fn parameters_mut(&mut self) -> &mut Parameters {
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
    fn block_skip(&self) -> bool {
        self.host.block_skip()
    }
    fn settled(&self) -> bool {
        !self.held && self.host.settled()
    }

    fn slides_stand(&self) -> bool {
        !self.held && self.host.slides_stand()
    }
}
