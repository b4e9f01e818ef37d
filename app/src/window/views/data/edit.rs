//! A value under edit in the data view: its field, the typed text, and the request to the
//! control.

use std::collections::BTreeMap;

use gsk_commission::ParameterChange;
use gsk_core::cnc::{OffsetEntry, Request};
use gsk_core::memory::{self, Offsets, PitchTable, Refusal, ToolOffset};
use gsk_core::units::{Axis, parse_finite};
use gsk_messages::{Message, say};

use super::values::Values;
use crate::kernel::monitor::VariableTable;

/// Millimetres per inch.
const INCH: f64 = 25.4;

/// A column of the tool offsets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Part {
    X,
    Z,
    R,
    T,
}

impl Part {
    /// The columns in the order of the page.
    pub const ALL: [Self; 4] = [Self::X, Self::Z, Self::R, Self::T];

    /// The heading of the column.
    pub const fn letter(self) -> &'static str {
        match self {
            Self::X => "X",
            Self::Z => "Z",
            Self::R => "R",
            Self::T => "T",
        }
    }

    /// The value of this column in a row: mm, or the tool nose number.
    fn of(self, row: ToolOffset) -> f64 {
        match self {
            Self::X => row.x,
            Self::Z => row.z,
            Self::R => row.r,
            Self::T => f64::from(row.t),
        }
    }

    /// Formats a value of this column as the page of the control does.
    fn text(self, value: f64, machine: &Values<'_>) -> String {
        match self {
            Self::T => format!("{value:.0}"),
            Self::X | Self::Z | Self::R => machine.offsets.display.length(value),
        }
    }
}

/// The field that shows a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Spot {
    /// A parameter; a state parameter as a whole.
    Parameter(u16),
    /// Row and column of the tool offsets.
    Offset(u8, Part),
    /// A point of the pitch errors of X.
    PitchX(u8),
    /// A point of the pitch errors of Z.
    PitchZ(u8),
    /// A macro variable by its number.
    Variable(u16),
}

/// A new value for a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edit {
    Parameter(ParameterChange),
    /// A tool offset.
    Offset {
        /// Row.
        number: u8,
        /// Column.
        part: Part,
        /// New value, mm, or the tool nose number.
        value: f64,
    },
    /// A macro variable.
    Variable {
        /// Number of the variable.
        number: u16,
        /// New value; `None` is null.
        value: Option<f64>,
        /// Whether the variable takes fractions and null.
        real: bool,
    },
}

impl Edit {
    /// The request that writes the value into the control.
    pub const fn request(self) -> Request {
        match self {
            Self::Parameter(change) => change.to_request(),
            Self::Offset {
                number,
                part,
                value,
            } => {
                let entry = match part {
                    Part::X => OffsetEntry::Stored(Axis::X, value),
                    Part::Z => OffsetEntry::Stored(Axis::Z, value),
                    Part::R => OffsetEntry::StoredRadius(value),
                    // Checked when the text was parsed.
                    Part::T => OffsetEntry::NoseNumber(value as u8),
                };
                Request::SetOffset { number, entry }
            }
            Self::Variable {
                number,
                value,
                real: true,
            } => Request::SetMacroVariable { number, value },
            Self::Variable { number, value, .. } => Request::SetVariable {
                number,
                // A whole number, checked when the text was parsed; such a variable is never
                // null.
                value: match value {
                    Some(value) => value as i64,
                    None => 0,
                },
            },
        }
    }

    /// The field and its new value as text: `No.035 = 12`.
    pub fn message(self) -> Message {
        match self {
            Self::Parameter(change) => change.message(),
            Self::Offset {
                number,
                part,
                value,
            } => say::data_offset(number, part.letter(), value),
            Self::Variable {
                number,
                value: Some(value),
                ..
            } => say::data_variable(number, value),
            Self::Variable { number, .. } => say::data_variable_null(number),
        }
    }

    /// The same edit with the current value of the control.
    pub fn now(self, machine: &Values<'_>) -> Self {
        match self {
            Self::Parameter(change) => {
                Self::Parameter(change.current(machine.parameters, machine.pitch))
            }
            Self::Offset { number, part, .. } => Self::Offset {
                number,
                part,
                value: part.of(machine.offsets.rows.get(number)),
            },
            Self::Variable { number, real, .. } => Self::Variable {
                number,
                value: variable(machine.variables, number),
                real,
            },
        }
    }

