//! Lessons in the window: starts them from the list, does their steps by hand, leaves them.

use std::path::Path;
use std::sync::Arc;

use gsk_exercise::course::{CourseFile, CourseTaskFile};
use gsk_exercise::exam::{Exam, ExamPin};
use gsk_exercise::library::EXERCISES;
use gsk_host::files::exams::ExamFolder;
use gsk_host::files::exercises;
use gsk_host::kernel::{Command, LessonAction};
use gsk_host::platform::CoursePage;
use gsk_window::layout::{Layouts, WindowLayout};
use gsk_window::view::ViewId;

use crate::common::WindowBench;
use crate::common::mouse_operator::MouseOperator;
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT as _, Queryable};
use gsk_core::setup::Setup;
use gsk_lesson::{LESSONS, Lesson};
use gsk_panel::keys::Key;
use gsk_panel::script::ScriptAction;

/// Clicks a widget outside of the panel.
fn click(bench: &mut WindowBench, label: &str) {
    bench.harness.get_by_label(label).click();
    bench.run(50);
    bench.run(50);
}

fn new_bench() -> WindowBench {
    bench_with(Setup::default())
}

fn bench_with(setup: Setup) -> WindowBench {
    let layouts = Layouts::with_layout(WindowLayout::Panel);
    WindowBench::with_layouts(setup, layouts, egui::vec2(1600.0, 900.0))
}

fn current_step(bench: &WindowBench) -> Option<usize> {
    bench
        .kernel
        .snapshot()
        .lesson
        .map(|lesson| lesson.view.step)
}

#[test]
fn leaving_a_lesson_restores_the_learners_machine() {
    let mut setup = Setup::default();
    let stored = setup.memory.programs.store("O0001;\nG00 X50;\nM30;\n");
    assert_eq!(stored, Ok(1));
    let mut bench = bench_with(setup);
    bench.click("Edit mode");
    let learners_machine = bench.kernel.emulator().clone();
    click(&mut bench, "Lessons");
    click(&mut bench, "MDI");
    assert_eq!(current_step(&bench), Some(0));
    assert!(
        bench.harness.query_all_by_label("Practice machine").count() >= 2,
        "it is said"
    );
    bench.click("MDI mode");
    bench.run(300);
    assert_eq!(current_step(&bench), Some(1));
    let programs = bench.kernel.emulator().cnc().programs();
    assert_eq!(programs.count(), 0, "no program of his is in it");
    click(&mut bench, "Leave");
    assert_eq!(current_step(&bench), None);
    // The learner's machine has not run meanwhile. Only the ticks after the lesson count.
    let mut expected = learners_machine;
    let passed = bench.kernel.emulator().ticks() - expected.ticks();
    assert!(passed < 400, "{passed} ticks");
    expected.run(passed);
    assert!(*bench.kernel.emulator() == expected);
}

#[test]
fn a_lesson_cannot_start_while_a_program_runs() {
    let mut bench = new_bench();
    bench.open("01-stepped-shaft.CNC");
    bench.click("Automatic mode");
    bench.click("Cycle start");
    click(&mut bench, "Lessons");
    click(&mut bench, "MDI");
    assert_eq!(current_step(&bench), None);
    let message = bench
        .harness
        .query_by_label_contains("A lesson cannot begin");
    assert!(message.is_some());
}

#[test]
fn a_lesson_demonstrates_goes_back_restarts_and_yields_to_keys() {
    let mut bench = new_bench();
    click(&mut bench, "Lessons");
    click(&mut bench, "Power-on and machine zero");
    bench.run(1000);
    assert_eq!(current_step(&bench), Some(0));
    click(&mut bench, "Show me");
    assert!(
        bench
            .kernel
            .snapshot()
            .lesson
            .is_some_and(|it| it.view.showing)
    );
    bench.run(3000);
    assert_eq!(
        current_step(&bench),
        Some(1),
        "the emergency stop is turned free"
    );
    click(&mut bench, "Show me");
    bench.console.send(Command::Tap(Key::Program));
    bench.run(50);
    assert!(
        bench
            .kernel
            .snapshot()
            .lesson
            .is_some_and(|it| !it.view.showing)
    );
    // The first demonstrated key opened the position page: this completes the next step, too.
    assert_eq!(current_step(&bench), Some(2));
    for before in [1, 0] {
        click(&mut bench, "Back");
        assert_eq!(current_step(&bench), Some(before));
    }
    assert!(
        bench
            .kernel
            .snapshot()
            .pressed
            .contains(&Key::EmergencyStop)
    );
    click(&mut bench, "Hint");
    assert!(
        bench
            .harness
            .query_by_label_contains("Hint: It is the large red")
            .is_some()
    );
    click(&mut bench, "Begin again");
    assert_eq!(current_step(&bench), Some(0));
}

