//! `outline`: writes the program that turns the outline of a drawing.

use std::path::Path;

use gsk_host::files::overwrite_guard::{CommandInputs, check_overwrites};
use gsk_host::files::program_file;
use gsk_host::loading;
use gsk_messages::{Language, Message, say};
use gsk_outline::{
    OutlineFormat, ProfileOptions, ProfilePiece, ProgramOptions, TurnedProfile, read_drawing,
};
use gsk_runner::report::{self, ProgramReport};
use serde::Serialize;

use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::OutlineArgs;

/// An outline with its program as JSON.
#[derive(Serialize)]
struct OutlineReport {
    file: String,
    /// The pieces from right to left.
    outline: Vec<OutlinePieceLine>,
    notes: Vec<String>,
    text: String,
}

/// A line or an arc of an outline as JSON: ends with X as a diameter, mm.
#[derive(Serialize)]
struct OutlinePieceLine {
    from: (f64, f64),
    to: (f64, f64),
    /// The centre with X as a diameter, and the radius; absent for a line.
    #[serde(skip_serializing_if = "Option::is_none")]
    arc: Option<(f64, f64, f64)>,
    /// The tangent of a quarter of the angle; positive is counter-clockwise (G03).
    bulge: f64,
}

impl OutlinePieceLine {
    fn new(piece: &ProfilePiece) -> Self {
        let center = piece.center();
        Self {
            from: (piece.start.x * 2.0, piece.start.z),
            to: (piece.end.x * 2.0, piece.end.z),
            arc: center.map(|center| (center.x * 2.0, center.z, piece.radius())),
            bulge: piece.bulge,
        }
    }
}

/// Writes the program of an outline, checks a whole program, and prints what was assumed.
/// Exit code 1 if the program ends with an alarm.
///
/// # Errors
/// The drawing is refused, or a file cannot be read or written.
pub fn outline(args: &OutlineArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let file = args.file.display().to_string();
    let in_file = |message: Message| say::subject_reason(&file, message);
    let bytes = program_file::read_bytes(&args.file)?;
    let drawing = read_drawing(&bytes).map_err(in_file)?;
    let options = ProfileOptions {
        layers: args.layer.clone(),
        zero: args.zero,
        unit: args.unit,
        gap: args.gap.clamp(0.0, 10.0),
    };
    let profile = drawing.find_profile(&options).map_err(in_file)?;
    let name = args.file.file_name().map(|name| name.to_string_lossy());
    let format = OutlineFormat::from(args.format);
    let program = ProgramOptions {
        format,
        stock: args.stock,
        insert: args.insert,
        name: name.unwrap_or_default().into_owned(),
        language: language.unwrap_or(Language::En),
        ..ProgramOptions::default()
    };
    let text = profile.write_program(&program).map_err(in_file)?;
    if let Some(target) = &args.output {
        let inputs = CommandInputs {
            files: vec![&args.file],
            ..CommandInputs::default()
        };
        check_overwrites(&inputs, &[target])?;
        output::reserve_file(target)?.write(text.as_bytes())?;
    }
    let check = match format {
        OutlineFormat::G71 => {
            let path = args.output.as_deref().unwrap_or(&args.file);
            Some(check_text(&text, path, language)?)
        }
        OutlineFormat::Contour => None,
    };
    print_outline(args, &profile, text, check.as_ref(), language)?;
    Ok(match check.is_some_and(|check| check.has_failed()) {
        true => EXIT_ALARM,
        false => EXIT_OK,
    })
}

/// Prints the program unless it went to a file, and the notes and the check beside it.
fn print_outline(
    args: &OutlineArgs,
    profile: &TurnedProfile,
    text: String,
    check: Option<&ProgramReport>,
    language: Option<Language>,
) -> Result<(), CommandError> {
    let notes = profile.notes.iter();
    let notes: Vec<String> = notes
        .map(|note| report::message_text(note, language))
        .collect();
    if args.json {
        let result = OutlineReport {
            file: args.file.display().to_string(),
            outline: profile.pieces().map(OutlinePieceLine::new).collect(),
            notes,
            text,
        };
        output::print(&format!("{}\n", serde_json::to_string(&result)?));
        return Ok(());
    }
    let to_stderr = args.output.is_none();
    if to_stderr {
        output::print(&text);
    }
    let notes: String = notes.iter().map(|note| format!("{note}\n")).collect();
    let check = check.map(|check| check.to_text(language));
    output::print_or_report(&(notes + &check.unwrap_or_default()), to_stderr);
    Ok(())
}

/// Checks a program on the training lathe.
fn check_text(
    text: &str,
    path: &Path,
    language: Option<Language>,
) -> Result<ProgramReport, CommandError> {
    let mut setup = loading::with_training_lathe(gsk_core::setup::Setup::default(), None);
    loading::open_text(&mut setup, path, text.to_owned(), |_, _| Default::default())?;
    let name = path.display().to_string();
    Ok(report::check_program(
        &name,
        &setup,
        language,
        &mut |_| {},
        &mut |_| true,
    ))
}
