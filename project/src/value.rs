//! Parses and formats a single value of a project.

use std::sync::Arc;

use gsk_core::model::ModelId;
use gsk_core::units::parse_finite;
use gsk_messages::{Message, say};

use crate::key::{PanelSetting, ProjectKey};

/// One value of a project, as its files store it.
#[derive(Clone, Debug)]
pub enum ProjectValue {
    /// An integer: parameter, pitch error, counter, PLC data.
    Whole(i64),
    /// A real number: tool offset (mm), macro variable.
    Real(f64),
    /// The state of a switch, written as `on` or `off`.
    Switch(bool),
    /// The model of the control.
    Model(ModelId),
    /// The number of the selected program; `None` if none is selected.
    Selected(Option<u16>),
    /// The content of a file: program, ladder, job or machine file.
    Text(Arc<str>),
}

/// Real numbers are equal if all their bits are equal.
impl PartialEq for ProjectValue {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Whole(one), Self::Whole(other)) => one == other,
            (Self::Real(one), Self::Real(other)) => one.to_bits() == other.to_bits(),
            (Self::Switch(one), Self::Switch(other)) => one == other,
            (Self::Model(one), Self::Model(other)) => one == other,
            (Self::Selected(one), Self::Selected(other)) => one == other,
            (Self::Text(one), Self::Text(other)) => one == other,
            _ => false,
        }
    }
}

/// Formats the value as its file writes it. A text is stored in a separate file and is empty
/// here.
impl core::fmt::Display for ProjectValue {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Whole(value) => write!(f, "{value}"),
            Self::Real(value) => f.write_str(&format_shortest(*value)),
            Self::Switch(on) => f.write_str(if *on { "on" } else { "off" }),
            Self::Model(model) => f.write_str(model.command_word()),
            Self::Selected(Some(number)) => write!(f, "O{number:04}"),
            Self::Selected(None) => f.write_str("none"),
            Self::Text(_) => Ok(()),
        }
    }
}

/// Returns the shortest decimal that parses to the same bits; with an exponent below 1e-6 and
/// from 1e15.
fn format_shortest(value: f64) -> String {
    match value.abs() {
        0.0 | 1e-6..1e15 => format!("{value}"),
        _ => format!("{value:e}"),
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ValueType {
    Whole,
    Real,
    Switch,
    Model,
    Selected,
}

const fn value_type(key: ProjectKey) -> ValueType {
    match key {
        ProjectKey::Model => ValueType::Model,
        ProjectKey::Selected => ValueType::Selected,
        ProjectKey::Setting(_) | ProjectKey::Panel(PanelSetting::Zx | PanelSetting::Drawing) => {
            ValueType::Switch
        }
        ProjectKey::Offset(_, _, crate::OffsetColumn::T) => ValueType::Whole,
        ProjectKey::Offset(..) | ProjectKey::Variable(_) => ValueType::Real,
        _ => ValueType::Whole,
    }
}

/// Parses the text of a key's value.
///
/// # Errors
/// A message with the text and the expected form.
pub(crate) fn parse_value(key: ProjectKey, text: &str) -> Result<ProjectValue, Message> {
    let (value, expected) = match value_type(key) {
        ValueType::Whole => (
            text.parse().ok().map(ProjectValue::Whole),
            say::project_whole(),
        ),
        ValueType::Real => (
            parse_finite(text).map(ProjectValue::Real),
            say::project_real(),
        ),
        ValueType::Switch => (
            parse_switch(text).map(ProjectValue::Switch),
            say::project_switch(),
        ),
        ValueType::Model => {
            let words = ModelId::ALL.map(ModelId::command_word).join(", ");
            (
                ModelId::from_command_word(text).map(ProjectValue::Model),
                say::project_one_of(words),
            )
        }
        ValueType::Selected => (parse_selected(text), say::project_program_name()),
    };
    value.ok_or_else(|| say::project_not_a_value(text, expected))
}

fn parse_switch(text: &str) -> Option<bool> {
    match text {
        "on" => Some(true),
        "off" => Some(false),
        _ => None,
    }
}

fn parse_selected(text: &str) -> Option<ProjectValue> {
    if text == "none" {
        return Some(ProjectValue::Selected(None));
    }
    match ProjectKey::from_path(&format!("programs/{text}.CNC")) {
        Some(ProjectKey::Program(number)) => Some(ProjectValue::Selected(Some(number))),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_finite() {
        let key = ProjectKey::Variable(500);
        assert_eq!(parse_value(key, "-2.5e3"), Ok(ProjectValue::Real(-2500.0)));
        for text in ["nan", "NaN", "inf", "-inf", "infinity", "1e999", "1,5", ""] {
            assert!(parse_value(key, text).is_err(), "{text}");
        }
    }
}
