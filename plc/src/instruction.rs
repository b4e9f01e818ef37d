//! The one table of instructions: mnemonic, role in a rung, operands, steps.
//!
//! Parsing, checking, counting of steps, listing and help all read [`TABLE`].

use serde::{Deserialize, Serialize};

use crate::address::{Area, BitAddress, ByteAddress};

/// An instruction of the ladder language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Mnemonic {
    /// Starts a rung or branch with a normally open contact.
    Ld,
    /// Starts a rung or branch with a normally closed contact.
    Ldi,
    /// Series contact, normally open.
    And,
    /// Series contact, normally closed.
    Ani,
    /// Parallel contact, normally open.
    Or,
    /// Parallel contact, normally closed.
    Ori,
    /// Series blocks in parallel.
    Orb,
    /// Parallel blocks in series.
    Anb,
    /// Coil.
    Out,
    /// Sets a bit that then stays 1.
    Set,
    /// Resets a bit that then stays 0.
    Rst,
    /// Compares two binary numbers.
    Cmp,
    /// On-delay timer.
    Tmrb,
    /// Counter.
    Ctrc,
    /// Copies a number.
    Movn,
    /// Binary decode: eight successive numbers to eight bits.
    Decb,
    /// Binary code conversion: a table.
    Codb,
    /// Rotation control: shortest way and number of steps.
    Rotb,
    /// Jump to a label.
    Jmpb,
    /// Label.
    Lbl,
    /// Calls a subprogram.
    Call,
    /// Start of a subprogram.
    Sp,
    /// End of a subprogram.
    Spe,
    /// End of level 1.
    End1,
    /// End of level 2.
    End2,
}

/// Where in a rung an instruction may stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstructionRole {
    /// LD, LDI: begin a rung or a branch.
    Start,
    /// Contacts and block instructions inside a rung.
    Contact,
    /// Takes the result of the rung.
    Output,
    /// Stands outside rungs.
    Structure,
}

/// What an operand may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OperandKind {
    /// Any bit: X Y F G R K A.
    Contact,
    /// A bit that may be written: Y G R K A.
    Coil,
    /// The first of three result bits, bit 0 to 5.
    ThreeCoils,
    /// Length of the values: 1, 2 or 4 bytes.
    Length,
    /// A number or any byte or entry.
    Value,
    /// Any byte or entry.
    Source,
    /// A byte or entry that may be written.
    Target,
    /// The byte that receives eight decoded bits.
    DecodeTarget,
    /// The byte with a table index.
    Index,
    /// Where a table value goes.
    TableTarget,
    /// Position of a rotating part.
    Position,
    /// Where a rotation result goes.
    RotationTarget,
    /// A timer T.
    Timer,
    /// A counter C.
    Counter,
    /// A time in ms: a number or DT.
    Time,
    /// A count: a number or DC.
    Count,
    /// A number.
    Number,
    /// Number of stations, from 1.
    Stations,
    /// Code 1 to 8 of a table size 2, 4, … 256.
    TableSize,
    /// Four digits `0 0 CN0 U/D`.
    CounterFormat,
    /// Four digits `RN0 DIR POS INC`.
    RotationFormat,
    /// A label L.
    Label,
    /// A subprogram P.
    Subprogram,
}

/// Areas whose bits can be written.
const COILS: &[Area] = &[Area::Y, Area::G, Area::R, Area::K, Area::A];

