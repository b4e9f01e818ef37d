//! What the panel may ask of the control; the control decides.

use std::sync::Arc;

use gsk_plc::Ladder;
use gsk_plc::address::{Area, BitAddress};

use super::{Cnc, LadderStep, X_BYTES};
use crate::alarm::Alarm;
use crate::command::ProgramId;
use crate::operation::{Mode, SoftSwitch};
use crate::program::Program;
use crate::units::Axis;

/// A request of the panel.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Relative coordinate of one axis to zero.
    ZeroRelative(Axis),
    /// The place where one axis stands becomes its machine zero; for axes without a
    /// zero switch.
    SetMachineZero(Axis),
    /// Part counter to zero.
    ClearParts,
    /// Cutting time to zero.
    ClearCuttingTime,
    /// Selects a stored program.
    SelectProgram(u16),
    /// Puts the cursor on a line of the selected program, from 1.
    CursorTo(u32),
    /// Searches a sequence number in the selected program.
    SearchSequence(u16),
    /// Stores a program text in the program memory.
    StoreProgram(String),
    /// Opens a program outside the memory, read-only.
    OpenExternal(Program),
    /// One word for the MDI block.
    MdiWord(String),
    /// A value for a common macro variable, keyed in on its page.
    SetVariable {
        /// #200–#231, #500–#515.
        number: u16,
        /// −2³² to 2³² − 1.
        value: i64,
    },
    /// A point of the pitch error table.
    SetPitch {
        /// Axis.
        axis: Axis,
        /// Point, 0–255.
        point: u8,
        /// −255 to 255, in 0.001 mm.
        value: i16,
    },
    /// 英制编程: programs are in inches from now on.
    SetInchInput(bool),
    /// The OUTPUT key went down or up.
    OutputKey(bool),
    /// A switch of the page 机床面板: the request goes to the ladder as F75.
    SoftSwitch(SoftSwitch, bool),
    /// Holds a bit of PLC memory at a value; `None` lets it go.
    ForceBit(BitAddress, Option<bool>),
    /// Halts the ladder, or lets it run on.
    HaltLadder(bool),
    /// The halted ladder goes on by a step.
    StepLadder(LadderStep),
    /// A ladder for the next power-on, as a download does.
    LoadLadder(Arc<Ladder>),
}

impl Cnc {
    /// Carries out a request, or raises the alarm that says why not. A refusal
    /// that the manual gives no alarm for is silent.
    ///
    /// # Errors
    /// The alarm that was raised: 031 or 071 program not found, 060 sequence number
    /// not found, 068 and 072 memory full, 111 and 115 for variables, and those of
    /// the MDI words.
    pub fn request(&mut self, request: Request) -> Result<(), Alarm> {
        let done = self.carry_out_request(request);
        if let Err(alarm) = &done {
            self.raise(alarm.clone());
        }
        done
    }

    fn carry_out_request(&mut self, request: Request) -> Result<(), Alarm> {
        match request {
            Request::ZeroRelative(axis) if !self.is_moving() => {
                *self.relative_zero.get_mut(axis) = self.position_absolute().get(axis);
            }
            Request::SetMachineZero(axis) => self.set_machine_zero(axis),
            Request::ClearParts if !self.is_moving() => self.counters.clear_parts(),
            Request::ClearCuttingTime if !self.is_moving() => self.counters.clear_cutting_time(),
            Request::ZeroRelative(_) | Request::ClearParts | Request::ClearCuttingTime => {}
            Request::SelectProgram(number) => self.select(ProgramId::Stored(number))?,
            Request::CursorTo(line) => {
                if !self.automatic.operating() {
                    self.forget_run();
                    self.cursor_line = line.max(1);
                }
            }
            Request::SearchSequence(number) => self.search_sequence(number)?,
            Request::StoreProgram(_) if self.memory_protected() => {}
            Request::StoreProgram(text) => {
                let number = self.programs.store(text)?;
                if !self.automatic.operating() {
                    self.select(ProgramId::Stored(number))?;
                }
            }
            Request::OpenExternal(program) => {
                if self.automatic.operating() {
                    return Ok(());
                }
                self.programs.open_external(program);
                self.select(ProgramId::External)?;
            }
            Request::MdiWord(word) => self.mdi.enter(&word, &self.parameters)?,
            Request::SetVariable { number, value } => {
                if self.mode == Mode::Mdi && !self.automatic.operating() {
                    self.variables.set(number, value)?;
                }
            }
            Request::SetPitch { axis, point, value } => {
                let allowed = self.mode == Mode::Mdi || self.emergency_stop;
                if allowed && !self.automatic.operating() && !self.is_moving() {
                    self.pitch.set(axis, point, value)?;
                    self.axes.reconfigure(&self.parameters, &self.pitch);
                }
            }
            Request::SetInchInput(inch) => {
                if self.mode == Mode::Mdi && !self.automatic.operating() {
                    self.inch_input = inch;
                    self.interpreter.set_inch_input(inch);
                    self.modal.inch = inch;
                }
            }
            Request::OutputKey(down) => self.output_key = down,
            Request::SoftSwitch(switch, true) => self.soft_switches |= switch.mask(),
            Request::SoftSwitch(switch, false) => self.soft_switches &= !switch.mask(),
            Request::ForceBit(bit, value) => self.plc.force(bit, value),
            Request::HaltLadder(halt) => self.plc_halted = halt,
            Request::StepLadder(step) => self.step_ladder(step),
            Request::LoadLadder(ladder) => self.next_ladder = Some(ladder),
        }
        Ok(())
    }

    /// Presses or releases a key of the machine panel: its contact in X20–X26.
    pub fn set_panel_key(&mut self, contact: BitAddress, down: bool) {
        let byte = usize::from(contact.byte);
        if contact.area != Area::X || byte >= X_BYTES {
            return;
        }
        let mask = 1 << contact.bit;
        if down {
            self.panel_keys[byte] |= mask;
        } else {
            self.panel_keys[byte] &= !mask;
        }
    }

    fn select(&mut self, program: ProgramId) -> Result<(), Alarm> {
        if self.automatic.operating() {
            return Ok(());
        }
        let missing = if self.mode == Mode::Auto { 31 } else { 71 };
        if self.programs.get(program).is_none() {
            return Err(Alarm::new(missing));
        }
        self.programs.select(program);
        self.forget_run();
        self.cursor_line = 1;
        Ok(())
    }

    fn search_sequence(&mut self, number: u16) -> Result<(), Alarm> {
        if self.automatic.operating() {
            return Ok(());
        }
        let line = self
            .programs
            .current()
            .and_then(|program| self.programs.get(program))
            .and_then(|program| program.find_sequence(number, 1));
        self.cursor_line = line.ok_or_else(|| Alarm::new(60))?;
        self.forget_run();
        Ok(())
    }

    /// A moved cursor voids the rest of a stopped run.
    fn forget_run(&mut self) {
        self.automatic.clear();
    }
}
