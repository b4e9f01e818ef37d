//! A control from a value for each key, each checked as the control checks it.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use gsk_core::battery::Memory;
use gsk_core::command::ProgramId;
use gsk_core::memory::{
    Counters, DiskContent, Disks, OFFSETS, Offsets, Parameters, PitchTable, Settings, ToolOffset,
    Variables, rows,
};
use gsk_core::model::{ControlModel, ModelId};
use gsk_core::plc::{Area, ByteAddress, CompileErrors, Ladder, RetainedMemory};
use gsk_core::program::{Program, ProgramMemory};
use gsk_core::setup::standard_ladder;
use gsk_core::units::Axis;
use gsk_messages::{Message, say};
use gsk_panel::pages::{BRIGHTNESS_STEPS, GraphicSettings};
use gsk_panel::panel::PanelRetained;

use crate::key::{Count, KEPT, Key, OffsetWord, PanelWord, Set, Switch};
use crate::state::{FORMAT, REAL, State};
use crate::value::Value;

/// A rule that a value breaks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Which value.
    pub key: Key,
    /// Line of the ladder's text, from 1.
    pub line: Option<u32>,
    /// The rule.
    pub rule: Message,
}

/// The values that are left, and what is wrong with those that were taken.
struct Builder<'a> {
    left: BTreeMap<Key, &'a Value>,
    faults: Vec<Fault>,
}

/// A control with these values.
///
/// # Errors
/// Every rule that is broken: a value that is missing, out of its range or of nothing that
/// the control has.
pub fn build(entries: &BTreeMap<Key, Value>) -> Result<State, Vec<Fault>> {
    let mut builder = Builder {
        left: entries.iter().map(|(key, value)| (*key, value)).collect(),
        faults: Vec::new(),
    };
    let state = builder.state();
    let left: Vec<Key> = builder.left.keys().copied().collect();
    for key in left {
        let rule = match key {
            Key::Parameter(_, number, bit) => unknown_parameter(number, bit),
            Key::Variable(number) => say::project_variable_unknown(number),
            _ => say::project_unknown(key.name()),
        };
        builder.fault(key, rule);
    }
    if builder.faults.is_empty() {
        return Ok(state);
    }
    builder.faults.sort_by_key(|fault| fault.key);
    Err(builder.faults)
}

fn unknown_parameter(number: u16, bit: Option<u8>) -> Message {
    match bit {
        Some(bit) => say::parameter_bit_unknown(number, bit),
        None => say::parameter_unknown(number),
    }
}

