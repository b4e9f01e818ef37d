//! The chain of causes, in both languages.

use gsk_core::plc::address::BitAddress;
use gsk_messages::{Language, Message};

use crate::keys::Key;

/// Greatest number of links in a chain of causes.
pub(super) const MAX_LINKS: usize = 80;

/// The thing that a link of a chain of causes is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CauseTarget {
    /// The link is about a bit of the PLC, on the diagnosis page.
    Bit(BitAddress),
    /// The link is about the ladder rung with this number.
    Rung(u32),
    /// The link is about a key of the panel.
    Key(Key),
    /// The link is about the parameter with this number.
    Parameter(u16),
}

/// A fact with its depth: the links after it that are one deeper decide it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CauseLink {
    /// Depth of the link below the explained state; 0 for the state itself.
    pub depth: usize,
    /// The thing that the link is about; `None` for a state of the control.
    pub target: Option<CauseTarget>,
    /// Whether the link names the way out of the state and no cause.
    pub is_remedy: bool,
    chinese: String,
    english: String,
}

impl CauseLink {
    /// Returns the text of the link in a language.
    pub fn text(&self, language: Language) -> &str {
        match language {
            Language::Zh => &self.chinese,
            Language::En => &self.english,
        }
    }
}

/// The facts that decide a subject, each before those that decide it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CauseChain {
    links: Vec<CauseLink>,
}

impl CauseChain {
    /// Returns the links of the chain, each before its causes.
    pub fn links(&self) -> &[CauseLink] {
        &self.links
    }

    pub(super) fn is_full(&self) -> bool {
        self.links.len() >= MAX_LINKS
    }

    /// Adds a link whose text `message` writes in a language. A full chain does not change.
    pub(super) fn push(
        &mut self,
        depth: usize,
        target: Option<CauseTarget>,
        message: impl Fn(Language) -> Message,
    ) {
        let text = |language| message(language).text(language).trim_end().to_owned();
        let link = CauseLink {
            depth,
            target,
            is_remedy: false,
            chinese: text(Language::Zh),
            english: text(Language::En),
        };
        let is_repeated = (self.links.last()).is_some_and(|last| *last == link);
        if !is_repeated && !self.is_full() {
            self.links.push(link);
        }
    }

    /// Adds a link that names the way out. A full chain does not change.
    pub(super) fn push_remedy(&mut self, depth: usize, message: impl Fn(Language) -> Message) {
        let before = self.links.len();
        self.push(depth, None, message);
        if let Some(added) = self.links.get_mut(before) {
            added.is_remedy = true;
        }
    }

    /// Returns the chain as lines of text, indented by depth.
    pub fn text(&self, language: Language) -> String {
        let mut text = String::new();
        for link in &self.links {
            for _ in 0..link.depth {
                text.push_str("  ");
            }
            text.push_str(link.text(language));
            text.push('\n');
        }
        text
    }
}