    /// Why the control would refuse the edit now; `None`: it would accept it.
    pub const fn refused(self, machine: &Values<'_>) -> Option<Refusal> {
        match self {
            Self::Parameter(_) => machine.parameters_refused,
            Self::Offset { .. } => machine.offsets.refused,
            Self::Variable { .. } => machine.variables.refused,
        }
    }
}

fn variable(table: &VariableTable, number: u16) -> Option<f64> {
    let row = table.rows.iter().find(|(own, _)| *own == number);
    row.and_then(|(_, value)| *value)
}

/// Whether a parameter consists of eight bits.
pub fn is_state(number: u16) -> bool {
    memory::row(number, None).is_some_and(|row| row.state)
}

/// Formats a parameter as its page does: eight binary digits, or a number.
pub fn parameter_text(number: u16, value: i32) -> String {
    match is_state(number) {
        true => format!("{value:08b}"),
        false => value.to_string(),
    }
}

impl Spot {
    /// The field of a point of an axis's pitch errors.
    pub const fn pitch(axis: Axis, point: u8) -> Self {
        match axis {
            Axis::X => Self::PitchX(point),
            Axis::Z => Self::PitchZ(point),
        }
    }

    /// The current value of the control as the operator would type it.
    pub fn text(self, machine: &Values<'_>) -> String {
        match self {
            Self::Parameter(number) => parameter_text(number, machine.parameters.value(number)),
            Self::Offset(number, part) => {
                part.text(part.of(machine.offsets.rows.get(number)), machine)
            }
            Self::PitchX(point) => machine.pitch.value(Axis::X, point).to_string(),
            Self::PitchZ(point) => machine.pitch.value(Axis::Z, point).to_string(),
            Self::Variable(number) => {
                let value = variable(machine.variables, number);
                value.map_or_else(String::new, |value| value.to_string())
            }
        }
    }

    pub fn name(self) -> Message {
        match self {
            Self::Parameter(number) => say::data_value_of(number),
            Self::Offset(number, part) => say::data_offset_cell(number, part.letter()),
            Self::PitchX(point) => say::project_of_pitch(format_args!("{point:03}"), 'X'),
            Self::PitchZ(point) => say::project_of_pitch(format_args!("{point:03}"), 'Z'),
            Self::Variable(number) => say::data_variable_cell(number),
        }
    }

    /// Parses a typed text as a new value.
    ///
    /// # Errors
    ///
    /// The text is invalid, or the control does not accept the value (alarms 030, 043, 111).
    pub fn read(self, typed: &str, machine: &Values<'_>) -> Result<Edit, Message> {
        let text = typed.trim();
        match self {
            Self::Parameter(number) => {
                let value = self.parameter(number, text)?;
                let mut then = machine.parameters.clone();
                then.set(number, value).map_err(|error| error.message())?;
                Ok(Edit::Parameter(ParameterChange::Value { number, value }))
            }
            Self::Offset(number, part) => self.offset(number, part, text, machine),
            Self::PitchX(point) => self.pitch_error(Axis::X, point, text),
            Self::PitchZ(point) => self.pitch_error(Axis::Z, point, text),
            Self::Variable(number) if machine.variables.real => Ok(Edit::Variable {
                number,
                value: Some(self.number(text)?),
                real: true,
            }),
            Self::Variable(number) => {
                let whole: Option<i64> = text.parse().ok();
                let range = memory::Variables::LEAST..=memory::Variables::GREATEST;
                let whole = whole.filter(|value| range.contains(value));
                let wrong = || say::data_variable_whole(self.name(), text);
                Ok(Edit::Variable {
                    number,
                    value: Some(whole.ok_or_else(wrong)? as f64),
                    real: false,
                })
            }
        }
    }

    fn parameter(self, number: u16, text: &str) -> Result<i32, Message> {
        if !is_state(number) {
            let value = text.parse().ok();
            return value.ok_or_else(|| say::data_not_a_value(self.name(), text));
        }
        let digits = text.len() == 8 && text.bytes().all(|byte| matches!(byte, b'0' | b'1'));
        let value = i32::from_str_radix(text, 2).ok().filter(|_| digits);
        value.ok_or_else(|| say::data_not_bits(self.name(), text))
    }

    /// Parses a pitch error: a whole number in the range of the table.
    fn pitch_error(self, axis: Axis, point: u8, text: &str) -> Result<Edit, Message> {
        let value = text.parse().ok();
        let value = value.ok_or_else(|| say::data_not_a_value(self.name(), text))?;
        let mut table = PitchTable::default();
        let set = table.set(axis, point, value);
        set.map_err(|error| error.message())?;
        Ok(Edit::Parameter(ParameterChange::Pitch {
            axis,
            point,
            value,
        }))
    }