impl Builder<'_> {
    fn fault(&mut self, key: Key, rule: Message) {
        self.faults.push(Fault {
            key,
            line: None,
            rule,
        });
    }

    /// A value that must be there.
    fn take(&mut self, key: Key) -> Option<Value> {
        let value = self.left.remove(&key).cloned();
        if value.is_none() {
            self.fault(key, say::project_missing(key.name()));
        }
        value
    }

    /// A whole number within a range; 0 where there is none.
    fn whole(&mut self, key: Key, range: core::ops::RangeInclusive<i64>) -> i64 {
        match self.take(key) {
            Some(Value::Whole(value)) if range.contains(&value) => value,
            Some(value) => {
                let rule = say::project_out_of_range(value, range.start(), range.end());
                self.fault(key, rule);
                0
            }
            None => 0,
        }
    }

    fn switch(&mut self, key: Key) -> bool {
        match self.take(key) {
            Some(Value::Switch(on)) => on,
            Some(value) => {
                let rule = say::project_not_a_value(value, say::project_switch());
                self.fault(key, rule);
                false
            }
            None => false,
        }
    }

    fn has_set(&self, set: Set) -> bool {
        self.left.keys().any(|key| match key {
            Key::Parameter(own, ..) | Key::Offset(own, ..) | Key::Pitch(own, ..) => *own == set,
            _ => false,
        })
    }

    fn state(&mut self) -> State {
        let _ = self.whole(Key::Format, FORMAT..=FORMAT);
        let own = self.set(Set::Control);
        let mut disks = Disks::default();
        for (set, disk, _) in Set::DISKS {
            if self.has_set(set) {
                let content = self.set(set);
                disks.save(disk, content);
            }
        }
        let memory = Memory {
            parameters: own.parameters,
            offsets: own.offsets,
            pitch: own.pitch,
            variables: self.variables(),
            settings: self.settings(),
            disks,
            programs: self.programs(),
            counters: self.counters(),
            model: self.model(),
            ..Memory::default()
        };
        let retained = self.retained();
        let ladder = self.ladder();
        let panel = self.panel();
        let state = State::new(&memory, Some(&retained), ladder, panel);
        let texts: Vec<_> = self
            .left
            .extract_if(.., |key, _| matches!(key, Key::Job(_) | Key::Machine))
            .filter_map(|(key, value)| match value {
                Value::Text(text) => Some((key, Arc::clone(text))),
                _ => None,
            })
            .collect();
        state.with_texts(texts)
    }

    fn set(&mut self, set: Set) -> DiskContent {
        DiskContent {
            parameters: self.parameters(set),
            offsets: self.offsets(set),
            pitch: self.pitch(set),
        }
    }

    fn parameters(&mut self, set: Set) -> Parameters {
        let mut parameters = Parameters::default();
        for row in rows().iter().filter(|row| row.bit.is_none()) {
            let number = row.number;
            if row.state {
                for bit in 0..8 {
                    let on = self.whole(Key::Parameter(set, number, Some(bit)), 0..=1) == 1;
                    // Cannot fail: it is a state parameter with eight bits.
                    let _ = parameters.set_bit(number, bit, on);
                }
                continue;
            }
            let key = Key::Parameter(set, number, None);
            let Some(Value::Whole(value)) = self.take(key) else {
                continue;
            };
            let told = match i32::try_from(value) {
                Ok(value) => parameters.set(number, value).map_err(|it| it.message()),
                Err(_) => Err(say::parameter_out_of_range(number, value, &row.range)),
            };
            if let Err(rule) = told {
                self.fault(key, rule);
            }
        }
        parameters
    }

    fn offsets(&mut self, set: Set) -> Offsets {
        let mut table = vec![ToolOffset::default(); OFFSETS];
        for (number, row) in (0..=u8::MAX).zip(&mut table) {
            for (word, _) in OffsetWord::ALL {
                let key = Key::Offset(set, number, word);
                if word == OffsetWord::T {
                    row.t = self.whole(key, 0..=9) as u8;
                    continue;
                }
                let Some(Value::Real(value)) = self.take(key) else {
                    continue;
                };
                let mut alone = ToolOffset::default();
                for place in [&mut alone, &mut *row] {
                    match word {
                        OffsetWord::X => place.x = value,
                        OffsetWord::Z => place.z = value,
                        OffsetWord::R | OffsetWord::T => place.r = value,
                    }
                }
                if let Err(rule) = checked(alone, value) {
                    self.fault(key, rule);
                    *row = ToolOffset {
                        t: row.t,
                        ..ToolOffset::default()
                    };
                }
            }
        }
        // Each value of it is checked.
        Offsets::try_from(table).unwrap_or_default()
    }

    fn pitch(&mut self, set: Set) -> PitchTable {
        let mut table = PitchTable::default();
        for point in 0..=u8::MAX {
            for axis in [Axis::X, Axis::Z] {
                let key = Key::Pitch(set, point, axis);
                let value = self.whole(key, i16::MIN.into()..=i16::MAX.into());
                if let Err(error) = table.set(axis, point, value as i16) {
                    self.fault(key, error.message());
                }
            }
        }
        table
    }

    fn variables(&mut self) -> Variables {
        let mut variables = Variables::default();
        let numbers: BTreeSet<u16> = Variables::numbers().chain(REAL).collect();
        for number in numbers {
            let key = Key::Variable(number);
            // One that macro B alone has may be null, which has no line.
            if !Variables::has(number) && !self.left.contains_key(&key) {
                continue;
            }
            if let Some(Value::Real(value)) = self.take(key)
                && let Err(alarm) = variables.set_real(number, Some(value))
            {
                self.fault(key, alarm.reason());
            }
        }
        variables
    }

    fn settings(&mut self) -> Settings {
        let [macro_b, parity, iso, inch, numbering] =
            Switch::ALL.map(|(switch, _)| self.switch(Key::Switch(switch)));
        Settings {
            parity,
            iso,
            inch,
            numbering,
            macro_b,
        }
    }

    fn counters(&mut self) -> Counters {
        let [parts, cutting_ms, required, started_ms] = Count::ALL.map(|(count, _)| {
            let end = match count {
                Count::Parts => i64::from(Counters::PARTS),
                Count::CuttingMs => Counters::CUTTING_MS as i64,
                Count::Required => i64::from(Counters::REQUIRED),
                Count::StartedMs => Counters::STARTED_MS as i64,
            };
            if count.may_be_missing() && !self.left.contains_key(&Key::Count(count)) {
                return 0;
            }
            self.whole(Key::Count(count), 0..=end - 1)
        });
        Counters {
            parts: parts as u32,
            cutting_ms: cutting_ms as u64,
            required: required as u32,
            started_ms: started_ms as u64,
        }
    }

    fn model(&mut self) -> ControlModel {
        let executed = match self.take(Key::Model) {
            Some(Value::Model(id)) if !id.is_mill() => Some(id),
            Some(Value::Model(id)) => {
                let name = id.name();
                self.fault(Key::Model, say::project_model_not_executed(name));
                None
            }
            _ => None,
        };
        let Some(id) = executed else {
            // Whose parameters they are is not known, or no matter: that is said once.
            self.left
                .retain(|key, _| !matches!(key, Key::ModelParameter(_)));
            return ControlModel::new(ModelId::default());
        };
        let mut model = ControlModel::new(id);
        for (number, parameter) in &id.record().parameters {
            let (low, high) = parameter.range;
            let key = Key::ModelParameter(*number);
            if id.is_main() && !self.left.contains_key(&key) {
                continue;
            }
            let value = self.whole(key, low.into()..=high.into());
            // A value out of its range was said.
            let _ = model.set_parameter(*number, value as i32);
        }
        model
    }

    fn programs(&mut self) -> ProgramMemory {
        let mut programs = ProgramMemory::default();
        let given: Vec<(Key, &Value)> = self
            .left
            .extract_if(.., |key, _| matches!(key, Key::Program(_)))
            .collect();
        for (key, value) in given {
            let (Key::Program(number), Value::Text(text)) = (key, value) else {
                continue;
            };
            let rule = match Program::new(&**text).number() {
                Some(own) if own == number => {
                    programs.store(&**text).err().map(|alarm| alarm.reason())
                }
                Some(own) => Some(say::project_program_other_number(own)),
                None => Some(say::program_number_missing()),
            };
            if let Some(rule) = rule {
                self.fault(key, rule);
            }
        }
        if let Some(Value::Selected(Some(number))) = self.take(Key::Selected)
            && !programs.select(ProgramId::Stored(number))
        {
            self.fault(Key::Selected, say::program_not_in_memory(number));
        }
        programs
    }

    fn retained(&mut self) -> RetainedMemory {
        let bytes = 0..=i64::from(u8::MAX);
        let entries = i64::from(i32::MIN)..=i64::from(i32::MAX);
        let [k, d, t, c, dc, dt] = KEPT.map(|(area, first)| {
            let range = match area {
                Area::K | Area::D => bytes.clone(),
                _ => entries.clone(),
            };
            let addresses = first..area.count();
            let values = addresses.map(|byte| {
                let address = ByteAddress::new(area, byte);
                self.whole(Key::Data(address), range.clone())
            });
            values.collect::<Vec<i64>>()
        });
        let small = |values: Vec<i64>| values.into_iter().map(|it| it as u8).collect();
        let large = |values: Vec<i64>| values.into_iter().map(|it| it as i32).collect();
        RetainedMemory {
            k: small(k),
            d300: small(d),
            t80: large(t),
            c: large(c),
            dc: large(dc),
            dt: large(dt),
        }
    }

    fn ladder(&mut self) -> Arc<Ladder> {
        let Some(Value::Text(text)) = self.take(Key::Ladder) else {
            return standard_ladder();
        };
        if *text == *standard_ladder().source() {
            return standard_ladder();
        }
        match Ladder::compile(&text) {
            Ok(ladder) => Arc::new(ladder),
            Err(CompileErrors { errors, .. }) => {
                for error in errors {
                    self.faults.push(Fault {
                        key: Key::Ladder,
                        line: Some(error.line),
                        rule: error.message,
                    });
                }
                standard_ladder()
            }
        }
    }

    fn panel(&mut self) -> Option<PanelRetained> {
        if !self.left.keys().any(|key| matches!(key, Key::Panel(_))) {
            return None;
        }
        let all = i64::from(i32::MIN)..=i64::from(i32::MAX);
        let mut length = |word| self.whole(Key::Panel(word), all.clone()) as i32;
        let mut graphic = GraphicSettings {
            center_x: length(PanelWord::CenterX),
            center_z: length(PanelWord::CenterZ),
            max_x: length(PanelWord::MaxX),
            max_z: length(PanelWord::MaxZ),
            min_x: length(PanelWord::MinX),
            min_z: length(PanelWord::MinZ),
            ..GraphicSettings::default()
        };
        graphic.scale = self.whole(Key::Panel(PanelWord::Scale), 0..=u32::MAX.into()) as u32;
        graphic.zx = self.switch(Key::Panel(PanelWord::Zx));
        graphic.drawing = self.switch(Key::Panel(PanelWord::Drawing));
        let most = i64::from(BRIGHTNESS_STEPS) - 1;
        let brightness = self.whole(Key::Panel(PanelWord::Brightness), 0..=most) as u8;
        Some(PanelRetained {
            brightness,
            graphic,
        })
    }
}

/// Whether the control would store this value as it is.
fn checked(alone: ToolOffset, value: f64) -> Result<(), Message> {
    let mut offsets = Offsets::default();
    offsets.set(1, alone).map_err(|alarm| alarm.reason())?;
    let stored = offsets.get(1);
    let stored = [stored.x, stored.z, stored.r];
    // A finer value would be rounded, and the folder say something else than the control.
    let same = stored.contains(&value);
    if same {
        Ok(())
    } else {
        Err(say::project_too_fine(value))
    }
}
