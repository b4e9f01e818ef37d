//! Carries out requests of the top bar, and finds out which control models can be chosen.

use egui::Ui;
use gsk_core::operation::RunState;
use gsk_messages::say;

use super::samples::SampleRequest;
use super::view::View;
use super::{Window, surroundings, top_bar};
use crate::kernel::{Command, LessonOrder};
use crate::platform;

impl Window {
    /// The control models to choose from, and why they cannot be chosen now.
    pub(super) fn model_choice(&self) -> top_bar::ModelChoice {
        let run = self.picture.as_ref().map(|picture| picture.run);
        let why_not = if self.board().is_some() {
            Some(say::model_not_with_board())
        } else if !matches!(run, Some(RunState::Reset | RunState::Stop)) {
            Some(say::model_not_while_running())
        } else if self.views.unsaved().is_some() {
            Some(say::model_not_unsaved())
        } else {
            None
        };
        top_bar::ModelChoice {
            shown: self.models.shown,
            offered: self.models.changeable,
            why_not,
        }
    }

    /// Carries out a request of the top bar.
    pub(super) fn answer(&mut self, asked: top_bar::Asked, ui: &Ui) {
        match asked {
            top_bar::Asked::Choose => {
                self.opener.choose(self.settings.language, ui.ctx());
            }
            top_bar::Asked::Open(path) => self.open(ui.ctx(), path),
            top_bar::Asked::Sample(sample) => {
                let starts = false;
                let request = SampleRequest { sample, starts };
                self.opener.open_sample(request, ui.ctx());
            }
            // A page in a browser has no folders, and may lack the code that reads them.
            top_bar::Asked::Project(_) if !platform::has_folders() => {}
            top_bar::Asked::Project(command) => {
                let language = self.settings.language;
                self.views.project().command(command, language, ui.ctx());
                self.show_view(View::Project);
            }
            top_bar::Asked::Layout(layout) => self.settings.layouts.choose(layout),
            top_bar::Asked::View(view) => self.settings.layouts.toggle(view),
            top_bar::Asked::Lessons => self.settings.layouts.toggle(View::Lesson),
            top_bar::Asked::LeaveLesson => {
                self.console.send(Command::Lesson(LessonOrder::Leave));
            }
            top_bar::Asked::Speed(speed) => self.console.send(Command::Speed(speed)),
            top_bar::Asked::FreeBits => self.console.send(Command::FreeBits),
            top_bar::Asked::Mend => self.console.send(Command::Mend),
            top_bar::Asked::Light => {
                self.settings.light = !self.settings.light;
                surroundings::set(ui.ctx(), self.settings.light);
            }
            top_bar::Asked::Model(model) => self.models.asked = Some(model),
            top_bar::Asked::Sound(volume) => self.settings.sound = volume,
            top_bar::Asked::Fingers => self.settings.fingers = !self.settings.fingers,
            top_bar::Asked::Zoom(per_cent) => self.settings.zoom = per_cent,
            top_bar::Asked::FirstStart => self.ask_first(),
            top_bar::Asked::Keys => self.key_map = !self.key_map,
            top_bar::Asked::Help => self.help.ask(None),
            top_bar::Asked::Language => {
                self.settings.language = self.settings.language.other();
            }
        }
    }
}
