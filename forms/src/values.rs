//! The values of a form: plain data, with the default of each field that was not set.

use core::fmt;
use std::collections::BTreeMap;

use gsk_messages::{Message, say};

use crate::contour::TurnedOutline;
use crate::error::FormError;
use crate::fields::{FieldInput, FieldRow, FieldUnit};
use crate::kind::FormKind;
use crate::thousandths::Thousandths;
use crate::thread_table;

/// The value of a field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FormValue {
    /// A number in the unit of the field.
    Number(Thousandths),
    /// The index of an option.
    Choice(usize),
    /// The index of a row of the thread table; `None`: the fields have diameter and pitch.
    Thread(Option<usize>),
    /// The points of an outline.
    Outline(TurnedOutline),
}

/// A field of a form.
pub type FormField = FieldRow<FormValues>;

/// The fields of a form, in the order of the dialog.
pub(crate) type FieldList = &'static [&'static FormField];

/// A form with the values that were set.
#[derive(Clone)]
pub struct FormValues {
    form: FormKind,
    fields: FieldList,
    set: BTreeMap<&'static str, FormValue>,
}

impl FormValues {
    /// A form with these fields, and defaults only.
    pub(crate) const fn with_fields(form: FormKind, fields: FieldList) -> Self {
        Self {
            form,
            fields,
            set: BTreeMap::new(),
        }
    }

    /// The form.
    pub const fn form(&self) -> FormKind {
        self.form
    }

