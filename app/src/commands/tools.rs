//! `tools`: the tool library.

use std::path::Path;

use gsk_core::preview::PreviewProgress;
use gsk_host::files::overwrite_guard::{CommandInputs, check_overwrites};
use gsk_host::files::tool_library::{self, ToolMinutes};
use gsk_host::files::tool_tables::{self, ToolTableFormat};
use gsk_host::job::{self, JobArgs};
use gsk_host::loading;
use gsk_messages::{Language, Message, say};
use gsk_runner::curves::RapidRates;
use gsk_runner::report;
use gsk_runner::text_format::short_description;
use gsk_tooling::{LibraryTool, ToolLibrary, ToolLife, tool_description};
use gsk_workpiece::tool::Insert;

use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::{
    ToolsAddArgs, ToolsCommand, ToolsCountArgs, ToolsDataArgs, ToolsFileArgs, ToolsLifeArgs,
    ToolsListArgs, ToolsShowArgs,
};

/// Executes a command about the tool library and returns its exit code.
pub fn tools(command: &ToolsCommand, language: Option<Language>) -> Result<u8, CommandError> {
    match command {
        ToolsCommand::List(args) => list(args, language),
        ToolsCommand::Show(args) => show(args, language),
        ToolsCommand::Add(args) => add(args),
        ToolsCommand::Remove(args) => {
            select_data(&args.data);
            tool_library::change(|library| {
                let removed = library.tools.remove(&args.id);
                removed.ok_or_else(|| say::tool_not_in_library(&args.id))
            })?;
            output::print_message(&say::tool_removed(&args.id));
            Ok(EXIT_OK)
        }
        ToolsCommand::Import(args) => import(args),
        ToolsCommand::Export(args) => export(args),
        ToolsCommand::Life(args) => life(args, language),
        ToolsCommand::Count(args) => count(args, language),
    }
}

fn select_data(data: &ToolsDataArgs) {
    if let Some(path) = &data.data {
        tool_library::set_data_folder(path);
    }
}

fn list(args: &ToolsListArgs, language: Option<Language>) -> Result<u8, CommandError> {
    select_data(&args.data);
    let library = tool_library::read()?;
    let wanted = args.text.as_deref().unwrap_or_default();
    let tools = library.tools.iter();
    let lines = tools
        .filter(|(id, tool)| tool.matches(id, wanted))
        .map(|(id, tool)| {
            let station = tool
                .station
                .map_or_else(String::new, |it| format!("T{it:02}"));
            let kind = report::message_text(&short_description(&tool.tool), language);
            let description = tool.description();
            let life = tool.life.as_ref().map(life_message);
            let life = life.map_or_else(String::new, |it| report::message_text(&it, language));
            let name = &tool.name;
            format!("{id}\t{station}\t{kind}\t{description}\t{name}\t{life}\n")
        });
    output::print(&lines.collect::<String>());
    Ok(EXIT_OK)
}

fn life_message(life: &ToolLife) -> Message {
    let (used, minutes) = (format!("{:.1}", life.used_minutes), life.minutes);
    say::tool_life_left(life.edge, life.edges, used, minutes)
}

fn show(args: &ToolsShowArgs, language: Option<Language>) -> Result<u8, CommandError> {
    select_data(&args.data);
    let text = args.description.join(" ");
    let known = tool_library::read()?.tools.remove(&text);
    let tool = match known {
        Some(tool) => tool,
        None => LibraryTool::from_description(&text)?,
    };
    let kind = report::message_text(&short_description(&tool.tool), language);
    let edge = match tool.tool.insert {
        Insert::Turning { letter, size, .. } => {
            format!(" edge={:.2}", letter.edge_length_mm(size))
        }
        _ => String::new(),
    };
    output::print(&format!("{kind}\n{}{edge}\n", tool_description(&tool.tool)));
    Ok(EXIT_OK)
}

fn add(args: &ToolsAddArgs) -> Result<u8, CommandError> {
    select_data(&args.data);
    let mut tool = LibraryTool::from_description(&args.description.join(" "))?;
    tool.name.clone_from(&args.name);
    tool.station = args.station;
    tool.life = args.life.map(|minutes| ToolLife::new(minutes, args.edges));
    let description = tool.description();
    let id = tool_library::change(|library| {
        let id = match &args.id {
            Some(id) if library.tools.contains_key(id) && !args.replace => {
                return Err(say::tool_exists(id));
            }
            Some(id) => id.clone(),
            None => library.free_id(&tool.code),
        };
        library.insert(&id, tool)?;
        Ok(id)
    })?;
    output::print_message(&say::tool_added(id, description));
    Ok(EXIT_OK)
}

/// The format of a table that is read or written; `by_name` finds it by the ending.
fn format_of(
    args: &ToolsFileArgs,
    by_name: fn(&Path) -> Option<ToolTableFormat>,
) -> Result<ToolTableFormat, Message> {
    let given = args.format.map(ToolTableFormat::from);
    given
        .or_else(|| by_name(&args.file))
        .ok_or_else(|| say::tool_format_unknown(args.file.display()))
}

