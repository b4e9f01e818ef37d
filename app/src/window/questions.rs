//! Asks for confirmation before something is ended or overwritten. The keys that stop the
//! machine stay uncovered: a stop must not wait for an answer.

use egui::{Align2, Context, ViewportCommand, Window};
use gsk_core::operation::RunState;

use super::clear;
use crate::kernel::{Command, Console, Opened, Snapshot, Storing};
use gsk_messages::{Language, Message, say};

/// Progress of a request to close the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Closing {
    #[default]
    Open,
    /// The close was requested while a program runs or work is unsaved.
    Asked,
    /// The window closes without a question.
    Agreed,
}

/// The operator's work that is not saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsaved {
    Text,
    Job,
    Project,
}

impl Unsaved {
    /// The question, and the consequence of closing.
    fn words(self) -> [Message; 2] {
        match self {
            Self::Text => [say::question_text_unsaved(), say::question_text_is_lost()],
            Self::Job => [say::question_job_unsaved(), say::question_job_is_lost()],
            Self::Project => [say::project_view_unsaved(), say::project_view_is_lost()],
        }
    }
}

/// Preferred size of a question, points.
const ROOM: egui::Vec2 = egui::vec2(520.0, 180.0);

/// The open questions.
#[derive(Debug, Default)]
pub struct Questions {
    closing: Closing,
    /// A program file to open, and its program number, which the memory already has.
    taken: Option<(Box<Opened>, u16)>,
}

impl Questions {
    /// Lets the window close without a question from now on.
    pub const fn let_close(&mut self) {
        self.closing = Closing::Agreed;
    }

    /// Asks what to do with an opened program whose `number` the memory already has.
    pub fn ask_for_place(&mut self, opened: Box<Opened>, number: u16) {
        self.taken = Some((opened, number));
    }

    /// Draws the open questions and carries out the answers.
    pub fn show(
        &mut self,
        context: &Context,
        language: Language,
        picture: Option<&Snapshot>,
        console: &Console,
        unsaved: Option<Unsaved>,
    ) {
        self.closing(context, language, picture, unsaved);
        self.place(context, language, console);
    }

    fn closing(
        &mut self,
        context: &Context,
        language: Language,
        picture: Option<&Snapshot>,
        unsaved: Option<Unsaved>,
    ) {
        let Some([title, consequence, agree]) = loss(picture, unsaved) else {
            if self.closing == Closing::Asked {
                self.closing = Closing::Open;
            }
            return;
        };
        let asked = context.input(|input| input.viewport().close_requested());
        if asked && self.closing != Closing::Agreed {
            context.send_viewport_cmd(ViewportCommand::CancelClose);
            self.closing = Closing::Asked;
        }
        if self.closing != Closing::Asked {
            return;
        }
        let [title, consequence] = [title, consequence].map(|said| said.text(language));
        let answers = [
            say::question_do_not_close().text(language),
            agree.text(language),
        ];
        match ask(context, "closing", &title, &consequence, &answers) {
            Some(1) => {
                self.closing = Closing::Agreed;
                context.send_viewport_cmd(ViewportCommand::Close);
            }
            Some(_) => self.closing = Closing::Open,
            None => {}
        }
    }

    fn place(&mut self, context: &Context, language: Language, console: &Console) {
        let Some((opened, number)) = &self.taken else {
            return;
        };
        let name = &opened.name;
        let title = say::question_number_taken(number).text(language);
        let consequence = say::question_number_taken_by(name, number).text(language);
        let answers = [
            say::question_replace_by_file().text(language),
            say::question_only_run_file().text(language),
            say::window_cancel().text(language),
        ];
        let answer = ask(context, "place", &title, &consequence, &answers);
        let Some(answer) = answer else { return };
        let storing = match answer {
            0 => Some(Storing::Replace),
            1 => Some(Storing::RunOnly),
            _ => None,
        };
        if let (Some((opened, _)), Some(storing)) = (self.taken.take(), storing) {
            let opened = Opened { storing, ..*opened };
            console.send(Command::Open(Box::new(opened)));
        }
    }
}

/// What closing the window would end or lose: the question, the consequence, and the answer
/// that confirms. `None`: nothing.
fn loss(picture: Option<&Snapshot>, unsaved: Option<Unsaved>) -> Option<[Message; 3]> {
    let run = picture.map(|picture| picture.run);
    let title = match run {
        Some(RunState::Run) => say::question_program_runs(),
        Some(RunState::Hold) => say::question_program_held(),
        _ => {
            let [title, loss] = unsaved?.words();
            return Some([title, loss, say::question_close_anyway()]);
        }
    };
    let linked = picture.is_some_and(|picture| picture.board.is_some());
    let consequence = if linked {
        say::question_closing_stops_board()
    } else {
        say::question_closing_ends_program()
    };
    Some([title, consequence, say::question_stop_and_close()])
}

/// Draws a question and returns the index of the clicked answer.
pub fn ask(
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
        .constrain_to(clear::free(context, ROOM))
        .show(context, |ui| {
            ui.add_space(6.0);
            ui.label(consequence);
            ui.add_space(10.0);
            ui.horizontal(|ui| {
                for (index, words) in answers.iter().enumerate() {
                    if ui.button(words).clicked() {
                        answer = Some(index);
                    }
                }
            });
            ui.add_space(4.0);
        });
    answer
}
