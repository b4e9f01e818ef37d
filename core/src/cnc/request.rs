//! What the panel may ask of the control; the control decides.

mod data;
mod programs;
mod received;
mod refused;

use std::sync::Arc;

use gsk_plc::Ladder;
use gsk_plc::address::{Area, BitAddress, ByteAddress};

pub use received::{Received, SerialPort};

use super::{Cnc, LadderStep, X_BYTES};
use crate::alarm::Alarm;
use crate::command::ProgramId;
use crate::memory::{Disk, Refusal, Rights, Setting};
use crate::operation::{RunState, SoftSwitch};
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
    /// A search on the program page found nothing; `sequence`: it was one for a
    /// sequence number.
    NotFound {
        /// Whether a sequence number was searched.
        sequence: bool,
    },
    /// Creates a program that holds only its name.
    CreateProgram(u16),
    /// Stores the selected program under another number as well (另存).
    SaveProgramAs(u16),
    /// Gives the selected program another number.
    RenameProgram(u16),
    /// Deletes a program.
    DeleteProgram(u16),
    /// Deletes every program that may be deleted.
    DeleteAllPrograms,
    /// Asks whether a program may be edited: raises the alarm that says why not.
    AskToEdit(u16),
    /// Asks whether a program may be sent: raises the alarm that says why not.
    AskToSend(u16),
    /// Asks whether a program may come in: raises the alarm that says why not.
    AskToReceive(u16),
    /// What the serial port does from now on (F213).
    SerialPort(SerialPort),
    /// What came in through the serial port.
    Receive(Received),
    /// Stores the edited text of a program.
    StoreEdited {
        /// Its number.
        number: u16,
        /// The text.
        program: Program,
    },
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
    /// A macro variable where programs are in macro B, or of the Huaxing lathes.
    SetMacroVariable {
        /// #1–#33 of the run that stands, #100–#231, #500–#999; or #1–#99.
        number: u16,
        /// Its value; none: null.
        value: Option<f64>,
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
    /// A value for a tool offset, keyed in on its page.
    SetOffset {
        /// 000–032.
        number: u8,
        /// What is given.
        entry: OffsetEntry,
    },
    /// A whole parameter; a status parameter as a byte.
    SetParameter {
        /// Number.
        number: u16,
        /// Value.
        value: i32,
    },
    /// One bit of a status parameter.
    SetParameterBit {
        /// Number.
        number: u16,
        /// Bit.
        bit: u8,
        /// Value.
        on: bool,
    },
    /// A row of the setting page.
    SetSetting(Setting, bool),
    /// 参数开关.
    SetParameterSwitch(bool),
    /// 程序开关.
    SetProgramSwitch(bool),
    /// 取消 and 复位 together: alarm 100 goes, the switch stays.
    CancelSwitchAlarm,
    /// Reads an electronic disk into the memory.
    LoadDisk(Disk),
    /// Saves parameters and offsets on an electronic disk.
    SaveDisk(Disk),
    /// A password: its level becomes the operation level.
    EnterPassword(String),
    /// A new password in place of an old one.
    ChangePassword {
        /// The old one.
        old: String,
        /// The new one.
        new: String,
    },
    /// Down to level 5.
    LeaveLevel,
    /// A soft switch of the machine panel page changes over.
    ToggleSoftSwitch(SoftSwitch),
    /// DGN.075: the tool that is in position.
    SetTool(u8),
    /// A preset of the PLC: a D byte, or the preset of a timer or counter.
    SetPreset(ByteAddress, i32),
    /// What the handwheel was turned by and the axis has not followed is not made.
    DropWheel,
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

/// What is keyed in on the offset page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OffsetEntry {
    /// X or Z with a value in the unit of the display: stored, or measured
    /// (012.5 DOFSI).
    Length(Axis, f64),
    /// X or Z as the table holds it, mm: stored, whatever 012.5 DOFSI says.
    Stored(Axis, f64),
    /// U or W with a value: added.
    Change(Axis, f64),
    /// U or W alone: the relative coordinate.
    Counter(Axis),
    /// R: nose radius, in the unit of the display.
    NoseRadius(f64),
    /// Nose radius as the table holds it, mm.
    StoredRadius(f64),
    /// T: position of the imaginary tool nose.
    NoseNumber(u8),
}

