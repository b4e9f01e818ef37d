//! Marks a solution in a thread, shows its report, and saves the sealed result.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crossbeam::channel::{Receiver, Sender, unbounded};
use egui::{Context, RichText, TextEdit, Ui};
use gsk_exercise::judge::{JudgeError, SlicedJudging};
use gsk_exercise::mark_table::{describe_evidence, verdict_sentence};
use gsk_exercise::report::ExerciseReport;
use gsk_exercise::result_file::{RESULT_EXTENSION, ResultAuthor, write_result};
use gsk_exercise::task::ExerciseTask;
use gsk_host::files::{atomic, exercise_key, exercises};
use gsk_host::kernel::{Command, Console, ExerciseAction, HandedInSolution, Notice, SeatAction};
use gsk_host::output::WriteError;
use gsk_host::platform;
use gsk_messages::{Language, Message, say};
use web_time::{Duration, Instant};

use crate::theme;
use crate::widgets::files::{FileChoice, choose_file, run_in_thread};
use crate::widgets::mark;

/// Width of the field for the name of the learner, points.
const NAME_WIDTH: f32 = 180.0;

/// Time of a turn of marking: a page of a browser is drawn after it.
const TURN_TIME: Duration = Duration::from_millis(25);
/// Ticks that are replayed between two readings of the clock.
const TURN_TICKS: u64 = 200;

/// A solution of the learner with its marks.
#[derive(Clone, Debug)]
struct MarkedSolution {
    solution: Arc<HandedInSolution>,
    report: ExerciseReport,
    hints: Vec<u32>,
    /// Points that are deducted for hints.
    hint_cost: u32,
}

impl MarkedSolution {
    fn points(&self) -> u32 {
        self.report.points.saturating_sub(self.hint_cost)
    }
}

/// What the view shows after the learner has handed a solution in.
#[derive(Default)]
enum ReportContent {
    #[default]
    Nothing,
    /// The share of the solution that is replayed, 0 to 1.
    Marking(f32),
    Marked(Box<MarkedSolution>),
    Failed(Message),
}

