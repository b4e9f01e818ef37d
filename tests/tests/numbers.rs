//! Checks that the sources name alarms and parameters by the `id` of
//! `assets/tables/alarms.tsv` and `parameters.tsv`, or by a method of `Parameters`, and never
//! by a number. Tests may use numbers.

use std::fs;

use gsk_tests::repository;
use gsk_tests::sources::{SourceFile, control_sources, package_sources};

/// Code before the number of an alarm.
const ALARM_PREFIXES: [&str; 9] = [
    "Alarm::new(",
    "Alarm::message(",
    "BlockError::at(",
    "self.alarm(",
    "self.refuse(",
    "Outcome::Fails(",
    "alarms.contains(",
    "alarms.remove(",
    "alarm.number == ",
];

/// Code before the number of a parameter.
const PARAMETER_PREFIXES: [&str; 5] = [".bit(", ".set_bit(", ".value(", ".timer_ms(", ".byte("];

/// The folder of the parameter table, with the named methods.
const MEMORY_FOLDER: &str = "core/src/memory";

/// Positions where a digit follows one of these beginnings, as `file:line`.
fn find_bare_numbers(sources: &[SourceFile], beginnings: &[&str]) -> Vec<String> {
    let mut places = Vec::new();
    for source in sources {
        for beginning in beginnings {
            for (at, _) in source.text.match_indices(beginning) {
                let text_after = source.text[at + beginning.len()..].trim_start();
                if text_after.starts_with(|letter: char| letter.is_ascii_digit()) {
                    let line = source.text[..at].lines().count();
                    places.push(format!("{}:{line}: {beginning}", source.path.display()));
                }
            }
        }
    }
    places
}

#[test]
fn alarms_are_raised_by_name() {
    let places = find_bare_numbers(&control_sources(), &ALARM_PREFIXES);
    assert!(places.is_empty(), "{}", places.join("\n"));
}

#[test]
fn parameters_are_read_by_name() {
    let mut sources = control_sources();
    let memory = repository().join(MEMORY_FOLDER);
    sources.retain(|source| !source.path.starts_with(&memory));
    let places = find_bare_numbers(&sources, &PARAMETER_PREFIXES);
    assert!(places.is_empty(), "{}", places.join("\n"));
}

#[test]
fn every_name_of_the_tables_is_used() {
    let mut sources = control_sources();
    // The set-up of a lathe.
    sources.extend(package_sources(&["commission"]));
    for (name, column) in [("alarms.tsv", 2), ("parameters.tsv", 3)] {
        let path = repository().join("assets/tables").join(name);
        let table = fs::read_to_string(path).expect("table");
        assert_ids_are_used(&table, column, &sources);
    }
}

fn assert_ids_are_used(table: &str, column: usize, sources: &[SourceFile]) {
    for line in table.lines().skip(1) {
        let id = line.split('\t').nth(column).expect("id");
        let wanted = format!("::{id}");
        let names = |source: &SourceFile| {
            source.text.match_indices(&wanted).any(|(at, _)| {
                let next_character = source.text[at + wanted.len()..].chars().next();
                !next_character
                    .is_some_and(|letter| letter == '_' || letter.is_ascii_alphanumeric())
            })
        };
        assert!(
            id == "-" || sources.iter().any(names),
            "{id}: no source asks for it; the table says - then"
        );
    }
}
