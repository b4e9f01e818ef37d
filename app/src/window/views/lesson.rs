//! The lesson view: the list of lessons, and the current step beside the panel.

use std::collections::BTreeSet;
use std::sync::Arc;

use egui::{CentralPanel, Color32, Panel, RichText, ScrollArea, Sense, Stroke, Ui, vec2};
use gsk_help::{Subject, article, topic};
use gsk_messages::{Language, Message, say};
use gsk_panel::keys::Key;
use gsk_runner::lesson::{Lesson, Remark, Step, built_in, demonstration_named};

use crate::kernel::{Command, Console, LessonOrder, LessonState, Snapshot};
use crate::window::focus;
use crate::window::samples::{SampleRequest, good_samples};

/// Seconds without progress after which the hint appears.
const HINT_AFTER: f64 = 40.0;
/// Diameter of the mark of a step, points.
const MARK: f32 = 12.0;

const DONE: Color32 = Color32::from_rgb(110, 230, 120);
const NOW: Color32 = Color32::from_rgb(90, 200, 255);
const OPEN: Color32 = Color32::from_gray(90);
const WRONG: Color32 = Color32::from_rgb(255, 150, 110);
const HINT: Color32 = Color32::from_rgb(255, 214, 130);

pub struct LessonView {
    console: Console,
    lessons: Vec<Arc<Lesson>>,
    /// Errors in a teacher's lesson files.
    wrong: Vec<Message>,
    /// Names of the lessons that were completed.
    finished: BTreeSet<String>,
    state: Option<LessonState>,
    /// Start of the current step, seconds of the window's clock; `None` until the next frame.
    since: Option<f64>,
    hint: bool,
    /// A sample was chosen.
    sample: Option<SampleRequest>,
    /// A lesson has begun since the last frame.
    has_begun: bool,
}

impl LessonView {
    /// Creates the view with the built-in lessons. `finished`: names of lessons completed
    /// earlier.
    pub fn new(console: Console, finished: BTreeSet<String>) -> Self {
        Self {
            console,
            lessons: built_in().into_iter().map(Arc::new).collect(),
            wrong: Vec::new(),
            finished,
            state: None,
            since: None,
            hint: false,
            sample: None,
            has_begun: false,
        }
    }

    /// The sample that was chosen since the last frame.
    pub const fn take_sample(&mut self) -> Option<SampleRequest> {
        self.sample.take()
    }

    /// Whether a lesson has begun since the last frame.
    pub const fn take_begun(&mut self) -> bool {
        core::mem::replace(&mut self.has_begun, false)
    }

    /// Replaces the built-in lessons. `wrong`: errors in the files of lessons.
    pub fn set_lessons(&mut self, lessons: Vec<Lesson>, wrong: Vec<Message>) {
        self.lessons = lessons.into_iter().map(Arc::new).collect();
        self.wrong = wrong;
    }

    /// Names of the lessons that were completed.
    pub const fn finished(&self) -> &BTreeSet<String> {
        &self.finished
    }

    /// Takes the state of the current lesson from a snapshot.
    pub fn seen(&mut self, picture: &Snapshot) {
        let step = |state: &Option<LessonState>| {
            let state = state.as_ref();
            state.map(|state| (state.name.clone(), state.view.step))
        };
        if step(&self.state) != step(&picture.lesson) {
            self.since = None;
            self.hint = false;
        }
        let name = |state: &Option<LessonState>| state.as_ref().map(|state| state.name.clone());
        self.has_begun |= picture.lesson.is_some() && name(&self.state) != name(&picture.lesson);
        self.state.clone_from(&picture.lesson);
        if let Some((lesson, state)) = self.under_way()
            && state.view.step == lesson.steps.len()
        {
            let name = lesson.name.clone();
            self.finished.insert(name);
        }
    }

    /// The current lesson and its state.
    fn under_way(&self) -> Option<(&Arc<Lesson>, &LessonState)> {
        let state = self.state.as_ref()?;
        let lesson = self.lessons.iter().find(|it| it.name == state.name)?;
        Some((lesson, state))
    }

    /// The keys that the panel marks: those of the current step of a lesson or demonstration.
    pub fn marked(&self) -> Vec<Key> {
        let shown = self.state.as_ref().and_then(|state| {
            let shown = demonstration_named(&state.name)?;
            Some((&shown.lesson, state))
        });
        let step = self
            .under_way()
            .or(shown)
            .and_then(|(lesson, state)| lesson.steps.get(state.view.step));
        step.map(|step| step.keys.clone()).unwrap_or_default()
    }

