//! The lesson view: the list of lessons and exercises, and the current step or task beside the
//! panel.

use std::collections::BTreeSet;
use std::sync::Arc;

use egui::{CentralPanel, Panel, RichText, ScrollArea, Ui};
use gsk_core::model::ModelId;
use gsk_help::{Subject, article, topic};
use gsk_host::kernel::part::PartView;
use gsk_host::kernel::{Command, Console, LessonAction, LessonState, PanelSnapshot};
use gsk_lesson::{Lesson, LessonRemark, LessonStep, built_in_lessons};
use gsk_messages::{Language, Message, say};
use gsk_panel::keys::Key;

use super::exercise::ExercisePane;
use super::interface::{View, ViewFrame, ViewStart};
use crate::focus;
use crate::samples::{SampleRequest, good_samples};
use crate::settings::WindowSettings;
use crate::theme;
use crate::widgets::card::{self, Card, CardPicture};
use crate::widgets::icons::Icon;
use crate::widgets::key_label::key_label_on;
use crate::widgets::mark;

/// Seconds without progress after which the hint appears.
const HINT_DELAY_S: f64 = 40.0;
/// Estimated time that a beginner needs for a step, s.
const STEP_TIME_S: usize = 40;

pub struct LessonView {
    console: Console,
    lessons: Vec<Arc<Lesson>>,
    /// Errors in the lesson files of a teacher.
    load_errors: Vec<Message>,
    /// Names of the lessons that were completed.
    finished: BTreeSet<String>,
    state: Option<LessonState>,
    /// Control model of the learner's own machine.
    model: ModelId,
    /// Additional text of the active alarm; `None` without one.
    alarm_detail: Option<Message>,
    /// Start of the current step, seconds of the window's clock; `None` until the first frame
    /// of the step.
    step_start_s: Option<f64>,
    hint_requested: bool,
    /// A sample program that the user has chosen, until the window takes it; `None` without one.
    sample: Option<SampleRequest>,
    /// Whether a lesson or an exercise has begun since the window last queried it.
    has_begun: bool,
    /// Whether the fault bench is to open.
    wants_bench: bool,
    exercises: ExercisePane,
}

impl View for LessonView {
    fn create(start: ViewStart<'_>) -> Self {
        Self::new(start.console.clone(), start.settings)
    }

    fn show(&mut self, ui: &mut Ui, frame: ViewFrame<'_>) {
        self.draw(ui, frame.language, frame.part);
    }
}

impl LessonView {
    /// Creates the view with the built-in lessons. `settings` contain the lessons completed
    /// earlier.
    pub fn new(console: Console, settings: &WindowSettings) -> Self {
        let (best, learner) = (settings.exercises.clone(), settings.learner.clone());
        Self {
            exercises: ExercisePane::new(console.clone(), best, learner),
            console,
            lessons: built_in_lessons().into_iter().map(Arc::new).collect(),
            load_errors: Vec::new(),
            finished: settings.lessons.clone(),
            state: None,
            model: ModelId::default(),
            alarm_detail: None,
            step_start_s: None,
            hint_requested: false,
            sample: None,
            has_begun: false,
            wants_bench: false,
        }
    }

    /// Removes and returns the sample program that the user has chosen since the last call; `None`
    /// without one.
    pub const fn take_sample(&mut self) -> Option<SampleRequest> {
        self.sample.take()
    }

    /// Whether the fault bench is to open, since the last call.
    pub const fn take_bench_request(&mut self) -> bool {
        core::mem::replace(&mut self.wants_bench, false)
    }

    /// Returns the pane with the exercises.
    pub const fn exercises(&mut self) -> &mut ExercisePane {
        &mut self.exercises
    }

    /// Whether a lesson or an exercise has begun since the last call.
    pub const fn take_begun(&mut self) -> bool {
        core::mem::replace(&mut self.has_begun, false)
    }

    /// Replaces the listed lessons. `errors` are those of lesson files.
    pub fn set_lessons(&mut self, lessons: Vec<Lesson>, errors: Vec<Message>) {
        self.lessons = lessons.into_iter().map(Arc::new).collect();
        self.load_errors = errors;
    }

    /// Returns the names of the lessons that were completed.
    pub const fn finished_lessons(&self) -> &BTreeSet<String> {
        &self.finished
    }

