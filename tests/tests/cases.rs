//! Runs every folder under `tests/cases/`: one line and one failure for each.
//!
//! `cargo test -p gsk980td-tests --test cases -- arc` runs the cases with `arc`
//! in their name; `UPDATE_CASES=1` rewrites what differs.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use gsk_tests::{cases_dir, run_case};

fn main() -> ExitCode {
    let mut filters = Vec::new();
    let mut exact = false;
    let mut list = false;
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--exact" => exact = true,
            "--list" => list = true,
            // Options of the usual test harness that take a value.
            "--test-threads" | "--skip" | "--format" | "--color" | "-Z" => {
                words.next();
            }
            word if word.starts_with('-') => {}
            word => filters.push(word.to_owned()),
        }
    }
    let wanted = |name: &str| {
        filters.is_empty()
            || filters.iter().any(|filter| {
                if exact {
                    name == filter
                } else {
                    name.contains(filter.as_str())
                }
            })
    };
    let folders = match folders() {
        Ok(folders) => folders,
        Err(error) => {
            eprintln!("{}: {error}", cases_dir().display());
            return ExitCode::FAILURE;
        }
    };
    let chosen: Vec<_> = folders
        .into_iter()
        .filter(|(name, _)| wanted(name))
        .collect();
    if list {
        for (name, _) in &chosen {
            println!("{name}: test");
        }
        return ExitCode::SUCCESS;
    }
    let update = std::env::var_os("UPDATE_CASES").is_some_and(|value| value != "0");
    let failures = run_all(&chosen, update);
    for (name, failure) in &failures {
        println!("\n---- {name} ----\n{failure}");
    }
    println!(
        "\n{} cases: {} passed, {} failed",
        chosen.len(),
        chosen.len() - failures.len(),
        failures.len()
    );
    if failures.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

fn folders() -> std::io::Result<Vec<(String, PathBuf)>> {
    let mut folders = Vec::new();
    for entry in std::fs::read_dir(cases_dir())? {
        let path = entry?.path();
        if path.is_dir() {
            let name = path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            folders.push((name, path));
        }
    }
    folders.sort();
    Ok(folders)
}

fn run_all(cases: &[(String, PathBuf)], update: bool) -> Vec<(String, String)> {
    let next = AtomicUsize::new(0);
    let failures = Mutex::new(Vec::new());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some((name, folder)) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let outcome = std::panic::catch_unwind(|| run_case(folder, update))
                        .unwrap_or_else(|_| Err("panicked".to_owned()));
                    match outcome {
                        Ok(()) => println!("case {name} ... ok"),
                        Err(failure) => {
                            println!("case {name} ... FAILED");
                            if let Ok(mut failures) = failures.lock() {
                                failures.push((name.clone(), failure));
                            }
                        }
                    }
                }
            });
        }
    });
    let mut failures = failures.into_inner().unwrap_or_default();
    failures.sort();
    failures
}
