//! The first start: asks three questions instead of the panel and opens the layout for the
//! answers (WINDOW-16).

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use egui::{Align, Button, Context, Key, Layout as Flow, RichText, ScrollArea, Ui, Vec2, vec2};
use gsk_core::model::ModelId;
use gsk_host::kernel::Console;
use gsk_host::loading::{self, SHIPPED_LATHES};
use gsk_host::platform;

use crate::Window;
use crate::focus;
use crate::layout::{Layouts, WindowLayout};
use crate::theme;
use crate::view::ViewId;
use crate::widgets::card::{Card, CardPicture};
use crate::widgets::files::{self, FileChoice};
use crate::widgets::icons::Icon;
use gsk_messages::{Language, Message, say};

/// Minimum size of a button with an answer, points: large enough for a finger.
const ANSWER: Vec2 = vec2(150.0, 44.0);
/// Minimum size of a button with an answer in a low window, points.
const LOW_ANSWER: Vec2 = vec2(96.0, 36.0);
/// Height of the window below which all questions are closer together, points.
const LOW_WINDOW: f32 = 640.0;
/// Maximum width of the column of questions, points.
const MAX_COLUMN_WIDTH: f32 = 720.0;

/// The purpose for which the operator uses the program, which selects the layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// The operator wants to learn how to operate and program the control.
    Learning,
    /// The operator wants to check programs before they are cut.
    Checking,
    /// The operator wants to run a real lathe with a pulse board.
    OwnLathe,
}

struct PurposeRow {
    purpose: Purpose,
    icon: Icon,
    name: fn() -> Message,
    /// Returns the description of the screen that opens for this purpose.
    description: fn() -> Message,
    layout: WindowLayout,
    /// A view that is docked in addition to those of the layout; `None`: no other view.
    view: Option<ViewId>,
}

/// The purposes in the order of their answer buttons.
static PURPOSES: [PurposeRow; 3] = [
    PurposeRow {
        purpose: Purpose::Learning,
        icon: Icon::LESSON,
        name: say::first_learning,
        description: say::first_learning_shows,
        layout: WindowLayout::Learner,
        view: None,
    },
    PurposeRow {
        purpose: Purpose::Checking,
        icon: Icon::CODE,
        name: say::first_checking,
        description: say::first_checking_shows,
        layout: WindowLayout::Programmer,
        view: None,
    },
    PurposeRow {
        purpose: Purpose::OwnLathe,
        icon: Icon::TOOLS,
        name: say::first_own_lathe,
        description: say::first_own_lathe_shows,
        layout: WindowLayout::Panel,
        view: Some(ViewId::Link),
    },
];

impl Purpose {
    /// Chooses the layout of this purpose and docks its view.
    pub fn apply(self, layouts: &mut Layouts) {
        let Some(row) = PURPOSES.iter().find(|row| row.purpose == self) else {
            return;
        };
        layouts.choose(row.layout);
        if let Some(view) = row.view
            && !layouts.docked().contains(&view)
        {
            layouts.dock(view);
        }
        layouts.bring_first_to_front();
    }
}

/// The operator's answers to the questions of the first start.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FirstStartAnswers {
    pub purpose: Purpose,
    pub model: ModelId,
    /// Path of the machine file; `None` selects the simulated lathe as delivered.
    pub machine_file: Option<PathBuf>,
}

/// How the operator has ended the questions of the first start.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FirstStartEnd {
    /// The operator has answered all questions.
    Answered(FirstStartAnswers),
    /// The operator has skipped the questions; they do not appear again.
    Skipped,
}

/// The machine file chosen in a file dialog, or why it cannot be used; `None` before a choice.
type ChosenMachine = Arc<Mutex<Option<Result<PathBuf, Message>>>>;

/// The page with the questions of the first start, while it is open.
#[derive(Debug)]
pub struct FirstStart {
    purpose: Option<Purpose>,
    model: ModelId,
    machine_file: Option<PathBuf>,
    file_error: Option<Message>,
    chosen_file: ChosenMachine,
    /// Whether the page queries control and lathe. A page in a browser has no files and no
    /// such question.
    has_lathe_question: bool,
    /// Whether the first answer button has received the keyboard focus.
    has_set_focus: bool,
}

impl FirstStart {
    /// Creates the page with the current model and machine file as answers. `changeable`:
    /// another control model can be turned on.
    pub fn new(model: ModelId, machine_file: Option<PathBuf>, changeable: bool) -> Self {
        Self {
            purpose: None,
            model,
            machine_file,
            file_error: None,
            chosen_file: ChosenMachine::default(),
            has_lathe_question: changeable && platform::has_folders(),
            has_set_focus: false,
        }
    }

