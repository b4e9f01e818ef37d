//! Executes programs on both paths, with results as the command line writes them.

use gsk_core::command::{ExecutedMove, ProgramId};
use gsk_core::interpreter::{Explanation, Modal};
use gsk_core::program::ProgramMemory;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_messages::Message;
use gsk_milling::MillSetup;
use gsk_runner::execution::{self, Limits, Watcher};
use gsk_runner::moves;
use gsk_runner::report::{self, AlarmReport, Report};
use serde_json::{Value, json};

/// One part, within half an hour of machine time.
const LIMITS: Limits = Limits {
    parts: 1,
    time_ms: 1_800_000,
};
/// Number of blocks without motion after which a preview is cancelled.
const MOTIONLESS_BLOCKS: u64 = 1_500_000;

/// The results of a path.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    /// The moves in the order of execution.
    pub moves: Vec<Value>,
    /// The result, without the fields that the path does not compute.
    pub result: Value,
}

impl Seen {
    /// Parses the written output, as a reader of the file does.
    fn read(moves: &[u8], report: &Report) -> Self {
        let lines = moves.split(|byte| *byte == b'\n');
        let lines = lines.filter(|line| !line.is_empty());
        let written = report.json().unwrap_or_default();
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

/// Writes the moves as the command line does.
#[derive(Default)]
struct Moves {
    written: Vec<u8>,
}

impl Moves {
    fn take(&mut self, executed: &ExecutedMove) {
        // Writing to memory cannot fail.
        let _ = moves::write_move(&mut self.written, executed);
    }
}

impl Watcher for Moves {
    fn moved(&mut self, executed: &ExecutedMove) {
        self.take(executed);
    }
    fn ticked(&mut self, _time_ms: u64, _machine: Point, _simulation: &Simulation) -> bool {
        false
    }
    fn block(&mut self, _line: u32, _text: &str, _modal: &Modal) {}
    fn pass(&mut self, _explanation: &Explanation) {}
    fn wants_explanations(&self) -> bool {
        false
    }
    fn tell(&mut self, _said: &Message) {}
}

/// Executes the path of `check`.
pub fn check(setup: &Setup) -> Seen {
    let mut moves = Moves::default();
    let report = report::check(
        "",
        setup,
        None,
        &mut |executed| moves.take(executed),
        &mut |progress| progress.motionless < MOTIONLESS_BLOCKS,
    );
    Seen::read(&moves.written, &report)
}

/// Executes the path of `check` with a mill.
pub fn check_mill(setup: &MillSetup, programs: &ProgramMemory) -> Seen {
    let mut written = Vec::new();
    let report = gsk_runner::mill::check(
        "",
        setup,
        programs,
        None,
        &mut |made| {
            // Writing to memory cannot fail.
            let _ = gsk_runner::mill::write_move(&mut written, made);
        },
        &mut |progress| progress.motionless < MOTIONLESS_BLOCKS,
    );
    Seen::read(&written, &report)
}

/// Executes the path of `run`.
pub fn run(setup: &Setup) -> Seen {
    let mut moves = Moves::default();
    let simulation = Simulation::new(setup.clone());
    match execution::execute("", simulation, LIMITS, None, None, &mut moves, None) {
        Ok((report, _)) => Seen::read(&moves.written, &report),
        Err(error) => Seen {
            moves: Vec::new(),
            result: json!({ "end": error.to_string() }),
        },
    }
}
