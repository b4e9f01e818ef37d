//! `run`: executes a program in the complete control.

use std::io::Write;
use std::path::{Path, PathBuf};

use gsk_core::alarm::number;
use gsk_core::command::ExecutedMove;
use gsk_core::interpreter::{Explanation, Modal};
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_messages::{Language, Message, say};
use gsk_runner::board::Operator;
use gsk_runner::curves::RapidRates;
use gsk_runner::execution::{self, Board, Limits, Watcher};
use gsk_runner::machining::live::Live;
use gsk_runner::partner::Partner;
use gsk_runner::picture::{self, Drawing, Format};
use gsk_runner::report::PartReport;
use gsk_runner::words::clock;
use gsk_runner::{moves, narration, report};
use indicatif::ProgressBar;

use super::{ALARM, COLLISION, CommandError, FINE, output};
use crate::apart::{Read, keep_apart, results};
use crate::cli::RunArgs;
use crate::dnc::{self, Source};
use crate::ending::ENDED;
use crate::files::data_dir::DataDir;
use crate::loading::LoadError;
use crate::person::Person;
use crate::picture::check_name;
use crate::{job, kernel, loading, retained};

/// Interval at which the progress line is updated, ms of machine time.
const PROGRESS_MS: u64 = 4096;

/// Executes a program and returns the exit code.
pub fn run(args: &RunArgs, spoken: Option<Language>) -> Result<u8, CommandError> {
    args.setup.refuse_mill().map_err(LoadError::from)?;
    if let Some(path) = &args.plot {
        check_name(path)?;
    }
    let read = Read {
        files: (args.files.iter().map(PathBuf::as_path))
            .chain(args.dnc.as_deref())
            .chain(args.setup.read_files())
            .collect(),
        main: args
            .files
            .first()
            .filter(|_| args.dnc.is_none())
            .map(PathBuf::as_path),
        data: args.setup.data.as_deref(),
    };
    let written = results(&[&args.moves, &args.positions, &args.plot, &args.part.section]);
    keep_apart(&read, &written)?;
    let person = attended(args)?;
    let language = spoken.unwrap_or(Language::En);
    let bare = match args.link {
        Some(_) => Setup::at_the_panel(),
        None => Setup::default(),
    };
    let mut setup = loading::fitted(bare, args.setup.machine.as_ref());
    let data = match &args.setup.data_folder() {
        Some(path) => Some(DataDir::open(path)?),
        None => None,
    };
    let restored = data.as_ref().map(|data| retained::load(data, &mut setup));
    for complaint in restored.iter().flat_map(|restored| &restored.complaints) {
        output::complain_of(complaint);
    }
    if let (Some(restored), Some(_)) = (&restored, &args.link) {
        restored.place(&mut setup);
    }
    loading::apply(&mut setup, &args.setup)?;
    let mut partner = args
        .dnc
        .as_ref()
        .map(|name| dnc::Partner::new(Source::of(name)));
    if partner.is_some() {
        loading::with_keys_for_dnc(&mut setup);
        loading::store_files(&mut setup.memory.programs, &args.files)?.print(spoken);
    } else {
        loading::open(&mut setup, &args.files)?.print(spoken);
    }

    let main = args.dnc.as_ref().or(args.files.first());
    let name = main
        .map(|path| path.display().to_string())
        .unwrap_or_default();
    let lines = setup
        .memory
        .programs
        .current()
        .and_then(|program| setup.memory.programs.get(program))
        .map_or(0, gsk_core::program::Program::line_count);
    let mut outputs = Outputs {
        moves: args.moves.as_deref().map(output::open).transpose()?,
        positions: args.positions.as_deref().map(output::open).transpose()?,
        drawing: args.plot.is_some().then(|| {
            let title = main.map(|path| title(path)).unwrap_or_default();
            Drawing::new(title, args.picture.look())
        }),
        rates: RapidRates::of(&setup.memory),
        explain: args.explain,
        language,
        progress: output::progress(u64::from(lines)),
        line: 0,
        pass: None,
        live: None,
        stops_at_collision: args.stop_on_collision,
        failed: None,
    };
    let wants_part = args.part.wanted() || args.stop_on_collision || args.picture.needs_part();
    let chosen = match wants_part {
        true => Some(job::choose(
            &args.part.job,
            main.map(PathBuf::as_path),
            &setup,
        )?),
        false => None,
    };
    outputs.live = chosen.as_ref().map(|chosen| Live::new(chosen.machining()));
    let target = args.plot.as_deref().map(output::reserve).transpose()?;
    outputs.begin()?;
    let limits = Limits {
        parts: args.parts,
        time_ms: args.limit,
    };
    let link = match &args.link {
        Some(port) => {
            super::window::connection(Some(port.clone()), &setup, args.setup.data.as_deref())?
        }
        None => None,
    };
    let mut simulation = Simulation::new(setup);
    let board = match link {
        Some(link) => {
            let mut live = kernel::live::Live::open(link, &mut simulation)?;
            let known = live.get_known(&mut simulation, |simulation| simulation, Simulation::tick);
            if let Err(said) = known {
                outputs.progress.finish_and_clear();
                output::complain_of(&said.message());
                return Ok(if live.is_over() { ENDED } else { ALARM });
            }
            let home = args.home;
            let operator = person.map(|person| Box::new(person) as Box<dyn Operator>);
            Some(Board::new(Box::new(live), home, operator))
        }
        None => None,
    };
    let partner = partner.as_mut().map(|partner| partner as &mut dyn Partner);
    let (mut report, simulation) = execution::execute(
        &name,
        simulation,
        limits,
        partner,
        board,
        &mut outputs,
        spoken,
    )?;
    report.part = chosen.zip(outputs.live.as_ref()).map(|(chosen, live)| {
        PartReport::new(live.machining(), chosen.name(), args.part.measure, None)
    });
    // Each result is written independently: one failure does not affect the others.
    let mut failures = Vec::new();
    if let (Some(data), Some(restored)) = (data, restored) {
        let saved = retained::save(data, &restored, &simulation.cnc);
        failures.extend(saved.map_err(CommandError::from).err());
    }
    failures.extend(outputs.end().err());
    if let (Some(path), Some(live)) = (&args.part.section, &outputs.live) {
        failures.extend(
            job::write_section(path, live.machining())
                .err()
                .map(CommandError::from),
        );
    }
    let mut drawing = outputs.drawing.take();
    if let (Some(path), Some(target), Some(drawing)) = (&args.plot, target, &mut drawing) {
        drawing.end(report.time_s);
        if let Some(live) = &outputs.live {
            drawing.stand_before(live.machining());
        }
        failures.extend(drawn(path, drawing, target, language).err());
        if let Some(said) = picture::shortfall(drawing) {
            output::complain_of(&said);
        }
    }
    let moves_on_screen = [&args.moves, &args.positions]
        .into_iter()
        .any(|path| output::is_standard(path.as_deref()));
    output::report(&report, args.json, moves_on_screen, spoken)?;
    let unknown = report
        .alarm
        .as_ref()
        .is_some_and(|alarm| alarm.number == number::NO_REFERENCE);
    if unknown && !args.home {
        output::complain_of(&say::run_home_first());
    }
    if !failures.is_empty() {
        return Err(CommandError::Several(failures));
    }
    Ok(match report.end {
        report::End::Asked => ENDED,
        _ if report.collided() => COLLISION,
        _ if report.failed() => ALARM,
        _ => FINE,
    })
}

