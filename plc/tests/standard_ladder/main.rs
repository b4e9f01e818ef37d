//! Tests the standard ladder as the control drives it: panel keys and machine inputs in X,
//! the state of the CNC in F, results in G, Y and A.

#![allow(
    clippy::unwrap_used,
    reason = "a test that cannot go on should say where"
)]

mod listing;
mod machine;
mod operation;
mod spindle;
mod turret;

use std::sync::Arc;

use gsk_plc::{BitAddress, Ladder, Plc};

const SOURCE: &str = include_str!("../../../assets/ladder/standard.il");

/// Mode code in G43 and the bit with which the CNC confirms it.
const EDIT: (u8, &str) = (3, "F3.6");
const AUTO: (u8, &str) = (1, "F3.5");
const MDI: (u8, &str) = (0, "F3.3");
const HANDWHEEL: (u8, &str) = (4, "F3.1");
const JOG: (u8, &str) = (5, "F3.2");
const MACHINE_ZERO: (u8, &str) = (133, "F4.5");
const PROGRAM_ZERO: (u8, &str) = (2, "F4.6");
const MODES: [(u8, &str); 7] = [EDIT, AUTO, MDI, HANDWHEEL, JOG, MACHINE_ZERO, PROGRAM_ZERO];

/// A lathe control that consists only of its PLC.
struct Control {
    plc: Plc,
}

impl Control {
    /// Creates a control with factory parameters and the inputs of an idle machine, in JOG
    /// mode.
    fn new() -> Control {
        let ladder = Ladder::compile(SOURCE).unwrap();
        let mut control = Control {
            plc: Plc::new(Arc::new(ladder)),
        };
        let memory = control.plc.memory_mut();
        memory.set_f(205, 0b0000_0010); // TSGN=1, TCPS=0, ZNIK=0
        memory.set_f(207, 4); // four stations
        memory.set_f(208, 0b1110_0100);
        memory.set_f(210, 0b0110_0000); // external start and hold masked
        control.set("X0.5", true);
        control.set("X0.3", true);
        control.set("X1.3", true);
        control.station(1);
        control.cycles(2);
        control.mode(JOG);
        control
    }

    fn set(&mut self, bit: &str, value: bool) {
        self.plc.memory_mut().set_bit(address(bit), value);
    }

    fn is(&self, bit: &str) -> bool {
        self.plc.memory().bit(address(bit))
    }

    /// Runs a number of whole cycles of level 2.
    fn cycles(&mut self, number: usize) {
        for _ in 0..number * self.plc.ladder().part_count() {
            self.plc.run_slot();
        }
    }

    fn milliseconds(&mut self, time: usize) {
        for _ in 0..time / 8 {
            self.plc.run_slot();
        }
    }

    fn press(&mut self, key: &str) {
        self.set(key, true);
        self.cycles(3);
        self.set(key, false);
        self.cycles(3);
    }

    /// Sets the mode of the CNC in G43 and its confirmation bit.
    fn mode(&mut self, (code, check): (u8, &str)) {
        self.plc.memory_mut().set_g(43, code);
        for (_, other) in MODES {
            self.set(other, other == check);
        }
        self.cycles(3);
    }

    /// Writes an M code with its strobe. The CNC clears the strobe after FIN.
    fn request_m(&mut self, code: u8) {
        self.plc.memory_mut().set_f(10, code);
        self.set("F7.0", true);
    }

    /// Runs until FIN, ends the handshake and returns the time until FIN, ms.
    fn finish(&mut self, strobe: &str) -> Option<usize> {
        let time = (0..20_000).step_by(8).find(|_| {
            self.plc.run_slot();
            self.is("G4.3")
        })?;
        self.milliseconds(16);
        self.set(strobe, false);
        self.plc.memory_mut().set_f(10, 0);
        self.cycles(2);
        assert!(!self.is("G4.3"), "FIN falls after its strobe");
        Some(time + 8)
    }

    fn run_m(&mut self, code: u8) -> Option<usize> {
        self.request_m(code);
        self.finish("F7.0")
    }

    /// Sets the inputs of a turret at one of four stations; 0 is between stations. With
    /// TSGN=1 an open contact is valid.
    fn station(&mut self, station: usize) {
        for (number, pin) in ["X1.6", "X1.7", "X0.0", "X0.1"].into_iter().enumerate() {
            self.set(pin, number + 1 != station);
        }
    }

    fn reset(&mut self) {
        self.set("F1.1", true);
        for strobe in ["F7.0", "F7.2", "F7.3"] {
            self.set(strobe, false);
        }
        self.milliseconds(32);
        self.set("F1.1", false);
        self.cycles(2);
    }

    fn messages(&self) -> Vec<u16> {
        self.plc
            .active_messages()
            .map(|(number, _)| number)
            .collect()
    }
}

fn address(bit: &str) -> BitAddress {
    bit.parse().unwrap()
}
