//! The control's battery-backed memory and the data directory: loading at the
//! start, saving while the control runs.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::thread::{self, JoinHandle};

use crossbeam::channel::{Receiver, Sender, bounded};
use gsk_core::cnc::Cnc;
use gsk_core::memory::{Counters, Offsets, Parameters, PitchTable, Variables};
use gsk_core::plc::{Ladder, Retained as PlcRetained};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use serde::{Deserialize, Serialize};

use crate::files::data_dir::{DataDir, Loaded, StoredProgram};
use crate::files::decode::Encoding;

/// Looks between two savings of the counters alone, which change all the time.
const COUNTER_LOOKS: u32 = 20;

/// What the setting page keeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Settings {
    /// 英制编程.
    inch_input: bool,
}

/// Everything that survives power-off.
#[derive(Clone, Debug, PartialEq)]
struct Memory {
    settings: Settings,
    parameters: Parameters,
    offsets: Offsets,
    pitch: PitchTable,
    counters: Counters,
    variables: Variables,
    plc: PlcRetained,
    programs: BTreeMap<u16, Program>,
    /// The ladder that the next power-on runs.
    ladder: Arc<Ladder>,
}

impl Memory {
    fn of(cnc: &Cnc) -> Self {
        Self {
            settings: Settings {
                inch_input: cnc.inch_input(),
            },
            parameters: cnc.parameters().clone(),
            offsets: cnc.offsets().clone(),
            pitch: cnc.pitch().clone(),
            counters: cnc.counters(),
            variables: cnc.variables().clone(),
            plc: cnc.plc().memory().retained(),
            programs: cnc
                .programs()
                .iter()
                .map(|(number, program)| (number, program.clone()))
                .collect(),
            ladder: Arc::clone(cnc.next_ladder().unwrap_or(cnc.plc().ladder())),
        }
    }
}

/// What a data directory held.
#[derive(Debug)]
pub struct Restored {
    /// The encodings of the programs, to be written back the same way.
    encodings: BTreeMap<u16, Encoding>,
    /// Sentences about damaged files.
    pub complaints: Vec<String>,
}

/// Puts the memory of a data directory into a setup.
pub fn load(data: &DataDir, setup: &mut Setup) -> Restored {
    let mut complaints = Vec::new();
    take(
        data.load("parameters"),
        &mut setup.parameters,
        &mut complaints,
    );
    take(data.load("offsets"), &mut setup.offsets, &mut complaints);
    take(data.load("pitch"), &mut setup.pitch, &mut complaints);
    take(data.load("counters"), &mut setup.counters, &mut complaints);
    take(
        data.load("variables"),
        &mut setup.variables,
        &mut complaints,
    );
    let mut settings = Settings {
        inch_input: setup.inch_input,
    };
    take(data.load("settings"), &mut settings, &mut complaints);
    setup.inch_input = settings.inch_input;
    match data.load("plc") {
        Loaded::Value(plc) => setup.plc_retained = Some(plc),
        Loaded::Missing => {}
        Loaded::Damaged(said) => complaints.push(said),
    }
    match data.ladder() {
        Loaded::Value(ladder) => setup.ladder = Arc::new(ladder),
        Loaded::Missing => {}
        Loaded::Damaged(said) => complaints.push(said),
    }
    let (programs, damaged) = data.programs();
    complaints.extend(damaged);
    let mut encodings = BTreeMap::new();
    for stored in programs {
        let program = Program::new(stored.text.as_str());
        let text = match program.number() {
            Some(number) if number == stored.number => stored.text,
            _ => program.renumbered(stored.number).text().to_owned(),
        };
        match setup.programs.store(text) {
            Ok(number) => {
                encodings.insert(number, stored.encoding);
            }
            Err(alarm) => complaints.push(format!("O{:04}: {}", stored.number, alarm.line_text())),
        }
    }
    Restored {
        encodings,
        complaints,
    }
}

fn take<T>(loaded: Loaded<T>, place: &mut T, complaints: &mut Vec<String>) {
    match loaded {
        Loaded::Value(value) => *place = value,
        Loaded::Missing => {}
        Loaded::Damaged(said) => complaints.push(said),
    }
}

/// Writes the memory of a control into its directory, once.
pub fn save(data: DataDir, restored: &Restored, cnc: &Cnc) -> Result<(), String> {
    let now = Memory::of(cnc);
    let nothing = Memory {
        settings: Settings::default(),
        parameters: Parameters::default(),
        offsets: Offsets::default(),
        pitch: PitchTable::default(),
        counters: Counters::default(),
        variables: Variables::default(),
        plc: PlcRetained::default(),
        programs: BTreeMap::new(),
        // Only the window loads another one.
        ladder: Arc::clone(&now.ladder),
    };
    Writer {
        data: Arc::new(data),
        encodings: restored.encodings.clone(),
        written: nothing,
    }
    .write(now)
}

/// Watches the memory and saves what has changed, in a thread of its own: a slow
/// disk never holds up the kernel.
pub struct Keeper {
    last: Memory,
    looks: u32,
    to_disk: Option<Sender<Memory>>,
    complaints: Receiver<String>,
    thread: Option<JoinHandle<()>>,
}

