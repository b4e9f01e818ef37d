//! The program view: a text editor for users at a PC, with colours, the alarms of the text
//! while it is typed, and the meaning of its words. The control's edit page is separate.

mod bar;
mod check;
mod desk;
mod document;
mod editor;
mod paint;
mod targets;
pub use std::ops::Range;
use std::path::{Path, PathBuf};

use egui::{Context, Panel, RichText, ScrollArea, Ui};
use gsk_core::command::ProgramId;
use gsk_messages::{Language, Message, say};

use super::{bar_frame, plain_frame, side_frame};
use crate::kernel::{Console, Place};
use crate::window::focus;
use crate::window::message::why_not;
use bar::{Bar, Wish};
use check::{Checked, Checker};
use desk::{Arrived, Desk};
use document::file_name;
pub use document::{Document, Origin, with_line_feeds};
use editor::Sheet;
use paint::{Painter, WRONG};
use targets::Target;

/// A text that shall be loaded into the editor.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Next {
    /// An empty text.
    New,
    /// A file that the user chooses.
    Choose,
    File(PathBuf),
    /// A program of the control's memory; `None`: the selected one.
    Memory(Option<u16>),
}

pub struct ProgramView {
    document: Document,
    desk: Desk,
    checker: Checker,
    checked: Option<Checked>,
    painter: Painter,
    bar: Bar,
    /// The range of characters to select and scroll to.
    jump: Option<Range<usize>>,
    /// End of the last search match, bytes. A read-only text has no cursor to search from.
    found: usize,
    /// The text to load once the current one is saved or discarded.
    next: Option<Next>,
    /// A text was requested and has not arrived.
    bringing: bool,
    /// A request of another view.
    wanted: Option<Wanted>,
    /// The revision that was last passed to other views.
    told: u64,
    /// The last message of the view.
    said: Option<Said>,
}

/// A request of another view.
enum Wanted {
    /// Show a block, identified by line and text.
    Block { line: u32, text: String },
    /// Replace the text `own` with `text`.
    Text { own: String, text: String },
}

impl Wanted {
    /// Whether the text that the request applies to is in the editor.
    fn is_in(&self, document: &Document) -> bool {
        match self {
            Self::Block { line, text } => {
                let index = line.checked_sub(1).map(|index| index as usize);
                index.is_some_and(|index| document.line(index).trim() == text.trim())
            }
            Self::Text { own, .. } => document.text.trim() == with_line_feeds(own).trim(),
        }
    }
}

/// A message of the view.
enum Said {
    Good(Message),
    Bad(Message),
    NotStored(crate::kernel::NotStored),
}

impl ProgramView {
    /// Creates the view. It loads the selected program of the control first.
    pub fn new(console: Console) -> Self {
        Self {
            document: Document::new(Origin::New, ""),
            checker: Checker::new(&console),
            desk: Desk::new(console),
            checked: None,
            painter: Painter::default(),
            bar: Bar::default(),
            jump: None,
            found: 0,
            next: Some(Next::Memory(None)),
            bringing: false,
            wanted: None,
            told: 0,
            said: None,
        }
    }

    /// Loads a program that was opened in the window.
    pub fn opened(&mut self, path: Option<&Path>, place: &Place) {
        self.next = Some(match (path, place) {
            (Some(path), _) => Next::File(path.to_owned()),
            (None, Place::Stored(number)) => Next::Memory(Some(*number)),
            (None, Place::OnlyRun(_)) => return,
        });
    }

    /// The document, if its revision has changed since the last call.
    pub fn newly_typed(&mut self) -> Option<&Document> {
        let revision = self.document.revision;
        (std::mem::replace(&mut self.told, revision) != revision).then_some(&self.document)
    }

    /// Shows a block of a program. `text` is the text of the block in another view.
    pub fn show_block(&mut self, program: ProgramId, line: u32, text: String) {
        self.wanted = Some(Wanted::Block { line, text });
        self.bring_program(program);
    }

