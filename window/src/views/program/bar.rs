//! The tool bar of the program view, and its question about an unsaved text.

use egui::{
    Align2, Button, Context, Key, Label, Modifiers, RichText, ScrollArea, TextEdit, Ui, Window,
};
use gsk_core::model::ProgramNaming;
use gsk_messages::{Language, Message, say};

use super::TextToLoad;
use super::breakpoints::BreakpointList;
use super::document::{ProgramDocument, TextOrigin};
use crate::placement::stop_key_clearance;

/// A command of the user in the tool bar of the editor, or by keys.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EditorCommand {
    /// Load this text into the editor.
    LoadText(TextToLoad),
    /// Save the text to its file.
    Save,
    /// Save the text to a file that the user chooses.
    SaveAs,
    /// Store the text as a program of the control.
    Store,
    Undo,
    Redo,
    /// Go to the next match of the search text.
    Find,
    /// Go to the target that the user has typed.
    GoTo,
    /// Open the form of the section at the cursor, or a form for a new section.
    OpenForm,
    /// Port the text from another control.
    OpenPort,
    /// Write the setup sheet and open it in a browser, which prints it.
    Print,
}

/// The texts that the user has entered in the tool bar.
#[derive(Default)]
pub struct ProgramBar {
    /// The search text that the user has typed.
    pub search_text: String,
    /// The jump target as typed: a block, program or line.
    pub target_text: String,
    /// The language of file dialogs.
    pub language: Language,
    /// Id of the field that gets the keyboard focus in the next frame; `None`: no field.
    focus_request: Option<&'static str>,
}

/// Width of an input field, points.
const FIELD_WIDTH: f32 = 90.0;
/// Greatest height of the list of programs, points.
const MENU_HEIGHT: f32 = 400.0;

impl ProgramBar {
    /// Draws the tools and returns the user's command; `None` without one. `memory`: numbers of the
    /// programs in the control's memory. `is_in_form`: the cursor is in the section of a form.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        document: &ProgramDocument,
        memory: &[u16],
        (breakpoints, is_in_form): (&mut BreakpointList, bool),
        language: Language,
    ) -> Option<EditorCommand> {
        let mut command = None;
        let naming = breakpoints.naming();
        ui.horizontal_wrapped(|ui| {
            show_file_menu(ui, language, &mut command);
            show_program_menu(ui, memory, (language, naming), &mut command);
            ui.separator();
            let is_editable = document.is_editable();
            let hint = say::program_store_hint().text(language);
            let tools = [
                (
                    document.is_unsaved(),
                    say::program_save(),
                    "Ctrl+S",
                    EditorCommand::Save,
                ),
                (true, say::program_store(), &hint, EditorCommand::Store),
                (
                    is_editable,
                    say::program_undo(),
                    "Ctrl+Z",
                    EditorCommand::Undo,
                ),
                (
                    is_editable,
                    say::program_redo(),
                    "Ctrl+Y",
                    EditorCommand::Redo,
                ),
            ];
            for (on, words, hint, what) in tools {
                let button = ui.add_enabled(on, Button::new(words.text(language)));
                if button.on_hover_text(hint).clicked() {
                    command = Some(what);
                }
            }
            ui.separator();
            breakpoints.show_menu(ui, language);
        });
        ui.horizontal(|ui| {
            if self.show_field(ui, "find", &say::program_find(), "Ctrl+F", language) {
                command = Some(EditorCommand::Find);
            }
            let next = ui.button(say::program_find_next().text(language));
            if next.on_hover_text("F3").clicked() {
                command = Some(EditorCommand::Find);
            }
            let hint = say::program_go_to_hint().text(language);
            let hint = format!("{hint} (Ctrl+G)");
            if self.show_field(ui, "go to", &say::program_go_to(), &hint, language) {
                command = Some(EditorCommand::GoTo);
            }
            ui.separator();
            if show_form_button(ui, is_in_form, document.is_editable(), language) {
                command = Some(EditorCommand::OpenForm);
            }
            ui.separator();
            let name =
                Label::new(RichText::new(document_title(document, naming, language)).strong());
            ui.add(name.truncate());
        });
        command
    }

    /// Draws a text field with its name. Returns true if Enter was pressed in it.
    fn show_field(
        &mut self,
        ui: &mut Ui,
        id: &'static str,
        name: &Message,
        hint: &str,
        language: Language,
    ) -> bool {
        let label = ui.label(name.text(language));
        let text = match id {
            "find" => &mut self.search_text,
            _ => &mut self.target_text,
        };
        let field = TextEdit::singleline(text)
            .id(egui::Id::unique(("program", id)))
            .desired_width(FIELD_WIDTH);
        let response = ui.add(field).labelled_by(label.id).on_hover_text(hint);
        if self.focus_request == Some(id) {
            self.focus_request = None;
            response.request_focus();
        }
        response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
    }

    /// Handles the keys of the view and returns the command of the pressed one, if any.
    /// `has_keyboard`: the keyboard belongs to the view and not to the panel.
    pub fn handle_keys(&mut self, ui: &Ui, has_keyboard: bool) -> Option<EditorCommand> {
        if !has_keyboard {
            return None;
        }
        let pressed = |modifiers: Modifiers, key: Key| {
            ui.input_mut(|input| input.consume_key(modifiers, key))
        };
        if pressed(Modifiers::COMMAND, Key::F) {
            self.focus_request = Some("find");
        }
        if pressed(Modifiers::COMMAND, Key::G) {
            self.focus_request = Some("go to");
        }
        if pressed(Modifiers::COMMAND, Key::S) {
            return Some(EditorCommand::Save);
        }
        pressed(Modifiers::NONE, Key::F3).then_some(EditorCommand::Find)
    }
}

