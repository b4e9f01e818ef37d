//! The control's battery-backed memory and the data directory: loading at the
//! start, saving while the control runs.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::thread::{self, JoinHandle};

use crossbeam::channel::{Receiver, Sender, bounded};
use gsk_core::alarm::Alarm;
use gsk_core::cnc::Cnc;
use gsk_core::command::ProgramId;
use gsk_core::memory::{
    Authority, Counters, Disks, Offsets, Parameters, PitchTable, Settings, Variables,
};
use gsk_core::plc::{Ladder, Retained as PlcRetained};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::units::{PerAxis, Point};
use gsk_panel::emulator::Emulator;
use gsk_panel::panel::PanelRetained;
use serde::{Deserialize, Serialize};

use crate::files::data_dir::{DataDir, Loaded, StoredProgram};
use crate::files::decode::Encoding;

/// Looks between two savings of what changes all the time in a run: counters and
/// position.
const COUNTER_LOOKS: u32 = 100;

/// Alarm 069: the memory is damaged; 101: power failed while a program was written.
const DAMAGED: u16 = 69;
const INTERRUPTED: u16 = 101;

/// Where the slides stand, and what the display says of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    /// Machine coordinates (X as a radius), mm.
    pub machine: Point,
    /// Absolute coordinates.
    pub absolute: Point,
    /// Axes whose machine zero was set by hand (zero return of method A).
    #[serde(default)]
    pub zero_kept: PerAxis<bool>,
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
    authority: Authority,
    disks: Disks,
    plc: PlcRetained,
    programs: BTreeMap<u16, Program>,
    selected: Option<u16>,
    standing: Option<Standing>,
    panel: Option<PanelRetained>,
    /// The ladder that the next power-on runs.
    ladder: Arc<Ladder>,
}

impl Memory {
    fn of(cnc: &Cnc) -> Self {
        let selected = match cnc.programs().current() {
            Some(ProgramId::Stored(number)) => Some(number),
            _ => None,
        };
        Self {
            parameters: cnc.parameters().clone(),
            offsets: cnc.offsets().clone(),
            pitch: cnc.pitch().clone(),
            counters: cnc.counters(),
            variables: cnc.variables().clone(),
            settings: cnc.settings(),
            authority: cnc.authority().clone(),
            disks: cnc.disks().clone(),
            plc: cnc.plc().memory().retained(),
            programs: cnc
                .programs()
                .iter()
                .map(|(number, program)| (number, program.clone()))
                .collect(),
            selected,
            ladder: Arc::clone(cnc.next_ladder().unwrap_or(cnc.plc().ladder())),
            standing: None,
            panel: None,
        }
    }

