//! Refuses the keys and pages that an exercise does not permit.

use gsk_core::cnc::Cnc;
use gsk_messages::Message;

use super::{KeyEvent, Panel};
use crate::keys::Key;
use crate::panel::limits::PanelLimits;

impl Panel {
    /// Sets the keys and pages that an exercise refuses.
    pub(crate) fn set_limits(&mut self, limits: PanelLimits) {
        self.limits = limits;
    }

    /// Returns why an exercise refuses a key or a character now; `None` if it permits it.
    pub fn limit_refusal(&self, event: KeyEvent, cnc: &Cnc) -> Option<Message> {
        if self.limits.is_empty() {
            return None;
        }
        match event {
            KeyEvent::Down(key) => {
                let by_key = self.limits.key_refusal(key);
                by_key.or_else(|| self.refused_page(key, cnc))
            }
            KeyEvent::Type(character) => self.limits.character_refusal(character),
            KeyEvent::Up(_) | KeyEvent::ReleaseAll | KeyEvent::Wheel(_) => None,
        }
    }

    /// Returns why a key is refused that would open a page; `None` if it opens none that is
    /// refused. A copy of the panel tries the key.
    pub(super) fn refused_page(&self, key: Key, cnc: &Cnc) -> Option<Message> {
        if !self.limits.refuses_pages() || !self.is_awake() {
            return None;
        }
        let mut tried = self.clone();
        tried.act_unlimited(key, cnc, &mut Vec::new());
        let page = Some(tried.page).filter(|page| *page != self.page);
        page.and_then(|page| self.limits.page_refusal(page))
    }
}