/// The report about a handed-in solution, as the view shows it.
pub struct SolutionReport {
    console: Console,
    learner: String,
    data: Option<PathBuf>,
    content: ReportContent,
    sender: Sender<MarkingStep>,
    receiver: Receiver<MarkingStep>,
    /// Channel for the names of exercises whose reference solution was saved.
    referenced: (Sender<String>, Receiver<String>),
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
            referenced: unbounded(),
        }
    }

    /// The data folder; `None` before it is set.
    pub fn data(&self) -> Option<&Path> {
        self.data.as_deref()
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

    /// Removes the report from the view.
    pub fn clear(&mut self) {
        self.content = ReportContent::Nothing;
    }

    /// Marks a solution in a task beside the window. `hints`: numbers of the hints that the
    /// learner has read.
    pub fn mark(&mut self, solution: HandedInSolution, hints: Vec<u32>, context: &Context) {
        self.content = ReportContent::Marking(0.0);
        let to = self.sender.clone();
        let mut marking = Some(MarkingTask::Begins(solution, hints));
        let context = context.clone();
        let started = platform::start_task("marking", move || {
            let (step, rest) = marking.take().map_or((None, None), MarkingTask::take_turn);
            marking = rest;
            // The send fails when the window is gone. No window needs the marks then.
            let is_shown = step.is_some_and(|step| to.send(step).is_ok());
            context.request_repaint();
            is_shown && marking.is_some()
        });
        if let Err(error) = started {
            self.content = ReportContent::Failed(say::as_written(error));
        }
    }

    /// Takes marks that have arrived; returns the report and the points.
    pub fn receive(&mut self) -> Option<(ExerciseReport, u32)> {
        match self.receiver.try_iter().last()? {
            MarkingStep::Replayed(share) => {
                // Another attempt may have begun meanwhile.
                if let ReportContent::Marking(shown) = &mut self.content {
                    *shown = share;
                }
                None
            }
            MarkingStep::Done(Ok(marked)) => {
                let points = (marked.report.clone(), marked.points());
                self.content = ReportContent::Marked(Box::new(marked));
                Some(points)
            }
            MarkingStep::Done(Err(why)) => {
                self.content = ReportContent::Failed(why);
                None
            }
        }
    }

    /// Draws the report; returns whether a moment of the solution was chosen, which is then shown.
    /// `lacks_reference`: the exercise is that of a teacher and has no reference solution yet.
    pub fn show(&mut self, ui: &mut Ui, language: Language, lacks_reference: bool) -> bool {
        let mut chosen = None;
        match &self.content {
            ReportContent::Nothing => {}
            ReportContent::Marking(share) => {
                ui.label(say::exercise_marking().text(language));
                ui.add(egui::ProgressBar::new(*share).show_percentage());
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
                if lacks_reference && show_save_reference(ui, language, marked) {
                    self.save_reference(marked, ui.ctx());
                }
            }
        }
        if let Some(elapsed_ms) = chosen {
            let action = ExerciseAction::ShowMoment(elapsed_ms);
            self.console.send(Command::Exercise(action));
        }
        chosen.is_some()
    }

    /// Saves the recording as the reference solution of its exercise, in a thread.
    fn save_reference(&self, marked: &MarkedSolution, context: &Context) {
        let Some(data) = self.data.clone() else {
            return;
        };
        let (solution, to) = (Arc::clone(&marked.solution), self.referenced.0.clone());
        run_in_thread(context, &self.console.notice_sender, move || {
            let id = &solution.task.id;
            match exercises::save_reference(&data, id, &solution.recording) {
                Ok(message) => {
                    // The send fails when the window is gone: the file is written.
                    let _ = to.send(id.clone());
                    Some(message)
                }
                Err(why) => Some(why),
            }
        });
    }

    /// The exercise whose reference solution was saved since the last call; `None` without one.
    pub fn take_referenced(&self) -> Option<String> {
        self.referenced.1.try_iter().last()
    }

    /// Seals the result and hands it in to the class.
    pub fn hand_in_to_class(&self) {
        let ReportContent::Marked(marked) = &self.content else {
            return;
        };
        let learner = self.learner.trim().to_owned();
        match seal(marked, learner, self.data.as_deref()) {
            Ok(result) => {
                let action = SeatAction::HandIn(result);
                self.console.send(Command::Seat(action));
            }
            Err(why) => {
                // A window that is gone needs no message.
                let _ = self.console.notice_sender.try_send(Notice::Message(why));
            }
        }
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

/// Seals a result with the key of the data folder.
fn seal(marked: &MarkedSolution, learner: String, data: Option<&Path>) -> Result<Vec<u8>, Message> {
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
    write_result(author, report, &marked.solution.recording, &key)
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

/// Draws the button that saves the reference solution; returns whether it was clicked.
fn show_save_reference(ui: &mut Ui, language: Language, marked: &MarkedSolution) -> bool {
    let is_full = marked.report.points == marked.report.max_points;
    let save = egui::Button::new(say::exercise_reference_save().text(language));
    let hint = say::exercise_reference_hint().text(language);
    let save = ui.add_enabled(is_full, save);
    save.on_hover_text(&hint)
        .on_disabled_hover_text(&hint)
        .clicked()
}

/// The progress of marking a solution.
enum MarkingStep {
    /// This share of the recording has been replayed, 0 to 1.
    Replayed(f32),
    /// Marking has ended: with the marks, or with the reason why marking is not possible.
    Done(Result<MarkedSolution, Message>),
}

/// A solution that is being marked in turns: a page of a browser is drawn between two of them.
enum MarkingTask {
    Begins(HandedInSolution, Vec<u32>),
    Replays(HandedInSolution, Vec<u32>, Box<SlicedJudging>),
}

impl MarkingTask {
    /// Takes one turn and returns the rest of the task; `None` after its last turn.
    fn take_turn(self) -> (Option<MarkingStep>, Option<Self>) {
        let failed = |error: JudgeError| (Some(MarkingStep::Done(Err(error.message()))), None);
        match self {
            Self::Begins(solution, hints) => {
                match SlicedJudging::new(&solution.task, &solution.recording) {
                    Ok(judging) => {
                        let rest = Self::Replays(solution, hints, Box::new(judging));
                        (Some(MarkingStep::Replayed(0.0)), Some(rest))
                    }
                    Err(error) => failed(error),
                }
            }
            Self::Replays(solution, hints, mut judging) => {
                let until = Instant::now() + TURN_TIME;
                let mut has_ended = false;
                while !has_ended && Instant::now() < until {
                    has_ended = judging.advance(TURN_TICKS);
                }
                if !has_ended {
                    let step = MarkingStep::Replayed(judging.progress());
                    return (Some(step), Some(Self::Replays(solution, hints, judging)));
                }
                match judging.finish() {
                    Ok(report) => {
                        let marked = give_marks(solution, report, hints);
                        (Some(MarkingStep::Done(marked)), None)
                    }
                    Err(error) => failed(error),
                }
            }
        }
    }
}

fn give_marks(
    solution: HandedInSolution,
    report: ExerciseReport,
    hints: Vec<u32>,
) -> Result<MarkedSolution, Message> {
    let hint_cost = solution.task.hint_cost(&hints)?;
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

/// Returns the proposed file name of a result: task and learner, without characters that a file
/// name cannot contain.
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
        let bytes = seal(marked, learner, data)?;
        let not_written = |error| WriteError::new(path, error).message();
        atomic::write(path, &bytes).map_err(not_written)?;
        Ok(say::exercise_saved(path.display()))
    };
    write().unwrap_or_else(|why: Message| why)
}
