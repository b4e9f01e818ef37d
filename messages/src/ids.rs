//! Makes [`Id`] and the functions of [`say`] from the list of rows in `rows.rs`.
//!
//! The list has names and placeholders only. A text that is reworded changes nothing here, so
//! no package is compiled again for it.

/// Type of the parameter that fills a placeholder.
macro_rules! parameter {
    (message) => { impl Into<Message> };
    (messages) => { impl IntoIterator<Item = Message> };
    ($($format:literal)?) => { impl Display };
}

/// Value that a message stores for a placeholder.
macro_rules! stored_value {
    ($value:ident) => {
        Value::Text($value.to_string())
    };
    ($value:ident message) => {
        Value::Message($value.into())
    };
    ($value:ident messages) => {
        Value::List($value.into_iter().collect())
    };
    ($value:ident $format:literal) => {
        Value::Text(format!($format, $value))
    };
}

/// Makes the ids, the rows and the functions from lines
/// `name Variant(placeholder, placeholder: kind);`. The names are one text: thousands of
/// references to names would be relocated at each start of the program.
macro_rules! message_rows {
    ($($name:ident $variant:ident($($value:ident $(: $kind:tt)?),*);)*) => {
        /// Identifies a message: a row of the message table.
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Id {
            $(
                #[doc = concat!("The row `", stringify!($name), "`.")]
                $variant,
            )*
        }

        /// The ids of all rows, in the order of the table.
        pub(crate) const IDS: &[Id] = &[$(Id::$variant),*];

        /// Name and placeholders of each row, separated by spaces, after an empty heading.
        pub(crate) static ROWS: MessageTable = MessageTable::new(concat!(
            "\n",
            $(stringify!($name), $(" ", stringify!($value),)* "\n",)*
        ));

        /// A function for each row of the message table, which makes the message from its values.
        pub mod say {
            use core::fmt::Display;

            use super::{Id, Message, Value};

            $(
                #[doc = concat!("Makes the message of the row `", stringify!($name), "`.")]
                #[must_use]
                pub fn $name($($value: parameter!($($kind)?)),*) -> Message {
                    Message::of(Id::$variant, vec![$(stored_value!($value $($kind)?)),*])
                }
            )*
        }
    };
}
