//! The control: owns the program, the motion and the PLC; one millisecond a tick.

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

/// Contacts are sampled, and outputs refreshed, every so many ticks.
const SAMPLE_TICKS: u64 = 4;
/// The PLC has its slot every so many ticks.
const SLOT_TICKS: u64 = 8;
/// X0.5, *ESP: closed when all is well.
const ESP_BYTE: usize = 0;
const ESP_MASK: u8 = 1 << 5;

/// What happened during a tick.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A piece of motion was finished or broken off.
    Moved(ExecutedMove),
    /// A block begins, with the modal state it leaves.
    BlockBegan(Source, Modal),
    /// Why the move that begins is where it is; only while the control explains.
    Explained(Explanation),
    /// A block was finished.
    BlockEnded(Source),
    /// An alarm came up.
    AlarmRaised(Alarm),
    /// What the operator did has not come to its end, and why; no alarm.
    Advised(Message),
    /// The part counter counted.
    PartFinished,
    /// A program came to its end; `m30` tells M30 from the end of the text.
    ProgramEnded {
        /// By M30 or M02.
        m30: bool,
        /// By M02.
        m02: bool,
    },
}

/// The control.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cnc {
    pub(crate) memory: Memory,
    pub(crate) switches: Switches,
    /// The parameters as they were when the power was switched on.
    at_power_on: Parameters,
    pub(crate) plc: PlcPort,
    serial_port: SerialPort,
    /// The line that a program comes in through while it runs.
    dnc: DncLine,
    pub(crate) run: Run,
    pub(crate) drives: Drives,
    pub(crate) hand: HandMotion,
    pub(crate) spindle: SpindleUnit,
    pub(crate) coordinates: Coordinates,
    pub(crate) alarms: ActiveAlarms,
    pub(crate) emergency_stop: bool,
    pub(crate) reset_left: u32,
    pub(crate) ticks: u64,
    #[serde(skip)]
    pub(crate) events: Vec<Event>,
}

impl Cnc {
    /// One millisecond of the control.
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

    /// Whether the next tick looks at the contacts.
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
