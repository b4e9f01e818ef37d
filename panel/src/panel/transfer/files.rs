//! Reads and writes the files of the serial port as plain text: programs unchanged; offsets,
//! pitch errors and parameters one a line.

use gsk_core::alarm::Alarm;
use gsk_core::cnc::{Cnc, ReceivedData};
use gsk_core::memory::{Offsets, PitchError, PitchTable, ToolOffset};
use gsk_core::program::Program;
use gsk_core::units::{Axis, parse_finite};
use gsk_messages::{Message, say};

use super::{FileId, LADDER_FILE, SerialFile, Wanted};
use crate::pages;

/// Names of the data files. The name of a program file is its number.
pub(super) const OFFSETS: &str = "Tofs.ofs";
pub(super) const PITCH: &str = "Wcomp.wmp";
pub(super) const PARAMETERS: &str = "ParaW.par";

/// Returns the files that the key 输出 sends.
pub(super) fn files_to_send(wanted: Wanted, cnc: &Cnc) -> Vec<SerialFile> {
    let file = |name: &str, text: String| SerialFile {
        name: name.to_owned(),
        text,
    };
    match wanted {
        Wanted::Program(number) => {
            let program = cnc.programs().stored(number);
            let program = program.map(|program| program_file(number, program));
            program.into_iter().collect()
        }
        Wanted::Programs => {
            let rights = cnc.rights();
            let programs = cnc.programs().iter();
            programs
                .filter(|(number, _)| rights.check_send_program(*number).is_ok())
                .map(|(number, program)| program_file(number, program))
                .collect()
        }
        Wanted::Offsets => vec![file(OFFSETS, offsets(cnc))],
        Wanted::Pitch => vec![file(PITCH, pitch(cnc))],
        Wanted::Parameters => vec![file(PARAMETERS, parameters(cnc))],
    }
}

/// Returns the file of a program, of data or of the ladder, with name and text; `None` for a missing program.
pub(super) fn file_of(id: FileId, cnc: &Cnc) -> Option<SerialFile> {
    let wanted = match id {
        FileId::Program(number) => Wanted::Program(number),
        FileId::Offsets => Wanted::Offsets,
        FileId::Pitch => Wanted::Pitch,
        FileId::Parameters => Wanted::Parameters,
        FileId::Ladder => {
            return Some(SerialFile {
                name: LADDER_FILE.to_owned(),
                text: cnc.stored_ladder().source().to_owned(),
            });
        }
    };
    files_to_send(wanted, cnc).pop()
}

fn program_file(number: u16, program: &Program) -> SerialFile {
    let text = program.text().trim_end();
    let text = text.strip_suffix('%').unwrap_or(text).trim_end();
    SerialFile {
        name: format!("O{number:04}.CNC"),
        text: format!("{text}\n%\n"),
    }
}

/// Returns the text of the offset file, one offset a line: number, X, Z, R, T.
fn offsets(cnc: &Cnc) -> String {
    let lines = cnc.offsets().iter().map(|(number, offset)| {
        let (x, z, r, t) = (offset.x, offset.z, offset.r, offset.t);
        format!("{number:03}={x:.3},{z:.3},{r:.3},{t}\n")
    });
    lines.collect()
}

/// Returns the text of the pitch error file, one point a line: number, X, Z.
fn pitch(cnc: &Cnc) -> String {
    let value = |axis, point| cnc.pitch().value(axis, point);
    let lines = (0..=u8::MAX).map(|point| {
        format!(
            "{point:03}={},{}\n",
            value(Axis::X, point),
            value(Axis::Z, point)
        )
    });
    lines.collect()
}

/// Returns the text of the parameter file, one a line. A state parameter has eight binary
/// digits.
fn parameters(cnc: &Cnc) -> String {
    let states = pages::state_numbers()
        .map(|number| format!("{number:03}={:08b}\n", cnc.parameters().byte(number)));
    let data = pages::data_numbers()
        .map(|number| format!("{number:03}={}\n", cnc.parameters().value(number)));
    states.chain(data).collect()
}

/// The reason why a line of a data file is invalid, with the line's number (from 1).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", self.message())]
pub enum DataLineError {
    /// The line, given by its number, does not have the form `NUMBER=VALUE`.
    Form(usize),
    /// The text before `=` is not a number; the values are line and text.
    NoNumber(usize, String),
    /// The value is not valid for its number; the values are line and value.
    NoValue(usize, String),
    /// The control refuses the offset in the line.
    Offset {
        /// Number of the line, from 1.
        line: usize,
        /// The alarm with which the control refuses the offset.
        alarm: Box<Alarm>,
    },
    /// The control refuses the pitch error; the values are line and reason.
    Pitch(usize, PitchError),
}

impl DataLineError {
    /// Returns the message that a line of a received file is invalid, with its number and the
    /// reason.
    pub fn message(&self) -> Message {
        match self {
            Self::Form(line) => say::in_line(line, say::data_line_form()),
            Self::NoNumber(line, text) => say::in_line(line, say::data_line_no_number(text)),
            Self::NoValue(line, value) => say::in_line(line, say::data_line_no_value(value)),
            Self::Offset { line, alarm } => say::in_line(line, alarm.reason()),
            Self::Pitch(line, error) => say::in_line(line, error.message()),
        }
    }
}

