//! The inputs of an emulator: every change from outside is one value of [`EmulatorInput`], and
//! [`Emulator::apply`] is the only function that makes one. What is applied can therefore be
//! recorded and applied again.

use gsk_core::alarm::Alarm;
use gsk_core::cnc::{ControlRequest, DncInput};
use gsk_core::machine::LatheFault;
use gsk_core::operation::RunState;
use gsk_core::plc::address::BitAddress;
use gsk_core::units::Point;
use gsk_messages::Message;
use serde::{Deserialize, Serialize};

use super::Emulator;
use super::serial::PortRequest;
use crate::pages::{Communication, PageId, UdiskFile};
use crate::panel::limits::PanelLimits;
use crate::panel::{FileRefusal, KeyEvent, PanelRetained, ReceiveError, SerialCable, SerialFile};

/// A change of an [`Emulator`] from outside. It acts between two ticks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum EmulatorInput {
    /// A key event: a key, a typed character or the handwheel.
    Key(KeyEvent),
    /// A request to the control without a key, for example of a view of the window.
    Request(Box<ControlRequest>),
    /// Switches the power off.
    PowerOff,
    /// Switches the power on, if it is off.
    PowerOn,
    /// Sets or clears a fault of the lathe.
    Fault(LatheFault, bool),
    /// Clears all faults of the lathe and all forced inputs.
    ClearFaults,
    /// Forces an input of the lathe to a state; `None` releases it.
    ForceInput(BitAddress, Option<bool>),
    /// Connects another device to the cable of the control's serial port.
    ConnectCable(SerialCable),
    /// Passes a file to the control, as the partner at the serial port sends it.
    Receive(SerialFile),
    /// The partner could not receive the files of the last transfer.
    TransferFailed,
    /// A client at a port of the computer reads or changes the files in memory.
    Port(PortRequest),
    /// The state of the port of the computer, which the LCD shows.
    PortState(Communication),
    /// Removes and returns the files that the simulated partner has received.
    TakeSent,
    /// Takes the files that 输出 sends through a port of the computer.
    TakePortFiles,
    /// Takes the report that 复位 has aborted a transfer through a port of the computer.
    TakeAborted,
    /// An event of the device that sends programs in DNC operation.
    Dnc(DncInput),
    /// Sets the graphic page to these extents, mm with X as a radius, and starts drawing.
    FitGraphic {
        /// Least X and Z of the range to show, mm.
        min: Point,
        /// Greatest X and Z of the range to show, mm.
        max: Point,
    },
    /// Shows a page of the LCD without pressing keys, and ends the self-test.
    ShowPage(PageId),
    /// Restores the panel's settings that survive power-off.
    RestorePanel(PanelRetained),
    /// Stores the program text that is open in the editor.
    StoreEdited,
    /// Places the slides of the simulated lathe, which must stand still while no program runs, at
    /// this position: machine coordinates, mm, X as a radius. The control knows it.
    PlaceSlides(Point),
    /// Plugs a U disk with these files into the control; `None` pulls it out.
    PlugUdisk(Option<Vec<UdiskFile>>),
    /// Takes the files that the control has stored on the U disk.
    TakeUdiskFiles,
    /// Sets the keys and pages that an exercise refuses.
    LimitPanel(PanelLimits),
}

/// The result of applying an [`EmulatorInput`].
#[derive(Clone, Debug, PartialEq)]
pub enum InputAnswer {
    /// The input was applied, or has no effect in the current state.
    Applied,
    /// The key has no effect, for the reason in the message.
    KeyRefused(Message),
    /// The control refused the request with this alarm.
    Alarm(Box<Alarm>),
    /// The control does not receive the file of the partner, for this reason.
    NotReceived(ReceiveError),
    /// The control refused the request of a client at the port.
    FileRefused(FileRefusal),
    /// The files that the request has returned.
    Files(Vec<SerialFile>),
    /// Files that the control has stored on the U disk.
    UdiskFiles(Vec<UdiskFile>),
    /// Number of characters that the DNC line has accepted.
    Accepted(usize),
}

/// An input with the tick of [`Emulator::ticks`] before which it was applied.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StampedInput {
    /// Number of ticks of the emulator at the time of the input.
    pub tick: u64,
    /// The input that was applied.
    pub input: EmulatorInput,
}

