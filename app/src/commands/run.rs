//! `run`: executes a program in the complete control.

mod debugging;
mod overload;
mod restarting;

use std::io::Write;
use std::path::{Path, PathBuf};

use gsk_core::alarm::number;
use gsk_core::command::ExecutedMove;
use gsk_core::interpreter::{Explanation, ModalState};
use gsk_core::json_line::JsonLine;
use gsk_core::machine::LatheFault;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_host::files::data_dir::DataDir;
use gsk_host::files::overwrite_guard::{CommandInputs, check_overwrites, collect_outputs};
use gsk_host::job::SelectedJob;
use gsk_host::kernel::BoardConnection;
use gsk_host::kernel::headless_board::HeadlessBoard;
use gsk_host::loading::LoadError;
use gsk_host::ports::dnc::{self, DncSource};
use gsk_host::retained::Restored;
use gsk_host::termination::TERMINATED_EXIT_CODE;
use gsk_host::{job, loading, retained};
use gsk_messages::{Language, Message, say};
use gsk_plot::{PathDrawing, PictureFormat};
use gsk_runner::board::TerminalOperator;
use gsk_runner::curves::RapidRates;
use gsk_runner::execution::{
    self, ExecutionLimits, ExecutionWatcher, SupervisedBoard, WatcherStop,
};
use gsk_runner::machining::live_part::LivePart;
use gsk_runner::partner::ProgramPartner;
use gsk_runner::report::{PartReport, ProgramReport};
use gsk_runner::script::TickObserver as _;
use gsk_runner::text_format::format_time;
use gsk_runner::{move_output, narration, report};
use indicatif::ProgressBar;

use debugging::{RunDebugger, uses_standard_output};
use overload::OverloadLog;
use restarting::RequestedRestart;

use super::network::CommandNetwork;
use super::results::report_exit_code;
use super::{CommandError, EXIT_ALARM, output};
use crate::cli::RunArgs;
use crate::picture::check_name;
use crate::terminal::StdinOperator;

/// Interval at which the progress line is updated, ms of machine time.
const PROGRESS_INTERVAL_MS: u64 = 4096;

