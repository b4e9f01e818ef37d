//! Tests of facts of the manual, over a small host.

mod blocks;
mod calls_and_units;
mod compound_threads;
mod corners;
mod cycles;
mod dialect;
mod explanations;
mod hx31;
mod hx31_cycles;
mod macro_b;
mod macro_machine;
mod macros;
mod motion;
mod ncb08;
mod nose_compensation;
mod pecking;
mod preview;
mod profiles;
mod properties;
mod roughing;
mod roughing_properties;
mod runs;
mod spindle_and_tool;
mod threads;

use crate::alarm::Alarm;
use crate::command::{Action, ControlCommand, ProgramId, ThreadStart};
use crate::interpreter::Host;
use crate::interpreter::Interpreter;
use crate::interpreter::InterpreterStep;
use crate::memory::{
    ControlParameters, ControlSettings, Counters, Offsets, Registers, ToolOffset, Variables,
};
use crate::model::{ControlModel, ModelId};
use crate::program::{Program, ProgramMemory};
use crate::units::{Feed, PerAxis, Point};

/// An interpreter with the data of a control that carries out each command at once.
pub(super) struct InterpreterBench {
    pub(super) parameters: ControlParameters,
    pub(super) offsets: Offsets,
    pub(super) variables: Variables,
    pub(super) registers: Registers,
    pub(super) counters: Counters,
    pub(super) settings: ControlSettings,
    pub(super) now_ms: u64,
    pub(super) inputs: u16,
    pub(super) outputs: u64,
    pub(super) programs: ProgramMemory,
    pub(super) machine: Point,
    pub(super) referenced: PerAxis<bool>,
    pub(super) block_skip: bool,
    pub(super) settled: bool,
    pub(super) interpreter: Interpreter,
}

struct BenchHost<'a> {
    parameters: &'a mut ControlParameters,
    offsets: &'a mut Offsets,
    registers: &'a mut Registers,
    counters: &'a mut Counters,
    settings: &'a mut ControlSettings,
    now_ms: u64,
    variables: &'a mut Variables,
    inputs: u16,
    outputs: &'a mut u64,
    programs: &'a ProgramMemory,
    machine: Point,
    referenced: PerAxis<bool>,
    block_skip: bool,
    settled: bool,
}

impl Host for BenchHost<'_> {
    fn offsets_mut(&mut self) -> &mut Offsets {
        self.offsets
    }
    fn registers(&self) -> &Registers {
        self.registers
    }
    fn registers_mut(&mut self) -> &mut Registers {
        self.registers
    }
    fn counters(&self) -> &Counters {
        self.counters
    }
    fn counters_mut(&mut self) -> &mut Counters {
        self.counters
    }
    fn settings(&self) -> &ControlSettings {
        self.settings
    }
    fn settings_mut(&mut self) -> &mut ControlSettings {
        self.settings
    }
    fn now_ms(&self) -> u64 {
        self.now_ms
    }
    fn parameters(&self) -> &ControlParameters {
        self.parameters
    }
    fn parameters_mut(&mut self) -> &mut ControlParameters {
        self.parameters
    }
    fn offsets(&self) -> &Offsets {
        self.offsets
    }
    fn variables(&self) -> &Variables {
        self.variables
    }
    fn variables_mut(&mut self) -> &mut Variables {
        self.variables
    }
    fn interface_inputs(&self) -> u16 {
        self.inputs
    }
    fn interface_outputs(&self) -> u64 {
        *self.outputs
    }
    fn set_interface_outputs(&mut self, outputs: u64) {
        *self.outputs = outputs;
    }
    fn programs(&self) -> &ProgramMemory {
        self.programs
    }
    fn machine_position(&self) -> Point {
        self.machine
    }
    fn referenced(&self) -> PerAxis<bool> {
        self.referenced
    }
    fn is_block_skip_on(&self) -> bool {
        self.block_skip
    }
    fn is_settled(&self) -> bool {
        self.settled
    }
}