/// Draws the toolpath and writes the picture.
fn drawn(
    path: &Path,
    drawing: &Drawing,
    target: output::Reserved,
    language: Language,
) -> Result<(), CommandError> {
    let format = Format::of(path)?;
    let bytes = picture::encode(format, drawing, language)?;
    Ok(target.write(&bytes)?)
}

/// The operator who confirms the stops of a real machine; `None` if no board is connected or
/// standard input is no terminal.
///
/// # Errors
/// Options that a real machine does not accept, or several parts without an operator.
fn attended(args: &RunArgs) -> Result<Option<Person>, CommandError> {
    if args.link.is_none() {
        return Ok(None);
    }
    args.setup.refuse_at_a_board()?;
    // With DNC on standard input, standard input holds the program.
    let taken = args
        .dnc
        .as_deref()
        .is_some_and(|name| Source::of(name) == Source::Standard);
    let person = if taken { None } else { Person::at_terminal() };
    if args.parts > 1 && person.is_none() {
        return Err(CommandError::Unattended(args.parts));
    }
    Ok(person)
}

/// The title of a picture: the name of the program file.
pub fn title(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// The results that are written while a program runs.
struct Outputs {
    moves: Option<Box<dyn Write>>,
    positions: Option<Box<dyn Write>>,
    drawing: Option<Drawing>,
    rates: RapidRates,
    explain: bool,
    language: Language,
    progress: ProgressBar,
    line: u32,
    /// The pass that was explained last.
    pass: Option<u64>,
    /// The part being cut.
    live: Option<Live>,
    stops_at_collision: bool,
    /// The first error of writing; the run continues.
    failed: Option<CommandError>,
}

impl Outputs {
    fn begin(&mut self) -> Result<(), CommandError> {
        if let Some(out) = &mut self.positions {
            out.write_all(moves::POSITIONS_HEAD.as_bytes())
                .map_err(CommandError::Output)?;
        }
        Ok(())
    }

    fn end(&mut self) -> Result<(), CommandError> {
        self.progress.finish_and_clear();
        for out in [&mut self.moves, &mut self.positions].into_iter().flatten() {
            if let Err(error) = out.flush() {
                self.failed.get_or_insert(CommandError::Output(error));
            }
        }
        self.failed.take().map_or(Ok(()), Err)
    }
}

impl Watcher for Outputs {
    fn moved(&mut self, executed: &ExecutedMove) {
        if let Some(out) = &mut self.moves
            && let Err(error) = moves::write_move(out, executed)
        {
            self.moves = None;
            self.failed.get_or_insert(CommandError::Output(error));
        }
        if let Some(drawing) = &mut self.drawing {
            drawing.push(executed, self.rates);
        }
        if self.explain {
            output::print(&narration::executed(executed, self.language));
        }
    }

    fn ticked(&mut self, time_ms: u64, machine: Point, simulation: &Simulation) -> bool {
        if let Some(out) = &mut self.positions {
            let degrees = simulation.lathe.spindle_degrees();
            let time_s = time_ms as f64 / 1000.0;
            if let Err(error) = moves::write_position(out, time_s, machine, degrees) {
                self.positions = None;
                self.failed.get_or_insert(CommandError::Output(error));
            }
        }
        if time_ms.is_multiple_of(PROGRESS_MS) && !self.progress.is_hidden() {
            self.progress.set_position(u64::from(self.line));
            let time = clock(time_ms as f64 / 1000.0);
            let said = say::report_progress_time(time);
            self.progress.set_message(output::worded(&said));
        }
        let found = self.live.as_mut().map(|live| live.ticked(simulation));
        self.stops_at_collision && found.is_some_and(|found| !found.is_empty())
    }

    fn block(&mut self, line: u32, text: &str, modal: &Modal) {
        self.line = line;
        self.pass = None;
        if !self.explain {
            return;
        }
        output::print(&narration::block(line, text, modal));
    }

    fn pass(&mut self, explanation: &Explanation) {
        if self.pass == Some(explanation.pass) {
            return;
        }
        self.pass = Some(explanation.pass);
        output::print(&narration::pass(explanation, self.language));
    }

    fn wants_explanations(&self) -> bool {
        self.explain
    }

    fn tell(&mut self, said: &Message) {
        self.progress.suspend(|| output::complain_of(said));
    }
}
