//! A value, and how it is written.

use std::sync::Arc;

use gsk_core::model::ModelId;
use gsk_core::units::parse_finite;
use gsk_messages::{Message, say};

use crate::key::{Key, PanelWord};

/// A value of the control.
#[derive(Clone, Debug)]
pub enum Value {
    /// A whole number.
    Whole(i64),
    /// A number with a fraction.
    Real(f64),
    /// On or off.
    Switch(bool),
    /// A control model.
    Model(ModelId),
    /// A program, or none.
    Selected(Option<u16>),
    /// What a file holds.
    Text(Arc<str>),
}

/// Numbers are the same when all their bits are.
impl PartialEq for Value {
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

/// As it stands in a file; a text is too long to be shown, and is empty here.
impl core::fmt::Display for Value {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Whole(value) => write!(f, "{value}"),
            Self::Real(value) => f.write_str(&shortest(*value)),
            Self::Switch(on) => f.write_str(if *on { "on" } else { "off" }),
            Self::Model(model) => f.write_str(model.word()),
            Self::Selected(Some(number)) => write!(f, "O{number:04}"),
            Self::Selected(None) => f.write_str("none"),
            Self::Text(_) => Ok(()),
        }
    }
}

/// The shortest decimal that is read as the same bits; with an exponent where it would be
/// long without.
fn shortest(value: f64) -> String {
    match value.abs() {
        0.0 | 1e-6..1e15 => format!("{value}"),
        _ => format!("{value:e}"),
    }
}

/// What a value of a key looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Whole,
    Real,
    Switch,
    Model,
    Selected,
}

const fn kind(key: Key) -> Kind {
    match key {
        Key::Model => Kind::Model,
        Key::Selected => Kind::Selected,
        Key::Switch(_) | Key::Panel(PanelWord::Zx | PanelWord::Drawing) => Kind::Switch,
        Key::Offset(_, _, crate::OffsetWord::T) => Kind::Whole,
        Key::Offset(..) | Key::Variable(_) => Kind::Real,
        _ => Kind::Whole,
    }
}

/// Reads the value of a key.
///
/// # Errors
/// What should stand there.
pub(crate) fn read(key: Key, text: &str) -> Result<Value, Message> {
    let (value, wanted) = match kind(key) {
        Kind::Whole => (text.parse().ok().map(Value::Whole), say::project_whole()),
        Kind::Real => (parse_finite(text).map(Value::Real), say::project_real()),
        Kind::Switch => (switch(text).map(Value::Switch), say::project_switch()),
        Kind::Model => {
            let words = ModelId::ALL.map(ModelId::word).join(", ");
            (
                ModelId::from_word(text).map(Value::Model),
                say::project_one_of(words),
            )
        }
        Kind::Selected => (selected(text), say::project_program_name()),
    };
    value.ok_or_else(|| say::project_not_a_value(text, wanted))
}

fn switch(text: &str) -> Option<bool> {
    match text {
        "on" => Some(true),
        "off" => Some(false),
        _ => None,
    }
}

fn selected(text: &str) -> Option<Value> {
    if text == "none" {
        return Some(Value::Selected(None));
    }
    match Key::of_file(&format!("programs/{text}.CNC")) {
        Some(Key::Program(number)) => Some(Value::Selected(Some(number))),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_finite() {
        let key = Key::Variable(500);
        assert_eq!(read(key, "-2.5e3"), Ok(Value::Real(-2500.0)));
        for text in ["nan", "NaN", "inf", "-inf", "infinity", "1e999", "1,5", ""] {
            assert!(read(key, text).is_err(), "{text}");
        }
    }
}
