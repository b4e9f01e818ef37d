//! The program view: a text editor for users at a PC, with colours, the alarms of the text
//! while it is typed, and the meaning of its words. The control's edit page is separate.

mod bar;
mod breakpoints;
mod check;
mod document;
mod document_store;
mod editor;
mod findings;
mod form_sections;
mod list_entry;
mod paint;
mod port_pane;
mod print;
mod restart;
mod run_follower;
mod targets;
mod watches;
pub use std::ops::Range;
use std::path::{Path, PathBuf};

use egui::{Context, Panel, Ui};
use gsk_core::command::ProgramId;
use gsk_host::kernel::{Console, PanelSnapshot, ProgramPlacement};
use gsk_messages::{Language, Message, say};

use super::form::{FormPane, SectionFinder};
use super::interface::{View, ViewFrame, ViewStart};
use super::{bar_frame, plain_frame, side_frame};
use crate::focus;
use crate::widgets::questions::Unsaved;
use bar::{EditorCommand, ProgramBar};
use breakpoints::BreakpointList;
pub use breakpoints::{halt_text, show_halt_buttons};
use check::{TextCheck, TextChecker};
pub use document::{ProgramDocument, TextOrigin, with_line_feeds};
use document_store::{DocumentEvent, DocumentStore};
use editor::EditorInputs;
use paint::TextColorizer;
use port_pane::PortPane;
use restart::RestartDialog;
use run_follower::RunFollower;
use targets::JumpTarget;

/// The text to load into the editor.
#[derive(Clone, Debug, PartialEq, Eq)]
enum TextToLoad {
    /// Load an empty new text.
    New,
    /// A new text with this content.
    NewProgram {
        text: String,
        notice: Message,
    },
    /// The file that the user chooses in a dialog.
    Choose,
    File(PathBuf),
    /// This program of the control's memory; `None`: the selected one.
    Memory(Option<u16>),
}

pub struct ProgramView {
    document: ProgramDocument,
    document_store: DocumentStore,
    checker: TextChecker,
    last_check: Option<TextCheck>,
    painter: TextColorizer,
    restart: RestartDialog,
    form: FormPane,
    port: PortPane,
    sections: SectionFinder,
    breakpoints: BreakpointList,
    run_follower: RunFollower,
    bar: ProgramBar,
    /// The range of characters to select and scroll to in the next frame; `None`: none.
    selection_to_show: Option<Range<usize>>,
    /// Byte offset of the end of the last search match, where the search continues in a
    /// read-only text, which has no cursor.
    search_start: usize,
    /// The text to load once the current one is saved or discarded; `None`: none.
    text_to_load: Option<TextToLoad>,
    /// Whether a text was requested and has not arrived yet.
    is_loading: bool,
    /// A request of another view that waits for its text; `None` without one.
    request: Option<EditorRequest>,
    /// The revision of the document that was passed to other views last.
    reported_revision: u64,
    /// The last message that the view shows; `None` without one.
    message: Option<EditorMessage>,
}

/// A request of another view to the program view.
enum EditorRequest {
    /// Show the block that is identified by its line and text.
    ShowBlock { line: u32, text: String },
    /// Replace the text `own` of the control with `text`.
    ReplaceText {
        control_text: String,
        new_text: String,
    },
}

impl EditorRequest {
    /// Whether the editor contains the text to which the request applies.
    fn applies_to(&self, document: &ProgramDocument) -> bool {
        match self {
            Self::ShowBlock { line, text } => {
                let index = line.checked_sub(1).map(|index| index as usize);
                index.is_some_and(|index| document.line(index).trim() == text.trim())
            }
            Self::ReplaceText {
                control_text: own, ..
            } => document.text.trim() == with_line_feeds(own).trim(),
        }
    }
}

/// A message that the program view shows below the text.
enum EditorMessage {
    Good(Message),
    Bad(Message),
    NotStored(gsk_host::kernel::NotStored),
}

impl View for ProgramView {
    fn create(start: ViewStart<'_>) -> Self {
        Self::new(start.console.clone(), &start.settings.watches)
    }

    fn show(&mut self, ui: &mut Ui, frame: ViewFrame<'_>) {
        self.draw(ui, frame.language, frame.owns_keys);
    }

    fn unsaved(&self) -> Option<Unsaved> {
        self.document.is_unsaved().then_some(Unsaved::Text)
    }
}

