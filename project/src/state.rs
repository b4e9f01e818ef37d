//! What a control holds, and the same as a value for each key.

use std::collections::BTreeMap;
use std::sync::Arc;

use gsk_core::battery::Memory;
use gsk_core::command::ProgramId;
use gsk_core::memory::{
    Authority, Counters, OFFSETS, Offsets, Parameters, PitchTable, Variables, rows,
};
use gsk_core::model::ControlModel;
use gsk_core::plc::{Area, ByteAddress, Ladder, Plc, RetainedMemory};
use gsk_core::setup::Setup;
use gsk_core::units::Axis;
use gsk_panel::panel::PanelRetained;

use crate::key::{Count, KEPT, Key, OffsetWord, PanelWord, Set, Switch};
use crate::value::Value;

/// The form of the folder.
pub(crate) const FORMAT: i64 = 1;

/// Variables that macro B alone has and that outlast power-off (manual III-11).
pub(crate) const REAL: core::ops::RangeInclusive<u16> = 500..=999;

/// Whether a macro variable is one of what a project holds: those of macro A, and those of
/// macro B that outlast power-off.
pub fn lasts(variable: u16) -> bool {
    Variables::has(variable) || REAL.contains(&variable)
}

/// What a control holds: all that its battery keeps but for the operation level with its
/// passwords, the ladder with what the PLC keeps, what the panel keeps. The position of the
/// slides is none of it.
#[derive(Clone, Debug)]
pub struct State {
    memory: Memory,
    retained: RetainedMemory,
    ladder: Arc<Ladder>,
    panel: Option<PanelRetained>,
    /// Machine file and jobs; a control has none.
    texts: Option<BTreeMap<Key, Arc<str>>>,
}

/// Two are the same when each value is, bit by bit.
impl PartialEq for State {
    fn eq(&self, other: &Self) -> bool {
        self.entries() == other.entries()
    }
}

