//! Offers demonstrations of a topic and shows the running one. It runs on a practice machine:
//! the learner's machine keeps its state.

use std::sync::Arc;

use egui::{Color32, Frame, Margin, RichText, Ui};
use gsk_help::Subject;
use gsk_messages::{Language, say};
use gsk_runner::lesson::{Demonstration, demonstration_named, demonstrations};

use super::Asked;
use crate::kernel::{LessonOrder, LessonState};

const SHOWN: Color32 = Color32::from_rgb(90, 200, 255);

/// The demonstrations of a subject and of its family.
fn of(subject: Subject<'_>) -> impl Iterator<Item = &'static Demonstration> {
    let own = subject.to_string();
    let family = subject.family();
    demonstrations().iter().filter(move |shown| {
        let mut topics = shown.topics.iter();
        topics.any(|topic| *topic == own || Some(topic.as_str()) == family)
    })
}

/// Draws a button for each demonstration of a subject.
pub fn offered(ui: &mut Ui, subject: Subject<'_>, language: Language) -> Option<Asked> {
    let mut asked = None;
    for shown in of(subject) {
        let title = shown.lesson.title.of(language);
        let button = ui.button(say::window_help_show(title).text(language));
        let hint = say::window_help_show_hint().text(language);
        if button.on_hover_text(hint).clicked() {
            asked = Some(LessonOrder::Show(Arc::clone(&shown.lesson)));
        }
    }
    asked.map(Asked::Lesson)
}

/// Draws the running demonstration with the buttons to continue, repeat and leave it. Draws
/// nothing for a lesson.
pub fn under_way(ui: &mut Ui, state: &LessonState, language: Language) -> Option<Asked> {
    let lesson = &demonstration_named(&state.name)?.lesson;
    let mut asked = None;
    Frame::new()
        .stroke((1.0, SHOWN))
        .inner_margin(Margin::same(6))
        .show(ui, |ui| {
            let title = say::window_help_shown(lesson.title.of(language));
            ui.label(RichText::new(title.text(language)).color(SHOWN));
            let step = lesson.steps.get(state.view.step);
            match step {
                Some(step) => {
                    let of = say::lesson_step_of(state.view.step + 1, lesson.steps.len());
                    ui.weak(of.text(language));
                    ui.label(RichText::new(step.text.of(language)).size(16.0).strong());
                    if !state.view.showing {
                        ui.label(say::window_help_shown_stopped().text(language));
                    }
                }
                None => {
                    ui.label(say::window_help_shown_done().text(language));
                }
            }
            ui.horizontal_wrapped(|ui| {
                let stopped = step.is_some() && !state.view.showing;
                let go_on = say::window_help_shown_on().text(language);
                if stopped && ui.button(go_on).clicked() {
                    asked = Some(LessonOrder::ShowMe);
                }
                let again = say::window_help_shown_again().text(language);
                if ui.button(again).clicked() {
                    asked = Some(LessonOrder::Show(Arc::clone(lesson)));
                }
                let back = say::window_help_to_my_machine().text(language);
                if ui.button(back).clicked() {
                    asked = Some(LessonOrder::Leave);
                }
            });
        });
    ui.add_space(6.0);
    asked.map(Asked::Lesson)
}
