//! Parts that the transfer dialogs share: their window, their buttons, and the fields for a
//! new name (CNC文件重命名).

use egui::{
    Align2, Button, Context, Grid, Label, Rect, RichText, ScrollArea, TextEdit, Ui, Window,
};
use gsk_messages::{Language, Message, say};
use gsk_transfer::{DirectoryEntry, FileName, Partition};

use crate::focus;
use crate::placement::stop_key_clearance;
use crate::theme;

/// Width of a text field, points.
pub const FIELD_WIDTH: f32 = 300.0;
/// Width of a dialog, points.
const DIALOG_WIDTH: f32 = 460.0;

/// CNC文件重命名 (manual V-3.5): the fields for the old and the new name, and the list of files.
pub struct RenameFields {
    /// The current name that the operator has typed.
    pub old_name: String,
    /// The new name that the operator has typed.
    pub new_name: String,
}

impl RenameFields {
    /// Creates the fields with a current name and a proposed new one.
    pub const fn new(old_name: String, new_name: String) -> Self {
        Self { old_name, new_name }
    }

    /// Draws the dialog for the new name of a file of the control that has the name of a file
    /// to send. Returns the accepted name, `Some(None)` if the dialog is cancelled, `None`
    /// while it is open.
    pub fn show(
        &mut self,
        context: &Context,
        bounds: Rect,
        language: Language,
        partition: Partition,
        entries: &[DirectoryEntry],
    ) -> Option<Option<FileName>> {
        let mut result = None;
        show_window(
            context,
            bounds,
            &say::transfer_view_rename_title(),
            language,
            |ui| {
                self.show_fields(ui, language, false);
                ui.label(RichText::new(partition.name()).weak());
                self.show_entries(ui, entries, false);
                if let Some(accepted) = show_buttons(ui, language, self.is_valid()) {
                    result = Some(
                        accepted
                            .then(|| FileName::new(&self.new_name).ok())
                            .flatten(),
                    );
                }
            },
        );
        result
    }

    /// Whether both typed names are valid file names.
    pub fn is_valid(&self) -> bool {
        FileName::new(&self.old_name).is_ok() && FileName::new(&self.new_name).is_ok()
    }

    /// Draws the fields of both names. With `is_editable` the old name can be typed, too.
    pub fn show_fields(&mut self, ui: &mut Ui, language: Language, is_editable: bool) {
        Grid::new("naming-fields").num_columns(2).show(ui, |ui| {
            ui.label(say::transfer_view_old_name().text(language));
            let line = TextEdit::singleline(&mut self.old_name).desired_width(FIELD_WIDTH);
            ui.add_enabled(is_editable, line);
            ui.end_row();
            ui.label(say::transfer_view_new_name().text(language));
            let label = say::transfer_view_new_name().text(language);
            let line = TextEdit::singleline(&mut self.new_name).desired_width(FIELD_WIDTH);
            ui.add(line.hint_text("O0001.CNC")).on_hover_text(label);
            ui.end_row();
        });
        show_name_error(ui, language, &self.new_name);
    }

    /// Draws the list of files. With `is_editable` a click copies a name into the old name.
    pub fn show_entries(&mut self, ui: &mut Ui, entries: &[DirectoryEntry], is_editable: bool) {
        ScrollArea::vertical()
            .id_salt("naming-entries")
            .max_height(150.0)
            .auto_shrink([false, true])
            .show(ui, |ui| {
                for entry in entries {
                    let name = entry.name.as_str();
                    let text = format!("{name:<12} {:>8}", entry.size);
                    let row = RichText::new(text).monospace();
                    if ui
                        .selectable_label(is_editable && name == self.old_name, row)
                        .clicked()
                        && is_editable
                    {
                        name.clone_into(&mut self.old_name);
                    }
                }
                focus::scroll_to_focus(ui);
            });
    }
}

/// Draws why a file name is invalid; nothing for a valid or empty one.
pub fn show_name_error(ui: &mut Ui, language: Language, name: &str) {
    if name.is_empty() {
        return;
    }
    if let Err(error) = FileName::new(name) {
        let text = RichText::new(error.message().text(language)).color(theme::ALARM_TEXT);
        ui.add(Label::new(text).wrap());
    }
}

/// Draws a dialog centred in the view. It covers no key that stops the machine.
pub fn show_window(
    context: &Context,
    bounds: Rect,
    title: &Message,
    language: Language,
    content: impl FnOnce(&mut Ui),
) {
    Window::new(title.text(language))
        .id(egui::Id::unique(("transfer", title.id())))
        .collapsible(false)
        .resizable(false)
        .pivot(Align2::CENTER_CENTER)
        .fixed_pos(bounds.center())
        .constrain_to(stop_key_clearance::free_rect(context, bounds.size()))
        .order(egui::Order::Foreground)
        .show(context, |ui| {
            ui.set_max_width(DIALOG_WIDTH.min(bounds.width() - 24.0));
            content(ui);
        });
}

/// Draws the buttons 确定 (OK) and 取消 (cancel). Returns true after OK, false after cancel,
/// `None` while neither is clicked. `can_accept` enables OK.
pub fn show_buttons(ui: &mut Ui, language: Language, can_accept: bool) -> Option<bool> {
    let mut accepted = None;
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        let words = say::transfer_view_ok().text(language);
        if ui.add_enabled(can_accept, Button::new(words)).clicked() {
            accepted = Some(true);
        }
        if ui.button(say::window_cancel().text(language)).clicked() {
            accepted = Some(false);
        }
    });
    accepted
}