    /// Takes the state of the current lesson from a snapshot and records a completed lesson.
    pub fn take_snapshot(&mut self, snapshot: &PanelSnapshot) {
        let step = |state: &Option<LessonState>| {
            let state = state.as_ref();
            state.map(|state| (state.name.clone(), state.view.step))
        };
        if step(&self.state) != step(&snapshot.lesson) {
            self.step_start_s = None;
            self.hint_requested = false;
        }
        let name = |state: &Option<LessonState>| state.as_ref().map(|state| state.name.clone());
        self.has_begun |= snapshot.lesson.is_some() && name(&self.state) != name(&snapshot.lesson);
        self.state.clone_from(&snapshot.lesson);
        if snapshot.lesson.is_none() && snapshot.exercise.is_none() {
            self.model = snapshot.model;
        }
        let alarm = snapshot.alarm.as_ref();
        self.alarm_detail = alarm.and_then(|alarm| alarm.further_detail().cloned());
        self.has_begun |= self.exercises.take_snapshot(snapshot);
        if let Some((lesson, state)) = self.current_lesson()
            && state.view.step == lesson.steps.len()
        {
            let name = lesson.name.clone();
            self.finished.insert(name);
        }
    }

    /// The current lesson and its state; `None` outside lessons and in a demonstration.
    fn current_lesson(&self) -> Option<(&Arc<Lesson>, &LessonState)> {
        let state = self.state.as_ref()?;
        let lesson = self.lessons.iter().find(|it| it.name == state.name)?;
        Some((lesson, state))
    }

    /// The key that the panel marks: the next one of the lesson or demonstration.
    pub fn next_key(&self) -> Option<Key> {
        self.state.as_ref()?.view.next_key
    }

    fn send_order(&self, order: LessonAction) {
        self.console.send(Command::Lesson(order));
    }

    /// Draws the lesson view and handles its input.
    fn draw(&mut self, ui: &mut Ui, language: Language, part: Option<&Arc<PartView>>) {
        self.exercises.receive_marks();
        let lesson = self.current_lesson().map(|(lesson, _)| Arc::clone(lesson));
        if let Some(lesson) = &lesson {
            // The buttons keep their position, whatever the length of the text above.
            Panel::bottom("lesson buttons")
                .frame(super::bar_frame())
                .show(ui, |ui| self.show_buttons(ui, language, lesson));
        } else if self.exercises.is_open() {
            Panel::bottom("exercise buttons")
                .frame(super::bar_frame())
                .show(ui, |ui| {
                    self.wants_bench |= self.exercises.show_buttons(ui, language);
                });
        }
        CentralPanel::default()
            .frame(super::side_frame())
            .show(ui, |ui| {
                ScrollArea::vertical()
                    .id_salt(("lesson", lesson.is_some(), self.exercises.is_open()))
                    .auto_shrink([false, false])
                    .show(ui, |ui| {
                        match lesson {
                            Some(lesson) => self.show_lesson(ui, language, &lesson),
                            None if self.exercises.is_open() => {
                                self.exercises.show_task(ui, language, part);
                            }
                            None if self.exercises.is_course() => {
                                self.exercises.show_list(ui, language, part);
                            }
                            None => self.list(ui, language, part),
                        }
                        focus::scroll_to_focus(ui);
                    });
            });
    }

    fn list(&mut self, ui: &mut Ui, language: Language, part: Option<&Arc<PartView>>) {
        let heading = say::lesson_samples().text(language);
        card::show_heading(ui, Icon::SAMPLE, &heading);
        let samples: Vec<_> = good_samples(self.model).collect();
        let cards: Vec<Card> = samples
            .iter()
            .map(|sample| Card {
                picture: sample.picture(),
                title: sample.description_text(language),
                // The name of the file without its folder.
                detail: sample
                    .name
                    .rsplit('/')
                    .next()
                    .unwrap_or_default()
                    .to_owned(),
                is_marked: false,
            })
            .collect();
        for (sample, card) in samples.into_iter().zip(card::show_cards(ui, &cards)) {
            let hint = say::lesson_sample_hint().text(language);
            if card.on_hover_text(hint).clicked() {
                let starts = true;
                self.sample = Some(SampleRequest { sample, starts });
            }
        }
        let mut models = ModelId::ALL;
        // The lessons for the current control come first.
        models.sort_by_key(|model| *model != self.model);
        for model in models {
            self.list_model(ui, language, model);
        }
        for error in &self.load_errors {
            ui.add_space(4.0);
            ui.label(RichText::new(error.text(language)).color(theme::ERROR_TEXT));
        }
        self.exercises.show_list(ui, language, part);
    }

