//! The whole control with such a board in place of its simulated slides.

use core::time::Duration;

use gsk_core::cnc::Request;
use gsk_core::machine::link::LinkConfig;
use gsk_core::machine::link::{LinkState, Linked};
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Axis;
use gsk_twins::klipper::{KlipperTwin, Make, Travel};

use crate::bench::{MS, config};

const SHAFT: &str = include_str!("../../../assets/programs/01-stepped-shaft.CNC");
const PIN: &str = include_str!("../../../assets/programs/03-grooved-pin.CNC");
const GROOVE: &str = include_str!("../../../assets/programs/O1031.CNC");

pub const AUTO: BitAddress = key(20, 1);
pub const ZERO: BitAddress = key(20, 3);
pub const CYCLE_START: BitAddress = key(25, 0);
pub const X_PLUS: BitAddress = key(23, 1);
pub const Z_PLUS: BitAddress = key(22, 7);
pub const RESET: BitAddress = key(26, 0);

pub const fn key(byte: u16, bit: u8) -> BitAddress {
    BitAddress {
        area: Area::X,
        byte,
        bit,
    }
}

#[derive(Clone)]
pub struct Machine {
    pub simulation: Simulation,
    pub linked: Linked,
    pub twin: KlipperTwin,
    pub worst_queue: usize,
}

impl Machine {
    /// Electronic gear 1/5, one switch for each axis 2 mm beyond where the slides stand.
    pub fn new() -> Self {
        Self::with(config(), &[])
    }

    /// The same with other wires and parameter bits.
    pub fn with(config: LinkConfig, bits: &[(u16, u8, bool)]) -> Self {
        let bits = [&[(7, 0, true), (7, 1, true)], bits].concat();
        let mut machine = Self::wired(config, &bits, [0, 0]);
        for (pin, axis, from, to) in [("PC4", 0, 800, 4800), ("PC6", 1, 400, 2400)] {
            let turn = None;
            let travel = Travel {
                axis,
                from,
                to,
                turn,
            };
            machine.twin.put_switch(pin, travel);
        }
        machine
    }

    /// Electronic gear 1/5, parameter bits, and where the slides stand in pulses.
    pub fn wired(config: LinkConfig, bits: &[(u16, u8, bool)], slides: [i64; 2]) -> Self {
        let mut setup = Setup::delivered();
        for number in [17, 18] {
            setup.parameters.set(number, 5).unwrap();
        }
        for (number, bit, value) in bits {
            setup.parameters.set_bit(*number, *bit, *value).unwrap();
        }
        let mut simulation = Simulation::new(setup);
        for _ in 0..100 {
            simulation.tick();
        }
        let mut twin = KlipperTwin::new(Make::default());
        twin.set_pin("PC2", true);
        twin.put_slides(slides);
        let linked = Linked::open(config, &mut simulation, Duration::ZERO);
        Self {
            simulation,
            linked,
            twin,
            worst_queue: 0,
        }
    }

    pub fn ms(&mut self) {
        self.twin.advance(MS);
        let now = Duration::from_nanos(self.twin.now());
        let bytes = self.twin.read();
        self.linked.pump(&mut self.simulation, &bytes, now);
        while self.linked.may_tick(&mut self.simulation) {
            self.linked.tick(&mut self.simulation);
        }
        let tx = self.linked.tx().to_vec();
        self.twin.write(&tx);
        self.linked.consumed(tx.len());
        self.worst_queue = self.worst_queue.max(self.twin.figures().queue);
    }

    pub fn pass(&mut self, ms: u32) {
        for _ in 0..ms {
            self.ms();
        }
    }

    pub fn wait(&mut self, limit_ms: u32, until: impl Fn(&Self) -> bool) -> bool {
        (0..limit_ms).any(|_| {
            self.ms();
            until(self)
        })
    }

    pub fn press(&mut self, key: BitAddress) {
        for down in [true, false] {
            self.simulation.cnc.set_panel_key(key, down);
            self.pass(100);
        }
    }

    /// Both axes return to their machine zero.
    pub fn return_axes(&mut self) {
        assert!(self.wait(3000, |machine| machine.linked.state() == LinkState::Locked));
        self.press(RESET);
        self.press(ZERO);
        for (key, axis) in [(X_PLUS, Axis::X), (Z_PLUS, Axis::Z)] {
            // 011.2 ZNIK is off: the key has to be held.
            self.simulation.cnc.set_panel_key(key, true);
            self.wait(60_000, |machine| {
                *machine.simulation.cnc.referenced().get(axis)
            });
            self.simulation.cnc.set_panel_key(key, false);
            self.pass(500);
        }
    }

    pub fn alarms(&self) -> Vec<String> {
        let alarms = self.simulation.cnc.alarms();
        alarms.iter().map(ToString::to_string).collect()
    }
}

#[test]
fn reference_return_and_the_samples_end_on_the_pulse_of_the_kernel() {
    // EVERY_SAMPLE=1 runs the long one too.
    let every = std::env::var_os("EVERY_SAMPLE").is_some();
    let samples = [(PIN, Some(GROOVE)), (SHAFT, None)];
    for (main, sub) in samples.into_iter().take(if every { 2 } else { 1 }) {
        let mut machine = Machine::new();
        machine.return_axes();
        assert_eq!(
            (machine.linked.state(), machine.alarms()),
            (LinkState::Ready, vec![])
        );
        // Past the switches and back to them.
        let [x, z] = machine.twin.pulses();
        assert_eq!((x, z), (4800, 2400));
        let kernel = machine.simulation.cnc.pulses();
        let origin = (x - kernel.x.0, z - kernel.z.0);

        if let Some(sub) = sub {
            let stored = Request::StoreProgram(sub.to_owned());
            machine.simulation.cnc.request(stored).unwrap();
        }
        let opened = Request::OpenExternal(Program::new(main));
        machine.simulation.cnc.request(opened).unwrap();
        machine.press(AUTO);
        machine.press(CYCLE_START);
        for _ in 0..3_600_000 {
            machine.ms();
            if machine.linked.is_behind() || machine.simulation.cnc.is_moving() {
                continue;
            }
            match machine.simulation.cnc.run_state() {
                RunState::Run => {}
                RunState::Stop if machine.alarms().is_empty() => machine.press(CYCLE_START),
                _ => break,
            }
        }
        assert!(machine.alarms().is_empty(), "{:?}", machine.alarms());
        assert_eq!(machine.simulation.cnc.run_state(), RunState::Reset);
        let kernel = machine.simulation.cnc.pulses();
        let [x, z] = machine.twin.pulses();
        assert_eq!((x - origin.0, z - origin.1), (kernel.x.0, kernel.z.0));
        assert!(machine.twin.figures().steps > 20_000);
        assert!(machine.worst_queue <= 625);
        assert_eq!(machine.linked.state(), LinkState::Ready);
    }
}
