//! Parts that the transfer dialogs share: their window, their buttons, and the fields for a
//! new name (CNC文件重命名).

use egui::{
    Align2, Button, Context, Grid, Label, Rect, RichText, ScrollArea, TextEdit, Ui, Window,
};
use gsk_messages::{Language, Message, say};
use gsk_transfer::{DirectoryEntry, FileName, Partition};

use super::BAD;
use crate::window::clear;
use crate::window::focus;

/// Width of a text field, points.
pub const FIELD: f32 = 300.0;
/// Width of a dialog, points.
const WIDTH: f32 = 460.0;

/// CNC文件重命名 (manual V-3.5): the fields for the old and the new name, and the list of files.
pub struct Naming {
    /// The current name as it is typed.
    pub old: String,
    /// The new name as it is typed.
    pub new: String,
}

impl Naming {
    /// Creates the fields with a current name and a proposed new one.
    pub const fn new(old: String, new: String) -> Self {
        Self { old, new }
    }

    /// Draws the dialog while a file to send has an existing name. Returns the new name when
    /// it is accepted, `Some(None)` when the dialog is cancelled, `None` while it is open.
    pub fn show(
        &mut self,
        context: &Context,
        room: Rect,
        language: Language,
        partition: Partition,
        entries: &[DirectoryEntry],
    ) -> Option<Option<FileName>> {
        let mut done = None;
        window(
            context,
            room,
            &say::transfer_view_rename_title(),
            language,
            |ui| {
                self.fields(ui, language, false);
                ui.label(RichText::new(partition.name()).weak());
                self.entries(ui, entries, false);
                if let Some(agreed) = ended(ui, language, self.is_good()) {
                    done = Some(agreed.then(|| FileName::new(&self.new).ok()).flatten());
                }
            },
        );
        done
    }

    /// Whether both texts are valid file names.
    pub fn is_good(&self) -> bool {
        FileName::new(&self.old).is_ok() && FileName::new(&self.new).is_ok()
    }

    /// Draws both fields. With `free` the old name can be typed, too.
    pub fn fields(&mut self, ui: &mut Ui, language: Language, free: bool) {
        Grid::new("naming-fields").num_columns(2).show(ui, |ui| {
            ui.label(say::transfer_view_old_name().text(language));
            let line = TextEdit::singleline(&mut self.old).desired_width(FIELD);
            ui.add_enabled(free, line);
            ui.end_row();
            ui.label(say::transfer_view_new_name().text(language));
            let label = say::transfer_view_new_name().text(language);
            let line = TextEdit::singleline(&mut self.new).desired_width(FIELD);
            ui.add(line.hint_text("O0001.CNC")).on_hover_text(label);
            ui.end_row();
        });
        complaint(ui, language, &self.new);
    }

    /// Draws the list of files. A click takes a name over into the old name.
    pub fn entries(&mut self, ui: &mut Ui, entries: &[DirectoryEntry], free: bool) {
        ScrollArea::vertical()
            .id_salt("naming-entries")
            .max_height(150.0)
            .auto_shrink([false, true])
            .show(ui, |ui| {
                for entry in entries {
                    let name = entry.name.as_str();
                    let words = format!("{name:<12} {:>8}", entry.size);
                    let row = RichText::new(words).monospace();
                    if ui.selectable_label(free && name == self.old, row).clicked() && free {
                        name.clone_into(&mut self.old);
                    }
                }
                focus::follow(ui);
            });
    }
}

/// Draws what is wrong with a file name.
pub fn complaint(ui: &mut Ui, language: Language, name: &str) {
    if name.is_empty() {
        return;
    }
    if let Err(error) = FileName::new(name) {
        let text = RichText::new(error.message().text(language)).color(BAD);
        ui.add(Label::new(text).wrap());
    }
}

/// Draws a dialog centred in the view. It covers no key that stops the machine.
pub fn window(
    context: &Context,
    room: Rect,
    title: &Message,
    language: Language,
    content: impl FnOnce(&mut Ui),
) {
    Window::new(title.text(language))
        .id(egui::Id::unique(("transfer", title.id())))
        .collapsible(false)
        .resizable(false)
        .pivot(Align2::CENTER_CENTER)
        .fixed_pos(room.center())
        .constrain_to(clear::free(context, room.size()))
        .order(egui::Order::Foreground)
        .show(context, |ui| {
            ui.set_max_width(WIDTH.min(room.width() - 24.0));
            content(ui);
        });
}

/// Draws the buttons 确定 (OK) and 取消 (cancel). Returns whether the operator has accepted, once
/// a button is clicked. `good` enables OK.
pub fn ended(ui: &mut Ui, language: Language, good: bool) -> Option<bool> {
    let mut done = None;
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        let words = say::transfer_view_ok().text(language);
        if ui.add_enabled(good, Button::new(words)).clicked() {
            done = Some(true);
        }
        if ui.button(say::window_cancel().text(language)).clicked() {
            done = Some(false);
        }
    });
    done
}