    /// Replaces the control's text `own` with `text`. The change can be undone and is not
    /// saved.
    pub fn take_over(&mut self, program: ProgramId, own: String, text: String) {
        self.wanted = Some(Wanted::Text { own, text });
        self.bring_program(program);
    }

    /// Loads a program from the memory unless its text is in the editor.
    fn bring_program(&mut self, program: ProgramId) {
        let ProgramId::Stored(number) = program else {
            return;
        };
        let wanted = self.wanted.as_ref();
        if !wanted.is_some_and(|wanted| wanted.is_in(&self.document)) && self.next.is_none() {
            self.next = Some(Next::Memory(Some(number)));
        }
    }

    /// Executes the request of another view once the text is loaded.
    fn carry_out_wanted(&mut self, context: &Context) {
        let Some(wanted) = self.wanted.take_if(|_| self.next.is_none()) else {
            return;
        };
        if !wanted.is_in(&self.document) {
            // The text has not arrived yet.
            if self.bringing {
                self.wanted = Some(wanted);
                return;
            }
            self.said = Some(Said::Bad(say::program_other_text()));
            return;
        }
        match wanted {
            Wanted::Block { line, .. } => self.go_to(Target::Line(line), 0, context),
            Wanted::Text { text, .. } => {
                self.document.text = with_line_feeds(&text);
                self.document.changed();
                self.said = Some(Said::Good(say::program_taken_over()));
            }
        }
    }

    /// Whether closing the window would lose the text.
    pub const fn is_unsaved(&self) -> bool {
        self.document.is_unsaved()
    }

    /// Draws the view. `native`: it is in a separate window and receives all keys.
    pub fn show(&mut self, ui: &mut Ui, language: Language, native: bool) {
        self.receive(ui.ctx());
        self.keys(ui, language, native);
        let document = &self.document;
        let memory = self
            .checked
            .as_ref()
            .map_or(&[][..], |checked| &checked.memory);
        let tools = Panel::top("program bar").frame(bar_frame());
        let wish = tools
            .show(ui, |ui| self.bar.show(ui, document, memory, language))
            .inner;
        if let Some(wish) = wish {
            self.carry_out(wish, ui.ctx(), language);
        }
        focus::pass_over_edge(ui, "program findings");
        Panel::bottom("program findings")
            .frame(side_frame())
            .resizable(true)
            .default_size(124.0)
            .min_size(60.0)
            .show(ui, |ui| self.findings(ui, language));
        egui::CentralPanel::default()
            .frame(plain_frame())
            .show(ui, |ui| self.text(ui, language));
        self.question(ui.ctx(), language);
        let document = &self.document;
        self.checker.ask(document.revision, ui.ctx(), || {
            (document.name(), document.text.clone())
        });
    }

    fn text(&mut self, ui: &mut Ui, language: Language) {
        let checked = self.checked.as_ref();
        let marks = checked.map_or((None, &[][..]), |checked| {
            (Some(checked.revision), &checked.findings[..])
        });
        let line = self
            .jump
            .as_ref()
            .map(|range| self.document.line_at(self.document.byte_of(range.start)));
        let edited = self.document.is_edited();
        let sheet = Sheet {
            document: &mut self.document,
            marks,
            language,
        };
        if !edited {
            self.jump = None;
            return editor::show(ui, &sheet, line);
        }
        let done = editor::edit(ui, sheet, &mut self.painter, &mut self.jump);
        if done.changed {
            self.said = None;
        }
        if let Some((target, line)) = done.followed {
            self.go_to(target, line, ui.ctx());
        }
    }

