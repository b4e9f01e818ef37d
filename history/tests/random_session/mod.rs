//! A machine that records while an operator acts at random: keys, handwheel, faults, edits, the
//! ladder, the serial port.

use gsk_core::cnc::ControlRequest;
use gsk_core::machine::LatheFault;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::setup::Setup;
use gsk_history::history::History;
use gsk_history::machine_part::{MachinePart, NamedJob, PartInput};
use gsk_history::moment::{MachineMoment, RecordedInput};
use gsk_panel::emulator::{Emulator, EmulatorInput, PortRequest, WaitCondition};
use gsk_panel::keys::{KEYS, Key};
use gsk_panel::panel::{FileId, KeyEvent, SerialCable, SerialFile};
use gsk_workpiece::job::Job;
use gsk_workpiece::stock::Stock;
use gsk_workpiece::tool::Tool;

const PROGRAM: &str = "O0001;\nG50 X60 Z20;\nT0101 M03 S800;\nG00 X52 Z2;\nG90 X46 Z-20 F200;\n\
     X42;\nX38 Z-12;\nG01 X30 Z0;\nX38 Z-6;\nG00 X60 Z20;\nM30;\n";

/// A generator with a fixed sequence for a seed (SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, bound: u64) -> u64 {
        self.next() % bound
    }
}

/// A machine that records, as the kernel does.
pub struct Session {
    pub moment: MachineMoment,
    pub history: History,
    pub random: Random,
    pub crashes: u32,
}

impl Session {
    pub fn new(seed: u64, budget_bytes: usize) -> Self {
        let mut emulator = Emulator::new(Setup::default());
        emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
        let start = MachineMoment {
            emulator: emulator.clone(),
            part: MachinePart::default(),
        };
        emulator.record_inputs();
        let mut session = Self {
            moment: MachineMoment {
                emulator,
                ..start.clone()
            },
            history: History::new(start, budget_bytes),
            random: Random(seed),
            crashes: 0,
        };
        let mut job = Job::new(Stock::bar(50.0, 0.0, 60.0));
        job.tools.insert(1, Tool::turning());
        session.change_part(PartInput::Job(Some(Box::new(NamedJob {
            job,
            name: Some("bar.job.ron".to_owned()),
        }))));
        session
    }

    pub fn change_part(&mut self, input: PartInput) {
        self.take_inputs();
        let tick = self.moment.ticks();
        self.history.record_part(tick, input.clone());
        self.moment.part.apply(input);
    }

    pub fn take_inputs(&mut self) {
        let inputs = self.moment.emulator.take_inputs();
        self.history.record_machine(inputs);
    }

    pub fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.moment.emulator.tick();
            let simulation = self.moment.emulator.simulation();
            if self.moment.part.follow_tick(simulation).is_some() {
                self.crashes += 1;
                let emulator = &mut self.moment.emulator;
                emulator.set_fault(LatheFault::DriveZ, true);
                emulator.set_fault(LatheFault::SpindleBlocked, true);
            }
            self.take_inputs();
            self.history
                .follow(&self.moment.emulator, &self.moment.part);
        }
    }

    pub fn press(&mut self, key: Key) {
        self.moment.emulator.key_down(key);
        let hold = 20 + self.random.below(150);
        self.run(hold);
        self.moment.emulator.key_up(key);
        self.run(20);
    }

    /// One random act of an operator or of the machine, and the time after it.
    pub fn act(&mut self) {
        let random = self.random.next();
        let emulator = &mut self.moment.emulator;
        match random % 16 {
            0 => drop(emulator.load_program("O1", PROGRAM)),
            1 | 2 => [Key::Reset, Key::Auto, Key::CycleStart]
                .into_iter()
                .for_each(|key| self.press(key)),
            3 => emulator.turn((random >> 8) as i32 % 200),
            4 => {
                let (_, fault) = LatheFault::ALL[(random >> 8) as usize % LatheFault::ALL.len()];
                emulator.set_fault(fault, random & 256 != 0);
            }
            5 => {
                let bit = BitAddress::new(Area::R, (random >> 8) as u16 % 50, 3);
                let _ = emulator.request(ControlRequest::ForceBit(bit, Some(random & 1 == 0)));
            }
            6 => {
                let halt = ControlRequest::HaltLadder(random & 512 == 0);
                let _ = emulator.request(halt);
            }
            7 => {
                emulator.apply(EmulatorInput::ClearFaults);
                self.press(Key::Reset);
            }
            8 => self.edit(),
            9 => {
                for character in "N10X5".chars() {
                    self.moment.emulator.key(KeyEvent::Type(character));
                    self.run(100);
                }
            }
            10 if random & 0xf00 == 0 => emulator.power_cycle(),
            11 => self.receive(),
            12 => self.change_part(PartInput::NewStock),
            13 => {
                let address = BitAddress::new(Area::X, (random >> 8) as u16 % 3, 5);
                emulator.force_input(address, [None, Some(true)][(random >> 20) as usize & 1]);
            }
            _ => {
                let key = KEYS[(random >> 8) as usize % KEYS.len()].key;
                self.press(key);
            }
        }
        self.take_inputs();
        let pause = self.random.below(1500);
        self.run(pause);
    }

    fn edit(&mut self) {
        let switch = ControlRequest::SetProgramSwitch(true);
        let _ = self.moment.emulator.request(switch);
        for key in [Key::Edit, Key::Program, Key::Down, Key::Delete, Key::Insert] {
            self.press(key);
        }
    }

    fn receive(&mut self) {
        let emulator = &mut self.moment.emulator;
        emulator.connect_cable(SerialCable::Simulated);
        let text = format!("O0002;\nG04 X{};\nM99;\n", self.random.0 % 9);
        let file = SerialFile {
            name: "O0002.CNC".to_owned(),
            text,
        };
        let _ = emulator.receive(file.clone());
        let _ = emulator.request_port(PortRequest::Receive {
            id: FileId::Program(2),
            file,
            overwrite: true,
        });
        let _ = emulator.take_sent();
    }
}

/// Runs a machine with the recorded inputs up to a tick.
pub fn run_on(moment: &mut MachineMoment, inputs: &[RecordedInput], until: u64) {
    let first = inputs.partition_point(|input| input.tick < moment.ticks());
    let rest = inputs[first..].iter().filter(|input| input.tick < until);
    for recorded in rest {
        while moment.ticks() < recorded.tick {
            moment.tick();
        }
        moment.apply(recorded.input.clone());
    }
    while moment.ticks() < until {
        moment.tick();
    }
}