/// Executes a program and returns the exit code. Returns an error if an option is wrong or a file
/// cannot be read or written.
pub fn run(args: &RunArgs, spoken: Option<Language>) -> Result<u8, CommandError> {
    args.setup.refuse_mill().map_err(LoadError::from)?;
    check_outputs(args)?;
    let terminal = find_operator(args)?;
    let language = spoken.unwrap_or(Language::En);
    let (mut setup, memory) = prepare_setup(args)?;
    let mut partner = args
        .dnc
        .as_ref()
        .map(|name| dnc::DncPartner::new(DncSource::from_name(name)));
    if partner.is_some() {
        loading::use_dnc_ladder(&mut setup);
        loading::store_files(&mut setup.memory.programs, &args.files)?.print(spoken);
    } else {
        loading::open_program(&mut setup, &args.files)?.print(spoken);
    }

    let main = args.dnc.as_ref().or(args.files.first());
    let main = main.map(PathBuf::as_path);
    let name = main
        .map(|path| path.display().to_string())
        .unwrap_or_default();
    let debugger = RunDebugger::open(&args.debug, &args.files, &setup, spoken)?;
    let needs_part = debugger.needs_part();
    let mut outputs = RunOutputs::open(args, main, &setup, language, debugger)?;
    let job_choice = choose_job(args, main, &setup, needs_part)?;
    outputs.live_part = job_choice.as_ref().map(|chosen| {
        let mut live = LivePart::new(chosen.create_machining());
        live.set_overload(args.overload);
        live
    });
    let target = args.plot.as_deref().map(output::reserve_file).transpose()?;
    outputs.begin()?;
    let limits = ExecutionLimits {
        parts: args.parts,
        time_ms: args.limit,
    };
    let link = match &args.link {
        Some(port) => {
            super::window::board_connection(Some(port.clone()), &setup, args.setup.data.as_deref())?
        }
        None => None,
    };
    let mut simulation = Simulation::new(setup);
    let mut restart = RequestedRestart::from_args(args, outputs.debugger.sources())?;
    let board = match link {
        Some(link) => match open_board(link, &mut simulation, &outputs.progress_bar)? {
            Ok(live) => {
                let operator = terminal.map(|person| Box::new(person) as Box<dyn TerminalOperator>);
                let board = SupervisedBoard::new(Box::new(live), args.home, operator);
                Some(match restart.take() {
                    Some(restart) => {
                        let keeps_part = wants_part(args, needs_part);
                        let planner = restart.into_planner(outputs.live_part.clone(), keeps_part);
                        board.with_restart(Box::new(planner))
                    }
                    None => board,
                })
            }
            Err(exit_code) => return Ok(exit_code),
        },
        None => None,
    };
    if let Some(restart) = restart {
        let is_result_elsewhere = args.json || uses_standard_output(args);
        restart.prepare(&mut simulation, &mut outputs.live_part, is_result_elsewhere)?;
    }
    let services = (&args.mtconnect, &args.mqtt);
    let part = outputs.live_part.clone();
    outputs.network = CommandNetwork::start(services, &simulation, part, board.is_some())?;
    if !wants_part(args, needs_part) {
        outputs.live_part = None;
    }
    let partner = partner.as_mut().map(|it| it as &mut dyn ProgramPartner);
    let (mut report, simulation) = execution::execute(
        &name,
        simulation,
        limits,
        partner,
        board,
        &mut outputs,
        spoken,
    )?;
    outputs.network = None;
    let live_part = outputs.live_part.as_ref();
    report.part = job_choice.zip(live_part).map(|(chosen, live)| {
        let (machining, job) = (live.machining(), chosen.file_name());
        PartReport::new(machining, job, args.part.measure, None)
            .with_overloads(outputs.overload.cuts(), spoken)
    });
    // Each result is written independently: one failure does not affect the others.
    let mut failures = Vec::new();
    if let Some((data, restored)) = memory {
        let saved = retained::save(data, &restored, &simulation.cnc);
        failures.extend(saved.map_err(CommandError::from).err());
    }
    failures.extend(write_results(args, &mut outputs, target, report.time_s));
    match outputs.debugger.finish() {
        Ok(breaks) => report.breaks = breaks,
        Err(error) => failures.push(CommandError::output(error)),
    }
    print_result(args, &report, spoken)?;
    if !failures.is_empty() {
        return Err(CommandError::several(&failures));
    }
    Ok(match report.end {
        report::RunEnd::Requested => TERMINATED_EXIT_CODE,
        _ => report_exit_code(&report),
    })
}

/// Checks that the picture has a valid name and that no result overwrites an input or another
/// result; returns an error if not.
fn check_outputs(args: &RunArgs) -> Result<(), CommandError> {
    if let Some(path) = &args.plot {
        check_name(path)?;
    }
    let inputs = CommandInputs {
        files: (args.files.iter().map(PathBuf::as_path))
            .chain(args.dnc.as_deref())
            .chain(args.setup.input_files())
            .collect(),
        main_program: args
            .files
            .first()
            .filter(|_| args.dnc.is_none())
            .map(PathBuf::as_path),
        data_dir: args.setup.data.as_deref(),
    };
    let output_paths = collect_outputs(&[
        &args.moves,
        &args.positions,
        &args.plot,
        &args.part.section,
        &args.debug.trace,
    ]);
    check_overwrites(&inputs, &output_paths)?;
    Ok(())
}

