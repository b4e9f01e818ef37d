//! Checks that every bit and value of the parameter table has a case that shows its effect, or
//! a line in `parameter-coverage.tsv` with the reason why it has none.
//!
//! A case counts if its `case.ron` sets the parameter to another value than its default, and
//! if it fails without this word: the parameter makes the difference. `test` names a Rust test
//! where no case can show it. `reserved` parameters have no meaning in the manual either.
//! `without effect` belongs to hardware that does not exist here, and is listed in both
//! READMEs for the user.

use std::collections::BTreeMap;
use std::fs;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use gsk_core::memory::{self, ControlParameters, ParameterRow};
use gsk_tests::case::TestCase;
use gsk_tests::sources::has_test;
use gsk_tests::{case_dir, repository, run_loaded_case};

/// What covers a parameter.
#[derive(Clone, Debug, PartialEq)]
enum ParameterCover {
    Cases(Vec<String>),
    Tests(Vec<String>),
    Reserved,
    /// An effect that no case shows yet.
    Open,
    /// The reason, in English and in Chinese.
    WithoutEffect(String, String),
}

/// A bit of a state parameter, or a data parameter as a whole.
type ParameterBit = (u16, Option<u8>);

fn parameter_text(parameter: ParameterBit) -> String {
    match parameter {
        (number, Some(bit)) => format!("{number:03}.{bit}"),
        (number, None) => format!("{number:03}"),
    }
}

fn parse_parameter(text: &str) -> Option<ParameterBit> {
    let (number, bit) = match text.split_once('.') {
        Some((number, bit)) => (number, Some(bit.parse().ok()?)),
        None => (text, None),
    };
    Some((number.parse().ok()?, bit))
}

/// The rows that need a line: bits, data parameters, and state parameters of which the manual
/// names no bit.
fn required_rows() -> impl Iterator<Item = &'static ParameterRow> {
    let rows = memory::parameter_rows();
    rows.iter().filter(move |row| {
        let bits = || {
            rows.iter()
                .any(|other| other.number == row.number && other.bit.is_some())
        };
        row.bit.is_some() || !row.state || !bits()
    })
}

fn read_covers() -> BTreeMap<ParameterBit, ParameterCover> {
    let path = repository().join("tests/parameter-coverage.tsv");
    let text = fs::read_to_string(path).expect("parameter-coverage.tsv");
    let mut covers = BTreeMap::new();
    for line in text.lines().skip(1) {
        let fields: Vec<&str> = line.split('\t').collect();
        let names = |names: &str| names.split(' ').map(str::to_owned).collect();
        let cover = match fields[1..] {
            ["case", cases] => ParameterCover::Cases(names(cases)),
            ["test", tests] => ParameterCover::Tests(names(tests)),
            ["reserved"] => ParameterCover::Reserved,
            ["open"] => ParameterCover::Open,
            ["without effect", en, zh] => {
                ParameterCover::WithoutEffect(en.to_owned(), zh.to_owned())
            }
            _ => panic!("parameter-coverage.tsv: not understood: {line}"),
        };
        let place = parse_parameter(fields[0]).unwrap_or_else(|| panic!("no parameter: {line}"));
        assert!(covers.insert(place, cover).is_none(), "twice: {line}");
    }
    covers
}