impl Keeper {
    /// Starts to keep the memory of a control in a directory.
    pub fn start(data: Arc<DataDir>, restored: &Restored, cnc: &Cnc) -> std::io::Result<Self> {
        let (to_disk, from_kernel) = bounded::<Memory>(1);
        let (say, complaints) = bounded(16);
        let mut writer = Writer {
            data,
            encodings: restored.encodings.clone(),
            written: Memory::of(cnc),
        };
        let last = writer.written.clone();
        let thread = thread::Builder::new()
            .name("memory".to_owned())
            .spawn(move || {
                for memory in from_kernel {
                    if let Err(complaint) = writer.write(memory) {
                        let _ = say.try_send(complaint);
                    }
                }
            })?;
        Ok(Self {
            last,
            looks: 0,
            to_disk: Some(to_disk),
            complaints,
            thread: Some(thread),
        })
    }

    /// Saves the memory if it has changed.
    pub fn look(&mut self, cnc: &Cnc) {
        self.looks += 1;
        let now = Memory::of(cnc);
        if now == self.last {
            return;
        }
        let only_counters = Memory {
            counters: self.last.counters,
            ..now.clone()
        } == self.last;
        if only_counters && self.looks < COUNTER_LOOKS {
            return;
        }
        // A disk that still writes the last one gets this one at the next look.
        if let Some(to_disk) = &self.to_disk
            && to_disk.try_send(now.clone()).is_ok()
        {
            self.last = now;
            self.looks = 0;
        }
    }

    /// What could not be saved, since the last call.
    pub fn complaints(&self) -> Vec<String> {
        self.complaints.try_iter().collect()
    }

    /// Saves everything and waits for the disk.
    pub fn finish(mut self, cnc: &Cnc) {
        if let Some(to_disk) = self.to_disk.take() {
            let _ = to_disk.send(Memory::of(cnc));
        }
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
        for complaint in self.complaints() {
            eprintln!("gsk980td: {complaint}");
        }
    }
}

/// Writes what differs from what is on the disk.
struct Writer {
    data: Arc<DataDir>,
    encodings: BTreeMap<u16, Encoding>,
    written: Memory,
}

impl Writer {
    fn write(&mut self, now: Memory) -> Result<(), String> {
        if now.parameters != self.written.parameters {
            self.data.store("parameters", &now.parameters)?;
            self.written.parameters = now.parameters;
        }
        if now.offsets != self.written.offsets {
            self.data.store("offsets", &now.offsets)?;
            self.written.offsets = now.offsets;
        }
        if now.pitch != self.written.pitch {
            self.data.store("pitch", &now.pitch)?;
            self.written.pitch = now.pitch;
        }
        if now.counters != self.written.counters {
            self.data.store("counters", &now.counters)?;
            self.written.counters = now.counters;
        }
        if now.variables != self.written.variables {
            self.data.store("variables", &now.variables)?;
            self.written.variables = now.variables;
        }
        if now.settings != self.written.settings {
            self.data.store("settings", &now.settings)?;
            self.written.settings = now.settings;
        }
        if now.plc != self.written.plc {
            self.data.store("plc", &now.plc)?;
            self.written.plc = now.plc;
        }
        if now.ladder != self.written.ladder {
            self.data.store_ladder(&now.ladder)?;
            self.written.ladder = now.ladder;
        }
        let gone: Vec<u16> = self
            .written
            .programs
            .keys()
            .filter(|number| !now.programs.contains_key(number))
            .copied()
            .collect();
        for number in gone {
            self.data.remove_program(number)?;
            self.written.programs.remove(&number);
        }
        for (number, program) in now.programs {
            if self.written.programs.get(&number) == Some(&program) {
                continue;
            }
            let encoding = self.encodings.get(&number).copied().unwrap_or_default();
            let text = program.text().to_owned();
            self.data.store_program(&StoredProgram {
                number,
                text,
                encoding,
            })?;
            self.written.programs.insert(number, program);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::cnc::Request;

    #[test]
    fn a_loaded_ladder_is_kept_even_if_power_goes_at_once() {
        let folder = crate::files::test_folder("kept-ladder");
        let data = Arc::new(DataDir::open(&folder).expect("open"));
        let mut setup = Setup::default();
        let restored = load(&data, &mut setup);
        let mut cnc = Cnc::new(setup);
        let keeper = Keeper::start(Arc::clone(&data), &restored, &cnc).expect("thread");
        let ladder = Ladder::compile("END1\nLD R1.0\nOUT R2.0\nEND2\n").expect("compiles");
        cnc.request(Request::LoadLadder(Arc::new(ladder.clone())))
            .expect("taken");
        cnc.power_cycle();
        keeper.finish(&cnc);
        let mut next = Setup::default();
        assert!(load(&data, &mut next).complaints.is_empty());
        assert_eq!(*next.ladder, ladder);
        std::fs::remove_dir_all(folder).expect("clean");
    }

    #[test]
    fn without_another_ladder_none_is_written() {
        let folder = crate::files::test_folder("own-ladder");
        let data = Arc::new(DataDir::open(&folder).expect("open"));
        let restored = load(&data, &mut Setup::default());
        let cnc = Cnc::new(Setup::default());
        let keeper = Keeper::start(Arc::clone(&data), &restored, &cnc).expect("thread");
        keeper.finish(&cnc);
        assert_eq!(data.ladder(), Loaded::Missing);
        std::fs::remove_dir_all(folder).expect("clean");
    }
}
