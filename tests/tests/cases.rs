//! Runs every case under `tests/cases/` as a test named by its path.
//!
//! `cargo test -p gsk980td-tests --test cases -- G71` runs the cases with `G71` in their path,
//! `--list` names them, `--exact` requires the whole path, `--help` lists the rest.
//! `UPDATE_CASES=1` in the environment rewrites what differs.

use std::process::ExitCode;

use gsk_tests::run_case;
use gsk_tests::tree::{self, CaseFolder};
use libtest_mimic::{Arguments, Failed, Trial};

fn main() -> ExitCode {
    gsk_tests::install_texts();
    let arguments = Arguments::from_args();
    let update = std::env::var_os("UPDATE_CASES").is_some_and(|value| value != "0");
    let cases = match tree::list_cases() {
        Ok(cases) => cases,
        Err(faults) => {
            eprintln!("{faults}");
            return ExitCode::FAILURE;
        }
    };
    let trials = cases
        .into_iter()
        .map(|case| build_trial(case, update))
        .collect();
    libtest_mimic::run(&arguments, trials).exit_code()
}

fn build_trial(case: CaseFolder, update: bool) -> Trial {
    let CaseFolder { path, folder, .. } = case;
    Trial::test(path, move || {
        run_case(&folder, update).map_err(Failed::from)
    })
}
