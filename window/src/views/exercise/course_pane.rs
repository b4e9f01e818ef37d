//! The course of a learning platform in the exercise view: how far the learner has come.

use egui::{RichText, Ui};
use gsk_exercise::course::scorm::platform_values;
use gsk_exercise::course::{Course, CourseProgress, TaskProgress};
use gsk_exercise::report::ExerciseReport;
use gsk_exercise::task::ExerciseTask;
use gsk_host::platform;
use gsk_messages::{Language, Message, say};

use crate::theme;
use crate::widgets::card;
use crate::widgets::icons::Icon;

/// The pane for the course of a learning platform.
pub struct CoursePane {
    title: String,
    progress: CourseProgress,
    /// Message about the last event: whether a report was accepted, or that an exercise was
    /// refused.
    message: Option<Message>,
}

impl CoursePane {
    /// Continues a course from the progress that the platform has stored.
    pub fn new(course: &Course, suspended: &str) -> Self {
        Self {
            title: course.title.clone(),
            progress: CourseProgress::resume(course, suspended),
            message: None,
        }
    }

    /// Returns the best points of an exercise; `None` before it was handed in.
    pub fn best(&self, id: &str) -> Option<u32> {
        let task = self.progress.task(id).filter(|task| task.attempts > 0);
        task.map(|task| task.best)
    }

    /// Whether an exercise may begin; if all its attempts are used, shows a message and returns
    /// false.
    pub fn permits(&mut self, task: &ExerciseTask) -> bool {
        let progress = self.progress.task(&task.id);
        let is_permitted = progress.is_some_and(TaskProgress::has_attempts_left);
        self.message = (!is_permitted).then(|| say::course_attempts_used(task.attempts));
        is_permitted
    }

    /// Records the marks of a solution and reports them to the platform.
    pub fn record(&mut self, report: &ExerciseReport, points: u32) {
        self.progress.record(&report.task, points);
        let values = platform_values(&self.progress, report, points);
        self.message = Some(match platform::report_course(&values.to_string()) {
            true => say::course_reported(),
            false => say::course_not_reported(),
        });
    }

    /// Draws the title and how far the learner has come.
    pub fn show_head(&self, ui: &mut Ui, language: Language) {
        card::show_heading(ui, Icon::MEASURE, &self.title);
        ui.label(say::course_intro().text(language));
        let (done, count) = self.progress.handed_in();
        let score = self.progress.score_per_cent();
        let words = say::course_progress(done, count, score).text(language);
        card::show_progress(ui, done, count, &words);
        if let Some(mastery) = self.progress.mastery_per_cent() {
            ui.label(say::course_mastery(mastery).text(language));
        }
        self.show_message(ui, language);
    }

    /// Draws the message about the last event.
    pub fn show_message(&self, ui: &mut Ui, language: Language) {
        if let Some(message) = &self.message {
            let words = RichText::new(message.text(language));
            ui.label(words.color(theme::LESSON_HINT_TEXT));
        }
    }

    /// Returns how often an exercise may still be handed in.
    pub fn describe_attempts(&self, id: &str, language: Language) -> String {
        let left = self.progress.task(id);
        let left = left.map_or(0, |task| task.permitted.saturating_sub(task.attempts));
        say::course_attempts_left(left).text(language)
    }
}
