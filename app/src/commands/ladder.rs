//! `ladder`: compiles, lists and scans an instruction list, searches and prints it, and moves it
//! to and from a control.

use std::ffi::OsStr;
use std::path::Path;
use std::sync::Arc;

use gsk_core::plc::{CompileError, Ladder, Plc};
use gsk_core::setup::{STANDARD_LADDER, standard_ladder};
use gsk_host::files::overwrite_guard::{CommandInputs, check_overwrites};
use gsk_host::files::program_file;
use gsk_host::loading;
use gsk_host::pc::{PcError, read_ladder, send_ladder};
use gsk_messages::say;
use gsk_runner::ladder::{SearchDirection, list_parameters, print_ladder, search_ladder};

use super::transfer::select_port;
use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::{
    FindDirection, LadderArgs, LadderCommand, LadderFindArgs, LadderPrintArgs, LadderReadArgs,
    LadderRunArgs, LadderSendArgs,
};

pub fn ladder(command: &LadderCommand) -> Result<u8, CommandError> {
    match command {
        LadderCommand::Check(args) => check(args),
        LadderCommand::List(args) => list(args),
        LadderCommand::Run(args) => run(args),
        LadderCommand::Find(args) => find(args),
        LadderCommand::Print(args) => print(args),
        LadderCommand::Parameters(args) => parameters(args),
        LadderCommand::Send(args) => send(args),
        LadderCommand::Read(args) => read(args),
    }
}

/// The errors of a ladder, formatted as one string per error.
#[derive(Debug, thiserror::Error)]
#[error("{}", .0.join("\n"))]
struct LadderErrors(Vec<String>);

fn compile(path: Option<&Path>) -> Result<Result<Arc<Ladder>, LadderErrors>, CommandError> {
    let Some(path) = path else {
        return Ok(Ok(standard_ladder()));
    };
    let file = program_file::read(path)?;
    let name = path.display().to_string();
    Ok(Ladder::compile(&file.text).map(Arc::new).map_err(|errors| {
        let errors = errors.errors.iter();
        LadderErrors(errors.map(|error| format_finding(&name, error)).collect())
    }))
}

/// Formats an error of a ladder as `door.il:123: E03 …`, which editors link to the file.
fn format_finding(name: &str, found: &CompileError) -> String {
    let text = output::localize(&found.message);
    format!("{name}:{}: {} {text}", found.line, found.code)
}

/// Returns the name of the file, or that of the standard ladder.
fn ladder_name(args: &LadderArgs) -> String {
    args.file.as_ref().map_or_else(
        || output::localize(&say::ladder_list_standard()),
        |path| path.display().to_string(),
    )
}

/// Compiles the ladder and runs `work` with it; prints the errors of a ladder that has some.
fn with_ladder(
    args: &LadderArgs,
    work: impl FnOnce(&Ladder) -> Result<u8, CommandError>,
) -> Result<u8, CommandError> {
    match compile(args.file.as_deref())? {
        Ok(ladder) => work(&ladder),
        Err(errors) => {
            complain!("{errors}");
            Ok(EXIT_ALARM)
        }
    }
}

/// Searches a ladder and prints the lines of the output window of GSKCC. Exit code 1 without a
/// match.
fn find(args: &LadderFindArgs) -> Result<u8, CommandError> {
    let direction = match args.direction {
        FindDirection::All => SearchDirection::All,
        FindDirection::Up => SearchDirection::Up(args.from),
        FindDirection::Down => SearchDirection::Down(args.from),
    };
    with_ladder(&args.ladder, |ladder| {
        let found = search_ladder(ladder, &args.text, direction);
        let mut lines = found.messages(&args.text);
        let last = lines.pop();
        for (line, place) in lines.iter().zip(&found.matches) {
            let statement = ladder.statements().get(place.statement);
            let statement = statement.map_or_else(String::new, ToString::to_string);
            output::print(&format!("{}  {statement}\n", output::localize(line)));
        }
        if let Some(last) = last {
            output::print_message(&last);
        }
        Ok(match found.matches.is_empty() {
            true => EXIT_ALARM,
            false => EXIT_OK,
        })
    })
}

fn print(args: &LadderPrintArgs) -> Result<u8, CommandError> {
    let target = args.output.as_path();
    let ending = target.extension().map(OsStr::to_ascii_lowercase);
    let is_html = ending.is_some_and(|it| it == "html" || it == "htm");
    if !is_html && !output::is_standard_output(Some(target)) {
        return Err(say::ladder_print_ending(target.display()).into());
    }
    with_ladder(&args.ladder, |ladder| {
        let name = ladder_name(&args.ladder);
        let page = print_ladder(ladder, &name, output::language());
        write_output(target, &args.ladder, page.as_bytes())
    })
}

/// Writes a result to a file, which must not be the ladder itself, or to standard output.
fn write_output(target: &Path, input: &LadderArgs, bytes: &[u8]) -> Result<u8, CommandError> {
    if output::is_standard_output(Some(target)) {
        output::print(&String::from_utf8_lossy(bytes));
        return Ok(EXIT_OK);
    }
    let inputs = CommandInputs {
        files: input.file.as_deref().into_iter().collect(),
        main_program: None,
        data_dir: None,
    };
    check_overwrites(&inputs, &[target])?;
    output::reserve_file(target)?.write(bytes)?;
    output::print_message(&say::ladder_file_written(target.display()));
    Ok(EXIT_OK)
}

