//! The exam in the exercise view: its form, the row of the instructor, and the way from one
//! exercise to the next.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

use crossbeam::channel::{Receiver, Sender, unbounded};
use egui::{Context, RichText, TextEdit, Ui};
use gsk_exercise::exam::{Exam, ExamPin};
use gsk_exercise::judge::judge;
use gsk_exercise::task::ExerciseTask;
use gsk_host::files::exams::{self, ExamFolder, UnfinishedExam};
use gsk_host::kernel::{
    Command, Console, ExamTask, ExerciseAction, ExerciseState, HandedInSolution, SeatAction,
};
use gsk_host::network::class::seat_request::SeatRefusal;
use gsk_messages::{Language, Message, say};

use crate::theme;
use crate::widgets::files::run_in_thread;

/// Width of the fields for name and PIN, points.
const FIELD_WIDTH: f32 = 140.0;
/// Time within which a second click confirms the hand-in, s.
const SURE_TIME: f64 = 4.0;

/// The form that the instructor fills in before an exam.
#[derive(Default)]
struct ExamForm {
    learner: String,
    pin: String,
    tasks: BTreeSet<String>,
}

impl ExamForm {
    /// Returns the number of the chosen exercises, their points and their time.
    fn describe_choice(&self, tasks: &[Arc<ExerciseTask>]) -> Message {
        let chosen = tasks.iter().filter(|task| self.tasks.contains(&task.id));
        let (mut count, mut points, mut time_ms) = (0, 0, 0);
        for task in chosen {
            count += 1;
            points += task.max_points();
            time_ms += task.time_limit_ms;
        }
        say::exam_form_sum(count, points, time_ms.div_ceil(60_000))
    }

    /// Returns messages about the fields that must be filled in before the exam can begin.
    fn missing(&self) -> Vec<Message> {
        let fields = [
            (self.learner.trim().is_empty(), say::exam_needs_name()),
            (self.tasks.is_empty(), say::exam_needs_tasks()),
            (!ExamPin::is_valid(&self.pin), say::exam_needs_pin()),
        ];
        let missing = fields.into_iter().filter(|(is_missing, _)| *is_missing);
        missing.map(|(_, message)| message).collect()
    }
}

/// The exam pane of the exercise view.
pub struct ExamPane {
    console: Console,
    data: Option<PathBuf>,
    form: ExamForm,
    /// The exam that has begun; `None` outside exams.
    current: Option<ExamFolder>,
    pin_entry: String,
    message: Option<Message>,
    /// Whether the solution that was handed in is still being sealed.
    is_sealing: bool,
    /// Whether the exam ends with the solution that is being handed in.
    is_ending: bool,
    /// Until when a second click hands in, s of the window's clock.
    sure_until: f64,
    sender: Sender<Result<SealedTask, Message>>,
    receiver: Receiver<Result<SealedTask, Message>>,
}

/// The exam after an exercise, and the sealed result of that exercise.
type SealedTask = (ExamFolder, Vec<u8>);

impl ExamPane {
    pub fn new(console: Console) -> Self {
        let (sender, receiver) = unbounded();
        Self {
            console,
            data: None,
            form: ExamForm::default(),
            current: None,
            pin_entry: String::new(),
            message: None,
            is_sealing: false,
            is_ending: false,
            sure_until: 0.0,
            sender,
            receiver,
        }
    }

    /// Whether an exam has begun and has not ended.
    pub fn is_running(&self) -> bool {
        self.current.as_ref().is_some_and(|it| !it.exam.is_over)
    }

    /// Sets the data folder, and continues the exam in it that has not ended.
    pub fn set_data(
        &mut self,
        data: PathBuf,
        unfinished: UnfinishedExam,
        tasks: &[Arc<ExerciseTask>],
    ) {
        match unfinished {
            Ok(Some(mut folder)) => {
                folder.exam.note.interruptions += 1;
                self.form.learner.clone_from(&folder.exam.learner);
                self.message = Some(say::exam_continued());
                self.save(folder);
                self.begin_current(tasks);
            }
            Ok(None) => {}
            Err(why) => self.message = Some(why),
        }
        self.data = Some(data);
    }

    /// Keeps the state of the exam, in the window and on the disk.
    fn save(&mut self, folder: ExamFolder) {
        if let Err(why) = folder.save() {
            self.message = Some(say::exam_log_failed(why));
        }
        self.current = Some(folder);
    }

    fn send(&self, action: ExerciseAction) {
        self.console.send(Command::Exercise(action));
    }

