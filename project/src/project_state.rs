//! Stores the retained data of a control and lists it as one value for each key.

use std::collections::BTreeMap;
use std::sync::Arc;

use gsk_core::battery::BatteryMemory;
use gsk_core::command::ProgramId;
use gsk_core::memory::{
    Authority, ControlParameters, Counters, OFFSET_ROWS, Offsets, PitchTable, Variables,
    parameter_rows,
};
use gsk_core::model::ControlModel;
use gsk_core::plc::{Area, ByteAddress, Ladder, Plc, RetainedMemory};
use gsk_core::setup::Setup;
use gsk_core::units::Axis;
use gsk_panel::panel::PanelRetained;

use crate::key::{
    DataSet, OffsetColumn, PanelSetting, ProjectCounter, ProjectKey, RETAINED_AREAS, SettingSwitch,
};
use crate::value::ProjectValue;

/// Version of the folder format.
pub(crate) const FORMAT_VERSION: i64 = 1;

/// Variables that only macro B has and that are retained over power-off (manual III-11).
pub(crate) const RETAINED_MACRO_B_VARIABLES: core::ops::RangeInclusive<u16> = 500..=999;

/// Returns whether a project stores this macro variable: all of macro A, and those of macro B
/// that are retained over power-off (500 to 999).
pub fn is_retained_variable(variable: u16) -> bool {
    Variables::has_integer(variable) || RETAINED_MACRO_B_VARIABLES.contains(&variable)
}

/// The data of a control that a project stores: battery memory, ladder, PLC data, panel
/// settings, and for a folder the machine file and jobs. Operation level, passwords and slide
/// positions are not stored.
#[derive(Clone, Debug)]
pub struct ProjectState {
    memory: BatteryMemory,
    retained: RetainedMemory,
    ladder: Arc<Ladder>,
    panel: Option<PanelRetained>,
    /// Texts of machine file and jobs; `None` for a control, which stores no such files.
    texts: Option<BTreeMap<ProjectKey, Arc<str>>>,
}

/// States are equal if all their values are equal, bit by bit.
impl PartialEq for ProjectState {
    fn eq(&self, other: &Self) -> bool {
        self.entries() == other.entries()
    }
}

impl ProjectState {
    /// Creates the project state of a control. Without `retained` the PLC data are the start
    /// values of the ladder. `panel` is `None` if the panel has never been opened. Values that
    /// are lost at power-off, the operation level and the passwords are dropped.
    pub fn new(
        memory: &BatteryMemory,
        retained: Option<&RetainedMemory>,
        ladder: Arc<Ladder>,
        panel: Option<PanelRetained>,
    ) -> Self {
        let mut memory = memory.clone();
        memory.authority = Authority::default();
        memory.variables.power_on();
        memory.counters = Counters {
            parts: memory.counters.parts % Counters::PART_COUNT_LIMIT,
            cutting_ms: memory.counters.cutting_ms % Counters::CUTTING_LIMIT_MS,
            required: memory.counters.required % Counters::REQUIRED_PARTS_LIMIT,
            started_ms: memory.counters.started_ms % Counters::STARTED_LIMIT_MS,
        };
        memory.model = drop_delivered_values(&memory.model);
        memory.programs = memory.programs.retained();
        let first = memory.programs.iter().next().map(|(number, _)| number);
        if let (None, Some(first)) = (memory.programs.selected(), first) {
            memory.programs.select(ProgramId::Stored(first));
        }
        // A directory of an older version may lack some areas.
        let mut plc = Plc::new(Arc::clone(&ladder));
        if let Some(retained) = retained {
            plc.memory_mut().restore_retained(retained);
        }
        Self {
            memory,
            retained: plc.memory().retained(),
            ladder,
            panel,
            texts: None,
        }
    }

    /// Creates the project state of a control that starts with this set-up.
    pub fn from_setup(setup: &Setup) -> Self {
        let retained = setup.plc_retained.as_ref();
        Self::new(&setup.memory, retained, setup.ladder.compiled(), None)
    }

    /// Returns the state with these panel settings; `None` removes them.
    #[must_use]
    pub fn with_panel(self, panel: Option<PanelRetained>) -> Self {
        Self { panel, ..self }
    }

