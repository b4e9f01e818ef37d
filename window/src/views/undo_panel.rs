//! Lists what a view has written into the control, with a button that undoes the last entry.

use egui::{Button, Ui};
use gsk_commission::UndoList;
use gsk_messages::{Language, Message, say};

/// Maximum number of changes of an entry that its hover text lists.
const LISTED: usize = 12;

/// Functions that describe the entries and changes of an undo list.
pub struct UndoTexts<Label, Change> {
    /// Function that describes a whole entry of the undo list.
    pub label: fn(&Label) -> Message,
    /// Function that describes one change: the item and its value.
    pub change: fn(&Change) -> Message,
    /// The condition under which the control would accept the old values: hover text of the
    /// disabled button.
    pub blocked_hint: Message,
}

/// Lists the entries and draws the undo button. `allowed`: whether the control would accept
/// these changes now. Returns the values that undo the last entry when the button is clicked.
pub fn show<Label, Change: Clone>(
    ui: &mut Ui,
    language: Language,
    undo: &mut UndoList<Label, Change>,
    texts: &UndoTexts<Label, Change>,
    allowed: impl Fn(&[Change]) -> bool,
) -> Option<Vec<Change>> {
    for entry in undo.entries() {
        let summary = say::commission_written((texts.label)(&entry.label), entry.written.len());
        let rows = entry.before.iter().zip(&entry.written).take(LISTED);
        let rows: Vec<String> = rows
            .map(|(before, written)| {
                let [before, written] =
                    [before, written].map(|change| (texts.change)(change).text(language));
                format!("{written} ← {before}")
            })
            .collect();
        ui.label(summary.text(language))
            .on_hover_text(rows.join("\n"));
    }
    let last = undo.entries().last()?;
    let caption = say::commission_undo((texts.label)(&last.label));
    let button = Button::new(caption.text(language)).wrap();
    let button = ui.add_enabled(allowed(&last.before), button);
    let hint = texts.blocked_hint.text(language);
    if button.on_disabled_hover_text(hint).clicked() {
        return undo.pop();
    }
    None
}
