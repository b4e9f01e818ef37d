//! `exercise drawing` and `exercise outline`: the drawing of a task, and the outline it is made from.

use std::path::Path;

use gsk_exercise::drawing::{draw_task, write_svg};
use gsk_exercise::outline_writer::write_outline;
use gsk_host::files::exercises;
use gsk_messages::{Language, Message, say};

use super::super::{CommandError, EXIT_OK, output};
use crate::cli::ExerciseDrawingArgs;

/// Width of the drawing, pixels.
const WIDTH: f64 = 900.0;
/// Height of the texts in the drawing, pixels.
const TEXT_HEIGHT: f64 = 16.0;

/// Draws the part of a task.
///
/// # Errors
/// The task is unknown or has no outline, or the file cannot be written.
pub fn draw(args: &ExerciseDrawingArgs, language: Language) -> Result<u8, CommandError> {
    let task = exercises::find(&args.task, args.data.as_deref())?;
    let drawing = draw_task(&task, WIDTH, TEXT_HEIGHT);
    let drawing = drawing.ok_or_else(|| say::exercise_drawing_none(&task.id))?;
    let svg = write_svg(&drawing, &task.title.in_language(language));
    output::reserve_file(&args.output)?.write(svg.as_bytes())?;
    Ok(EXIT_OK)
}

/// Prints the outline of the part that the reference solution of a task makes.
///
/// # Errors
/// A file cannot be read, the solution fails, or it makes no part.
pub fn print_outline(path: &Path) -> Result<u8, CommandError> {
    let task = exercises::read(path)?;
    let solutions = exercises::read_solutions(path)?;
    let reference = solutions.iter().find(|it| it.is_reference());
    let reference = reference.ok_or_else(say::exercise_no_reference)?;
    let in_file = |message: Message| say::subject_reason(&reference.name, message);
    let part = reference.make_part(&task).map_err(in_file)?;
    let part = part.ok_or_else(say::exercise_outline_no_part)?;
    output::print(&write_outline(&part));
    Ok(EXIT_OK)
}