    /// The field with this id, in upper or lower case.
    ///
    /// # Errors
    /// The form has no such field.
    pub fn field(&self, id: &str) -> Result<&'static FormField, FormError> {
        let mut fields = self.fields.iter();
        let found = fields.find(|field| field.id.eq_ignore_ascii_case(id));
        found.copied().ok_or_else(|| {
            let ids: Vec<&str> = self.fields.iter().map(|it| it.id).collect();
            FormError::new("", say::form_field_unknown(id, ids.join(" ")))
        })
    }

    /// The fields that matter with the current values.
    pub fn shown_fields(&self) -> impl Iterator<Item = &'static FormField> {
        let fields = self.fields.iter().copied();
        fields.filter(|field| (field.is_shown)(self))
    }

    /// The sign of a unit beside a value; that of speeds and feeds depends on other fields.
    pub fn unit_sign(&self, unit: FieldUnit) -> &'static str {
        match unit {
            FieldUnit::Length => "mm",
            FieldUnit::Diameter => "Ø mm",
            FieldUnit::Angle => "°",
            FieldUnit::Count => "",
            FieldUnit::Seconds => "s",
            FieldUnit::Speed if self.has("SPIN", "CSS") => "m/min",
            FieldUnit::Speed | FieldUnit::Revolutions => "r/min",
            FieldUnit::Feed if self.has("FEED", "MIN") => "mm/min",
            FieldUnit::Feed => "mm/r",
            FieldUnit::Leads => "× P",
        }
    }

    /// Whether a value of the field was set; otherwise it has its default.
    pub fn is_set(&self, id: &str) -> bool {
        self.set.contains_key(id)
    }

    /// Returns the field to its default.
    pub fn clear(&mut self, id: &str) {
        self.set.remove(id);
    }

    /// The value of a field, or its default.
    pub fn get(&self, field: &FormField) -> FormValue {
        if let Some(value) = self.set.get(field.id) {
            return value.clone();
        }
        match &field.input {
            FieldInput::Number { default, .. } => FormValue::Number(default(self)),
            FieldInput::Choice { default, .. } => FormValue::Choice(*default),
            FieldInput::Thread { default } => FormValue::Thread(thread_table::find_thread(default)),
            FieldInput::Outline { default } => {
                FormValue::Outline(TurnedOutline::parse(default).unwrap_or_default())
            }
        }
    }

    /// The value of a field as text, as [`Self::set_text`] reads it.
    pub fn text(&self, field: &FormField) -> String {
        match (self.get(field), &field.input) {
            (FormValue::Choice(index), FieldInput::Choice { options, .. }) => {
                let option = options.get(index).or_else(|| options.first());
                option.map_or("", |it| it.word).to_owned()
            }
            (FormValue::Thread(row), _) => thread_table::designation(row).to_ascii_uppercase(),
            (FormValue::Outline(outline), _) => outline.to_string(),
            (FormValue::Number(number), _) => number.to_string(),
            (FormValue::Choice(_), _) => String::new(),
        }
    }

    /// Sets a field from text.
    ///
    /// # Errors
    /// The field is unknown, or the text is not a value of it.
    pub fn set_text(&mut self, id: &str, text: &str) -> Result<(), FormError> {
        let field = self.field(id)?;
        let value = self.parse(field, text.trim());
        let value = value.map_err(|rule| FormError::new(field.id, rule))?;
        self.set.insert(field.id, value);
        Ok(())
    }

    fn parse(&self, field: &FormField, text: &str) -> Result<FormValue, Message> {
        match &field.input {
            FieldInput::Number { unit, range, .. } => {
                let number = Thousandths::parse(text).ok_or_else(|| say::form_no_number(text))?;
                let (least, most) = *range;
                if !(least..=most).contains(&number) {
                    return Err(say::form_out_of_range(number, least, most));
                }
                if unit.is_count() && number.0 % 1000 != 0 {
                    return Err(say::form_no_whole_number(number));
                }
                Ok(FormValue::Number(number))
            }
            FieldInput::Choice { options, .. } => {
                let index = (options.iter()).position(|it| it.word.eq_ignore_ascii_case(text));
                let words: Vec<&str> = options.iter().map(|it| it.word).collect();
                index
                    .map(FormValue::Choice)
                    .ok_or_else(|| say::form_no_option(text, words.join(" ")))
            }
            FieldInput::Thread { .. } => match thread_table::find_thread(text) {
                row @ Some(_) => Ok(FormValue::Thread(row)),
                None if text.eq_ignore_ascii_case(thread_table::FREE) => {
                    Ok(FormValue::Thread(None))
                }
                None => Err(say::form_no_thread(text)),
            },
            FieldInput::Outline { .. } => TurnedOutline::parse(text).map(FormValue::Outline),
        }
    }

    /// The same form with the value of every field that matters set, and no other.
    pub fn complete(&self) -> Self {
        let shown = self.shown_fields();
        Self {
            form: self.form,
            fields: self.fields,
            set: shown.map(|field| (field.id, self.get(field))).collect(),
        }
    }

    /// The same values, with those that equal their defaults unset: they follow the fields on
    /// which they depend.
    #[must_use]
    pub fn without_defaults(&self) -> Self {
        let mut values = self.clone();
        for (id, value) in &self.set {
            values.set.remove(id);
            let is_default = (values.field(id)).is_ok_and(|field| values.get(field) == *value);
            if !is_default {
                values.set.insert(id, value.clone());
            }
        }
        values
    }

    /// The number of a field; 0 if the form has no such field.
    pub(crate) fn number(&self, id: &str) -> Thousandths {
        match self.field(id).map(|field| self.get(field)) {
            Ok(FormValue::Number(number)) => number,
            _ => Thousandths(0),
        }
    }

    /// The number of a field in its unit.
    pub(crate) fn value(&self, id: &str) -> f64 {
        self.number(id).value()
    }

    /// Whether the option `word` of a field is chosen.
    pub(crate) fn has(&self, id: &str, word: &str) -> bool {
        self.field(id).is_ok_and(|field| self.text(field) == word)
    }
}

impl PartialEq for FormValues {
    fn eq(&self, other: &Self) -> bool {
        self.form == other.form && self.set == other.set
    }
}

impl Eq for FormValues {}

impl fmt::Debug for FormValues {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} {:?}", self.form.word(), self.set)
    }
}