#[test]
fn every_bit_and_value_has_its_line() {
    let mut covers = read_covers();
    let mut faults = Vec::new();
    for row in required_rows() {
        let place = (row.number, row.bit);
        let undescribed = ["reserved", "not described"];
        let reserved = undescribed
            .iter()
            .any(|word| row.meaning_en.starts_with(word));
        match covers.remove(&place) {
            None => faults.push(format!("{}: has no line", parameter_text(place))),
            Some(cover) if (cover == ParameterCover::Reserved) != reserved => {
                faults.push(format!("{}: {}", parameter_text(place), row.meaning_en));
            }
            Some(_) => {}
        }
    }
    faults.extend(
        covers
            .keys()
            .map(|place| format!("{}: not in the table", parameter_text(*place))),
    );
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Removes the words of a case that set a parameter. Returns them.
fn take_words(case: &mut TestCase, wanted: ParameterBit) -> Vec<String> {
    let of_it = |word: &String| {
        let name = word.split('=').next().unwrap_or_default();
        parse_parameter(name) == Some(wanted)
    };
    let (words, others) = case.setup.params.drain(..).partition(of_it);
    case.setup.params = others;
    words
}

fn parameter_value(parameters: &ControlParameters, (number, bit): ParameterBit) -> i32 {
    match bit {
        Some(bit) => parameters.bit(number, bit).into(),
        None => parameters.value(number),
    }
}

/// The fault of a case as a proof for a parameter.
fn case_fault(wanted: ParameterBit, name: &str) -> Option<String> {
    let Some(folder) = case_dir(name) else {
        return Some("is no case".to_owned());
    };
    let mut case = match TestCase::read(&folder) {
        Ok(case) => case,
        Err(error) => return Some(error),
    };
    if case.known_failure.is_some() {
        return Some("is a known failure".to_owned());
    }
    let set = case
        .setup
        .program_setup()
        .expect("set-up")
        .memory
        .parameters;
    if take_words(&mut case, wanted).is_empty() {
        return Some("its case.ron does not set it".to_owned());
    }
    let unset = case
        .setup
        .program_setup()
        .expect("set-up")
        .memory
        .parameters;
    if parameter_value(&set, wanted) == parameter_value(&unset, wanted) {
        return Some("sets it to what it is anyway".to_owned());
    }
    run_loaded_case(&case, &folder, false)
        .is_ok()
        .then(|| "passes without it too".to_owned())
}

#[test]
fn every_case_shows_the_difference() {
    let witnesses: Vec<(ParameterBit, String)> = read_covers()
        .into_iter()
        .filter_map(|(place, cover)| match cover {
            ParameterCover::Cases(cases) => Some((place, cases)),
            _ => None,
        })
        .flat_map(|(place, cases)| cases.into_iter().map(move |case| (place, case)))
        .collect();
    let next = AtomicUsize::new(0);
    let faults = Mutex::new(Vec::new());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some((place, case)) = witnesses.get(next.fetch_add(1, Ordering::Relaxed))
                {
                    if let Some(fault) = case_fault(*place, case) {
                        let fault = format!("{}: {case}: {fault}", parameter_text(*place));
                        faults.lock().expect("faults").push(fault);
                    }
                }
            });
        }
    });
    let mut faults = faults.into_inner().expect("faults");
    faults.sort();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn every_test_named_exists() {
    for (place, cover) in read_covers() {
        let ParameterCover::Tests(tests) = cover else {
            continue;
        };
        for test in tests {
            let exists = has_test(&test);
            assert!(exists, "{}: there is no test {test}", parameter_text(place));
        }
    }
}

/// The rows of the table under a heading of a document.
fn table_under<'a>(document: &'a str, heading: &str) -> Vec<&'a str> {
    let (_, below) = document.split_once(heading).expect(heading);
    let lines = below.lines().skip_while(|line| !line.starts_with('|'));
    let table = lines.take_while(|line| line.starts_with('|'));
    table.skip(2).collect()
}

#[test]
fn the_readmes_list_what_is_without_effect() {
    let (mut english, mut chinese) = (Vec::new(), Vec::new());
    for (place, cover) in read_covers() {
        let ParameterCover::WithoutEffect(en, zh) = cover else {
            continue;
        };
        let row = memory::parameter_row(place.0, place.1).expect("row");
        let name = format!("{} {}", parameter_text(place), row.symbol);
        english.push(format!("| {} | {en} |", name.trim_end()));
        chinese.push(format!("| {} | {zh} |", name.trim_end()));
    }
    let text = |name: &str| fs::read_to_string(repository().join(name)).expect(name);
    let heading = "### Kept for compatibility, without effect";
    assert_eq!(table_under(&text("README.md"), heading), english);
    let heading = "### 为兼容而保留、不起作用的参数";
    assert_eq!(table_under(&text("README.zh-CN.md"), heading), chinese);
}

/// Facts from the appendix of parameters and from its chapters, with the cases or tests that
/// check them.
#[test]
fn every_fact_about_parameters_has_its_case_or_test() {
    let path = repository().join("tests/parameter-facts.tsv");
    let text = fs::read_to_string(path).expect("parameter-facts.tsv");
    for line in text.lines().skip(1) {
        let fields: Vec<&str> = line.split('\t').collect();
        let [_, _, proofs] = fields[..] else {
            panic!("parameter-facts.tsv: three columns are needed: {line}");
        };
        for proof in proofs.split(' ') {
            let exists = case_dir(proof).is_some() || has_test(proof);
            assert!(exists, "there is neither a case nor a test {proof}");
        }
    }
}