    /// Draws the page. A chosen language applies at once. Returns how the operator left the
    /// page, or `None` while it is open.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        language: &mut Language,
        console: &Console,
    ) -> Option<FirstStartEnd> {
        self.take_machine_file();
        let mut end = None;
        let frame = egui::Frame::new()
            .fill(theme::WINDOW_GROUND)
            .inner_margin(egui::Margin::symmetric(16, 10));
        egui::CentralPanel::default().frame(frame).show(ui, |ui| {
            ScrollArea::vertical()
                .id_salt("first start")
                .auto_shrink([false, false])
                .show(ui, |ui| {
                    let width = ui.available_width().min(MAX_COLUMN_WIDTH);
                    let side_margin = (ui.available_width() - width) / 2.0;
                    ui.horizontal_top(|ui| {
                        ui.add_space(side_margin);
                        ui.allocate_ui_with_layout(
                            vec2(width, 0.0),
                            Flow::top_down(Align::Min),
                            |ui| {
                                ui.set_width(width);
                                end = self.show_questions(ui, language, console);
                            },
                        );
                    });
                    focus::scroll_to_focus(ui);
                });
        });
        if ui.input(|input| input.key_pressed(Key::Escape)) {
            end = Some(FirstStartEnd::Skipped);
        }
        end
    }

    fn show_questions(
        &mut self,
        ui: &mut Ui,
        language: &mut Language,
        console: &Console,
    ) -> Option<FirstStartEnd> {
        // The first question is in both languages.
        let both = [Language::Zh, Language::En].map(|it| say::first_language().text(it));
        ui.heading(both.join("    "));
        ui.horizontal_wrapped(|ui| {
            for (answer, other) in [(Language::Zh, Language::En), (Language::En, Language::Zh)] {
                let name = say::window_other_language().text(other);
                let answer_button = answer_option(ui, *language == answer, &name);
                if !self.has_set_focus && *language == answer {
                    self.has_set_focus = true;
                    answer_button.request_focus();
                }
                if answer_button.clicked() {
                    *language = answer;
                }
            }
        });
        let text = |message: Message| message.text(*language);
        show_heading(ui, &text(say::first_what_for()));
        for row in &PURPOSES {
            let chosen = self.purpose == Some(row.purpose);
            let card = Card {
                picture: CardPicture::Icon(row.icon),
                title: text((row.name)()),
                detail: text((row.description)()),
                is_marked: chosen,
            };
            if card.show(ui, ui.available_width()).clicked() {
                self.purpose = Some(row.purpose);
            }
        }
        if self.has_lathe_question {
            show_heading(ui, &text(say::first_which_control()));
            ui.horizontal_wrapped(|ui| {
                for id in ModelId::ALL.into_iter().filter(|id| !id.is_mill()) {
                    if answer_option(ui, self.model == id, &text(id.name())).clicked() {
                        self.model = id;
                    }
                }
            });
            show_heading(ui, &text(say::first_which_lathe()));
            self.show_lathe_question(ui, *language, console);
        }
        ui.add_space(if is_low(ui) { 6.0 } else { 18.0 });
        let mut end = None;
        ui.horizontal_wrapped(|ui| {
            let begin = RichText::new(text(say::first_begin())).size(theme::LARGE_SIZE);
            let mut begin = Button::new(begin).min_size(answer_size(ui));
            if self.purpose.is_some() {
                begin = begin.fill(theme::ACCENT_GROUND);
            }
            let begin = ui.add_enabled(self.purpose.is_some(), begin);
            if let (true, Some(purpose)) = (begin.clicked(), self.purpose) {
                end = Some(FirstStartEnd::Answered(FirstStartAnswers {
                    purpose,
                    model: self.model,
                    machine_file: self.machine_file.clone(),
                }));
            }
            let skip = Button::new(text(say::first_skip())).min_size(answer_size(ui));
            if ui.add(skip).clicked() {
                end = Some(FirstStartEnd::Skipped);
            }
            if self.purpose.is_none() {
                let missing = RichText::new(text(say::first_answer_all()));
                ui.label(missing.color(theme::WARNING));
            }
        });
        ui.weak(text(say::first_again()));
        end
    }

    /// Draws the question about control model and machine file.
    fn show_lathe_question(&mut self, ui: &mut Ui, language: Language, console: &Console) {
        ui.horizontal_wrapped(|ui| {
            let simulated = say::first_simulated().text(language);
            if answer_option(ui, self.machine_file.is_none(), &simulated).clicked() {
                self.machine_file = None;
                self.file_error = None;
            }
            for lathe in &SHIPPED_LATHES {
                let path = Path::new(lathe.word);
                let is_chosen = self.machine_file.as_deref() == Some(path);
                let name = (lathe.name)().text(language);
                if answer_option(ui, is_chosen, &name).clicked() {
                    self.machine_file = Some(path.to_owned());
                    self.file_error = None;
                }
            }
            let own_file = self.machine_file.as_ref();
            let own_file = own_file.filter(|path| !is_shipped(path));
            let name = own_file.and_then(|path| path.file_name());
            let file = match name {
                Some(name) => say::first_machine_file_is(name.to_string_lossy()),
                None => say::first_machine_file(),
            };
            let file = answer_option(ui, own_file.is_some(), &file.text(language));
            if file.clicked() {
                self.choose_machine_file(ui.ctx(), language, console);
            }
        });
        let is_own_file = self
            .machine_file
            .as_deref()
            .is_some_and(|path| !is_shipped(path));
        if is_own_file || !is_low(ui) {
            ui.weak(say::first_machine_file_hint().text(language));
        }
        if let Some(wrong) = &self.file_error {
            ui.label(RichText::new(wrong.text(language)).color(theme::ERROR_TEXT));
        }
    }

    fn choose_machine_file(&self, context: &Context, language: Language, console: &Console) {
        let chosen = Arc::clone(&self.chosen_file);
        let name = say::first_machine_files().text(language);
        let choice = FileChoice::Open(name, vec!["ron"]);
        files::choose_file(
            context,
            language,
            &console.notice_sender,
            choice,
            move |path| {
                let path = std::path::absolute(&path).unwrap_or(path);
                let checked = loading::load_machine(&path).map_err(|error| error.message());
                let answer = checked.map(|_| path);
                *chosen.lock().unwrap_or_else(PoisonError::into_inner) = Some(answer);
                None
            },
        );
    }

    fn take_machine_file(&mut self) {
        let mut chosen = self
            .chosen_file
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        match chosen.take() {
            Some(Ok(path)) => {
                self.machine_file = Some(path);
                self.file_error = None;
            }
            Some(Err(error)) => self.file_error = Some(error),
            None => {}
        }
    }
}