    /// Lists the lessons whose practice machine has a control model, with the progress.
    fn list_model(&self, ui: &mut Ui, language: Language, model: ModelId) {
        let of_model = |lesson: &&Arc<Lesson>| lesson.start.model() == model;
        let lessons: Vec<&Arc<Lesson>> = self.lessons.iter().filter(of_model).collect();
        if lessons.is_empty() {
            return;
        }
        ui.add_space(8.0);
        let is_own = model == self.model;
        let (heading, intro) = match (is_own, model.is_main()) {
            (true, true) => (say::lesson_first_hour(), say::lesson_intro()),
            (true, false) => (say::lesson_of_model(model.name()), say::lesson_intro()),
            (false, _) => (
                say::lesson_of_model(model.name()),
                say::lesson_of_model_intro(model.name()),
            ),
        };
        card::show_heading(ui, Icon::LESSON, &heading.text(language));
        ui.label(intro.text(language));
        let is_done = |lesson: &Arc<Lesson>| self.finished.contains(&lesson.name);
        let done = lessons.iter().filter(|it| is_done(it)).count();
        let words = say::lesson_progress(done, lessons.len()).text(language);
        card::show_progress(ui, done, lessons.len(), &words);
        let cards: Vec<Card> = lessons
            .iter()
            .map(|lesson| Card {
                picture: CardPicture::Icon(lesson_icon(lesson)),
                title: lesson.title.in_language(language).into_owned(),
                detail: describe_length(lesson, language),
                is_marked: is_done(lesson),
            })
            .collect();
        for (lesson, card) in lessons.into_iter().zip(card::show_cards(ui, &cards)) {
            let about = lesson.about.in_language(language);
            if card.on_hover_text(about).clicked() {
                self.send_order(LessonAction::Begin(Arc::clone(lesson)));
            }
        }
    }

    fn show_lesson(&mut self, ui: &mut Ui, language: Language, lesson: &Arc<Lesson>) {
        let Some(state) = self.state.clone() else {
            return;
        };
        let view = &state.view;
        let practice =
            RichText::new(say::lesson_practice().text(language)).color(theme::LESSON_HINT_TEXT);
        ui.label(practice)
            .on_hover_text(say::lesson_practice_hint().text(language));
        ui.heading(lesson.title.in_language(language));
        ui.horizontal_wrapped(|ui| {
            for step in 0..lesson.steps.len() {
                let colour = match step.cmp(&view.step) {
                    core::cmp::Ordering::Less => theme::SUCCESS,
                    core::cmp::Ordering::Equal => theme::LESSON_STEP,
                    core::cmp::Ordering::Greater => theme::LESSON_OPEN,
                };
                mark::draw(ui, colour, step < view.step);
            }
        });
        ui.add_space(6.0);
        let Some(step) = lesson.steps.get(view.step) else {
            self.show_end(ui, language, lesson);
            return;
        };
        let number = say::lesson_step_of(view.step + 1, lesson.steps.len());
        ui.label(RichText::new(number.text(language)).color(theme::LESSON_STEP));
        ui.label(
            RichText::new(step.text.in_language(language))
                .size(theme::LARGE_SIZE)
                .color(theme::BRIGHT_TEXT),
        );
        if !step.keys.is_empty() {
            let model = lesson.start.model();
            let labels = step.keys.iter();
            let keys = labels.map(|key| key_label_on(model, *key, language));
            let keys = keys.collect::<Vec<_>>().join("  ");
            ui.add_space(4.0);
            let words = say::lesson_keys(keys).text(language);
            ui.label(
                RichText::new(words)
                    .size(theme::READING_SIZE)
                    .color(theme::LESSON_STEP),
            );
        }
        if let Some(why) = &view.sent_back {
            let reason = say::lesson_back_here(why.clone()).text(language);
            ui.add_space(6.0);
            ui.label(
                RichText::new(reason)
                    .size(theme::READING_SIZE)
                    .color(theme::ERROR_TEXT),
            );
        }
        if let Some(remark_text) = self.describe_remark(step, view.remark, language) {
            ui.add_space(6.0);
            ui.label(
                RichText::new(remark_text)
                    .size(theme::READING_SIZE)
                    .color(theme::ERROR_TEXT),
            );
        }
        let note = match (view.showing, view.replaced) {
            (_, true) => Some(say::lesson_replaced()),
            (true, false) => Some(say::lesson_showing()),
            (false, false) => None,
        };
        if let Some(note) = note {
            ui.add_space(6.0);
            ui.label(RichText::new(note.text(language)).color(theme::NOTE_TEXT));
        }
        let now = ui.input(|input| input.time);
        let start_s = *self.step_start_s.get_or_insert(now);
        let is_hint_due = now - start_s >= HINT_DELAY_S;
        if !is_hint_due {
            let remaining =
                core::time::Duration::from_secs_f64(HINT_DELAY_S - (now - start_s) + 0.05);
            ui.ctx().request_repaint_after(remaining);
        }
        if self.hint_requested || is_hint_due {
            ui.add_space(6.0);
            let words = say::lesson_hint_is(step.hint.in_language(language)).text(language);
            ui.label(
                RichText::new(words)
                    .size(theme::READING_SIZE)
                    .color(theme::LESSON_HINT_TEXT),
            );
        }
    }

