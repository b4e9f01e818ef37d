//! The help window: shows the topic about what the operator points at or searches for, beside
//! the panel (WINDOW-12); lists when an alarm was raised, and starts demonstrations
//! (WINDOW-21).

mod alarm_history;
mod contents;
mod demonstrations;

use egui::{Context, Frame, Key, Margin, RichText, ScrollArea, TextEdit, Ui};
use gsk_core::model::ModelId;
use gsk_help::{Subject, Topic, article, search_model, topic, topic_of};
use gsk_host::kernel::{LessonAction, PanelSnapshot};
use gsk_messages::{Language, say};
use gsk_panel::alarm_log::AlarmRecord;

use super::theme;
use crate::focus;
use crate::placement::panel_placement::PlacedArea;
use crate::placement::stop_key_clearance;
use crate::widgets::icons::{Icon, IconButton};
use contents::HelpChapter;

/// Size of the help window, points.
const WINDOW_SIZE: [f32; 2] = [440.0, 420.0];
/// Width and height that frame and title add to the content, points.
const FRAME_SIZE: egui::Vec2 = egui::vec2(20.0, 48.0);
/// Maximum number of topics in a search result.
const MAX_LISTED: usize = 60;

/// The id under which a frame keeps the topic of the element under the pointer.
const POINTED_TOPIC: &str = "pointed topic";

/// A request of the user in the help window.
#[derive(Clone, Debug)]
pub enum HelpRequest {
    /// Carry out a command of the demonstration on the practice machine.
    Lesson(LessonAction),
    /// Show the program view at the block that raised this alarm.
    Block(Box<AlarmRecord>),
    /// Open the lessons from the help window.
    OpenLessons,
}

/// The state of the help window.
#[derive(Debug, Default)]
pub struct HelpWindow {
    is_open: bool,
    query: String,
    /// The last query with its control model, and the topics found. The search reads all texts
    /// and would be too slow for every frame.
    search_result: ((ModelId, String), Vec<&'static Topic>),
    /// The topics that the operator has read; the last one is shown.
    history: Vec<&'static Topic>,
    /// The chapter whose topics are listed; `None`: the contents, or a topic.
    chapter: Option<HelpChapter>,
    /// Whether a press on the panel shows its topic instead of pressing the key.
    explains_presses: bool,
}

impl HelpWindow {
    /// Opens the window at a topic; `None` opens the last one. Closes the window if it already
    /// shows that topic.
    pub fn toggle(&mut self, topic: Option<&'static Topic>) {
        let current = self.history.last().copied();
        if self.is_open && (topic.is_none() || topic == current) {
            self.is_open = false;
            self.explains_presses = false;
            return;
        }
        self.is_open = true;
        self.query.clear();
        if let Some(topic) = topic {
            self.push_topic(topic);
        }
    }

    /// Whether the help window is open.
    pub const fn is_open(&self) -> bool {
        self.is_open
    }

    /// Closes the help window.
    pub const fn close(&mut self) {
        self.is_open = false;
        self.explains_presses = false;
    }

    /// Whether a press on the panel shows the topic of the key instead of pressing it.
    pub const fn is_explaining(&self) -> bool {
        self.is_open && self.explains_presses
    }

    /// Shows the topic of a panel part that was pressed while presses are explained.
    pub fn show_pressed(&mut self, topic: &'static Topic) {
        self.query.clear();
        self.push_topic(topic);
    }

    fn push_topic(&mut self, topic: &'static Topic) {
        if self.history.last() != Some(&topic) {
            self.history.push(topic);
        }
    }

    /// Draws the window, if it is open, and returns the operator's request; `None` without one.
    pub fn show(
        &mut self,
        context: &Context,
        language: Language,
        snapshot: Option<&PanelSnapshot>,
        placed: &[PlacedArea],
    ) -> Option<HelpRequest> {
        if !self.is_open {
            return None;
        }
        // The window opens below the top bar and covers no key that stops the machine.
        let mut screen = context.content_rect();
        screen.min.y += super::TOP_BAR_HEIGHT;
        let wanted_size = egui::Vec2::from(WINDOW_SIZE) + FRAME_SIZE;
        let area = stop_key_clearance::best_rect(
            screen,
            &stop_key_clearance::stop_key_rects(placed),
            |room| stop_key_clearance::rate_beside_panel(room, wanted_size, placed),
        );
        let max_size = area.size() - FRAME_SIZE;
        let size = egui::Vec2::from(WINDOW_SIZE).min(max_size);
        let mut open = true;
        let request = egui::Window::new(say::window_help_title().text(language))
            .id(egui::Id::unique("help"))
            .collapsible(false)
            .default_size(size)
            .max_size(max_size)
            .default_pos(area.right_top() - egui::vec2(wanted_size.x.min(area.width()), 0.0))
            .constrain_to(area)
            .open(&mut open)
            .show(context, |ui| self.show_content(ui, language, snapshot));
        self.is_open &= open;
        self.explains_presses &= self.is_open;
        request.and_then(|response| response.inner).flatten()
    }

