//! Requests of the panel to the control, which decides about them.

mod data;
mod programs;
mod received;
mod refusal;

use std::sync::Arc;

use gsk_plc::Ladder;
use gsk_plc::address::{Area, BitAddress, ByteAddress};
use serde::{Deserialize, Serialize};

pub use received::{ReceivedData, SerialPort};

use super::{Cnc, LadderStep, X_BYTES};
use crate::alarm::Alarm;
use crate::command::ProgramId;
use crate::memory::{Authority, ElectronicDisk, Rights, SettingRow, WriteRefusal};
use crate::operation::{PreparedRestart, RunState, SoftSwitch};
use crate::program::Program;
use crate::units::Axis;

/// A request of the panel to the control.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ControlRequest {
    /// Sets the relative coordinate of one axis to zero.
    ZeroRelative(Axis),
    /// Sets the machine zero of an axis to its current position, if the axis has no zero switch.
    SetMachineZero(Axis),
    /// Sets the part counter to zero.
    ClearParts,
    /// Sets the cutting time to zero.
    ClearCuttingTime,
    /// Selects the stored program with this O number.
    SelectProgram(u16),
    /// Moves the cursor to a line of the selected program, from 1.
    CursorTo(u32),
    /// Raises the alarm for a search on the program page that found nothing.
    NotFound {
        /// Whether the search was for a sequence number, not for a program.
        sequence: bool,
    },
    /// Creates a program with this O number, which holds only its name.
    CreateProgram(u16),
    /// Stores the selected program under this O number too (另存).
    SaveProgramAs(u16),
    /// Gives the selected program this O number.
    RenameProgram(u16),
    /// Deletes the program with this O number.
    DeleteProgram(u16),
    /// Deletes all programs whose deletion is permitted.
    DeleteAllPrograms,
    /// Checks whether the program with this O number may be edited; raises the alarm that
    /// refuses it.
    CheckEdit(u16),
    /// Checks whether the program with this O number may be sent; raises the alarm that
    /// refuses it.
    CheckSend(u16),
    /// Checks whether a program with this O number may be received; raises the alarm that
    /// refuses it.
    CheckReceive(u16),
    /// Sets the state of the serial port (F213).
    SetSerialPort(SerialPort),
    /// Stores data that was received through the serial port, completely or not at all.
    StoreReceived(ReceivedData),
    /// Stores the edited text of a program.
    StoreEdited {
        /// O number of the edited program.
        number: u16,
        /// The whole edited program text.
        program: Program,
    },
    /// Stores a program text in the program memory and selects it.
    StoreProgram(String),
    /// Opens a program outside the memory, which can only be read and executed.
    OpenExternal(Program),
    /// Adds one word to the MDI block.
    AddMdiWord(String),
    /// Sets a common macro variable from its page.
    SetVariable {
        /// Number of the variable: #200–#231, #500–#515.
        number: u16,
        /// New value, −2³² to 2³² − 1.
        value: i64,
    },
    /// Sets a real variable, of macro B or of the Huaxing lathes.
    SetMacroVariable {
        /// Number of the variable. Macro B: #1–#33 of the current run, #100–#231, #500–#999;
        /// Huaxing: #1–#99.
        number: u16,
        /// New value; `None` makes the variable null (empty).
        value: Option<f64>,
    },
    /// Sets a point of the pitch error table.
    SetPitch {
        /// The axis whose pitch error table is changed.
        axis: Axis,
        /// Number of the point in the table, 0–255.
        point: u8,
        /// New correction, −255 to 255, in 0.001 mm.
        value: i16,
    },
    /// Sets a tool offset, as the offset page does.
    SetOffset {
        /// Number of the tool offset, 000–032.
        number: u8,
        /// The new value, with the kind of its entry.
        entry: OffsetEntry,
    },
    /// Sets a whole parameter; a status parameter as the value of its byte.
    SetParameter {
        /// Parameter number.
        number: u16,
        /// New value of the parameter; a status parameter as a byte.
        value: i32,
    },
    /// Sets one bit of a status parameter.
    SetParameterBit {
        /// Parameter number.
        number: u16,
        /// Number of the bit, 0–7.
        bit: u8,
        /// New state of the bit: `true` = 1.
        on: bool,
    },
    /// Sets a parameter that only the selected control model has.
    SetModelParameter {
        /// Parameter number.
        number: u16,
        /// New value of the parameter.
        value: i32,
    },
    /// Sets the absolute coordinate of the tool on an axis, mm (X as a radius), by its zero
    /// offset.
    SetCoordinate(Axis, f64),
    /// Sets a row of the setting page to on or off.
    SetSetting(SettingRow, bool),
    /// Switches 参数开关, which permits changes of parameters while on.
    SetParameterSwitch(bool),
    /// Switches 程序开关, which permits changes of programs while on.
    SetProgramSwitch(bool),
    /// Clears alarm 100 and leaves 参数开关 on (取消 and 复位 together).
    CancelSwitchAlarm,
    /// Replaces parameters, offsets and pitch errors by those of an electronic disk.
    LoadDisk(ElectronicDisk),
    /// Saves parameters, offsets and pitch errors on an electronic disk.
    SaveDisk(ElectronicDisk),
    /// Enters a password: its level becomes the operation level.
    EnterPassword(String),
    /// Replaces the password `old` by `new`.
    ChangePassword {
        /// The current password of the level.
        old: String,
        /// The new password of the level.
        new: String,
    },
    /// Lowers the operation level to 5, which permits the least.
    LowerLevel,
    /// Toggles a soft switch, as its key on the page 机床面板 does.
    ToggleSoftSwitch(SoftSwitch),
    /// Sets the number of the tool that is in position (DGN.075).
    SetTool(u8),
    /// Sets a preset of the PLC: a D byte, or the preset (DT, DC) of a timer or counter.
    SetPreset(ByteAddress, i32),
    /// Drops the handwheel motion that the axis has not followed yet.
    DropWheel,
    /// Reports whether the OUTPUT key is down.
    SetOutputKey(bool),
    /// Sets a soft switch of the page 机床面板 on or off; the ladder reads it in F75.
    SetSoftSwitch(SoftSwitch, bool),
    /// Forces a bit of the PLC memory to a value; `None` releases the bit.
    ForceBit(BitAddress, Option<bool>),
    /// Halts the ladder (true), or lets it run again.
    HaltLadder(bool),
    /// Executes one step of the halted ladder.
    StepLadder(LadderStep),
    /// Loads a ladder for the next power-on, as a download does.
    LoadLadder(Arc<Ladder>),
    /// Drops the stopped run; the next cycle start in AUTO begins the restart.
    Restart(Box<PreparedRestart>),
    /// Switches on or off that the handwheel retraces the path of a held run.
    SetRetrace(bool),
}

