//! Marks a solution in a thread, shows its report, and saves the sealed result.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crossbeam::channel::{Receiver, Sender, unbounded};
use egui::{Context, RichText, TextEdit, Ui};
use gsk_exercise::judge::judge;
use gsk_exercise::mark_table::{describe_evidence, verdict_sentence};
use gsk_exercise::report::ExerciseReport;
use gsk_exercise::result_file::{RESULT_EXTENSION, ResultAuthor, write_result};
use gsk_exercise::task::ExerciseTask;
use gsk_host::files::{atomic, exercise_key};
use gsk_host::kernel::{Command, Console, ExerciseAction, HandedInSolution};
use gsk_host::output::WriteError;
use gsk_messages::{Language, Message, say};

use crate::theme;
use crate::widgets::files::{FileChoice, choose_file, run_in_thread};
use crate::widgets::mark;

/// Width of the field for the name of the learner, points.
const NAME_WIDTH: f32 = 180.0;

/// A solution with its marks.
#[derive(Clone, Debug)]
struct MarkedSolution {
    solution: Arc<HandedInSolution>,
    report: ExerciseReport,
    hints: Vec<u32>,
    /// Points that the hints cost.
    hint_cost: u32,
}

impl MarkedSolution {
    fn points(&self) -> u32 {
        self.report.points.saturating_sub(self.hint_cost)
    }
}

/// What is shown after the learner has handed in.
#[derive(Default)]
enum ReportContent {
    #[default]
    Nothing,
    Marking,
    Marked(Box<MarkedSolution>),
    Failed(Message),
}

/// The report of a solution.
pub struct SolutionReport {
    console: Console,
    learner: String,
    data: Option<PathBuf>,
    content: ReportContent,
    sender: Sender<Result<MarkedSolution, Message>>,
    receiver: Receiver<Result<MarkedSolution, Message>>,
}

impl SolutionReport {
    pub fn new(console: Console, learner: String) -> Self {
        let (sender, receiver) = unbounded();
        Self {
            console,
            learner,
            data: None,
            content: ReportContent::Nothing,
            sender,
            receiver,
        }
    }

    /// Sets the data folder, with the key that seals results.
    pub fn set_data(&mut self, data: PathBuf) {
        self.data = Some(data);
    }

    pub fn learner(&self) -> &str {
        &self.learner
    }

    /// Sets the name of the learner, unless it is empty.
    pub fn set_learner(&mut self, learner: &str) {
        if !learner.is_empty() {
            learner.clone_into(&mut self.learner);
        }
    }

    /// Discards the report.
    pub fn clear(&mut self) {
        self.content = ReportContent::Nothing;
    }

    /// Marks a solution in a thread. `hints`: numbers of the hints that the learner has read.
    pub fn mark(&mut self, solution: HandedInSolution, hints: Vec<u32>, context: &Context) {
        self.content = ReportContent::Marking;
        let to = self.sender.clone();
        run_in_thread(context, &self.console.notice_sender, move || {
            let marked = mark_solution(solution, hints);
            // The send fails when the window is gone. No window needs the marks then.
            let _ = to.send(marked);
            None
        });
    }

    /// Takes marks that have arrived; returns the report and the points.
    pub fn receive(&mut self) -> Option<(ExerciseReport, u32)> {
        let marked = self.receiver.try_iter().last()?;
        match marked {
            Ok(marked) => {
                let points = (marked.report.clone(), marked.points());
                self.content = ReportContent::Marked(Box::new(marked));
                Some(points)
            }
            Err(why) => {
                self.content = ReportContent::Failed(why);
                None
            }
        }
    }

    /// Draws the report; returns whether a moment of the solution was chosen, which is then shown.
    pub fn show(&mut self, ui: &mut Ui, language: Language) -> bool {
        let mut chosen = None;
        match &self.content {
            ReportContent::Nothing => {}
            ReportContent::Marking => {
                ui.horizontal(|ui| {
                    ui.spinner();
                    ui.label(say::exercise_marking().text(language));
                });
            }
            ReportContent::Failed(why) => {
                ui.label(RichText::new(why.text(language)).color(theme::ERROR_TEXT));
            }
            ReportContent::Marked(marked) => {
                chosen = show_marks(ui, language, marked);
                ui.add_space(8.0);
                if show_save(ui, language, &mut self.learner) {
                    self.save(marked, language, ui.ctx());
                }
            }
        }
        if let Some(elapsed_ms) = chosen {
            let action = ExerciseAction::ShowMoment(elapsed_ms);
            self.console.send(Command::Exercise(action));
        }
        chosen.is_some()
    }

    /// Seals the result and writes it where the learner chooses.
    fn save(&self, marked: &MarkedSolution, language: Language, context: &Context) {
        let learner = self.learner.trim().to_owned();
        let name = result_name(&marked.report.task, &learner);
        let (marked, data) = (marked.clone(), self.data.clone());
        choose_file(
            context,
            language,
            &self.console.notice_sender,
            FileChoice::Save(name, RESULT_EXTENSION),
            move |path| Some(write_sealed(&marked, learner, data.as_deref(), &path)),
        );
    }
}

