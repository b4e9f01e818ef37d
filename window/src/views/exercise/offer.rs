//! An exercise that was chosen but not begun: the learner reads the task before its time runs.

use std::sync::Arc;

use egui::{RichText, Ui};
use gsk_exercise::task::ExerciseTask;
use gsk_messages::{Language, say};

use super::{ExercisePane, describe_length, show_demand, show_text};
use crate::theme;

impl ExercisePane {
    /// Offers an exercise, unless all its attempts in a course are used.
    pub(super) fn offer(&mut self, task: Arc<ExerciseTask>) {
        let is_permitted = self.course.as_mut().is_none_or(|it| it.permits(&task));
        self.offered = is_permitted.then_some(task);
    }

    /// Returns the exercise that is offered; `None` while an exercise or an exam is in progress.
    pub(super) fn offered_now(&self) -> Option<Arc<ExerciseTask>> {
        let is_free = self.state.is_none() && !self.is_in_exam();
        self.offered.clone().filter(|_| is_free)
    }

    /// Draws the task that is offered, with its criteria and its time.
    pub(super) fn show_offer(&mut self, ui: &mut Ui, language: Language, task: &ExerciseTask) {
        show_text(ui, language, task);
        let best = self.best.get(&task.id).copied();
        let length = describe_length(task, best).text(language);
        ui.label(RichText::new(length).color(theme::LESSON_STEP));
        ui.label(say::exercise_time_begins().text(language));
        ui.add_space(6.0);
        self.drawing.show(ui, language, task, &[]);
        ui.strong(say::exercise_demands().text(language));
        for criterion in &task.criteria {
            show_demand(ui, language, criterion, None);
        }
    }

    /// Draws the buttons below the task that is offered.
    pub(super) fn show_offer_buttons(
        &mut self,
        ui: &mut Ui,
        language: Language,
        task: Arc<ExerciseTask>,
    ) {
        ui.horizontal_wrapped(|ui| {
            let begin = egui::Button::new(say::exercise_begin().text(language));
            let begin = begin.fill(theme::ACCENT_GROUND);
            if ui.add(begin).clicked() {
                self.begin(task);
            }
            if ui.button(say::exercise_other().text(language)).clicked() {
                self.offered = None;
            }
        });
    }
}