/// A value for a tool offset, and how the offset is calculated from it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum OffsetEntry {
    /// X or Z with a value in the unit of the display: stored as the offset, or taken as the
    /// measured coordinate (012.5 DOFSI).
    Length(Axis, f64),
    /// X or Z in mm: stored as the offset, regardless of 012.5 DOFSI.
    Stored(Axis, f64),
    /// U or W with a value in the unit of the display: added to the offset.
    Change(Axis, f64),
    /// U or W without a value: the offset becomes the relative coordinate.
    RelativeCoordinate(Axis),
    /// R: nose radius in the unit of the display.
    NoseRadius(f64),
    /// R: nose radius of the tool offset, mm.
    StoredRadius(f64),
    /// T: number of the imaginary tool nose position, 0–9.
    NoseNumber(u8),
}

impl Cnc {
    /// Executes a request, or raises the alarm that refuses it. Where the manual specifies
    /// no alarm, the refusal is silent; see [`request_refusal`](Self::request_refusal).
    ///
    /// # Errors
    /// The alarm that was raised: 031 or 071 program not found, 060 sequence number not
    /// found, 068, 072, 074 and 110 of the program memory, 030 and 043 of offsets and
    /// parameters, 111 and 115 for variables, and those of the MDI words.
    pub fn request(&mut self, request: ControlRequest) -> Result<(), Alarm> {
        let result = self.execute_request(request);
        if let Err(alarm) = &result {
            self.raise(alarm.clone());
        }
        result
    }