    /// Returns the state with the texts of the machine file and of jobs; other keys are ignored.
    #[must_use]
    pub fn with_texts(mut self, texts: impl IntoIterator<Item = (ProjectKey, Arc<str>)>) -> Self {
        let texts = texts.into_iter();
        let texts =
            texts.filter(|(key, _)| matches!(key, ProjectKey::Job(_) | ProjectKey::Machine));
        self.texts = Some(texts.collect());
        self
    }

    /// Returns the state without machine file and jobs, as a control has it.
    #[must_use]
    pub fn without_texts(self) -> Self {
        Self {
            texts: None,
            ..self
        }
    }

    /// Returns the battery memory. Its operation level and passwords are those of delivery.
    pub const fn memory(&self) -> &BatteryMemory {
        &self.memory
    }

    /// Returns the PLC data that are retained over power-off.
    pub const fn retained(&self) -> &RetainedMemory {
        &self.retained
    }

    /// Returns the compiled ladder of the project.
    pub const fn ladder(&self) -> &Arc<Ladder> {
        &self.ladder
    }

    /// Returns the panel settings; `None` if the panel has never been opened.
    pub const fn panel(&self) -> Option<PanelRetained> {
        self.panel
    }

    /// Returns the texts of machine file and jobs; `None` for a control, which stores no such
    /// files.
    pub const fn texts(&self) -> Option<&BTreeMap<ProjectKey, Arc<str>>> {
        self.texts.as_ref()
    }

    /// Returns every value of the project by its key.
    pub fn entries(&self) -> BTreeMap<ProjectKey, ProjectValue> {
        let memory = &self.memory;
        let mut entries = BTreeMap::new();
        entries.insert(ProjectKey::Format, ProjectValue::Whole(FORMAT_VERSION));
        entries.insert(ProjectKey::Model, ProjectValue::Model(memory.model.id()));
        for (number, parameter) in memory.model.record().parameters() {
            let value = memory.model.parameter(*number);
            // Folders of the GSK980TD from older versions have no model parameters.
            if memory.model.is_main() && value == parameter.delivered {
                continue;
            }
            entries.insert(
                ProjectKey::ModelParameter(*number),
                ProjectValue::Whole(value.into()),
            );
        }
        let settings = &memory.settings;
        for (switch, _) in SettingSwitch::ALL {
            let on = match switch {
                SettingSwitch::MacroB => settings.macro_b,
                SettingSwitch::Parity => settings.parity,
                SettingSwitch::Iso => settings.iso,
                SettingSwitch::Inch => settings.inch,
                SettingSwitch::Numbering => settings.numbering,
            };
            entries.insert(ProjectKey::Setting(switch), ProjectValue::Switch(on));
        }
        let selected = match memory.programs.selected() {
            Some(ProgramId::Stored(number)) => Some(number),
            _ => None,
        };
        entries.insert(ProjectKey::Selected, ProjectValue::Selected(selected));
        for (number, program) in memory.programs.iter() {
            entries.insert(
                ProjectKey::Program(number),
                ProjectValue::Text(program.text().into()),
            );
        }
        let tables = (&memory.parameters, &memory.offsets, &memory.pitch);
        insert_set(&mut entries, DataSet::Control, tables);
        for (set, disk, _) in DataSet::DISKS {
            if let Some(content) = memory.disks.saved(disk) {
                let tables = (&content.parameters, &content.offsets, &content.pitch);
                insert_set(&mut entries, set, tables);
            }
        }
        for number in Variables::numbers().chain(RETAINED_MACRO_B_VARIABLES) {
            if let Some(value) = memory.variables.real_value(number) {
                entries.insert(ProjectKey::Variable(number), ProjectValue::Real(value));
            }
        }
        for (count, _) in ProjectCounter::ALL {
            let value = match count {
                ProjectCounter::Parts => memory.counters.parts.into(),
                ProjectCounter::CuttingMs => memory.counters.cutting_ms as i64,
                ProjectCounter::Required => memory.counters.required.into(),
                ProjectCounter::StartedMs => memory.counters.started_ms as i64,
            };
            if value == 0 && count.is_optional() {
                continue;
            }
            entries.insert(ProjectKey::Counter(count), ProjectValue::Whole(value));
        }
        insert_plc_data(&mut entries, &self.retained);
        if let Some(panel) = &self.panel {
            insert_panel_settings(&mut entries, panel);
        }
        entries.insert(
            ProjectKey::Ladder,
            ProjectValue::Text(self.ladder.source().into()),
        );
        for (key, text) in self.texts.iter().flatten() {
            entries.insert(*key, ProjectValue::Text(Arc::clone(text)));
        }
        entries
    }
}

