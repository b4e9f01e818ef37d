//! Builds a project state from single values and checks each value as the control does.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use gsk_core::battery::BatteryMemory;
use gsk_core::command::ProgramId;
use gsk_core::memory::{
    ControlParameters, ControlSettings, Counters, DiskContent, Disks, OFFSET_ROWS, Offsets,
    PitchTable, ToolOffset, Variables, parameter_rows,
};
use gsk_core::model::{ControlModel, ModelId, ModelRecord};
use gsk_core::plc::{Area, ByteAddress, CompileErrors, Ladder, RetainedMemory};
use gsk_core::program::{Program, ProgramMemory};
use gsk_core::setup::standard_ladder;
use gsk_core::units::Axis;
use gsk_messages::{Message, say};
use gsk_panel::pages::{BRIGHTNESS_STEPS, GraphicSettings};
use gsk_panel::panel::PanelRetained;

use crate::key::{
    DataSet, OffsetColumn, PanelSetting, ProjectCounter, ProjectKey, RETAINED_AREAS, SettingSwitch,
};
use crate::project_state::{FORMAT_VERSION, ProjectState, RETAINED_MACRO_B_VARIABLES};
use crate::value::ProjectValue;

/// A value of a project that breaks a rule of the control, and the rule.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InvalidValue {
    /// Key of the invalid value.
    pub key: ProjectKey,
    /// Line of the fault in the ladder text, from 1; `None` for values that are not the
    /// ladder.
    pub line: Option<u32>,
    /// The message about the rule that the value breaks.
    pub rule: Message,
}

struct StateBuilder<'a> {
    remaining: BTreeMap<ProjectKey, &'a ProjectValue>,
    invalid: Vec<InvalidValue>,
}

/// Builds a project state from a value for each key.
///
/// # Errors
/// All invalid values, in the order of their keys: missing, out of range, or unknown to the
/// control.
pub fn build_state(
    entries: &BTreeMap<ProjectKey, ProjectValue>,
) -> Result<ProjectState, Vec<InvalidValue>> {
    let mut builder = StateBuilder {
        remaining: entries.iter().map(|(key, value)| (*key, value)).collect(),
        invalid: Vec::new(),
    };
    let state = builder.build();
    let unknown: Vec<ProjectKey> = builder.remaining.keys().copied().collect();
    for key in unknown {
        let rule = match key {
            ProjectKey::Parameter(_, number, bit) => unknown_parameter(number, bit),
            ProjectKey::Variable(number) => say::project_variable_unknown(number),
            _ => say::project_unknown(key.name()),
        };
        builder.report_invalid(key, rule);
    }
    if builder.invalid.is_empty() {
        return Ok(state);
    }
    builder.invalid.sort_by_key(|value| value.key);
    Err(builder.invalid)
}

fn unknown_parameter(number: u16, bit: Option<u8>) -> Message {
    match bit {
        Some(bit) => say::parameter_bit_unknown(number, bit),
        None => say::parameter_unknown(number),
    }
}

