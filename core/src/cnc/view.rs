//! Read access to the control for the pages of the panel and the command line.

use std::collections::VecDeque;

use gsk_plc::Plc;

use super::{Cnc, Event};
use crate::alarm::Alarm;
use crate::battery::BatteryMemory;
use crate::command::{Action, Frame, ProgramId, SourcePosition};
use crate::interpreter::ModalState;
use crate::machine::pins;
use crate::memory::{
    Authority, ControlParameters, ControlSettings, Counters, Disks, Offsets, PitchTable, Variables,
};
use crate::model::{ControlModel, GCode};
use crate::motion::JogRate;
use crate::operation::{OperatingMode, RunState, Sensors, ZeroReturnStage, jog_rate};
use crate::program::{MdiBlock, ProgramMemory};
use crate::spindle::SpindleControl;
use crate::units::{Axis, PerAxis, Point, Pulses, TICK_S};
use gsk_link::SpindleDirection;

/// Lag of a pulse board after the control, at the end of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoardLag {
    /// Ticks of motion that the board may not have executed yet.
    pub ticks: u64,
    /// Number of stops after which the control continued from another position. Motion that
    /// was pending at such a stop is never executed.
    pub resync_count: u64,
}

/// The block in execution, or the block at which the next cycle start begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProgramCursor {
    /// The program that contains the block; `None` if the memory is empty.
    pub program: Option<ProgramId>,
    /// Line of the block in its program, from 1.
    pub line: u32,
    /// The last sequence number (N) before or in the block; `None` without one.
    pub sequence: Option<u32>,
}

impl Cnc {
    /// Returns the operating mode that the ladder has selected.
    pub const fn mode(&self) -> OperatingMode {
        self.run.mode
    }

    /// Signals of drives and encoder, for the diagnosis page.
    pub const fn sensors(&self) -> Sensors {
        self.drives.sensors
    }

    /// Analog spindle output SVC, 0 to 10 V.
    pub fn spindle_volts(&self) -> f64 {
        self.spindle.control.volts()
    }

    /// Returns the state of the program run.
    pub const fn run_state(&self) -> RunState {
        self.run.automatic.state
    }

    /// Machine coordinates of the slides (mm, X as a radius).
    pub fn position_machine(&self) -> Point {
        self.slide_position()
    }

    /// Pulse count of each axis: the sum of the pulses commanded since power-on, unless a board has
    /// set the count.
    pub fn pulses(&self) -> PerAxis<Pulses> {
        self.drives.axis_chain.pulses()
    }

    /// Absolute coordinates in the work coordinate system (mm, X as a radius).
    pub fn position_absolute(&self) -> Point {
        self.coordinates.frame.to_program(self.position())
    }

    /// Relative coordinates U, W (mm, X as a radius).
    pub fn position_relative(&self) -> Point {
        self.relative_base() - self.coordinates.relative_zero
    }

    /// Coordinates from which the relative coordinates are counted, mm: the absolute ones,
    /// with the tool offset unless 004.1 PROD = 1.
    pub(crate) fn relative_base(&self) -> Point {
        let absolute = self.position_absolute();
        if self.memory.parameters.is_relative_programmed() {
            absolute
        } else {
            absolute + self.coordinates.frame.offset
        }
    }

    /// Distance to go of the current programmed motion (mm, X as a radius).
    pub fn distance_to_go(&self) -> Point {
        self.drives.interpolator.distance_to_go()
    }

    /// The current coordinate frame: work zero and tool offset.
    pub const fn frame(&self) -> Frame {
        self.coordinates.frame
    }

    /// Whether any axis has speed, in programmed or manual motion.
    pub fn is_moving(&self) -> bool {
        self.drives.interpolator.is_moving() || self.is_waiting_for_motor()
    }