    /// Parses a number with a decimal point or comma.
    fn number(self, text: &str) -> Result<f64, Message> {
        parse_finite(&text.replace(',', "."))
            .ok_or_else(|| say::data_not_a_value(self.name(), text))
    }

    /// Parses an offset. After U or W the number is added to the current value (decision
    /// DATA-3, manual III-7).
    fn offset(
        self,
        number: u8,
        part: Part,
        text: &str,
        machine: &Values<'_>,
    ) -> Result<Edit, Message> {
        let own = machine.offsets.rows.get(number);
        if number == 0 && !machine.parameters.work_shift() {
            return Err(say::data_offset_fixed());
        }
        let in_mm = |value: f64| match machine.offsets.display.inch {
            true => value * INCH,
            false => value,
        };
        let added = match part {
            Part::X => text.strip_prefix(['U', 'u']),
            Part::Z => text.strip_prefix(['W', 'w']),
            Part::R | Part::T => None,
        };
        let mut then = own;
        match (part, added) {
            (Part::X, Some(by)) => then.x += in_mm(self.number(by.trim())?),
            (Part::Z, Some(by)) => then.z += in_mm(self.number(by.trim())?),
            (Part::X, None) => then.x = in_mm(self.number(text)?),
            (Part::Z, None) => then.z = in_mm(self.number(text)?),
            (Part::R, _) => then.r = in_mm(self.number(text)?),
            (Part::T, _) => {
                let nose = text.parse().ok();
                then.t = nose.ok_or_else(|| say::data_not_a_value(self.name(), text))?;
            }
        }
        // The table rounds and limits the value as the control does. Row 000 has the limits of
        // the others.
        let mut table = Offsets::default();
        table.set(1, then).map_err(|alarm| {
            let why = alarm.further_detail().cloned();
            say::data_not_allowed(self.name(), why.unwrap_or(alarm.reason()))
        })?;
        Ok(Edit::Offset {
            number,
            part,
            value: part.of(table.get(1)),
        })
    }
}

/// Typed texts that are not written yet.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Drafts {
    typed: BTreeMap<Spot, String>,
}

impl Drafts {
    /// The text of a field: what was typed, else the current value of the control.
    pub fn text(&self, spot: Spot, machine: &Values<'_>) -> String {
        let typed = self.typed.get(&spot).cloned();
        typed.unwrap_or_else(|| spot.text(machine))
    }

    /// Whether the field has a typed text.
    pub fn has(&self, spot: Spot) -> bool {
        self.typed.contains_key(&spot)
    }

    /// Stores the typed text of a field.
    pub fn set(&mut self, spot: Spot, text: String) {
        self.typed.insert(spot, text);
    }

    /// Drops the text of a field that has lost the focus, if it equals the current value.
    pub fn left(&mut self, spot: Spot, machine: &Values<'_>) {
        let text = self.typed.get(&spot);
        if text.is_some_and(|text| is_there(spot, text, machine)) {
            self.typed.remove(&spot);
        }
    }

    /// Replaces typed additions by their results. Each addition is applied once.
    pub fn counted(&mut self, edits: &[Edit], machine: &Values<'_>) {
        for edit in edits {
            if let Edit::Offset {
                number,
                part,
                value,
            } = *edit
            {
                let text = part.text(value, machine);
                self.typed.insert(Spot::Offset(number, part), text);
            }
        }
    }

    /// Drops all texts that equal the current values by now.
    pub fn settle(&mut self, machine: &Values<'_>) {
        self.typed
            .retain(|spot, text| !is_there(*spot, text, machine));
    }

    /// Drops all typed texts.
    pub fn discard(&mut self) {
        self.typed.clear();
    }

    /// Count of fields with a typed text.
    pub fn count(&self) -> usize {
        self.typed.len()
    }

    /// Parses all typed texts.
    ///
    /// # Errors
    ///
    /// The error of the first text that is invalid.
    pub fn edits(&self, machine: &Values<'_>) -> Result<Vec<Edit>, Message> {
        let edits = self.typed.iter();
        edits.map(|(spot, text)| spot.read(text, machine)).collect()
    }
}

/// Whether the typed text equals the current value.
fn is_there(spot: Spot, text: &str, machine: &Values<'_>) -> bool {
    // An addition is never equal.
    let added = matches!(spot, Spot::Offset(..)) && text.trim().starts_with(['U', 'u', 'W', 'w']);
    let edit = spot.read(text, machine).ok().filter(|_| !added);
    edit.is_some_and(|edit| edit.now(machine) == edit) || text == spot.text(machine)
}
