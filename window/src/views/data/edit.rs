//! A value under edit in the data view: its field, the typed text, and the request to the
//! control.

use std::collections::BTreeMap;

use gsk_commission::ParameterChange;
use gsk_core::cnc::{ControlRequest, OffsetEntry};
use gsk_core::memory::{self, Offsets, PitchTable, ToolOffset, WriteRefusal};
use gsk_core::units::{Axis, parse_finite};
use gsk_host::kernel::monitor::VariableTable;
use gsk_messages::{Message, say};

use super::data_values::DataValues;

/// Number of millimetres in an inch.
const MM_PER_INCH: f64 = 25.4;

/// A column of the tool offset table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ToolOffsetField {
    X,
    Z,
    R,
    T,
}

impl ToolOffsetField {
    /// All columns in the order of the control's page.
    pub const ALL: [Self; 4] = [Self::X, Self::Z, Self::R, Self::T];

    /// Returns the letter in the heading of the column.
    pub const fn letter(self) -> &'static str {
        match self {
            Self::X => "X",
            Self::Z => "Z",
            Self::R => "R",
            Self::T => "T",
        }
    }

    /// The value of this column in a row: mm, or the tool nose number without a unit.
    fn value_in(self, row: ToolOffset) -> f64 {
        match self {
            Self::X => row.x,
            Self::Z => row.z,
            Self::R => row.r,
            Self::T => f64::from(row.t),
        }
    }

    /// Formats a value of this column as the page of the control does.
    fn text(self, value: f64, machine: &DataValues<'_>) -> String {
        match self {
            Self::T => format!("{value:.0}"),
            Self::X | Self::Z | Self::R => machine.offsets.display.length(value),
        }
    }
}

/// Identifies a value of the control that a field of the data pages shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum DataField {
    /// A parameter by its number; a state parameter with all its bits.
    Parameter(u16),
    /// A tool offset: its number and the column.
    Offset(u8, ToolOffsetField),
    /// The point with this number of the pitch error table of X.
    PitchX(u8),
    /// The point with this number of the pitch error table of Z.
    PitchZ(u8),
    /// The macro variable with this number.
    Variable(u16),
}

/// A new value for a field, which is not written to the control yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DataEdit {
    Parameter(ParameterChange),
    /// A new value of a tool offset.
    Offset {
        /// Number of the tool offset.
        number: u8,
        /// Column of the tool offset table.
        part: ToolOffsetField,
        /// New value, mm, or the tool nose number without a unit.
        value: f64,
    },
    /// A new value of a macro variable.
    Variable {
        number: u16,
        /// New value of the variable; `None` sets it to null.
        value: Option<f64>,
        /// Whether the variable can be a fraction or null.
        is_real: bool,
    },
}