impl State {
    /// Of what a control holds; `None` of `retained`: what the ladder starts with, `None` of
    /// `panel`: nobody has looked at the panel yet. What does not outlast power-off, and who
    /// is logged on, is left out.
    pub fn new(
        memory: &Memory,
        retained: Option<&RetainedMemory>,
        ladder: Arc<Ladder>,
        panel: Option<PanelRetained>,
    ) -> Self {
        let mut memory = memory.clone();
        memory.authority = Authority::default();
        memory.variables.power_on();
        memory.counters = Counters {
            parts: memory.counters.parts % Counters::PARTS,
            cutting_ms: memory.counters.cutting_ms % Counters::CUTTING_MS,
            required: memory.counters.required % Counters::REQUIRED,
            started_ms: memory.counters.started_ms % Counters::STARTED_MS,
        };
        memory.model = as_delivered_but_for(&memory.model);
        memory.programs = memory.programs.retained();
        let first = memory.programs.iter().next().map(|(number, _)| number);
        if let (None, Some(first)) = (memory.programs.current(), first) {
            memory.programs.select(ProgramId::Stored(first));
        }
        // An older directory may lack some of it.
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

    /// What a control starts from.
    pub fn of(setup: &Setup) -> Self {
        let retained = setup.plc_retained.as_ref();
        Self::new(&setup.memory, retained, setup.ladder.compiled(), None)
    }

    /// With what its panel keeps.
    #[must_use]
    pub fn with_panel(self, panel: Option<PanelRetained>) -> Self {
        Self { panel, ..self }
    }

    /// With the machine file and the jobs of its programs.
    #[must_use]
    pub fn with_texts(mut self, texts: impl IntoIterator<Item = (Key, Arc<str>)>) -> Self {
        let own = texts.into_iter();
        let own = own.filter(|(key, _)| matches!(key, Key::Job(_) | Key::Machine));
        self.texts = Some(own.collect());
        self
    }

    /// As a control has it: without machine file and jobs.
    #[must_use]
    pub fn without_texts(self) -> Self {
        Self {
            texts: None,
            ..self
        }
    }

    /// What the battery keeps; its operation level is as delivered.
    pub const fn memory(&self) -> &Memory {
        &self.memory
    }

    /// What the PLC keeps.
    pub const fn retained(&self) -> &RetainedMemory {
        &self.retained
    }

    /// The ladder.
    pub const fn ladder(&self) -> &Arc<Ladder> {
        &self.ladder
    }

    /// What the panel keeps.
    pub const fn panel(&self) -> Option<PanelRetained> {
        self.panel
    }

    /// Machine file and jobs; none of a control, which has no such files.
    pub const fn texts(&self) -> Option<&BTreeMap<Key, Arc<str>>> {
        self.texts.as_ref()
    }

    /// Every value by its key.
    pub fn entries(&self) -> BTreeMap<Key, Value> {
        let memory = &self.memory;
        let mut all = BTreeMap::new();
        all.insert(Key::Format, Value::Whole(FORMAT));
        all.insert(Key::Model, Value::Model(memory.model.id()));
        for (number, parameter) in &memory.model.record().parameters {
            let value = memory.model.parameter(*number);
            // Older folders of the GSK980TD have none of them.
            if memory.model.is_main() && value == parameter.delivered {
                continue;
            }
            all.insert(Key::ModelParameter(*number), Value::Whole(value.into()));
        }
        let settings = &memory.settings;
        for (switch, _) in Switch::ALL {
            let on = match switch {
                Switch::MacroB => settings.macro_b,
                Switch::Parity => settings.parity,
                Switch::Iso => settings.iso,
                Switch::Inch => settings.inch,
                Switch::Numbering => settings.numbering,
            };
            all.insert(Key::Switch(switch), Value::Switch(on));
        }
        let selected = match memory.programs.current() {
            Some(ProgramId::Stored(number)) => Some(number),
            _ => None,
        };
        all.insert(Key::Selected, Value::Selected(selected));
        for (number, program) in memory.programs.iter() {
            all.insert(Key::Program(number), Value::Text(program.text().into()));
        }
        let own = (&memory.parameters, &memory.offsets, &memory.pitch);
        list_set(&mut all, Set::Control, own);
        for (set, disk, _) in Set::DISKS {
            if let Some(content) = memory.disks.saved(disk) {
                let own = (&content.parameters, &content.offsets, &content.pitch);
                list_set(&mut all, set, own);
            }
        }
        for number in Variables::numbers().chain(REAL) {
            if let Some(value) = memory.variables.real(number) {
                all.insert(Key::Variable(number), Value::Real(value));
            }
        }
        for (count, _) in Count::ALL {
            let value = match count {
                Count::Parts => memory.counters.parts.into(),
                Count::CuttingMs => memory.counters.cutting_ms as i64,
                Count::Required => memory.counters.required.into(),
                Count::StartedMs => memory.counters.started_ms as i64,
            };
            if value == 0 && count.may_be_missing() {
                continue;
            }
            all.insert(Key::Count(count), Value::Whole(value));
        }
        list_retained(&mut all, &self.retained);
        if let Some(panel) = &self.panel {
            list_panel(&mut all, panel);
        }
        all.insert(Key::Ladder, Value::Text(self.ladder.source().into()));
        for (key, text) in self.texts.iter().flatten() {
            all.insert(*key, Value::Text(Arc::clone(text)));
        }
        all
    }
}

/// A parameter set to the value it is delivered with is one that was not changed.
fn as_delivered_but_for(model: &ControlModel) -> ControlModel {
    let mut same = ControlModel::new(model.id());
    for (number, parameter) in &model.record().parameters {
        let value = model.parameter(*number);
        if value != parameter.delivered {
            // Cannot fail: the value comes from the model.
            let _ = same.set_parameter(*number, value);
        }
    }
    same
}

fn list_set(
    all: &mut BTreeMap<Key, Value>,
    set: Set,
    (parameters, offsets, pitch): (&Parameters, &Offsets, &PitchTable),
) {
    for row in rows().iter().filter(|row| row.bit.is_none()) {
        let number = row.number;
        if row.state {
            for bit in 0..8 {
                let on = i64::from(parameters.bit(number, bit));
                all.insert(Key::Parameter(set, number, Some(bit)), Value::Whole(on));
            }
        } else {
            let value = parameters.value(number).into();
            all.insert(Key::Parameter(set, number, None), Value::Whole(value));
        }
    }
    for (number, offset) in offsets.iter().take(OFFSETS) {
        for (word, _) in OffsetWord::ALL {
            let value = match word {
                OffsetWord::X => Value::Real(offset.x),
                OffsetWord::Z => Value::Real(offset.z),
                OffsetWord::R => Value::Real(offset.r),
                OffsetWord::T => Value::Whole(offset.t.into()),
            };
            all.insert(Key::Offset(set, number, word), value);
        }
    }
    for point in 0..=u8::MAX {
        for axis in [Axis::X, Axis::Z] {
            let value = pitch.value(axis, point).into();
            all.insert(Key::Pitch(set, point, axis), Value::Whole(value));
        }
    }
}

fn list_retained(all: &mut BTreeMap<Key, Value>, retained: &RetainedMemory) {
    for (area, first) in KEPT {
        let values: Vec<i64> = match area {
            Area::K => retained.k.iter().map(|it| (*it).into()).collect(),
            Area::D => retained.d300.iter().map(|it| (*it).into()).collect(),
            Area::T => retained.t80.iter().map(|it| (*it).into()).collect(),
            Area::C => retained.c.iter().map(|it| (*it).into()).collect(),
            Area::Dc => retained.dc.iter().map(|it| (*it).into()).collect(),
            _ => retained.dt.iter().map(|it| (*it).into()).collect(),
        };
        for (byte, value) in (first..area.count()).zip(values) {
            let key = Key::Data(ByteAddress::new(area, byte));
            all.insert(key, Value::Whole(value));
        }
    }
}

fn list_panel(all: &mut BTreeMap<Key, Value>, panel: &PanelRetained) {
    let graphic = &panel.graphic;
    for (word, _) in PanelWord::ALL {
        let value = match word {
            PanelWord::Brightness => Value::Whole(panel.brightness.into()),
            PanelWord::Zx => Value::Switch(graphic.zx),
            PanelWord::Scale => Value::Whole(graphic.scale.into()),
            PanelWord::CenterX => Value::Whole(graphic.center_x.into()),
            PanelWord::CenterZ => Value::Whole(graphic.center_z.into()),
            PanelWord::MaxX => Value::Whole(graphic.max_x.into()),
            PanelWord::MaxZ => Value::Whole(graphic.max_z.into()),
            PanelWord::MinX => Value::Whole(graphic.min_x.into()),
            PanelWord::MinZ => Value::Whole(graphic.min_z.into()),
            PanelWord::Drawing => Value::Switch(graphic.drawing),
        };
        all.insert(Key::Panel(word), value);
    }
}