    /// Takes texts from files and memory, and the result of the check.
    fn receive(&mut self, context: &Context) {
        if let Some(checked) = self.checker.result() {
            self.checked = Some(checked);
        }
        while let Some(arrived) = self.desk.arrived() {
            self.bringing = false;
            self.said = match arrived {
                Arrived::Text(document) => {
                    self.replace(*document, context);
                    None
                }
                Arrived::Saved { text, origin } => {
                    let Origin::File(path, _) = &origin else {
                        continue;
                    };
                    let said = say::window_saved(path.display());
                    self.document.saved(text, origin);
                    Some(Said::Good(said))
                }
                Arrived::Stored { text, number } => {
                    // A text that has a file is saved only when it is written there.
                    if !matches!(self.document.origin, Origin::File(..)) {
                        self.document.saved(text, Origin::Memory(number));
                    }
                    self.checker.forget();
                    Some(Said::Good(say::program_stored(number)))
                }
                Arrived::NotStored(why) => Some(Said::NotStored(why)),
                Arrived::Refused(why) => Some(Said::Bad(why)),
            };
        }
        // Unsaved changes are kept: `question` asks the user first.
        if !self.document.is_unsaved()
            && let Some(next) = self.next.take()
        {
            self.bring(next, context);
        }
        self.carry_out_wanted(context);
    }

    /// Puts another document into the editor. Revisions continue to increase.
    fn replace(&mut self, document: Document, context: &Context) {
        let revision = self.document.revision + 1;
        self.document = document;
        self.document.revision = revision;
        self.checked = None;
        self.jump = None;
        self.found = 0;
        editor::forget(context);
    }

    fn bring(&mut self, next: Next, context: &Context) {
        self.bringing = matches!(next, Next::File(_) | Next::Memory(_));
        match next {
            Next::New => self.replace(Document::new(Origin::New, ""), context),
            Next::Choose => self.desk.choose(self.bar.language, context),
            Next::File(path) => self.desk.read(path, context),
            Next::Memory(number) => self.desk.take(number, context),
        }
    }

    fn carry_out(&mut self, wish: Wish, context: &Context, language: Language) {
        match wish {
            Wish::Bring(next) => self.next = Some(next),
            Wish::Save => self.desk.save(&self.document, language, context),
            Wish::SaveAs => self.desk.save_as(&self.document, language, context),
            Wish::Store => self.desk.store(&self.document, context),
            Wish::Undo => self.step(context, false),
            Wish::Redo => self.step(context, true),
            Wish::Find => self.find(context),
            Wish::GoTo => {
                let typed = self.bar.go_to.clone();
                match Target::typed(&typed) {
                    Some(target) => self.go_to(target, 0, context),
                    None => self.said = Some(Said::Bad(say::program_go_to_nothing(typed))),
                }
            }
        }
    }

    fn step(&mut self, context: &Context, again: bool) {
        if let Some(text) = editor::step(context, &self.document.text, again) {
            self.document.text = text;
            self.document.changed();
        }
    }

    /// Selects the next match after the cursor.
    fn find(&mut self, context: &Context) {
        let sought = self.bar.find.clone();
        let cursor = editor::cursor(context).filter(|_| self.document.is_edited());
        let from = cursor.map_or(self.found, |range| self.document.byte_of(range.end));
        match targets::find(&self.document.text, &sought, from) {
            Some(found) => {
                self.found = found.end;
                self.select(&found);
            }
            None => self.said = Some(Said::Bad(say::program_find_nothing(sought))),
        }
    }

    /// Goes to a block, a program of this text or of the memory, or a line.
    fn go_to(&mut self, target: Target, from_line: usize, context: &Context) {
        if let Some(line) = target.line_in(&self.document.text, from_line) {
            let start = self.document.line_start(line);
            let end = start + self.document.line(line).len();
            return self.select(&(start..end));
        }
        let known = |number| {
            let checked = self.checked.as_ref();
            checked.is_some_and(|checked| checked.memory.contains(&number))
        };
        match target {
            Target::Program(number) if known(number) => {
                self.next = Some(Next::Memory(Some(number)));
                context.request_repaint();
            }
            Target::Program(number) => self.nothing(format!("O{number:04}")),
            Target::Sequence(number) => self.nothing(format!("N{number}")),
            Target::Line(line) => self.nothing(line.to_string()),
        }
    }