/// Returns a copy of a model without parameters that are at their delivered value: such
/// parameters compare as unset.
fn drop_delivered_values(model: &ControlModel) -> ControlModel {
    let mut changed = ControlModel::new(model.id());
    for (number, parameter) in model.record().parameters() {
        let value = model.parameter(*number);
        if value != parameter.delivered {
            // Cannot fail: the value comes from the same model.
            let _ = changed.set_parameter(*number, value);
        }
    }
    changed
}

fn insert_set(
    entries: &mut BTreeMap<ProjectKey, ProjectValue>,
    set: DataSet,
    (parameters, offsets, pitch): (&ControlParameters, &Offsets, &PitchTable),
) {
    for row in parameter_rows().iter().filter(|row| row.bit.is_none()) {
        let number = row.number;
        if row.state {
            for bit in 0..8 {
                let on = i64::from(parameters.bit(number, bit));
                entries.insert(
                    ProjectKey::Parameter(set, number, Some(bit)),
                    ProjectValue::Whole(on),
                );
            }
        } else {
            let value = parameters.value(number).into();
            entries.insert(
                ProjectKey::Parameter(set, number, None),
                ProjectValue::Whole(value),
            );
        }
    }
    for (number, offset) in offsets.iter().take(OFFSET_ROWS) {
        for (word, _) in OffsetColumn::ALL {
            let value = match word {
                OffsetColumn::X => ProjectValue::Real(offset.x),
                OffsetColumn::Z => ProjectValue::Real(offset.z),
                OffsetColumn::R => ProjectValue::Real(offset.r),
                OffsetColumn::T => ProjectValue::Whole(offset.t.into()),
            };
            entries.insert(ProjectKey::Offset(set, number, word), value);
        }
    }
    for point in 0..=u8::MAX {
        for axis in [Axis::X, Axis::Z] {
            let value = pitch.value(axis, point).into();
            entries.insert(
                ProjectKey::Pitch(set, point, axis),
                ProjectValue::Whole(value),
            );
        }
    }
}

fn insert_plc_data(entries: &mut BTreeMap<ProjectKey, ProjectValue>, retained: &RetainedMemory) {
    for (area, first) in RETAINED_AREAS {
        let values: Vec<i64> = match area {
            Area::K => retained.k.iter().map(|it| (*it).into()).collect(),
            Area::D => retained.d300.iter().map(|it| (*it).into()).collect(),
            Area::T => retained.t80.iter().map(|it| (*it).into()).collect(),
            Area::C => retained.c.iter().map(|it| (*it).into()).collect(),
            Area::Dc => retained.dc.iter().map(|it| (*it).into()).collect(),
            _ => retained.dt.iter().map(|it| (*it).into()).collect(),
        };
        for (byte, value) in (first..area.count()).zip(values) {
            let key = ProjectKey::Data(ByteAddress::new(area, byte));
            entries.insert(key, ProjectValue::Whole(value));
        }
    }
}

fn insert_panel_settings(entries: &mut BTreeMap<ProjectKey, ProjectValue>, panel: &PanelRetained) {
    let graphic = &panel.graphic;
    for (word, _) in PanelSetting::ALL {
        let value = match word {
            PanelSetting::Brightness => ProjectValue::Whole(panel.brightness.into()),
            PanelSetting::Zx => ProjectValue::Switch(graphic.zx),
            PanelSetting::Scale => ProjectValue::Whole(graphic.scale.into()),
            PanelSetting::CenterX => ProjectValue::Whole(graphic.center_x.into()),
            PanelSetting::CenterZ => ProjectValue::Whole(graphic.center_z.into()),
            PanelSetting::MaxX => ProjectValue::Whole(graphic.max_x.into()),
            PanelSetting::MaxZ => ProjectValue::Whole(graphic.max_z.into()),
            PanelSetting::MinX => ProjectValue::Whole(graphic.min_x.into()),
            PanelSetting::MinZ => ProjectValue::Whole(graphic.min_z.into()),
            PanelSetting::Drawing => ProjectValue::Switch(graphic.drawing),
        };
        entries.insert(ProjectKey::Panel(word), value);
    }
}
