//! Exercises in the lesson view: their list, the task that is being solved, and its report.

mod course_pane;
mod exam_pane;
mod offer;
mod part_exercise;
mod solution_report;
mod task_drawing;

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

use course_pane::CoursePane;
use egui::{Context, RichText, Ui};
use exam_pane::ExamPane;
use gsk_exercise::course::Course;
use gsk_exercise::criterion::ExerciseCriterion;
use gsk_exercise::exam::{Exam, ExamPin};
use gsk_exercise::part_size::{MeasuredSize, measure_sizes};
use gsk_exercise::task::ExerciseTask;
use gsk_host::files::exams::UnfinishedExam;
use gsk_host::files::exercises::{self, AvailableExercises};
use gsk_host::kernel::part::PartView;
use gsk_host::kernel::{
    Command, Console, ExerciseAction, ExerciseState, HandedInSolution, LessonAction, PanelSnapshot,
    SeatAction,
};
use gsk_host::network::class::seat_request::SeatRefusal;
use gsk_host::platform::{self, CoursePage};
use gsk_messages::{Language, Message, say};
use gsk_workpiece::measure::Feature;
use gsk_workpiece::region::Region;
use part_exercise::PartExercisePane;
use solution_report::SolutionReport;
use task_drawing::DrawingPane;

use crate::theme;
use crate::widgets::card::{self, Card, CardPicture};
use crate::widgets::icons::Icon;
use crate::widgets::mark;

/// The pane of the lesson view that lists and runs exercises.
pub struct ExercisePane {
    console: Console,
    tasks: Vec<Arc<ExerciseTask>>,
    /// Errors in the exercise files of a teacher.
    load_errors: Vec<Message>,
    state: Option<ExerciseState>,
    /// The exercise that was chosen and whose time does not run yet.
    offered: Option<Arc<ExerciseTask>>,
    /// The section that was measured last, and the sizes on it.
    measured: Option<(Arc<Region>, Vec<MeasuredSize>)>,
    drawing: DrawingPane,
    /// Numbers of the hints that the learner has read, from 1.
    read_hints: BTreeSet<u32>,
    report: SolutionReport,
    exam: ExamPane,
    /// The form for a new exercise from the part in the lathe.
    part_exercise: PartExercisePane,
    /// Names of the exercises of a teacher without a reference solution.
    without_reference: BTreeSet<String>,
    /// The course of a learning platform; `None` outside platforms.
    course: Option<CoursePane>,
    /// Whether the time line is to open for a moment of the solution, or to close again.
    wants_timeline: Option<bool>,
    /// Whether the time line was opened for a moment of the solution.
    has_opened_timeline: bool,
    /// The learner's best points by the name of the exercise.
    best: BTreeMap<String, u32>,
    /// Sum of the best points as the class knows it; `None` outside a class.
    class_points: Option<u32>,
}

impl ExercisePane {
    /// Creates the pane without exercises. `best`: the learner's best points, by the name of the
    /// exercise.
    pub fn new(console: Console, best: BTreeMap<String, u32>, learner: String) -> Self {
        Self {
            report: SolutionReport::new(console.clone(), learner),
            exam: ExamPane::new(console.clone()),
            part_exercise: PartExercisePane::new(console.clone()),
            without_reference: BTreeSet::new(),
            course: None,
            console,
            tasks: Vec::new(),
            load_errors: Vec::new(),
            state: None,
            offered: None,
            measured: None,
            drawing: DrawingPane::default(),
            read_hints: BTreeSet::new(),
            wants_timeline: None,
            has_opened_timeline: false,
            best,
            class_points: None,
        }
    }

    /// Replaces the listed exercises. Results are stored in the data folder `data`.
    /// `unfinished`: the exam in that folder that has not ended.
    pub fn set_exercises(
        &mut self,
        found: AvailableExercises,
        data: PathBuf,
        unfinished: UnfinishedExam,
    ) {
        self.list_exercises(found);
        self.report.set_data(data.clone());
        self.part_exercise.set_data(data.clone());
        self.exam.set_data(data, unfinished, &self.tasks);
    }

