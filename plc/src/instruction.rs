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
pub enum Role {
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
pub enum Kind {
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

impl Kind {
    /// Areas an address may lie in; empty when the operand is no address.
    #[must_use]
    pub const fn areas(self) -> &'static [Area] {
        use Area::{A, C, D, Dc, Dt, F, G, K, R, T, X, Y};
        match self {
            Kind::Contact => &[X, Y, F, G, R, K, A],
            Kind::Coil | Kind::ThreeCoils | Kind::DecodeTarget => COILS,
            Kind::Value | Kind::Source => &[R, X, Y, F, G, K, A, D, T, C, Dc, Dt],
            Kind::Target => &[R, Y, G, K, A, D, T, C, Dc, Dt],
            Kind::Index => &[R, X, Y, G, F, A, K, D],
            Kind::TableTarget | Kind::RotationTarget => &[R, Y, G, K, A, D, Dt, Dc],
            Kind::Position => &[R, X, Y, F, G, K, A, D, Dc, Dt],
            Kind::Timer => &[T],
            Kind::Counter => &[C],
            Kind::Time => &[Dt],
            Kind::Count => &[Dc],
            _ => &[],
        }
    }

    /// True when the operand is a single bit.
    #[must_use]
    pub const fn is_bit(self) -> bool {
        matches!(self, Kind::Contact | Kind::Coil | Kind::ThreeCoils)
    }

    /// True when the instruction writes the operand.
    #[must_use]
    pub(crate) const fn is_written(self) -> bool {
        matches!(
            self,
            Kind::Coil
                | Kind::ThreeCoils
                | Kind::Target
                | Kind::DecodeTarget
                | Kind::TableTarget
                | Kind::RotationTarget
        )
    }

    /// True when a plain number may stand here.
    #[must_use]
    pub const fn takes_number(self) -> bool {
        matches!(
            self,
            Kind::Length
                | Kind::Value
                | Kind::Time
                | Kind::Count
                | Kind::Number
                | Kind::Stations
                | Kind::TableSize
        )
    }

    /// True when the operand is as many bytes wide as the instruction's length says.
    #[must_use]
    pub const fn is_wide(self) -> bool {
        matches!(
            self,
            Kind::Value
                | Kind::Source
                | Kind::Target
                | Kind::TableTarget
                | Kind::Position
                | Kind::RotationTarget
        )
    }
}

/// One row of the instruction table.
#[derive(Debug)]
pub struct Row {
    /// The instruction.
    pub mnemonic: Mnemonic,
    /// Its name in a listing.
    pub name: &'static str,
    /// Where in a rung it may stand.
    pub role: Role,
    /// Its operands in order. CODB has its table after them.
    pub operands: &'static [Kind],
    /// Steps without a table: 1 for basic instructions, SET and RST, else
    /// 1 and one for each operand.
    pub steps: u32,
}

const fn row(
    mnemonic: Mnemonic,
    name: &'static str,
    role: Role,
    operands: &'static [Kind],
    steps: u32,
) -> Row {
    Row {
        mnemonic,
        name,
        role,
        operands,
        steps,
    }
}

/// The instruction table.
pub static TABLE: [Row; 25] = [
    row(Mnemonic::Ld, "LD", Role::Start, &[Kind::Contact], 1),
    row(Mnemonic::Ldi, "LDI", Role::Start, &[Kind::Contact], 1),
    row(Mnemonic::And, "AND", Role::Contact, &[Kind::Contact], 1),
    row(Mnemonic::Ani, "ANI", Role::Contact, &[Kind::Contact], 1),
    row(Mnemonic::Or, "OR", Role::Contact, &[Kind::Contact], 1),
    row(Mnemonic::Ori, "ORI", Role::Contact, &[Kind::Contact], 1),
    row(Mnemonic::Orb, "ORB", Role::Contact, &[], 1),
    row(Mnemonic::Anb, "ANB", Role::Contact, &[], 1),
    row(Mnemonic::Out, "OUT", Role::Output, &[Kind::Coil], 1),
    row(Mnemonic::Set, "SET", Role::Output, &[Kind::Coil], 1),
    row(Mnemonic::Rst, "RST", Role::Output, &[Kind::Coil], 1),
    row(
        Mnemonic::Cmp,
        "CMP",
        Role::Output,
        &[Kind::Length, Kind::Value, Kind::Value, Kind::ThreeCoils],
        5,
    ),
    row(
        Mnemonic::Tmrb,
        "TMRB",
        Role::Output,
        &[Kind::Timer, Kind::Time, Kind::Coil],
        4,
    ),
    row(
        Mnemonic::Ctrc,
        "CTRC",
        Role::Output,
        &[
            Kind::CounterFormat,
            Kind::Contact,
            Kind::Counter,
            Kind::Count,
            Kind::Coil,
        ],
        6,
    ),
    row(
        Mnemonic::Movn,
        "MOVN",
        Role::Output,
        &[Kind::Length, Kind::Value, Kind::Target],
        4,
    ),
    row(
        Mnemonic::Decb,
        "DECB",
        Role::Output,
        &[Kind::Length, Kind::Source, Kind::Number, Kind::DecodeTarget],
        5,
    ),
    row(
        Mnemonic::Codb,
        "CODB",
        Role::Output,
        &[
            Kind::Length,
            Kind::TableSize,
            Kind::Index,
            Kind::TableTarget,
        ],
        5,
    ),
    row(
        Mnemonic::Rotb,
        "ROTB",
        Role::Output,
        &[
            Kind::RotationFormat,
            Kind::Stations,
            Kind::Length,
            Kind::Position,
            Kind::Position,
            Kind::RotationTarget,
            Kind::Coil,
        ],
        8,
    ),
    row(Mnemonic::Jmpb, "JMPB", Role::Output, &[Kind::Label], 2),
    row(Mnemonic::Lbl, "LBL", Role::Structure, &[Kind::Label], 2),
    row(Mnemonic::Call, "CALL", Role::Output, &[Kind::Subprogram], 2),
    row(Mnemonic::Sp, "SP", Role::Structure, &[Kind::Subprogram], 2),
    row(Mnemonic::Spe, "SPE", Role::Structure, &[], 1),
    row(Mnemonic::End1, "END1", Role::Structure, &[], 1),
    row(Mnemonic::End2, "END2", Role::Structure, &[], 1),
];

impl Mnemonic {
    /// The instruction's row of the table.
    #[must_use]
    pub fn row(self) -> &'static Row {
        // The table stands in the order of the enumeration (tested below).
        &TABLE[self as usize]
    }

    /// The instruction called `name`, in either case.
    #[must_use]
    pub(crate) fn of_name(name: &str) -> Option<Mnemonic> {
        TABLE
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
    fn the_table_stands_in_the_order_of_the_mnemonics() {
        for row in &TABLE {
            assert_eq!(row.mnemonic.row().name, row.name);
            assert_eq!(Mnemonic::of_name(row.name), Some(row.mnemonic));
        }
    }

    #[test]
    fn steps_follow_the_operands() {
        for row in &TABLE {
            let basic = row.role != Role::Output && row.role != Role::Structure
                || matches!(row.mnemonic, Mnemonic::Out | Mnemonic::Set | Mnemonic::Rst);
            let expected = if basic { 1 } else { 1 + row.operands.len() };
            assert_eq!(row.steps as usize, expected, "{}", row.name);
        }
    }
}