    fn order(&self, order: LessonOrder) {
        self.console.send(Command::Lesson(order));
    }

    /// Draws the view and handles its input.
    pub fn show(&mut self, ui: &mut Ui, language: Language) {
        let lesson = self.under_way().map(|(lesson, _)| Arc::clone(lesson));
        if let Some(lesson) = &lesson {
            // The buttons keep their position, whatever the length of the text above.
            Panel::bottom("lesson buttons")
                .frame(super::bar_frame())
                .show(ui, |ui| self.buttons(ui, language, lesson));
        }
        CentralPanel::default()
            .frame(super::side_frame())
            .show(ui, |ui| {
                ScrollArea::vertical()
                    .id_salt("lesson")
                    .auto_shrink([false, false])
                    .show(ui, |ui| {
                        match lesson {
                            Some(lesson) => self.lesson(ui, language, &lesson),
                            None => self.list(ui, language),
                        }
                        focus::follow(ui);
                    });
            });
    }

    fn list(&mut self, ui: &mut Ui, language: Language) {
        ui.label(RichText::new(say::lesson_samples().text(language)).size(15.0));
        ui.horizontal_wrapped(|ui| {
            for sample in good_samples() {
                let button = ui.button(sample.shows(language));
                let hint = say::lesson_sample_hint().text(language);
                if button.on_hover_text(hint).clicked() {
                    let starts = true;
                    self.sample = Some(SampleRequest { sample, starts });
                }
            }
        });
        ui.add_space(8.0);
        ui.label(say::lesson_intro().text(language));
        ui.add_space(8.0);
        for lesson in &self.lessons {
            let done = self.finished.contains(&lesson.name);
            ui.horizontal(|ui| {
                mark(ui, if done { DONE } else { OPEN }, done);
                let title = RichText::new(lesson.title.of(language)).size(15.0);
                let button = ui.button(title);
                if button.on_hover_text(lesson.about.of(language)).clicked() {
                    self.order(LessonOrder::Begin(Arc::clone(lesson)));
                }
            });
        }
        for said in &self.wrong {
            ui.add_space(4.0);
            ui.label(RichText::new(said.text(language)).color(WRONG));
        }
    }

    fn lesson(&mut self, ui: &mut Ui, language: Language, lesson: &Arc<Lesson>) {
        let Some(state) = self.state.clone() else {
            return;
        };
        let view = &state.view;
        let practice = RichText::new(say::lesson_practice().text(language)).color(HINT);
        ui.label(practice)
            .on_hover_text(say::lesson_practice_hint().text(language));
        ui.heading(lesson.title.of(language));
        ui.horizontal_wrapped(|ui| {
            for step in 0..lesson.steps.len() {
                let colour = match step.cmp(&view.step) {
                    core::cmp::Ordering::Less => DONE,
                    core::cmp::Ordering::Equal => NOW,
                    core::cmp::Ordering::Greater => OPEN,
                };
                mark(ui, colour, step < view.step);
            }
        });
        ui.add_space(6.0);
        let Some(step) = lesson.steps.get(view.step) else {
            self.end(ui, language, lesson);
            return;
        };
        let number = say::lesson_step_of(view.step + 1, lesson.steps.len());
        ui.label(RichText::new(number.text(language)).color(NOW));
        ui.label(
            RichText::new(step.text.of(language))
                .size(16.0)
                .color(Color32::WHITE),
        );
        if !step.keys.is_empty() {
            let keys = step.keys.iter().map(|key| printed(*key));
            let keys = keys.collect::<Vec<_>>().join("  ");
            ui.add_space(4.0);
            let words = say::lesson_keys(keys).text(language);
            ui.label(RichText::new(words).size(15.0).color(NOW));
        }
        if let Some(why) = &view.sent_back {
            let said = say::lesson_back_here(why.clone()).text(language);
            ui.add_space(6.0);
            ui.label(RichText::new(said).size(15.0).color(WRONG));
        }
        if let Some(said) = remark(step, view.remark, language) {
            ui.add_space(6.0);
            ui.label(RichText::new(said).size(15.0).color(WRONG));
        }
        let note = match (view.showing, view.replaced) {
            (_, true) => Some(say::lesson_replaced()),
            (true, false) => Some(say::lesson_showing()),
            (false, false) => None,
        };
        if let Some(note) = note {
            ui.add_space(6.0);
            ui.label(RichText::new(note.text(language)).color(Color32::from_gray(170)));
        }
        let now = ui.input(|input| input.time);
        let since = *self.since.get_or_insert(now);
        let late = now - since >= HINT_AFTER;
        if !late {
            let rest = core::time::Duration::from_secs_f64(HINT_AFTER - (now - since) + 0.05);
            ui.ctx().request_repaint_after(rest);
        }
        if self.hint || late {
            ui.add_space(6.0);
            let words = say::lesson_hint_is(step.hint.of(language)).text(language);
            ui.label(RichText::new(words).size(15.0).color(HINT));
        }
    }