/// Draws the button of the form of the section at the cursor. Returns true if it was clicked.
fn show_form_button(ui: &mut Ui, is_in_form: bool, is_editable: bool, language: Language) -> bool {
    let name = match is_in_form {
        true => say::program_form_open(),
        false => say::program_form(),
    };
    let button = ui.add_enabled(is_editable, Button::new(name.text(language)));
    let hint = say::program_form_hint().text(language);
    button.on_hover_text(hint).clicked()
}

/// Draws the menu of files and stores the chosen command in `command`.
fn show_file_menu(ui: &mut Ui, language: Language, command: &mut Option<EditorCommand>) {
    ui.menu_button(say::program_file().text(language), |ui| {
        let entries = [
            (say::program_new(), EditorCommand::LoadText(TextToLoad::New)),
            (
                say::program_open(),
                EditorCommand::LoadText(TextToLoad::Choose),
            ),
            (say::program_save(), EditorCommand::Save),
            (say::program_save_as(), EditorCommand::SaveAs),
            (say::program_form(), EditorCommand::OpenForm),
            (say::program_port(), EditorCommand::OpenPort),
            (say::program_print(), EditorCommand::Print),
        ];
        for (words, what) in entries {
            if ui.button(words.text(language)).clicked() {
                *command = Some(what);
                ui.close();
            }
        }
    });
}

/// Draws the menu of the programs in the control's memory and stores the chosen command in
/// `command`.
fn show_program_menu(
    ui: &mut Ui,
    memory: &[u16],
    (language, naming): (Language, ProgramNaming),
    command: &mut Option<EditorCommand>,
) {
    let menu = ui.menu_button(say::program_control().text(language), |ui| {
        let list = ScrollArea::vertical().max_height(MENU_HEIGHT);
        list.show(ui, |ui| {
            for number in memory {
                if ui.button(naming.name(*number)).clicked() {
                    *command = Some(EditorCommand::LoadText(TextToLoad::Memory(Some(*number))));
                    ui.close();
                }
            }
        });
    });
    let hint = say::program_control_hint().text(language);
    menu.response.on_hover_text(hint);
}

/// The name of the text, with a mark if the text is not saved.
fn document_title(document: &ProgramDocument, naming: ProgramNaming, language: Language) -> String {
    let mark = if document.is_unsaved() { "● " } else { "" };
    let name = match &document.origin {
        TextOrigin::New => say::program_new_name().text(language),
        TextOrigin::File(_, encoding) => format!("{} ({encoding})", document.name(naming)),
        TextOrigin::Memory(_) => document.name(naming),
    };
    format!("{mark}{name}")
}

/// The user's decision about an unsaved text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnsavedAnswer {
    /// Save the text before another one is loaded.
    Save,
    /// Discard the changes before another text is loaded.
    Discard,
    /// Keep the text in the editor; the other text is not loaded.
    Cancel,
}

/// Size of the window with the question, points.
const QUESTION_SIZE: egui::Vec2 = egui::vec2(520.0, 180.0);

/// Draws the question whether to save the unsaved text `name`. Returns the answer, or `None`
/// while it is open.
pub fn ask_to_save(context: &Context, name: &str, language: Language) -> Option<UnsavedAnswer> {
    let mut answer = None;
    Window::new(say::program_unsaved_title(name).text(language))
        .id(egui::Id::unique("unsaved program"))
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, [0.0, -60.0])
        .constrain_to(stop_key_clearance::free_rect(context, QUESTION_SIZE))
        .show(context, |ui| {
            ui.label(say::program_unsaved_lost(name).text(language));
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                for (words, what) in [
                    (say::program_save(), UnsavedAnswer::Save),
                    (say::program_discard(), UnsavedAnswer::Discard),
                    (say::program_keep(), UnsavedAnswer::Cancel),
                ] {
                    if ui.button(words.text(language)).clicked() {
                        answer = Some(what);
                    }
                }
            });
        });
    answer
}
