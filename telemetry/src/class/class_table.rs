//! The seats of a class as a table of text.

use core::fmt::Write;

use gsk_messages::{Language, say};

use super::class_roster::{ClassRoster, ClassSeat};

/// Widths of the columns but the last one, columns of a terminal.
const WIDTHS: [usize; 5] = [18, 16, 12, 20, 8];

/// Writes the seats of a class, the most urgent first.
pub fn write_table(roster: &ClassRoster, language: Language) -> String {
    let (online, seats) = roster.count();
    let mut text = say::class_seats(online, seats).text(language);
    text.push('\n');
    let heading = [
        say::class_column_seat(),
        say::class_column_state(),
        say::class_column_program(),
        say::class_column_task(),
        say::class_column_points(),
        say::class_column_alarm(),
    ];
    push_row(&mut text, &heading.map(|message| message.text(language)));
    for seat in roster.by_urgency() {
        push_row(&mut text, &cells(seat, language));
    }
    text
}

fn cells(seat: &ClassSeat, language: Language) -> [String; 6] {
    let report = &seat.report;
    let trouble = report.trouble.as_ref();
    [
        report.name.clone(),
        seat.state_message().text(language),
        program_text(seat),
        task_text(seat, language),
        report.points.to_string(),
        trouble.map_or_else(String::new, |it| it.text.text(language).to_owned()),
    ]
}

/// The selected program with the line in execution.
pub fn program_text(seat: &ClassSeat) -> String {
    let report = &seat.report;
    match (&report.program, report.line) {
        (Some(program), Some(line)) if report.is_running => format!("{program}:{line}"),
        (Some(program), _) => program.clone(),
        (None, _) => String::new(),
    }
}

/// The lesson with its step, or the exercise with the time left.
pub fn task_text(seat: &ClassSeat, language: Language) -> String {
    let Some(task) = &seat.report.task else {
        return String::new();
    };
    let title = match task.title.text(language) {
        "" => &task.id,
        title => title,
    };
    match (task.step, task.remaining_min) {
        (Some(step), _) => format!("{title} {step}"),
        (None, Some(minutes)) if !task.is_handed_in => format!("{title} {minutes}'"),
        _ => title.to_owned(),
    }
}

fn push_row(text: &mut String, cells: &[String; 6]) {
    for (cell, width) in cells.iter().zip(WIDTHS) {
        push_cell(text, cell, width);
    }
    let _ = writeln!(text, "{}", cells[5].trim_end());
}

/// Writes a cell; a Chinese character takes two columns.
fn push_cell(text: &mut String, cell: &str, width: usize) {
    let mut used = 0;
    for character in cell.chars() {
        let columns = if character.is_ascii() { 1 } else { 2 };
        if used + columns > width - 1 {
            break;
        }
        text.push(character);
        used += columns;
    }
    text.extend(core::iter::repeat_n(' ', width - used));
}