    fn list_exercises(&mut self, found: AvailableExercises) {
        self.tasks = found.tasks.into_iter().map(Arc::new).collect();
        self.load_errors = found.errors;
        self.without_reference = found.without_reference;
    }

    /// Sets the surface of the part that is clicked with the caliper.
    pub const fn set_picked_feature(&mut self, picked: Option<Feature>) {
        self.part_exercise.set_picked(picked);
    }

    /// Lists only the exercises of a course. Results are sealed with a key in the data folder
    /// `data`.
    pub fn set_course(&mut self, page: &CoursePage, data: PathBuf) {
        self.report.set_data(data);
        match Course::from_json(&page.file) {
            Ok(course) => {
                let pane = CoursePane::new(&course, &page.suspended);
                let best = course.tasks.iter().filter_map(|task| {
                    let best = pane.best(&task.id)?;
                    Some((task.id.clone(), best))
                });
                self.best = best.collect();
                self.tasks = course.tasks.into_iter().map(Arc::new).collect();
                self.report.set_learner(&page.learner);
                self.course = Some(pane);
            }
            Err(why) => self.load_errors = vec![why],
        }
    }

    /// Whether the listed exercises are those of a course.
    pub const fn is_course(&self) -> bool {
        self.course.is_some()
    }

    /// The learner's best points by the name of the exercise.
    pub const fn best(&self) -> &BTreeMap<String, u32> {
        &self.best
    }

    /// Returns the name of the learner.
    pub fn learner(&self) -> &str {
        self.report.learner()
    }

    /// Sets the name of the learner.
    pub fn set_learner(&mut self, name: &str) {
        self.report.set_learner(name);
    }

    /// Whether the time line is to open (true) or to close again, since the last call.
    pub const fn take_timeline_request(&mut self) -> Option<bool> {
        self.wants_timeline.take()
    }

    /// Whether an exercise is offered, or an exercise or an exam is in progress.
    pub fn is_open(&self) -> bool {
        self.state.is_some() || self.offered.is_some() || self.is_in_exam()
    }

    /// Whether an exam has begun and is not over: the window gives no help.
    pub fn is_in_exam(&self) -> bool {
        self.exam.is_running()
    }

    /// Takes the state of the current exercise from a snapshot. Returns whether an exercise has
    /// begun with it.
    pub fn take_snapshot(&mut self, snapshot: &PanelSnapshot) -> bool {
        let is_begin = match (&self.state, &snapshot.exercise) {
            (Some(before), Some(now)) => before.begun_at != now.begun_at || before.id != now.id,
            (None, Some(_)) => true,
            (_, None) => false,
        };
        if is_begin {
            self.offered = None;
            self.measured = None;
            self.read_hints.clear();
            self.report.clear();
        }
        let has_left = self.state.is_some() && snapshot.exercise.is_none();
        if (has_left || is_begin) && core::mem::take(&mut self.has_opened_timeline) {
            self.wants_timeline = Some(false);
        }
        self.state.clone_from(&snapshot.exercise);
        self.report_points(snapshot.asks_help.is_some());
        is_begin
    }

    /// Reports the sum of the best points to the class when it has changed.
    fn report_points(&mut self, is_in_class: bool) {
        let points = is_in_class.then(|| self.best.values().sum());
        if let Some(points) = points.filter(|points| self.class_points != Some(*points)) {
            self.console.send(Command::Seat(SeatAction::Points(points)));
        }
        self.class_points = points;
    }

    /// The exercise with this name; `None` if the seat does not have it.
    pub fn task(&self, id: &str) -> Option<Arc<ExerciseTask>> {
        self.tasks.iter().find(|task| task.id == id).cloned()
    }

    /// Begins an exercise that the instructor of the class has offered.
    pub fn begin_offered(&mut self, task: Arc<ExerciseTask>) {
        if !self.tasks.iter().any(|known| known.hash == task.hash) {
            self.tasks.retain(|known| known.id != task.id);
            self.tasks.push(Arc::clone(&task));
        }
        self.begin(task);
    }