    /// Begins the current exercise of the exam, or continues it.
    fn begin_current(&mut self, tasks: &[Arc<ExerciseTask>]) {
        let Some(folder) = &self.current else { return };
        let Some(name) = folder.exam.current() else {
            return;
        };
        let Some(task) = tasks.iter().find(|task| task.id == name) else {
            self.message = Some(say::exam_task_missing(name));
            return;
        };
        match folder.read_recording() {
            Ok(recorded) => self.send(ExerciseAction::BeginExam(Box::new(ExamTask {
                task: Arc::clone(task),
                recording_file: folder.recording_path(),
                recorded: recorded.map(Arc::from),
                is_paused: folder.exam.is_paused,
            }))),
            Err(why) => self.message = Some(why),
        }
    }

    /// Seals the result of a solution that was handed in, in a thread.
    pub fn take_solution(&mut self, solution: HandedInSolution, context: &Context) {
        let Some(mut folder) = self.current.clone() else {
            return;
        };
        self.is_sealing = true;
        let is_ending = self.is_ending;
        let to = self.sender.clone();
        run_in_thread(context, &self.console.notice_sender, move || {
            let seal = || {
                let recording = &solution.recording;
                let report = judge(&solution.task, recording).map_err(|error| error.message())?;
                let result = folder.finish_task(report, recording, env!("CARGO_PKG_VERSION"))?;
                if is_ending {
                    folder.exam.is_over = true;
                    folder.save()?;
                }
                Ok((folder, result))
            };
            // The send fails when the window is gone: the next start continues the exam.
            let _ = to.send(seal());
            None
        });
    }

    /// Receives a result that a background thread has sealed.
    pub fn receive(&mut self) {
        let Some(sealed) = self.receiver.try_iter().last() else {
            return;
        };
        self.is_sealing = false;
        match sealed {
            Ok((mut folder, result)) => {
                // Outside a class it goes nowhere.
                self.console.send(Command::Seat(SeatAction::HandIn(result)));
                // The instructor may have paused or ended the exam while the result was sealed.
                if let Some(current) = &self.current
                    && current.path == folder.path
                {
                    folder.exam.note = current.exam.note;
                    folder.exam.is_paused = current.exam.is_paused;
                    folder.exam.is_over |= current.exam.is_over;
                }
                self.message = Some(match folder.exam.is_over {
                    true => say::exam_over(folder.path.display()),
                    false => say::exam_handed_in(),
                });
                self.save(folder);
            }
            Err(why) => self.message = Some(why),
        }
    }

    /// Draws the form of an exam under the list of exercises.
    pub fn show_form(&mut self, ui: &mut Ui, language: Language, tasks: &[Arc<ExerciseTask>]) {
        ui.add_space(8.0);
        let heading = say::exam_heading().text(language);
        egui::CollapsingHeader::new(heading)
            .id_salt("exam")
            .show(ui, |ui| {
                ui.label(say::exam_intro().text(language));
                ui.horizontal_wrapped(|ui| {
                    let name = ui.label(say::exercise_learner().text(language));
                    let field = TextEdit::singleline(&mut self.form.learner);
                    ui.add(field.desired_width(FIELD_WIDTH))
                        .labelled_by(name.id);
                    // Readable: a slip would end in an exam that cannot be paused.
                    show_pin_field(ui, language, &mut self.form.pin, false);
                });
                for task in tasks {
                    let mut is_chosen = self.form.tasks.contains(&task.id);
                    let title = task.title.in_language(language);
                    if ui.checkbox(&mut is_chosen, title).changed() {
                        match is_chosen {
                            true => self.form.tasks.insert(task.id.clone()),
                            false => self.form.tasks.remove(&task.id),
                        };
                    }
                }
                ui.label(self.form.describe_choice(tasks).text(language));
                let missing = self.form.missing();
                let begin = egui::Button::new(say::exam_begin().text(language));
                let begin = ui.add_enabled(missing.is_empty(), begin);
                let hint = say::exam_begin_hint().text(language);
                if begin
                    .on_hover_text(&hint)
                    .on_disabled_hover_text(&hint)
                    .clicked()
                {
                    self.begin(tasks);
                }
                for message in missing {
                    let words = RichText::new(message.text(language));
                    ui.label(words.color(theme::NOTE_TEXT));
                }
            });
        self.show_message(ui, language);
    }

    /// Begins an exam with the values of the form.
    fn begin(&mut self, tasks: &[Arc<ExerciseTask>]) {
        let Some(data) = &self.data else { return };
        let chosen = tasks.iter().filter(|it| self.form.tasks.contains(&it.id));
        let chosen = chosen.map(|task| task.id.clone()).collect();
        let learner = self.form.learner.trim().to_owned();
        let created = exams::store_pin(&self.form.pin)
            .and_then(|pin| ExamFolder::create(data, Exam::new(learner, chosen, pin)));
        self.begin_created(created, tasks);
    }

