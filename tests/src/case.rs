//! `case.ron`: the programs or the script of a case, and its set-up.

use std::path::Path;

use serde::Deserialize;

use crate::setup::SetupWords;

/// A case as defined by its `case.ron`.
#[derive(Clone, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TestCase {
    /// Part programs; the first one is executed, the others are subprograms.
    pub programs: Vec<String>,
    /// An operator script instead of programs.
    pub script: Option<String>,
    /// The execution paths of a program; both by default.
    pub paths: Vec<ProgramPath>,
    /// Whether a partner is connected to the serial port.
    pub partner: bool,
    /// Initial state of control and lathe.
    pub setup: SetupWords,
    /// Tolerance of times, s.
    pub time_tolerance: f64,
    /// Why the case is known to fail; it must fail then.
    pub known_failure: Option<String>,
}

/// The way a program is executed: interpretation alone or the full kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum ProgramPath {
    /// The preview, as in `check`.
    Check,
    /// Every tick, with PLC and simulated lathe, as in `run`.
    Run,
}

impl ProgramPath {
    /// Its name in messages.
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
    /// Reads the `case.ron` of a folder.
    ///
    /// # Errors
    /// The file is missing or invalid.
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