impl OperandKind {
    /// Areas an address may lie in; empty when the operand is no address.
    #[must_use]
    pub const fn areas(self) -> &'static [Area] {
        use Area::{A, C, D, Dc, Dt, F, G, K, R, T, X, Y};
        match self {
            OperandKind::Contact => &[X, Y, F, G, R, K, A],
            OperandKind::Coil | OperandKind::ThreeCoils | OperandKind::DecodeTarget => COILS,
            OperandKind::Value | OperandKind::Source => &[R, X, Y, F, G, K, A, D, T, C, Dc, Dt],
            OperandKind::Target => &[R, Y, G, K, A, D, T, C, Dc, Dt],
            OperandKind::Index => &[R, X, Y, G, F, A, K, D],
            OperandKind::TableTarget | OperandKind::RotationTarget => &[R, Y, G, K, A, D, Dt, Dc],
            OperandKind::Position => &[R, X, Y, F, G, K, A, D, Dc, Dt],
            OperandKind::Timer => &[T],
            OperandKind::Counter => &[C],
            OperandKind::Time => &[Dt],
            OperandKind::Count => &[Dc],
            _ => &[],
        }
    }

    /// True when the operand is a single bit.
    #[must_use]
    pub const fn is_bit(self) -> bool {
        matches!(
            self,
            OperandKind::Contact | OperandKind::Coil | OperandKind::ThreeCoils
        )
    }

    /// True when the instruction writes the operand.
    #[must_use]
    pub(crate) const fn is_written(self) -> bool {
        matches!(
            self,
            OperandKind::Coil
                | OperandKind::ThreeCoils
                | OperandKind::Target
                | OperandKind::DecodeTarget
                | OperandKind::TableTarget
                | OperandKind::RotationTarget
        )
    }

    /// True when a plain number may stand here.
    #[must_use]
    pub const fn can_be_number(self) -> bool {
        matches!(
            self,
            OperandKind::Length
                | OperandKind::Value
                | OperandKind::Time
                | OperandKind::Count
                | OperandKind::Number
                | OperandKind::Stations
                | OperandKind::TableSize
        )
    }

    /// True when the operand is as many bytes wide as the instruction's length says.
    #[must_use]
    pub const fn has_instruction_length(self) -> bool {
        matches!(
            self,
            OperandKind::Value
                | OperandKind::Source
                | OperandKind::Target
                | OperandKind::TableTarget
                | OperandKind::Position
                | OperandKind::RotationTarget
        )
    }
}

/// One row of the instruction table.
#[derive(Debug)]
pub struct InstructionRow {
    /// The instruction.
    pub mnemonic: Mnemonic,
    /// Its name in a listing.
    pub name: &'static str,
    /// Where in a rung it may stand.
    pub role: InstructionRole,
    /// Its operands in order. CODB has its table after them.
    pub operands: &'static [OperandKind],
    /// Steps without a table: 1 for basic instructions, SET and RST, else
    /// 1 and one for each operand.
    pub steps: u32,
}

const fn row(
    mnemonic: Mnemonic,
    name: &'static str,
    role: InstructionRole,
    operands: &'static [OperandKind],
    steps: u32,
) -> InstructionRow {
    InstructionRow {
        mnemonic,
        name,
        role,
        operands,
        steps,
    }
}

/// The instruction table.
pub static INSTRUCTIONS: [InstructionRow; 25] = [
    row(
        Mnemonic::Ld,
        "LD",
        InstructionRole::Start,
        &[OperandKind::Contact],
        1,
    ),
    row(
        Mnemonic::Ldi,
        "LDI",
        InstructionRole::Start,
        &[OperandKind::Contact],
        1,
    ),
    row(
        Mnemonic::And,
        "AND",
        InstructionRole::Contact,
        &[OperandKind::Contact],
        1,
    ),
    row(
        Mnemonic::Ani,
        "ANI",
        InstructionRole::Contact,
        &[OperandKind::Contact],
        1,
    ),
    row(
        Mnemonic::Or,
        "OR",
        InstructionRole::Contact,
        &[OperandKind::Contact],
        1,
    ),
    row(
        Mnemonic::Ori,
        "ORI",
        InstructionRole::Contact,
        &[OperandKind::Contact],
        1,
    ),
    row(Mnemonic::Orb, "ORB", InstructionRole::Contact, &[], 1),
    row(Mnemonic::Anb, "ANB", InstructionRole::Contact, &[], 1),
    row(
        Mnemonic::Out,
        "OUT",
        InstructionRole::Output,
        &[OperandKind::Coil],
        1,
    ),
    row(
        Mnemonic::Set,
        "SET",
        InstructionRole::Output,
        &[OperandKind::Coil],
        1,
    ),
    row(
        Mnemonic::Rst,
        "RST",
        InstructionRole::Output,
        &[OperandKind::Coil],
        1,
    ),
    row(
        Mnemonic::Cmp,
        "CMP",
        InstructionRole::Output,
        &[
            OperandKind::Length,
            OperandKind::Value,
            OperandKind::Value,
            OperandKind::ThreeCoils,
        ],
        5,
    ),
    row(
        Mnemonic::Tmrb,
        "TMRB",
        InstructionRole::Output,
        &[OperandKind::Timer, OperandKind::Time, OperandKind::Coil],
        4,
    ),
    row(
        Mnemonic::Ctrc,
        "CTRC",
        InstructionRole::Output,
        &[
            OperandKind::CounterFormat,
            OperandKind::Contact,
            OperandKind::Counter,
            OperandKind::Count,
            OperandKind::Coil,
        ],
        6,
    ),
    row(
        Mnemonic::Movn,
        "MOVN",
        InstructionRole::Output,
        &[OperandKind::Length, OperandKind::Value, OperandKind::Target],
        4,
    ),
    row(
        Mnemonic::Decb,
        "DECB",
        InstructionRole::Output,
        &[
            OperandKind::Length,
            OperandKind::Source,
            OperandKind::Number,
            OperandKind::DecodeTarget,
        ],
        5,
    ),
    row(
        Mnemonic::Codb,
        "CODB",
        InstructionRole::Output,
        &[
            OperandKind::Length,
            OperandKind::TableSize,
            OperandKind::Index,
            OperandKind::TableTarget,
        ],
        5,
    ),
    row(
        Mnemonic::Rotb,
        "ROTB",
        InstructionRole::Output,
        &[
            OperandKind::RotationFormat,
            OperandKind::Stations,
            OperandKind::Length,
            OperandKind::Position,
            OperandKind::Position,
            OperandKind::RotationTarget,
            OperandKind::Coil,
        ],
        8,
    ),
    row(
        Mnemonic::Jmpb,
        "JMPB",
        InstructionRole::Output,
        &[OperandKind::Label],
        2,
    ),
    row(
        Mnemonic::Lbl,
        "LBL",
        InstructionRole::Structure,
        &[OperandKind::Label],
        2,
    ),
    row(
        Mnemonic::Call,
        "CALL",
        InstructionRole::Output,
        &[OperandKind::Subprogram],
        2,
    ),
    row(
        Mnemonic::Sp,
        "SP",
        InstructionRole::Structure,
        &[OperandKind::Subprogram],
        2,
    ),
    row(Mnemonic::Spe, "SPE", InstructionRole::Structure, &[], 1),
    row(Mnemonic::End1, "END1", InstructionRole::Structure, &[], 1),
    row(Mnemonic::End2, "END2", InstructionRole::Structure, &[], 1),
];