    /// Whether the current motion is a rapid, programmed or manual.
    pub fn is_rapid_under_way(&self) -> bool {
        let is_manual_rapid = |axis| {
            matches!(
                self.hand.jog.get(axis),
                Some((_, JogRate::Rapid | JogRate::Approach(_)))
            ) || *self.coordinates.returns.get(axis) == Some(ZeroReturnStage::Straight)
        };
        match self.run.automatic.current_action() {
            Some(Action::Rapid { .. } | Action::ZeroReturn { .. }) => true,
            Some(_) if self.run.held_motion.is_none() => false,
            _ => is_manual_rapid(Axis::X) || is_manual_rapid(Axis::Z),
        }
    }

    /// Whether the current motion is a thread that follows the spindle angle.
    pub const fn is_in_thread(&self) -> bool {
        self.drives.interpolator.is_in_thread()
    }

    /// The current F word: mm/min with G98, mm per revolution with G99.
    pub const fn feed_commanded(&self) -> f64 {
        self.run.modal.feed
    }

    /// The current thread lead, mm; 0 until a thread is programmed.
    pub const fn thread_lead(&self) -> f64 {
        self.run.interpreter.thread_lead()
    }

    /// Speed of the axes along the path, mm/min.
    pub fn feed_actual(&self) -> f64 {
        self.drives.interpolator.velocity().length() * 60.0
    }

    /// Jog rate of the current override step, mm/min.
    pub fn jog_rate(&self) -> f64 {
        jog_rate(self.plc.signals.jog_code)
    }

    /// Feed override that the ladder commands, 0–150 %.
    pub const fn feed_override(&self) -> u8 {
        self.plc.signals.feed_override
    }

    /// Rapid override: 25, 50, 100 %, or 0 for F0.
    pub const fn rapid_override(&self) -> u8 {
        self.plc.signals.rapid_override
    }

    /// Spindle override that the ladder commands, 50–120 %.
    pub const fn spindle_override(&self) -> u8 {
        self.plc.signals.spindle_override
    }

    /// Spindle speed for the S display (manual III-2.1.1), r/min: the measured speed, also
    /// at standstill. `None` without an encoder.
    pub fn spindle_measured(&self) -> Option<f64> {
        let has_encoder = self.spindle.control.has_encoder();
        has_encoder.then(|| self.spindle.control.actual_rpm())
    }

    /// Measured spindle speed, r/min; 0 without an encoder.
    pub fn spindle_actual(&self) -> f64 {
        self.spindle.control.actual_rpm()
    }

    /// Commanded spindle speed, r/min, after override and limits.
    pub fn spindle_commanded(&self) -> f64 {
        self.spindle.control.commanded_rpm()
    }

    /// Commanded spindle speed with its direction, r/min: 0 after M05, negative in reverse.
    pub fn spindle_switched(&self) -> f64 {
        match pins::spindle_direction(self.plc.engine.memory()) {
            SpindleDirection::Stop => 0.0,
            SpindleDirection::Forward => self.spindle_commanded(),
            SpindleDirection::Reverse => -self.spindle_commanded(),
        }
    }

    /// The M code of the direction that the ladder has switched: 3, 4, or 5 for none.
    pub fn spindle_m_code(&self) -> u8 {
        match pins::spindle_direction(self.plc.engine.memory()) {
            SpindleDirection::Stop => 5,
            SpindleDirection::Forward => 3,
            SpindleDirection::Reverse => 4,
        }
    }

    /// The state of the spindle in the control: speeds, gear, limits.
    pub const fn spindle(&self) -> &SpindleControl {
        &self.spindle.control
    }

    /// Tool number and offset number on the T display.
    pub const fn tool(&self) -> (u8, u8) {
        self.run.tool
    }

    /// Returns the modal state of the block that is being executed.
    pub const fn modal(&self) -> &ModalState {
        &self.run.modal
    }

    /// Part counter, cutting time and the other counters.
    pub const fn counters(&self) -> Counters {
        self.memory.counters
    }

    /// Stored parameter values; some of them act only after the next power-on.
    pub const fn parameters(&self) -> &ControlParameters {
        &self.memory.parameters
    }

    /// Returns the control model with its model-specific parameters.
    pub const fn model(&self) -> &ControlModel {
        &self.memory.model
    }

