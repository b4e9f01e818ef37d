//! The M functions that a program has output before a block, by the equipment that they switch.

use std::collections::{BTreeMap, BTreeSet};

/// A device of the lathe, such as coolant or chuck, that M functions switch between a few states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Equipment {
    Chuck,
    Tailstock,
    Gear,
    Spindle,
    Coolant,
    Lubrication,
}

impl Equipment {
    const fn from_code(code: u8) -> Option<Self> {
        Some(match code {
            3..=5 => Self::Spindle,
            8 | 9 => Self::Coolant,
            10 | 11 => Self::Tailstock,
            12 | 13 => Self::Chuck,
            32 | 33 => Self::Lubrication,
            41..=44 => Self::Gear,
            _ => return None,
        })
    }
}

/// The last M code for each device of the lathe, and the M codes with another effect.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MachineFunctions {
    last: BTreeMap<Equipment, u8>,
    others: BTreeSet<u8>,
}

impl MachineFunctions {
    /// Records the M code of a block that begins.
    pub(super) fn add(&mut self, code: u8) {
        match Equipment::from_code(code) {
            Some(equipment) => {
                self.last.insert(equipment, code);
            }
            // Stops, ends and calls switch nothing.
            None if matches!(code, 0..=2 | 30 | 98 | 99) => {}
            None => {
                self.others.insert(code);
            }
        }
    }

    /// The last M code of an equipment; `None` if the program has not switched it.
    pub(super) fn last(&self, equipment: Equipment) -> Option<u8> {
        self.last.get(&equipment).copied()
    }

    /// Returns the M codes that a restart does not repeat, in ascending order.
    pub(super) fn others(&self) -> impl Iterator<Item = u8> + '_ {
        self.others.iter().copied()
    }
}
