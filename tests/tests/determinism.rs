//! The same inputs at the same ticks give the same machine, bit for bit, also after saving and
//! restoring in the middle; an exercise gets the same mark.

use std::fs;

use gsk_exercise::judge::judge;
use gsk_exercise::result_file::{ResultAuthor, write_result};
use gsk_exercise::seal::SealKey;
use gsk_exercise::solve::{SolutionScript, record_solution};
use gsk_exercise::task::ExerciseTask;
use gsk_tests::determinism::{GOLDEN, SessionTrace};
use gsk_tests::marks::mark_and_replay;
use gsk_tests::repository;

fn run_session(saves: &[u64]) -> SessionTrace {
    gsk_tests::install_texts();
    gsk_tests::determinism::trace_session(saves).expect("the session")
}

#[test]
fn the_same_script_twice_is_the_same_machine() {
    assert_eq!(run_session(&[]), run_session(&[]));
}

#[test]
fn saving_and_restoring_changes_nothing() {
    let saves = [1, 2500, 6001, 9137, 12_000, 14_567, 21_003, 33_333];
    assert_eq!(run_session(&[]), run_session(&saves));
}

#[test]
fn positions_are_those_of_every_platform() {
    let trace = run_session(&[]);
    assert_eq!(
        trace.positions, GOLDEN,
        "the positions of the script hash to {:#018x} now",
        trace.positions
    );
}

#[test]
fn an_exercise_is_marked_and_replayed_as_on_every_platform() {
    const NAME: &str = "19-taper";
    let read = |name: &str| {
        let path = repository().join("assets/exercises").join(NAME).join(name);
        fs::read_to_string(path).expect("a file of the exercise")
    };
    let task = ExerciseTask::read(NAME, NAME, &read("task.ron")).expect("a task");
    let script = SolutionScript::read(&read("reference.txt")).expect("a script");
    let recording = record_solution(&task, &script, "test").expect("recorded");
    let author = ResultAuthor {
        program: "test".to_owned(),
        learner: "Anna".to_owned(),
        hints: Vec::new(),
        exam: None,
    };
    let report = judge(&task, &recording).expect("judged");
    let key = SealKey::from_random(&[1; 32], [1; 8]);
    let result = write_result(author, report, &recording, &key).expect("a result");
    gsk_tests::install_texts();
    let files = [
        ("anna.gskresult".to_owned(), result),
        ("anna.gskrec".to_owned(), recording),
    ];
    let text = mark_and_replay(&files);
    // All digits of the angle: another sine would change the last one.
    for expected in [
        "\"valid\": true",
        "\"measured\": 14.03631207847785",
        "\"differs_at\": null",
        "\"is_complete\": true",
    ] {
        assert!(text.contains(expected), "{expected} is missing:\n{text}");
    }
}
