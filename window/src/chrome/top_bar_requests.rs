//! Carries out requests of the top bar, and finds out which control models can be chosen.

use egui::Ui;
use gsk_core::operation::RunState;
use gsk_host::kernel::{Command, LessonAction};
use gsk_host::platform;
use gsk_messages::say;

use super::exam_limits::is_allowed_in_exam;
use super::top_bar;
use crate::samples::SampleRequest;
use crate::view::ViewId;
use crate::{Window, theme};

impl Window {
    /// Returns the control models that the operator can choose, and why they cannot be chosen
    /// now.
    pub(crate) fn model_choice(&self) -> top_bar::ModelChoice {
        let run = self.snapshot.as_ref().map(|picture| picture.run_state);
        let refusal = if self.board().is_some() {
            Some(say::model_not_with_board())
        } else if !matches!(run, Some(RunState::Reset | RunState::Stop)) {
            Some(say::model_not_while_running())
        } else if self.views.first_unsaved().is_some() {
            Some(say::model_not_unsaved())
        } else {
            None
        };
        top_bar::ModelChoice {
            current: self.models.current,
            is_offered: self.models.is_changeable,
            refusal,
        }
    }

    /// Carries out a request of the top bar.
    pub(crate) fn handle_request(&mut self, request: top_bar::TopBarRequest, ui: &Ui) {
        if self.is_in_exam() && matches!(request, top_bar::TopBarRequest::ToggleLessons) {
            return self.show_view(ViewId::Lesson);
        }
        if self.is_in_exam() && !is_allowed_in_exam(&request) {
            return self.show_message(say::exam_no_help());
        }
        let opens_program = matches!(
            request,
            top_bar::TopBarRequest::ChooseProgram
                | top_bar::TopBarRequest::Open(_)
                | top_bar::TopBarRequest::Sample(_)
        );
        // The kernel refuses it, too; the summary of the program must not hide why.
        let is_in_exercise = (self.snapshot.as_ref()).is_some_and(|it| it.exercise.is_some());
        if opens_program && is_in_exercise {
            return self.show_message(say::exercise_keys_only());
        }
        match request {
            top_bar::TopBarRequest::ChooseProgram => {
                self.opener.choose(self.settings.language, ui.ctx());
            }
            top_bar::TopBarRequest::Open(path) => self.open(ui.ctx(), path),
            top_bar::TopBarRequest::Sample(sample) => {
                let starts = false;
                let request = SampleRequest { sample, starts };
                self.opener.open_sample(request, ui.ctx());
            }
            // A page in a browser has no folders, and may lack the code that reads them.
            top_bar::TopBarRequest::Project(_) if !platform::has_folders() => {}
            top_bar::TopBarRequest::Project(command) => {
                let language = self.settings.language;
                self.views.project().command(command, language, ui.ctx());
                self.show_view(ViewId::Project);
            }
            top_bar::TopBarRequest::Layout(layout) => self.settings.layouts.choose(layout),
            top_bar::TopBarRequest::ToggleView(view) => self.settings.layouts.toggle(view),
            top_bar::TopBarRequest::ToggleTimeline => {
                self.settings.timeline = !self.settings.timeline;
            }
            top_bar::TopBarRequest::ToggleNetwork => self.network.toggle(),
            // Someone who does not see the lessons wants to see them.
            top_bar::TopBarRequest::ToggleLessons
                if self.settings.layouts.is_covered(ViewId::Lesson) =>
            {
                self.show_view(ViewId::Lesson);
            }
            top_bar::TopBarRequest::ToggleLessons => self.settings.layouts.toggle(ViewId::Lesson),
            top_bar::TopBarRequest::LeaveLesson => {
                self.console.send(Command::Lesson(LessonAction::Leave));
            }
            top_bar::TopBarRequest::Speed(speed) => self.console.send(Command::Speed(speed)),
            top_bar::TopBarRequest::ReleaseBits => self.console.send(Command::ReleaseForcedBits),
            top_bar::TopBarRequest::ClearFaults => self.console.send(Command::ClearFaults),
            top_bar::TopBarRequest::ToggleLight => {
                self.settings.light = !self.settings.light;
                theme::set_light(ui.ctx(), self.settings.light);
            }
            top_bar::TopBarRequest::Model(model) => self.models.requested = Some(model),
            top_bar::TopBarRequest::Sound(volume) => self.settings.sound = volume,
            top_bar::TopBarRequest::ToggleFingers => self.settings.fingers = !self.settings.fingers,
            top_bar::TopBarRequest::Zoom(per_cent) => self.settings.zoom = per_cent,
            top_bar::TopBarRequest::FirstStart => self.open_first_start(),
            top_bar::TopBarRequest::ToggleKeyMap => self.is_key_map_open = !self.is_key_map_open,
            top_bar::TopBarRequest::Help => self.help.toggle(None),
            top_bar::TopBarRequest::SwitchLanguage => {
                self.settings.language = self.settings.language.other();
            }
        }
    }
}
