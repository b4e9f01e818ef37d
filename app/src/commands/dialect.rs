//! `dialect`: compares how two control models read a program, or ports a program of another
//! control.

use std::path::Path;

use gsk_core::model::ModelId;
use gsk_core::setup::Setup;
use gsk_host::files::overwrite_guard::{CommandInputs, check_overwrites};
use gsk_host::files::{decode, program_file, subprograms};
use gsk_host::loading;
use gsk_messages::{Language, Message, say};
use gsk_port::{
    ForeignDialect, MachineNeeds, PortFinding, PortOptions, PortedProgram, code_table, port_program,
};
use gsk_runner::report::ProgramReport;
use gsk_runner::{dialect, report};
use serde::Serialize;

use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::{DialectArgs, ProgramOrigin};

/// Parameter with the number of tool stations.
const TOOL_STATIONS: u16 = 84;
/// Parameter with the equipment of the control, and its bit for nose radius compensation.
const EQUIPMENT: u16 = 2;
const NOSE_COMPENSATION: i32 = 1 << 1;

/// Compares two models, or ports a program of another control; with `--codes` prints the table
/// of foreign codes. Exit code 1 if differences or refusals remain, or the check of the ported
/// program ends with an alarm.
pub fn dialect(args: &DialectArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let (Some(file), Some(origin)) = (&args.file, args.from) else {
        output::print(&code_table(language.unwrap_or(Language::En)));
        return Ok(EXIT_OK);
    };
    match (origin, args.to) {
        (ProgramOrigin::Foreign(foreign), None | Some(ModelId::Gsk980td)) => {
            port_file(args, file, foreign, language)
        }
        (ProgramOrigin::Foreign(foreign), Some(_)) => {
            Err(say::ported_to_not_needed(foreign.name()).into())
        }
        (ProgramOrigin::Model(from), Some(to)) => compare(args, file, (from, to), language),
        (ProgramOrigin::Model(from), None) => {
            Err(say::ported_to_needed(from.command_word()).into())
        }
    }
}

/// Lists the blocks that the other model reads differently. With `--output` it writes the
/// program for the other model and lists only the remaining differences.
fn compare(
    args: &DialectArgs,
    path: &Path,
    (from, to): (ModelId, ModelId),
    language: Option<Language>,
) -> Result<u8, CommandError> {
    let file = program_file::read(path)?;
    let (from, to) = (from.record(), to.record());
    let mut findings = dialect::compare_models(&file.text, from, to);
    if let Some(target) = &args.output {
        let rewritten = dialect::rewrite_program(&file.text, from, to);
        write_program(path, target, &decode::encode(&rewritten, file.encoding))?;
        findings.retain(|finding| !finding.is_rewritten());
    }
    let localize = |message: &Message| report::message_text(message, language);
    let mut out = String::new();
    for finding in &findings {
        let text = localize(&finding.text(from, to));
        let name = path.display().to_string();
        out.push_str(&format!("{name}:{}: {text}\n", finding.line));
    }
    if from.program_name != to.program_name {
        let names =
            say::dialect_names(from.name(), &from.program_name, to.name(), &to.program_name);
        out.push_str(&format!("{}\n", localize(&names)));
    }
    if findings.is_empty() {
        out.push_str(&format!("{}\n", localize(&say::dialect_same(to.name()))));
    }
    output::print(&out);
    Ok(match findings.is_empty() {
        true => EXIT_OK,
        false => EXIT_ALARM,
    })
}

/// Writes a program into a file that is not one of the inputs.
fn write_program(input: &Path, target: &Path, bytes: &[u8]) -> Result<(), CommandError> {
    let input = input.to_owned();
    let inputs = CommandInputs {
        files: vec![&input],
        ..CommandInputs::default()
    };
    check_overwrites(&inputs, &[target])?;
    output::reserve_file(target)?.write(bytes)?;
    Ok(())
}

/// The result of porting a program, as JSON.
#[derive(Serialize)]
struct PortReport<'a> {
    file: String,
    from: &'static str,
    /// Whether every block has an equivalent.
    complete: bool,
    findings: Vec<PortFindingLine>,
    /// Equipment that the program needs beyond the lathe as delivered; the check assumes it.
    needs: Vec<String>,
    /// The ported program; absent if it was written into a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    text: Option<&'a str>,
    /// The result of checking the ported program.
    check: &'a ProgramReport,
}

/// A finding of the port, as JSON.
#[derive(Serialize)]
struct PortFindingLine {
    line: u32,
    word: String,
    refused: bool,
    text: String,
}

