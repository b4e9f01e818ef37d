//! Records since when the bits of the PLC have their values, and which inputs changed just before.

use std::collections::{BTreeMap, VecDeque};

use gsk_core::cnc::Cnc;
use gsk_core::plc::PlcAddress;
use gsk_core::plc::address::{Area, BitAddress, ByteAddress};

/// Time within which a change of an input counts as the trigger of a later change, ticks. By then
/// the whole ladder has run with the input.
const TRIGGER_TICKS: u64 = 64;

/// Areas of bytes whose bits are compared. R900 and up have the flags of comparisons, which change
/// with every one.
const BYTE_AREAS: [(Area, u16); 7] = [
    (Area::X, 30),
    (Area::Y, 20),
    (Area::F, 256),
    (Area::G, 256),
    (Area::R, 900),
    (Area::A, 25),
    (Area::K, 30),
];

/// Number of counters whose values are compared.
const COUNTERS: u16 = 100;

/// A change of an input of the ladder: X from the machine and the keys, F from the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InputChange {
    /// The input.
    pub bit: BitAddress,
    /// Its value after the change.
    pub value: bool,
    /// Tick of the change.
    pub tick: u64,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct AddressChange {
    tick: u64,
    triggers: Vec<InputChange>,
}

/// The last change of each bit and counter of the PLC.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BitLog {
    last_tick: u64,
    bytes: Vec<u8>,
    counters: Vec<i32>,
    changes: BTreeMap<PlcAddress, AddressChange>,
    recent_inputs: VecDeque<InputChange>,
}

impl BitLog {
    /// Compares the memory of the PLC with the last call. Begins anew if time goes back. `tick` is the time stamp of a change.
    pub fn follow_tick(&mut self, cnc: &Cnc, tick: u64) {
        if tick < self.last_tick {
            // Another machine, or an earlier moment of it.
            *self = Self::default();
        }
        self.last_tick = tick;
        let memory = cnc.plc().memory();
        let addresses = BYTE_AREAS
            .iter()
            .flat_map(|(area, count)| (0..*count).map(|byte| ByteAddress::new(*area, byte)));
        let is_first = self.bytes.is_empty();
        while (self.recent_inputs.front()).is_some_and(|it| it.tick + TRIGGER_TICKS < tick) {
            self.recent_inputs.pop_front();
        }
        for (at, address) in addresses.enumerate() {
            let now = memory.byte(address);
            if is_first {
                self.bytes.push(now);
                continue;
            }
            let Some(before) = self.bytes.get_mut(at) else {
                return;
            };
            let changed = core::mem::replace(before, now) ^ now;
            for bit in (0..8).filter(|bit| changed >> bit & 1 == 1) {
                let bit = BitAddress::new(address.area, address.byte, bit);
                self.record_bit(bit, memory.bit(bit), tick);
            }
        }
        for counter in 0..COUNTERS {
            let now = memory.long(ByteAddress::new(Area::C, counter));
            if is_first {
                self.counters.push(now);
                continue;
            }
            let Some(before) = self.counters.get_mut(usize::from(counter)) else {
                return;
            };
            if core::mem::replace(before, now) != now {
                let address = PlcAddress::Byte(ByteAddress::new(Area::C, counter));
                self.record_change(address, tick);
            }
        }
    }

    fn record_bit(&mut self, bit: BitAddress, value: bool, tick: u64) {
        self.record_change(PlcAddress::Bit(bit), tick);
        if matches!(bit.area, Area::X | Area::F) {
            let change = InputChange { bit, value, tick };
            self.recent_inputs.push_back(change);
        }
    }

    fn record_change(&mut self, address: PlcAddress, tick: u64) {
        let triggers = self.recent_inputs.iter().copied().collect();
        let change = AddressChange { tick, triggers };
        self.changes.insert(address, change);
    }

    /// The tick of the last change of a bit or counter; `None` if it has not changed since the log
    /// began.
    pub fn since(&self, address: PlcAddress) -> Option<u64> {
        self.changes.get(&address).map(|change| change.tick)
    }

    /// The inputs that changed shortly before the last change of a bit, byte or counter, oldest
    /// first.
    pub fn triggers(&self, address: PlcAddress) -> &[InputChange] {
        let newest = match address {
            PlcAddress::Byte(byte) if !byte.area.is_entry() => (0..8)
                .filter_map(|bit| {
                    let bit = BitAddress::new(byte.area, byte.byte, bit);
                    self.changes.get(&PlcAddress::Bit(bit))
                })
                .max_by_key(|change| change.tick),
            _ => self.changes.get(&address),
        };
        newest.map_or(&[], |change| &change.triggers)
    }
}
