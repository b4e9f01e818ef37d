//! A control, its link, the board, and a spindle that the board drives and sees.

use core::time::Duration;

use gsk_core::cnc::Request;
use gsk_core::machine::link::{LinkConfig, LinkState, Linked};
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Axis;
use gsk_twins::klipper::{KlipperTwin, Make, SpindleMake, Travel};

use crate::bench::{MS, WIRED};

pub const AUTO: BitAddress = key(20, 1);
pub const ZERO: BitAddress = key(20, 3);
pub const FEED_HOLD: BitAddress = key(24, 7);
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

/// A step of Z and the turns of the spindle at that moment.
#[derive(Clone, Copy, Debug)]
pub struct Cut {
    pub place: i64,
    pub turns: f64,
    /// X, pulses.
    pub x: i64,
}

pub struct Lathe {
    pub simulation: Simulation,
    pub linked: Linked,
    pub twin: KlipperTwin,
    /// Board pulses minus the kernel's.
    pub origin: [i64; 2],
    pub cuts: Vec<Cut>,
    /// The host sleeps so many ms between two looks.
    pub sleep: u64,
}

/// The wires of a machine file; without its index.
pub fn wires(index: bool) -> LinkConfig {
    let wired = if index { ", index: \"PC3\"" } else { "" };
    let text = WIRED.replace(", index: \"PC3\"", "").replace(
        "spindle_cw: \"PB4\"",
        &format!("spindle_cw: \"PB4\", spindle_ccw: \"PB5\"{wired}"),
    );
    let config: LinkConfig = ron::from_str(&text).unwrap();
    config.check().unwrap();
    config
}

impl Lathe {
    /// Referenced; gear 1/5: a pulse of Z is 5 µm.
    pub fn new(index: bool, parameters: &[(u16, i32)]) -> Self {
        Self::made(Make::default(), index, parameters)
    }

    /// The same with another board.
    pub fn made(make: Make, index: bool, parameters: &[(u16, i32)]) -> Self {
        let mut setup = Setup::delivered();
        for (number, value) in [(17, 5), (18, 5), (37, 2000)] {
            setup.parameters.set(number, value).unwrap();
        }
        for (number, value) in parameters {
            setup.parameters.set(*number, *value).unwrap();
        }
        // One switch for each axis.
        for bit in [0, 1] {
            setup.parameters.set_bit(7, bit, true).unwrap();
        }
        let mut simulation = Simulation::new(setup);
        for _ in 0..100 {
            simulation.tick();
        }
        let mut twin = KlipperTwin::new(make);
        twin.set_pin("PC2", true);
        for (pin, axis, from, to) in [("PC4", 0, 800, 4800), ("PC6", 1, 400, 2400)] {
            let turn = None;
            twin.put_switch(
                pin,
                Travel {
                    axis,
                    from,
                    to,
                    turn,
                },
            );
        }
        twin.fit_spindle(SpindleMake {
            index: "PC3",
            forward: "PB4",
            reverse: "PB5",
            speed: "PB6",
            top: 2000.0,
            inertia: 0.2,
        });
        let linked = Linked::open(wires(index), &mut simulation, Duration::ZERO);
        let mut lathe = Self {
            simulation,
            linked,
            twin,
            origin: [0; 2],
            cuts: Vec::new(),
            sleep: 1,
        };
        assert!(lathe.wait(3000, |lathe| lathe.linked.state() == LinkState::Locked));
        lathe.press(RESET);
        lathe.press(ZERO);
        for (key, axis) in [(X_PLUS, Axis::X), (Z_PLUS, Axis::Z)] {
            lathe.simulation.cnc.set_panel_key(key, true);
            lathe.wait(60_000, |lathe| *lathe.simulation.cnc.referenced().get(axis));
            lathe.simulation.cnc.set_panel_key(key, false);
            lathe.pass(500);
        }
        assert_eq!(
            (lathe.linked.state(), lathe.alarms()),
            (LinkState::Ready, vec![])
        );
        let [x, z] = lathe.twin.pulses();
        let kernel = lathe.simulation.cnc.pulses();
        lathe.origin = [x - kernel.x.0, z - kernel.z.0];
        lathe.twin.record_steps();
        lathe
    }

    /// The host does nothing for some ms.
    pub fn be_away(&mut self, ms: u32) {
        for _ in 0..ms {
            self.board_ms();
        }
    }

    fn board_ms(&mut self) {
        self.twin.advance(MS);
        let [x, _] = self.twin.pulses();
        for step in self.twin.recorded_steps() {
            if step.axis == 1 {
                self.cuts.push(Cut {
                    place: step.place - self.origin[1],
                    turns: self.twin.spindle_turns(step.at),
                    x: x - self.origin[0],
                });
            }
        }
    }

    pub fn ms(&mut self) {
        self.board_ms();
        if !(self.twin.now() / MS).is_multiple_of(self.sleep) {
            return;
        }
        let now = Duration::from_nanos(self.twin.now());
        let bytes = self.twin.read();
        self.linked.pump(&mut self.simulation, &bytes, now);
        while self.linked.may_tick(&mut self.simulation) {
            self.linked.tick(&mut self.simulation);
        }
        let tx = self.linked.tx().to_vec();
        self.twin.write(&tx);
        self.linked.consumed(tx.len());
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

    pub fn alarms(&self) -> Vec<String> {
        let alarms = self.simulation.cnc.alarms();
        alarms.iter().map(ToString::to_string).collect()
    }

    /// Loads a program and starts it.
    pub fn start(&mut self, text: &str) {
        let opened = Request::OpenExternal(Program::new(text));
        self.simulation.cnc.request(opened).unwrap();
        self.press(AUTO);
        self.cuts.clear();
        self.press(CYCLE_START);
    }

    /// Until nothing runs and moves any more.
    pub fn finish(&mut self, limit_ms: u32) {
        let over = self.wait(limit_ms, |lathe| {
            let stands = !lathe.linked.is_behind() && !lathe.simulation.cnc.is_moving();
            stands && lathe.simulation.cnc.run_state() != RunState::Run
        });
        assert!(over, "it goes on and on: {:?}", self.alarms());
        self.pass(300);
    }

    /// The board has made what the kernel has commanded.
    #[track_caller]
    pub fn agrees(&self) {
        let kernel = self.simulation.cnc.pulses();
        let [x, z] = self.twin.pulses();
        let made = [x - self.origin[0], z - self.origin[1]];
        assert_eq!(made, [kernel.x.0, kernel.z.0]);
    }

    /// Program coordinates at a count, X as radius: at rest.
    pub fn offset(&self) -> (f64, f64) {
        let (at, kernel) = (
            self.simulation.cnc.position_absolute(),
            self.simulation.cnc.pulses(),
        );
        (
            at.x - kernel.x.0 as f64 / 400.0,
            at.z - kernel.z.0 as f64 / 200.0,
        )
    }
}
