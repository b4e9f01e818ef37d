//! The tool bar of the program view, and its question about an unsaved text.

use egui::{
    Align2, Button, Context, Key, Label, Modifiers, RichText, ScrollArea, TextEdit, Ui, Window,
};
use gsk_messages::{Language, Message, say};

use super::Next;
use super::document::{Document, Origin};
use crate::window::clear;

/// A request of the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Bring another text into the editor.
    Bring(Next),
    /// Save to the text's file.
    Save,
    /// Save to a file that the user chooses.
    SaveAs,
    /// Store the text in the control.
    Store,
    Undo,
    Redo,
    /// Go to the next match of the search text.
    Find,
    /// Go to the target that was typed.
    GoTo,
}

/// The state of the tool bar.
#[derive(Default)]
pub struct Bar {
    /// The search text.
    pub find: String,
    /// The target to go to, as typed.
    pub go_to: String,
    /// The language of dialogs.
    pub language: Language,
    /// The field that gets the keyboard focus in the next frame.
    focus: Option<&'static str>,
}

/// Width of a field, points.
const FIELD: f32 = 90.0;
/// Height of the list of programs, points.
const MENU: f32 = 400.0;

impl Bar {
    /// Draws the tools. `memory`: numbers of the programs in the control's memory.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        document: &Document,
        memory: &[u16],
        language: Language,
    ) -> Option<Wish> {
        let mut wish = None;
        ui.horizontal(|ui| {
            files(ui, language, &mut wish);
            programs(ui, memory, language, &mut wish);
            ui.separator();
            let edited = document.is_edited();
            let hint = say::program_store_hint().text(language);
            let tools = [
                (
                    document.is_unsaved(),
                    say::program_save(),
                    "Ctrl+S",
                    Wish::Save,
                ),
                (true, say::program_store(), &hint, Wish::Store),
                (edited, say::program_undo(), "Ctrl+Z", Wish::Undo),
                (edited, say::program_redo(), "Ctrl+Y", Wish::Redo),
            ];
            for (on, words, hint, what) in tools {
                let button = ui.add_enabled(on, Button::new(words.text(language)));
                if button.on_hover_text(hint).clicked() {
                    wish = Some(what);
                }
            }
        });
        ui.horizontal(|ui| {
            if self.field(ui, "find", &say::program_find(), "Ctrl+F", language) {
                wish = Some(Wish::Find);
            }
            let next = ui.button(say::program_find_next().text(language));
            if next.on_hover_text("F3").clicked() {
                wish = Some(Wish::Find);
            }
            let hint = say::program_go_to_hint().text(language);
            let hint = format!("{hint} (Ctrl+G)");
            if self.field(ui, "go to", &say::program_go_to(), &hint, language) {
                wish = Some(Wish::GoTo);
            }
            ui.separator();
            let name = Label::new(RichText::new(title(document, language)).strong());
            ui.add(name.truncate());
        });
        wish
    }

    /// Draws a field with its name. Returns whether Enter was pressed in it.
    fn field(
        &mut self,
        ui: &mut Ui,
        id: &'static str,
        name: &Message,
        hint: &str,
        language: Language,
    ) -> bool {
        let label = ui.label(name.text(language));
        let text = match id {
            "find" => &mut self.find,
            _ => &mut self.go_to,
        };
        let field = TextEdit::singleline(text)
            .id(egui::Id::unique(("program", id)))
            .desired_width(FIELD);
        let response = ui.add(field).labelled_by(label.id).on_hover_text(hint);
        if self.focus == Some(id) {
            self.focus = None;
            response.request_focus();
        }
        response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
    }

    /// Handles the keys of the view. `own`: the keyboard belongs to the view and not to the
    /// panel.
    pub fn keys(&mut self, ui: &Ui, own: bool) -> Option<Wish> {
        if !own {
            return None;
        }
        let pressed = |modifiers: Modifiers, key: Key| {
            ui.input_mut(|input| input.consume_key(modifiers, key))
        };
        if pressed(Modifiers::COMMAND, Key::F) {
            self.focus = Some("find");
        }
        if pressed(Modifiers::COMMAND, Key::G) {
            self.focus = Some("go to");
        }
        if pressed(Modifiers::COMMAND, Key::S) {
            return Some(Wish::Save);
        }
        pressed(Modifiers::NONE, Key::F3).then_some(Wish::Find)
    }
}

/// Draws the menu of files.
fn files(ui: &mut Ui, language: Language, wish: &mut Option<Wish>) {
    ui.menu_button(say::program_file().text(language), |ui| {
        let entries = [
            (say::program_new(), Wish::Bring(Next::New)),
            (say::program_open(), Wish::Bring(Next::Choose)),
            (say::program_save(), Wish::Save),
            (say::program_save_as(), Wish::SaveAs),
        ];
        for (words, what) in entries {
            if ui.button(words.text(language)).clicked() {
                *wish = Some(what);
                ui.close();
            }
        }
    });
}

/// Draws the menu of the programs in the control's memory.
fn programs(ui: &mut Ui, memory: &[u16], language: Language, wish: &mut Option<Wish>) {
    let menu = ui.menu_button(say::program_control().text(language), |ui| {
        let list = ScrollArea::vertical().max_height(MENU);
        list.show(ui, |ui| {
            for number in memory {
                if ui.button(format!("O{number:04}")).clicked() {
                    *wish = Some(Wish::Bring(Next::Memory(Some(*number))));
                    ui.close();
                }
            }
        });
    });
    let hint = say::program_control_hint().text(language);
    menu.response.on_hover_text(hint);
}

/// The name of the text, with a mark if it is not saved.
fn title(document: &Document, language: Language) -> String {
    let mark = if document.is_unsaved() { "● " } else { "" };
    let name = match &document.origin {
        Origin::New => say::program_new_name().text(language),
        Origin::File(_, encoding) => format!("{} ({encoding})", document.name()),
        Origin::Memory(_) => document.name(),
    };
    format!("{mark}{name}")
}

/// The user's decision about an unsaved text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Save it first.
    Save,
    /// Discard its changes.
    Discard,
    /// Keep it in the editor; the other text is not loaded.
    Cancel,
}

/// Size of the question's window, points.
const ROOM: egui::Vec2 = egui::vec2(520.0, 180.0);

/// Asks before an unsaved text is lost.
pub fn ask_to_save(context: &Context, name: &str, language: Language) -> Option<Answer> {
    let mut answer = None;
    Window::new(say::program_unsaved_title(name).text(language))
        .id(egui::Id::unique("unsaved program"))
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, [0.0, -60.0])
        .constrain_to(clear::free(context, ROOM))
        .show(context, |ui| {
            ui.label(say::program_unsaved_lost(name).text(language));
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                for (words, what) in [
                    (say::program_save(), Answer::Save),
                    (say::program_discard(), Answer::Discard),
                    (say::program_keep(), Answer::Cancel),
                ] {
                    if ui.button(words.text(language)).clicked() {
                        answer = Some(what);
                    }
                }
            });
        });
    answer
}
