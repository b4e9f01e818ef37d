//! What a field is: name, unit, range, default, and on which values it depends.

use gsk_messages::Message;

use crate::thousandths::Thousandths;

/// The unit of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldUnit {
    /// Millimetres along Z, or of a depth or radius.
    Length,
    /// Millimetres of a diameter.
    Diameter,
    /// Degrees.
    Angle,
    /// A count or number without a unit.
    Count,
    /// Seconds.
    Seconds,
    /// r/min, or m/min with constant surface speed.
    Speed,
    /// mm/r or mm/min, as FEED says.
    Feed,
    /// Revolutions per minute.
    Revolutions,
    /// Multiples of the lead of a thread.
    Leads,
}

impl FieldUnit {
    /// Whether numbers must be whole.
    pub const fn is_count(self) -> bool {
        matches!(self, Self::Count | Self::Speed | Self::Revolutions)
    }
}

/// An option of a field.
#[derive(Clone, Copy, Debug)]
pub struct FieldOption {
    /// The word of the option in text.
    pub word: &'static str,
    /// The name of the option.
    pub name: fn() -> Message,
}

/// What a field accepts. `V` has the values on which the field depends.
pub enum FieldInput<V> {
    /// A number within a range.
    Number {
        /// The unit of the number.
        unit: FieldUnit,
        /// Least and greatest number.
        range: (Thousandths, Thousandths),
        /// The number if none was set.
        default: fn(&V) -> Thousandths,
    },
    /// One of some options.
    Choice {
        /// The options.
        options: &'static [FieldOption],
        /// The index of the option if none was chosen.
        default: usize,
    },
    /// A thread of the table, or `FREE`.
    Thread {
        /// The designation if none was chosen.
        default: &'static str,
    },
    /// The points of an outline.
    Outline {
        /// The points if none were given.
        default: &'static str,
    },
}

/// A field of a form. `V` has the values on which it depends.
pub struct FieldRow<V> {
    /// The id: a word in capitals, unique within its form.
    pub id: &'static str,
    /// The name of the field.
    pub name: fn() -> Message,
    /// What the field means, in a sentence.
    pub tip: fn() -> Message,
    /// What the field accepts.
    pub input: FieldInput<V>,
    /// Whether the field matters with these values.
    pub is_shown: fn(&V) -> bool,
}

/// The name and the tip of a field.
pub(crate) type FieldTexts = (fn() -> Message, fn() -> Message);

impl<V> FieldRow<V> {
    /// A field for a number; `range` and the default are thousandths.
    pub(crate) const fn number(
        id: &'static str,
        texts: FieldTexts,
        unit: FieldUnit,
        range: (i64, i64),
        default: fn(&V) -> Thousandths,
    ) -> Self {
        Self {
            id,
            name: texts.0,
            tip: texts.1,
            input: FieldInput::Number {
                unit,
                range: (Thousandths(range.0), Thousandths(range.1)),
                default,
            },
            is_shown: |_| true,
        }
    }

    /// A field with options.
    pub(crate) const fn choice(
        id: &'static str,
        texts: FieldTexts,
        options: &'static [FieldOption],
    ) -> Self {
        Self {
            id,
            name: texts.0,
            tip: texts.1,
            input: FieldInput::Choice {
                options,
                default: 0,
            },
            is_shown: |_| true,
        }
    }

    /// The same field, shown only with some values.
    pub(crate) const fn shown_if(self, is_shown: fn(&V) -> bool) -> Self {
        Self { is_shown, ..self }
    }
}
