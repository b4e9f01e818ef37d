//! Runs cases with a part program.

use std::path::Path;

use serde_json::{Value, json};

use crate::case::{ProgramPath, TestCase};
use crate::compare::{list_differences, update_expectation};
use crate::execute::{self, PathResult};
use crate::setup;

const MOVES_FILE: &str = "moves.ndjson";
const RESULT_FILE: &str = "result.json";

/// Fields of the report that only the preview computes.
const CHECK_ONLY: [&str; 3] = ["more_alarms", "unchecked_behind", "warnings"];

/// Executes the programs of a case on its paths, and compares moves and reports with the
/// expected ones.
pub(crate) fn run_program_case(case: &TestCase, folder: &Path, update: bool) -> Result<(), String> {
    let texts: Vec<String> = case
        .programs
        .iter()
        .map(|name| crate::read_case_file(folder, name))
        .collect::<Result<_, _>>()?;
    let mut start = case.setup.program_setup()?;
    start.memory.programs = setup::build_memory(&texts)?;
    let expected = ExpectedResult::read(folder)?;
    let mut all = Vec::new();
    for &path in &case.paths {
        let seen = match path {
            ProgramPath::Check => match case.setup.mill_setup(&start)? {
                Some(mill) => execute::run_mill_check(&mill, &start.memory.programs),
                None => execute::run_check(&start),
            },
            ProgramPath::Run if start.memory.model.id().is_mill() => continue,
            ProgramPath::Run => execute::run_kernel(&start),
        };
        let found = expected.differences(path, &seen, case.time_tolerance);
        if !found.is_empty() && update {
            expected.update(folder, &seen)?;
        }
        all.extend(found);
    }
    if all.is_empty() || update {
        Ok(())
    } else {
        Err(all.join("\n"))
    }
}

struct ExpectedResult {
    moves: Option<Vec<Value>>,
    result: Option<Value>,
}

impl ExpectedResult {
    fn read(folder: &Path) -> Result<Self, String> {
        let moves = crate::read_optional_file(folder, MOVES_FILE)?
            .map(|text| {
                let lines = text.lines().enumerate();
                lines
                    .map(|(index, line)| {
                        serde_json::from_str(line)
                            .map_err(|error| format!("{MOVES_FILE}:{}: {error}", index + 1))
                    })
                    .collect::<Result<Vec<Value>, _>>()
            })
            .transpose()?;
        let result = crate::read_optional_file(folder, RESULT_FILE)?
            .map(|text| {
                serde_json::from_str(&text).map_err(|error| format!("{RESULT_FILE}: {error}"))
            })
            .transpose()?;
        Ok(Self { moves, result })
    }

    fn differences(
        &self,
        path: ProgramPath,
        actual: &PathResult,
        time_tolerance: f64,
    ) -> Vec<String> {
        let name = path.name();
        let mut all = Vec::new();
        if self.moves.is_none() && self.result.is_none() {
            all.push(format!("neither {MOVES_FILE} nor {RESULT_FILE} is there"));
        }
        if let Some(result) = &self.result {
            let mut result = result.clone();
            let others: &[&str] = match path {
                ProgramPath::Check => &[],
                ProgramPath::Run => &CHECK_ONLY,
            };
            if let Value::Object(fields) = &mut result {
                fields.retain(|field, _| !others.contains(&field.as_str()));
            }
            all.extend(list_differences(
                name,
                &result,
                &actual.result,
                time_tolerance,
            ));
        }
        if let Some(moves) = &self.moves {
            for (index, (expected, seen)) in moves.iter().zip(&actual.moves).enumerate() {
                let place = format!("{name}: move {}", index + 1);
                all.extend(list_differences(&place, expected, seen, time_tolerance));
            }
            if moves.len() != actual.moves.len() {
                let next = moves
                    .get(actual.moves.len())
                    .or(actual.moves.get(moves.len()));
                all.push(format!(
                    "{name}: {} moves expected, {} seen; the first one alone: {}",
                    moves.len(),
                    actual.moves.len(),
                    next.unwrap_or(&Value::Null)
                ));
            }
        }
        all
    }

    /// Rewrites the values in the expectation files by those of `actual`. The files of a new
    /// case get the usual fields.
    fn update(&self, folder: &Path, actual: &PathResult) -> Result<(), String> {
        let mut fields = json!({"line": 0, "kind": 0, "x0": 0, "z0": 0, "x": 0, "z": 0});
        if actual.moves.iter().any(|it| !it["y"].is_null()) {
            fields = json!({"line": 0, "kind": 0, "x": 0, "y": 0, "z": 0});
        }
        if self.moves.is_some() || self.result.is_none() {
            let mut text = String::new();
            for (index, seen) in actual.moves.iter().enumerate() {
                let named = self.moves.as_ref().and_then(|moves| moves.get(index));
                text += &update_expectation(named.unwrap_or(&fields), seen).to_string();
                text.push('\n');
            }
            crate::write_expectation(folder, MOVES_FILE, &text)?;
        }
        let fields = json!({"end": 0, "alarm": 0, "parts": 0, "final": 0});
        let result = update_expectation(self.result.as_ref().unwrap_or(&fields), &actual.result);
        let text = serde_json::to_string_pretty(&result).map_err(|error| error.to_string())?;
        crate::write_expectation(folder, RESULT_FILE, &(text + "\n"))
    }
}