fn import(args: &ToolsFileArgs) -> Result<u8, CommandError> {
    select_data(&args.data);
    let unit_mm = if args.inch { 25.4 } else { 1.0 };
    let imported = tool_tables::import(
        &args.file,
        format_of(args, ToolTableFormat::from_input_path)?,
        unit_mm,
    )?;
    for note in &imported.notes {
        output::report_error(note);
    }
    let has_refused = imported.tools.is_empty() && !imported.notes.is_empty();
    let replaces = args.replace;
    let count =
        tool_library::change(|library| tool_tables::add_imported(library, imported, replaces))?;
    output::print_message(&say::tool_import_done(count));
    Ok(if has_refused { EXIT_ALARM } else { EXIT_OK })
}

fn export(args: &ToolsFileArgs) -> Result<u8, CommandError> {
    select_data(&args.data);
    let format = format_of(args, ToolTableFormat::from_path)?;
    let library = tool_library::read()?;
    let text = tool_tables::table_text(&library, format);
    if let Some(text) = text.filter(|_| output::is_standard_output(Some(&args.file))) {
        output::print(&text);
        return Ok(EXIT_OK);
    }
    let path = tool_library::library_path()?;
    let inputs = CommandInputs {
        files: vec![path.as_path()],
        ..CommandInputs::default()
    };
    check_overwrites(&inputs, &[args.file.as_path()])?;
    tool_tables::export(&library, &args.file, format)?;
    Ok(EXIT_OK)
}

fn life(args: &ToolsLifeArgs, language: Option<Language>) -> Result<u8, CommandError> {
    select_data(&args.data);
    let Some(id) = &args.id else {
        let library = tool_library::read()?;
        let lines = library
            .tools
            .iter()
            .map(|(id, tool)| life_line(id, tool, language));
        output::print(&lines.collect::<String>());
        let is_worn = |tool: &LibraryTool| tool.life.is_some_and(|it| it.is_used_up());
        let any_worn = library.tools.values().any(is_worn);
        return Ok(if any_worn { EXIT_ALARM } else { EXIT_OK });
    };
    let is_change = args.minutes.is_some() || args.edges.is_some() || args.add.is_some();
    let change = |library: &mut ToolLibrary| {
        let known = library.tools.get(id);
        let mut tool = known.cloned().ok_or_else(|| say::tool_not_in_library(id))?;
        let mut life = tool.life.unwrap_or(ToolLife::new(15.0, 1));
        life.minutes = args.minutes.unwrap_or(life.minutes);
        life.edges = args.edges.unwrap_or(life.edges);
        life.edge = life.edge.min(life.edges);
        life.add_minutes(args.add.unwrap_or(0.0));
        if args.next_edge {
            life.turn_edge();
        }
        tool.life = Some(life);
        library.insert(id, tool.clone())?;
        Ok(tool)
    };
    let tool = if is_change || args.next_edge {
        tool_library::change(change)?
    } else {
        let mut library = tool_library::read()?;
        let tool = library.tools.remove(id);
        tool.ok_or_else(|| say::tool_not_in_library(id))?
    };
    output::print(&life_line(id, &tool, language));
    Ok(EXIT_OK)
}

fn life_line(id: &str, tool: &LibraryTool, language: Option<Language>) -> String {
    let life = tool
        .life
        .as_ref()
        .map_or_else(say::tool_life_none, life_message);
    format!("{id}\t{}\n", report::message_text(&life, language))
}

/// Cuts the part of a program and prints the minutes in the cut of each tool.
fn count(args: &ToolsCountArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let mut setup = loading::command_setup(&args.setup, None, language)?;
    loading::open_program(&mut setup, core::slice::from_ref(&args.file))?.print(language);
    let job_args = JobArgs {
        part: true,
        job: args.job.clone(),
    };
    let job_choice = job::choose(&job_args, Some(Path::new(&args.file)), &setup)?;
    let _ = job_choice.set_work_zero(&mut setup);
    let mut machining = job_choice.create_machining();
    let rates = RapidRates::from_memory(&setup.memory);
    let mut should_continue = |_: &PreviewProgress| true;
    let name = args.file.display().to_string();
    let mut on_move = |executed: &_| machining.execute_move(executed, rates);
    report::check_program(&name, &setup, language, &mut on_move, &mut should_continue);
    let library = tool_library::read()?;
    let mut spent = Vec::new();
    for (number, cutting) in machining.cutting() {
        let minutes = cutting.seconds / 60.0;
        let id = job_choice.job.library.get(number);
        let life = id.and_then(|id| library.tools.get(id)?.life);
        let parts = life.map_or_else(String::new, |life| {
            let parts = (life.minutes / minutes.max(1e-6)).floor().min(1e6);
            report::message_text(&say::tool_life_parts(parts), language)
        });
        let id = id.map_or("", String::as_str);
        output::print(&format!("T{number:02}\t{id}\t{minutes:.3} min\t{parts}\n"));
        if !id.is_empty() {
            spent.push(ToolMinutes {
                number: *number,
                id: id.to_owned(),
                minutes: minutes * f64::from(args.parts.unwrap_or(0)),
            });
        }
    }
    if args.parts.is_none() {
        return Ok(EXIT_OK);
    }
    let worn = tool_library::add_minutes(&spent)?;
    for message in &worn {
        output::report_error(message);
    }
    Ok(if worn.is_empty() { EXIT_OK } else { EXIT_ALARM })
}