impl InterpreterBench {
    /// A bench at X300 Z300 with an analog spindle and offset 01 = X0.040 Z0.020.
    pub(super) fn new() -> Self {
        let mut parameters = ControlParameters::default();
        parameters.set_bit(1, 4, true).unwrap();
        let mut offsets = Offsets::default();
        offsets
            .set(
                1,
                ToolOffset {
                    x: 0.04,
                    z: 0.02,
                    ..ToolOffset::default()
                },
            )
            .unwrap();
        offsets
            .set(
                2,
                ToolOffset {
                    x: 0.06,
                    z: 0.03,
                    ..ToolOffset::default()
                },
            )
            .unwrap();
        let interpreter = Interpreter::new(&parameters);
        Self {
            parameters,
            offsets,
            variables: Variables::default(),
            registers: Registers::default(),
            counters: Counters::default(),
            settings: ControlSettings::default(),
            now_ms: 0,
            inputs: 0,
            outputs: 0,
            programs: ProgramMemory::default(),
            machine: Point::new(150.0, 300.0),
            referenced: PerAxis::new(true, true),
            block_skip: false,
            settled: true,
            interpreter,
        }
    }

    /// A bench with the tool at X `x` (diameter) and Z `z`, mm.
    pub(super) fn at(x: f64, z: f64) -> Self {
        Self {
            machine: Point::new(x / 2.0, z),
            ..Self::new()
        }
    }

    pub(super) fn of_model(mut self, id: ModelId) -> Self {
        self.interpreter.set_model(&ControlModel::new(id));
        self
    }

    pub(super) fn with_bit(mut self, number: u16, bit: u8, value: bool) -> Self {
        self.parameters.set_bit(number, bit, value).unwrap();
        self
    }

    fn split_for_run(&mut self) -> (&mut Interpreter, BenchHost<'_>) {
        let world = BenchHost {
            parameters: &mut self.parameters,
            offsets: &mut self.offsets,
            registers: &mut self.registers,
            counters: &mut self.counters,
            settings: &mut self.settings,
            now_ms: self.now_ms,
            variables: &mut self.variables,
            inputs: self.inputs,
            outputs: &mut self.outputs,
            programs: &self.programs,
            machine: self.machine,
            referenced: self.referenced,
            block_skip: self.block_skip,
            settled: self.settled,
        };
        (&mut self.interpreter, world)
    }

    pub(super) fn open(&mut self, text: &str) {
        self.programs.open_external(Program::new(text));
        let (interpreter, world) = self.split_for_run();
        interpreter.start(ProgramId::External, 1, &world);
    }

    pub(super) fn mdi(&mut self, text: &str) {
        let (interpreter, world) = self.split_for_run();
        interpreter.start_mdi(Program::new(text), &world);
    }

    pub(super) fn next(&mut self) -> Result<InterpreterStep, Alarm> {
        let (interpreter, mut world) = self.split_for_run();
        let step = interpreter.next(&mut world)?;
        if let InterpreterStep::Command(command) = &step
            && let Some(to) = target(&command.action)
        {
            self.machine = to;
        }
        Ok(step)
    }

    pub(super) fn reset(&mut self) {
        let (interpreter, world) = self.split_for_run();
        interpreter.reset(&world);
    }

    /// Returns the remaining commands of the current run, at most 10 000, and the alarm that
    /// ends the run, if any.
    pub(super) fn run_to_end(&mut self) -> (Vec<ControlCommand>, Option<Alarm>) {
        let mut commands = Vec::new();
        while commands.len() < 10_000 {
            match self.next() {
                Ok(InterpreterStep::Command(command)) => commands.push(*command),
                Ok(InterpreterStep::Wait | InterpreterStep::Ended) => return (commands, None),
                Err(alarm) => return (commands, Some(alarm)),
            }
        }
        (commands, None)
    }

    /// Runs a program to its end and returns its commands as short texts, without the action
    /// that precedes thread cycles.
    pub(super) fn trace(&mut self, text: &str) -> Vec<String> {
        self.open(text);
        let (commands, alarm) = self.run_to_end();
        let mut lines: Vec<_> = commands
            .iter()
            .filter(|command| !matches!(command.action, Action::ThreadCycle { .. }))
            .map(|command| self.describe(command))
            .collect();
        if let Some(alarm) = alarm {
            let line = alarm.source.map_or(0, |source| source.line);
            lines.push(format!("alarm {:03} line {line}", alarm.number));
        }
        lines
    }