/// The inputs applied since they were last taken. A copy of an emulator records nothing, and
/// two emulators with different records are equal: the record is no state of the machine.
#[derive(Debug, Default)]
pub(super) struct InputRecord {
    is_on: bool,
    inputs: Vec<StampedInput>,
}

impl Clone for InputRecord {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl PartialEq for InputRecord {
    fn eq(&self, _other: &Self) -> bool {
        true
    }
}

impl Emulator {
    /// Applies an input, which acts in the next tick. Every change of the emulator from outside
    /// passes here, except the exchange with a pulse board
    /// ([`Self::board_simulation`]).
    pub fn apply(&mut self, input: EmulatorInput) -> InputAnswer {
        if self.record.is_on {
            self.record.inputs.push(StampedInput {
                tick: self.ticks(),
                input: input.clone(),
            });
        }
        match input {
            EmulatorInput::Key(event) => self
                .apply_key(event)
                .map_or(InputAnswer::Applied, InputAnswer::KeyRefused),
            EmulatorInput::Request(request) => match self.simulation.cnc.request(*request) {
                Ok(()) => InputAnswer::Applied,
                Err(alarm) => InputAnswer::Alarm(Box::new(alarm)),
            },
            EmulatorInput::PowerOff => self.switch_off(),
            EmulatorInput::PowerOn => self.switch_on(),
            EmulatorInput::Fault(fault, on) => {
                self.simulation.lathe.set_fault(fault, on);
                InputAnswer::Applied
            }
            EmulatorInput::ClearFaults => {
                self.simulation.lathe.clear_faults();
                InputAnswer::Applied
            }
            EmulatorInput::ForceInput(address, state) => {
                self.simulation.lathe.force_input(address, state);
                InputAnswer::Applied
            }
            EmulatorInput::PlaceSlides(position) => {
                let cnc = &self.simulation.cnc;
                if cnc.run_state() == RunState::Reset && !cnc.is_moving() {
                    self.simulation.place_slides(position);
                }
                InputAnswer::Applied
            }
            EmulatorInput::Receive(file) => match self.begin_reception(file) {
                Ok(()) => InputAnswer::Applied,
                Err(refused) => InputAnswer::NotReceived(refused),
            },
            EmulatorInput::Port(request) => match self.execute_port_request(request) {
                Ok(files) => InputAnswer::Files(Vec::from_iter(files)),
                Err(refused) => InputAnswer::FileRefused(refused),
            },
            EmulatorInput::Dnc(input) => {
                InputAnswer::Accepted(self.simulation.cnc.apply_dnc(input))
            }
            EmulatorInput::TakeUdiskFiles => InputAnswer::UdiskFiles(self.panel.take_udisk_files()),
            EmulatorInput::TakeSent => InputAnswer::Files(self.panel.take_sent()),
            EmulatorInput::TakePortFiles => InputAnswer::Files(self.panel.take_port_files()),
            EmulatorInput::TakeAborted => {
                self.panel.clear_aborted();
                InputAnswer::Applied
            }
            to_panel => self.apply_to_panel(&to_panel),
        }
    }

    /// Applies an input that concerns the panel alone.
    fn apply_to_panel(&mut self, input: &EmulatorInput) -> InputAnswer {
        match input {
            EmulatorInput::ConnectCable(cable) => self.panel.connect_cable(*cable),
            EmulatorInput::TransferFailed => self.panel.transfer_failed(),
            EmulatorInput::PortState(shown) => {
                let mut requests = Vec::new();
                self.panel.show_port_state(*shown, &mut requests);
                self.send_requests(requests);
            }
            EmulatorInput::FitGraphic { min, max } => {
                self.panel.fit_graphic(*min, *max, &self.simulation.cnc);
            }
            EmulatorInput::ShowPage(page) => self.panel.show(*page, &self.simulation.cnc),
            EmulatorInput::RestorePanel(retained) => self.panel.restore(retained),
            EmulatorInput::StoreEdited => self.store_edited_text(),
            EmulatorInput::PlugUdisk(files) => self.panel.plug_udisk(files.clone()),
            EmulatorInput::LimitPanel(limits) => self.panel.set_limits(limits.clone()),
            _ => {}
        }
        InputAnswer::Applied
    }

