//! `form`: writes blocks from the dimensions of a drawing, and reads forms from a program.

use std::path::Path;

use gsk_forms::{
    FieldInput, FormError, FormKind, FormValues, find_sections, form_job, thread_table_text,
    whole_program, write_form,
};
use gsk_host::files::overwrite_guard::{CommandInputs, check_overwrites};
use gsk_host::files::program_file;
use gsk_host::files::tool_library;
use gsk_host::job;
use gsk_messages::{Language, Message, say};
use gsk_runner::report;
use gsk_tooling::LibraryTool;
use gsk_workpiece::cutting::CuttingMaterial;
use gsk_workpiece::job::Job;

use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::FormArgs;

/// Lists forms, fields or threads, reads the forms of a program, or writes a form. Exit code 1
/// if a form that was read cannot be used again.
pub fn form(args: &FormArgs, language: Option<Language>) -> Result<u8, CommandError> {
    if args.threads {
        output::print(&thread_table_text());
        return Ok(EXIT_OK);
    }
    if let Some(path) = &args.read {
        return read(path, language);
    }
    let Some(form) = args.name else {
        output::print(&list(language));
        return Ok(EXIT_OK);
    };
    let values = fill_in(form, args)?;
    if args.fields {
        output::print(&fields(&values, language));
        return Ok(EXIT_OK);
    }
    let section = write_form(&values).map_err(|error| error.message())?;
    let program = whole_program(args.number, &section);
    match &args.output {
        None if args.blocks => output::print(&section),
        None => output::print(&program),
        Some(path) => write(
            path,
            &program,
            &form_job_with_tool(&values, args.tool.as_deref())?,
        )?,
    }
    Ok(EXIT_OK)
}

/// The form with starting values for a material, a tool of the library and the values of the
/// options.
fn fill_in(form: FormKind, args: &FormArgs) -> Result<FormValues, CommandError> {
    let mut values = FormValues::new(form);
    if let Some(path) = &args.data {
        tool_library::set_data_folder(path);
    }
    if let Some(name) = &args.material {
        let material = CuttingMaterial::from_name(name);
        let material = material.ok_or_else(|| say::stock_unknown_grade(name))?;
        let proposed = values.propose(&material);
        if !proposed.map_err(|error: FormError| error.message())? {
            return Err(say::form_no_proposal(material.name).into());
        }
    }
    if let Some(id) = &args.tool {
        let tool = library_tool(id)?;
        if !values.take_tool(&tool.tool, tool.station) {
            return Err(say::tool_unusable_by_form(id).into());
        }
    }
    for option in &args.values {
        let pair = option.split_once('=');
        let (id, text) = pair.ok_or_else(|| say::form_word_unreadable(option))?;
        values
            .set_text(id, text)
            .map_err(|error: FormError| error.message())?;
    }
    Ok(values)
}

fn library_tool(id: &str) -> Result<LibraryTool, Message> {
    let known = tool_library::read()?.tools.remove(id);
    known.ok_or_else(|| say::tool_not_in_library(id))
}

/// Stock and tool of the form; the tool is that of the library if the form takes one from it.
fn form_job_with_tool(values: &FormValues, id: Option<&str>) -> Result<Job, Message> {
    let mut job = form_job(values);
    if let (Some(id), Some(number)) = (id, job.tools.keys().next().copied()) {
        job.tools.insert(number, library_tool(id)?.tool);
        job.library.insert(number, id.to_owned());
    }
    Ok(job)
}

/// Writes the program, and the job with stock and tool beside it.
fn write(path: &Path, program: &str, form_job: &Job) -> Result<(), CommandError> {
    let job_path = job::job_path(path);
    check_overwrites(&CommandInputs::default(), &[path, &job_path])?;
    output::reserve_file(path)?.write(program.as_bytes())?;
    job::write(&job_path, form_job)?;
    Ok(())
}

fn list(language: Option<Language>) -> String {
    let localize = |message: &Message| report::message_text(message, language);
    let lines = FormKind::ALL.into_iter().map(|form| {
        let word = form.word();
        let (name, purpose) = (localize(&form.name()), localize(&form.purpose()));
        format!("{word}\t{name}\t{purpose}\n")
    });
    lines.collect()
}

/// A line for each field: id, value, unit, range or options, name, meaning.
fn fields(values: &FormValues, language: Option<Language>) -> String {
    let localize = |message: &Message| report::message_text(message, language);
    let lines = values.shown_fields().map(|field| {
        let (unit, range) = match &field.input {
            FieldInput::Number { unit, range, .. } => {
                (values.unit_sign(*unit), format!("{}..{}", range.0, range.1))
            }
            FieldInput::Choice { options, .. } => {
                let words: Vec<&str> = options.iter().map(|it| it.word).collect();
                ("", words.join("|"))
            }
            FieldInput::Thread { .. } => ("", "form --threads".to_owned()),
            FieldInput::Outline { .. } => ("mm", "X Z L A CW CCW T R C".to_owned()),
        };
        let (name, tip) = (localize(&(field.name)()), localize(&(field.tip)()));
        let value = values.text(field);
        format!("{}\t{value}\t{unit}\t{range}\t{name}\t{tip}\n", field.id)
    });
    lines.collect()
}

/// Lists the forms of a program: line, form and values.
fn read(path: &Path, language: Option<Language>) -> Result<u8, CommandError> {
    let file = program_file::read(path)?;
    let sections = find_sections(&file.text);
    let localize = |message: &Message| report::message_text(message, language);
    let name = path.display().to_string();
    let mut out = String::new();
    let mut is_usable = true;
    for section in &sections {
        let line = section.lines.start + 1;
        let text = match &section.values {
            Ok(values) => {
                let words = values.shown_fields();
                let words = words.map(|field| format!(" {}={}", field.id, values.text(field)));
                format!("{}{}", values.form().word(), words.collect::<String>())
            }
            Err(error) => localize(&error.message()),
        };
        out.push_str(&format!("{name}:{line}: {text}\n"));
        if section.is_edited {
            let edited = localize(&say::form_edited());
            out.push_str(&format!("{name}:{line}: {edited}\n"));
        }
        is_usable &= section.values.is_ok() && !section.is_edited;
    }
    if sections.is_empty() {
        out.push_str(&format!("{name}: {}\n", localize(&say::form_none())));
    }
    output::print(&out);
    Ok(match is_usable {
        true => EXIT_OK,
        false => EXIT_ALARM,
    })
}