/// Does the lessons with the mouse on the panel. Lessons that a click cannot do (a key
/// held for seconds) are tested in the runner.
#[test]
fn lessons_can_be_done_with_the_mouse() {
    let (mut done, mut skipped) = (Vec::new(), Vec::new());
    for (name, text) in &LESSONS {
        let lesson = Lesson::read(name, text).expect("a lesson");
        // The operator of the test knows the panel of the GSK980TD.
        if !lesson.start.model().is_main() {
            continue;
        }
        let lines = lesson.steps.iter().flat_map(|step| &step.solution.lines);
        let actions: Vec<&ScriptAction> = lines.map(|line| &line.action).collect();
        let can_click = |action: &&&ScriptAction| {
            let action: &ScriptAction = action;
            !matches!(
                action,
                ScriptAction::Hold(..)
                    | ScriptAction::Down(_)
                    | ScriptAction::Press(Key::ToolChange)
            ) && !matches!(action, ScriptAction::WaitFor(condition, ..)
                if !matches!(condition, gsk_panel::emulator::WaitCondition::Stopped))
        };
        if actions.iter().filter(can_click).count() < actions.len() {
            skipped.push(*name);
            continue;
        }
        let mut bench = new_bench();
        click(&mut bench, "Lessons");
        click(&mut bench, &lesson.title.en);
        let mut hand = MouseOperator::on_bench(bench);
        for line in lesson.steps.iter().flat_map(|step| &step.solution.lines) {
            hand.run_script(&line.text);
        }
        hand.bench.run(3000);
        let reached_step = current_step(&hand.bench);
        assert_eq!(
            reached_step,
            Some(lesson.steps.len()),
            "{name}\n{}",
            hand.bench.lcd()
        );
        let settings = hand.bench.harness.state().settings();
        assert!(
            settings.lessons.contains(&lesson.name),
            "{name} is remembered"
        );
        // The end repeats nothing of the beginning.
        let about = hand.bench.harness.query_by_label(&lesson.about.en);
        assert!(about.is_none(), "{name}");
        done.push(*name);
    }
    assert!(done.len() >= 6, "{done:?} were done, not {skipped:?}");
}

#[test]
fn the_example_of_the_documents_is_a_lesson() {
    for document in ["lessons.md", "lessons.zh-CN.md"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../docs")
            .join(document);
        let text = std::fs::read_to_string(path).expect(document);
        let example = text
            .split("```ron\n")
            .nth(1)
            .and_then(|rest| rest.split("```").next());
        let lesson = Lesson::read("example.ron", example.expect("an example"));
        let lesson = Arc::new(lesson.unwrap_or_else(|error| panic!("{error}")));
        let outcomes = gsk_lesson::solution_player::play_lesson(&lesson).expect("played");
        assert!(
            matches!(
                outcomes[..],
                [gsk_lesson::solution_player::StepResult::Done(_)]
            ),
            "{outcomes:?}"
        );
    }
}

#[test]
fn help_demonstrates_on_a_practice_machine_and_restores_the_learners() {
    let mut bench = new_bench();
    bench.click("Edit mode");
    let learners_machine = bench.kernel.emulator().clone();
    let key = bench.harness.get_by_label("Offset pages").rect().center();
    bench.harness.hover_at(key);
    bench.run(10);
    bench.harness.key_press(egui::Key::F1);
    bench.run(10);
    click(
        &mut bench,
        "Show me: The pages of offsets and macro variables",
    );
    let name = bench.kernel.snapshot().lesson.map(|lesson| lesson.name);
    assert_eq!(name.as_deref(), Some("shown/page-offset"));
    let done = (0..300).any(|_| {
        bench.run(100);
        bench
            .harness
            .query_by_label("End of the demonstration.")
            .is_some()
    });
    assert!(done, "{}", bench.lcd());
    bench.assert_lcd_contains("宏变量");
    click(&mut bench, "Back to my machine");
    assert_eq!(current_step(&bench), None);
    let mut expected = learners_machine;
    let passed = bench.kernel.emulator().ticks() - expected.ticks();
    expected.run(passed);
    assert!(*bench.kernel.emulator() == expected);
}

