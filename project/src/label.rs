//! Names, units and file comments of project values, in both languages.

use gsk_core::memory::{self, ParameterRow, WriteRefusal};
use gsk_core::model::ModelId;
use gsk_core::plc::{Ladder, PlcAddress};
use gsk_core::units::Axis;
use gsk_messages::{Language, Message, say};

use crate::key::{
    DataSet, OffsetColumn, PanelSetting, ProjectCounter, ProjectKey, ProjectTable, SettingSwitch,
    find_name,
};
use crate::project_state::ProjectState;

const fn localized(language: Language, zh: &'static str, en: &'static str) -> &'static str {
    match language {
        Language::Zh => zh,
        Language::En => en,
    }
}

/// Returns the comment line at the top of a table's file, with its line end.
pub(crate) fn file_heading(table: ProjectTable, language: Language) -> String {
    let heading = match table {
        ProjectTable::Head => say::project_heading(),
        ProjectTable::ModelParameters => say::project_heading_model(),
        ProjectTable::Parameters(_) => say::project_heading_parameters(),
        ProjectTable::Offsets(_) => say::project_heading_offsets(),
        ProjectTable::Pitch(_) => say::project_heading_pitch(),
        ProjectTable::Variables => say::project_heading_variables(),
        ProjectTable::Counters => say::project_heading_counters(),
        ProjectTable::Panel => say::project_heading_panel(),
        ProjectTable::Data => say::project_heading_data(),
    };
    format!("; {}\n", heading.text(language))
}

/// Returns the comment after a key's value in its file; empty for none.
pub(crate) fn line_comment(key: ProjectKey, state: &ProjectState, language: Language) -> String {
    match key {
        ProjectKey::Parameter(..) | ProjectKey::ModelParameter(_) => {
            let name = parameter_name(key, state.memory().model.id(), language);
            let unit = unit(key, state.memory().model.id());
            [name.as_str(), unit].join(" ").trim_end().to_owned()
        }
        ProjectKey::Data(_) => ladder_comment(key, state.ladder(), language),
        ProjectKey::Setting(_)
        | ProjectKey::Counter(_)
        | ProjectKey::Panel(_)
        | ProjectKey::Model
        | ProjectKey::Selected => label(key, state, language),
        _ => String::new(),
    }
}

fn parameter_row(key: ProjectKey) -> Option<&'static ParameterRow> {
    match key {
        ProjectKey::Parameter(_, number, bit) => memory::parameter_row(number, bit),
        _ => None,
    }
}

/// Returns the unit of a key's value (`mm`, `µm`, `mm/min`); empty for a value without a unit.
pub fn unit(key: ProjectKey, model: ModelId) -> &'static str {
    match key {
        ProjectKey::Parameter(..) => parameter_row(key).map_or("", |row| row.unit),
        ProjectKey::ModelParameter(number) => {
            let parameter = model.record().parameters().get(&number);
            parameter.map_or("", |parameter| parameter.unit.as_str())
        }
        ProjectKey::Offset(_, _, OffsetColumn::T) => "",
        ProjectKey::Offset(..) => "mm",
        ProjectKey::Pitch(..) => "µm",
        _ => "",
    }
}

fn parameter_name(key: ProjectKey, model: ModelId, language: Language) -> String {
    if let ProjectKey::ModelParameter(number) = key {
        let parameter = model.record().parameters().get(&number);
        return parameter
            .map_or("", |parameter| parameter.name(language))
            .to_owned();
    }
    let Some(row) = parameter_row(key) else {
        return String::new();
    };
    localized(language, row.meaning_zh, row.meaning_en).to_owned()
}

fn ladder_comment(key: ProjectKey, ladder: &Ladder, language: Language) -> String {
    let ProjectKey::Data(address) = key else {
        return String::new();
    };
    let comment = ladder.comment(PlcAddress::Byte(address));
    comment.map_or_else(String::new, |comment| match language {
        Language::Zh => comment.chinese.clone(),
        Language::En => comment.english.clone(),
    })
}

