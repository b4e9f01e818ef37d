//! Checks that every alarm of the control has a case that raises it, or a line in
//! `alarm-coverage.tsv` with the reason why none can.
//!
//! `never` marks alarms that a simulated machine cannot have, `test` names the Rust test that
//! raises an alarm which no case can, `open` marks those without either so far. An alarm of a
//! program may be open only while a case marked as a known failure waits for it.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use gsk_core::alarm::{self, AlarmRow};
use gsk_tests::sources::has_test;
use gsk_tests::tree::CaseFolder;
use gsk_tests::{TestCase, repository, tree};
use serde_json::Value;

/// The cases of an alarm.
#[derive(Default)]
struct AlarmCases {
    pass: Vec<String>,
    known_failures: Vec<String>,
}

/// Cases by the first number of the table row they raise.
type CasesByAlarm = BTreeMap<u16, AlarmCases>;

/// The alarm that the result of a program case expects.
fn expected_alarm(folder: &Path) -> Option<Value> {
    let text = fs::read_to_string(folder.join("result.json")).ok()?;
    let result: Value = serde_json::from_str(&text).expect("result.json");
    result
        .get("alarm")
        .filter(|alarm| !alarm.is_null())
        .cloned()
}

/// The alarms that an operator script waits for.
fn alarms_of_script(text: &str) -> Vec<u16> {
    text.lines()
        .filter_map(|line| line.trim().strip_prefix("expect alarm "))
        .filter_map(|rest| rest.split_whitespace().next()?.parse().ok())
        .collect()
}

fn read_cases() -> CasesByAlarm {
    let mut covered = CasesByAlarm::new();
    for CaseFolder { name, folder, .. } in tree::list_cases().expect("cases") {
        let case = TestCase::read(&folder).expect("case.ron");
        let numbers = match &case.script {
            Some(script) => {
                alarms_of_script(&fs::read_to_string(folder.join(script)).expect("script"))
            }
            None => expected_alarm(&folder)
                .and_then(|alarm| alarm["number"].as_u64())
                .and_then(|number| u16::try_from(number).ok())
                .into_iter()
                .collect(),
        };
        for number in numbers {
            let row =
                alarm::row(number).unwrap_or_else(|| panic!("{name}: there is no alarm {number}"));
            let cases = covered.entry(row.number).or_default();
            match case.known_failure {
                Some(_) => cases.known_failures.push(name.clone()),
                None => cases.pass.push(name.clone()),
            }
        }
    }
    covered
}

/// Why an alarm has no case.
struct CoverageReason {
    open: bool,
    why: String,
}

fn read_reasons() -> BTreeMap<u16, CoverageReason> {
    let path = repository().join("tests/alarm-coverage.tsv");
    let text = fs::read_to_string(path).expect("alarm-coverage.tsv");
    let mut reasons = BTreeMap::new();
    for line in text.lines().skip(1) {
        let fields: Vec<&str> = line.split('\t').collect();
        let [number, kind, why] = fields[..] else {
            panic!("alarm-coverage.tsv: three columns are needed: {line}");
        };
        let open = match kind {
            "never" => false,
            "open" => true,
            "test" => {
                assert!(has_test(why), "{number}: there is no test {why}");
                false
            }
            other => panic!("alarm-coverage.tsv: {other} is neither never, test nor open"),
        };
        let reason = CoverageReason {
            open,
            why: why.to_owned(),
        };
        let number = number.parse().expect("an alarm number");
        assert!(!reason.why.is_empty(), "{number}: without a reason");
        assert!(reasons.insert(number, reason).is_none(), "{number} twice");
    }
    reasons
}

/// The fault of one row of the alarm table.
fn row_fault(
    row: &AlarmRow,
    cases: &AlarmCases,
    reason: Option<&CoverageReason>,
) -> Option<String> {
    let of_program = row.advice.is_some();
    let text = match (cases.pass.first(), reason) {
        (None, None) => "neither a case nor a line in alarm-coverage.tsv".to_owned(),
        (Some(case), Some(_)) => {
            format!("{case} raises it: take its line out of alarm-coverage.tsv")
        }
        (None, Some(reason)) if reason.open && of_program && cases.known_failures.is_empty() => {
            format!(
                "a program raises it, so it cannot stay open ({})",
                reason.why
            )
        }
        _ => return None,
    };
    Some(format!("{:03} {}: {text}", row.number, row.meaning_en))
}

#[test]
fn every_alarm_has_a_case_or_a_reason() {
    let (mut covered, reasons) = (read_cases(), read_reasons());
    let mut faults: Vec<String> = alarm::rows()
        .iter()
        .filter_map(|row| {
            let cases = covered.remove(&row.number).unwrap_or_default();
            row_fault(row, &cases, reasons.get(&row.number))
        })
        .collect();
    let unknown = reasons
        .keys()
        .filter(|number| alarm::row(**number).is_none_or(|row| row.number != **number));
    faults.extend(unknown.map(|number| format!("{number:03}: not in the alarm table")));
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn every_alarm_of_a_program_case_is_expected_at_a_line() {
    let cases = tree::list_cases().expect("cases").into_iter();
    let without: Vec<String> = cases
        .filter(|case| expected_alarm(&case.folder).is_some_and(|alarm| alarm["line"].is_null()))
        .map(|case| case.name)
        .collect();
    assert!(without.is_empty(), "no line: {}", without.join(", "));
}

#[test]
fn a_script_names_its_alarms() {
    let script = "press CS\nwait alarm 5s\nexpect alarm 011   # no F\nexpect alarm none\n";
    assert_eq!(alarms_of_script(script), [11]);
}