impl ProgramView {
    /// Creates the view, which loads the selected program of the control first.
    pub fn new(console: Console, watched: &[String]) -> Self {
        Self {
            document: ProgramDocument::new(TextOrigin::New, ""),
            checker: TextChecker::new(&console),
            restart: RestartDialog::new(console.clone()),
            form: FormPane::new(&console),
            port: PortPane::default(),
            sections: SectionFinder::default(),
            breakpoints: BreakpointList::new(console.clone(), watched),
            run_follower: RunFollower::default(),
            document_store: DocumentStore::new(console),
            last_check: None,
            painter: TextColorizer::default(),
            bar: ProgramBar::default(),
            selection_to_show: None,
            search_start: 0,
            text_to_load: Some(TextToLoad::Memory(None)),
            is_loading: false,
            request: None,
            reported_revision: 0,
            message: None,
        }
    }

    /// The names of the watched values.
    pub fn watched(&self) -> &[String] {
        self.breakpoints.watches.names()
    }

    /// Loads a program that was opened in the window, from its file or from the control.
    pub fn load_opened(&mut self, path: Option<&Path>, location: &ProgramPlacement) {
        self.text_to_load = Some(match (path, location) {
            (Some(path), _) => TextToLoad::File(path.to_owned()),
            (None, ProgramPlacement::Stored(number)) => TextToLoad::Memory(Some(*number)),
            (None, ProgramPlacement::OnlyRun(_)) => return,
        });
    }

    /// Stores the state of the program that runs. At a new halt its program is shown, unless a
    /// text is unsaved.
    pub fn take_snapshot(&mut self, snapshot: &PanelSnapshot) {
        let Some(block) = self.breakpoints.take_snapshot(snapshot) else {
            return;
        };
        self.run_follower.request();
        if let ProgramId::Stored(number) = block.program
            && !BreakpointList::is_program(&self.document, block.program)
            && !self.document.is_unsaved()
        {
            self.text_to_load = Some(TextToLoad::Memory(Some(number)));
        }
    }

    /// Returns the document if its revision has changed since the last call; else `None`.
    pub fn take_changed_document(&mut self) -> Option<&ProgramDocument> {
        let revision = self.document.revision;
        (std::mem::replace(&mut self.reported_revision, revision) != revision)
            .then_some(&self.document)
    }

    /// Loads a program and shows one of its blocks. `text` is the text of the block in another
    /// view.
    pub fn show_block(&mut self, program: ProgramId, line: u32, text: String) {
        self.request = Some(EditorRequest::ShowBlock { line, text });
        self.load_program(program);
    }

    /// Replaces the control's text `own` with `text` in the editor. The change can be undone
    /// and is not saved.
    pub fn replace_text(&mut self, program: ProgramId, own: String, text: String) {
        self.request = Some(EditorRequest::ReplaceText {
            control_text: own,
            new_text: text,
        });
        self.load_program(program);
    }

    /// Loads a program from the memory, unless the editor contains its text.
    fn load_program(&mut self, program: ProgramId) {
        let ProgramId::Stored(number) = program else {
            return;
        };
        let request = self.request.as_ref();
        if !request.is_some_and(|wanted| wanted.applies_to(&self.document))
            && self.text_to_load.is_none()
        {
            self.text_to_load = Some(TextToLoad::Memory(Some(number)));
        }
    }

    /// Carries out the request of another view once the text is loaded.
    fn handle_request(&mut self, context: &Context) {
        let Some(request) = self.request.take_if(|_| self.text_to_load.is_none()) else {
            return;
        };
        if !request.applies_to(&self.document) {
            // The text has not arrived yet.
            if self.is_loading {
                self.request = Some(request);
                return;
            }
            self.message = Some(EditorMessage::Bad(say::program_other_text()));
            return;
        }
        match request {
            EditorRequest::ShowBlock { line, .. } => self.go_to(JumpTarget::Line(line), 0, context),
            EditorRequest::ReplaceText { new_text: text, .. } => {
                self.document.text = with_line_feeds(&text);
                self.document.update_after_change();
                self.message = Some(EditorMessage::Good(say::program_taken_over()));
            }
        }
    }

