//! The instruction table: mnemonic, role in a rung, operands and steps.
//!
//! Parser, checks, step count, listing and help all use [`INSTRUCTIONS`].

use serde::{Deserialize, Serialize};

use crate::address::{Area, BitAddress, ByteAddress};

/// The mnemonic of a ladder instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Mnemonic {
    /// LD: starts a rung or a branch with a normally open contact.
    Ld,
    /// LDI: starts a rung or a branch with a normally closed contact.
    Ldi,
    /// AND: normally open contact in series.
    And,
    /// ANI: normally closed contact in series.
    Ani,
    /// OR: normally open contact in parallel.
    Or,
    /// ORI: normally closed contact in parallel.
    Ori,
    /// ORB: connects two series blocks in parallel.
    Orb,
    /// ANB: connects two parallel blocks in series.
    Anb,
    /// OUT: writes the result of the rung to a bit.
    Out,
    /// SET: sets a bit to 1 if the result of the rung is 1.
    Set,
    /// RST: resets a bit to 0 if the result of the rung is 1.
    Rst,
    /// CMP: compares two binary numbers.
    Cmp,
    /// TMRB: on-delay timer.
    Tmrb,
    /// CTRC: up or down counter.
    Ctrc,
    /// MOVN: copies a number.
    Movn,
    /// DECB: decodes a binary number; eight successive values have one bit each.
    Decb,
    /// CODB: reads a value from a table.
    Codb,
    /// ROTB: rotation control; computes direction and target station or number of steps.
    Rotb,
    /// JMPB: jumps to a label.
    Jmpb,
    /// LBL: defines a label.
    Lbl,
    /// CALL: calls a subprogram.
    Call,
    /// SP: starts a subprogram.
    Sp,
    /// SPE: ends a subprogram.
    Spe,
    /// END1: ends level 1.
    End1,
    /// END2: ends level 2.
    End2,
}

/// The position that an instruction takes in a rung: start, contact, output, or outside rungs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstructionRole {
    /// The instruction starts a rung or a branch: LD and LDI.
    Start,
    /// The instruction is a contact, or connects blocks, within a rung.
    Contact,
    /// The instruction uses the result of the rung, as a coil or a function.
    Output,
    /// The instruction is outside rungs: labels, subprograms and ends of levels.
    Structure,
}

/// The kind of operand that an instruction accepts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OperandKind {
    /// Operand: any bit of X Y F G R K A.
    Contact,
    /// Operand: a writable bit, of Y G R K A.
    Coil,
    /// Operand: the first of three adjacent result bits, bit 0 to 5 of a byte.
    ThreeCoils,
    /// Operand: the length of the values, 1, 2 or 4 bytes.
    Length,
    /// Operand: a number, or any byte or entry.
    Value,
    /// Operand: any byte or entry to read.
    Source,
    /// Operand: a byte or entry to write.
    Target,
    /// Operand: the byte that receives eight decoded bits.
    DecodeTarget,
    /// Operand: the byte that contains a table index.
    Index,
    /// Operand: the byte or entry that receives a table value.
    TableTarget,
    /// Operand: the byte or entry that contains the position of a rotating part.
    Position,
    /// Operand: the byte or entry that receives the target or steps of a rotation.
    RotationTarget,
    /// Operand: a timer, T0 to T99.
    Timer,
    /// Operand: a counter, C0 to C99.
    Counter,
    /// Operand: a time in ms, as a number or a DT entry.
    Time,
    /// Operand: a count, as a number or a DC entry.
    Count,
    /// Operand: a constant number.
    Number,
    /// Operand: the number of stations of a rotating part, from 1.
    Stations,
    /// Operand: the code of a table size, 1 to 8 for 2, 4, … 256 entries.
    TableSize,
    /// Operand: the counter format, four digits `0 0 CN0 U/D`.
    CounterFormat,
    /// Operand: the rotation format, four digits `RN0 DIR POS INC`.
    RotationFormat,
    /// Operand: a label, L0 to L9999.
    Label,
    /// Operand: a subprogram, P0 to P9999.
    Subprogram,
}

/// The areas whose bits a coil may write.
const COILS: &[Area] = &[Area::Y, Area::G, Area::R, Area::K, Area::A];

impl OperandKind {
    /// Returns the areas that an address operand may use; empty if the operand is not an
    /// address.
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

    /// Returns whether the operand is the address of a single bit.
    #[must_use]
    pub const fn is_bit(self) -> bool {
        matches!(
            self,
            OperandKind::Contact | OperandKind::Coil | OperandKind::ThreeCoils
        )
    }

    /// Returns whether the instruction writes the operand.
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

    /// Returns whether the operand may be a constant number.
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

    /// Returns whether the operand has the length, in bytes, of the instruction's length
    /// operand.
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

/// The properties of one instruction, a row of [`INSTRUCTIONS`].
#[derive(Debug)]
pub struct InstructionRow {
    /// The instruction that the row describes.
    pub mnemonic: Mnemonic,
    /// Name of the instruction in a listing, in capital letters.
    pub name: &'static str,
    /// Position that the instruction takes in a rung.
    pub role: InstructionRole,
    /// Kinds of the operands, in order. The table of CODB follows them.
    pub operands: &'static [OperandKind],
    /// Steps in program memory without a table: 1 for contacts, OUT, SET and RST; otherwise
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

/// The properties of all instructions, in the order of [`Mnemonic`].
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
    /// Returns the row of the instruction in the table [`INSTRUCTIONS`].
    #[must_use]
    pub fn row(self) -> &'static InstructionRow {
        // The rows are in the order of the enumeration; a test below checks it.
        &INSTRUCTIONS[self as usize]
    }

    /// Returns the instruction with this name, in upper or lower case; `None` for an unknown
    /// name.
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
    /// Operand that is the address of a bit.
    Bit(BitAddress),
    /// Operand that is the address of a byte or an entry.
    Byte(ByteAddress),
    /// Operand that is a constant number.
    Number(i32),
    /// Operand that is a format of four binary digits; the first digit is bit 3.
    Format(u8),
    /// Operand that is the number of a label, 7 for L7.
    Label(u16),
    /// Operand that is the number of a subprogram, 7 for P7.
    Subprogram(u16),
}

/// One instruction with its operands and its position in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Statement {
    /// The instruction of the statement.
    pub mnemonic: Mnemonic,
    /// The operands, in the order of the instruction table.
    pub operands: Vec<Operand>,
    /// The entries of a CODB table; empty for other instructions.
    pub table: Vec<i32>,
    /// Line of the statement in the source text, from 1.
    pub line: u32,
    /// Number of the rung that contains the statement, from 1.
    pub rung: u32,
}

impl Statement {
    /// Returns the number of steps that the statement takes in the program memory of 5000 steps.
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