    /// Stores an exercise that the instructor of the class has sent; `text` is its file. Returns a
    /// message about it; `None` where nothing can be stored.
    pub fn keep_offered(&self, task: &ExerciseTask, text: &str) -> Option<Message> {
        if !platform::has_folders() {
            return None;
        }
        let data = self.report.data()?;
        let kept = exercises::keep_sent(data, &task.id, text, task.drawing.as_deref());
        Some(match kept {
            Ok(folder) => say::class_task_kept(folder.display()),
            Err(reason) => say::class_task_not_kept(reason),
        })
    }

    /// Begins an exam that the instructor of the class has offered.
    pub fn begin_offered_exam(&mut self, exam: Exam) {
        self.exam.begin_offered(exam, &self.tasks);
    }

    /// Ends the exam at the request of the class.
    ///
    /// # Errors
    /// No exam is under way, or it has another PIN.
    pub fn end_exam_from_class(&mut self, pin: &ExamPin) -> Result<(), SeatRefusal> {
        self.exam.end_from_class(pin, self.state.as_ref())
    }

    /// Marks a solution in a thread.
    pub fn take_solution(&mut self, solution: HandedInSolution, context: &Context) {
        if self.state.as_ref().is_some_and(|state| state.is_exam) {
            return self.exam.take_solution(solution, context);
        }
        let hints = self.read_hints.iter().copied().collect();
        self.report.mark(solution, hints, context);
    }

    /// Receives the marks that background threads have computed.
    pub fn receive_marks(&mut self) {
        self.exam.receive();
        if let Some(found) = self.part_exercise.receive() {
            self.list_exercises(found);
        }
        if let Some(id) = self.report.take_referenced() {
            self.without_reference.remove(&id);
        }
        if let Some((report, points)) = self.report.receive() {
            if let Some(course) = &mut self.course {
                course.record(&report, points);
            }
            if self.class_points.is_some() {
                self.report.hand_in_to_class();
            }
            let best = self.best.entry(report.task).or_default();
            *best = points.max(*best);
        }
    }

    fn current_task(&self) -> Option<Arc<ExerciseTask>> {
        let id = &self.state.as_ref()?.id;
        self.tasks.iter().find(|task| task.id == *id).cloned()
    }

    /// Draws the cards of the exercises.
    pub fn show_list(&mut self, ui: &mut Ui, language: Language, part: Option<&Arc<PartView>>) {
        ui.add_space(8.0);
        let best = |task: &ExerciseTask| self.best.get(&task.id).copied();
        let is_solved = |task: &ExerciseTask| best(task) == Some(task.max_points());
        if let Some(course) = &self.course {
            course.show_head(ui, language);
        } else {
            let heading = say::exercise_heading().text(language);
            card::show_heading(ui, Icon::MEASURE, &heading);
            ui.label(say::exercise_intro().text(language));
            let solved = self.tasks.iter().filter(|task| is_solved(task)).count();
            let words = say::exercise_progress(solved, self.tasks.len()).text(language);
            card::show_progress(ui, solved, self.tasks.len(), &words);
        }
        let cards: Vec<Card> = self
            .tasks
            .iter()
            .map(|task| Card {
                picture: CardPicture::Icon(task_icon(task)),
                title: task.title.in_language(language).into_owned(),
                detail: describe_length(task, best(task)).text(language),
                is_marked: is_solved(task),
            })
            .collect();
        let mut chosen = None;
        for (task, card) in self.tasks.iter().zip(card::show_cards(ui, &cards)) {
            if card
                .on_hover_text(self.describe_card(task, language))
                .clicked()
            {
                chosen = Some(Arc::clone(task));
            }
        }
        if let Some(task) = chosen {
            self.offer(task);
        }
        if platform::has_folders() && self.course.is_none() {
            self.exam.show_form(ui, language, &self.tasks);
            self.part_exercise.show(ui, language, part);
        }
        for error in &self.load_errors {
            ui.add_space(4.0);
            ui.label(RichText::new(error.text(language)).color(theme::ERROR_TEXT));
        }
    }

