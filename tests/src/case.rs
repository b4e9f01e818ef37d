//! `case.ron`: what a case runs and from which set-up.

use std::path::Path;

use serde::Deserialize;

use crate::setup::SetupWords;

/// A case as its `case.ron` says.
#[derive(Clone, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Case {
    /// Part programs; the first one is executed, the others are subprograms.
    pub programs: Vec<String>,
    /// An operator script instead of programs.
    pub script: Option<String>,
    /// Which paths a program takes; without it both.
    pub paths: Vec<ProgramPath>,
    /// Whether somebody listens at the serial port.
    pub partner: bool,
    /// What control and lathe start from.
    pub setup: SetupWords,
    /// How far times may be off, s.
    pub time_tolerance: f64,
    /// Why the case is known to fail today.
    pub known_failure: Option<String>,
}

/// A path through the program: interpretation alone or the full kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum ProgramPath {
    /// The preview, as `check` takes it.
    Check,
    /// Every tick, with PLC and simulated lathe, as `run` takes it.
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

impl Default for Case {
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

impl Case {
    /// Reads the `case.ron` of a folder.
    ///
    /// # Errors
    /// The file is missing or is no case.
    pub fn read(folder: &Path) -> Result<Self, String> {
        let text = crate::read(folder, "case.ron")?;
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