/// Whether a machine file is one within the program.
fn is_shipped(path: &Path) -> bool {
    SHIPPED_LATHES.iter().any(|it| path == Path::new(it.word))
}

/// Whether the window is so low that the questions need less space between them.
fn is_low(ui: &Ui) -> bool {
    ui.ctx().content_rect().height() < LOW_WINDOW
}

/// Minimum size of a button with an answer, points.
fn answer_size(ui: &Ui) -> Vec2 {
    match is_low(ui) {
        true => LOW_ANSWER,
        false => ANSWER,
    }
}

fn show_heading(ui: &mut Ui, text: &str) {
    ui.add_space(if is_low(ui) { 4.0 } else { 14.0 });
    ui.heading(text);
}

/// Draws an answer as a button that is large enough for a finger. Returns its response.
fn answer_option(ui: &mut Ui, is_chosen: bool, name: &str) -> egui::Response {
    let text = RichText::new(name).size(theme::LARGE_SIZE);
    ui.add(
        Button::selectable(is_chosen, text)
            .min_size(answer_size(ui))
            .frame_when_inactive(true),
    )
}

impl Window {
    /// Opens the questions of the first start instead of the panel.
    pub fn open_first_start(&mut self) {
        let (model, machine) = (self.models.current, self.settings.machine.clone());
        self.first_start = Some(FirstStart::new(model, machine, self.models.is_changeable));
    }

    /// Draws the questions of the first start and applies the answers. Returns whether they
    /// are visible, which they never are while a board moves real slides.
    pub(crate) fn show_first_start(&mut self, ui: &mut Ui) -> bool {
        if self.board().is_some() {
            return false;
        }
        let Some(page) = &mut self.first_start else {
            return false;
        };
        let end = page.show(ui, &mut self.settings.language, &self.console);
        self.pointer_position = None;
        let Some(end) = end else { return true };
        self.first_start = None;
        self.settings.first_start = false;
        if let FirstStartEnd::Answered(answers) = end {
            answers.purpose.apply(&mut self.settings.layouts);
            let same = answers.machine_file == self.settings.machine;
            self.settings.machine = answers.machine_file;
            if !same || answers.model != self.models.current {
                self.models.requested = Some(answers.model);
            }
        }
        true
    }
}
