//! Keys and pages that a task refuses.

use gsk_exercise::check::{check_task, judge_script};
use gsk_exercise::judge::{JudgeError, judge};
use gsk_exercise::solve::{SolutionScript, record_solution};
use gsk_exercise::task::ExerciseTask;
use gsk_messages::Language;

use super::{read_file, read_task};

/// The file of the exercise with the handwheel, with another line of permitted keys and pages.
fn handwheel_with(lines: &str) -> String {
    let text = read_file("03-handwheel", "task.ron");
    let own = text.lines().find(|line| line.trim().starts_with("keys:"));
    text.replace(own.expect("a list of keys"), lines)
}

#[test]
fn a_refused_key_is_in_the_report_and_decides_the_solution() {
    let task = read_task("03-handwheel");
    let script = read_file("03-handwheel", "wrong-4.txt");
    let report = judge_script(&task, &script).expect("judged");
    let refused = report.refused.clone().expect("a refused key");
    assert_eq!((refused.count, report.points), (1, 0));
    let sentence = refused.message().text(Language::En);
    assert!(
        sentence.ends_with("does not permit the key [录入]."),
        "{sentence}"
    );
    // The same keys reach the position where the task permits them.
    let free = ExerciseTask::read("03-handwheel", "task.ron", &handwheel_with("")).expect("a task");
    let report = judge_script(&free, &script).expect("judged");
    assert_eq!((report.points, report.refused), (free.max_points(), None));
    // A recording of the machine without limits is none of the task.
    let script = SolutionScript::read(&script).expect("a script");
    let recording = record_solution(&free, &script, "test").expect("recorded");
    assert_eq!(judge(&task, &recording), Err(JudgeError::ForeignState));
}

#[test]
fn a_refused_page_is_in_the_report() {
    let task = read_task("f10-drive-z");
    let report = judge_script(&task, &read_file("f10-drive-z", "wrong-4.txt")).expect("judged");
    let refused = report.refused.expect("a refused page");
    assert_eq!(refused.count, 1);
    let sentence = refused.message().text(Language::Zh);
    assert!(sentence.contains("（par-bit）"), "{sentence}");
}

#[test]
fn a_wrong_name_is_reported_with_its_line() {
    for (lines, line, words) in [
        ("keys: Only([\n\"HND\",\n\"HAND\",\n]),", 2, "HAND"),
        (
            "pages: AllBut([\"pos-rel\", \"somewhere\"]),",
            0,
            "somewhere",
        ),
        (
            "keys: AllBut([\"JOG\",\n\"FH\"]),",
            1,
            "FH stops the machine",
        ),
        ("keys: AllBut([\"ESTOP\"]),", 0, "ESTOP stops the machine"),
        ("keys: AllBut([\"reset\"]),", 0, "RESET stops the machine"),
    ] {
        let text = handwheel_with(lines);
        let first = lines.lines().next().expect("a line");
        let first = text.lines().position(|it| it == first).expect("the list") + 1;
        let error = ExerciseTask::read("a", "task.ron", &text).expect_err(lines);
        assert_eq!(error.line, first + line, "{lines}");
        let message = error.to_string();
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn a_list_without_the_keys_that_stop_the_machine_is_noted() {
    let text = handwheel_with("keys: Only([\"HND\", \"HX\", \"HZ\", \"I100\", \"FH\"]),");
    let task = ExerciseTask::read("a", "task.ron", &text).expect("a task");
    let notes = check_task(&task, &[]).notes;
    assert_eq!(notes.len(), 1);
    let note = notes[0].text(Language::En);
    assert!(note.starts_with("ESTOP RESET stay permitted"), "{note}");
}
