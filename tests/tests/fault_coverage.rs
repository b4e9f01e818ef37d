//! Checks that every fault of the lathe has a case that causes it and opens the diagnosis page
//! for it.

use std::fs;

use gsk_core::machine::FAULTS;
use gsk_tests::tree;

#[test]
fn every_fault_has_a_case_that_shows_its_cause() {
    let mut scripts = Vec::new();
    for case in tree::list_cases().unwrap() {
        let script = case.folder.join("operate.txt");
        scripts.extend(fs::read_to_string(script));
    }
    assert!(scripts.len() > 200, "{}", scripts.len());
    let without: Vec<&str> = FAULTS
        .iter()
        .map(|row| row.name)
        .filter(|name| {
            let breaks = format!("fault {name} on");
            let shows = |script: &String| script.contains(&breaks) && script.contains("press DGN");
            !scripts.iter().any(shows)
        })
        .collect();
    assert_eq!(without, [""; 0]);
}