    /// Returns the pitch error tables of both axes.
    pub const fn pitch(&self) -> &PitchTable {
        &self.memory.pitch
    }

    /// The memory that the battery would keep at a power-off now.
    pub fn battery_memory(&self) -> BatteryMemory {
        BatteryMemory {
            programs: self.memory.programs.retained(),
            ..self.memory.clone()
        }
    }

    /// Returns all tool offsets.
    pub const fn offsets(&self) -> &Offsets {
        &self.memory.offsets
    }

    /// Macro variables: the common ones and the real ones.
    pub const fn variables(&self) -> &Variables {
        &self.memory.variables
    }

    /// Remaining time of a dwell, s; `None` without a dwell, and on models whose overall
    /// page does not show it (all but the NC-B08).
    pub fn displayed_dwell_s(&self) -> Option<f64> {
        let is_displayed = self.memory.model.record().g_code(4) == Some(GCode::DwellSecondsFirst);
        let left = f64::from(self.run.automatic.dwell_left_ms) * TICK_S;
        (is_displayed && self.run.automatic.is_dwelling()).then_some(left)
    }

    /// Numbers of the variables that the variable page lists.
    pub fn variable_numbers(&self) -> Vec<u16> {
        if self.memory.model.record().own_variables {
            Variables::numbers_of_huaxing().collect()
        } else if self.memory.settings.macro_b {
            Variables::numbers_of_macro_b().collect()
        } else {
            Variables::numbers().collect()
        }
    }

    /// Whether the variable page lists real numbers: with macro B and on the Huaxing
    /// lathes.
    pub fn are_variables_real(&self) -> bool {
        self.memory.settings.macro_b || self.memory.model.record().own_variables
    }

    /// Value of the real variable with this number; `None` if the variable is null.
    pub fn real_variable(&self, number: u16) -> Option<f64> {
        let variables = &self.memory.variables;
        if self.memory.model.record().own_variables {
            return variables.huaxing_value(number);
        }
        match u8::try_from(number) {
            Ok(local @ 1..=33) => self.run.interpreter.local_variable(local),
            _ => variables.real_value(number),
        }
    }

    /// Whether programs are in inches (英制编程 of the setting page).
    pub const fn is_inch_input(&self) -> bool {
        self.memory.settings.inch
    }

    /// States of the rows of the setting page.
    pub const fn settings(&self) -> ControlSettings {
        self.memory.settings
    }

    /// Returns operation level and passwords.
    pub const fn authority(&self) -> &Authority {
        &self.memory.authority
    }

    /// The electronic disks that hold sets of parameter values.
    pub const fn disks(&self) -> &Disks {
        &self.memory.disks
    }

    /// Whether 参数开关 (parameter switch) is on.
    pub const fn is_parameter_switch_on(&self) -> bool {
        self.switches.parameters
    }

    /// Whether 程序开关 (program switch) is on.
    pub const fn is_program_switch_on(&self) -> bool {
        self.switches.programs
    }

    /// KEY1, G46.3: whether the ladder forbids changes of programs, offsets and parameters.
    pub const fn is_memory_protected(&self) -> bool {
        self.plc.signals.memory_protect
    }

    /// SBK, G46.1: whether the program stops after each block.
    pub const fn is_single_block_on(&self) -> bool {
        self.plc.signals.single_block
    }

    /// DRN, G46.7: whether the program runs at the feeds of a dry run.
    pub const fn is_dry_run_on(&self) -> bool {
        self.plc.signals.dry_run
    }

    /// Program memory with the stored programs and the external one.
    pub const fn programs(&self) -> &ProgramMemory {
        &self.memory.programs
    }

    /// The block keyed in on the MDI page.
    pub const fn mdi_block(&self) -> &MdiBlock {
        &self.run.mdi
    }