    /// Begins an exercise, unless all its attempts in a course are used.
    fn begin(&mut self, task: Arc<ExerciseTask>) {
        let is_permitted = self.course.as_mut().is_none_or(|it| it.permits(&task));
        if is_permitted {
            self.send(ExerciseAction::Begin(task));
        }
    }

    /// Returns the tip of a card: the task and, in a course, how often it may be handed in.
    fn describe_card(&self, task: &ExerciseTask, language: Language) -> String {
        let about = task.text.in_language(language);
        match &self.course {
            Some(course) => format!("{about}\n{}", course.describe_attempts(&task.id, language)),
            None => about.into_owned(),
        }
    }

    fn send(&self, action: ExerciseAction) {
        self.console.send(Command::Exercise(action));
    }

    /// Draws the current task with its criteria, or its report.
    pub fn show_task(&mut self, ui: &mut Ui, language: Language, part: Option<&Arc<PartView>>) {
        if let Some(task) = self.offered_now() {
            return self.show_offer(ui, language, &task);
        }
        let is_exam = self.is_exam_shown();
        if is_exam {
            self.exam.show_head(ui, language, self.state.as_ref());
        }
        let (Some(task), Some(state)) = (self.current_task(), self.state.clone()) else {
            return;
        };
        if !is_exam {
            let practice = RichText::new(say::lesson_practice().text(language));
            ui.label(practice.color(theme::LESSON_HINT_TEXT))
                .on_hover_text(say::lesson_practice_hint().text(language));
        }
        show_text(ui, language, &task);
        if state.is_handed_in && is_exam {
            return;
        }
        if state.is_handed_in {
            if let Some(course) = &self.course {
                course.show_message(ui, language);
            }
            let lacks_reference = self.without_reference.contains(&task.id);
            if self.report.show(ui, language, lacks_reference) {
                self.wants_timeline = Some(true);
                self.has_opened_timeline = true;
            }
            return;
        }
        let words = say::exercise_time_left(state.remaining_text()).text(language);
        ui.label(RichText::new(words).color(theme::LESSON_STEP))
            .on_hover_text(say::exercise_time_left_hint().text(language));
        ui.add_space(6.0);
        // In an exam the learner measures the part himself.
        let sizes = match is_exam {
            true => Vec::new(),
            false => self.measure(&task, part),
        };
        self.drawing.show(ui, language, &task, &sizes);
        ui.strong(say::exercise_demands().text(language));
        for (index, criterion) in task.criteria.iter().enumerate() {
            let size = sizes.iter().find(|size| size.criterion == index);
            show_demand(ui, language, criterion, size);
        }
        for (number, hint) in (1..).zip(&task.hints) {
            if self.read_hints.contains(&number) {
                let words = say::lesson_hint_is(hint.text.in_language(language)).text(language);
                let words = RichText::new(words).size(theme::READING_SIZE);
                ui.add_space(6.0);
                ui.label(words.color(theme::LESSON_HINT_TEXT));
            }
        }
    }

    /// Whether the view shows an exam, including its end.
    fn is_exam_shown(&self) -> bool {
        self.is_in_exam() || self.state.as_ref().is_some_and(|state| state.is_exam)
    }

    /// Measures the dimensions of the task on the part, if the part has changed.
    fn measure(&mut self, task: &ExerciseTask, part: Option<&Arc<PartView>>) -> Vec<MeasuredSize> {
        let Some(section) = part.map(|part| &part.section) else {
            return Vec::new();
        };
        let is_known = |known: &Arc<Region>| Arc::ptr_eq(known, section);
        match &self.measured {
            Some((known, sizes)) if is_known(known) => sizes.clone(),
            _ => {
                let sizes = measure_sizes(task, section);
                self.measured = Some((Arc::clone(section), sizes.clone()));
                sizes
            }
        }
    }