/// Lists the parameters: address, value of a blank memory, preset, meaning, rows.
fn parameters(args: &LadderArgs) -> Result<u8, CommandError> {
    with_ladder(args, |ladder| {
        let mut out = String::new();
        for parameter in list_parameters(ladder, output::language()) {
            let start = parameter
                .start
                .map_or_else(String::new, |it| it.to_string());
            let line = format!(
                "{:<8} {start:>10}  {:<8} {}  [{}]",
                parameter.address.to_string(),
                parameter.preset_text(),
                parameter.meaning,
                parameter.rows_text(),
            );
            out.push_str(line.trim_end());
            out.push('\n');
        }
        output::print(&out);
        Ok(EXIT_OK)
    })
}

/// Sends a ladder that compiles to a control.
fn send(args: &LadderSendArgs) -> Result<u8, CommandError> {
    let (port, baud) = select_port(&args.port)?;
    with_ladder(&args.ladder, |ladder| {
        finish_transfer(send_ladder(&port, baud, ladder.source()).map(|()| {
            output::print_message(&say::ladder_line_sent(&port, ladder.source().len()));
            EXIT_OK
        }))
    })
}

/// Reads the ladder of a control into a file.
fn read(args: &LadderReadArgs) -> Result<u8, CommandError> {
    let (port, baud) = select_port(&args.port)?;
    let list = match read_ladder(&port, baud) {
        Ok(list) => list,
        Err(error) => return finish_transfer(Err(error)),
    };
    let code = write_output(&args.output, &LadderArgs { file: None }, list.as_bytes())?;
    if !output::is_standard_output(Some(&args.output)) {
        output::print_message(&say::ladder_line_received(&port, list.len()));
    }
    Ok(code)
}

/// Converts an error at the line to a message and exit code 1, as `transfer` does.
fn finish_transfer(result: Result<u8, PcError>) -> Result<u8, CommandError> {
    match result.map_err(CommandError::from) {
        Err(CommandError::Files(error)) if error.is_line_error() => {
            output::report_error(&error.message());
            Ok(EXIT_ALARM)
        }
        result => result,
    }
}

fn check(args: &LadderArgs) -> Result<u8, CommandError> {
    let name = ladder_name(args);
    match compile(args.file.as_deref())? {
        Ok(ladder) => {
            let mut out = String::new();
            for warning in ladder.warnings() {
                out.push_str(&(format_finding(&name, warning) + "\n"));
            }
            output::print(&out);
            output::print_message(&say::ladder_list_summary(
                name,
                ladder.rung_count(),
                ladder.steps(),
                ladder.level1_steps(),
                ladder.part_count(),
                ladder.warnings().len(),
            ));
            Ok(EXIT_OK)
        }
        Err(errors) => {
            complain!("{errors}");
            Ok(EXIT_ALARM)
        }
    }
}

fn list(args: &LadderArgs) -> Result<u8, CommandError> {
    match compile(args.file.as_deref())? {
        Ok(ladder) => {
            // The standard ladder is printed with its comments.
            let text = match args.file {
                Some(_) => ladder.to_source(),
                None => STANDARD_LADDER.to_owned(),
            };
            output::print(&text);
            Ok(EXIT_OK)
        }
        Err(errors) => {
            complain!("{errors}");
            Ok(EXIT_ALARM)
        }
    }
}

fn run(args: &LadderRunArgs) -> Result<u8, CommandError> {
    let ladder = match compile(args.file.as_deref())? {
        Ok(ladder) => ladder,
        Err(errors) => {
            complain!("{errors}");
            return Ok(EXIT_ALARM);
        }
    };
    let mut forced_bits = Vec::new();
    for bit in &args.bits {
        forced_bits.push((loading::parse_address(&bit.address)?, bit.state));
    }
    let mut plc = Plc::new(ladder);
    plc.power_on();
    for _ in 0..args.slots {
        for (address, state) in &forced_bits {
            plc.memory_mut().set_bit(*address, *state);
        }
        plc.run_slot();
        if let Some(fault) = plc.fault() {
            output::report_error(&fault.message());
            return Ok(EXIT_ALARM);
        }
    }
    output::print(&format_outputs(&plc));
    Ok(EXIT_OK)
}

/// Formats the outputs that are on and the active messages of the PLC, one per line.
fn format_outputs(plc: &Plc) -> String {
    let mut out = String::new();
    let memory = plc.memory();
    for (area, count, byte) in [
        ('Y', 20u16, &(|byte| memory.y(byte)) as &dyn Fn(u16) -> u8),
        ('G', 256, &|byte| memory.g(byte)),
    ] {
        let on: Vec<String> = (0..count)
            .flat_map(|number| (0..8u8).map(move |bit| (number, bit)))
            .filter(|(number, bit)| byte(*number) >> bit & 1 == 1)
            .map(|(number, bit)| format!("{area}{number}.{bit}"))
            .collect();
        let on = say::ladder_list_on(area, on.join(" "));
        out.push_str(&format!("{}\n", output::localize(&on)));
    }
    for (number, text) in plc.active_messages() {
        let message = say::ladder_list_message(number, text);
        out.push_str(&format!("{}\n", output::localize(&message)));
    }
    out
}