/// Prepares control and lathe from the options and the data directory. Also returns that directory
/// with the memory loaded from it; `None` without one. Returns an error if an option or a file is
/// wrong.
fn prepare_setup(args: &RunArgs) -> Result<(Setup, Option<(DataDir, Restored)>), CommandError> {
    let initial_setup = match args.link {
        Some(_) => Setup::for_operator_script(),
        None => Setup::default(),
    };
    let mut setup = loading::with_training_lathe(initial_setup, args.setup.machine.as_ref());
    let memory = match &args.setup.data_folder() {
        Some(path) => {
            let data = DataDir::open(path)?;
            let restored = retained::load(&data, &mut setup);
            Some((data, restored))
        }
        None => None,
    };
    for complaint in memory.iter().flat_map(|(_, restored)| &restored.complaints) {
        output::report_error(complaint);
    }
    if let (Some((_, restored)), Some(_)) = (&memory, &args.link) {
        restored.place_slides(&mut setup);
    }
    loading::apply_options(&mut setup, &args.setup)?;
    Ok((setup, memory))
}

/// Selects the job of the part; `None` if no requested result needs the part. `needs_part`:
/// a breakpoint does. Returns an error if the job file is wrong.
fn choose_job(
    args: &RunArgs,
    main: Option<&Path>,
    setup: &Setup,
    needs_part: bool,
) -> Result<Option<SelectedJob>, CommandError> {
    if wants_part(args, needs_part) {
        return Ok(Some(job::choose(&args.part.job, main, setup)?));
    }
    // Without a part the way of a restart is not checked for collisions, and the MTConnect agent
    // has no tools.
    let uses_job = args.restart.restart.is_some()
        || args.mtconnect.mtconnect.is_some()
        || args.mqtt.mqtt.is_some();
    let job = uses_job.then(|| job::choose(&args.part.job, main, setup).ok());
    Ok(job.flatten())
}

/// Whether any requested result needs the part. `needs_part`: a breakpoint needs it.
fn wants_part(args: &RunArgs, needs_part: bool) -> bool {
    needs_part
        || args.part.is_requested()
        || args.debug.stop_on_collision
        || args.overload
        || args.picture.needs_part()
}

/// Opens a board and waits until it is ready. The inner `Err` holds the exit code for a board
/// that does not become ready.
fn open_board(
    link: BoardConnection,
    simulation: &mut Simulation,
    progress_bar: &ProgressBar,
) -> Result<Result<HeadlessBoard, u8>, CommandError> {
    let mut live = HeadlessBoard::open(link, simulation)?;
    let readiness = live.wait_until_ready(simulation, |simulation| simulation, Simulation::tick);
    if let Err(error) = readiness {
        progress_bar.finish_and_clear();
        output::report_error(&error.message());
        return Ok(Err(if live.has_ended() {
            TERMINATED_EXIT_CODE
        } else {
            EXIT_ALARM
        }));
    }
    Ok(Ok(live))
}

/// Writes the moves, the section of the part and the picture of a run that took `time_s` of
/// machine time, s. Returns the errors of what could not be written.
fn write_results(
    args: &RunArgs,
    outputs: &mut RunOutputs,
    target: Option<output::ReservedFile>,
    time_s: f64,
) -> Vec<CommandError> {
    let mut failures = Vec::new();
    failures.extend(outputs.end().err());
    if let (Some(path), Some(live)) = (&args.part.section, &outputs.live_part) {
        failures.extend(
            job::write_section(path, live.machining())
                .err()
                .map(CommandError::from),
        );
    }
    let mut drawing = outputs.drawing.take();
    if let (Some(path), Some(target), Some(drawing)) = (&args.plot, target, &mut drawing) {
        drawing.end(time_s);
        if let Some(live) = &outputs.live_part {
            drawing.add_scenery(live.machining());
        }
        failures.extend(write_picture(path, drawing, target, outputs.language).err());
        if let Some(message) = gsk_plot::missing_moves_message(drawing) {
            output::report_error(&message);
        }
    }
    failures
}

/// Prints the report of the run and, if the position of the slides is unknown, advice. Returns an
/// error if it cannot be written.
fn print_result(
    args: &RunArgs,
    report: &ProgramReport,
    spoken: Option<Language>,
) -> Result<(), CommandError> {
    output::print_report(report, args.json, uses_standard_output(args), spoken)?;
    let is_position_unknown = report
        .alarm
        .as_ref()
        .is_some_and(|alarm| alarm.number == number::NO_REFERENCE);
    if is_position_unknown && !args.home {
        output::report_error(&say::run_home_first());
    }
    Ok(())
}