impl StateBuilder<'_> {
    fn report_invalid(&mut self, key: ProjectKey, rule: Message) {
        self.invalid.push(InvalidValue {
            key,
            line: None,
            rule,
        });
    }

    /// Removes and returns the value of a key; reports it and returns `None` if it is missing.
    fn take_required(&mut self, key: ProjectKey) -> Option<ProjectValue> {
        let value = self.remaining.remove(&key).cloned();
        if value.is_none() {
            self.report_invalid(key, say::project_missing(key.name()));
        }
        value
    }

    /// Removes and returns the integer of a key; reports it and returns 0 if it is missing or
    /// outside `range`.
    fn take_integer(&mut self, key: ProjectKey, range: core::ops::RangeInclusive<i64>) -> i64 {
        match self.take_required(key) {
            Some(ProjectValue::Whole(value)) if range.contains(&value) => value,
            Some(value) => {
                let rule = say::project_out_of_range(value, range.start(), range.end());
                self.report_invalid(key, rule);
                0
            }
            None => 0,
        }
    }

    fn take_switch(&mut self, key: ProjectKey) -> bool {
        match self.take_required(key) {
            Some(ProjectValue::Switch(on)) => on,
            Some(value) => {
                let rule = say::project_not_a_value(value, say::project_switch());
                self.report_invalid(key, rule);
                false
            }
            None => false,
        }
    }

    fn has_set(&self, set: DataSet) -> bool {
        self.remaining.keys().any(|key| match key {
            ProjectKey::Parameter(key_set, ..)
            | ProjectKey::Offset(key_set, ..)
            | ProjectKey::Pitch(key_set, ..) => *key_set == set,
            _ => false,
        })
    }

    fn build(&mut self) -> ProjectState {
        let _ = self.take_integer(ProjectKey::Format, FORMAT_VERSION..=FORMAT_VERSION);
        let model = self.build_model();
        let record = model.record();
        let active = self.build_set(DataSet::Control, record);
        let mut disks = Disks::default();
        for (set, disk, _) in DataSet::DISKS {
            if self.has_set(set) {
                let content = self.build_set(set, record);
                disks.save(disk, content);
            }
        }
        let memory = BatteryMemory {
            parameters: active.parameters,
            offsets: active.offsets,
            pitch: active.pitch,
            variables: self.build_variables(),
            settings: self.build_settings(),
            disks,
            programs: self.build_programs(),
            counters: self.build_counters(),
            model,
            ..BatteryMemory::default()
        };
        let retained = self.build_retained();
        let ladder = self.build_ladder();
        let panel = self.build_panel();
        let state = ProjectState::new(&memory, Some(&retained), ladder, panel);
        let texts: Vec<_> = self
            .remaining
            .extract_if(.., |key, _| {
                matches!(key, ProjectKey::Job(_) | ProjectKey::Machine)
            })
            .filter_map(|(key, value)| match value {
                ProjectValue::Text(text) => Some((key, Arc::clone(text))),
                _ => None,
            })
            .collect();
        state.with_texts(texts)
    }

    fn build_set(&mut self, set: DataSet, record: &ModelRecord) -> DiskContent {
        DiskContent {
            parameters: self.build_parameters(set, record),
            offsets: self.build_offsets(set),
            pitch: self.build_pitch(set),
        }
    }

    fn build_parameters(&mut self, set: DataSet, record: &ModelRecord) -> ControlParameters {
        let mut parameters = ControlParameters::default();
        for row in parameter_rows().iter().filter(|row| row.bit.is_none()) {
            let number = row.number;
            if row.state {
                for bit in 0..8 {
                    let on = self
                        .take_integer(ProjectKey::Parameter(set, number, Some(bit)), 0..=1)
                        == 1;
                    // Cannot fail: a state parameter has eight bits.
                    let _ = parameters.set_bit(number, bit, on);
                }
                continue;
            }
            let key = ProjectKey::Parameter(set, number, None);
            let Some(ProjectValue::Whole(value)) = self.take_required(key) else {
                continue;
            };
            let result = match i32::try_from(value) {
                // Parameters saved under another model, or before models had separate ranges,
                // keep to the common range.
                Ok(value) => parameters
                    .set(number, value)
                    .or_else(|_| parameters.set_for_model(record, number, value))
                    .map_err(|it| it.message()),
                Err(_) => Err(say::parameter_out_of_range(number, value, &row.range)),
            };
            if let Err(rule) = result {
                self.report_invalid(key, rule);
            }
        }
        parameters
    }

    fn build_offsets(&mut self, set: DataSet) -> Offsets {
        let mut table = vec![ToolOffset::default(); OFFSET_ROWS];
        for (number, row) in (0..=u8::MAX).zip(&mut table) {
            for (word, _) in OffsetColumn::ALL {
                let key = ProjectKey::Offset(set, number, word);
                if word == OffsetColumn::T {
                    row.t = self.take_integer(key, 0..=9) as u8;
                    continue;
                }
                let Some(ProjectValue::Real(value)) = self.take_required(key) else {
                    continue;
                };
                let mut single = ToolOffset::default();
                for target in [&mut single, &mut *row] {
                    match word {
                        OffsetColumn::X => target.x = value,
                        OffsetColumn::Z => target.z = value,
                        OffsetColumn::R | OffsetColumn::T => target.r = value,
                    }
                }
                if let Err(rule) = check_storable(single, value) {
                    self.report_invalid(key, rule);
                    *row = ToolOffset {
                        t: row.t,
                        ..ToolOffset::default()
                    };
                }
            }
        }
        // Cannot fail: each value has been checked above.
        Offsets::try_from(table).unwrap_or_default()
    }

    fn build_pitch(&mut self, set: DataSet) -> PitchTable {
        let mut table = PitchTable::default();
        for point in 0..=u8::MAX {
            for axis in [Axis::X, Axis::Z] {
                let key = ProjectKey::Pitch(set, point, axis);
                let value = self.take_integer(key, i16::MIN.into()..=i16::MAX.into());
                if let Err(error) = table.set(axis, point, value as i16) {
                    self.report_invalid(key, error.message());
                }
            }
        }
        table
    }

    fn build_variables(&mut self) -> Variables {
        let mut variables = Variables::default();
        let numbers: BTreeSet<u16> = Variables::numbers()
            .chain(RETAINED_MACRO_B_VARIABLES)
            .collect();
        for number in numbers {
            let key = ProjectKey::Variable(number);
            // A variable that only macro B has may be null (empty): it has no line then.
            if !Variables::has_integer(number) && !self.remaining.contains_key(&key) {
                continue;
            }
            if let Some(ProjectValue::Real(value)) = self.take_required(key)
                && let Err(alarm) = variables.set_real(number, Some(value))
            {
                self.report_invalid(key, alarm.reason());
            }
        }
        variables
    }

    fn build_settings(&mut self) -> ControlSettings {
        let [macro_b, parity, iso, inch, numbering] =
            SettingSwitch::ALL.map(|(switch, _)| self.take_switch(ProjectKey::Setting(switch)));
        ControlSettings {
            parity,
            iso,
            inch,
            numbering,
            macro_b,
        }
    }

    fn build_counters(&mut self) -> Counters {
        let [parts, cutting_ms, required, started_ms] = ProjectCounter::ALL.map(|(count, _)| {
            let end = match count {
                ProjectCounter::Parts => i64::from(Counters::PART_COUNT_LIMIT),
                ProjectCounter::CuttingMs => Counters::CUTTING_LIMIT_MS as i64,
                ProjectCounter::Required => i64::from(Counters::REQUIRED_PARTS_LIMIT),
                ProjectCounter::StartedMs => Counters::STARTED_LIMIT_MS as i64,
            };
            if count.is_optional() && !self.remaining.contains_key(&ProjectKey::Counter(count)) {
                return 0;
            }
            self.take_integer(ProjectKey::Counter(count), 0..=end - 1)
        });
        Counters {
            parts: parts as u32,
            cutting_ms: cutting_ms as u64,
            required: required as u32,
            started_ms: started_ms as u64,
        }
    }

    fn build_model(&mut self) -> ControlModel {
        let executed = match self.take_required(ProjectKey::Model) {
            Some(ProjectValue::Model(id)) if !id.is_mill() => Some(id),
            Some(ProjectValue::Model(id)) => {
                let name = id.name();
                self.report_invalid(ProjectKey::Model, say::project_model_not_executed(name));
                None
            }
            _ => None,
        };
        let Some(id) = executed else {
            // Without a model its parameters cannot be checked. The model itself is already
            // reported.
            self.remaining
                .retain(|key, _| !matches!(key, ProjectKey::ModelParameter(_)));
            return ControlModel::new(ModelId::default());
        };
        let mut model = ControlModel::new(id);
        for (number, parameter) in id.record().parameters() {
            let (low, high) = parameter.range;
            let key = ProjectKey::ModelParameter(*number);
            if id.is_main() && !self.remaining.contains_key(&key) {
                continue;
            }
            let value = self.take_integer(key, low.into()..=high.into());
            // An invalid value is already reported and has become 0.
            let _ = model.set_parameter(*number, value as i32);
        }
        model
    }

    fn build_programs(&mut self) -> ProgramMemory {
        let mut programs = ProgramMemory::default();
        let programs_to_store: Vec<(ProjectKey, &ProjectValue)> = self
            .remaining
            .extract_if(.., |key, _| matches!(key, ProjectKey::Program(_)))
            .collect();
        for (key, value) in programs_to_store {
            let (ProjectKey::Program(number), ProjectValue::Text(text)) = (key, value) else {
                continue;
            };
            let rule = match Program::new(&**text).number() {
                Some(text_number) if text_number == number => {
                    programs.store(&**text).err().map(|alarm| alarm.reason())
                }
                Some(text_number) => Some(say::project_program_other_number(text_number)),
                None => Some(say::program_number_missing()),
            };
            if let Some(rule) = rule {
                self.report_invalid(key, rule);
            }
        }
        if let Some(ProjectValue::Selected(Some(number))) = self.take_required(ProjectKey::Selected)
            && !programs.select(ProgramId::Stored(number))
        {
            self.report_invalid(ProjectKey::Selected, say::program_not_in_memory(number));
        }
        programs
    }

    fn build_retained(&mut self) -> RetainedMemory {
        let bytes = 0..=i64::from(u8::MAX);
        let entries = i64::from(i32::MIN)..=i64::from(i32::MAX);
        let [k, d, t, c, dc, dt] = RETAINED_AREAS.map(|(area, first)| {
            let range = match area {
                Area::K | Area::D => bytes.clone(),
                _ => entries.clone(),
            };
            let addresses = first..area.count();
            let values = addresses.map(|byte| {
                let address = ByteAddress::new(area, byte);
                self.take_integer(ProjectKey::Data(address), range.clone())
            });
            values.collect::<Vec<i64>>()
        });
        let to_bytes = |values: Vec<i64>| values.into_iter().map(|it| it as u8).collect();
        let to_words = |values: Vec<i64>| values.into_iter().map(|it| it as i32).collect();
        RetainedMemory {
            k: to_bytes(k),
            d300: to_bytes(d),
            t80: to_words(t),
            c: to_words(c),
            dc: to_words(dc),
            dt: to_words(dt),
        }
    }

    fn build_ladder(&mut self) -> Arc<Ladder> {
        let Some(ProjectValue::Text(text)) = self.take_required(ProjectKey::Ladder) else {
            return standard_ladder();
        };
        if *text == *standard_ladder().source() {
            return standard_ladder();
        }
        match Ladder::compile(&text) {
            Ok(ladder) => Arc::new(ladder),
            Err(CompileErrors { errors, .. }) => {
                for error in errors {
                    self.invalid.push(InvalidValue {
                        key: ProjectKey::Ladder,
                        line: Some(error.line),
                        rule: error.message,
                    });
                }
                standard_ladder()
            }
        }
    }

    fn build_panel(&mut self) -> Option<PanelRetained> {
        if !self
            .remaining
            .keys()
            .any(|key| matches!(key, ProjectKey::Panel(_)))
        {
            return None;
        }
        let i32_range = i64::from(i32::MIN)..=i64::from(i32::MAX);
        let mut take_i32 =
            |word| self.take_integer(ProjectKey::Panel(word), i32_range.clone()) as i32;
        let mut graphic = GraphicSettings {
            center_x: take_i32(PanelSetting::CenterX),
            center_z: take_i32(PanelSetting::CenterZ),
            max_x: take_i32(PanelSetting::MaxX),
            max_z: take_i32(PanelSetting::MaxZ),
            min_x: take_i32(PanelSetting::MinX),
            min_z: take_i32(PanelSetting::MinZ),
            ..GraphicSettings::default()
        };
        graphic.scale =
            self.take_integer(ProjectKey::Panel(PanelSetting::Scale), 0..=u32::MAX.into()) as u32;
        graphic.zx = self.take_switch(ProjectKey::Panel(PanelSetting::Zx));
        graphic.drawing = self.take_switch(ProjectKey::Panel(PanelSetting::Drawing));
        let max_brightness = i64::from(BRIGHTNESS_STEPS) - 1;
        let brightness = self.take_integer(
            ProjectKey::Panel(PanelSetting::Brightness),
            0..=max_brightness,
        ) as u8;
        Some(PanelRetained {
            brightness,
            graphic,
        })
    }
}

/// Checks that the control stores `value` of the offset `single` unchanged, without rounding.
fn check_storable(single: ToolOffset, value: f64) -> Result<(), Message> {
    let mut offsets = Offsets::default();
    offsets.set(1, single).map_err(|alarm| alarm.reason())?;
    let stored = offsets.get(1);
    let stored = [stored.x, stored.z, stored.r];
    // The control rounds a finer value: folder and control would differ.
    if stored.contains(&value) {
        Ok(())
    } else {
        Err(say::project_too_fine(value))
    }
}
