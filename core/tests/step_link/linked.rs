//! The whole control with such a board in place of its simulated slides.

use core::time::Duration;

use gsk_core::cnc::Request;
use gsk_core::machine::link::{LinkState, Linked};
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_twins::klipper::{KlipperTwin, Make};

use crate::bench::{MS, config};

const SHAFT: &str = include_str!("../../../assets/programs/01-stepped-shaft.CNC");
const PIN: &str = include_str!("../../../assets/programs/03-grooved-pin.CNC");
const GROOVE: &str = include_str!("../../../assets/programs/O1031.CNC");

const AUTO: BitAddress = key(20, 1);
const ZERO: BitAddress = key(20, 3);
const CYCLE_START: BitAddress = key(25, 0);
const X_PLUS: BitAddress = key(23, 1);
const Z_PLUS: BitAddress = key(22, 7);
const RESET: BitAddress = key(26, 0);

const fn key(byte: u16, bit: u8) -> BitAddress {
    BitAddress {
        area: Area::X,
        byte,
        bit,
    }
}

struct Machine {
    simulation: Simulation,
    linked: Linked,
    twin: KlipperTwin,
    worst_queue: usize,
}

impl Machine {
    /// Electronic gear 1/5, switches 2 mm beyond where the slides stand.
    fn new() -> Self {
        let mut setup = Setup::delivered();
        for number in [17, 18] {
            setup.parameters.set(number, 5).unwrap();
        }
        let mut simulation = Simulation::new(setup);
        for _ in 0..100 {
            simulation.tick();
        }
        let mut twin = KlipperTwin::new(Make::default());
        twin.set_pin("PC2", true);
        let linked = Linked::open(config(), &mut simulation, Duration::ZERO);
        Self {
            simulation,
            linked,
            twin,
            worst_queue: 0,
        }
    }

    fn ms(&mut self) {
        self.twin.advance(MS);
        let [x, z] = self.twin.pulses();
        self.twin.set_pin("PC4", x >= 800);
        self.twin.set_pin("PC6", z >= 400);
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

    fn pass(&mut self, ms: u32) {
        for _ in 0..ms {
            self.ms();
        }
    }

    fn wait(&mut self, limit_ms: u32, until: impl Fn(&Self) -> bool) -> bool {
        (0..limit_ms).any(|_| {
            self.ms();
            until(self)
        })
    }

    fn press(&mut self, key: BitAddress) {
        for down in [true, false] {
            self.simulation.cnc.set_panel_key(key, down);
            self.pass(100);
        }
    }

    fn alarms(&self) -> Vec<String> {
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
        assert!(machine.wait(3000, |machine| machine.linked.state() == LinkState::Locked));
        machine.press(RESET);
        machine.press(ZERO);
        for axis in [X_PLUS, Z_PLUS] {
            machine.press(axis);
            machine.wait(60_000, |machine| {
                !matches!(machine.linked.state(), LinkState::Homing)
            });
            machine.pass(500);
        }
        assert_eq!(
            (machine.linked.state(), machine.alarms()),
            (LinkState::Ready, vec![])
        );
        // The switches let go at 800 and 400; then comes a millimetre.
        let [x, z] = machine.twin.pulses();
        assert!(
            (398..=400).contains(&x) && (198..=200).contains(&z),
            "{x} {z}"
        );
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