impl Cnc {
    /// Carries out a request, or raises the alarm that says why not. A refusal
    /// that the manual gives no alarm for is silent.
    ///
    /// # Errors
    /// The alarm that was raised: 031 or 071 program not found, 060 sequence number
    /// not found, 068, 072, 074 and 110 of the program memory, 030 and 043 of
    /// offsets and parameters, 111 and 115 for variables, and those of the MDI
    /// words.
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
                *self.coordinates.relative_zero.get_mut(axis) = self.relative_base().get(axis);
            }
            Request::SetMachineZero(axis) => self.set_machine_zero(axis),
            Request::ClearParts if !self.is_moving() => self.memory.counters.clear_parts(),
            Request::ClearCuttingTime if !self.is_moving() => {
                self.memory.counters.clear_cutting_time();
            }
            Request::ZeroRelative(_) | Request::ClearParts | Request::ClearCuttingTime => {}
            Request::SelectProgram(number) => self.select(ProgramId::Stored(number))?,
            Request::CursorTo(line) => {
                if !self.run.automatic.operating() {
                    self.forget_run();
                    self.run.cursor_line = line.max(1);
                }
            }
            Request::NotFound { sequence } => return Err(self.not_found(sequence)),
            Request::CreateProgram(number) => self.create_program(number)?,
            Request::SaveProgramAs(number) => self.save_program_as(number)?,
            Request::RenameProgram(number) => self.rename_program(number)?,
            Request::DeleteProgram(number) => self.delete_program(number)?,
            Request::DeleteAllPrograms => self.delete_all_programs()?,
            Request::AskToEdit(number) => {
                allowed(self.rights().program(number))?;
            }
            Request::AskToSend(number) => {
                allowed(self.rights().send_program(number))?;
            }
            Request::AskToReceive(number) => {
                allowed(self.rights().receive_program(number))?;
            }
            Request::SerialPort(state) => self.serial_port = state,
            Request::Receive(received) => self.take_received(received)?,
            Request::StoreEdited { number, program } => self.store_edited(number, program)?,
            Request::StoreProgram(_) if self.memory_protected() => {}
            Request::StoreProgram(text) => {
                let number = self.memory.programs.store(text)?;
                if !self.rights().hides(number) {
                    self.select(ProgramId::Stored(number))?;
                }
            }
            Request::OpenExternal(program) => {
                if self.run.automatic.operating() {
                    return Ok(());
                }
                self.memory.programs.open_external(program);
                self.select(ProgramId::External)?;
            }
            Request::MdiWord(word) => {
                let macro_b = self.variables_are_real();
                self.run
                    .mdi
                    .enter(&word, &self.memory.parameters, macro_b)?;
            }
            Request::SetVariable { number, value } => {
                if self.rights().variables().is_ok() {
                    self.memory.variables.set(number, value)?;
                }
            }
            Request::SetMacroVariable { number, value } => {
                self.set_macro_variable(number, value)?;
            }
            Request::SetPitch { axis, point, value } => self.set_pitch(axis, point, value)?,
            Request::SetOffset { number, entry } => self.set_offset(number, entry)?,
            Request::SetParameter { number, value } => {
                let record = self.memory.model.record();
                self.change_parameters(|parameters| parameters.set_of(record, number, value))?;
            }
            Request::SetParameterBit { number, bit, on } => {
                self.change_parameters(|parameters| parameters.set_bit(number, bit, on))?;
            }
            Request::SetSetting(setting, on) => self.set_setting(setting, on),
            Request::SetParameterSwitch(on) => self.set_parameter_switch(on),
            Request::SetProgramSwitch(on) => {
                if self.rights().program_switch().is_ok() {
                    self.switches.programs = on;
                }
            }
            Request::CancelSwitchAlarm => self.cancel_switch_alarm(),
            Request::LoadDisk(disk) => self.load_disk(disk),
            Request::SaveDisk(disk) => self.save_disk(disk),
            Request::EnterPassword(password) => {
                if self.rights().password().is_ok() {
                    self.memory.authority.enter(&password);
                }
            }
            Request::ChangePassword { old, new } => {
                if self.rights().password().is_ok() {
                    self.memory.authority.change(&old, &new);
                }
            }
            Request::LeaveLevel => {
                if self.rights().password().is_ok() {
                    self.memory.authority.leave();
                }
            }
            Request::ToggleSoftSwitch(switch) => self.plc.toggle_soft_switch(switch),
            Request::SetTool(tool) => self.set_tool_in_position(tool)?,
            Request::SetPreset(address, value) => self.set_preset(address, value)?,
            Request::DropWheel => self.drop_wheel(),
            Request::OutputKey(down) => self.plc.output_key = down,
            Request::SoftSwitch(switch, on) => self.plc.set_soft_switch(switch, on),
            Request::ForceBit(bit, value) => self.plc.engine.force(bit, value),
            Request::HaltLadder(halt) => self.plc.halted = halt,
            Request::StepLadder(step) => self.step_ladder(step),
            Request::LoadLadder(ladder) => {
                if self.rights().ladder().is_ok() {
                    self.plc.next_ladder = Some(ladder);
                }
            }
        }
        Ok(())
    }

    /// Who may write what at this moment.
    pub fn rights(&self) -> Rights<'_> {
        Rights {
            parameters: &self.memory.parameters,
            level: self.memory.authority.level(),
            mode: self.run.mode,
            operating: self.run.automatic.operating(),
            running: self.run.automatic.state == RunState::Run,
            moving: self.is_moving(),
            alarm: self.alarm_state(),
            emergency_stop: self.emergency_stop,
            parameter_switch: self.switches.parameters,
            program_switch: self.switches.programs,
            protected: self.memory_protected(),
        }
    }

    /// Presses or releases a key of the machine panel: its contact in X20–X26.
    pub fn set_panel_key(&mut self, contact: BitAddress, down: bool) {
        let byte = usize::from(contact.byte);
        if contact.area != Area::X || byte >= X_BYTES {
            return;
        }
        let mask = 1 << contact.bit;
        if down {
            self.plc.panel_keys[byte] |= mask;
        } else {
            self.plc.panel_keys[byte] &= !mask;
        }
    }
}

/// Whether a program operation may go on; a level that is too low has an alarm,
/// the other refusals are silent.
fn allowed(rights: Result<(), Refusal>) -> Result<bool, Alarm> {
    match rights {
        Ok(()) => Ok(true),
        Err(refusal) => refusal.alarm().map_or(Ok(false), Err),
    }
}
