//! Remembers since when the bits of the ladder have their values.

use gsk_core::cnc::Cnc;
use gsk_core::plc::PlcAddress;
use gsk_core::plc::address::BitAddress;

/// The last change of each bit that the ladder uses.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BitLog {
    /// Bit, its value, and the tick of its last change; `None` while it has not changed.
    bits: Vec<(BitAddress, bool, Option<u64>)>,
}

impl BitLog {
    /// Compares the bits with those of the last tick. Call it after every tick; `tick` is the
    /// time stamp of a change.
    pub fn follow_tick(&mut self, cnc: &Cnc, tick: u64) {
        let memory = cnc.plc().memory();
        if self.bits.is_empty() {
            let addresses = cnc.plc().ladder().addresses().into_iter();
            self.bits = addresses
                .filter_map(|address| match address {
                    PlcAddress::Bit(bit) => Some((bit, memory.bit(bit), None)),
                    PlcAddress::Byte(_) => None,
                })
                .collect();
            return;
        }
        for (bit, value, since) in &mut self.bits {
            let now = memory.bit(*bit);
            if now != *value {
                *value = now;
                *since = Some(tick);
            }
        }
    }

    /// The tick at which a bit took its value; `None` if it has not changed since the log began.
    pub fn since(&self, bit: BitAddress) -> Option<u64> {
        let at = self.bits.binary_search_by_key(&bit, |(bit, ..)| *bit).ok()?;
        self.bits.get(at).and_then(|(.., since)| *since)
    }
}