    /// Starts to record the applied inputs; [`Self::take_inputs`] returns them.
    pub fn record_inputs(&mut self) {
        self.record.is_on = true;
    }

    /// Takes the inputs that were recorded since the last call, in the order of application.
    pub fn take_inputs(&mut self) -> Vec<StampedInput> {
        core::mem::take(&mut self.record.inputs)
    }

    /// Sends a request to the control without a key.
    ///
    /// # Errors
    ///
    /// Returns the alarm with which the control refuses the request.
    pub fn request(&mut self, request: ControlRequest) -> Result<(), Alarm> {
        match self.apply(EmulatorInput::Request(Box::new(request))) {
            InputAnswer::Alarm(alarm) => Err(*alarm),
            _ => Ok(()),
        }
    }

    /// Sets (`true`) or clears a fault of the lathe.
    pub fn set_fault(&mut self, fault: LatheFault, on: bool) {
        self.apply(EmulatorInput::Fault(fault, on));
    }

    /// Forces an input of the lathe to a state; `None` releases it.
    pub fn force_input(&mut self, address: BitAddress, state: Option<bool>) {
        self.apply(EmulatorInput::ForceInput(address, state));
    }

    /// Connects another device to the control's serial port.
    pub fn connect_cable(&mut self, cable: SerialCable) {
        self.apply(EmulatorInput::ConnectCable(cable));
    }

    /// Shows a page immediately without keys, for pictures of single pages. Ends the
    /// self-test.
    pub fn show_page(&mut self, page: PageId) {
        self.apply(EmulatorInput::ShowPage(page));
    }

    /// Restores the panel's settings that survive power-off.
    pub fn restore_panel(&mut self, retained: &PanelRetained) {
        self.apply(EmulatorInput::RestorePanel(*retained));
    }

    /// Removes and returns the files that the simulated partner has received.
    pub fn take_sent(&mut self) -> Vec<SerialFile> {
        if !self.panel.has_sent() {
            return Vec::new();
        }
        self.take_files(EmulatorInput::TakeSent)
    }

    /// Sets the keys and pages that an exercise refuses.
    pub fn limit_panel(&mut self, limits: &PanelLimits) {
        self.apply(EmulatorInput::LimitPanel(limits.clone()));
    }

    /// Plugs a U disk with these files into the control; `None` pulls it out.
    pub fn plug_udisk(&mut self, files: Option<Vec<UdiskFile>>) {
        self.apply(EmulatorInput::PlugUdisk(files));
    }

    /// Adds a file to the plugged U disk. Plugs one if there is none.
    pub fn add_udisk_file(&mut self, file: UdiskFile) {
        let disk = self.panel.view().udisk.as_ref();
        let mut files = disk.map_or_else(Vec::new, |disk| disk.files.clone());
        files.retain(|other| other.name != file.name);
        files.push(file);
        self.plug_udisk(Some(files));
    }

    /// Takes the files that the control has stored on the U disk since the last call.
    pub fn take_udisk_files(&mut self) -> Vec<UdiskFile> {
        if !self.panel.has_udisk_files() {
            return Vec::new();
        }
        match self.apply(EmulatorInput::TakeUdiskFiles) {
            InputAnswer::UdiskFiles(files) => files,
            _ => Vec::new(),
        }
    }

    /// Takes the files that 输出 sends, for the port of the computer.
    pub fn take_port_files(&mut self) -> Vec<SerialFile> {
        if !self.panel.has_port_files() {
            return Vec::new();
        }
        self.take_files(EmulatorInput::TakePortFiles)
    }

    /// Returns whether 复位 has aborted a transfer through the computer's port since the last
    /// call.
    pub fn take_aborted(&mut self) -> bool {
        let is_aborted = self.panel.is_aborted();
        if is_aborted {
            self.apply(EmulatorInput::TakeAborted);
        }
        is_aborted
    }

    fn take_files(&mut self, input: EmulatorInput) -> Vec<SerialFile> {
        match self.apply(input) {
            InputAnswer::Files(files) => files,
            _ => Vec::new(),
        }
    }
}
