//! Sound: a page is silent. What a browser needs for it would not fit into the size that a
//! page may have.

use core::convert::Infallible;

use gsk_messages::{Message, say};

/// Whether the system can play at all.
pub const fn has_sound() -> bool {
    false
}

/// No page has one.
pub struct Player(Infallible);

impl Player {
    /// Refuses.
    ///
    /// # Errors
    /// Always.
    pub fn open(_rate: u32) -> Result<Self, Message> {
        Err(say::sound_no_device())
    }

    /// Nothing can come here.
    ///
    /// # Errors
    /// None.
    pub fn play(&mut self, _samples: &[i16]) -> Result<(), Message> {
        match self.0 {}
    }
}