    /// Draws the view. `native`: the view is in a separate window and receives all keys.
    fn draw(&mut self, ui: &mut Ui, language: Language, native: bool) {
        self.receive_events(ui.ctx());
        if self.form.is_open() {
            return self.show_form(ui, language);
        }
        if self.port.is_open() {
            return self.show_port(ui, language);
        }
        self.handle_keys(ui, language, native);
        let is_in_form = self.cursor_section(ui.ctx()).is_some();
        let document = &self.document;
        let memory = self
            .last_check
            .as_ref()
            .map_or(&[][..], |checked| &checked.stored_programs);
        let tools = Panel::top("program bar").frame(bar_frame());
        let (bar, breakpoints) = (&mut self.bar, &mut self.breakpoints);
        let command = tools
            .show(ui, |ui| {
                bar.show(ui, document, memory, (breakpoints, is_in_form), language)
            })
            .inner;
        if let Some(command) = command {
            self.execute(command, ui.ctx(), language);
        }
        focus::skip_resize_edge(ui, "program findings");
        Panel::bottom("program findings")
            .frame(side_frame())
            .resizable(true)
            .default_size(72.0)
            .min_size(60.0)
            .show(ui, |ui| self.show_findings(ui, language));
        egui::CentralPanel::default()
            .frame(plain_frame())
            .show(ui, |ui| self.show_text(ui, language));
        self.show_unsaved_question(ui.ctx(), language);
        self.restart.show(ui.ctx(), language);
        let (document, naming) = (&self.document, self.breakpoints.naming());
        self.checker.request_check(document.revision, ui.ctx(), || {
            (document.name(naming), document.text.clone())
        });
    }

    fn show_text(&mut self, ui: &mut Ui, language: Language) {
        let checked = self.last_check.as_ref();
        let marks = checked.map_or((None, &[][..]), |checked| {
            (Some(checked.revision), &checked.findings[..])
        });
        let line = self.selection_to_show.as_ref().map(|range| {
            self.document
                .line_at(self.document.byte_of_character(range.start))
        });
        let edited = self.document.is_editable();
        let margin = self.breakpoints.margin_marks(&self.document);
        // The text follows the program that runs, unless the cursor is in it.
        let is_edited = ui.memory(|memory| memory.has_focus(editor::text_field_id()));
        let height = ui.available_height();
        let shows_running_line =
            (self.run_follower).should_scroll(margin.running_line, height, is_edited);
        let sheet = EditorInputs {
            document: &mut self.document,
            marks,
            margin,
            shows_running_line,
            language,
        };
        if !edited {
            self.selection_to_show = None;
            if let Some(line) = editor::show_read_only(ui, &sheet, line) {
                self.breakpoints.toggle_line(&self.document, line);
            }
            return;
        }
        let done = editor::show_editable(ui, sheet, &mut self.painter, &mut self.selection_to_show);
        if done.is_changed {
            self.message = None;
        }
        if let Some(line) = done.breakpoint_line {
            self.breakpoints.toggle_line(&self.document, line);
        }
        if let Some(line) = done.restart_line {
            let text = self.document.text.clone();
            self.restart.open(text, line, ui.ctx());
        }
        if let Some((target, line)) = done.clicked_target {
            self.go_to(target, line, ui.ctx());
        }
        if done.opens_form {
            self.open_form(ui.ctx());
        }
    }

    /// Receives texts from files and memory, and the result of the check.
    fn receive_events(&mut self, context: &Context) {
        if let Some(checked) = self.checker.take_result() {
            self.last_check = Some(checked);
        }
        while let Some(arrived) = self.document_store.next_event() {
            self.is_loading = false;
            self.message = match arrived {
                DocumentEvent::Loaded(document) => {
                    self.set_document(*document, context);
                    None
                }
                DocumentEvent::Saved { text, origin } => {
                    let TextOrigin::File(path, _) = &origin else {
                        continue;
                    };
                    let message = say::window_saved(path.display());
                    self.document.mark_saved(text, origin);
                    Some(EditorMessage::Good(message))
                }
                DocumentEvent::Stored { text, number } => {
                    // A text that has a file is saved only when it is written there.
                    if !matches!(self.document.origin, TextOrigin::File(..)) {
                        self.document.mark_saved(text, TextOrigin::Memory(number));
                    }
                    self.checker.force_next_check();
                    let name = self.breakpoints.naming().name(number);
                    Some(EditorMessage::Good(say::program_stored(name)))
                }
                DocumentEvent::Printed(message) => Some(EditorMessage::Good(message)),
                DocumentEvent::NotStored(why) => Some(EditorMessage::NotStored(why)),
                DocumentEvent::Failed(why) => Some(EditorMessage::Bad(why)),
            };
        }
        // Unsaved changes are kept: `show_unsaved_question` asks the user first.
        if !self.document.is_unsaved()
            && let Some(next) = self.text_to_load.take()
        {
            self.load_text(next, context);
        }
        self.handle_request(context);
    }

    /// Puts another document into the editor. Its revision number continues that of the last
    /// one.
    fn set_document(&mut self, document: ProgramDocument, context: &Context) {
        let revision = self.document.revision + 1;
        self.document = document;
        self.document.revision = revision;
        self.last_check = None;
        self.selection_to_show = None;
        self.search_start = 0;
        editor::clear_undo(context);
    }

