//! The control: owns the program run, the motion and the PLC; one tick is 1 ms.

mod automatic;
mod board;
mod dnc;
mod drives;
mod gear_speed;
mod inspection;
mod interpreter_host;
mod ladder;
mod manual;
mod motion;
mod parts;
mod plc;
mod power;
mod request;
mod reset;
mod soft_panel;
mod spindle;
mod tool_post;
mod view;

use gsk_messages::Message;
use serde::{Deserialize, Serialize};

pub use automatic::restart::RestartRoute;
pub use dnc::DncInput;
use dnc::DncLine;
pub(crate) use interpreter_host::ControlHost;
pub use ladder::LadderStep;
use ladder::TIMER_PRESETS;
pub use parts::RunStop;
use parts::{CncRun, Coordinates, DriveUnit, ManualMotion, PlcPort, SpindleUnit, WriteSwitches};
pub use request::{ControlRequest, OffsetEntry, ReceivedData, SerialPort};
pub use view::ProgramCursor;

use crate::alarm::Alarm;
use crate::battery::BatteryMemory;
use crate::command::{ExecutedMove, SourcePosition};
use crate::interpreter::Explanation;
use crate::interpreter::ModalState;
use crate::machine::{MachineInputs, MachineOutputs};
use crate::memory::ControlParameters;
use crate::operation::{ActiveAlarms, RunState, X_BYTES};
use crate::units::PerAxis;

/// Ticks between two samples of the input contacts; the outputs are refreshed as often.
const SAMPLE_TICKS: u64 = 4;
/// Ticks from one slot of the PLC to the next.
pub const SLOT_TICKS: u64 = 8;
/// X0.5, *ESP: closed when no emergency stop is pressed.
const ESP_BYTE: usize = 0;
const ESP_MASK: u8 = 1 << 5;

/// An event of a tick, reported to the caller of [`Cnc::tick`].
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A programmed move was finished or interrupted: its executed part.
    MoveEnded(ExecutedMove),
    /// A block begins: its source position, and the modal state after it.
    BlockStarted(SourcePosition, ModalState),
    /// Explanation of the move that begins; sent only while [`Cnc::set_explaining`] is on.
    Explained(Explanation),
    /// The block at this source position was finished.
    BlockEnded(SourcePosition),
    /// This alarm was raised in the tick.
    AlarmRaised(Alarm),
    /// An action of the operator had no effect or ended early, with the reason; no alarm.
    Advised(Message),
    /// The part counter was increased.
    PartFinished,
    /// A program ended: by M30 or M02, or at the end of its text (both fields false).
    ProgramEnded {
        /// Whether M30 was programmed, or M02 on a model that has it.
        m30: bool,
        /// Whether M02 ended the program; `m30` is then true too.
        m02: bool,
    },
}

/// The simulated control; its whole state can be saved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cnc {
    pub(crate) memory: BatteryMemory,
    pub(crate) switches: WriteSwitches,
    /// Parameter values at the last power-on; some changes act only at the next one.
    at_power_on: ControlParameters,
    pub(crate) plc: PlcPort,
    serial_port: SerialPort,
    /// Serial line that delivers a program while the program runs.
    dnc: DncLine,
    pub(crate) run: CncRun,
    pub(crate) drives: DriveUnit,
    pub(crate) hand: ManualMotion,
    pub(crate) spindle: SpindleUnit,
    pub(crate) coordinates: Coordinates,
    pub(crate) alarms: ActiveAlarms,
    pub(crate) emergency_stop: bool,
    #[serde(rename = "reset_left")]
    pub(crate) reset_left_ms: u32,
    pub(crate) ticks: u64,
    #[serde(skip)]
    pub(crate) events: Vec<Event>,
}

impl Cnc {
    /// Advances the control by one tick (1 ms) with the signals of the machine. Returns the
    /// signals for the machine.
    pub fn tick(&mut self, inputs: &MachineInputs) -> MachineOutputs {
        self.events.clear();
        let pulses_before = self.handle_board_reports(inputs.board.as_deref());
        let with_board;
        let inputs = match self
            .drives
            .board
            .as_ref()
            .and_then(|board| board.spindle.as_ref())
        {
            Some(spindle) => {
                with_board = self.with_board_spindle(inputs, spindle);
                &with_board
            }
            None => inputs,
        };
        self.ticks += 1;
        self.drives.sensors.update(inputs, &self.memory.parameters);
        self.plc.advance_soft_switch();
        if self.ticks % SAMPLE_TICKS == 1 {
            self.sample_contacts(inputs);
        }
        if self.ticks % SLOT_TICKS == 1 {
            self.run_plc_slot();
        }
        let masked = self.memory.parameters.is_emergency_stop_masked();
        let closed = self.plc.filter.accepted()[ESP_BYTE] & ESP_MASK != 0;
        self.check_reset(closed || masked, inputs);
        self.check_drives(inputs);
        self.advance_dnc();
        self.advance_output_timers();
        self.advance_automatic();
        self.advance_manual_motion(inputs);
        self.advance_returns(inputs);
        self.advance_spindle(inputs);
        self.advance_motion();
        self.update_motion_signals();
        self.check_travel();
        self.check_limit_signals();
        self.update_reference_lamps();
        if let Some(pulses) = pulses_before {
            self.check_changed_parameters(pulses);
        }
        if self.run.automatic.state == RunState::Run {
            self.memory.counters.count_cutting_ms(1);
            self.memory.counters.count_started_ms(1);
        }
        self.outputs()
    }

    /// Whether the next tick reads the machine contacts.
    pub(crate) const fn will_sample_contacts(&self) -> bool {
        (self.ticks + 1) % SAMPLE_TICKS == 1
    }

    fn outputs(&self) -> MachineOutputs {
        let mut outputs = MachineOutputs {
            pulses: self.pulses(),
            spindle_volts: self.spindle.control.volts(),
            enable: PerAxis::new(!self.emergency_stop, !self.emergency_stop),
            board: (self.drives.board.is_some()).then(|| Box::new(self.board_orders())),
            ..MachineOutputs::default()
        };
        if let Some(bytes) = self.plc.y.first_chunk() {
            outputs.y = *bytes;
        }
        outputs
    }
}