    /// Runs a program that must end with an alarm; returns the number and the line of that
    /// alarm.
    pub(super) fn run_to_alarm(&mut self, text: &str) -> (u16, u32) {
        self.open(text);
        let (_, alarm) = self.run_to_end();
        let alarm = alarm.unwrap_or_else(|| panic!("no alarm: {text}"));
        assert!(
            alarm.detail.is_some(),
            "alarm {} without a detail",
            alarm.number
        );
        (alarm.number, alarm.source.map_or(0, |source| source.line))
    }

    /// The absolute position that the control shows: X (diameter) and Z, mm.
    pub(super) fn displayed_position(&self) -> (f64, f64) {
        let point = self.interpreter.position();
        (point.diameter().0, point.z)
    }

    /// Formats a command as a short text. Positions are machine coordinates with X as a
    /// diameter; `|` marks a stop of single block.
    fn describe(&self, command: &ControlCommand) -> String {
        let format_point = |point: Point| {
            format!(
                "X{} Z{}",
                format_short(point.x * 2.0),
                format_short(point.z)
            )
        };
        let format_feed = |feed: Feed| match feed {
            Feed::PerMinute(rate) => format!("F{rate}"),
            Feed::PerRevolution(rate) => format!("F{rate}/r"),
        };
        let text = match &command.action {
            Action::Rapid { to } => format!("rapid {}", format_point(*to)),
            Action::Outputs { on, off, ms } => format!("outputs on {on:b} off {off:b} {ms}ms"),
            Action::InputWait { input, high } => format!("wait for X{input} {high}"),
            Action::Line { to, feed } => {
                format!("line {} {}", format_point(*to), format_feed(*feed))
            }
            Action::Arc {
                to,
                center,
                clockwise,
                feed,
            } => {
                let turn = if *clockwise { "cw" } else { "ccw" };
                format!(
                    "{turn} {} about {} {}",
                    format_point(*to),
                    format_point(*center),
                    format_feed(*feed)
                )
            }
            Action::Thread {
                to,
                lead_axis: long,
                lead,
                increase,
                start,
                run_out,
            } => {
                let kind = if *run_out { "run-out" } else { "thread" };
                let begins = match start {
                    ThreadStart::AtIndex { degrees } => format!("at {}", format_short(*degrees)),
                    ThreadStart::Continued => "continued".into(),
                };
                let growth = if *increase == 0.0 {
                    String::new()
                } else {
                    format!(
                        "{}{}",
                        if *increase > 0.0 { "+" } else { "" },
                        format_short(*increase)
                    )
                };
                format!(
                    "{kind} {} {long:?} lead {}{growth} {begins}",
                    format_point(*to),
                    format_short(*lead)
                )
            }
            Action::Tap {
                to,
                lead,
                start_degrees,
            } => format!(
                "tap {} lead {} at {}",
                format_point(*to),
                format_short(*lead),
                format_short(*start_degrees)
            ),
            Action::ThreadCycle { .. } => "thread cycle".into(),
            Action::Dwell { ms } => format!("dwell {ms}"),
            Action::ZeroReturn { x, z } => format!("zero return {x} {z}"),
            Action::Referenced { x, z } => format!("referenced {x} {z}"),
            Action::Frame {
                frame,
                program_zero,
                relative,
            } => format!(
                "frame {} offset {}{}{}",
                format_point(frame.zero),
                format_point(frame.offset),
                if program_zero.is_some() {
                    " program zero"
                } else {
                    ""
                },
                if *relative { " relative" } else { "" }
            ),
            Action::Miscellaneous { code } => format!("M{code:02}"),
            Action::Spindle(speed) => format!("{speed:?}"),
            Action::Tool { tool, offset, .. } => format!("T{tool:02}{offset:02}"),
            Action::ProgramStop => "stop".into(),
            Action::End { counts, m30, .. } => format!("end counts {counts} m30 {m30}"),
            Action::Repeat => "repeat".into(),
            Action::Macro => "macro".into(),
            Action::Nothing => "nothing".into(),
        };
        let stop = if command.stop_point { " |" } else { "" };
        format!("{}: {text}{stop}", command.source.line)
    }
}

fn target(action: &Action) -> Option<Point> {
    match action {
        Action::Rapid { to }
        | Action::Line { to, .. }
        | Action::Arc { to, .. }
        | Action::Thread { to, .. } => Some(*to),
        _ => None,
    }
}

/// Formats a number with at most six decimals, without zeros at the end.
fn format_short(value: f64) -> String {
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".into()
    } else {
        text.into()
    }
}