    fn show_content(
        &mut self,
        ui: &mut Ui,
        language: Language,
        snapshot: Option<&PanelSnapshot>,
    ) -> Option<HelpRequest> {
        let mut opens_first = false;
        ui.horizontal(|ui| {
            let back = egui::Button::new("⬅");
            let is_inside = !self.history.is_empty() || self.chapter.is_some();
            let back = ui.add_enabled(is_inside && self.query.is_empty(), back);
            let back = back.on_hover_text(say::window_help_back().text(language));
            // From a topic to the one before, then to its chapter, then to the contents.
            if back.clicked() && self.history.pop().is_none() {
                self.chapter = None;
            }
            let contents = IconButton {
                icon: Icon::BOOK,
                name: say::window_help_contents().text(language),
                hint: String::new(),
                is_selected: None,
            };
            if contents.show(ui, false).clicked() {
                self.query.clear();
                self.history.clear();
                self.chapter = None;
            }
            let explain = say::window_help_explain().text(language);
            ui.toggle_value(&mut self.explains_presses, explain)
                .on_hover_text(say::window_help_explain_hint().text(language));
            let hint = say::window_help_hint().text(language);
            let field = TextEdit::singleline(&mut self.query).hint_text(hint);
            let field = ui.add(field.desired_width(f32::INFINITY));
            let entered = ui.input(|input| input.key_pressed(Key::Enter));
            opens_first = field.lost_focus() && entered;
            if field.has_focus() && ui.input(|input| input.key_pressed(Key::Escape)) {
                self.query.clear();
            }
        });
        ui.separator();
        let lesson = snapshot.and_then(|picture| picture.lesson.as_ref());
        let mut request =
            lesson.and_then(|state| demonstrations::show_running(ui, state, language));
        ScrollArea::vertical()
            .auto_shrink([false, false])
            .show(ui, |ui| {
                let topic_request = self.show_topics(ui, language, snapshot, opens_first);
                request = request.take().or(topic_request);
                focus::scroll_to_focus(ui);
            });
        request
    }

    fn show_topics(
        &mut self,
        ui: &mut Ui,
        language: Language,
        snapshot: Option<&PanelSnapshot>,
        opens_first: bool,
    ) -> Option<HelpRequest> {
        if !self.query.trim().is_empty() {
            let model = snapshot.map(|picture| picture.model).unwrap_or_default();
            let search = (model, self.query.clone());
            if self.search_result.0 != search {
                self.search_result = (search, search_model(model, &self.query));
            }
            match &self.search_result.1[..] {
                [] => {
                    ui.label(say::window_help_nothing().text(language));
                }
                [only] => return show_topic(ui, only, language, snapshot),
                several => {
                    let first = several.first().copied().filter(|_| opens_first);
                    let chosen = show_topic_list(ui, several, MAX_LISTED, language);
                    if let Some(chosen) = chosen.or(first) {
                        self.query.clear();
                        self.push_topic(chosen);
                    }
                }
            }
            return None;
        }
        let Some(current) = self.history.last() else {
            return self.show_contents(ui, language, snapshot);
        };
        // Another model may have been turned on since then: a code is explained for the
        // current model.
        let model = snapshot.map(|picture| picture.model).unwrap_or_default();
        let current = topic_of(model, current.subject).unwrap_or(current);
        let request = show_topic(ui, current, language, snapshot);
        let related = related_topics(current.subject);
        if let Some(chosen) = show_topic_list(ui, &related, MAX_LISTED, language) {
            self.push_topic(chosen);
        }
        request
    }
}

/// Draws at most `limit` topics by their headings. Returns the topic that was clicked, if any.
fn show_topic_list(
    ui: &mut Ui,
    topics: &[&'static Topic],
    limit: usize,
    language: Language,
) -> Option<&'static Topic> {
    let name = say::window_help_list_name().text(language);
    let count = topics.len().min(limit);
    let list = focus::FocusList::begin(ui, "topics", &name, count, None);
    let mut chosen = list.entered_row().and_then(|at| topics.get(at).copied());
    for (at, topic) in topics.iter().take(limit).enumerate() {
        let link = focus::link_row(ui, article(topic, language).heading.into());
        if list.show_cursor(ui, at, &link) {
            chosen = Some(*topic);
        }
    }
    if topics.len() > limit {
        ui.weak(say::help_more(topics.len() - limit).text(language));
    }
    chosen
}

/// Topics related to a subject: the bits of a state parameter, the parameter of a bit, the
/// page of a field.
fn related_topics(subject: Subject<'_>) -> Vec<&'static Topic> {
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

/// Draws a topic with its demonstrations and, for an alarm, its occurrences. Returns the operator's
/// request; `None` without one.
fn show_topic(
    ui: &mut Ui,
    topic: &Topic,
    language: Language,
    snapshot: Option<&PanelSnapshot>,
) -> Option<HelpRequest> {
    show_article(ui, topic, language);
    // Demonstrations run on a GSK980TD only.
    let request = match topic.model {
        None => demonstrations::show_offers(ui, topic.subject, language),
        Some(_) => None,
    };
    let history_request = match topic.subject {
        Subject::Alarm(number) => snapshot.and_then(|picture| {
            alarm_history::show_occurrences(ui, number, &picture.alarm_records, language)
        }),
        _ => None,
    };
    request.or(history_request)
}

/// Names the topic of the element under the pointer, which F1 then shows instead of that of its
/// view.
pub fn point_at_topic(ui: &Ui, topic: Option<&'static Topic>) {
    ui.data_mut(|data| data.insert_temp(egui::Id::unique(POINTED_TOPIC), topic));
}

/// Takes the topic of the element under the pointer in this frame; `None` without one.
pub fn take_pointed_topic(context: &Context) -> Option<&'static Topic> {
    let id = egui::Id::unique(POINTED_TOPIC);
    let topic: Option<Option<&'static Topic>> = context.data_mut(|data| data.remove_temp(id));
    topic.flatten()
}

/// Draws the help article of a topic.
pub fn show_article(ui: &mut Ui, topic: &Topic, language: Language) {
    let article = article(topic, language);
    ui.heading(article.heading);
    ui.add_space(4.0);
    if !article.rule.is_empty() {
        ui.label(article.rule);
        ui.add_space(4.0);
    }
    for fact in article.facts {
        ui.label(RichText::new(fact).color(theme::NOTE_TEXT));
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
