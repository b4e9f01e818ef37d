//! Describes the inputs and outputs of a control model for its diagnosis pages.

use gsk_messages::Message;

/// An input or output of a control model, with its pin.
#[derive(Clone, Copy, Debug)]
pub struct ContactRow {
    /// Number of the pin in the connector; 0 if the manual gives none.
    pub pin: u8,
    /// The signal at the contact.
    pub meaning: ContactMeaning,
}

/// The purpose of an input or output of a control model.
#[derive(Clone, Copy, Debug)]
pub enum ContactMeaning {
    /// The manual does not assign a signal to the contact.
    Free,
    /// An M code switches the output, or an edge of the input acts as the code.
    Code(&'static str),
    /// The contact has a signal with this name.
    Signal(fn() -> Message),
}

/// Creates the row of a contact with its pin and signal.
pub(super) const fn contact(pin: u8, meaning: ContactMeaning) -> ContactRow {
    ContactRow { pin, meaning }
}
