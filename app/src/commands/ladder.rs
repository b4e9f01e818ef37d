//! `ladder`: compiles, prints and scans an instruction list.

use std::path::Path;
use std::sync::Arc;

use gsk_core::plc::{CompileError, Ladder, Plc};
use gsk_core::setup::{STANDARD_LADDER, standard_ladder};
use gsk_host::files::program_file;
use gsk_host::loading;
use gsk_messages::say;

use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::{LadderArgs, LadderCommand, LadderRunArgs};

pub fn ladder(command: &LadderCommand) -> Result<u8, CommandError> {
    match command {
        LadderCommand::Check(args) => check(args),
        LadderCommand::List(args) => list(args),
        LadderCommand::Run(args) => run(args),
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

fn check(args: &LadderArgs) -> Result<u8, CommandError> {
    let name = args.file.as_ref().map_or_else(
        || output::localize(&say::ladder_list_standard()),
        |path| path.display().to_string(),
    );
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
