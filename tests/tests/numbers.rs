//! Checks that the sources name alarms and parameters by the `id` of
//! `assets/tables/alarms.tsv` and `parameters.tsv`, or by a method of `Parameters`, and never
//! by a number. Tests may use numbers.

use std::fs;

use gsk_tests::repository;
use gsk_tests::sources::{Source, control_sources, sources_of};

/// Code before the number of an alarm.
const ALARM_AT: [&str; 9] = [
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
const PARAMETER_AT: [&str; 5] = [".bit(", ".set_bit(", ".value(", ".timer_ms(", ".byte("];

/// The folder of the parameter table, with the named methods.
const MEMORY: &str = "core/src/memory";

/// Positions where a digit follows one of these beginnings, as `file:line`.
fn bare_numbers(sources: &[Source], beginnings: &[&str]) -> Vec<String> {
    let mut places = Vec::new();
    for source in sources {
        for beginning in beginnings {
            for (at, _) in source.text.match_indices(beginning) {
                let behind = source.text[at + beginning.len()..].trim_start();
                if behind.starts_with(|letter: char| letter.is_ascii_digit()) {
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
    let places = bare_numbers(&control_sources(), &ALARM_AT);
    assert!(places.is_empty(), "{}", places.join("\n"));
}

#[test]
fn parameters_are_asked_by_name() {
    let mut sources = control_sources();
    let memory = repository().join(MEMORY);
    sources.retain(|source| !source.path.starts_with(&memory));
    let places = bare_numbers(&sources, &PARAMETER_AT);
    assert!(places.is_empty(), "{}", places.join("\n"));
}

#[test]
fn every_name_of_the_tables_is_used() {
    let mut sources = control_sources();
    // The set-up of a lathe.
    sources.extend(sources_of(&["commission"]));
    for (name, column) in [("alarms.tsv", 2), ("parameters.tsv", 3)] {
        let path = repository().join("assets/tables").join(name);
        let table = fs::read_to_string(path).expect("table");
        every_id_is_used(&table, column, &sources);
    }
}

fn every_id_is_used(table: &str, column: usize, sources: &[Source]) {
    for line in table.lines().skip(1) {
        let id = line.split('\t').nth(column).expect("id");
        let wanted = format!("::{id}");
        let names = |source: &Source| {
            source.text.match_indices(&wanted).any(|(at, _)| {
                let behind = source.text[at + wanted.len()..].chars().next();
                !behind.is_some_and(|letter| letter == '_' || letter.is_ascii_alphanumeric())
            })
        };
        assert!(
            id == "-" || sources.iter().any(names),
            "{id}: no source asks for it; the table says - then"
        );
    }
}
