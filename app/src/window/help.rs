//! The help window: shows the topic about what the operator points at or searches for, beside
//! the panel (WINDOW-12); lists when an alarm was raised, and starts demonstrations
//! (WINDOW-21).

mod raised;
mod shown;

use egui::{Color32, Context, Frame, Key, Margin, RichText, ScrollArea, TextEdit, Ui};
use gsk_core::model::ModelId;
use gsk_help::{Subject, Topic, article, search_model, topic, topic_of};
use gsk_messages::{Language, say};
use gsk_panel::alarm_log::AlarmRecord;

use super::clear;
use super::focus;
use super::placing::View;
use crate::kernel::{LessonOrder, Snapshot};

/// Size of the window, points.
const SIZE: [f32; 2] = [440.0, 420.0];
/// Width and height that the frame and the title add, points.
const FRAME: egui::Vec2 = egui::vec2(20.0, 48.0);
/// Greatest count of topics in a search result.
const LISTED: usize = 60;

/// A request from the help window.
#[derive(Clone, Debug)]
pub enum Asked {
    /// A command for the demonstration on the practice machine.
    Lesson(LessonOrder),
    /// Show the program view at the block that raised this alarm.
    Block(Box<AlarmRecord>),
}

/// The help window.
#[derive(Debug, Default)]
pub struct Help {
    open: bool,
    question: String,
    /// The last query with its model, and the topics found. The search reads all texts: too
    /// slow for every frame.
    found: ((ModelId, String), Vec<&'static Topic>),
    /// The topics that were read; the last one is shown.
    read: Vec<&'static Topic>,
    /// Whether a press on the panel shows its topic instead of pressing the key.
    explains: bool,
}

impl Help {
    /// Opens the window at a topic, or with `None` at the last one. Closes it when it already
    /// shows that topic.
    pub fn ask(&mut self, about: Option<&'static Topic>) {
        let shown = self.read.last().copied();
        if self.open && (about.is_none() || about == shown) {
            self.open = false;
            self.explains = false;
            return;
        }
        self.open = true;
        self.question.clear();
        if let Some(about) = about {
            self.turn_to(about);
        }
    }

    /// Whether a press on the panel shows its topic instead of pressing the key.
    pub const fn explains(&self) -> bool {
        self.open && self.explains
    }

    /// Shows the topic of a part that was pressed while presses are explained.
    pub fn explain(&mut self, about: &'static Topic) {
        self.question.clear();
        self.turn_to(about);
    }

    fn turn_to(&mut self, about: &'static Topic) {
        if self.read.last() != Some(&about) {
            self.read.push(about);
        }
    }

    /// Draws the window, if it is open, and returns the operator's request.
    pub fn show(
        &mut self,
        context: &Context,
        language: Language,
        picture: Option<&Snapshot>,
        placed: &[View],
    ) -> Option<Asked> {
        if !self.open {
            return None;
        }
        // The window opens below the top bar and covers no key that stops the machine.
        let mut screen = context.content_rect();
        screen.min.y += super::BAR;
        let wanted = egui::Vec2::from(SIZE) + FRAME;
        let room = clear::room(screen, &clear::stops(placed), |room| {
            clear::worth(room, wanted, placed)
        });
        let most = room.size() - FRAME;
        let size = egui::Vec2::from(SIZE).min(most);
        let mut open = true;
        let asked = egui::Window::new(say::window_help_title().text(language))
            .id(egui::Id::unique("help"))
            .collapsible(false)
            .default_size(size)
            .max_size(most)
            .default_pos(room.right_top() - egui::vec2(wanted.x.min(room.width()), 0.0))
            .constrain_to(room)
            .open(&mut open)
            .show(context, |ui| self.inside(ui, language, picture));
        self.open &= open;
        self.explains &= self.open;
        asked.and_then(|asked| asked.inner).flatten()
    }

    fn inside(
        &mut self,
        ui: &mut Ui,
        language: Language,
        picture: Option<&Snapshot>,
    ) -> Option<Asked> {
        ui.horizontal(|ui| {
            let back = egui::Button::new("⬅");
            let back = ui.add_enabled(self.read.len() > 1 && self.question.is_empty(), back);
            let back = back.on_hover_text(say::window_help_back().text(language));
            if back.clicked() {
                self.read.pop();
            }
            let explain = say::window_help_explain().text(language);
            ui.toggle_value(&mut self.explains, explain)
                .on_hover_text(say::window_help_explain_hint().text(language));
            let hint = say::window_help_hint().text(language);
            let field = TextEdit::singleline(&mut self.question).hint_text(hint);
            let field = ui.add(field.desired_width(f32::INFINITY));
            if field.has_focus() && ui.input(|input| input.key_pressed(Key::Escape)) {
                self.question.clear();
            }
        });
        ui.separator();
        let under_way = picture.and_then(|picture| picture.lesson.as_ref());
        let mut asked = under_way.and_then(|state| shown::under_way(ui, state, language));
        ScrollArea::vertical()
            .auto_shrink([false, false])
            .show(ui, |ui| {
                let below = self.text(ui, language, picture);
                asked = asked.take().or(below);
                focus::follow(ui);
            });
        asked
    }

