//! Offers demonstrations of a topic and shows the running one. It runs on a practice machine:
//! the learner's machine keeps its state.

use std::sync::Arc;

use egui::{Frame, Margin, RichText, Ui};
use gsk_help::Subject;
use gsk_host::kernel::{LessonAction, LessonState};
use gsk_lesson::{Demonstration, demonstrations, find_demonstration};
use gsk_messages::{Language, say};

use super::HelpRequest;
use crate::theme;

/// The demonstrations of a subject, and those of the family that it belongs to.
fn demonstrations_of(subject: Subject<'_>) -> impl Iterator<Item = &'static Demonstration> {
    let subject_name = subject.to_string();
    let family = subject.family();
    demonstrations().iter().filter(move |demonstration| {
        let mut topics = demonstration.topics.iter();
        topics.any(|topic| *topic == subject_name || Some(topic.as_str()) == family)
    })
}

/// Draws a button for each demonstration of a subject. Returns the request to start the one that
/// was clicked; `None` without one.
pub fn show_offers(ui: &mut Ui, subject: Subject<'_>, language: Language) -> Option<HelpRequest> {
    let mut order = None;
    for demonstration in demonstrations_of(subject) {
        let title = demonstration.lesson.title.in_language(language);
        let button = ui.button(say::window_help_show(title).text(language));
        let hint = say::window_help_show_hint().text(language);
        if button.on_hover_text(hint).clicked() {
            order = Some(LessonAction::Demonstrate(Arc::clone(&demonstration.lesson)));
        }
    }
    order.map(HelpRequest::Lesson)
}

/// Draws the running demonstration with the buttons to continue, repeat and leave it, and
/// returns the clicked one's request. Draws nothing for a lesson.
pub fn show_running(ui: &mut Ui, state: &LessonState, language: Language) -> Option<HelpRequest> {
    let lesson = &find_demonstration(&state.name)?.lesson;
    let mut order = None;
    Frame::new()
        .stroke((1.0, theme::LESSON_STEP))
        .inner_margin(Margin::same(6))
        .show(ui, |ui| {
            let title = say::window_help_shown(lesson.title.in_language(language));
            ui.label(RichText::new(title.text(language)).color(theme::LESSON_STEP));
            let step = lesson.steps.get(state.view.step);
            match step {
                Some(step) => {
                    let progress = say::lesson_step_of(state.view.step + 1, lesson.steps.len());
                    ui.weak(progress.text(language));
                    ui.label(
                        RichText::new(step.text.in_language(language))
                            .size(theme::LARGE_SIZE)
                            .strong(),
                    );
                    if !state.view.showing {
                        ui.label(say::window_help_shown_stopped().text(language));
                    }
                }
                None => {
                    ui.label(say::window_help_shown_done().text(language));
                }
            }
            ui.horizontal_wrapped(|ui| {
                let is_stopped = step.is_some() && !state.view.showing;
                let continue_text = say::window_help_shown_on().text(language);
                if is_stopped && ui.button(continue_text).clicked() {
                    order = Some(LessonAction::ShowMe);
                }
                let repeat_text = say::window_help_shown_again().text(language);
                if ui.button(repeat_text).clicked() {
                    order = Some(LessonAction::Demonstrate(Arc::clone(lesson)));
                }
                let leave_text = say::window_help_to_my_machine().text(language);
                if ui.button(leave_text).clicked() {
                    order = Some(LessonAction::Leave);
                }
            });
        });
    ui.add_space(6.0);
    order.map(HelpRequest::Lesson)
}
