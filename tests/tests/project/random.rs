//! Random controls and changes: what is written is read again bit for bit, the differences
//! are exactly the changes, and no damaged line passes.

use std::collections::BTreeMap;
use std::sync::Arc;

use gsk_core::battery::BatteryMemory;
use gsk_core::command::ProgramId;
use gsk_core::memory::{Counters, DiskContent, ElectronicDisk, ToolOffset, parameter_rows};
use gsk_core::model::{ControlModel, ModelId};
use gsk_core::plc::{Area, ByteAddress, Ladder, Plc, RetainedMemory};
use gsk_core::setup::{STANDARD_LADDER, Setup, standard_ladder};
use gsk_core::units::Axis;
use gsk_messages::Language;
use gsk_panel::panel::PanelRetained;
use gsk_project::{
    DataSet, OffsetColumn, PanelSetting, ProjectDifference, ProjectKey, ProjectState, ProjectValue,
    SettingSwitch, apply, describe_text_changes, diff, export, import, label,
};
use proptest::prelude::*;

use super::is_table;

fn config() -> ProptestConfig {
    let mut config = ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = 16;
    }
    config
}

/// Random numbers from a seed.
struct ProjectRandom(u64);

impl ProjectRandom {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: u64) -> u64 {
        self.next() % end
    }

    fn pick<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len() as u64) as usize]
    }
}

/// A control that is changed through its own functions.
#[derive(Clone)]
pub(super) struct ProjectControl {
    pub(super) memory: BatteryMemory,
    plc: Plc,
    panel: Option<PanelRetained>,
}

/// A key with its values before and after.
type KeyChange = (ProjectKey, Option<ProjectValue>, Option<ProjectValue>);

impl ProjectControl {
    pub(super) fn new() -> Self {
        Self {
            memory: BatteryMemory::default(),
            plc: Plc::new(standard_ladder()),
            panel: None,
        }
    }

    fn from_seed(seed: u64) -> Self {
        let numbers = &mut ProjectRandom(seed);
        let mut control = Self::new();
        if numbers.below(4) == 0 {
            control.memory.model = ControlModel::new(ModelId::Ncb08);
        }
        if numbers.below(2) == 0 {
            control.panel = Some(PanelRetained {
                brightness: 8,
                graphic: Default::default(),
            });
        }
        if numbers.below(3) == 0 {
            let text = format!("{STANDARD_LADDER}\n; number {}\n", numbers.next());
            control.plc = Plc::new(Arc::new(Ladder::compile(&text).unwrap()));
        }
        for _ in 0..numbers.below(120) {
            control.change(numbers);
        }
        for disk in [ElectronicDisk::N1, ElectronicDisk::N3] {
            if numbers.below(3) == 0 {
                let content = DiskContent {
                    parameters: control.memory.parameters.clone(),
                    offsets: control.memory.offsets.clone(),
                    pitch: control.memory.pitch.clone(),
                };
                control.memory.disks.save(disk, content);
            }
        }
        for _ in 0..numbers.below(120) {
            control.change(numbers);
        }
        control
    }

    pub(super) fn state(&self) -> ProjectState {
        let retained: RetainedMemory = self.plc.memory().retained();
        let ladder = self.plc.ladder();
        ProjectState::new(
            &self.memory,
            Some(&retained),
            Arc::clone(ladder),
            self.panel,
        )
    }

    fn selected(&self) -> Option<ProjectValue> {
        let number = match self.memory.programs.selected() {
            Some(ProgramId::Stored(number)) => Some(number),
            _ => None,
        };
        Some(ProjectValue::Selected(number))
    }

