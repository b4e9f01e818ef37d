//! `mill`: calculations for the setup of a GSK980MDi.

use std::path::Path;

use gsk_commission::ImportedFile;
use gsk_host::files::overwrite_guard::{CommandInputs, check_overwrites};
use gsk_host::files::program_file;
use gsk_host::loading::LoadError;
use gsk_messages::{Language, Message, say};
use gsk_milling::commissioning::{MillPitchTable, Teeth, backlash_rate, linear_gear, rotary_gear};
use gsk_milling::keys::{KEYS, pressed_keys};
use gsk_milling::machine_tables::{MillTable, MillTableRow};
use gsk_milling::{Length, ParameterValues, describe_reference_returns};
use gsk_runner::report;

use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::{
    GearArgs, HomingArgs, MILL_AXES, MillCommand, MillKeysArgs, MillSearchArgs, PitchArgs,
};

/// Carries out a `mill` command and prints its result; returns the exit code. Returns an error if
/// an option or a file is wrong.
pub fn run_mill_command(
    command: &MillCommand,
    language: Option<Language>,
) -> Result<u8, CommandError> {
    match command {
        MillCommand::Gear(args) => gear(args, language),
        MillCommand::Pitch(args) => pitch(args, language),
        MillCommand::Keys(args) => keys(args, language),
        MillCommand::Homing(args) if args.params.is_some() || !args.values.is_empty() => {
            describe_homing(args, language)
        }
        MillCommand::Homing(_) => {
            let steps = [
                say::mill_homing_absolute(),
                say::mill_homing_d1(),
                say::mill_homing_d2(),
                say::mill_homing_d3(),
                say::mill_homing_d4(),
                say::mill_homing_by_switch(),
                say::mill_homing_ways(),
            ];
            for message in steps {
                print_line(&message, language);
            }
            Ok(EXIT_OK)
        }
        MillCommand::Io(args) => show_table(MillTable::Signals, args, language),
        MillCommand::Diagnosis(args) => show_table(MillTable::Diagnosis, args, language),
        MillCommand::Spindle(args) => show_table(MillTable::Spindle, args, language),
        MillCommand::Reference(args) => show_table(MillTable::ReferenceReturn, args, language),
        MillCommand::Backlash(args) => {
            let rate = backlash_rate(args.bits, args.eighth);
            print_line(&say::mill_backlash(rate), language);
            Ok(EXIT_OK)
        }
    }
}

/// Prints the rows of a table that have the words of the arguments, in columns. Exit code 1 if
/// there are none.
fn show_table(
    table: MillTable,
    args: &MillSearchArgs,
    language: Option<Language>,
) -> Result<u8, CommandError> {
    let text = args.words.join(" ");
    let rows: Vec<&MillTableRow> = table.search(&text).collect();
    if rows.is_empty() {
        let message = report::message_text(&say::mill_table_no_match(text), language);
        complain!("{message}");
        return Ok(EXIT_ALARM);
    }
    let titles: Vec<String> = titles(table)
        .iter()
        .map(|title| report::message_text(title, language))
        .collect();
    let is_chinese = language == Some(Language::Zh);
    let lines = rows.into_iter().map(|row| {
        let cells = row.keys.iter().copied();
        let meaning = if is_chinese { row.zh } else { row.en };
        cells.chain([meaning]).map(str::to_owned).collect()
    });
    let lines: Vec<Vec<String>> = core::iter::once(titles).chain(lines).collect();
    output::print(&format_columns(&lines));
    Ok(EXIT_OK)
}

/// Returns the titles of the columns of a table.
fn titles(table: MillTable) -> Vec<Message> {
    let mut titles = match table {
        MillTable::Signals => vec![
            say::mill_column_connector(),
            say::mill_column_pin(),
            say::mill_column_address(),
            say::mill_column_symbol(),
        ],
        MillTable::Diagnosis => vec![say::mill_column_number(), say::mill_column_symbol()],
        MillTable::Spindle | MillTable::ReferenceReturn => {
            vec![say::mill_column_number(), say::help_chapter_parameters()]
        }
    };
    titles.push(say::mill_column_meaning());
    titles
}