    /// Draws the buttons below the task of an exercise. Returns whether the learner asks for the
    /// fault bench, where the faults of his task are repaired.
    pub fn show_buttons(&mut self, ui: &mut Ui, language: Language) -> bool {
        if let Some(task) = self.offered_now() {
            self.show_offer_buttons(ui, language, task);
            return false;
        }
        if self.is_exam_shown() {
            let state = self.state.as_ref();
            self.exam.show_buttons(ui, language, state, &self.tasks);
            return false;
        }
        let (Some(task), Some(state)) = (self.current_task(), self.state.clone()) else {
            return false;
        };
        let mut wants_bench = false;
        ui.horizontal_wrapped(|ui| {
            let hand_in = egui::Button::new(say::exercise_hand_in().text(language));
            let hand_in = ui.add_enabled(!state.is_handed_in, hand_in);
            let hint = say::exercise_hand_in_hint().text(language);
            if hand_in.on_hover_text(hint).clicked() {
                self.send(ExerciseAction::HandIn);
            }
            if !state.is_handed_in && !task.faults.is_empty() {
                let bench = ui.button(say::window_view_bench().text(language));
                let hint = say::bench_repair_hint().text(language);
                wants_bench = bench.on_hover_text(hint).clicked();
            }
            let mut unread = (1..).zip(&task.hints);
            let unread = unread.find(|(number, _)| !self.read_hints.contains(number));
            if let Some((number, hint)) = unread.filter(|_| !state.is_handed_in) {
                let words = say::exercise_hint_for(hint.cost).text(language);
                if ui.button(words).clicked() {
                    self.read_hints.insert(number);
                }
            }
            let again = ui.button(say::lesson_again().text(language));
            let hint = say::exercise_again_hint().text(language);
            if again.on_hover_text(hint).clicked() {
                self.begin(task);
            }
            let leave = ui.button(say::exercise_leave().text(language));
            let hint = say::exercise_leave_hint().text(language);
            if leave.on_hover_text(hint).clicked() {
                self.console.send(Command::Lesson(LessonAction::Leave));
            }
        });
        wants_bench
    }
}

/// Draws the title and the text of a task.
fn show_text(ui: &mut Ui, language: Language, task: &ExerciseTask) {
    ui.heading(task.title.in_language(language));
    let text = RichText::new(task.text.in_language(language));
    ui.label(text.size(theme::READING_SIZE).color(theme::BRIGHT_TEXT));
    ui.add_space(6.0);
}

/// Draws a criterion: its text, its points and, for a dimension, its size on the part.
fn show_demand(
    ui: &mut Ui,
    language: Language,
    criterion: &ExerciseCriterion,
    size: Option<&MeasuredSize>,
) {
    let is_met = size.is_some_and(MeasuredSize::is_met);
    let colour = match is_met {
        true => theme::SUCCESS,
        false => theme::TEXT,
    };
    ui.horizontal_wrapped(|ui| {
        mark::draw(
            ui,
            if is_met {
                theme::SUCCESS
            } else {
                theme::LESSON_OPEN
            },
            is_met,
        );
        ui.label(RichText::new(criterion.yes.in_language(language)).color(colour));
        let points = say::exercise_worth(criterion.points).text(language);
        ui.label(RichText::new(points).color(theme::NOTE_TEXT));
        if let Some(size) = size {
            let (least, most) = (size.size.min, size.size.max);
            let words = match size.measured {
                Some(measured) => say::exercise_size_now(least, most, measured),
                None => say::exercise_size_missing(least, most),
            };
            ui.label(RichText::new(words.text(language)).color(colour));
        }
    });
}

/// Returns the icon on an exercise's card.
fn task_icon(task: &ExerciseTask) -> Icon {
    match (task.faults.is_empty(), task.cuts_part()) {
        (false, _) => Icon::WARNING,
        (true, true) => Icon::STOCK,
        (true, false) => Icon::KEYBOARD,
    }
}

fn describe_length(task: &ExerciseTask, best: Option<u32>) -> Message {
    let minutes = task.time_limit_ms.div_ceil(60_000);
    match best {
        Some(best) => say::exercise_best(best, task.max_points()),
        None => say::exercise_card(task.max_points(), minutes),
    }
}
