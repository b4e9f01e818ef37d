//! Parses the settings in the first line of an input and makes a set-up from them.

use gsk_core::command::ProgramId;
use gsk_core::memory::ToolOffset;
use gsk_core::model::{ControlModel, ModelId};
use gsk_core::program::split_programs;
use gsk_core::setup::Setup;

/// Returns a set-up with the settings in the text, in which the program of the text is
/// selected. Its further O numbers are stored as subprograms.
pub(super) fn setup_from_input(text: &str) -> Setup {
    let mut setup = Setup {
        spindle_rpm: Some(500.0),
        ..Setup::default()
    };
    for setting in setting_words(text) {
        // A refused setting is not made.
        let _ = apply_setting(&mut setup, setting);
    }
    let mut programs = split_programs(text).into_iter();
    let Some(first) = programs.next() else {
        return setup;
    };
    for program in programs {
        let _ = setup.memory.programs.store(program.text());
    }
    setup.memory.programs.open_external(first);
    setup.memory.programs.select(ProgramId::External);
    setup
}

fn setting_words(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .next()
        .and_then(|line| line.strip_prefix("(SET "))
        .and_then(|line| line.split(')').next())
        .unwrap_or("")
        .split_whitespace()
}

/// Returns those settings of the text that consist of a number and a value: `13=1`.
pub(super) fn numeric_settings(text: &str) -> impl Iterator<Item = (u16, i32)> {
    setting_words(text).filter_map(|setting| {
        let (number, value) = setting.split_once('=')?;
        Some((number.parse().ok()?, value.parse().ok()?))
    })
}

fn apply_setting(setup: &mut Setup, setting: &str) -> Option<()> {
    let (what, value) = setting.split_once('=')?;
    if let Some(offset) = what.strip_prefix('T') {
        let number: u8 = offset.parse().ok()?;
        let (r, t) = value.split_once('/')?;
        let offset = ToolOffset {
            r: r.parse().ok()?,
            t: t.parse().ok()?,
            ..setup.memory.offsets.get(number)
        };
        return setup.memory.offsets.set(number, offset).ok();
    }
    match what.split_once('.') {
        Some((number, bit)) => {
            let (number, bit) = (number.parse().ok()?, bit.parse().ok()?);
            setup
                .memory
                .parameters
                .set_bit(number, bit, value == "1")
                .ok()
        }
        None if what == "M" => {
            let id = ModelId::from_command_word(value).filter(|id| !id.is_mill())?;
            setup.memory.model = ControlModel::new(id);
            Some(())
        }
        None if what == "B" => {
            setup.memory.settings.macro_b = value == "1";
            Some(())
        }
        None => {
            let number = what.parse().ok()?;
            setup
                .memory
                .parameters
                .set(number, value.parse().ok()?)
                .ok()
        }
    }
}
