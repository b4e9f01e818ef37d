//! What a view has written into the control, and the button that takes the last of it back.

use egui::{Button, Ui};
use gsk_commission::UndoList;
use gsk_messages::{Language, Message, say};

/// Changes of an entry that are listed when it is pointed at.
const LISTED: usize = 12;

/// How a view speaks of what it has written.
pub struct Words<Label, Change> {
    /// Of an entry as a whole.
    pub label: fn(&Label) -> Message,
    /// Of a change: what stands where.
    pub change: fn(&Change) -> Message,
    /// What is needed to take it back.
    pub hint: Message,
}

/// Lists the entries; `allowed`: the control would take these changes now. What has to be
/// written to take the last entry back comes out when its button was pressed.
pub fn show<Label, Change: Clone>(
    ui: &mut Ui,
    language: Language,
    undo: &mut UndoList<Label, Change>,
    words: &Words<Label, Change>,
    allowed: impl Fn(&[Change]) -> bool,
) -> Option<Vec<Change>> {
    for entry in undo.entries() {
        let said = say::commission_written((words.label)(&entry.label), entry.written.len());
        let rows = entry.before.iter().zip(&entry.written).take(LISTED);
        let rows: Vec<String> = rows
            .map(|(before, written)| {
                let [before, written] =
                    [before, written].map(|change| (words.change)(change).text(language));
                format!("{written} ← {before}")
            })
            .collect();
        ui.label(said.text(language)).on_hover_text(rows.join("\n"));
    }
    let last = undo.entries().last()?;
    let said = say::commission_undo((words.label)(&last.label));
    let button = Button::new(said.text(language)).wrap();
    let button = ui.add_enabled(allowed(&last.before), button);
    let hint = words.hint.text(language);
    if button.on_disabled_hover_text(hint).clicked() {
        return undo.pop();
    }
    None
}
