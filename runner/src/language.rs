//! The language of what surrounds the panel.

pub use gsk_messages::Language;