impl DataEdit {
    /// Converts the edit to the request that writes the value into the control.
    pub const fn request(self) -> ControlRequest {
        match self {
            Self::Parameter(change) => change.to_request(),
            Self::Offset {
                number,
                part,
                value,
            } => {
                let entry = match part {
                    ToolOffsetField::X => OffsetEntry::Stored(Axis::X, value),
                    ToolOffsetField::Z => OffsetEntry::Stored(Axis::Z, value),
                    ToolOffsetField::R => OffsetEntry::StoredRadius(value),
                    // Checked when the text was parsed.
                    ToolOffsetField::T => OffsetEntry::NoseNumber(value as u8),
                };
                ControlRequest::SetOffset { number, entry }
            }
            Self::Variable {
                number,
                value,
                is_real: true,
            } => ControlRequest::SetMacroVariable { number, value },
            Self::Variable { number, value, .. } => ControlRequest::SetVariable {
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

    /// Formats the field and its new value: `No.035 = 12`.
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

    /// Creates an edit of the same field with its current value, which undoes this one after
    /// it was written.
    pub fn with_current_value(self, machine: &DataValues<'_>) -> Self {
        match self {
            Self::Parameter(change) => {
                Self::Parameter(change.current(machine.parameters, machine.pitch))
            }
            Self::Offset { number, part, .. } => Self::Offset {
                number,
                part,
                value: part.value_in(machine.offsets.rows.get(number)),
            },
            Self::Variable {
                number,
                is_real: real,
                ..
            } => Self::Variable {
                number,
                value: variable_value(machine.variables, number),
                is_real: real,
            },
        }
    }

    /// Returns the reason why the control would refuse the edit at the moment; `None` if it would
    /// accept it.
    pub const fn refusal(self, machine: &DataValues<'_>) -> Option<WriteRefusal> {
        match self {
            Self::Parameter(_) => machine.parameters_refusal,
            Self::Offset { .. } => machine.offsets.refused,
            Self::Variable { .. } => machine.variables.refused,
        }
    }
}

fn variable_value(table: &VariableTable, number: u16) -> Option<f64> {
    let row = table.rows.iter().find(|(own, _)| *own == number);
    row.and_then(|(_, value)| *value)
}

/// Whether a parameter consists of eight bits, as opposed to a number.
pub fn is_state_parameter(number: u16) -> bool {
    memory::parameter_row(number, None).is_some_and(|row| row.state)
}

/// Formats a parameter as its page does: eight binary digits, or a number.
pub fn parameter_text(number: u16, value: i32) -> String {
    match is_state_parameter(number) {
        true => format!("{value:08b}"),
        false => value.to_string(),
    }
}

impl DataField {
    /// Returns the field of a point in the pitch error table of `axis`.
    pub const fn pitch(axis: Axis, point: u8) -> Self {
        match axis {
            Axis::X => Self::PitchX(point),
            Axis::Z => Self::PitchZ(point),
        }
    }

    /// Formats the current value of the field as the operator would type it.
    pub fn current_text(self, machine: &DataValues<'_>) -> String {
        match self {
            Self::Parameter(number) => parameter_text(number, machine.parameters.value(number)),
            Self::Offset(number, part) => {
                part.text(part.value_in(machine.offsets.rows.get(number)), machine)
            }
            Self::PitchX(point) => machine.pitch.value(Axis::X, point).to_string(),
            Self::PitchZ(point) => machine.pitch.value(Axis::Z, point).to_string(),
            Self::Variable(number) => {
                let value = variable_value(machine.variables, number);
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
    pub fn parse(self, typed: &str, machine: &DataValues<'_>) -> Result<DataEdit, Message> {
        let text = typed.trim();
        match self {
            Self::Parameter(number) => {
                let value = self.parse_parameter(number, text)?;
                let mut changed = machine.parameters.clone();
                changed
                    .set(number, value)
                    .map_err(|error| error.message())?;
                Ok(DataEdit::Parameter(ParameterChange::Value {
                    number,
                    value,
                }))
            }
            Self::Offset(number, part) => self.parse_offset(number, part, text, machine),
            Self::PitchX(point) => self.parse_pitch_error(Axis::X, point, text),
            Self::PitchZ(point) => self.parse_pitch_error(Axis::Z, point, text),
            Self::Variable(number) if machine.variables.real => Ok(DataEdit::Variable {
                number,
                value: Some(self.parse_number(text)?),
                is_real: true,
            }),
            Self::Variable(number) => {
                let parsed: Option<i64> = text.parse().ok();
                let range = memory::Variables::LEAST..=memory::Variables::GREATEST;
                let whole = parsed.filter(|value| range.contains(value));
                let error = || say::data_variable_whole(self.name(), text);
                Ok(DataEdit::Variable {
                    number,
                    value: Some(whole.ok_or_else(error)? as f64),
                    is_real: false,
                })
            }
        }
    }

    fn parse_parameter(self, number: u16, text: &str) -> Result<i32, Message> {
        if !is_state_parameter(number) {
            let value = text.parse().ok();
            return value.ok_or_else(|| say::data_not_a_value(self.name(), text));
        }
        let is_binary = text.len() == 8 && text.bytes().all(|byte| matches!(byte, b'0' | b'1'));
        let value = i32::from_str_radix(text, 2).ok().filter(|_| is_binary);
        value.ok_or_else(|| say::data_not_bits(self.name(), text))
    }

    /// Parses a pitch error as a whole number in the range of the table.
    fn parse_pitch_error(self, axis: Axis, point: u8, text: &str) -> Result<DataEdit, Message> {
        let value = text.parse().ok();
        let value = value.ok_or_else(|| say::data_not_a_value(self.name(), text))?;
        let mut table = PitchTable::default();
        let result = table.set(axis, point, value);
        result.map_err(|error| error.message())?;
        Ok(DataEdit::Parameter(ParameterChange::Pitch {
            axis,
            point,
            value,
        }))
    }

    /// Parses a number with a decimal point or comma. Returns a message as error for another text.
    fn parse_number(self, text: &str) -> Result<f64, Message> {
        parse_finite(&text.replace(',', "."))
            .ok_or_else(|| say::data_not_a_value(self.name(), text))
    }

    /// Parses an offset in mm. After U or W the number is added to the current value (decision
    /// DATA-3, manual III-7). Returns a message as error for a wrong number.
    fn parse_offset(
        self,
        number: u8,
        part: ToolOffsetField,
        text: &str,
        machine: &DataValues<'_>,
    ) -> Result<DataEdit, Message> {
        let current = machine.offsets.rows.get(number);
        if number == 0 && !machine.parameters.has_work_shift() {
            return Err(say::data_offset_fixed());
        }
        let to_mm = |value: f64| match machine.offsets.display.inch {
            true => value * MM_PER_INCH,
            false => value,
        };
        let increment = match part {
            ToolOffsetField::X => text.strip_prefix(['U', 'u']),
            ToolOffsetField::Z => text.strip_prefix(['W', 'w']),
            ToolOffsetField::R | ToolOffsetField::T => None,
        };
        let mut changed = current;
        match (part, increment) {
            (ToolOffsetField::X, Some(by)) => changed.x += to_mm(self.parse_number(by.trim())?),
            (ToolOffsetField::Z, Some(by)) => changed.z += to_mm(self.parse_number(by.trim())?),
            (ToolOffsetField::X, None) => changed.x = to_mm(self.parse_number(text)?),
            (ToolOffsetField::Z, None) => changed.z = to_mm(self.parse_number(text)?),
            (ToolOffsetField::R, _) => changed.r = to_mm(self.parse_number(text)?),
            (ToolOffsetField::T, _) => {
                let nose = text.parse().ok();
                changed.t = nose.ok_or_else(|| say::data_not_a_value(self.name(), text))?;
            }
        }
        // The table rounds and limits the value as the control does. Row 000 has the limits of
        // the others.
        let mut table = Offsets::default();
        table.set(1, changed).map_err(|alarm| {
            let detail = alarm.further_detail().cloned();
            say::data_not_allowed(self.name(), detail.unwrap_or(alarm.reason()))
        })?;
        Ok(DataEdit::Offset {
            number,
            part,
            value: part.value_in(table.get(1)),
        })
    }
}

/// Texts that the operator has typed into fields and not written yet.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Drafts {
    texts: BTreeMap<DataField, String>,
}

impl Drafts {
    /// Returns the text of a field: the typed text, or else its current value.
    pub fn text(&self, field: DataField, machine: &DataValues<'_>) -> String {
        let typed = self.texts.get(&field).cloned();
        typed.unwrap_or_else(|| field.current_text(machine))
    }

    /// Whether the operator has typed into the field.
    pub fn has_draft(&self, field: DataField) -> bool {
        self.texts.contains_key(&field)
    }

    /// Stores the text that was typed into a field.
    pub fn set(&mut self, field: DataField, text: String) {
        self.texts.insert(field, text);
    }

    /// Drops the typed text of a field that has lost the focus, if it equals the current
    /// value.
    pub fn drop_if_unchanged(&mut self, field: DataField, machine: &DataValues<'_>) {
        let text = self.texts.get(&field);
        if text.is_some_and(|text| is_current(field, text, machine)) {
            self.texts.remove(&field);
        }
    }

    /// Replaces typed additions (U, W) by their results, so that each addition is applied
    /// once.
    pub fn replace_additions(&mut self, edits: &[DataEdit], machine: &DataValues<'_>) {
        for edit in edits {
            if let DataEdit::Offset {
                number,
                part,
                value,
            } = *edit
            {
                let text = part.text(value, machine);
                self.texts.insert(DataField::Offset(number, part), text);
            }
        }
    }

    /// Drops all typed texts that equal the current values by now.
    pub fn drop_written(&mut self, machine: &DataValues<'_>) {
        self.texts
            .retain(|field, text| !is_current(*field, text, machine));
    }

    /// Discards all typed texts.
    pub fn discard(&mut self) {
        self.texts.clear();
    }

    /// Returns the number of fields with a typed text.
    pub fn count(&self) -> usize {
        self.texts.len()
    }

    /// Parses all typed texts into edits.
    ///
    /// # Errors
    ///
    /// The error of the first text that is invalid.
    pub fn parse_edits(&self, machine: &DataValues<'_>) -> Result<Vec<DataEdit>, Message> {
        let edits = self.texts.iter();
        edits
            .map(|(field, text)| field.parse(text, machine))
            .collect()
    }
}

/// Whether the typed text of a field equals its current value.
fn is_current(field: DataField, text: &str, machine: &DataValues<'_>) -> bool {
    // An addition is never equal.
    let is_addition =
        matches!(field, DataField::Offset(..)) && text.trim().starts_with(['U', 'u', 'W', 'w']);
    let edit = field.parse(text, machine).ok().filter(|_| !is_addition);
    edit.is_some_and(|edit| edit.with_current_value(machine) == edit)
        || text == field.current_text(machine)
}