impl Mnemonic {
    /// The instruction's row of the table.
    #[must_use]
    pub fn row(self) -> &'static InstructionRow {
        // The table stands in the order of the enumeration (tested below).
        &INSTRUCTIONS[self as usize]
    }

    /// The instruction called `name`, in either case.
    #[must_use]
    pub(crate) fn from_name(name: &str) -> Option<Mnemonic> {
        INSTRUCTIONS
            .iter()
            .find(|row| row.name.eq_ignore_ascii_case(name))
            .map(|row| row.mnemonic)
    }
}

/// One operand of a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operand {
    /// A bit address.
    Bit(BitAddress),
    /// A byte or entry address.
    Byte(ByteAddress),
    /// A number.
    Number(i32),
    /// Four binary digits, the first one in bit 3.
    Format(u8),
    /// Number of a label L.
    Label(u16),
    /// Number of a subprogram P.
    Subprogram(u16),
}

/// One instruction with its operands and its place in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Statement {
    /// The instruction.
    pub mnemonic: Mnemonic,
    /// Its operands, in the order of the table.
    pub operands: Vec<Operand>,
    /// The entries of a CODB table.
    pub table: Vec<i32>,
    /// Line of the source text, from 1.
    pub line: u32,
    /// Rung, from 1.
    pub rung: u32,
}

impl Statement {
    /// Steps of program memory: the capacity is 5000.
    #[must_use]
    pub fn steps(&self) -> u32 {
        self.mnemonic.row().steps + u32::try_from(self.table.len()).unwrap_or(u32::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instruction_table_is_in_mnemonic_order() {
        for row in &INSTRUCTIONS {
            assert_eq!(row.mnemonic.row().name, row.name);
            assert_eq!(Mnemonic::from_name(row.name), Some(row.mnemonic));
        }
    }

    #[test]
    fn steps_are_one_plus_operand_count() {
        for row in &INSTRUCTIONS {
            let basic = row.role != InstructionRole::Output
                && row.role != InstructionRole::Structure
                || matches!(row.mnemonic, Mnemonic::Out | Mnemonic::Set | Mnemonic::Rst);
            let expected = if basic { 1 } else { 1 + row.operands.len() };
            assert_eq!(row.steps as usize, expected, "{}", row.name);
        }
    }
}
