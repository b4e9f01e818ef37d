//! The control: owns the program, the motion and the PLC; one millisecond a tick.

mod ladder;
mod motion;
mod plc;
mod power;
mod request;
mod soft_panel;
mod spindle;
mod tool_post;
mod view;
mod world;

use std::collections::VecDeque;
use std::sync::Arc;

use gsk_plc::{Ladder, Plc};
use serde::{Deserialize, Serialize};

pub use ladder::LadderStep;
use ladder::TIMER_PRESETS;
pub use request::{OffsetEntry, Received, Request, SerialPort};
pub use view::Cursor;
pub(crate) use world::World;

use crate::alarm::Alarm;
use crate::axis::{AxisChain, SoftLimits};
use crate::command::{ExecutedMove, Frame, Source};
use crate::interpreter::{Explanation, Interpreter, Modal};
use crate::machine::{Inputs, Outputs};
use crate::memory::{
    Authority, Counters, Disks, Offsets, Parameters, PitchTable, Settings, Variables,
};
use crate::motion::{Interpolator, JogRate, MotionLimits};
use crate::operation::{
    ActiveAlarms, Automatic, BoardDrives, DriveWatch, FromPlc, Handshake, InputFilter, Mode,
    Return, RunState, Sensors, WheelCounter, X_BYTES,
};
use crate::program::{MdiBlock, ProgramMemory};
use crate::spindle::{SpindleAngle, SpindleControl};
use crate::units::{PerAxis, Point};

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
    /// The part counter counted.
    PartFinished,
    /// A program came to its end; `m30` tells M30 from the end of the text.
    ProgramEnded {
        /// By M30.
        m30: bool,
    },
}

/// The control.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cnc {
    pub(crate) parameters: Parameters,
    pub(crate) offsets: Offsets,
    pub(crate) pitch: PitchTable,
    pub(crate) variables: Variables,
    pub(crate) settings: Settings,
    pub(crate) authority: Authority,
    pub(crate) disks: Disks,
    /// 参数开关.
    pub(crate) parameter_switch: bool,
    /// 程序开关.
    pub(crate) program_switch: bool,
    /// The parameters as they were when the power was switched on.
    at_power_on: Parameters,
    pub(crate) programs: ProgramMemory,
    pub(crate) counters: Counters,
    pub(crate) mdi: MdiBlock,
    pub(crate) interpreter: Interpreter,
    pub(crate) plc: Plc,
    pub(crate) from_plc: FromPlc,
    pub(crate) filter: InputFilter,
    panel_keys: [u8; X_BYTES],
    /// A soft switch on its way.
    turning: Option<soft_panel::Turning>,
    output_key: bool,
    serial_port: SerialPort,
    /// The soft machine panel, as F75 has it.
    pub(crate) soft_switches: u8,
    /// The ladder stands still, for stepping.
    plc_halted: bool,
    /// The ladder that the next power-on loads.
    next_ladder: Option<Arc<Ladder>>,
    pub(crate) plc_message: bool,
    pub(crate) sensors: Sensors,
    pub(crate) drives: DriveWatch,

    pub(crate) mode: Mode,
    pub(crate) automatic: Automatic,
    pub(crate) handshake: Handshake,
    pub(crate) alarms: ActiveAlarms,
    pub(crate) emergency_stop: bool,
    pub(crate) reset_left: u32,
    pub(crate) modal: Modal,
    pub(crate) tool: (u8, u8),
    /// The tool-change key turns the tool post.
    indexing_by_hand: bool,

    pub(crate) interpolator: Interpolator,
    pub(crate) limits: MotionLimits,
    /// The rest of a held block while the axes are moved by hand.
    pub(crate) held: Option<Interpolator>,
    pub(crate) jog_blocked: PerAxis<bool>,
    pub(crate) jog_command: PerAxis<Option<(bool, JogRate)>>,
    /// Axis keys that were down at the last tick.
    pub(crate) axis_keys: PerAxis<bool>,
    pub(crate) wheel: WheelCounter,
    /// Returns to a zero under way.
    pub(crate) returns: PerAxis<Option<Return>>,
    pub(crate) axes: AxisChain,
    pub(crate) soft_limits: SoftLimits,
    /// Real drives behind a pulse board, if they make the motion.
    pub(crate) board: Option<BoardDrives>,
    pub(crate) spindle: SpindleControl,
    pub(crate) angle: SpindleAngle,
    /// Spindle override in force, %; a change waits for the end of a thread.
    spindle_override: u8,
    /// Programmed X minus that of the tip, at the end of the last move.
    pub(crate) programmed_ahead: f64,

    pub(crate) frame: Frame,
    /// Absolute coordinate at which the relative display shows zero.
    pub(crate) relative_zero: Point,
    /// Machine coordinate of the program zero point, once a G50 has run.
    pub(crate) program_zero: Option<Point>,
    pub(crate) referenced: PerAxis<bool>,
    /// Coordinate of the reference point an axis stands at.
    pub(crate) at_reference: PerAxis<Option<f64>>,
    negative: PerAxis<bool>,
    last_rapid: bool,

    pub(crate) cursor_line: u32,
    pub(crate) rewind_at_start: bool,
    pub(crate) ticks: u64,
    y: Vec<u8>,
    /// Explanations of what was read and has not begun yet; `None`: nobody asked.
    #[serde(skip)]
    pub(crate) explanations: Option<VecDeque<Option<Explanation>>>,
    #[serde(skip)]
    pub(crate) events: Vec<Event>,
}

impl Cnc {
    /// One millisecond of the control.
    pub fn tick(&mut self, inputs: &Inputs) -> Outputs {
        let seen;
        let inputs = match self.board.as_ref().and_then(|board| board.spindle.as_ref()) {
            Some(spindle) => {
                seen = self.with_board_spindle(inputs, spindle);
                &seen
            }
            None => inputs,
        };
        self.events.clear();
        self.ticks += 1;
        self.sensors.sense(inputs, &self.parameters);
        self.soft_switch_tick();
        if self.ticks % SAMPLE_TICKS == 1 {
            self.sample_contacts(inputs);
        }
        if self.ticks % SLOT_TICKS == 1 {
            self.plc_slot();
        }
        let masked = self.parameters.emergency_stop_masked();
        let closed = self.filter.accepted()[ESP_BYTE] & ESP_MASK != 0;
        self.watch_reset(closed || masked);
        self.watch_drives(inputs);
        self.automatic_tick();
        self.manual_tick(inputs);
        self.return_tick(inputs);
        self.spindle_tick(inputs);
        self.motion_tick();
        self.watch_travel();
        self.watch_limit_signals();
        self.watch_reference();
        if self.automatic.state == RunState::Run {
            self.counters.count_cutting_ms(1);
        }
        self.outputs()
    }

    fn outputs(&self) -> Outputs {
        Outputs {
            y: core::array::from_fn(|index| self.y.get(index).copied().unwrap_or(0)),
            pulses: self.pulses(),
            spindle_volts: self.spindle.volts(),
            enable: PerAxis::new(!self.emergency_stop, !self.emergency_stop),
        }
    }
}