    fn nothing(&mut self, target: String) {
        self.said = Some(Said::Bad(say::program_go_to_nothing(target)));
    }

    /// Selects a range of bytes of the text and scrolls to it.
    fn select(&mut self, bytes: &Range<usize>) {
        let characters = |byte| self.document.character_of(byte);
        self.jump = Some(characters(bytes.start)..characters(bytes.end));
        self.said = None;
    }

    /// Handles the keys of the view. The text field handles undo and redo.
    fn keys(&mut self, ui: &mut Ui, language: Language, native: bool) {
        self.bar.language = language;
        let typing = ui.ctx().text_edit_focused();
        if let Some(wish) = self.bar.keys(ui, typing || native) {
            self.carry_out(wish, &ui.ctx().clone(), language);
        }
    }

    /// Draws the last message and the findings of the check.
    fn findings(&mut self, ui: &mut Ui, language: Language) {
        let said = self.said.as_ref().map(|said| match said {
            Said::Good(said) => (said.text(language), None),
            Said::Bad(said) => (said.text(language), Some(WRONG)),
            Said::NotStored(why) => (why_not(why, language).text(language), Some(WRONG)),
        });
        if let Some((text, color)) = said {
            let text = RichText::new(text);
            ui.label(color.map_or(text.clone(), |color| text.color(color)));
        }
        if !self.document.is_edited() {
            let limit = document::LARGEST_EDITED / 1000;
            ui.label(say::program_large(limit).text(language));
        }
        let newest = self.checked.as_ref();
        let Some(checked) = newest.filter(|it| it.revision == self.document.revision) else {
            ui.weak(say::program_checking().text(language));
            return;
        };
        let mut go = None;
        ScrollArea::vertical()
            .auto_shrink([false, false])
            .show(ui, |ui| {
                if checked.is_given_up() {
                    let words = say::program_given_up().text(language);
                    ui.label(RichText::new(words).color(WRONG));
                } else if checked.findings.is_empty() {
                    ui.label(checked.look.line(language));
                }
                let name = say::program_findings_name().text(language);
                let count = checked.findings.len();
                let list = focus::List::begin(ui, "findings", &name, count, None);
                for (at, finding) in checked.findings.iter().enumerate() {
                    let told = finding.told(language);
                    let sentence = RichText::new(told.sentence(Some(language))).color(WRONG);
                    let link = focus::link(ui, sentence);
                    if list.row(ui, at, &link) || list.entered() == Some(at) {
                        go = finding.line.map(|line| (line, finding.columns.clone()));
                    }
                    let helps = [
                        told.cause.map(say::window_alarm_cause),
                        told.way_out.map(say::window_alarm_way_out),
                    ];
                    for said in helps.into_iter().flatten() {
                        ui.label(said.text(language));
                    }
                }
                for warning in &checked.warnings {
                    ui.label(warning.text(language));
                }
            });
        if let Some((line, columns)) = go {
            let start = self.document.character_of(self.document.line_start(line));
            self.jump = Some(start + columns.start..start + columns.end);
        }
    }

    /// Asks what to do with an unsaved text before another one is loaded.
    fn question(&mut self, context: &Context, language: Language) {
        if self.next.is_none() || !self.document.is_unsaved() {
            return;
        }
        let name = match &self.document.origin {
            Origin::File(path, _) => file_name(path),
            Origin::New => say::program_new_name().text(language),
            Origin::Memory(_) => self.document.name(),
        };
        match bar::ask_to_save(context, &name, language) {
            Some(bar::Answer::Save) => {
                let document = &self.document;
                match document.origin {
                    Origin::Memory(_) => self.desk.store(document, context),
                    Origin::File(..) | Origin::New => self.desk.save(document, language, context),
                }
            }
            Some(bar::Answer::Discard) => {
                if let Some(next) = self.next.take() {
                    self.bring(next, context);
                }
            }
            Some(bar::Answer::Cancel) => self.next = None,
            None => {}
        }
    }
}