#[test]
fn a_demonstration_does_not_replace_a_lesson() {
    let mut bench = new_bench();
    click(&mut bench, "Lessons");
    click(&mut bench, "MDI");
    let demonstration = gsk_lesson::find_demonstration("shown/offset").expect("it is there");
    let order = LessonAction::Demonstrate(Arc::clone(&demonstration.lesson));
    bench.console.send(Command::Lesson(order));
    bench.run(50);
    let name = bench.kernel.snapshot().lesson.map(|lesson| lesson.name);
    assert_eq!(name.as_deref(), Some("03-mdi"));
}

#[test]
fn the_topic_of_an_alarm_lists_its_time_and_links_to_its_block() {
    let mut setup = Setup::default();
    let stored = setup
        .memory
        .programs
        .store("O0001;\nG04 X0.1;\nN20 G77 X1;\nM30;\n");
    let stored = stored.expect("room");
    let program = gsk_core::command::ProgramId::Stored(stored);
    setup.memory.programs.select(program);
    let mut bench = bench_with(setup);
    bench.click("Automatic mode");
    bench.click("Cycle start");
    bench.run(1000);
    bench.click("Reset");
    bench.run(500);
    assert!(bench.kernel.emulator().cnc().alarms().is_empty());
    let raised = bench.kernel.snapshot().alarm_records;
    assert_eq!(raised.len(), 1);
    assert_eq!(raised[0].block, "N20 G77 X1;");
    bench.harness.get_by_label("Help F1").click();
    bench.run(10);
    let field = bench.harness.get_by_role(Role::TextInput);
    field.focus();
    bench.run(10);
    bench
        .harness
        .event(egui::Event::Text("alarm 10".to_owned()));
    bench.run(10);
    bench.run(10);
    assert!(bench.harness.query_by_label("Last occurrences").is_some());
    assert!(bench.harness.query_by_label("N20 G77 X1;").is_some());
    bench.harness.get_by_label("Go to the block").scroll_to_me();
    // The list scrolls until it rests.
    for _ in 0..30 {
        bench.run(10);
    }
    click(&mut bench, "Go to the block");
    let open = bench
        .harness
        .state()
        .settings()
        .layouts
        .is_open(ViewId::Program);
    assert!(open, "the program view");
    // A practice machine has a separate alarm history.
    let demonstration = gsk_lesson::find_demonstration("shown/offset").expect("it is there");
    for (order, raised) in [
        (
            LessonAction::Demonstrate(Arc::clone(&demonstration.lesson)),
            0,
        ),
        (LessonAction::Leave, 1),
    ] {
        bench.console.send(Command::Lesson(order));
        bench.run(50);
        assert_eq!(bench.kernel.snapshot().alarm_records.len(), raised);
    }
}

/// The page of a learning platform with one exercise that may be handed in once.
fn course_page(exercise: &str) -> CoursePage {
    let mut shipped = EXERCISES.iter();
    let (id, text) = shipped.find(|(id, _)| *id == exercise).expect("a task");
    let course = CourseFile {
        title: "Course of the school".to_owned(),
        mastery_per_cent: Some(60),
        tasks: vec![CourseTaskFile::new(
            (*id).to_owned(),
            text.replace("time_limit:", "attempts: 1, time_limit:"),
            None,
        )],
    };
    CoursePage {
        file: serde_json::to_vec(&course).expect("a course"),
        suspended: String::new(),
        learner: "Li, Ming".to_owned(),
    }
}