/// Formats rows of cells as columns; a Chinese character is two cells of the terminal wide.
fn format_columns(rows: &[Vec<String>]) -> String {
    let width = |text: &str| text.chars().map(|it| 1 + usize::from(!it.is_ascii())).sum();
    let column_width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| width(cell)).max().unwrap_or(0)
    };
    let count = rows.first().map_or(0, Vec::len);
    let widths: Vec<usize> = (0..count).map(column_width).collect();
    let mut out = String::new();
    for row in rows {
        let mut line = String::new();
        for (cell, column) in row.iter().zip(&widths) {
            let filled = column - width(cell).min(*column);
            line.push_str(cell);
            line.push_str(&" ".repeat(filled + 2));
        }
        out.push_str(line.trim_end());
        out.push('\n');
    }
    out
}

/// Describes how each axis returns to the reference point with the given machine parameters;
/// returns the exit code. Returns an error if a parameter is wrong.
fn describe_homing(args: &HomingArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let mut values = ParameterValues::default();
    if let Some(path) = &args.params {
        let file = program_file::read(path).map_err(LoadError::from)?;
        for (line, text) in (1_u32..).zip(file.text.lines()) {
            let at_line = |rule: Message| {
                let rule = say::pitch_file_line(line, rule);
                mill_value_error(say::pitch_file(path.display(), rule))
            };
            values.parse_line(text).map_err(at_line)?;
        }
    }
    for word in &args.values {
        values.parse_line(word).map_err(mill_value_error)?;
    }
    for message in describe_reference_returns(&values) {
        print_line(&message, language);
    }
    Ok(EXIT_OK)
}

fn mill_value_error(message: Message) -> CommandError {
    LoadError::MillWord(message).into()
}

fn print_line(message: &Message, language: Option<Language>) {
    output::print(&(report::message_text(message, language) + "\n"));
}

fn gear(args: &GearArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let (screw, motor) = args.teeth;
    let teeth = Teeth { screw, motor };
    let gear = match (args.lead, args.pulses) {
        (_, Some(pulses)) => rotary_gear(args.counts, pulses, teeth),
        (lead, None) => {
            let increment = Length::from_mm(args.increment);
            let lead = Length::from_mm(lead.unwrap_or_default());
            linear_gear(args.counts, increment, lead, teeth)
        }
    };
    let found = gear.map_err(mill_value_error)?;
    let ratio = f64::from(found.multiplier) / f64::from(found.divider);
    let message = say::mill_gear(found.multiplier, found.divider, format!("{ratio:.6}"));
    print_line(&message, language);
    Ok(EXIT_OK)
}

fn pitch(args: &PitchArgs, language: Option<Language>) -> Result<u8, CommandError> {
    // Beyond the travel of any axis.
    const MAX_THOUSANDTHS: f64 = 1e12;
    let thousandths = |mm: f64| {
        (mm * 1000.0)
            .round()
            .clamp(-MAX_THOUSANDTHS, MAX_THOUSANDTHS) as i64
    };
    let interval = thousandths(args.interval);
    let table = MillPitchTable::new(args.origin, interval, args.window, &args.values);
    let mut table = table.map_err(mill_value_error)?;
    let (axis, backlash) = match &args.ren {
        Some(path) => add_renishaw_file(&mut table, args, path)?,
        None => (None, None),
    };
    let axis = args.axis.or(axis);
    if let Some(axis) = axis {
        print_line(&say::mill_pitch_axis(axis), language);
    }
    for (number, value) in table.values() {
        let message = say::mill_pitch_row(number, table.label(number), value);
        print_line(&message, language);
    }
    if let Some(backlash) = backlash {
        print_line(&say::mill_pitch_of_file(backlash), language);
    }
    for position in &args.positions {
        let commanded = table.commanded(thousandths(*position));
        print_line(&say::mill_pitch_pulses(position, commanded), language);
    }
    if let Some(turn) = args.turn {
        let end = table
            .end_of_turn(thousandths(turn))
            .map_err(mill_value_error)?;
        print_line(&say::mill_pitch_end(end), language);
    }
    if let Some(path) = &args.export {
        check_export_target(args.ren.as_deref(), path)?;
        let target = output::reserve_file(path)?;
        target.write(to_renishaw_text(&table, axis, interval, backlash).as_bytes())?;
    }
    Ok(EXIT_OK)
}

/// Refuses to overwrite the file from which the table was read.
fn check_export_target(source: Option<&Path>, target: &Path) -> Result<(), CommandError> {
    let inputs = CommandInputs {
        files: source.into_iter().collect(),
        ..CommandInputs::default()
    };
    Ok(check_overwrites(&inputs, &[target])?)
}