    /// With what the whole emulator keeps besides the control.
    fn of_emulator(emulator: &Emulator) -> Self {
        let cnc = &emulator.simulation.cnc;
        Self {
            standing: Some(Standing {
                machine: cnc.position_machine(),
                absolute: cnc.position_absolute(),
                zero_kept: cnc.reference_without_switch(),
            }),
            panel: Some(emulator.panel.retained()),
            ..Self::of(cnc)
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
    /// Where the slides stood.
    pub standing: Option<Standing>,
    /// What the panel kept.
    pub panel: Option<PanelRetained>,
}

impl Restored {
    /// Puts the slides where they stood: for sessions that go on with the machine.
    pub fn place(&self, setup: &mut Setup) {
        if let Some(standing) = self.standing {
            setup.start = Some(standing.machine);
            setup.absolute = Some(standing.absolute);
            setup.zero_kept = standing.zero_kept;
        }
    }

    /// Gives the panel back what it kept.
    pub fn restore_panel(&self, emulator: &mut Emulator) {
        if let Some(panel) = &self.panel {
            emulator.panel.restore(panel);
        }
    }
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
    take(data.load("settings"), &mut setup.settings, &mut complaints);
    take(
        data.load("authority"),
        &mut setup.authority,
        &mut complaints,
    );
    take(data.load("disks"), &mut setup.disks, &mut complaints);
    let mut selected = None;
    take(data.load("selected"), &mut selected, &mut complaints);
    let mut standing = None;
    take(data.load("standing"), &mut standing, &mut complaints);
    let mut panel = None;
    take(data.load("panel"), &mut panel, &mut complaints);
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
    if let Some(number) = selected {
        setup.programs.select(ProgramId::Stored(number));
    }
    if !complaints.is_empty() {
        let names = damaged_names(&complaints);
        setup.alarms.push(Alarm::new(DAMAGED).because(names));
    }
    if !data.interrupted().is_empty() {
        let names = data.interrupted().join(", ");
        setup.alarms.push(Alarm::new(INTERRUPTED).because(names));
    }
    Restored {
        encodings,
        complaints,
        standing,
        panel,
    }
}

/// The names of the files that the sentences are about.
fn damaged_names(complaints: &[String]) -> String {
    let names = complaints.iter().map(|said| {
        let path = said.split(" is damaged").next().unwrap_or(said);
        path.rsplit(['/', '\\']).next().unwrap_or(path)
    });
    names.collect::<Vec<_>>().join(", ")
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
    Writer::new(Arc::new(data), restored, Arc::clone(&now.ladder)).write(now)
}

/// Writes the memory of a whole emulator into its directory, once.
pub fn save_emulator(
    data: DataDir,
    restored: &Restored,
    emulator: &Emulator,
) -> Result<(), String> {
    let now = Memory::of_emulator(emulator);
    Writer::new(Arc::new(data), restored, Arc::clone(&now.ladder)).write(now)
}

/// A memory to be written, and who waits for it.
type Job = (Memory, Option<Sender<()>>);

/// Watches the memory and saves what has changed, in a thread of its own: a slow
/// disk never holds up the kernel.
pub struct Keeper {
    last: Memory,
    looks: u32,
    to_disk: Option<Sender<Job>>,
    complaints: Receiver<String>,
    thread: Option<JoinHandle<()>>,
}

impl Keeper {
    /// Starts to keep the memory of a control in a directory.
    pub fn start(
        data: Arc<DataDir>,
        restored: &Restored,
        emulator: &Emulator,
    ) -> std::io::Result<Self> {
        let (to_disk, from_kernel) = bounded::<Job>(1);
        let (say, complaints) = bounded(16);
        let last = Memory::of_emulator(emulator);
        let mut writer = Writer {
            data,
            encodings: restored.encodings.clone(),
            knows: true,
            written: last.clone(),
        };
        let thread = thread::Builder::new()
            .name("memory".to_owned())
            .spawn(move || {
                for (memory, waiting) in from_kernel {
                    if let Err(complaint) = writer.write(memory) {
                        let _ = say.try_send(complaint);
                    }
                    if let Some(waiting) = waiting {
                        let _ = waiting.send(());
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
    pub fn look(&mut self, emulator: &Emulator) {
        self.looks += 1;
        let now = Memory::of_emulator(emulator);
        if now == self.last {
            return;
        }
        // A machine zero set by hand is no small thing of the moment.
        let places = |(now, last): (Standing, Standing)| Standing {
            zero_kept: now.zero_kept,
            ..last
        };
        let only_counters = Memory {
            counters: self.last.counters,
            standing: now.standing.zip(self.last.standing).map(places),
            ..now.clone()
        } == self.last;
        if only_counters && self.looks < COUNTER_LOOKS {
            return;
        }
        // A disk that still writes the last one gets this one at the next look.
        if let Some(to_disk) = &self.to_disk
            && to_disk.try_send((now.clone(), None)).is_ok()
        {
            self.last = now;
            self.looks = 0;
        }
    }

    /// Saves everything and waits until it is on the disk.
    pub fn settle(&mut self, emulator: &Emulator) {
        let (done, written) = bounded(1);
        let now = Memory::of_emulator(emulator);
        if let Some(to_disk) = &self.to_disk
            && to_disk.send((now.clone(), Some(done))).is_ok()
            && written.recv().is_ok()
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
    pub fn finish(mut self, emulator: &Emulator) {
        if let Some(to_disk) = self.to_disk.take() {
            let _ = to_disk.send((Memory::of_emulator(emulator), None));
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
    /// `written` is what is on the disk. Else all of it is written: a value that was
    /// set back to its default is no reason to leave the old one there.
    knows: bool,
    written: Memory,
}

impl Writer {
    /// A writer that knows nothing of what is on the disk, but for the ladder: only
    /// the window loads another one.
    fn new(data: Arc<DataDir>, restored: &Restored, ladder: Arc<Ladder>) -> Self {
        Self {
            data,
            encodings: restored.encodings.clone(),
            knows: false,
            written: Memory {
                parameters: Parameters::default(),
                offsets: Offsets::default(),
                pitch: PitchTable::default(),
                counters: Counters::default(),
                variables: Variables::default(),
                settings: Settings::default(),
                authority: Authority::default(),
                disks: Disks::default(),
                plc: PlcRetained::default(),
                programs: BTreeMap::new(),
                selected: None,
                standing: None,
                panel: None,
                ladder,
            },
        }
    }

    fn write(&mut self, now: Memory) -> Result<(), String> {
        let data = &self.data;
        let knows = self.knows;
        let was = &mut self.written;
        store(
            data,
            "parameters",
            knows,
            &mut was.parameters,
            now.parameters,
        )?;
        store(data, "offsets", knows, &mut was.offsets, now.offsets)?;
        store(data, "pitch", knows, &mut was.pitch, now.pitch)?;
        store(data, "counters", knows, &mut was.counters, now.counters)?;
        store(data, "variables", knows, &mut was.variables, now.variables)?;
        store(data, "settings", knows, &mut was.settings, now.settings)?;
        store(data, "authority", knows, &mut was.authority, now.authority)?;
        store(data, "disks", knows, &mut was.disks, now.disks)?;
        store(data, "plc", knows, &mut was.plc, now.plc)?;
        if now.standing.is_some() {
            store(data, "standing", knows, &mut was.standing, now.standing)?;
        }
        if now.panel.is_some() {
            store(data, "panel", knows, &mut was.panel, now.panel)?;
        }
        // New texts first: a program that gets another number is never nowhere.
        for (number, program) in &now.programs {
            if was.programs.get(number) == Some(program) {
                continue;
            }
            data.store_program(&StoredProgram {
                number: *number,
                text: program.text().to_owned(),
                encoding: self.encodings.get(number).copied().unwrap_or_default(),
            })?;
            was.programs.insert(*number, program.clone());
        }
        if now.ladder != was.ladder {
            data.store_ladder(&now.ladder)?;
            was.ladder = now.ladder;
        }
        let on_disk: Vec<u16> = match knows {
            true => was.programs.keys().copied().collect(),
            false => self.encodings.keys().copied().collect(),
        };
        let gone = on_disk
            .into_iter()
            .filter(|number| !now.programs.contains_key(number));
        for number in gone {
            data.remove_program(number)?;
            was.programs.remove(&number);
        }
        store(data, "selected", knows, &mut was.selected, now.selected)?;
        self.knows = true;
        Ok(())
    }
}

/// Writes a value that differs from what is on the disk.
fn store<T: Serialize + PartialEq>(
    data: &DataDir,
    name: &str,
    knows: bool,
    written: &mut T,
    now: T,
) -> Result<(), String> {
    if !knows || *written != now {
        data.store(name, &now)?;
        *written = now;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::cnc::Request;
    use gsk_core::units::Axis;

    #[test]
    fn a_loaded_ladder_is_kept_even_if_power_goes_at_once() {
        let folder = crate::files::test_folder("kept-ladder");
        let data = Arc::new(DataDir::open(&folder).expect("open"));
        let mut setup = Setup::default();
        let restored = load(&data, &mut setup);
        let mut emulator = Emulator::new(setup);
        let keeper = Keeper::start(Arc::clone(&data), &restored, &emulator).expect("thread");
        let ladder = Ladder::compile("END1\nLD R1.0\nOUT R2.0\nEND2\n").expect("compiles");
        let cnc = &mut emulator.simulation.cnc;
        cnc.request(Request::SetParameterSwitch(true)).expect("on");
        let edit_key = "X20.0".parse().expect("an address");
        emulator.simulation.cnc.set_panel_key(edit_key, true);
        emulator.run(100);
        let cnc = &mut emulator.simulation.cnc;
        cnc.request(Request::LoadLadder(Arc::new(ladder.clone())))
            .expect("taken");
        cnc.power_cycle();
        keeper.finish(&emulator);
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
        let emulator = Emulator::new(Setup::default());
        let keeper = Keeper::start(Arc::clone(&data), &restored, &emulator).expect("thread");
        keeper.finish(&emulator);
        assert_eq!(data.ladder(), Loaded::Missing);
        std::fs::remove_dir_all(folder).expect("clean");
    }

    #[test]
    fn what_is_set_back_or_deleted_is_so_on_the_disk_too() {
        let folder = crate::files::test_folder("set-back");
        let keep = |change: fn(&mut Setup)| {
            let data = DataDir::open(&folder).expect("open");
            let mut setup = Setup::default();
            let restored = load(&data, &mut setup);
            change(&mut setup);
            save(data, &restored, &Emulator::new(setup).simulation.cnc).expect("saved");
        };
        keep(|setup| {
            setup.parameters.set(24, 584).expect("in range");
            setup.programs.store("O0007;\nM30;\n").expect("stored");
        });
        keep(|setup| {
            let delivered = Parameters::default().value(24);
            assert_eq!(setup.parameters.value(24), 584);
            setup.parameters.set(24, delivered).expect("in range");
            setup.programs.delete(7).expect("deleted");
        });
        let data = DataDir::open(&folder).expect("open");
        let mut setup = Setup::default();
        load(&data, &mut setup);
        assert_eq!(setup.parameters.value(24), Parameters::default().value(24));
        assert!(setup.programs.stored(7).is_none());
        std::fs::remove_dir_all(folder).expect("clean");
    }

    #[test]
    fn a_damaged_file_is_alarm_069_and_a_broken_off_writing_101() {
        let folder = crate::files::test_folder("alarms-of-the-memory");
        std::fs::create_dir_all(folder.join("programs")).expect("make");
        std::fs::write(folder.join("offsets.ron"), "(1, 2").expect("write");
        std::fs::write(folder.join("programs/O0003.CNC.new"), "O00").expect("write");
        let data = DataDir::open(&folder).expect("open");
        let mut setup = Setup::default();
        load(&data, &mut setup);
        let emulator = Emulator::new(setup);
        let alarms = emulator.simulation.cnc.alarms();
        let said = |number| alarms.iter().find(|alarm| alarm.number == number);
        let detail = |number| said(number).and_then(|alarm| alarm.detail.as_deref());
        assert!(detail(69).is_some_and(|detail| detail.contains("offsets.ron")));
        assert!(detail(101).is_some_and(|detail| detail.contains("O0003")));
        std::fs::remove_dir_all(folder).expect("clean");
    }

    /// Method A: 014.0, 014.1 = 0; 取消 and the letter of the axis set the zero.
    #[test]
    fn a_machine_zero_set_by_hand_outlasts_the_process() {
        let folder = crate::files::test_folder("zero-kept");
        let data = Arc::new(DataDir::open(&folder).expect("open"));
        let without_switch = || {
            let mut setup = Setup::delivered();
            setup.parameters.set_bit(14, 1, false).expect("bit");
            setup
        };
        let mut setup = without_switch();
        let restored = load(&data, &mut setup);
        let mut emulator = Emulator::new(setup);
        let mut keeper = Keeper::start(Arc::clone(&data), &restored, &emulator).expect("thread");
        let cnc = &mut emulator.simulation.cnc;
        cnc.request(Request::SetMachineZero(Axis::Z)).expect("set");
        keeper.look(&emulator);
        keeper.finish(&emulator);
        let mut next = without_switch();
        load(&data, &mut next).place(&mut next);
        let next = Emulator::new(next);
        let referenced = next.simulation.cnc.reference_without_switch();
        assert!(referenced.z && !referenced.x);
        std::fs::remove_dir_all(folder).expect("clean");
    }
}
