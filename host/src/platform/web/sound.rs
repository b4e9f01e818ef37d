//! Sound: a page is silent. The code for it would exceed the size limit of the page.

use core::convert::Infallible;

use gsk_messages::{Message, say};

/// Returns false: a page cannot play sound.
pub const fn has_sound() -> bool {
    false
}

/// A sound output; it never exists on a page.
pub struct Player(Infallible);

impl Player {
    /// Does not open an output, because a page has none.
    ///
    /// # Errors
    ///
    /// Always returns an error.
    pub fn open(_rate: u32) -> Result<Self, Message> {
        Err(say::sound_no_device())
    }

    /// Plays samples; never called.
    ///
    /// # Errors
    /// Never.
    pub fn play(&mut self, _samples: &[i16]) -> Result<(), Message> {
        match self.0 {}
    }
}