    /// Begins an exam whose folder was created.
    fn begin_created(&mut self, created: Result<ExamFolder, Message>, tasks: &[Arc<ExerciseTask>]) {
        match created {
            Ok(folder) => {
                self.message = None;
                self.is_ending = false;
                self.form = ExamForm::default();
                self.current = Some(folder);
                self.begin_current(tasks);
            }
            Err(why) => self.message = Some(why),
        }
    }

    /// Begins an exam that the instructor of the class has offered.
    pub fn begin_offered(&mut self, exam: Exam, tasks: &[Arc<ExerciseTask>]) {
        if let Some(data) = &self.data {
            let created = ExamFolder::create(data, exam);
            self.begin_created(created, tasks);
        }
    }

    /// Ends the exam at the request of the class.
    ///
    /// # Errors
    /// No exam is under way, or it has another PIN, which is not noted: the learner has not
    /// entered it.
    pub fn end_from_class(
        &mut self,
        pin: &ExamPin,
        state: Option<&ExerciseState>,
    ) -> Result<(), SeatRefusal> {
        let current = self.current.as_ref().filter(|it| !it.exam.is_over);
        let current = current.ok_or(SeatRefusal::NoExam)?;
        if current.exam.pin != *pin {
            return Err(SeatRefusal::Pin);
        }
        self.end(state.is_some_and(|state| state.is_exam && !state.is_handed_in));
        Ok(())
    }

    /// Draws which exercise it is, and the row of the instructor.
    pub fn show_head(&mut self, ui: &mut Ui, language: Language, state: Option<&ExerciseState>) {
        let Some(folder) = &self.current else { return };
        let exam = &folder.exam;
        let is_paused = exam.is_paused;
        let is_working = state.is_some_and(|state| state.is_exam && !state.is_handed_in);
        // The exercise that is shown: sealed already, or under way.
        let is_sealed = state.is_some_and(|state| state.is_handed_in) && !self.is_sealing;
        let number = exam.done + usize::from(!is_sealed);
        let count = exam.tasks.len();
        let position = say::exam_position(&exam.learner, number.clamp(1, count), count);
        ui.label(RichText::new(position.text(language)).color(theme::LESSON_HINT_TEXT));
        if !self.is_running() {
            return self.show_message(ui, language);
        }
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(say::exam_instructor().text(language)).color(theme::NOTE_TEXT));
            show_pin_field(ui, language, &mut self.pin_entry, true);
            let pause = match is_paused {
                true => say::exam_continue(),
                false => say::exam_pause(),
            };
            if ui.button(pause.text(language)).clicked() && self.is_pin_right() {
                self.pause(!is_paused);
            }
            let end = ui.button(say::exam_end().text(language));
            let hint = say::exam_end_hint().text(language);
            if end.on_hover_text(hint).clicked() && self.is_pin_right() {
                self.end(is_working);
            }
        });
        // Below the row, whose buttons keep their place.
        self.show_message(ui, language);
        if is_paused {
            let words = say::exam_paused().text(language);
            ui.label(RichText::new(words).size(theme::LESSON_END_SIZE).strong());
        }
        ui.separator();
    }

    fn show_message(&self, ui: &mut Ui, language: Language) {
        if let Some(message) = &self.message {
            let words = RichText::new(message.text(language));
            ui.label(words.color(theme::LESSON_HINT_TEXT));
        }
    }

    /// Compares the PIN that was entered; a wrong one is noted.
    fn is_pin_right(&mut self) -> bool {
        let pin = core::mem::take(&mut self.pin_entry);
        let Some(mut folder) = self.current.clone() else {
            return false;
        };
        self.message = None;
        let is_right = folder.exam.accepts(&pin);
        if !is_right {
            self.message = Some(say::exam_wrong_pin());
            self.save(folder);
        }
        is_right
    }

    fn pause(&mut self, is_paused: bool) {
        if let Some(mut folder) = self.current.clone() {
            folder.exam.set_paused(is_paused);
            self.save(folder);
            self.send(ExerciseAction::PauseExam(is_paused));
        }
    }

    /// Ends the exam; an exercise in progress is handed in before.
    fn end(&mut self, is_working: bool) {
        if is_working {
            self.is_ending = true;
            return self.send(ExerciseAction::HandIn);
        }
        if let Some(mut folder) = self.current.clone() {
            folder.exam.is_over = true;
            self.message = Some(say::exam_over(folder.path.display()));
            self.save(folder);
        }
    }

    /// Draws the buttons below the task of the exam.
    pub fn show_buttons(
        &mut self,
        ui: &mut Ui,
        language: Language,
        state: Option<&ExerciseState>,
        tasks: &[Arc<ExerciseTask>],
    ) {
        if self.is_sealing {
            ui.horizontal(|ui| {
                ui.spinner();
                ui.label(say::exercise_marking().text(language));
            });
            return;
        }
        if !self.is_running() {
            if ui.button(say::exam_leave().text(language)).clicked() {
                self.current = None;
                self.message = None;
                self.is_ending = false;
                self.send(ExerciseAction::LeaveExam);
            }
            return;
        }
        match state.filter(|state| state.is_exam && !state.is_handed_in) {
            Some(_) => self.show_hand_in(ui, language),
            None => {
                let next = match state {
                    Some(_) => say::exam_next(),
                    None => say::exam_continue(),
                };
                if ui.button(next.text(language)).clicked() {
                    self.message = None;
                    self.begin_current(tasks);
                }
            }
        }
    }

    /// Draws the button that hands in: with the second click.
    fn show_hand_in(&mut self, ui: &mut Ui, language: Language) {
        let now = ui.input(|input| input.time);
        let is_sure = now < self.sure_until;
        let words = match is_sure {
            true => say::exam_hand_in_sure(),
            false => say::exercise_hand_in(),
        };
        let button = ui.button(words.text(language));
        let hint = say::exercise_hand_in_hint().text(language);
        if button.on_hover_text(hint).clicked() {
            if is_sure {
                self.sure_until = 0.0;
                self.send(ExerciseAction::HandIn);
            } else {
                self.sure_until = now + SURE_TIME;
            }
        }
    }
}