/// Parses a received file by the extension of its name; without a known one it is a program.
///
/// # Errors
///
/// Returns the first invalid line of a data file.
pub(super) fn read(file: &SerialFile) -> Result<ReceivedData, DataLineError> {
    let extension = file.name.rsplit('.').next().unwrap_or_default();
    match extension.to_ascii_lowercase().as_str() {
        "ofs" => read_offsets(&file.text).map(ReceivedData::Offsets),
        "wmp" => read_pitch(&file.text).map(ReceivedData::Pitch),
        "par" => read_parameters(&file.text).map(ReceivedData::Parameters),
        _ => Ok(ReceivedData::Program(file.text.clone())),
    }
}

/// Returns the number of a program text. A text without a number has the access rights of
/// O0000.
pub(super) fn number_of(text: &str) -> u16 {
    Program::new(text).number().unwrap_or(0)
}

/// Returns the lines `NUMBER=VALUE` as line (from 1), number and value.
fn lines(text: &str) -> impl Iterator<Item = Result<(usize, u16, &str), DataLineError>> {
    let lines = text
        .lines()
        .enumerate()
        .map(|(at, line)| (at + 1, line.trim()));
    lines
        .filter(|(_, line)| !line.is_empty())
        .map(|(at, line)| {
            let (number, value) = line.split_once('=').ok_or(DataLineError::Form(at))?;
            let number = number.trim().parse();
            let number = number.map_err(|_| DataLineError::NoNumber(at, line.to_owned()))?;
            Ok((at, number, value.trim()))
        })
}

fn invalid_value(at: usize, value: &str) -> DataLineError {
    DataLineError::NoValue(at, value.to_owned())
}

fn read_offsets(text: &str) -> Result<Offsets, DataLineError> {
    let mut offsets = Offsets::default();
    for line in lines(text) {
        let (at, number, value) = line?;
        let offset = offset(value).ok_or_else(|| invalid_value(at, value))?;
        if number == 0 && offset == ToolOffset::default() {
            continue;
        }
        let number = u8::try_from(number).map_err(|_| invalid_value(at, value))?;
        let set = offsets.set(number, offset);
        set.map_err(|alarm| DataLineError::Offset {
            line: at,
            alarm: Box::new(alarm),
        })?;
    }
    Ok(offsets)
}

fn offset(value: &str) -> Option<ToolOffset> {
    let mut values = value.split(',').map(str::trim);
    let mut length = || parse_finite(values.next()?);
    let (x, z, r) = (length()?, length()?, length()?);
    let t = values.next()?.parse().ok()?;
    let offset = ToolOffset { x, z, r, t };
    values.next().is_none().then_some(offset)
}

fn read_pitch(text: &str) -> Result<PitchTable, DataLineError> {
    let mut table = PitchTable::default();
    for line in lines(text) {
        let (at, number, value) = line?;
        let point = u8::try_from(number).map_err(|_| invalid_value(at, value))?;
        let (x, z) = value
            .split_once(',')
            .ok_or_else(|| invalid_value(at, value))?;
        for (axis, digits) in [(Axis::X, x), (Axis::Z, z)] {
            let micrometres = digits
                .trim()
                .parse()
                .map_err(|_| invalid_value(at, value))?;
            let set = table.set(axis, point, micrometres);
            set.map_err(|error| DataLineError::Pitch(at, error))?;
        }
    }
    Ok(table)
}

fn read_parameters(text: &str) -> Result<Vec<(u16, i32)>, DataLineError> {
    let states: Vec<u16> = pages::state_numbers().collect();
    let mut values = Vec::new();
    for line in lines(text) {
        let (at, number, value) = line?;
        let read = if states.contains(&number) {
            u8::from_str_radix(value, 2).ok().map(i32::from)
        } else {
            value.parse().ok()
        };
        values.push((number, read.ok_or_else(|| invalid_value(at, value))?));
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(name: &str, text: &str) -> SerialFile {
        SerialFile {
            name: name.to_owned(),
            text: text.to_owned(),
        }
    }

    #[test]
    fn bad_lines_are_named() {
        for (name, text, words) in [
            ("a.ofs", "001=1,2,3,4\n033=0,0,0,0\n", "line 2: "),
            ("a.ofs", "1=1,2,3\n", "line 1: 1,2,3 is not a valid value"),
            ("a.ofs", "1=1,2,nan,0\n", "line 1: "),
            ("a.ofs", "1=10000,2,0,0\n", "line 1: "),
            ("a.wmp", "\n1=256,0\n", "line 2: "),
            ("a.wmp", "256=0,0\n", "line 1: "),
            ("a.par", "001=2\n", "line 1: 2 is not a valid value"),
            ("a.par", "X=2\n", "does not begin with a number"),
            ("a.par", "22\n", "NUMBER=VALUE"),
        ] {
            let read = read(&file(name, text));
            assert!(
                read.as_ref()
                    .is_err_and(|error| error.to_string().contains(words)),
                "{text}: {read:?}"
            );
        }
    }

    #[test]
    fn names_determine_the_kind_of_a_file() {
        assert!(matches!(
            read(&file("TOFS.OFS", "")),
            Ok(ReceivedData::Offsets(_))
        ));
        assert!(matches!(
            read(&file("O1", "O0001;")),
            Ok(ReceivedData::Program(_))
        ));
        let read = read(&file("ParaW.par", "001=00000101\n022=-7\n"));
        assert_eq!(read, Ok(ReceivedData::Parameters(vec![(1, 5), (22, -7)])));
    }
}