/// Draws the name of the learner and the button that saves; returns whether it was clicked.
fn show_save(ui: &mut Ui, language: Language, learner: &mut String) -> bool {
    let row = ui.horizontal_wrapped(|ui| {
        let name = ui.label(say::exercise_learner().text(language));
        let field = TextEdit::singleline(learner).desired_width(NAME_WIDTH);
        ui.add(field).labelled_by(name.id);
        let save = egui::Button::new(say::exercise_save().text(language));
        let save = ui.add_enabled(!learner.trim().is_empty(), save);
        let hint = say::exercise_save_hint().text(language);
        save.on_hover_text(hint).clicked()
    });
    row.inner
}

/// Replays and marks a solution.
fn mark_solution(solution: HandedInSolution, hints: Vec<u32>) -> Result<MarkedSolution, Message> {
    let task = &solution.task;
    let report = judge(task, &solution.recording).map_err(|error| error.message())?;
    let hint_cost = task.hint_cost(&hints)?;
    Ok(MarkedSolution {
        solution: Arc::new(solution),
        report,
        hints,
        hint_cost,
    })
}

/// Draws the marks; returns the time of the solution whose moment was chosen, ms.
fn show_marks(ui: &mut Ui, language: Language, marked: &MarkedSolution) -> Option<u64> {
    let mut chosen = None;
    let task: &ExerciseTask = &marked.solution.task;
    let points = say::exercise_points(marked.points(), marked.report.max_points).text(language);
    let is_full = marked.points() == marked.report.max_points;
    let colour = match is_full {
        true => theme::SUCCESS,
        false => theme::BRIGHT_TEXT,
    };
    let points = RichText::new(points).size(theme::LESSON_END_SIZE);
    ui.label(points.color(colour));
    if marked.hint_cost > 0 {
        let cost = say::exercise_hints_cost(marked.hint_cost).text(language);
        ui.label(RichText::new(cost).color(theme::NOTE_TEXT));
    }
    let note = RichText::new(say::exercise_evidence_note().text(language));
    ui.label(note.color(theme::NOTE_TEXT));
    for (criterion, verdict) in task.criteria.iter().zip(&marked.report.verdicts) {
        let sentence = verdict_sentence(criterion, verdict, language);
        let colour = match verdict.is_met {
            true => theme::SUCCESS,
            false => theme::ERROR_TEXT,
        };
        ui.horizontal_wrapped(|ui| {
            mark::draw(ui, colour, verdict.is_met);
            ui.label(RichText::new(sentence).color(colour));
            let points = say::exercise_points(verdict.points, verdict.max_points).text(language);
            ui.label(RichText::new(points).color(theme::NOTE_TEXT));
            let evidence = describe_evidence(&verdict.evidence, language);
            ui.label(RichText::new(evidence).color(theme::NOTE_TEXT));
            if let Some(tick) = verdict.evidence.tick {
                let show = ui.small_button(say::exercise_show_moment().text(language));
                let hint = say::exercise_show_moment_hint().text(language);
                if show.on_hover_text(hint).clicked() {
                    chosen = Some(tick);
                }
            }
        });
    }
    if let Some(refused) = &marked.report.refused {
        let refused = RichText::new(refused.message().text(language));
        ui.label(refused.color(theme::NOTE_TEXT));
    }
    chosen
}

/// The proposed name of a result: task and learner, without what a file name cannot have.
fn result_name(task: &str, learner: &str) -> String {
    let is_plain = |c: &char| c.is_alphanumeric() || matches!(c, '-' | '_');
    let learner: String = learner
        .chars()
        .map(|c| if c == ' ' { '-' } else { c })
        .filter(is_plain)
        .collect();
    format!("{task}-{learner}.{RESULT_EXTENSION}")
}

/// Seals a result with the key of the data folder and writes it. Returns the message for the
/// learner.
fn write_sealed(
    marked: &MarkedSolution,
    learner: String,
    data: Option<&Path>,
    path: &Path,
) -> Message {
    let write = || {
        let key = match data {
            Some(data) => exercise_key::load_or_make(data)?.0,
            None => exercise_key::make()?,
        };
        let author = ResultAuthor {
            program: env!("CARGO_PKG_VERSION").to_owned(),
            learner,
            hints: marked.hints.clone(),
            exam: None,
        };
        let report = marked.report.clone();
        let bytes = write_result(author, report, &marked.solution.recording, &key)?;
        let not_written = |error| WriteError::new(path, error).message();
        atomic::write(path, &bytes).map_err(not_written)?;
        Ok(say::exercise_saved(path.display()))
    };
    write().unwrap_or_else(|why: Message| why)
}
