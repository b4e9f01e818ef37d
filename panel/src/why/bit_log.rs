//! Records since when the bits of the PLC have their values, and which inputs changed just before.

use std::collections::{BTreeMap, VecDeque};

use gsk_core::cnc::Cnc;
use gsk_core::plc::address::{Area, BitAddress, ByteAddress};
use gsk_core::plc::{PlcAddress, PlcMemory};

/// Time within which a change of an input counts as the trigger of a later change, ticks. By then
/// the whole ladder has run with the input.
const TRIGGER_TICKS: u64 = 64;

/// Areas whose changes are recorded: the bits of the first ones, and the counters.
const AREAS: [Area; 8] = [
    Area::X,
    Area::Y,
    Area::F,
    Area::G,
    Area::R,
    Area::A,
    Area::K,
    Area::C,
];
/// First byte of R with the flags of comparisons: the flags change with every comparison.
const FIRST_FLAG_BYTE: u16 = 900;

/// A change of an input of the ladder: X from the machine and the keys, F from the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InputChange {
    /// The PLC input that has changed.
    pub bit: BitAddress,
    /// Value of the input after the change.
    pub value: bool,
    /// Tick in which the input changed.
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
    /// The memory at the last change; `None` before the first call.
    last_memory: Option<PlcMemory>,
    changes: BTreeMap<PlcAddress, AddressChange>,
    recent_inputs: VecDeque<InputChange>,
}

impl BitLog {
    /// Compares the memory of the PLC with that of the last call and records the changes with the
    /// time `tick`. Restarts the log if time goes back.
    pub fn follow_tick(&mut self, cnc: &Cnc, tick: u64) {
        if tick < self.last_tick {
            // Another machine, or an earlier moment of it.
            *self = Self::default();
        }
        self.last_tick = tick;
        let memory = cnc.plc().memory();
        let Some(last) = self.last_memory.take() else {
            self.last_memory = Some(memory.clone());
            return;
        };
        while (self.recent_inputs.front()).is_some_and(|it| it.tick + TRIGGER_TICKS < tick) {
            self.recent_inputs.pop_front();
        }
        let mut has_changed = false;
        for area in AREAS {
            let (before, now) = (last.area(area), memory.area(area));
            // Nearly always nothing has changed.
            if before != now {
                has_changed = true;
                self.record_area(area, before, now, tick);
            }
        }
        self.last_memory = Some(match has_changed {
            true => memory.clone(),
            false => last,
        });
    }

    fn record_area(&mut self, area: Area, before: &[u8], now: &[u8], tick: u64) {
        let width = if area.is_entry() { 4 } else { 1 };
        let pairs = before.chunks(width).zip(now.chunks(width));
        for (number, (before, now)) in (0..).zip(pairs) {
            if before == now || (area == Area::R && number >= FIRST_FLAG_BYTE) {
                continue;
            }
            let (&[before], &[now]) = (before, now) else {
                self.record_change(PlcAddress::Byte(ByteAddress::new(area, number)), tick);
                continue;
            };
            for bit in (0..8).filter(|bit| (before ^ now) >> bit & 1 == 1) {
                let bit_address = BitAddress::new(area, number, bit);
                self.record_bit(bit_address, now >> bit & 1 == 1, tick);
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