/// Draws the toolpath and writes the picture into `target`; `path` gives its format. Returns an
/// error if that fails.
fn write_picture(
    path: &Path,
    drawing: &PathDrawing,
    target: output::ReservedFile,
    language: Language,
) -> Result<(), CommandError> {
    let format = PictureFormat::from_file_name(path)?;
    let bytes = gsk_plot::encode(format, drawing, language)?;
    Ok(target.write(&bytes)?)
}

/// The operator who confirms the stops of a real machine; `None` if no board is connected or
/// standard input is no terminal.
///
/// # Errors
/// Options that a real machine does not accept, or several parts without an operator.
fn find_operator(args: &RunArgs) -> Result<Option<StdinOperator>, CommandError> {
    if args.link.is_none() {
        return Ok(None);
    }
    args.setup.refuse_machine_state()?;
    // With DNC on standard input, standard input holds the program.
    let stdin_is_program = args
        .dnc
        .as_deref()
        .is_some_and(|name| DncSource::from_name(name) == DncSource::Standard);
    let terminal = if stdin_is_program {
        None
    } else {
        StdinOperator::open()
    };
    if args.parts > 1 && terminal.is_none() {
        return Err(say::command_parts_unattended(args.parts).into());
    }
    Ok(terminal)
}

/// Returns the title of a picture: the name of the program file.
pub fn picture_title(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// The block that is being executed, for the progress output.
#[derive(Default)]
struct BlockProgress {
    /// Line of the block, from 1; 0 before the first block.
    line: u32,
    /// Number of the cycle pass that was explained last; `None` before the first one.
    explained_pass: Option<u64>,
}

/// The file of the moves, and the line that is written next.
struct MoveFile {
    out: Box<dyn Write>,
    line: JsonLine,
}

/// The result files and progress output of a running program.
struct RunOutputs {
    moves: Option<MoveFile>,
    positions: Option<Box<dyn Write>>,
    drawing: Option<PathDrawing>,
    rates: RapidRates,
    explain: bool,
    language: Language,
    progress_bar: ProgressBar,
    block: BlockProgress,
    /// What options switch on in the network; `None` if nothing is on.
    network: Option<CommandNetwork>,
    /// The part that the program cuts; `None` if no result needs it.
    live_part: Option<LivePart>,
    stops_at_collision: bool,
    overload: OverloadLog,
    debugger: RunDebugger,
    /// Whether breakpoints are reported when they are reached, not in the JSON only.
    prints_breaks: bool,
    /// The first error of a result file, after which the run continues; `None` without one.
    first_error: Option<CommandError>,
}

impl RunOutputs {
    /// Opens the result files that the options request. `main` is the path of the program that
    /// runs. Returns an error if a file cannot be created.
    fn open(
        args: &RunArgs,
        main: Option<&Path>,
        setup: &Setup,
        language: Language,
        debugger: RunDebugger,
    ) -> Result<Self, CommandError> {
        let lines = setup
            .memory
            .programs
            .selected()
            .and_then(|program| setup.memory.programs.get(program))
            .map_or(0, gsk_core::program::Program::line_count);
        let moves = args.moves.as_deref().map(output::open).transpose()?;
        Ok(Self {
            moves: moves.map(|out| MoveFile {
                out,
                line: JsonLine::default(),
            }),
            positions: args.positions.as_deref().map(output::open).transpose()?,
            drawing: args.plot.is_some().then(|| {
                let title = main.map(picture_title).unwrap_or_default();
                PathDrawing::new(title, args.picture.to_look())
            }),
            rates: RapidRates::from_memory(&setup.memory),
            explain: args.explain,
            language,
            progress_bar: output::create_progress_bar(u64::from(lines)),
            block: BlockProgress::default(),
            network: None,
            live_part: None,
            stops_at_collision: args.debug.stop_on_collision,
            overload: OverloadLog::new(args),
            debugger,
            prints_breaks: !args.json && !uses_standard_output(args),
            first_error: None,
        })
    }

    fn begin(&mut self) -> Result<(), CommandError> {
        if let Some(out) = &mut self.positions {
            out.write_all(move_output::POSITIONS_HEADER.as_bytes())
                .map_err(CommandError::output)?;
        }
        Ok(())
    }

    fn end(&mut self) -> Result<(), CommandError> {
        self.progress_bar.finish_and_clear();
        let moves = self.moves.iter_mut().map(|file| &mut file.out);
        for out in moves.chain(&mut self.positions) {
            if let Err(error) = out.flush() {
                self.first_error.get_or_insert(CommandError::output(error));
            }
        }
        self.first_error.take().map_or(Ok(()), Err)
    }
}

impl ExecutionWatcher for RunOutputs {
    fn on_move(&mut self, executed: &ExecutedMove) {
        if let Some(MoveFile { out, line }) = &mut self.moves
            && let Err(error) = move_output::write_move(out, line, executed)
        {
            self.moves = None;
            self.first_error.get_or_insert(CommandError::output(error));
        }
        if let Some(drawing) = &mut self.drawing {
            drawing.add_move(executed, self.rates);
        }
        if self.explain {
            output::print(&narration::move_text(executed, self.language));
        }
    }

    fn on_tick(
        &mut self,
        time_ms: u64,
        machine: Point,
        simulation: &Simulation,
    ) -> Option<WatcherStop> {
        if let Some(out) = &mut self.positions {
            let degrees = simulation.lathe.spindle_degrees();
            let time_s = time_ms as f64 / 1000.0;
            if let Err(error) = move_output::write_position(out, time_s, machine, degrees) {
                self.positions = None;
                self.first_error.get_or_insert(CommandError::output(error));
            }
        }
        if time_ms.is_multiple_of(PROGRESS_INTERVAL_MS) && !self.progress_bar.is_hidden() {
            self.progress_bar.set_position(u64::from(self.block.line));
            let time = format_time(time_ms as f64 / 1000.0);
            let message = say::report_progress_time(time);
            self.progress_bar.set_message(output::localize(&message));
        }
        let found = self
            .live_part
            .as_mut()
            .map(|live| live.follow_tick(simulation));
        let has_collided = found.is_some_and(|found| !found.is_empty());
        if let Some(cut) = self.overload.follow_tick(self.live_part.as_ref()) {
            self.show(&cut.message());
        }
        if let Some(network) = &mut self.network {
            network.follow_tick(simulation);
        }
        let reached = self.debugger.follow_tick(time_ms, simulation, has_collided);
        let reached = reached.unwrap_or_else(|error| {
            self.first_error.get_or_insert(CommandError::output(error));
            Default::default()
        });
        if self.prints_breaks {
            for message in &reached.messages {
                let print = || output::print_message(message);
                self.progress_bar.suspend(print);
            }
        }
        if has_collided && self.stops_at_collision {
            Some(WatcherStop::Collision)
        } else if self.overload.ends_run() {
            Some(WatcherStop::Overload)
        } else {
            reached.ends.then_some(WatcherStop::Location)
        }
    }

    fn cut_fault(&self) -> Option<LatheFault> {
        self.overload.fault()
    }

    fn on_block(&mut self, line: u32, text: &str, modal: &ModalState) {
        self.block.line = line;
        self.block.explained_pass = None;
        if !self.explain {
            return;
        }
        output::print(&narration::block_text(line, text, modal));
    }

    fn on_pass(&mut self, explanation: &Explanation) {
        if !self.explain || self.block.explained_pass == Some(explanation.pass) {
            return;
        }
        self.block.explained_pass = Some(explanation.pass);
        output::print(&narration::pass_text(explanation, self.language));
    }

    fn wants_explanations(&self) -> bool {
        self.explain || self.debugger.needs_passes()
    }

    fn show(&mut self, message: &Message) {
        self.progress_bar.suspend(|| output::report_error(message));
    }

    fn on_restart(&mut self, part: Option<LivePart>) {
        self.live_part = part;
    }
}
