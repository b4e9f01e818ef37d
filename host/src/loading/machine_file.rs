//! Reads machine files, and sets the parameters that they list.

use std::path::Path;

use gsk_core::machine::{ConfigError, LatheConfig};
use gsk_core::memory::{ControlParameters, parameter};
use gsk_core::setup::Setup;
use gsk_core::units::{NonFinite, find_non_finite};
use gsk_messages::{Message, say};

use super::{LoadError, apply_parameter};
use crate::files::program_file;
use crate::setup_args::parse_parameter;

/// A lathe whose machine file is part of the program.
#[derive(Debug)]
pub struct ShippedLathe {
    /// The word that `--machine` takes in place of a path.
    pub word: &'static str,
    /// Its name in a list.
    pub name: fn() -> Message,
    text: &'static str,
}

/// The shipped lathes that need no ladder of their own, in the order of the list.
pub static SHIPPED_LATHES: [ShippedLathe; 3] = [
    ShippedLathe {
        word: "small-flat-bed",
        name: say::first_lathe_flat_bed,
        text: include_str!("../../../assets/machines/small-flat-bed.ron"),
    },
    ShippedLathe {
        word: "slant-bed",
        name: say::first_lathe_slant_bed,
        text: include_str!("../../../assets/machines/slant-bed.ron"),
    },
    ShippedLathe {
        word: "bench-lathe",
        name: say::first_lathe_bench,
        text: include_str!("../../../assets/machines/bench-lathe.ron"),
    },
];

/// Reads a machine file (`docs/machine-file.md`), or takes the shipped lathe of this name if there
/// is no such file, and checks its rules. Returns an error if it cannot be read or breaks a rule.
pub fn load_machine(path: &Path) -> Result<LatheConfig, LoadError> {
    let mut shipped = SHIPPED_LATHES.iter().filter(|_| !path.exists());
    match shipped.find(|lathe| path == Path::new(lathe.word)) {
        Some(lathe) => parse_machine(path, lathe.text),
        None => parse_machine(path, &program_file::read(path)?.text),
    }
}

/// Parses the text of a machine file and checks its rules; `path` is for error messages only.
pub fn parse_machine(path: &Path, text: &str) -> Result<LatheConfig, LoadError> {
    if let Some(NonFinite { line, token }) = find_non_finite(text) {
        return Err(LoadError::MachineNumber {
            path: path.to_owned(),
            line,
            token,
        });
    }
    let options =
        ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    let config: LatheConfig = options.from_str(text).map_err(|error| LoadError::Machine {
        path: path.to_owned(),
        line: error.span.start.line,
        error: Box::new(error.code),
    })?;
    let mut trial = Setup::default();
    for word in &config.parameters {
        set_machine_parameter(&mut trial, word).map_err(|error| LoadError::InvalidLathe {
            path: path.to_owned(),
            rules: vec![error.message()],
        })?;
    }
    config.check().map_err(|errors| {
        let rules = errors.iter().map(ConfigError::message);
        LoadError::InvalidLathe {
            path: path.to_owned(),
            rules: rules.collect(),
        }
    })?;
    Ok(config)
}

/// Sets the parameters that the machine file lists, if those of the control are still as delivered.
pub(super) fn apply_machine_parameters(setup: &mut Setup) -> Result<(), LoadError> {
    // The parameters of other models have other meanings.
    if setup.memory.model.id().is_main() && is_as_delivered(setup) {
        setup.memory.parameters = with_machine_parameters(setup)?;
    }
    Ok(())
}

/// Parameters that the control writes: depths and passes of cycles, the station of the tool post.
const WRITTEN_BY_CONTROL: [u16; 7] = [
    parameter::ROUGHING_DEPTH,
    parameter::ROUGHING_RETRACT,
    parameter::PATTERN_RELIEF_X,
    parameter::PATTERN_RELIEF_Z,
    parameter::PATTERN_PASSES,
    parameter::PECKING_RETRACT,
    STATION,
];
/// The station of the tool post that is in position.
const STATION: u16 = 75;

/// Whether all parameters are those with which the model is delivered, with or without the chuck of
/// the training lathe, apart from those that the control writes.
fn is_as_delivered(setup: &Setup) -> bool {
    let plain = Setup::default();
    let mut of_model = plain.clone();
    of_model.memory.set_model(setup.memory.model.clone());
    let with_chuck = [plain.clone().with_chuck(), of_model.clone().with_chuck()];
    let now = &setup.memory.parameters;
    [plain, of_model]
        .into_iter()
        .chain(with_chuck)
        .any(|delivered| {
            let mut parameters = delivered.memory.parameters;
            for number in WRITTEN_BY_CONTROL {
                // A value out of its range is no delivered one: the comparison fails.
                let _ = parameters.set(number, now.value(number));
            }
            parameters == *now
        })
}

/// Returns the parameters of the control with those that its machine file lists.
fn with_machine_parameters(setup: &Setup) -> Result<ControlParameters, LoadError> {
    let mut changed = setup.clone();
    for word in &setup.lathe.parameters {
        set_machine_parameter(&mut changed, word)?;
    }
    Ok(changed.memory.parameters)
}

/// Sets a parameter that a machine file lists. Returns an error that names its text.
fn set_machine_parameter(setup: &mut Setup, word: &str) -> Result<(), LoadError> {
    let refused = |reason| LoadError::MachineParameter {
        word: word.to_owned(),
        reason,
    };
    let parameter = parse_parameter(word).map_err(|error| refused(error.message()))?;
    apply_parameter(setup, parameter).map_err(|error| match error {
        LoadError::Parameter(error) => refused(error.message()),
        other => other,
    })
}

/// Returns the parameters that the lathe needs and the control has otherwise, as the machine file
/// lists them; `None` if there are none.
pub fn missing_machine_parameters(setup: &Setup) -> Option<String> {
    let differs = |word: &&String| {
        let mut changed = setup.clone();
        changed.lathe.parameters = vec![(*word).clone()];
        let needed = with_machine_parameters(&changed);
        needed.is_ok_and(|needed| needed != setup.memory.parameters)
    };
    let missing: Vec<&str> = setup
        .lathe
        .parameters
        .iter()
        .filter(differs)
        .map(String::as_str)
        .collect();
    (setup.memory.model.id().is_main() && !missing.is_empty()).then(|| missing.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_messages::Language;

    #[test]
    fn a_wrong_parameter_is_named_with_its_rule() {
        for word in ["84", "8.9=1", "84=999999", "22=-5"] {
            let text = format!("(parameters: [\"{word}\"])");
            let error = parse_machine(Path::new("lathe.ron"), &text).expect_err(word);
            let message = error.message().text(Language::En);
            let names_all = message.contains("lathe.ron") && message.contains(word);
            assert!(names_all && !message.contains("--param"), "{message}");
        }
    }
}
