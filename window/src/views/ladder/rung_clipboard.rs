//! Cuts, copies and pastes rungs as instruction lists, through the clipboard of the computer
//! (manual PLC-III 3.2.2, 剪切, 复制, 粘贴).

use std::ops::RangeInclusive;

use egui::{Button, Event, Ui};
use gsk_messages::{Language, say};

use super::draft::LadderDraft;
use super::{LadderView, Tab};

/// The chosen rungs, and the rungs that were copied last.
#[derive(Clone, Debug, Default)]
pub struct RungClipboard {
    /// The rung at the other end of the chosen range; `None`: only the selected rung is chosen.
    range_end: Option<u32>,
    /// The instruction list that was copied last.
    text: String,
}

impl LadderView {
    /// The numbers of the chosen rungs: the selected one, or a range up to it. `None` without a
    /// selection in the draft.
    pub(super) fn chosen_rungs(&self) -> Option<RangeInclusive<u32>> {
        let ladder = self.draft.as_ref().filter(|_| self.is_editing)?.ladder();
        let rung = ladder.statements().get(self.selected?)?.rung;
        let end = self.clipboard.range_end.unwrap_or(rung);
        Some(rung.min(end)..=rung.max(end))
    }

    /// Handles a click on a statement in the rungs: with Shift the rungs from the selected one to
    /// the clicked one are chosen.
    pub(super) fn select_clicked(&mut self, at: usize, with_shift: bool) {
        let chosen = self.chosen_rungs();
        let ladder = self.draft.as_ref().map(LadderDraft::ladder);
        let clicked = ladder.and_then(|ladder| ladder.statements().get(at));
        let clicked = clicked.map(|statement| statement.rung);
        self.clipboard.range_end = match (chosen, clicked) {
            (Some(chosen), Some(clicked)) if with_shift => Some(match clicked < *chosen.end() {
                true => *chosen.end(),
                false => *chosen.start(),
            }),
            _ => None,
        };
        self.selected = Some(at);
    }

    /// Copies the chosen rungs. Returns false without chosen rungs.
    fn copy_rungs(&mut self, ui: &Ui) -> bool {
        let (Some(chosen), Some(draft)) = (self.chosen_rungs(), &self.draft) else {
            return false;
        };
        let text = draft
            .ladder()
            .source_of_rungs(*chosen.start(), *chosen.end());
        ui.copy_text(text.clone());
        self.clipboard.text = text;
        true
    }

    fn cut_rungs(&mut self, ui: &Ui) {
        let Some(chosen) = self.chosen_rungs() else {
            return;
        };
        if !self.draft_compiles() || !self.copy_rungs(ui) {
            return;
        }
        if let Some(draft) = &mut self.draft {
            let (first, last) = chosen.into_inner();
            let rest = draft.ladder().source_without_rungs(first, last);
            draft.set_text(rest, None);
        }
        self.clipboard.range_end = None;
    }

    /// Puts an instruction list after the chosen rungs, and selects its first rung.
    fn paste_rungs(&mut self, list: &str) {
        let Some(chosen) = self.chosen_rungs() else {
            return;
        };
        if list.trim().is_empty() || !self.draft_compiles() {
            return;
        }
        let Some(draft) = &mut self.draft else { return };
        let after = *chosen.end();
        let text = draft.ladder().source_with_rungs_after(after, list);
        draft.set_text(text, None);
        self.clipboard.range_end = None;
        if let Some(first) = draft.ladder().network(after + 1) {
            self.selected = Some(first.first);
            self.pending_rung = Some(first.number);
        }
    }

    fn draft_compiles(&self) -> bool {
        self.draft
            .as_ref()
            .is_some_and(|draft| draft.errors().is_empty())
    }

    /// Draws the buttons Cut, Copy and Paste.
    pub(super) fn show_clipboard_tools(&mut self, ui: &mut Ui, language: Language) {
        let on = self.draft_compiles() && self.chosen_rungs().is_some();
        let hint = say::ladder_choose_rungs_hint().text(language);
        let cut = Button::new(say::ladder_cut().text(language));
        let cut = ui.add_enabled(on, cut);
        if cut.on_hover_text(format!("Ctrl+X  {hint}")).clicked() {
            self.cut_rungs(ui);
        }
        let copy = Button::new(say::ladder_copy().text(language));
        let copy = ui.add_enabled(on, copy);
        if copy.on_hover_text(format!("Ctrl+C  {hint}")).clicked() {
            self.copy_rungs(ui);
        }
        let paste = Button::new(say::ladder_paste().text(language));
        let paste = ui.add_enabled(on && !self.clipboard.text.is_empty(), paste);
        if paste.on_hover_text("Ctrl+V").clicked() {
            let list = self.clipboard.text.clone();
            self.paste_rungs(&list);
        }
    }

    /// Handles Ctrl+X, Ctrl+C and Ctrl+V in the rungs, unless a text field has the keyboard.
    pub(super) fn handle_clipboard_keys(&mut self, ui: &Ui) {
        if self.tab != Tab::Rungs || ui.ctx().egui_wants_keyboard_input() {
            return;
        }
        let is_clipboard =
            |event: &&Event| matches!(event, Event::Cut | Event::Copy | Event::Paste(_));
        let event = ui.input(|input| input.events.iter().find(is_clipboard).cloned());
        match event {
            Some(Event::Cut) => self.cut_rungs(ui),
            Some(Event::Copy) => {
                self.copy_rungs(ui);
            }
            Some(Event::Paste(list)) => self.paste_rungs(&list),
            _ => {}
        }
    }
}
