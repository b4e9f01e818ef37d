//! `run`: a program in the full kernel.

use std::io::Write;
use std::path::Path;

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::interpreter::{Explanation, Modal};
use gsk_core::simulation::Simulation;
use gsk_core::units::{Feed, Point};
use indicatif::ProgressBar;

use super::{ALARM, FINE, output};
use crate::cli::RunArgs;
use crate::execution::{self, Limits, Watcher};
use crate::files::data_dir::DataDir;
use crate::picture::{self, Drawing, RapidRates};
use crate::report::{self, clock};
use crate::{loading, moves, retained};

/// Ticks between two looks at the progress line.
const PROGRESS_MS: u64 = 4096;

/// Runs a program.
pub fn run(args: &RunArgs) -> Result<u8, String> {
    if let Some(path) = &args.plot {
        picture::check_name(path)?;
    }
    let mut setup = gsk_core::setup::Setup::default();
    let data = match &args.setup.data {
        Some(path) => Some(DataDir::open(path).map_err(|error| error.to_string())?),
        None => None,
    };
    let restored = data.as_ref().map(|data| retained::load(data, &mut setup));
    for complaint in restored.iter().flat_map(|restored| &restored.complaints) {
        eprintln!("gsk980td: {complaint}");
    }
    loading::apply(&mut setup, &args.setup)?;
    loading::open(&mut setup, &args.files)?.print();

    let name = args
        .files
        .first()
        .map(|path| path.display().to_string())
        .unwrap_or_default();
    let lines = setup
        .programs
        .current()
        .and_then(|program| setup.programs.get(program))
        .map_or(0, gsk_core::program::Program::line_count);
    let mut outputs = Outputs {
        moves: args.moves.as_deref().map(output::open).transpose()?,
        positions: args.positions.as_deref().map(output::open).transpose()?,
        drawing: args
            .plot
            .is_some()
            .then(|| Drawing::new(title(&args.files[0]))),
        rates: RapidRates::of(&setup.parameters),
        explain: args.explain,
        progress: output::progress(u64::from(lines)),
        line: 0,
        pass: None,
    };
    outputs.begin()?;
    let limits = Limits {
        parts: args.parts,
        time_ms: args.limit,
    };
    let (report, simulation) = execution::execute(&name, setup, limits, &mut outputs)?;
    outputs.end()?;
    if let (Some(path), Some(drawing)) = (&args.plot, &outputs.drawing) {
        picture::write(path, drawing)?;
    }
    if let (Some(data), Some(restored)) = (data, restored) {
        retained::save(data, &restored, &simulation.cnc)?;
    }
    if args.json {
        let json = serde_json::to_string(&report).map_err(|error| error.to_string())?;
        output::print(&format!("{json}\n"))?;
    } else {
        output::print(&report.words())?;
    }
    Ok(if matches!(report.end, "alarm" | "limit") {
        ALARM
    } else {
        FINE
    })
}

/// The title of a picture.
pub fn title(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// Everything that is written while a program runs.
struct Outputs {
    moves: Option<Box<dyn Write>>,
    positions: Option<Box<dyn Write>>,
    drawing: Option<Drawing>,
    rates: RapidRates,
    explain: bool,
    progress: ProgressBar,
    line: u32,
    /// The pass that was explained last.
    pass: Option<u64>,
}

impl Outputs {
    fn begin(&mut self) -> Result<(), String> {
        if let Some(out) = &mut self.positions {
            out.write_all(moves::POSITIONS_HEAD.as_bytes())
                .map_err(said)?;
        }
        Ok(())
    }

    fn end(&mut self) -> Result<(), String> {
        self.progress.finish_and_clear();
        for out in [&mut self.moves, &mut self.positions].into_iter().flatten() {
            out.flush().map_err(said)?;
        }
        Ok(())
    }
}

#[allow(clippy::needless_pass_by_value)] // For map_err.
fn said(error: std::io::Error) -> String {
    format!("the output cannot be written: {error}")
}

impl Watcher for Outputs {
    fn moved(&mut self, executed: &ExecutedMove) -> Result<(), String> {
        if let Some(out) = &mut self.moves {
            moves::write_move(out, executed).map_err(said)?;
        }
        if let Some(drawing) = &mut self.drawing {
            drawing.push(executed, self.rates);
        }
        if self.explain {
            output::print(&format!("        {}\n", sentence(executed)))?;
        }
        Ok(())
    }

    fn ticked(
        &mut self,
        time_ms: u64,
        machine: Point,
        simulation: &Simulation,
    ) -> Result<(), String> {
        if let Some(out) = &mut self.positions {
            let degrees = simulation.lathe.spindle_degrees();
            moves::write_position(out, time_ms as f64 / 1000.0, machine, degrees).map_err(said)?;
        }
        if time_ms.is_multiple_of(PROGRESS_MS) && !self.progress.is_hidden() {
            self.progress.set_position(u64::from(self.line));
            self.progress
                .set_message(format!("machine time {}", clock(time_ms as f64 / 1000.0)));
        }
        Ok(())
    }

    fn block(&mut self, line: u32, text: &str, modal: &Modal) -> Result<(), String> {
        self.line = line;
        self.pass = None;
        if !self.explain {
            return Ok(());
        }
        let codes = report::modal_codes(modal).join(" ");
        let (feed, speed) = (moves::rounded(modal.feed), moves::rounded(modal.spindle));
        let (tool, offset) = (modal.tool, modal.offset);
        output::print(&format!(
            "{line:6}  {text}\n        {codes} F{feed} S{speed} T{tool:02}{offset:02}\n"
        ))
    }

    fn pass(&mut self, explanation: &Explanation) -> Result<(), String> {
        if self.pass == Some(explanation.pass) {
            return Ok(());
        }
        self.pass = Some(explanation.pass);
        output::print(&pass_in_words(explanation))
    }

    fn wants_explanations(&self) -> bool {
        self.explain
    }
}

/// A pass of a cycle, as it would stand on the blackboard.
fn pass_in_words(explanation: &Explanation) -> String {
    let Explanation {
        code,
        pass,
        depth,
        remaining,
        formula,
        words,
        ..
    } = explanation;
    let of = explanation
        .passes
        .map_or_else(String::new, |passes| format!(" of {passes}"));
    let level = explanation.level.map_or_else(String::new, |level| {
        format!(" at {}", moves::rounded(level))
    });
    let cut = if *depth == 0.0 && *remaining == 0.0 {
        String::new()
    } else {
        format!(": depth {depth:.3}, left {remaining:.3}")
    };
    format!("        G{code:02} pass {pass}{of}{level}{cut}\n          {formula}   [{words}]\n")
}

/// A move in words.
fn sentence(executed: &ExecutedMove) -> String {
    let (x, z) = moves::diameter_z(executed.to);
    let verb = match executed.kind {
        MoveKind::Rapid => "rapid",
        MoveKind::Feed => "cut",
        MoveKind::Clockwise => "cut clockwise",
        MoveKind::CounterClockwise => "cut counter-clockwise",
        MoveKind::Thread => "thread",
        MoveKind::RunOut => "leave the thread",
        MoveKind::Dwell => return format!("wait {} s", moves::rounded(executed.duration_s)),
    };
    let feed = match executed.feed {
        Some(Feed::PerMinute(feed)) => format!(" at {} mm/min", moves::rounded(feed)),
        Some(Feed::PerRevolution(feed)) => format!(" at {} mm/r", moves::rounded(feed)),
        None => String::new(),
    };
    format!("{verb} to X{x} Z{z}{feed}: {:.2} s", executed.duration_s)
}
