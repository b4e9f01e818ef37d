//! The control: owns the program run, the motion and the PLC; one tick is 1 ms.

mod automatic;
mod board;
mod dnc;
mod drives;
mod gear_speed;
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
mod world;

use gsk_messages::Message;
use serde::{Deserialize, Serialize};

use dnc::DncLine;
pub use ladder::LadderStep;
use ladder::TIMER_PRESETS;
use parts::{Coordinates, Drives, HandMotion, PlcPort, Run, SpindleUnit, Switches};
pub use request::{OffsetEntry, Received, Request, SerialPort};
pub use view::Cursor;
pub(crate) use world::World;

use crate::alarm::Alarm;
use crate::battery::Memory;
use crate::command::{ExecutedMove, Source};
use crate::interpreter::Explanation;
use crate::interpreter::Modal;
use crate::machine::{Inputs, Outputs};
use crate::memory::Parameters;
use crate::operation::{ActiveAlarms, RunState, X_BYTES};
use crate::units::PerAxis;

/// Ticks between two samples of the contacts and refreshes of the outputs.
const SAMPLE_TICKS: u64 = 4;
/// Ticks from one slot of the PLC to the next.
const SLOT_TICKS: u64 = 8;
/// X0.5, *ESP: closed when no emergency stop is pressed.
const ESP_BYTE: usize = 0;
const ESP_MASK: u8 = 1 << 5;

/// Something that happened during a tick.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A move was finished or interrupted.
    Moved(ExecutedMove),
    /// A block begins, with its modal state.
    BlockBegan(Source, Modal),
    /// Explanation of the move that begins; sent only while [`Cnc::explain`] is on.
    Explained(Explanation),
    /// A block was finished.
    BlockEnded(Source),
    /// An alarm was raised.
    AlarmRaised(Alarm),
    /// An action of the operator had no effect or ended early, with the reason; no alarm.
    Advised(Message),
    /// The part counter counted a part.
    PartFinished,
    /// A program ended; `m30` distinguishes M30 from the end of the text.
    ProgramEnded {
        /// Whether M30 or M02 ended it.
        m30: bool,
        /// Whether M02 ended it.
        m02: bool,
    },
}

/// The control with all its state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cnc {
    pub(crate) memory: Memory,
    pub(crate) switches: Switches,
    /// Parameter values at power-on.
    at_power_on: Parameters,
    pub(crate) plc: PlcPort,
    serial_port: SerialPort,
    /// Serial line that delivers a program while it runs.
    dnc: DncLine,
    pub(crate) run: Run,
    pub(crate) drives: Drives,
    pub(crate) hand: HandMotion,
    pub(crate) spindle: SpindleUnit,
    pub(crate) coordinates: Coordinates,
    pub(crate) alarms: ActiveAlarms,
    pub(crate) emergency_stop: bool,
    #[serde(rename = "reset_left")]
    pub(crate) reset_left: u32,
    pub(crate) ticks: u64,
    #[serde(skip)]
    pub(crate) events: Vec<Event>,
}

impl Cnc {
    /// Advances the control by one tick (1 ms).
    pub fn tick(&mut self, inputs: &Inputs) -> Outputs {
        self.events.clear();
        let stood_at = self.hear_board(inputs.board.as_deref());
        let seen;
        let inputs = match self
            .drives
            .board
            .as_ref()
            .and_then(|board| board.spindle.as_ref())
        {
            Some(spindle) => {
                seen = self.with_board_spindle(inputs, spindle);
                &seen
            }
            None => inputs,
        };
        self.ticks += 1;
        self.drives.sensors.sense(inputs, &self.memory.parameters);
        self.plc.soft_switch_tick();
        if self.ticks % SAMPLE_TICKS == 1 {
            self.sample_contacts(inputs);
        }
        if self.ticks % SLOT_TICKS == 1 {
            self.plc_slot();
        }
        let masked = self.memory.parameters.emergency_stop_masked();
        let closed = self.plc.filter.accepted()[ESP_BYTE] & ESP_MASK != 0;
        self.watch_reset(closed || masked, inputs);
        self.watch_drives(inputs);
        self.dnc_tick();
        self.output_tick();
        self.automatic_tick();
        self.manual_tick(inputs);
        self.return_tick(inputs);
        self.spindle_tick(inputs);
        self.motion_tick();
        self.note_motion();
        self.watch_travel();
        self.watch_limit_signals();
        self.watch_reference();
        if let Some(pulses) = stood_at {
            self.check_outgrown(pulses);
        }
        if self.run.automatic.state == RunState::Run {
            self.memory.counters.count_cutting_ms(1);
            self.memory.counters.count_started_ms(1);
        }
        self.outputs()
    }

    /// Whether the next tick samples the contacts.
    pub(crate) const fn samples_contacts_next(&self) -> bool {
        (self.ticks + 1) % SAMPLE_TICKS == 1
    }

    fn outputs(&self) -> Outputs {
        let mut outputs = Outputs {
            pulses: self.pulses(),
            spindle_volts: self.spindle.control.volts(),
            enable: PerAxis::new(!self.emergency_stop, !self.emergency_stop),
            board: (self.drives.board.is_some()).then(|| Box::new(self.board_orders())),
            ..Outputs::default()
        };
        if let Some(bytes) = self.plc.y.first_chunk() {
            outputs.y = *bytes;
        }
        outputs
    }
}