fn show_pin_field(ui: &mut Ui, language: Language, pin: &mut String, is_hidden: bool) {
    let label = ui.label(say::exam_pin().text(language));
    let field = TextEdit::singleline(pin).password(is_hidden).char_limit(12);
    let field = ui.add(field.desired_width(FIELD_WIDTH / 2.0));
    field
        .labelled_by(label.id)
        .on_hover_text(say::exam_pin_hint().text(language));
}

#[cfg(test)]
mod tests {
    use gsk_core::setup::Setup;
    use gsk_exercise::library::built_in_tasks;
    use gsk_host::kernel::Kernel;
    use gsk_panel::emulator::Emulator;
    use gsk_tests::test_folder;

    use super::*;

    #[test]
    fn the_form_names_what_is_missing_and_adds_the_points() {
        let tasks: Vec<_> = built_in_tasks().into_iter().map(Arc::new).collect();
        let mut form = ExamForm::default();
        let all = vec![
            say::exam_needs_name(),
            say::exam_needs_tasks(),
            say::exam_needs_pin(),
        ];
        assert_eq!(form.missing(), all);
        form.learner = "Li".to_owned();
        form.pin = "123".to_owned();
        form.tasks = tasks.iter().take(2).map(|task| task.id.clone()).collect();
        assert_eq!(form.missing(), [say::exam_needs_pin()]);
        form.pin = "1234".to_owned();
        assert_eq!(form.missing(), []);
        let points = tasks[0].max_points() + tasks[1].max_points();
        let minutes = (tasks[0].time_limit_ms + tasks[1].time_limit_ms).div_ceil(60_000);
        assert_eq!(
            form.describe_choice(&tasks),
            say::exam_form_sum(2, points, minutes)
        );
    }

    #[test]
    fn what_the_instructor_does_during_the_sealing_is_kept() {
        let (_kernel, console) = Kernel::new(Emulator::new(Setup::default()));
        let mut pane = ExamPane::new(console);
        let data = test_folder("exam-sealing");
        let pin = ExamPin::new("4711", 1).expect("a PIN");
        let names = vec!["01-reference".to_owned(), "02-jog".to_owned()];
        let exam = Exam::new("Li".to_owned(), names, pin);
        let folder = ExamFolder::create(&data, exam).expect("a folder");
        // The result is sealed from the state before the PIN.
        let mut sealed = folder.clone();
        pane.current = Some(folder);
        pane.is_sealing = true;
        pane.pin_entry = "1111".to_owned();
        assert!(!pane.is_pin_right());
        pane.pin_entry = "4711".to_owned();
        assert!(pane.is_pin_right());
        pane.pause(true);
        sealed.exam.finish_task();
        pane.sender.send(Ok((sealed, Vec::new()))).expect("sent");
        pane.receive();
        let stored = ExamFolder::find_unfinished(&data).expect("readable");
        assert_eq!(stored, pane.current);
        let exam = stored.expect("an exam").exam;
        assert_eq!((exam.done, exam.is_paused), (1, true));
        assert_eq!((exam.note.wrong_pins, exam.note.pauses), (1, 1));
    }
}