    /// The block in execution, or the block at which the next cycle start begins.
    pub fn cursor(&self) -> ProgramCursor {
        let running = self.run.automatic.state != RunState::Reset;
        let suspended = self.run.automatic.suspended_source();
        let last = suspended
            .or(self.run.automatic.last_source)
            .filter(|_| running);
        match last {
            Some(SourcePosition {
                program,
                line,
                sequence,
            }) => ProgramCursor {
                program: Some(program),
                line,
                sequence: sequence.map(u32::from),
            },
            None => ProgramCursor {
                program: self.memory.programs.selected(),
                line: self.run.cursor_line,
                sequence: None,
            },
        }
    }

    /// Returns the active alarms, the newest first.
    pub fn alarms(&self) -> &[Alarm] {
        self.alarms.list()
    }

    /// Active messages of the machine's ladder, each with number and text.
    pub fn plc_messages(&self) -> impl Iterator<Item = (u16, &str)> {
        self.plc.engine.active_messages()
    }

    /// The first active message of the ladder, as an alarm with the block that it interrupts;
    /// `None` without one. Cycle start has no effect until the cause of the message is gone and
    /// RESET has cleared it.
    pub fn active_message(&self) -> Option<Alarm> {
        if !self.plc.message {
            return None;
        }
        let (number, text) = self.plc_messages().next()?;
        let message = Alarm::from_ladder_message(number, text);
        let running = self.run.automatic.state != RunState::Reset;
        let block = self.run.automatic.last_source.filter(|_| running);
        Some(match block {
            Some(block) => message.with_source(block),
            None => message,
        })
    }

    /// Whether the status line shows 准备未绪 (not ready).
    pub fn is_shown_not_ready(&self) -> bool {
        self.is_not_ready() || self.is_position_unknown()
    }

    /// Whether the position of real slides is unknown, so that they need a reference
    /// return.
    pub fn is_position_unknown(&self) -> bool {
        self.drives.board.is_some_and(|board| !board.position_known)
    }

    /// Whether a pulse board makes the motion. The slides of the simulated lathe are then
    /// not the real ones.
    pub const fn has_board(&self) -> bool {
        self.drives.board.is_some()
    }

    /// Lag of the pulse board after this tick; `None` without a board: the simulated lathe makes
    /// the motion at once.
    pub fn board_lag(&self) -> Option<BoardLag> {
        self.drives.board.map(|board| BoardLag {
            ticks: board.ticks_ahead,
            resync_count: board.resync_count,
        })
    }

    /// Speed of the spindle whose one-turn signal the board measures, r/min; negative in reverse.
    /// `None` without such a spindle.
    pub fn board_spindle_rpm(&self) -> Option<f64> {
        Some(self.drives.board?.spindle?.rpm)
    }

    /// Whether an alarm or a ladder message is active (signal AL, F1.0).
    pub fn is_in_alarm(&self) -> bool {
        self.is_alarm_active()
    }

    /// Whether the status line shows 暂停 (hold): in feed hold, with *SP open, or after a
    /// stop of single block between two moves of one block.
    pub fn is_in_feed_hold(&self) -> bool {
        self.run.automatic.state == RunState::Hold
            || self.run.automatic.is_stopped_within_block()
            || self.plc.signals.feed_hold
    }

    /// Whether the reference point of each axis is established.
    pub const fn referenced_axes(&self) -> PerAxis<bool> {
        self.coordinates.referenced
    }

    /// The PLC with its ladder, signals, timers and messages.
    pub const fn plc(&self) -> &Plc {
        &self.plc.engine
    }

    /// Returns the events of the last tick, in order.
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// Switches the explanations of cycle passes ([`Event::Explained`]); off at power-on.
    pub fn set_explaining(&mut self, on: bool) {
        self.run.explanations = on.then(VecDeque::new);
    }

    /// The control's date as YYYYMMDD and time of day as hhmmss.
    pub fn date_and_time(&self) -> (u32, u32) {
        let registers = &self.run.registers;
        (
            registers.date(self.ticks),
            registers.time_of_day(self.ticks),
        )
    }

    /// Returns the number of ticks of 1 ms since power-on.
    pub const fn ticks(&self) -> u64 {
        self.ticks
    }
}
