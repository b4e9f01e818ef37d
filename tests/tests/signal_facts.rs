//! Checks that every signal of the control that the standard ladder does not read has a line
//! in `signal-facts.tsv`: what sets and clears it according to the manual, and the cases that
//! see it at 1 and at 0. Authors of ladders build on these signals, and no other case would
//! detect that one of them is wrong.

use std::collections::BTreeSet;
use std::fs;

use gsk_tests::sources::has_test;
use gsk_tests::{case_dir, repository};

const SIGNALS: &str = include_str!("../../assets/tables/plc-signals.tsv");

/// A line of the table.
struct SignalFact {
    address: String,
    cases: Vec<String>,
}

fn read_facts() -> Vec<SignalFact> {
    let path = repository().join("tests/signal-facts.tsv");
    let text = fs::read_to_string(path).expect("signal-facts.tsv");
    let fact = |line: &str| {
        let cells: Vec<&str> = line.split('\t').collect();
        let [address, set, cleared, manual, cases] = cells[..] else {
            panic!("signal-facts.tsv: five cells: {line}");
        };
        let is_empty = [set, cleared, manual, cases]
            .iter()
            .any(|cell| cell.is_empty());
        assert!(!is_empty, "signal-facts.tsv: an empty cell: {line}");
        SignalFact {
            address: address.to_owned(),
            cases: cases.split(' ').map(str::to_owned).collect(),
        }
    };
    text.lines().skip(1).map(fact).collect()
}

/// Signals that the control sends and the standard ladder does not read.
fn unread_signals() -> impl Iterator<Item = &'static str> {
    SIGNALS.lines().filter_map(|line| {
        let cells: Vec<&str> = line.split('\t').collect();
        let [address, .., acts] = cells[..] else {
            return None;
        };
        let control = acts.split(';').next()? == "control";
        (address.starts_with('F') && control).then_some(address)
    })
}

/// The values that a script expects of an address or of its bits.
fn expected_values(script: &str, address: &str) -> BTreeSet<String> {
    let lines = script.lines().map(|line| line.split_whitespace());
    lines
        .filter_map(|mut words| {
            let verb = words.next()?;
            let (seen, value) = (words.next()?, words.next()?);
            let is_bit = seen
                .split_once('.')
                .is_some_and(|(byte, _)| byte == address);
            let asks = matches!(verb, "expect" | "wait") && (seen == address || is_bit);
            asks.then(|| value.to_owned())
        })
        .collect()
}

#[test]
fn signals_that_no_standard_rung_reads_have_their_facts() {
    let facts = read_facts();
    let named: BTreeSet<&str> = facts.iter().map(|fact| fact.address.as_str()).collect();
    let mut faults = Vec::new();
    for address in unread_signals() {
        let byte = address.split('.').next().unwrap();
        if !named.contains(address) && !named.contains(byte) {
            faults.push(format!("{address}: has no line"));
        }
    }
    for fact in &facts {
        let mut values = BTreeSet::new();
        let mut by_test = false;
        for name in &fact.cases {
            match case_dir(name) {
                Some(folder) => {
                    let script = fs::read_to_string(folder.join("operate.txt"));
                    values.extend(expected_values(&script.unwrap_or_default(), &fact.address));
                }
                None if has_test(name) => by_test = true,
                None => faults.push(format!("{}: no case {name}", fact.address)),
            }
        }
        let is_bit = fact.address.contains('.');
        let both = values.contains("0") && values.contains("1");
        if !by_test && (is_bit && !both || values.is_empty()) {
            faults.push(format!("{}: seen as {values:?} only", fact.address));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
