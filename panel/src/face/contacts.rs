//! Describes the inputs and outputs of a control model for its diagnosis pages.

use gsk_messages::Message;

/// An input or output of a control model.
#[derive(Clone, Copy, Debug)]
pub struct ContactRow {
    /// Pin of the connector; 0 if the manual gives none.
    pub pin: u8,
    /// What the contact is for.
    pub meaning: ContactMeaning,
}

/// What an input or output of a control model is for.
#[derive(Clone, Copy, Debug)]
pub enum ContactMeaning {
    /// The manual gives no meaning.
    Free,
    /// An M code switches the output, or an edge of the input acts as the code.
    Code(&'static str),
    /// A signal with a name.
    Signal(fn() -> Message),
}

/// Returns a contact with a meaning at a pin.
pub(super) const fn contact(pin: u8, meaning: ContactMeaning) -> ContactRow {
    ContactRow { pin, meaning }
}
