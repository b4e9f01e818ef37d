//! Executes programs on both paths, with results as the command line writes them.

use gsk_core::command::{ExecutedMove, ProgramId};
use gsk_core::interpreter::{Explanation, ModalState};
use gsk_core::json_line::JsonLine;
use gsk_core::program::ProgramMemory;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_messages::Message;
use gsk_milling::MillSetup;
use gsk_runner::execution::{self, ExecutionLimits, ExecutionWatcher, WatcherStop};
use gsk_runner::move_output;
use gsk_runner::report::{self, AlarmReport, ProgramReport};
use serde_json::{Value, json};

/// Limits of a kernel run: one part, within half an hour of machine time.
const RUN_LIMITS: ExecutionLimits = ExecutionLimits {
    parts: 1,
    time_ms: 1_800_000,
};
/// Number of blocks without motion after which a preview is cancelled.
const MOTIONLESS_BLOCKS: u64 = 1_500_000;

/// The moves and the report of a program that was executed on one path.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PathResult {
    /// The moves in the order of execution, as JSON objects.
    pub moves: Vec<Value>,
    /// The report as a JSON object, without the fields that the path does not compute.
    pub result: Value,
}

impl PathResult {
    /// Parses moves and report as they are written to files.
    fn parse(moves: &[u8], report: &ProgramReport) -> Self {
        let lines = moves.split(|byte| *byte == b'\n');
        let lines = lines.filter(|line| !line.is_empty());
        let written = report.to_json().unwrap_or_default();
        let mut result: Value = serde_json::from_str(&written).unwrap_or_default();
        if let Some(alarm) = &report.alarm {
            result["alarm"]["n"] = json!(alarm.sequence);
            result["alarm"]["program"] = json!(alarm.program.map(program_name));
        }
        if let Some(path) = &report.path {
            let pair = |alarm: &AlarmReport| json!([alarm.number, alarm.line]);
            result["more_alarms"] = path.more_alarms.iter().map(pair).collect();
        }
        if report.warnings.is_empty() {
            result["warnings"] = json!([]);
        }
        Self {
            moves: lines
                .map(|line| serde_json::from_slice(line).unwrap_or_default())
                .collect(),
            result,
        }
    }
}

fn program_name(program: ProgramId) -> String {
    match program {
        ProgramId::Stored(number) => format!("O{number:04}"),
        ProgramId::External => "external".to_owned(),
        ProgramId::Mdi => "MDI".to_owned(),
        ProgramId::Dnc => "DNC".to_owned(),
    }
}

/// Collects the moves as the lines that the command line writes.
#[derive(Default)]
struct MoveWriter {
    written: Vec<u8>,
    line: JsonLine,
}

impl MoveWriter {
    fn write(&mut self, executed: &ExecutedMove) {
        // Writing to memory cannot fail.
        let _ = move_output::write_move(&mut self.written, &mut self.line, executed);
    }
}

impl ExecutionWatcher for MoveWriter {
    fn on_move(&mut self, executed: &ExecutedMove) {
        self.write(executed);
    }
    fn on_tick(
        &mut self,
        _time_ms: u64,
        _machine: Point,
        _simulation: &Simulation,
    ) -> Option<WatcherStop> {
        None
    }
    fn on_block(&mut self, _line: u32, _text: &str, _modal: &ModalState) {}
    fn on_pass(&mut self, _explanation: &Explanation) {}
    fn wants_explanations(&self) -> bool {
        false
    }
    fn show(&mut self, _message: &Message) {}
}

/// Interprets the selected program of a lathe as `check` does, and returns the result.
pub fn run_check(setup: &Setup) -> PathResult {
    let mut moves = MoveWriter::default();
    let report = report::check_program(
        "",
        setup,
        None,
        &mut |executed| moves.write(executed),
        &mut |progress| progress.motionless < MOTIONLESS_BLOCKS,
    );
    PathResult::parse(&moves.written, &report)
}

/// Interprets the selected program of a mill as `check` does, and returns the result.
pub fn run_mill_check(setup: &MillSetup, programs: &ProgramMemory) -> PathResult {
    let (mut written, mut line) = (Vec::new(), JsonLine::default());
    let report = gsk_runner::mill::check_program(
        "",
        setup,
        programs,
        None,
        &mut |made| {
            // Writing to memory cannot fail.
            let _ = gsk_runner::mill::write_move(&mut written, &mut line, made);
        },
        &mut |progress| progress.motionless < MOTIONLESS_BLOCKS,
    );
    PathResult::parse(&written, &report)
}

/// Runs the selected program tick by tick as `run` does, and returns the result.
pub fn run_kernel(setup: &Setup) -> PathResult {
    let mut moves = MoveWriter::default();
    let simulation = Simulation::new(setup.clone());
    match execution::execute("", simulation, RUN_LIMITS, None, None, &mut moves, None) {
        Ok((report, _)) => PathResult::parse(&moves.written, &report),
        Err(error) => PathResult {
            moves: Vec::new(),
            result: json!({ "end": error.to_string() }),
        },
    }
}
