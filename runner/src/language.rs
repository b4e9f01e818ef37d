//! The language of what surrounds the panel.

pub use gsk_messages::Language;

/// One of two sentences, for words that are needed in one place alone.
pub const fn say(language: Language, zh: &'static str, en: &'static str) -> &'static str {
    match language {
        Language::Zh => zh,
        Language::En => en,
    }
}