    /// Changes one value.
    fn change(&mut self, numbers: &mut ProjectRandom) -> Vec<KeyChange> {
        let memory = &mut self.memory;
        let whole = |value: i64| Some(ProjectValue::Whole(value));
        match numbers.below(11) {
            0 | 1 => {
                let data: Vec<_> = parameter_rows()
                    .iter()
                    .filter(|it| it.bit.is_none() && !it.state)
                    .collect();
                let row = numbers.pick(&data);
                let old = memory.parameters.value(row.number);
                let value = match &row.range {
                    gsk_core::memory::ParameterRange::Span(low, high) => {
                        low + numbers.below((high - low) as u64 + 1) as i32
                    }
                    gsk_core::memory::ParameterRange::List(values) => numbers.pick(values),
                };
                memory.parameters.set(row.number, value).unwrap();
                let key = ProjectKey::Parameter(DataSet::Control, row.number, None);
                vec![(key, whole(old.into()), whole(value.into()))]
            }
            2 => {
                let states: Vec<_> = parameter_rows().iter().filter(|it| it.state).collect();
                let number = numbers.pick(&states).number;
                let bit = numbers.below(8) as u8;
                let old = memory.parameters.bit(number, bit);
                memory.parameters.set_bit(number, bit, !old).unwrap();
                let key = ProjectKey::Parameter(DataSet::Control, number, Some(bit));
                vec![(key, whole(old.into()), whole((!old).into()))]
            }
            3 => {
                let number = 1 + numbers.below(32) as u8;
                let length =
                    |numbers: &mut ProjectRandom| (numbers.below(20_000_000) as f64 - 1e7) / 1000.0;
                let old = memory.offsets.get(number);
                let new = ToolOffset {
                    x: length(numbers),
                    z: length(numbers),
                    r: length(numbers),
                    t: numbers.below(10) as u8,
                };
                memory.offsets.set(number, new).unwrap();
                let new = memory.offsets.get(number);
                let key = |word| ProjectKey::Offset(DataSet::Control, number, word);
                let real = |value| Some(ProjectValue::Real(value));
                vec![
                    (key(OffsetColumn::X), real(old.x), real(new.x)),
                    (key(OffsetColumn::Z), real(old.z), real(new.z)),
                    (key(OffsetColumn::R), real(old.r), real(new.r)),
                    (
                        key(OffsetColumn::T),
                        whole(old.t.into()),
                        whole(new.t.into()),
                    ),
                ]
            }
            4 => {
                let number = match numbers.below(2) {
                    0 => 200 + numbers.below(32) as u16,
                    _ => 500 + numbers.below(500) as u16,
                };
                let old = memory.variables.real_value(number);
                let value = match numbers.below(4) {
                    0 => None,
                    1 => Some(numbers.below(1 << 33) as f64 - 4_294_967_296.0),
                    2 => Some((numbers.next() as i64) as f64 / 9.3e10),
                    _ if number > 515 => Some(f64::from_bits(numbers.next())),
                    _ => Some(0.1),
                };
                let value = value.filter(|value| value.abs() <= 1e47);
                memory.variables.set_real(number, value).unwrap();
                let new = memory.variables.real_value(number);
                let (old, new) = (old.map(ProjectValue::Real), new.map(ProjectValue::Real));
                vec![(ProjectKey::Variable(number), old, new)]
            }
            5 => {
                let (point, axis) = (numbers.next() as u8, numbers.pick(&[Axis::X, Axis::Z]));
                let value = numbers.below(511) as i16 - 255;
                let old = memory.pitch.value(axis, point);
                memory.pitch.set(axis, point, value).unwrap();
                let key = ProjectKey::Pitch(DataSet::Control, point, axis);
                vec![(key, whole(old.into()), whole(value.into()))]
            }
            6 => {
                let old = memory.settings.macro_b;
                memory.settings.macro_b = !old;
                let key = ProjectKey::Setting(SettingSwitch::MacroB);
                vec![(
                    key,
                    Some(ProjectValue::Switch(old)),
                    Some(ProjectValue::Switch(!old)),
                )]
            }
            7 => {
                let old = memory.counters.parts;
                memory.counters.parts = numbers.below(Counters::PART_COUNT_LIMIT.into()) as u32;
                let key = ProjectKey::Counter(gsk_project::ProjectCounter::Parts);
                vec![(key, whole(old.into()), whole(memory.counters.parts.into()))]
            }
            8 => self.change_programs(numbers),
            9 => {
                let areas = [
                    (Area::K, 0),
                    (Area::D, 300),
                    (Area::T, 80),
                    (Area::C, 0),
                    (Area::Dt, 0),
                ];
                let (area, first) = numbers.pick(&areas);
                let byte = first + numbers.below((area.count() - first).into()) as u16;
                let address = ByteAddress::new(area, byte);
                let plc = self.plc.memory_mut();
                let read = |plc: &gsk_core::plc::PlcMemory| match area.is_entry() {
                    true => plc.long(address).into(),
                    false => plc.byte(address).into(),
                };
                let old = read(plc);
                match area.is_entry() {
                    true => plc.set_long(address, numbers.next() as i32),
                    false => plc.set_byte(address, numbers.next() as u8),
                }
                let new = read(plc);
                vec![(ProjectKey::Data(address), whole(old), whole(new))]
            }
            _ => {
                let Some(panel) = &mut self.panel else {
                    return Vec::new();
                };
                let old = panel.graphic.min_z;
                panel.graphic.min_z = numbers.next() as i32;
                let new = panel.graphic.min_z;
                vec![(
                    ProjectKey::Panel(PanelSetting::MinZ),
                    whole(old.into()),
                    whole(new.into()),
                )]
            }
        }
    }

