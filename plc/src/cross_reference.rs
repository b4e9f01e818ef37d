//! Cross reference: lists the instructions that read or write an address.

use std::collections::BTreeSet;

use crate::address::{Area, ByteAddress};
use crate::directive::PlcAddress;
use crate::instruction::{Mnemonic, Operand, OperandKind, Statement};
use crate::ladder::Ladder;

/// How an instruction accesses an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Access {
    /// The instruction reads the address.
    Read,
    /// The instruction writes the address.
    Write,
    /// The instruction reads and writes the address, as timers and counters do.
    ReadWrite,
}

impl Access {
    /// Returns whether the instruction reads the address.
    #[must_use]
    pub const fn is_read(self) -> bool {
        !matches!(self, Access::Write)
    }

    /// Returns whether the instruction writes the address.
    #[must_use]
    pub const fn is_write(self) -> bool {
        !matches!(self, Access::Read)
    }
}

/// One use of an address by an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CrossReference {
    /// Index of the statement in the program, from 0.
    pub statement: usize,
    /// Number of the rung that contains the instruction, from 1.
    pub rung: u32,
    /// Line of the instruction in the source text, from 1.
    pub line: u32,
    /// Name of the instruction that uses the address.
    pub mnemonic: Mnemonic,
    /// Whether the instruction reads or writes the address.
    pub access: Access,
}

/// The bytes, or the bits of one byte, that an operand covers.
struct OperandExtent {
    first: ByteAddress,
    bytes: u16,
    /// Mask of the covered bits in the first byte; 255 for whole bytes.
    mask: u8,
    access: Access,
}

/// The bits of R900 that every CMP writes: its result flags zero, negative and overflow.
const RESULT_FLAGS_WRITE: OperandExtent = OperandExtent {
    first: ByteAddress::new(Area::R, 900),
    bytes: 1,
    mask: 0b10_0011,
    access: Access::Write,
};

impl OperandExtent {
    fn overlaps(&self, subject: PlcAddress) -> bool {
        let (address, mask) = match subject {
            PlcAddress::Bit(bit) => (bit.byte_address(), 1 << (bit.bit & 7)),
            PlcAddress::Byte(byte) => (byte, u8::MAX),
        };
        let inside = self.first.byte..self.first.byte.saturating_add(self.bytes);
        address.area == self.first.area && inside.contains(&address.byte) && self.mask & mask != 0
    }
}

fn operand_extents(statement: &Statement) -> impl Iterator<Item = OperandExtent> + '_ {
    let kinds = statement.mnemonic.row().operands;
    let length = kinds.iter().zip(&statement.operands);
    let length = length
        .filter(|(kind, _)| **kind == OperandKind::Length)
        .find_map(|(_, operand)| match operand {
            Operand::Number(length) => u16::try_from(*length).ok(),
            _ => None,
        })
        .unwrap_or(1);
    let result = (statement.mnemonic == Mnemonic::Cmp).then_some(RESULT_FLAGS_WRITE);
    let operands = kinds.iter().zip(&statement.operands);
    let named = operands.filter_map(move |(kind, operand)| {
        let access = match kind {
            OperandKind::Timer | OperandKind::Counter => Access::ReadWrite,
            kind if kind.is_written() => Access::Write,
            _ => Access::Read,
        };
        let (first, bytes, mask) = match operand {
            Operand::Bit(bit) if *kind == OperandKind::ThreeCoils => {
                (bit.byte_address(), 1, 0b111 << (bit.bit & 7))
            }
            Operand::Bit(bit) => (bit.byte_address(), 1, 1 << (bit.bit & 7)),
            Operand::Byte(byte) if kind.has_instruction_length() && !byte.area.is_entry() => {
                (*byte, length, u8::MAX)
            }
            Operand::Byte(byte) => (*byte, 1, u8::MAX),
            _ => return None,
        };
        Some(OperandExtent {
            first,
            bytes,
            mask,
            access,
        })
    });
    named.chain(result)
}

impl Ladder {
    /// Returns every instruction that reads or writes a bit, byte or entry, in program
    /// order.
    ///
    /// For a byte this includes instructions that use one of its bits or a wider value that
    /// contains it.
    #[must_use]
    pub fn references(&self, subject: PlcAddress) -> Vec<CrossReference> {
        let mut found: Vec<CrossReference> = Vec::new();
        for (at, statement) in self.statements().iter().enumerate() {
            let touching = operand_extents(statement).filter(|extent| extent.overlaps(subject));
            let access = touching
                .map(|extent| extent.access)
                .reduce(|a, b| if a == b { a } else { Access::ReadWrite });
            if let Some(access) = access {
                found.push(CrossReference {
                    statement: at,
                    rung: statement.rung,
                    line: statement.line,
                    mnemonic: statement.mnemonic,
                    access,
                });
            }
        }
        found
    }

    /// Returns every address that the program uses, in address order.
    #[must_use]
    pub fn addresses(&self) -> BTreeSet<PlcAddress> {
        let operands = self.statements().iter().flat_map(|s| &s.operands);
        operands
            .filter_map(|operand| match operand {
                Operand::Bit(bit) => Some(PlcAddress::Bit(*bit)),
                Operand::Byte(byte) => Some(PlcAddress::Byte(*byte)),
                _ => None,
            })
            .collect()
    }
}
