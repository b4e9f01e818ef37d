//! What a value is called.

use gsk_core::memory::{self, ParameterRow, Refusal};
use gsk_core::model::ModelId;
use gsk_core::plc::{Ladder, PlcAddress};
use gsk_core::units::Axis;
use gsk_messages::{Language, Message, say};

use crate::key::{Count, Key, OffsetWord, PanelWord, Set, Switch, Table, name_of};
use crate::state::State;

const fn by(language: Language, zh: &'static str, en: &'static str) -> &'static str {
    match language {
        Language::Zh => zh,
        Language::En => en,
    }
}

/// The first lines of a file: what stands in it.
pub(crate) fn heading(table: Table, language: Language) -> String {
    let said = match table {
        Table::Head => say::project_heading(),
        Table::ModelParameters => say::project_heading_model(),
        Table::Parameters(_) => say::project_heading_parameters(),
        Table::Offsets(_) => say::project_heading_offsets(),
        Table::Pitch(_) => say::project_heading_pitch(),
        Table::Variables => say::project_heading_variables(),
        Table::Counters => say::project_heading_counters(),
        Table::Panel => say::project_heading_panel(),
        Table::Data => say::project_heading_data(),
    };
    format!("; {}\n", said.text(language))
}

/// What stands as a remark behind a value.
pub(crate) fn remark(key: Key, state: &State, language: Language) -> String {
    match key {
        Key::Parameter(..) | Key::ModelParameter(_) => {
            let name = parameter_name(key, state.memory().model.id(), language);
            let unit = unit(key, state.memory().model.id());
            [name.as_str(), unit].join(" ").trim_end().to_owned()
        }
        Key::Data(_) => comment(key, state.ladder(), language),
        Key::Switch(_) | Key::Count(_) | Key::Panel(_) | Key::Model | Key::Selected => {
            label(key, state, language)
        }
        _ => String::new(),
    }
}

fn row(key: Key) -> Option<&'static ParameterRow> {
    match key {
        Key::Parameter(_, number, bit) => memory::row(number, bit),
        _ => None,
    }
}

/// The unit of a value; empty where it has none, or is not known by that.
pub fn unit(key: Key, model: ModelId) -> &'static str {
    match key {
        Key::Parameter(..) => row(key).map_or("", |row| row.unit),
        Key::ModelParameter(number) => {
            let own = model.record().parameters.get(&number);
            own.map_or("", |own| own.unit.as_str())
        }
        Key::Offset(_, _, OffsetWord::T) => "",
        Key::Offset(..) => "mm",
        Key::Pitch(..) => "µm",
        _ => "",
    }
}

fn parameter_name(key: Key, model: ModelId, language: Language) -> String {
    if let Key::ModelParameter(number) = key {
        let own = model.record().parameters.get(&number);
        return own.map_or("", |own| own.name(language)).to_owned();
    }
    let Some(row) = row(key) else {
        return String::new();
    };
    by(language, row.meaning_zh, row.meaning_en).to_owned()
}

/// The comment that the ladder has for an address of what the PLC keeps.
fn comment(key: Key, ladder: &Ladder, language: Language) -> String {
    let Key::Data(address) = key else {
        return String::new();
    };
    let comment = ladder.comment(PlcAddress::Byte(address));
    comment.map_or_else(String::new, |comment| match language {
        Language::Zh => comment.chinese.clone(),
        Language::En => comment.english.clone(),
    })
}

/// What a value is called, with its number: `No.022 X rapid rate`. The name of an address
/// of the PLC comes from the ladder of `state`.
pub fn label(key: Key, state: &State, language: Language) -> String {
    let said: Message = match key {
        Key::Format => say::project_of_format(),
        Key::Model => say::project_of_model(),
        Key::Selected => say::project_of_selected(),
        Key::Switch(switch) => match switch {
            Switch::MacroB => say::project_of_macro_b(),
            Switch::Parity => say::project_of_parity(),
            Switch::Iso => say::project_of_iso(),
            Switch::Inch => say::project_of_inch(),
            Switch::Numbering => say::project_of_numbering(),
        },
        Key::ModelParameter(_) | Key::Parameter(..) => {
            let name = parameter_name(key, state.memory().model.id(), language);
            return on_disk(key, format!("No.{} {name}", key.name()), language);
        }
        Key::Offset(_, row, word) => {
            say::project_of_offset(format_args!("{row:03}"), name_of(&OffsetWord::ALL, word))
        }
        Key::Pitch(_, point, axis) => {
            let axis = match axis {
                Axis::X => "X",
                Axis::Z => "Z",
            };
            say::project_of_pitch(format_args!("{point:03}"), axis)
        }
        Key::Count(Count::Parts) => say::project_of_parts(),
        Key::Count(Count::CuttingMs) => say::project_of_cutting_time(),
        Key::Count(Count::Required) => say::project_of_required_parts(),
        Key::Count(Count::StartedMs) => say::project_of_started_time(),
        Key::Panel(word) => match word {
            PanelWord::Brightness => say::project_of_brightness(),
            PanelWord::Zx => say::project_of_zx(),
            PanelWord::Scale => say::project_of_scale(),
            PanelWord::CenterX => say::project_of_center("X"),
            PanelWord::CenterZ => say::project_of_center("Z"),
            PanelWord::MaxX => say::project_of_max("X"),
            PanelWord::MaxZ => say::project_of_max("Z"),
            PanelWord::MinX => say::project_of_min("X"),
            PanelWord::MinZ => say::project_of_min("Z"),
            PanelWord::Drawing => say::project_of_drawing(),
        },
        Key::Data(address) => {
            let name = format!("{address} {}", comment(key, state.ladder(), language));
            return name.trim_end().to_owned();
        }
        Key::Ladder => say::project_of_ladder(),
        Key::Program(number) => return format!("O{number:04}"),
        Key::Job(number) => say::project_of_job(number),
        Key::Machine => say::project_of_machine(),
        Key::Variable(_) => return key.name(),
    };
    on_disk(key, said.text(language), language)
}

/// With the name of the electronic disk that it was saved on.
fn on_disk(key: Key, what: String, language: Language) -> String {
    let set = match key {
        Key::Parameter(set, ..) | Key::Offset(set, ..) | Key::Pitch(set, ..) => set,
        _ => Set::Control,
    };
    match set.disk() {
        Some(disk) => say::project_on_disk(disk, what).text(language),
        None => what,
    }
}

/// Why the control refuses a value.
pub fn refused(refusal: Refusal) -> Message {
    match refusal {
        Refusal::Mode => say::request_needs_mdi(),
        Refusal::Running => say::request_while_running(),
        Refusal::Alarm => say::request_in_alarm(),
        Refusal::ParameterSwitch => say::request_parameter_switch_off(),
        Refusal::ProgramSwitch => say::request_program_switch_off(),
        Refusal::Level => say::level_too_low(),
        Refusal::Locked => say::request_locked(),
    }
}