/// Returns the display name of a key's value with its number: `No.022 X rapid rate`. The name
/// of a PLC address is its comment in the ladder of `state`.
pub fn label(key: ProjectKey, state: &ProjectState, language: Language) -> String {
    let name: Message = match key {
        ProjectKey::Format => say::project_of_format(),
        ProjectKey::Model => say::project_of_model(),
        ProjectKey::Selected => say::project_of_selected(),
        ProjectKey::Setting(switch) => match switch {
            SettingSwitch::MacroB => say::project_of_macro_b(),
            SettingSwitch::Parity => say::project_of_parity(),
            SettingSwitch::Iso => say::project_of_iso(),
            SettingSwitch::Inch => say::project_of_inch(),
            SettingSwitch::Numbering => say::project_of_numbering(),
        },
        ProjectKey::ModelParameter(_) | ProjectKey::Parameter(..) => {
            let name = parameter_name(key, state.memory().model.id(), language);
            return with_disk_name(key, format!("No.{} {name}", key.name()), language);
        }
        ProjectKey::Offset(_, row, word) => say::project_of_offset(
            format_args!("{row:03}"),
            find_name(&OffsetColumn::ALL, word),
        ),
        ProjectKey::Pitch(_, point, axis) => {
            let axis = match axis {
                Axis::X => "X",
                Axis::Z => "Z",
            };
            say::project_of_pitch(format_args!("{point:03}"), axis)
        }
        ProjectKey::Counter(ProjectCounter::Parts) => say::project_of_parts(),
        ProjectKey::Counter(ProjectCounter::CuttingMs) => say::project_of_cutting_time(),
        ProjectKey::Counter(ProjectCounter::Required) => say::project_of_required_parts(),
        ProjectKey::Counter(ProjectCounter::StartedMs) => say::project_of_started_time(),
        ProjectKey::Panel(word) => match word {
            PanelSetting::Brightness => say::project_of_brightness(),
            PanelSetting::Zx => say::project_of_zx(),
            PanelSetting::Scale => say::project_of_scale(),
            PanelSetting::CenterX => say::project_of_center("X"),
            PanelSetting::CenterZ => say::project_of_center("Z"),
            PanelSetting::MaxX => say::project_of_max("X"),
            PanelSetting::MaxZ => say::project_of_max("Z"),
            PanelSetting::MinX => say::project_of_min("X"),
            PanelSetting::MinZ => say::project_of_min("Z"),
            PanelSetting::Drawing => say::project_of_drawing(),
        },
        ProjectKey::Data(address) => {
            let name = format!(
                "{address} {}",
                ladder_comment(key, state.ladder(), language)
            );
            return name.trim_end().to_owned();
        }
        ProjectKey::Ladder => say::project_of_ladder(),
        ProjectKey::Program(number) => return format!("O{number:04}"),
        ProjectKey::Job(number) => say::project_of_job(number),
        ProjectKey::Machine => say::project_of_machine(),
        ProjectKey::Variable(_) => return key.name(),
    };
    with_disk_name(key, name.text(language), language)
}

fn with_disk_name(key: ProjectKey, name: String, language: Language) -> String {
    let set = match key {
        ProjectKey::Parameter(set, ..)
        | ProjectKey::Offset(set, ..)
        | ProjectKey::Pitch(set, ..) => set,
        _ => DataSet::Control,
    };
    match set.disk_name() {
        Some(disk) => say::project_on_disk(disk, name).text(language),
        None => name,
    }
}

/// Returns the message that the control does not accept a value now, with the reason.
pub fn refusal_message(refusal: WriteRefusal) -> Message {
    match refusal {
        WriteRefusal::Mode => say::request_needs_mdi(),
        WriteRefusal::Running => say::request_while_running(),
        WriteRefusal::Alarm => say::request_in_alarm(),
        WriteRefusal::ParameterSwitch => say::request_parameter_switch_off(),
        WriteRefusal::ProgramSwitch => say::request_program_switch_off(),
        WriteRefusal::Level => say::level_too_low(),
        WriteRefusal::Locked => say::request_locked(),
    }
}