    fn buttons(&mut self, ui: &mut Ui, language: Language, lesson: &Arc<Lesson>) {
        let step = self.state.as_ref().map_or(0, |state| state.view.step);
        let works = step < lesson.steps.len();
        ui.horizontal_wrapped(|ui| {
            let hint = egui::Button::new(say::lesson_hint().text(language));
            if ui.add_enabled(works, hint).clicked() {
                self.hint = true;
            }
            let orders = [
                (
                    works,
                    say::lesson_show_me(),
                    say::lesson_show_me_hint(),
                    LessonOrder::ShowMe,
                ),
                (
                    step > 0,
                    say::lesson_back(),
                    say::lesson_back_hint(),
                    LessonOrder::Back,
                ),
                (
                    true,
                    say::lesson_again(),
                    say::lesson_again_hint(),
                    LessonOrder::Again,
                ),
                (
                    true,
                    say::lesson_leave(),
                    say::lesson_leave_hint(),
                    LessonOrder::Leave,
                ),
            ];
            for (enabled, name, hint, order) in orders {
                let button = egui::Button::new(name.text(language));
                let button = ui.add_enabled(enabled, button);
                if button.on_hover_text(hint.text(language)).clicked() {
                    self.order(order);
                }
            }
        });
    }

    /// Draws the end of a lesson whose steps are all done, with a button for the next lesson.
    fn end(&self, ui: &mut Ui, language: Language, lesson: &Arc<Lesson>) {
        let done = RichText::new(say::lesson_done().text(language));
        ui.label(done.size(17.0).color(DONE));
        ui.label(lesson.about.of(language));
        ui.add_space(10.0);
        let at = self.lessons.iter().position(|it| it.name == lesson.name);
        let next = at.and_then(|at| self.lessons.get(at + 1));
        if let Some(next) = next {
            let words = say::lesson_next(next.title.of(language)).text(language);
            if ui.button(words).clicked() {
                self.order(LessonOrder::Begin(Arc::clone(next)));
            }
        }
    }
}

/// The legend of a key in brackets, without its English words: `[X 手轮]`.
fn printed(key: Key) -> String {
    let legend = key.row().legend;
    let english = |line: &str| line.len() > 1 && line.is_ascii();
    let only = legend.iter().all(|line| line.is_ascii());
    let lines = legend.iter().filter(|line| only || !english(line)).copied();
    let lines: Vec<&str> = lines.collect();
    let blank = lines.iter().any(|line| line.len() == 1);
    format!("[{}]", lines.join(if blank { " " } else { "" }))
}

/// Draws the mark of a step or lesson. `done` adds a tick.
fn mark(ui: &mut Ui, colour: Color32, done: bool) {
    let (place, _) = ui.allocate_exact_size(vec2(MARK + 2.0, MARK + 4.0), Sense::HOVER);
    let (centre, radius) = (place.center(), MARK / 2.0);
    let painter = ui.painter();
    painter.circle_stroke(centre, radius, Stroke::new(1.5, colour));
    if done {
        let stroke = Stroke::new(2.0, colour);
        let corner = centre + vec2(-0.1, 0.5) * radius;
        painter.line_segment([centre + vec2(-0.55, 0.0) * radius, corner], stroke);
        painter.line_segment([corner, centre + vec2(0.6, -0.5) * radius], stroke);
    }
}

/// The remark about the state of the machine; `None` if there is none.
fn remark(step: &Step, remark: Remark, language: Language) -> Option<String> {
    let said = match remark {
        Remark::None => return None,
        Remark::Wrong(index) => return Some(step.wrong.get(index)?.say.of(language).to_owned()),
        Remark::PowerOff => say::lesson_power_off(),
        Remark::EmergencyStop => say::lesson_emergency_stop(),
        Remark::Alarm(number) => {
            let about = topic(Subject::Alarm(number));
            let about = about.map(|topic| article(topic, language).heading);
            say::lesson_alarm(about.unwrap_or_else(|| number.to_string()))
        }
        Remark::Stuck => say::lesson_stuck(),
    };
    Some(said.text(language))
}