/// Adds the values of a Renishaw file to `table`. Returns the axis that the file names and its
/// backlash, 0.001 mm; each is `None` if the file lacks it.
fn add_renishaw_file(
    table: &mut MillPitchTable,
    args: &PitchArgs,
    path: &Path,
) -> Result<(Option<char>, Option<i64>), CommandError> {
    if args.turn.is_some() {
        return Err(mill_value_error(say::pitch_ren_rotary()));
    }
    let file = program_file::read(path).map_err(LoadError::from)?;
    let at_file = |rule: Message| mill_value_error(say::pitch_file(path.display(), rule));
    let imported = gsk_commission::read_measurement_file_with_axes(&file.text, &MILL_AXES);
    let imported = imported.map_err(|fault| at_file(fault.message()))?;
    let ImportedFile::Table(read) = imported else {
        return Err(at_file(say::mill_pitch_measured()));
    };
    let is_other_axis = |axis: &char| args.axis.is_some_and(|wanted| wanted != *axis);
    if let Some(axis) = read.axis.filter(is_other_axis) {
        return Err(at_file(say::pitch_other_axis(axis)));
    }
    let at_line = |line: u32, rule: Message| at_file(say::pitch_file_line(line, rule));
    if let Some((line, spacing)) = read.spacing
        && (spacing.0 - args.interval).abs() > 1e-6
    {
        let rule = say::mill_pitch_spacing(spacing.0, args.interval);
        return Err(at_line(line, rule));
    }
    for row in &read.rows {
        let position = (row.end.0 * 1000.0).round() as i64;
        let to_whole_number = |value: f64| {
            let rounded = value.round();
            let exact = (value - rounded).abs() < 1e-6;
            exact.then_some(rounded as i64)
        };
        let fraction = || at_line(row.line, say::mill_pitch_fraction(row.value.0));
        let value = to_whole_number(row.value.0).ok_or_else(fraction)?;
        // No interval ends at the reference point.
        if position == 0 && value == 0 {
            continue;
        }
        let Some(number) = table.number_at(position) else {
            let rule = match position {
                0 => say::pitch_ren_at_zero(),
                ..0 if !table.has_negative_side() => {
                    say::mill_pitch_negative(row.end.0, args.origin)
                }
                _ => say::pitch_ren_off_grid(row.end.0),
            };
            return Err(at_line(row.line, rule));
        };
        let added = table.add(number, value);
        added.map_err(|rule| at_line(row.line, rule))?;
    }
    let backlash = read.backlash.map(|(_, backlash)| backlash.0.round() as i64);
    Ok((read.axis, backlash))
}

fn to_renishaw_text(
    table: &MillPitchTable,
    axis: Option<char>,
    interval: i64,
    backlash: Option<i64>,
) -> String {
    let rows: Vec<_> = table.values().collect();
    let mm = |thousandths: i64| thousandths as f64 / 1000.0;
    let mut out = String::new();
    if let Some(axis) = axis {
        out.push_str(&format!("axis: {axis}\n"));
    }
    out += &format!("spacing: {:.3}\npoints: {}\n", mm(interval), rows.len());
    if let Some(backlash) = backlash {
        out.push_str(&format!("backlash: {backlash}\n"));
    }
    for (number, value) in rows {
        let end = mm(table.end_of(number));
        out.push_str(&format!("{number} {end:.3} {value}\n"));
    }
    out
}

fn keys(args: &MillKeysArgs, language: Option<Language>) -> Result<u8, CommandError> {
    if args.shown.is_empty() {
        for (number, keys) in KEYS {
            let message = say::mill_keys_pressed(format!("{number:03}"), keys.join("  "));
            print_line(&message, language);
        }
        return Ok(EXIT_OK);
    }
    for (number, bits) in &args.shown {
        let number_text = format!("{number:03}");
        let keys = pressed_keys(*number, *bits);
        let keys = keys.ok_or_else(|| mill_value_error(say::mill_keys_number(&number_text)))?;
        let message = match keys.is_empty() {
            true => say::mill_keys_none(number_text),
            false => say::mill_keys_pressed(number_text, keys.join("  ")),
        };
        print_line(&message, language);
    }
    Ok(EXIT_OK)
}