    fn execute_request(&mut self, request: ControlRequest) -> Result<(), Alarm> {
        match request {
            ControlRequest::ZeroRelative(axis) if !self.is_moving() => {
                *self.coordinates.relative_zero.get_mut(axis) = self.relative_base().get(axis);
            }
            ControlRequest::SetMachineZero(axis) => self.set_machine_zero(axis),
            ControlRequest::ClearParts if !self.is_moving() => self.memory.counters.clear_parts(),
            ControlRequest::ClearCuttingTime if !self.is_moving() => {
                self.memory.counters.clear_cutting_time();
            }
            ControlRequest::ZeroRelative(_)
            | ControlRequest::ClearParts
            | ControlRequest::ClearCuttingTime => {}
            ControlRequest::SelectProgram(number) => {
                self.select_program(ProgramId::Stored(number))?;
            }
            ControlRequest::CursorTo(line) => self.move_cursor(line),
            ControlRequest::NotFound { sequence } => return Err(self.search_alarm(sequence)),
            ControlRequest::CreateProgram(number) => self.create_program(number)?,
            ControlRequest::SaveProgramAs(number) => self.save_program_as(number)?,
            ControlRequest::RenameProgram(number) => self.rename_program(number)?,
            ControlRequest::DeleteProgram(number) => self.delete_program(number)?,
            ControlRequest::DeleteAllPrograms => self.delete_all_programs()?,
            ControlRequest::CheckEdit(number) => {
                check_allowed(self.rights().check_program_edit(number))?;
            }
            ControlRequest::CheckSend(number) => {
                check_allowed(self.rights().check_send_program(number))?;
            }
            ControlRequest::CheckReceive(number) => {
                check_allowed(self.rights().check_receive_program(number))?;
            }
            ControlRequest::SetSerialPort(state) => self.serial_port = state,
            ControlRequest::StoreReceived(received) => self.store_received(received)?,
            ControlRequest::StoreEdited { number, program } => {
                self.store_edited(number, program)?;
            }
            ControlRequest::StoreProgram(text) => self.store_program(text)?,
            ControlRequest::OpenExternal(program) => self.open_external(program)?,
            ControlRequest::AddMdiWord(word) => self.add_mdi_word(&word)?,
            ControlRequest::SetVariable { number, value } => self.set_variable(number, value)?,
            ControlRequest::SetMacroVariable { number, value } => {
                self.set_macro_variable(number, value)?;
            }
            ControlRequest::SetPitch { axis, point, value } => {
                self.set_pitch(axis, point, value)?;
            }
            ControlRequest::SetOffset { number, entry } => self.set_offset(number, entry)?,
            ControlRequest::SetParameter { number, value } => self.set_parameter(number, value)?,
            ControlRequest::SetParameterBit { number, bit, on } => {
                self.change_parameters(|parameters| parameters.set_bit(number, bit, on))?;
            }
            ControlRequest::SetModelParameter { number, value } => {
                self.set_model_parameter(number, value)?;
            }
            ControlRequest::SetCoordinate(axis, value) => self.set_coordinate(axis, value),
            ControlRequest::SetSetting(setting, on) => self.set_setting(setting, on),
            ControlRequest::SetParameterSwitch(on) => self.set_parameter_switch(on),
            ControlRequest::SetProgramSwitch(on) => self.set_program_switch(on),
            ControlRequest::CancelSwitchAlarm => self.cancel_switch_alarm(),
            ControlRequest::LoadDisk(disk) => self.load_disk(disk),
            ControlRequest::SaveDisk(disk) => self.save_disk(disk),
            ControlRequest::EnterPassword(password) => {
                self.change_authority(|authority| authority.enter(&password));
            }
            ControlRequest::ChangePassword { old, new } => {
                self.change_authority(|authority| authority.change_password(&old, &new));
            }
            ControlRequest::LowerLevel => self.change_authority(Authority::log_off),
            ControlRequest::ToggleSoftSwitch(switch) => self.plc.toggle_soft_switch(switch),
            ControlRequest::SetTool(tool) => self.set_tool_in_position(tool)?,
            ControlRequest::SetPreset(address, value) => self.set_preset(address, value)?,
            ControlRequest::DropWheel => self.drop_wheel(),
            ControlRequest::SetOutputKey(down) => self.plc.output_key = down,
            ControlRequest::SetSoftSwitch(switch, on) => self.plc.set_soft_switch(switch, on),
            ControlRequest::ForceBit(bit, value) => self.plc.engine.force(bit, value),
            ControlRequest::HaltLadder(halt) => self.plc.halted = halt,
            ControlRequest::StepLadder(step) => self.step_ladder(step),
            ControlRequest::LoadLadder(ladder) => self.load_ladder(ladder),
            ControlRequest::Restart(restart) => self.accept_restart(restart),
            ControlRequest::SetRetrace(on) => self.set_retrace(on),
        }
        Ok(())
    }

    /// Returns the permissions to change data at this moment.
    pub fn rights(&self) -> Rights<'_> {
        Rights {
            parameters: &self.memory.parameters,
            level: self.memory.authority.level(),
            mode: self.run.mode,
            operating: self.run.automatic.is_operating(),
            running: self.run.automatic.state == RunState::Run,
            moving: self.is_moving(),
            alarm: self.is_alarm_active(),
            emergency_stop: self.emergency_stop,
            parameter_switch: self.switches.parameters,
            program_switch: self.switches.programs,
            protected: self.is_memory_protected(),
        }
    }

    /// Presses or releases a key of the machine panel; `contact` is its contact in X20–X27.
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

/// Whether a program operation may proceed; false for a silent refusal. A level that is
/// too low returns its alarm as error.
fn check_allowed(rights: Result<(), WriteRefusal>) -> Result<bool, Alarm> {
    match rights {
        Ok(()) => Ok(true),
        Err(refusal) => refusal.alarm().map_or(Ok(false), Err),
    }
}