    fn text(
        &mut self,
        ui: &mut Ui,
        language: Language,
        picture: Option<&Snapshot>,
    ) -> Option<Asked> {
        if !self.question.trim().is_empty() {
            let model = picture.map(|picture| picture.model).unwrap_or_default();
            let looked_up = (model, self.question.clone());
            if self.found.0 != looked_up {
                self.found = (looked_up, search_model(model, &self.question));
            }
            match &self.found.1[..] {
                [] => {
                    ui.label(say::window_help_nothing().text(language));
                }
                [only] => return show_topic(ui, only, language, picture),
                several => {
                    if let Some(chosen) = list(ui, several, language) {
                        self.question.clear();
                        self.turn_to(chosen);
                    }
                }
            }
            return None;
        }
        let Some(shown) = self.read.last() else {
            ui.label(say::window_help_begin().text(language));
            return None;
        };
        // Another model may have been turned on since then: a code is explained for the
        // current model.
        let model = picture.map(|picture| picture.model).unwrap_or_default();
        let shown = topic_of(model, shown.subject).unwrap_or(shown);
        let asked = show_topic(ui, shown, language, picture);
        if let Some(chosen) = list(ui, &related(shown.subject), language) {
            self.turn_to(chosen);
        }
        asked
    }
}

/// Draws topics by their headings. Returns the one that was clicked.
fn list(ui: &mut Ui, topics: &[&'static Topic], language: Language) -> Option<&'static Topic> {
    let name = say::window_help_list_name().text(language);
    let count = topics.len().min(LISTED);
    let list = focus::List::begin(ui, "topics", &name, count, None);
    let mut chosen = list.entered().and_then(|at| topics.get(at).copied());
    for (at, topic) in topics.iter().take(LISTED).enumerate() {
        let link = focus::link(ui, article(topic, language).heading.into());
        if list.row(ui, at, &link) {
            chosen = Some(*topic);
        }
    }
    if topics.len() > LISTED {
        ui.weak(say::help_more(topics.len() - LISTED).text(language));
    }
    chosen
}

/// Topics related to a subject: the bits of a state parameter, the parameter of a bit, the
/// page of a field.
fn related(subject: Subject<'_>) -> Vec<&'static Topic> {
    match subject {
        Subject::Parameter(number) => (0..8)
            .rev()
            .filter_map(|bit| topic(Subject::Bit(number, bit)))
            .collect(),
        Subject::Bit(number, _) => topic(Subject::Parameter(number)).into_iter().collect(),
        Subject::Field(page, _) => topic(Subject::Page(page)).into_iter().collect(),
        _ => Vec::new(),
    }
}

/// Draws a topic with its demonstrations and, for an alarm, its occurrences.
fn show_topic(
    ui: &mut Ui,
    topic: &Topic,
    language: Language,
    picture: Option<&Snapshot>,
) -> Option<Asked> {
    show_article(ui, topic, language);
    // Demonstrations run on a GSK980TD only.
    let asked = match topic.model {
        None => shown::offered(ui, topic.subject, language),
        Some(_) => None,
    };
    let raised = match topic.subject {
        Subject::Alarm(number) => {
            picture.and_then(|picture| raised::of(ui, number, &picture.raised, language))
        }
        _ => None,
    };
    asked.or(raised)
}

/// Draws the article of a topic.
pub fn show_article(ui: &mut Ui, topic: &Topic, language: Language) {
    let article = article(topic, language);
    ui.heading(article.heading);
    ui.add_space(4.0);
    if !article.rule.is_empty() {
        ui.label(article.rule);
        ui.add_space(4.0);
    }
    for fact in article.facts {
        ui.label(RichText::new(fact).color(Color32::from_gray(170)));
    }
    if !article.example.is_empty() {
        ui.add_space(4.0);
        Frame::new()
            .fill(ui.visuals().faint_bg_color)
            .inner_margin(Margin::same(6))
            .show(ui, |ui| {
                ui.label(RichText::new(say::window_help_example().text(language)).strong());
                ui.label(article.example);
            });
    }
    if !article.source.is_empty() {
        ui.weak(article.source);
    }
    ui.add_space(6.0);
}
