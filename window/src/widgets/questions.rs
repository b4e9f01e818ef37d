//! Asks for confirmation before something is ended or overwritten. The keys that stop the
//! machine stay uncovered: a stop must not wait for an answer.

use egui::{Align2, Context, ViewportCommand, Window};
use gsk_core::operation::RunState;
use gsk_host::kernel::{Command, Console, OpenedProgram, PanelSnapshot, StorePolicy};

use crate::placement::stop_key_clearance;
use gsk_messages::{Language, Message, say};

/// The state of a request to close the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum CloseRequest {
    #[default]
    None,
    /// The window was to be closed while a program runs or work is unsaved; the operator must
    /// confirm.
    Pending,
    /// The window closes without further questions.
    Confirmed,
}

/// The kinds of the operator's work that may not be saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsaved {
    Text,
    Job,
    Project,
}

impl Unsaved {
    /// The question before this work is lost, and the consequence of closing.
    fn question(self) -> [Message; 2] {
        match self {
            Self::Text => [say::question_text_unsaved(), say::question_text_is_lost()],
            Self::Job => [say::question_job_unsaved(), say::question_job_is_lost()],
            Self::Project => [say::project_view_unsaved(), say::project_view_is_lost()],
        }
    }
}

/// Preferred size of the window with a question, points.
const QUESTION_SIZE: egui::Vec2 = egui::vec2(520.0, 180.0);

/// The questions of the main window that wait for an answer.
#[derive(Debug, Default)]
pub struct Questions {
    closing: CloseRequest,
    /// A program to open, and its program number, which another program in the memory has.
    number_conflict: Option<(Box<OpenedProgram>, u16)>,
}

impl Questions {
    /// Lets the window close without a question from now on.
    pub const fn allow_closing(&mut self) {
        self.closing = CloseRequest::Confirmed;
    }

    /// Opens the question about an opened program whose `number` another program in memory already
    /// has.
    pub fn ask_about_number(&mut self, opened: Box<OpenedProgram>, number: u16) {
        self.number_conflict = Some((opened, number));
    }

    /// Draws the open questions and carries out the answers.
    pub fn show(
        &mut self,
        context: &Context,
        language: Language,
        snapshot: Option<&PanelSnapshot>,
        console: &Console,
        unsaved: Option<Unsaved>,
    ) {
        self.show_close_question(context, language, snapshot, unsaved);
        self.show_number_question(context, language, console);
    }

    fn show_close_question(
        &mut self,
        context: &Context,
        language: Language,
        snapshot: Option<&PanelSnapshot>,
        unsaved: Option<Unsaved>,
    ) {
        let Some([title, consequence, agree]) = close_question(snapshot, unsaved) else {
            if self.closing == CloseRequest::Pending {
                self.closing = CloseRequest::None;
            }
            return;
        };
        let is_requested = context.input(|input| input.viewport().close_requested());
        if is_requested && self.closing != CloseRequest::Confirmed {
            context.send_viewport_cmd(ViewportCommand::CancelClose);
            self.closing = CloseRequest::Pending;
        }
        if self.closing != CloseRequest::Pending {
            return;
        }
        let [title, consequence] = [title, consequence].map(|message| message.text(language));
        let answers = [
            say::question_do_not_close().text(language),
            agree.text(language),
        ];
        match show_question(context, "closing", &title, &consequence, &answers) {
            Some(1) => {
                self.closing = CloseRequest::Confirmed;
                context.send_viewport_cmd(ViewportCommand::Close);
            }
            Some(_) => self.closing = CloseRequest::None,
            None => {}
        }
    }

    fn show_number_question(&mut self, context: &Context, language: Language, console: &Console) {
        let Some((opened, number)) = &self.number_conflict else {
            return;
        };
        let name = &opened.name;
        let program = console.naming().name(*number);
        let title = say::question_number_taken(&program).text(language);
        let consequence = say::question_number_taken_by(name, program).text(language);
        let answers = [
            say::question_replace_by_file().text(language),
            say::question_only_run_file().text(language),
            say::window_cancel().text(language),
        ];
        let answer = show_question(context, "place", &title, &consequence, &answers);
        let Some(answer) = answer else { return };
        let storing = match answer {
            0 => Some(StorePolicy::Replace),
            1 => Some(StorePolicy::RunOnly),
            _ => None,
        };
        if let (Some((opened, _)), Some(storing)) = (self.number_conflict.take(), storing) {
            let opened = OpenedProgram {
                store_policy: storing,
                ..*opened
            };
            console.send(Command::Open(Box::new(opened)));
        }
    }
}

/// Returns the question before closing the window: text, consequence and confirming answer. `None`
/// if closing ends or loses nothing.
fn close_question(
    snapshot: Option<&PanelSnapshot>,
    unsaved: Option<Unsaved>,
) -> Option<[Message; 3]> {
    let run = snapshot.map(|picture| picture.run_state);
    let title = match run {
        Some(RunState::Run) => say::question_program_runs(),
        Some(RunState::Hold) => say::question_program_held(),
        _ => {
            let [title, loss] = unsaved?.question();
            return Some([title, loss, say::question_close_anyway()]);
        }
    };
    let linked = snapshot.is_some_and(|picture| picture.board.is_some());
    let consequence = if linked {
        say::question_closing_stops_board()
    } else {
        say::question_closing_ends_program()
    };
    Some([title, consequence, say::question_stop_and_close()])
}

/// Draws a question and returns the index of the clicked answer, from 0; `None` while it is
/// open.
pub fn show_question(
    context: &Context,
    id: &str,
    title: &str,
    consequence: &str,
    answers: &[String],
) -> Option<usize> {
    let mut answer = None;
    Window::new(title)
        .id(egui::Id::unique(("question", id)))
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, [0.0, -60.0])
        .constrain_to(stop_key_clearance::free_rect(context, QUESTION_SIZE))
        .show(context, |ui| {
            ui.add_space(6.0);
            ui.label(consequence);
            ui.add_space(10.0);
            ui.horizontal(|ui| {
                for (index, answer_text) in answers.iter().enumerate() {
                    if ui.button(answer_text).clicked() {
                        answer = Some(index);
                    }
                }
            });
            ui.add_space(4.0);
        });
    answer
}
