//! The first start: asks three questions instead of the panel and opens the layout for the
//! answers (WINDOW-16).

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use egui::{Align, Button, Color32, Context, Key, Layout as Flow, RichText, ScrollArea, Ui, vec2};
use gsk_core::model::ModelId;

use super::Window;
use super::files::{self, Wanted};
use super::focus;
use super::layout::{Layout, Layouts};
use super::view::View;
use crate::kernel::Console;
use crate::{loading, platform};
use gsk_messages::{Language, Message, say};

/// Height of an answer, points: large enough for a finger.
const ANSWER: f32 = 44.0;
/// Least width of an answer, points.
const LEAST: f32 = 150.0;
/// Greatest width of the column of questions, points.
const WIDEST: f32 = 720.0;
const WRONG: Color32 = Color32::from_rgb(255, 150, 110);

/// The purpose for which the operator uses the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Learning to operate and program the control.
    Learning,
    /// Checking programs before they are cut.
    Checking,
    /// Running a lathe with a pulse board.
    OwnLathe,
}

struct PurposeRow {
    purpose: Purpose,
    name: fn() -> Message,
    /// Description of the screen that opens.
    shows: fn() -> Message,
    layout: Layout,
    /// A view that is docked in addition to those of the layout.
    view: Option<View>,
}

/// The purposes in the order of the answers.
static PURPOSES: [PurposeRow; 3] = [
    PurposeRow {
        purpose: Purpose::Learning,
        name: say::first_learning,
        shows: say::first_learning_shows,
        layout: Layout::Learner,
        view: None,
    },
    PurposeRow {
        purpose: Purpose::Checking,
        name: say::first_checking,
        shows: say::first_checking_shows,
        layout: Layout::Programmer,
        view: None,
    },
    PurposeRow {
        purpose: Purpose::OwnLathe,
        name: say::first_own_lathe,
        shows: say::first_own_lathe_shows,
        layout: Layout::Panel,
        view: Some(View::Link),
    },
];

impl Purpose {
    /// Opens the layout and the view for this purpose.
    pub fn open(self, layouts: &mut Layouts) {
        let Some(row) = PURPOSES.iter().find(|row| row.purpose == self) else {
            return;
        };
        layouts.choose(row.layout);
        if let Some(view) = row.view
            && !layouts.docked().contains(&view)
        {
            layouts.dock(view);
        }
        // The panel is shown first where both do not fit.
        layouts.bring(None);
    }
}

/// The answers to the questions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answers {
    pub purpose: Purpose,
    pub model: ModelId,
    /// The machine file; `None`: the simulated lathe as delivered.
    pub machine: Option<PathBuf>,
}

/// How the operator has left the questions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Left {
    /// All questions are answered.
    Answered(Answers),
    /// Without answers; the questions do not appear again.
    Skipped,
}

/// A machine file that was chosen in a file dialog, or its error.
type Chosen = Arc<Mutex<Option<Result<PathBuf, Message>>>>;

/// The page of the questions while it is open.
#[derive(Debug)]
pub struct FirstStart {
    purpose: Option<Purpose>,
    model: ModelId,
    machine: Option<PathBuf>,
    wrong: Option<Message>,
    chosen: Chosen,
    /// Whether the page asks for the control and the lathe. A page in a browser has no files.
    asks_lathe: bool,
    /// Whether the first answer has received the keyboard focus.
    begun: bool,
}

impl FirstStart {
    /// Creates the page. `changeable`: another control model can be turned on.
    pub fn new(model: ModelId, machine: Option<PathBuf>, changeable: bool) -> Self {
        Self {
            purpose: None,
            model,
            machine,
            wrong: None,
            chosen: Chosen::default(),
            asks_lathe: changeable && platform::has_folders(),
            begun: false,
        }
    }