    fn show_buttons(&mut self, ui: &mut Ui, language: Language, lesson: &Arc<Lesson>) {
        let step = self.state.as_ref().map_or(0, |state| state.view.step);
        let has_step = step < lesson.steps.len();
        ui.horizontal_wrapped(|ui| {
            let hint = egui::Button::new(say::lesson_hint().text(language));
            if ui.add_enabled(has_step, hint).clicked() {
                self.hint_requested = true;
            }
            let orders = [
                (
                    has_step,
                    say::lesson_show_me(),
                    say::lesson_show_me_hint(),
                    LessonAction::ShowMe,
                ),
                (
                    step > 0,
                    say::lesson_back(),
                    say::lesson_back_hint(),
                    LessonAction::Back,
                ),
                (
                    true,
                    say::lesson_again(),
                    say::lesson_again_hint(),
                    LessonAction::Restart,
                ),
                (
                    true,
                    say::lesson_leave(),
                    say::lesson_leave_hint(),
                    LessonAction::Leave,
                ),
            ];
            for (enabled, name, hint, order) in orders {
                let button = egui::Button::new(name.text(language));
                let button = ui.add_enabled(enabled, button);
                if button.on_hover_text(hint.text(language)).clicked() {
                    self.send_order(order);
                }
            }
        });
    }

    /// Formats the remark about the state of the machine; `None` if there is none.
    fn describe_remark(
        &self,
        step: &LessonStep,
        remark: LessonRemark,
        language: Language,
    ) -> Option<String> {
        let message = match remark {
            LessonRemark::None => return None,
            LessonRemark::Mistake(index) => {
                return Some(
                    step.mistakes
                        .get(index)?
                        .text
                        .in_language(language)
                        .into_owned(),
                );
            }
            LessonRemark::PowerOff => say::lesson_power_off(),
            LessonRemark::EmergencyStop => say::lesson_emergency_stop(),
            LessonRemark::Alarm(number) => {
                let about = topic(Subject::Alarm(number));
                let about = about.map(|topic| article(topic, language).heading);
                let about = about.unwrap_or_else(|| number.to_string());
                match &self.alarm_detail {
                    Some(detail) => say::lesson_alarm_detail(about, detail.clone()),
                    None => say::lesson_alarm(about),
                }
            }
            LessonRemark::Stuck => say::lesson_stuck(),
        };
        Some(message.text(language))
    }

    /// Draws the end of a lesson whose steps are all done, with a button for the next lesson.
    fn show_end(&self, ui: &mut Ui, language: Language, lesson: &Arc<Lesson>) {
        let done = RichText::new(say::lesson_done().text(language));
        ui.label(done.size(theme::LESSON_END_SIZE).color(theme::SUCCESS));
        ui.add_space(10.0);
        let at = self.lessons.iter().position(|it| it.name == lesson.name);
        let next = at.and_then(|at| self.lessons.get(at + 1));
        if let Some(next) = next {
            let words = say::lesson_next(next.title.in_language(language)).text(language);
            if ui.button(words).clicked() {
                self.send_order(LessonAction::Begin(Arc::clone(next)));
            }
        }
    }
}

/// Returns the icon on a lesson's card, which depends on its first steps.
fn lesson_icon(lesson: &Lesson) -> Icon {
    let icons = [
        ("01", Icon::KEYBOARD),
        ("02", Icon::FIT),
        ("03", Icon::CODE),
        ("04", Icon::BOOK),
        ("05", Icon::MEASURE),
        ("06", Icon::PATH),
        ("07", Icon::WARNING),
        ("08", Icon::TOOLS),
        ("09", Icon::STOCK),
        ("10", Icon::SECTION),
    ];
    let own = icons
        .iter()
        .find(|(number, _)| lesson.name.starts_with(number));
    own.map_or(Icon::LESSON, |(_, icon)| *icon)
}

/// Describes number of steps and estimated time of a lesson.
fn describe_length(lesson: &Lesson, language: Language) -> String {
    let minutes = (lesson.steps.len() * STEP_TIME_S).div_ceil(60);
    say::lesson_length(lesson.steps.len(), minutes).text(language)
}
