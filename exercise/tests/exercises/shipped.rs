//! Every shipped exercise is solved by its reference and failed by its wrong solutions.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use gsk_exercise::check::{SolutionContent, SolutionFile, TaskCheck, check_task};
use gsk_exercise::library::EXERCISES;
use gsk_exercise::task::ExerciseTask;

use super::{exercises_folder, read_file};

/// Least number of wrong solutions of an exercise.
const WRONG_SOLUTIONS: usize = 3;

fn solutions(name: &str) -> Vec<SolutionFile> {
    let entries = fs::read_dir(exercises_folder().join(name)).expect("a folder");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("entry").path()).collect();
    paths.sort();
    let texts = paths
        .iter()
        .filter(|path| path.extension().is_some_and(|it| it == "txt"));
    texts
        .map(|path| SolutionFile {
            name: path
                .file_name()
                .expect("name")
                .to_string_lossy()
                .into_owned(),
            content: SolutionContent::Script(fs::read_to_string(path).expect("a script")),
        })
        .collect()
}

/// Checks one exercise and returns what is wrong with it.
fn check(name: &str) -> Vec<String> {
    let task = match ExerciseTask::read(name, name, &read_file(name, "task.ron")) {
        Ok(task) => task,
        Err(error) => return vec![error.to_string()],
    };
    let solutions = solutions(name);
    let TaskCheck {
        faults, reports, ..
    } = check_task(&task, &solutions);
    let mut problems: Vec<String> = faults
        .iter()
        .map(|fault| format!("{name}: {fault}"))
        .collect();
    if !problems.is_empty() {
        for (solution, report) in &reports {
            let verdicts = report.verdicts.iter();
            problems.extend(verdicts.filter(|it| !it.is_met).map(|verdict| {
                let evidence = &verdict.evidence;
                let found = evidence.found.as_ref().map(ToString::to_string);
                let (tick, measured) = (evidence.tick, evidence.measured);
                format!(
                    "    {solution}: {}: {tick:?} {measured:?} {found:?}",
                    verdict.id
                )
            }));
        }
    }
    if solutions.len() <= WRONG_SOLUTIONS {
        problems.push(format!(
            "{name}: {WRONG_SOLUTIONS} wrong solutions are needed"
        ));
    }
    problems
}

#[test]
fn every_exercise_is_solved_by_its_reference_and_failed_by_its_wrong_solutions() {
    // One exercise alone while it is written.
    let only = std::env::var("EXERCISE").ok();
    let names: Vec<&str> = EXERCISES
        .iter()
        .map(|(name, _)| *name)
        .filter(|name| only.as_deref().is_none_or(|only| name.contains(only)))
        .collect();
    let next = AtomicUsize::new(0);
    let work = || {
        let mut problems = Vec::new();
        while let Some(name) = names.get(next.fetch_add(1, Ordering::Relaxed)) {
            problems.extend(check(name));
        }
        problems
    };
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let problems: Vec<String> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        let results = workers
            .into_iter()
            .map(|worker| worker.join().expect("checked"));
        results.flatten().collect()
    });
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn every_folder_of_exercises_is_in_the_library() {
    let entries = fs::read_dir(exercises_folder()).expect("a folder");
    let mut folders: Vec<String> = entries
        .map(|entry| {
            entry
                .expect("entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    folders.sort();
    let names: Vec<&str> = EXERCISES.iter().map(|(name, _)| *name).collect();
    assert_eq!(folders, names);
}
