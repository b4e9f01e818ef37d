//! `case.ron`: the programs or the script of a case, and its set-up.

use std::path::Path;

use serde::Deserialize;

use crate::setup::SetupWords;

/// A test case as its `case.ron` defines it.
#[derive(Clone, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TestCase {
    /// Files of the part programs. The first program is executed, the others are subprograms.
    pub programs: Vec<String>,
    /// File of an operator script that is run instead of programs; `None` for a case with
    /// programs.
    pub script: Option<String>,
    /// Whether the programs are interpreted, run by the kernel, or both (the default).
    pub paths: Vec<ProgramPath>,
    /// Whether a partner is connected to the serial port of the control.
    pub partner: bool,
    /// Initial state of control and lathe, as set-up words.
    pub setup: SetupWords,
    /// Difference up to which two times count as equal, s.
    pub time_tolerance: f64,
    /// Why the case is known to fail; it must fail then. `None` for a case that must pass.
    pub known_failure: Option<String>,
}

/// How a program is executed: by interpretation alone or by the full kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum ProgramPath {
    /// The preview interprets the program, as in `check`.
    Check,
    /// The kernel runs every tick, with PLC and simulated lathe, as in `run`.
    Run,
}

impl ProgramPath {
    /// Returns the name of the path in messages: `check` or `run`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Check => "check",
            Self::Run => "run",
        }
    }
}

impl Default for TestCase {
    fn default() -> Self {
        Self {
            programs: Vec::new(),
            script: None,
            partner: false,
            paths: vec![ProgramPath::Check, ProgramPath::Run],
            setup: SetupWords::default(),
            time_tolerance: 0.002,
            known_failure: None,
        }
    }
}

impl TestCase {
    /// Reads and parses the `case.ron` of a case's folder.
    ///
    /// # Errors
    /// Returns a message if the file is missing or invalid.
    pub fn read(folder: &Path) -> Result<Self, String> {
        let text = crate::read_case_file(folder, "case.ron")?;
        let options = ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
        let case: Self = options
            .from_str(&text)
            .map_err(|error| format!("case.ron: {error}"))?;
        if case.script.is_none() && case.programs.is_empty() {
            return Err("case.ron: names neither programs nor a script".to_owned());
        }
        Ok(case)
    }
}