#[test]
fn a_learning_platform_shows_its_exercises_alone_and_counts_attempts() {
    let mut bench = new_bench();
    let data = gsk_tests::test_folder("course").to_path_buf();
    let window = bench.harness.state_mut();
    window.set_course(&course_page("04-spindle"), data);
    bench.run(50);
    bench.harness.get_by_label("Course of the school");
    assert_eq!(
        bench.harness.query_all_by_label("The first hour").count(),
        0
    );
    click(&mut bench, "Start the spindle by MDI");
    assert_eq!(
        bench.kernel.snapshot().exercise,
        None,
        "its time does not run"
    );
    bench
        .harness
        .get_by_label_contains("The clock starts when you press Begin");
    click(&mut bench, "Begin");
    // Title and time are visible although the panel may cover the task.
    let line = bench.harness.query_all_by_label_contains("Time left 5:00");
    assert!(line.count() >= 2, "in the bar and on the message line");
    bench
        .harness
        .get_by_label("Start the spindle by MDI. Time left 5:00");
    click(&mut bench, "Hand in");
    let is_marked = (0..500).any(|_| {
        std::thread::sleep(std::time::Duration::from_millis(10));
        bench.run(10);
        let shown = bench.harness.query_by_label_contains("0 of 10 points");
        shown.is_some()
    });
    assert!(is_marked, "the report comes");
    // No platform is connected in a test.
    let refused = "The learning platform did not accept the points";
    assert!(bench.harness.query_by_label_contains(refused).is_some());
    bench.harness.get_by_label_contains("In brackets: ");
    click(&mut bench, "Leave the exercise");
    bench
        .harness
        .get_by_label_contains("Handed in: 1 of 1. Score: 0 %");
    click(&mut bench, "Start the spindle by MDI");
    bench
        .harness
        .get_by_label_contains("All 1 attempts of this exercise are used.");
    assert_eq!(bench.kernel.snapshot().exercise, None);
}

#[test]
fn a_fault_hunt_leads_to_the_bench_and_begins_again_without_old_refusals() {
    let mut bench = new_bench();
    let data = gsk_tests::test_folder("hunt").to_path_buf();
    let window = bench.harness.state_mut();
    window.set_course(&course_page("f10-drive-z"), data);
    bench.run(50);
    click(&mut bench, "Alarm of a drive");
    click(&mut bench, "Begin");
    let bench_hint = "Fault hunt: no fault is marked.";
    let is_explained = |bench: &WindowBench| {
        let mut shown = bench.harness.query_all_by_label_contains(bench_hint);
        shown.next().is_some()
    };
    assert!(!is_explained(&bench));
    click(&mut bench, "Fault bench");
    bench.run(100);
    let settings = bench.harness.state().settings();
    assert!(settings.layouts.is_open(ViewId::Bench));
    assert!(is_explained(&bench));
    // The task refuses this key.
    bench.click("Parameter pages");
    let refusal = "This exercise does not permit";
    let is_refused = |bench: &WindowBench| {
        let mut shown = bench.harness.query_all_by_label_contains(refusal);
        shown.next().is_some()
    };
    assert!(is_refused(&bench));
    click(&mut bench, "Begin again");
    assert!(!is_refused(&bench), "the new machine has refused nothing");
}

#[test]
fn views_that_an_exam_closes_open_after_it() {
    let layouts = Layouts::with_layout(WindowLayout::Programmer);
    let mut bench = WindowBench::with_layouts(Setup::default(), layouts, egui::vec2(1600.0, 900.0));
    bench.run(50);
    let data = gsk_tests::test_folder("exam-views");
    let pin = ExamPin::new("4711", 1).expect("a PIN");
    let exam = Exam::new("Li".to_owned(), vec![EXERCISES[3].0.to_owned()], pin);
    let folder = ExamFolder::create(&data, exam).map(Some);
    let found = exercises::load_exercises(None);
    let window = bench.harness.state_mut();
    window.set_exercises(found, data.to_path_buf(), folder);
    bench.run(50);
    bench.run(50);
    let is_open = |bench: &WindowBench, view| {
        let layouts = &bench.harness.state().settings().layouts;
        layouts.is_open(view)
    };
    assert!(is_open(&bench, ViewId::Lesson) && !is_open(&bench, ViewId::Program));
    let mut fields = bench.harness.query_all_by_label("PIN");
    let field = fields.find(|it| it.accesskit_node().role() != Role::Label);
    field.expect("the field of the PIN").focus();
    drop(fields);
    bench.run(10);
    bench.harness.event(egui::Event::Text("4711".to_owned()));
    bench.run(10);
    click(&mut bench, "End the exam");
    let opens_again = (0..500).any(|_| {
        std::thread::sleep(std::time::Duration::from_millis(10));
        bench.run(10);
        is_open(&bench, ViewId::Program)
    });
    assert!(opens_again && is_open(&bench, ViewId::Lesson));
    bench.harness.get_by_label_contains("The exam is over.");
}