    fn load_text(&mut self, next: TextToLoad, context: &Context) {
        self.is_loading = matches!(next, TextToLoad::File(_) | TextToLoad::Memory(_));
        match next {
            TextToLoad::New => {
                self.set_document(ProgramDocument::new(TextOrigin::New, ""), context);
            }
            TextToLoad::NewProgram { text, notice } => {
                self.set_document(ProgramDocument::new(TextOrigin::New, ""), context);
                self.document.text = text;
                self.document.update_after_change();
                self.message = Some(EditorMessage::Good(notice));
            }
            TextToLoad::Choose => self.document_store.choose_file(self.bar.language, context),
            TextToLoad::File(path) => self.document_store.load_file(path, context),
            TextToLoad::Memory(number) => self.document_store.load_program(number, context),
        }
    }

    fn execute(&mut self, command: EditorCommand, context: &Context, language: Language) {
        match command {
            EditorCommand::LoadText(next) => self.text_to_load = Some(next),
            EditorCommand::Save => self.document_store.save(&self.document, language, context),
            EditorCommand::SaveAs => self
                .document_store
                .save_as(&self.document, language, context),
            EditorCommand::Store => self.document_store.store(&self.document, context),
            EditorCommand::Undo => self.undo_or_redo(context, false),
            EditorCommand::Redo => self.undo_or_redo(context, true),
            EditorCommand::Find => self.find_next(context),
            EditorCommand::OpenForm => self.open_form(context),
            EditorCommand::Print => {
                self.message = Some(EditorMessage::Good(say::program_print_running()));
                self.document_store.print(&self.document, language, context);
            }
            EditorCommand::OpenPort => self.port.open(&self.document.text),
            EditorCommand::GoTo => {
                let typed = self.bar.target_text.clone();
                match JumpTarget::parse(&typed) {
                    Some(target) => self.go_to(target, 0, context),
                    None => {
                        self.message = Some(EditorMessage::Bad(say::program_go_to_nothing(typed)));
                    }
                }
            }
        }
    }

    fn undo_or_redo(&mut self, context: &Context, redo: bool) {
        if let Some(text) = editor::undo_or_redo(context, &self.document.text, redo) {
            self.document.text = text;
            self.document.update_after_change();
        }
    }

    /// Selects the next match of the search text after the cursor.
    fn find_next(&mut self, context: &Context) {
        let sought = self.bar.search_text.clone();
        let cursor = editor::cursor_range(context).filter(|_| self.document.is_editable());
        let from = cursor.map_or(self.search_start, |range| {
            self.document.byte_of_character(range.end)
        });
        match targets::find_text(&self.document.text, &sought, from) {
            Some(found) => {
                self.search_start = found.end;
                self.select_bytes(&found);
            }
            None => self.message = Some(EditorMessage::Bad(say::program_find_nothing(sought))),
        }
    }

    /// Goes to a block after `from_line`, a program of this text or of the memory, or a line.
    fn go_to(&mut self, target: JumpTarget, from_line: usize, context: &Context) {
        if let Some(line) = target.find_line(&self.document.text, from_line) {
            let start = self.document.line_start(line);
            let end = start + self.document.line(line).len();
            return self.select_bytes(&(start..end));
        }
        let known = |number| {
            let checked = self.last_check.as_ref();
            checked.is_some_and(|checked| checked.stored_programs.contains(&number))
        };
        match target {
            JumpTarget::Program(number) if known(number) => {
                self.text_to_load = Some(TextToLoad::Memory(Some(number)));
                context.request_repaint();
            }
            JumpTarget::Program(number) => {
                self.report_missing_target(self.breakpoints.naming().name(number));
            }
            JumpTarget::Sequence(number) => self.report_missing_target(format!("N{number}")),
            JumpTarget::Line(line) => self.report_missing_target(line.to_string()),
        }
    }

    fn report_missing_target(&mut self, target: String) {
        self.message = Some(EditorMessage::Bad(say::program_go_to_nothing(target)));
    }

    /// Selects a range of bytes of the text and scrolls there.
    fn select_bytes(&mut self, bytes: &Range<usize>) {
        let characters = |byte| self.document.character_at_byte(byte);
        self.selection_to_show = Some(characters(bytes.start)..characters(bytes.end));
        self.message = None;
    }

    /// Handles the keys of the view except undo and redo, which the text field handles.
    fn handle_keys(&mut self, ui: &mut Ui, language: Language, native: bool) {
        self.bar.language = language;
        let typing = ui.ctx().text_edit_focused();
        if let Some(command) = self.bar.handle_keys(ui, typing || native) {
            self.execute(command, &ui.ctx().clone(), language);
        }
    }
}