    /// Draws the page. The language changes as soon as it is answered. Returns how the page
    /// was left, if it was.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        language: &mut Language,
        console: &Console,
    ) -> Option<Left> {
        self.take_chosen();
        let mut left = None;
        let frame = egui::Frame::new()
            .fill(Color32::from_gray(22))
            .inner_margin(egui::Margin::symmetric(16, 10));
        egui::CentralPanel::default().frame(frame).show(ui, |ui| {
            ScrollArea::vertical()
                .id_salt("first start")
                .auto_shrink([false, false])
                .show(ui, |ui| {
                    let width = ui.available_width().min(WIDEST);
                    let beside = (ui.available_width() - width) / 2.0;
                    ui.horizontal_top(|ui| {
                        ui.add_space(beside);
                        ui.allocate_ui_with_layout(
                            vec2(width, 0.0),
                            Flow::top_down(Align::Min),
                            |ui| {
                                ui.set_width(width);
                                left = self.questions(ui, language, console);
                            },
                        );
                    });
                    focus::follow(ui);
                });
        });
        if ui.input(|input| input.key_pressed(Key::Escape)) {
            left = Some(Left::Skipped);
        }
        left
    }

    fn questions(
        &mut self,
        ui: &mut Ui,
        language: &mut Language,
        console: &Console,
    ) -> Option<Left> {
        // The first question is in both languages.
        let both = [Language::Zh, Language::En].map(|it| say::first_language().text(it));
        ui.heading(both.join("    "));
        ui.horizontal_wrapped(|ui| {
            for (answer, other) in [(Language::Zh, Language::En), (Language::En, Language::Zh)] {
                let name = say::window_other_language().text(other);
                let asked = option(ui, *language == answer, &name, LEAST);
                if !self.begun && *language == answer {
                    self.begun = true;
                    asked.request_focus();
                }
                if asked.clicked() {
                    *language = answer;
                }
            }
        });
        let said = |said: Message| said.text(*language);
        heading(ui, &said(say::first_what_for()));
        for row in &PURPOSES {
            let chosen = self.purpose == Some(row.purpose);
            if option(ui, chosen, &said((row.name)()), ui.available_width()).clicked() {
                self.purpose = Some(row.purpose);
            }
            ui.weak(said((row.shows)()));
        }
        if self.asks_lathe {
            heading(ui, &said(say::first_which_control()));
            ui.horizontal_wrapped(|ui| {
                for id in ModelId::ALL.into_iter().filter(|id| !id.is_mill()) {
                    if option(ui, self.model == id, id.name(), LEAST).clicked() {
                        self.model = id;
                    }
                }
            });
            heading(ui, &said(say::first_which_lathe()));
            self.lathe(ui, *language, console);
        }
        ui.add_space(18.0);
        let mut left = None;
        ui.horizontal_wrapped(|ui| {
            let begin = RichText::new(said(say::first_begin())).size(16.0);
            let begin = Button::new(begin).min_size(vec2(LEAST, ANSWER));
            let begin = ui.add_enabled(self.purpose.is_some(), begin);
            let begin = begin.on_disabled_hover_text(said(say::first_answer_all()));
            if let (true, Some(purpose)) = (begin.clicked(), self.purpose) {
                left = Some(Left::Answered(Answers {
                    purpose,
                    model: self.model,
                    machine: self.machine.clone(),
                }));
            }
            let skip = Button::new(said(say::first_skip())).min_size(vec2(LEAST, ANSWER));
            if ui.add(skip).clicked() {
                left = Some(Left::Skipped);
            }
        });
        ui.weak(said(say::first_again()));
        left
    }

    /// Draws the question about the lathe of the control.
    fn lathe(&mut self, ui: &mut Ui, language: Language, console: &Console) {
        ui.horizontal_wrapped(|ui| {
            let simulated = say::first_simulated().text(language);
            if option(ui, self.machine.is_none(), &simulated, LEAST).clicked() {
                self.machine = None;
                self.wrong = None;
            }
            let name = self.machine.as_ref().and_then(|path| path.file_name());
            let file = match name {
                Some(name) => say::first_machine_file_is(name.to_string_lossy()),
                None => say::first_machine_file(),
            };
            let file = option(ui, self.machine.is_some(), &file.text(language), LEAST);
            if file.clicked() {
                self.choose(ui.ctx(), language, console);
            }
        });
        let hint = say::first_machine_file_hint().text(language);
        ui.weak(hint);
        if let Some(wrong) = &self.wrong {
            ui.label(RichText::new(wrong.text(language)).color(WRONG));
        }
    }

    fn choose(&self, context: &Context, language: Language, console: &Console) {
        let chosen = Arc::clone(&self.chosen);
        let name = say::first_machine_files().text(language);
        let wanted = Wanted::Open(name, vec!["ron"]);
        files::choose(context, language, &console.say, wanted, move |path| {
            let path = std::path::absolute(&path).unwrap_or(path);
            let read = loading::machine(&path).map_err(|error| error.message());
            let answer = read.map(|_| path);
            *chosen.lock().unwrap_or_else(PoisonError::into_inner) = Some(answer);
            None
        });
    }

    fn take_chosen(&mut self) {
        let mut chosen = self.chosen.lock().unwrap_or_else(PoisonError::into_inner);
        match chosen.take() {
            Some(Ok(path)) => {
                self.machine = Some(path);
                self.wrong = None;
            }
            Some(Err(said)) => self.wrong = Some(said),
            None => {}
        }
    }
}

fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(14.0);
    ui.heading(text);
}

/// Draws an answer as a button that is large enough for a finger.
fn option(ui: &mut Ui, chosen: bool, name: &str, width: f32) -> egui::Response {
    let text = RichText::new(name).size(16.0);
    ui.add(
        Button::selectable(chosen, text)
            .min_size(vec2(width, ANSWER))
            .frame_when_inactive(true),
    )
}

impl Window {
    /// Opens the questions of the first start instead of the panel.
    pub fn ask_first(&mut self) {
        let (model, machine) = (self.models.shown, self.settings.machine.clone());
        self.first_start = Some(FirstStart::new(model, machine, self.models.changeable));
    }

    /// Draws the questions of the first start and applies the answers. Returns whether they
    /// are visible: never while a board moves real slides.
    pub(super) fn asks_first(&mut self, ui: &mut Ui) -> bool {
        if self.board().is_some() {
            return false;
        }
        let Some(asked) = &mut self.first_start else {
            return false;
        };
        let left = asked.show(ui, &mut self.settings.language, &self.console);
        self.pointer = None;
        let Some(left) = left else { return true };
        self.first_start = None;
        self.settings.first_start = false;
        if let Left::Answered(answers) = left {
            answers.purpose.open(&mut self.settings.layouts);
            let same = answers.machine == self.settings.machine;
            self.settings.machine = answers.machine;
            if !same || answers.model != self.models.shown {
                self.models.asked = Some(answers.model);
            }
        }
        true
    }
}