    fn change_programs(&mut self, numbers: &mut ProjectRandom) -> Vec<KeyChange> {
        let number = numbers.below(6) as u16 * 1999;
        let selected = self.selected();
        let programs = &mut self.memory.programs;
        let text = |programs: &gsk_core::program::ProgramMemory| {
            let program = programs.stored(number);
            program.map(|program| ProjectValue::Text(program.text().into()))
        };
        let old = text(programs);
        if numbers.below(3) == 0 && old.is_some() {
            programs.delete(number).unwrap();
        } else {
            let end = numbers.pick(&["\n", "\r\n", ";\n"]);
            let mut new = format!("O{number:04}{end}(车 {}){end}", numbers.next());
            for _ in 0..numbers.below(5) {
                new.push_str(&format!("G01 X{} F0.2{end}", numbers.below(99)));
            }
            programs
                .store(new + numbers.pick(&["M30", "M30;\n%\n", "M99\r"]))
                .unwrap();
        }
        let new = text(programs);
        vec![
            (ProjectKey::Program(number), old, new),
            (ProjectKey::Selected, selected, self.selected()),
        ]
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn what_is_written_is_read_again_bit_for_bit(seed: u64) {
        let state = ProjectControl::from_seed(seed).state();
        for language in [Language::En, Language::Zh] {
            let files = export(&state, language);
            let read = import(&files);
            prop_assert!(read.is_ok(), "{:?}", read.err());
            let read = read.unwrap();
            prop_assert_eq!(&read, &state);
            // The values that the control itself compares.
            prop_assert_eq!(&read.memory().parameters, &state.memory().parameters);
            prop_assert_eq!(&read.memory().offsets, &state.memory().offsets);
            prop_assert_eq!(&read.memory().pitch, &state.memory().pitch);
            prop_assert_eq!(&read.memory().variables, &state.memory().variables);
            prop_assert_eq!(&read.memory().settings, &state.memory().settings);
            prop_assert_eq!(&read.memory().disks, &state.memory().disks);
            prop_assert_eq!(&read.memory().programs, &state.memory().programs);
            prop_assert_eq!(&read.memory().counters, &state.memory().counters);
            prop_assert_eq!(&read.memory().model, &state.memory().model);
            prop_assert_eq!(read.retained(), state.retained());
            prop_assert_eq!(read.ladder(), state.ladder());
            prop_assert_eq!(read.panel(), state.panel());
            prop_assert_eq!(export(&read, language), files, "the same bytes again");
        }
    }

    #[test]
    fn differences_are_exactly_what_was_changed(seed: u64, changes in 0..60u64) {
        let mut control = ProjectControl::from_seed(seed);
        let before = control.state();
        let mut planted: BTreeMap<ProjectKey, (Option<ProjectValue>, Option<ProjectValue>)> = BTreeMap::new();
        let numbers = &mut ProjectRandom(seed ^ 1);
        for _ in 0..changes {
            for (key, old, new) in control.change(numbers) {
                planted.entry(key).or_insert((old, None)).1 = new;
            }
        }
        let after = control.state();
        let planted: Vec<ProjectDifference> = planted
            .into_iter()
            .filter(|(_, (old, new))| old != new)
            .map(|(key, (old, new))| ProjectDifference { key, old, new })
            .collect();
        let found = diff(&before, &after);
        prop_assert_eq!(&found, &planted);
        prop_assert_eq!(apply(&before, &found).unwrap(), after.clone());
        prop_assert_eq!(diff(&after, &before).len(), found.len());
        for difference in &found {
            for language in [Language::En, Language::Zh] {
                prop_assert!(!label(difference.key, &after, language).is_empty());
            }
            let is_text = matches!(difference.old, Some(ProjectValue::Text(_)))
                || matches!(difference.new, Some(ProjectValue::Text(_)));
            prop_assert_eq!(describe_text_changes(difference).is_empty(), !is_text);
        }
        // Two random ones as well: applying the differences makes them equal.
        let other = ProjectControl::from_seed(seed ^ 2).state();
        let found = diff(&before, &other);
        let panel = other.panel().or(before.panel());
        prop_assert_eq!(apply(&before, &found).unwrap(), other.with_panel(panel));
    }

    #[test]
    fn no_damaged_line_passes_unnoticed(seed: u64, garbage in "\\PC{0,12}") {
        let state = ProjectControl::from_seed(seed).state();
        let files = export(&state, Language::En);
        let numbers = &mut ProjectRandom(seed);
        let names: Vec<&String> = files.keys().filter(|name| is_table(name)).collect();
        for _ in 0..8 {
            let name = numbers.pick(&names).clone();
            let lines: Vec<&str> = files[&name].lines().collect();
            let at = 1 + numbers.below(lines.len() as u64 - 1) as usize;
            let mut damaged = lines.clone();
            match numbers.below(4) {
                0 => drop(damaged.remove(at)),
                1 => damaged.insert(at + 1, lines[at]),
                2 => damaged.insert(at, "no line of a table"),
                _ => damaged[at] = &garbage,
            }
            let mut files = files.clone();
            files.insert(name.clone(), damaged.join("\n"));
            match import(&files) {
                Err(problems) => {
                    prop_assert!(problems.iter().all(|it| it.file == name), "{problems:?}");
                }
                // A variable of macro B without a line is null; garbage may be a value.
                Ok(read) => {
                    let expected = name == "variables.txt" || garbage.contains('=');
                    prop_assert!(expected || read == state, "{name}:{at}: {damaged:?}");
                }
            }
        }
    }

    #[test]
    fn no_folder_panics(texts in proptest::collection::vec(("[a-zO0-9./]{0,20}", "\\PC{0,60}"), 0..6)) {
        let mut files = export(&ProjectState::from_setup(&Setup::delivered()), Language::En);
        for (name, text) in texts {
            let known: Vec<String> = files.keys().cloned().collect();
            let name = match text.len() % 2 {
                0 => known[text.len() % known.len()].clone(),
                _ => name,
            };
            files.insert(name, text);
        }
        if let Err(problems) = import(&files) {
            for problem in problems {
                prop_assert!(!problem.file.is_empty() || files.contains_key(""));
                let _ = problem.message().text(Language::Zh);
            }
        }
    }
}
