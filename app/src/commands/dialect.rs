//! `dialect`: compares how two control models read a program.

use gsk_host::files::overwrite_guard::{CommandInputs, check_overwrites};
use gsk_host::files::{decode, program_file};
use gsk_messages::{Language, Message, say};
use gsk_runner::{dialect, report};

use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::DialectArgs;

/// Lists the blocks that the other model reads differently. With `--output` it writes the
/// program for the other model and lists only the remaining differences. Exit code 1 if
/// there are any.
pub fn dialect(args: &DialectArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let file = program_file::read(&args.file)?;
    let (from, to) = (args.from.record(), args.to.record());
    let mut findings = dialect::compare_models(&file.text, from, to);
    if let Some(path) = &args.output {
        let inputs = CommandInputs {
            files: vec![&args.file],
            ..CommandInputs::default()
        };
        check_overwrites(&inputs, &[path])?;
        let rewritten = dialect::rewrite_program(&file.text, from, to);
        let target = output::reserve_file(path)?;
        target.write(&decode::encode(&rewritten, file.encoding))?;
        findings.retain(|finding| !finding.is_rewritten());
    }
    let localize = |message: &Message| report::message_text(message, language);
    let mut out = String::new();
    for finding in &findings {
        let text = localize(&finding.text(from, to));
        let name = args.file.display().to_string();
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
    Ok(if findings.is_empty() {
        EXIT_OK
    } else {
        EXIT_ALARM
    })
}
