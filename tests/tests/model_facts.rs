//! Checks `model-facts.tsv`: each fact of the control models, C1 to C58, has cases and tests
//! that prove it.

use std::collections::BTreeSet;
use std::fs;

use gsk_tests::case::TestCase;
use gsk_tests::sources::has_test;
use gsk_tests::{case_dir, repository};

/// Number of facts; they count from 1.
const FACT_COUNT: u32 = 58;

/// The fault of a case as a proof.
fn case_fault(name: &str) -> Option<String> {
    let Some(folder) = case_dir(name) else {
        return Some(format!("there is no case {name}"));
    };
    match TestCase::read(&folder) {
        Ok(case) if case.known_failure.is_some() => Some(format!("{name} is a known failure")),
        Ok(_) => None,
        Err(error) => Some(format!("{name}: {error}")),
    }
}

/// The faults of a table of facts.
fn table_faults(table: &str) -> Vec<String> {
    let mut faults = Vec::new();
    let mut missing: BTreeSet<u32> = (1..=FACT_COUNT).collect();
    for line in table.lines().skip(1) {
        let fields: Vec<&str> = line.split('\t').collect();
        let [fact, what, cases, tests] = fields[..] else {
            faults.push(format!("four columns are needed: {line}"));
            continue;
        };
        let number = fact.strip_prefix('C').and_then(|it| it.parse().ok());
        if !number.is_some_and(|number| missing.remove(&number)) {
            faults.push(format!("{fact}: no fact, or a second time"));
        }
        if what.is_empty() || (cases.is_empty() && tests.is_empty()) {
            faults.push(format!("{fact}: without text or proof"));
        }
        let cases = cases.split(' ').filter(|name| !name.is_empty());
        faults.extend(cases.filter_map(case_fault));
        let tests = tests.split(' ').filter(|name| !name.is_empty());
        let unknown = tests.filter(|name| !has_test(name));
        faults.extend(unknown.map(|name| format!("{fact}: there is no test {name}")));
    }
    faults.extend(missing.iter().map(|fact| format!("C{fact}: is missing")));
    faults
}

fn read_table() -> String {
    let path = repository().join("tests/model-facts.tsv");
    fs::read_to_string(path).expect("model-facts.tsv")
}

#[test]
fn every_fact_is_proven() {
    let faults = table_faults(&read_table());
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn a_fact_that_is_not_proven_is_found() {
    let table = read_table();
    let twice = table.replace("\nC2\t", "\nC1\t");
    assert_eq!(table_faults(&twice).len(), 2);
    let unknown = table.replace("c10-word", "c10-wrd");
    assert_eq!(table_faults(&unknown), ["there is no case c10-wrd"]);
    let gone = table.replace("gears_of_the_manual", "gears");
    assert_eq!(table_faults(&gone).len(), 2);
}