/// Ports a program, checks the result, and prints it or writes it into the output file.
fn port_file(
    args: &DialectArgs,
    path: &Path,
    from: ForeignDialect,
    language: Option<Language>,
) -> Result<u8, CommandError> {
    let file = program_file::read(path)?;
    let options = PortOptions {
        plain_numbers: args.numbers,
        starts_in_inches: args.inch,
    };
    let ported = port_program(&file.text, from, options);
    if let Some(target) = &args.output {
        write_program(path, target, &decode::encode(&ported.text, file.encoding))?;
    }
    let checked_path = args.output.as_deref().unwrap_or(path);
    let mut setup = loading::with_training_lathe(Setup::default(), None);
    let needs = fit_lathe(&mut setup, ported.machine_needs());
    let check = check_ported(&ported, setup, checked_path, language)?;
    let complete = ported.is_complete();
    if args.json {
        let result = PortReport {
            file: path.display().to_string(),
            from: from.command_word(),
            complete,
            findings: (ported.findings.iter())
                .map(|finding| finding_line(finding, language))
                .collect(),
            needs: (needs.iter())
                .map(|need| report::message_text(need, language))
                .collect(),
            text: args.output.is_none().then_some(ported.text.as_str()),
            check: &check,
        };
        output::print(&format!("{}\n", serde_json::to_string(&result)?));
    } else {
        print_port(args, path, (&ported, &needs), &check, language);
    }
    Ok(match complete && !check.has_failed() {
        true => EXIT_OK,
        false => EXIT_ALARM,
    })
}

fn finding_line(finding: &PortFinding, language: Option<Language>) -> PortFindingLine {
    PortFindingLine {
        line: finding.line,
        word: finding.word.clone(),
        refused: finding.is_refused,
        text: report::message_text(&finding.message(), language),
    }
}

/// Prints the findings and the check; without an output file the program goes to standard
/// output and they go to standard error.
fn print_port(
    args: &DialectArgs,
    path: &Path,
    (ported, needs): (&PortedProgram, &[Message]),
    check: &ProgramReport,
    language: Option<Language>,
) {
    let localize = |message: &Message| report::message_text(message, language);
    let name = path.display().to_string();
    let mut out = String::new();
    for finding in &ported.findings {
        let text = localize(&finding.message());
        out.push_str(&format!("{name}:{}: {text}\n", finding.line));
    }
    let refused = ported.findings.iter().filter(|it| it.is_refused).count();
    let summary = match refused {
        0 => say::ported_complete(ported.findings.len()),
        _ => say::ported_incomplete(refused),
    };
    for message in core::iter::once(&summary).chain(needs) {
        out.push_str(&format!("{}\n", localize(message)));
    }
    out.push_str(&check.to_text(language));
    let to_stderr = args.output.is_none();
    if to_stderr {
        output::print(&ported.text);
    }
    output::print_or_report(&out, to_stderr);
}

/// Gives the lathe the equipment that a ported program needs, and returns a message for each
/// piece that the lathe as delivered lacks.
fn fit_lathe(setup: &mut Setup, needs: MachineNeeds) -> Vec<Message> {
    let parameters = &mut setup.memory.parameters;
    let mut messages = Vec::new();
    let stations = i64::from(parameters.value(TOOL_STATIONS));
    if needs.tool_stations > stations
        && let Ok(number) = i32::try_from(needs.tool_stations)
        && parameters.set(TOOL_STATIONS, number).is_ok()
    {
        messages.push(say::ported_needs_stations(needs.tool_stations, stations));
    }
    let equipment = parameters.value(EQUIPMENT);
    if needs.nose_compensation
        && equipment & NOSE_COMPENSATION == 0
        && parameters
            .set(EQUIPMENT, equipment | NOSE_COMPENSATION)
            .is_ok()
    {
        messages.push(say::ported_needs_compensation());
    }
    messages
}

/// Checks a ported program on a lathe. Its subprograms may be in the folder of `path`.
fn check_ported(
    ported: &PortedProgram,
    mut setup: Setup,
    path: &Path,
    language: Option<Language>,
) -> Result<ProgramReport, CommandError> {
    let model = setup.memory.model.clone();
    let find = |calls, loaded: &_| subprograms::find_called(path, calls, loaded, &model);
    loading::open_text(&mut setup, path, ported.text.clone(), find)?;
    let name = path.display().to_string();
    Ok(report::check_program(
        &name,
        &setup,
        language,
        &mut |_| {},
        &mut |_| true,
    ))
}
