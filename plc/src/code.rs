//! Generates the compiled program: one operation for each statement, with resolved
//! addresses.

use crate::check::{LadderStructure, MAX_SLOT_STEPS};
use crate::directive::Directives;
use crate::instruction::{InstructionRole, Mnemonic, Operand, Statement};
use crate::memory::{LATCH_OFFSET, offset};

/// One operation of the compiled program. An operation and its statement have the same index,
/// so that a position in the code is a position in the listing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Op {
    Ld(MemoryBit),
    Ldi(MemoryBit),
    And(MemoryBit),
    Ani(MemoryBit),
    Or(MemoryBit),
    Ori(MemoryBit),
    Orb,
    Anb,
    Out(MemoryBit),
    Set(MemoryBit),
    Rst(MemoryBit),
    /// A function instruction; the value is its index in [`Code::functions`].
    Function(u16),
    /// A jump: the index of the operation that runs next if the jump is taken.
    Jump(u16),
    /// A call of a subprogram; the value is the index of the subprogram's first operation.
    Call(u16),
    Return,
    /// No operation: END1, END2, LBL and SP.
    Nop,
}

/// One bit of the memory array: index of its byte, and mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MemoryBit {
    pub at: u16,
    pub mask: u8,
}

/// The value of an operand: a constant, or the index of its lowest byte in the memory
/// array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OperandValue {
    Number(i32),
    Address(u16),
}

/// A function instruction with resolved operands. Indices are those of bytes in the memory array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    Compare {
        length: u8,
        a: OperandValue,
        b: OperandValue,
        at: u16,
        bit: u8,
    },
    Timer {
        timer: u8,
        at: u16,
        preset: OperandValue,
        output: MemoryBit,
    },
    Counter {
        down: bool,
        /// Initial value of the counter (CN0), 0 or 1.
        initial: i32,
        reset: MemoryBit,
        at: u16,
        preset: OperandValue,
        output: MemoryBit,
        /// Index of the counter's previous input state in the scan state.
        edge: u16,
    },
    Move {
        length: u8,
        from: OperandValue,
        to: u16,
    },
    Decode {
        length: u8,
        from: OperandValue,
        base: i32,
        to: u16,
    },
    Table {
        length: u8,
        /// Number of the first entry of the table: 1, or 0 with `.OPT codb0`.
        first: u8,
        index: u16,
        to: u16,
        entries: Box<[i32]>,
    },
    Rotate {
        format: u8,
        stations: i32,
        length: u8,
        current: OperandValue,
        target: OperandValue,
        result: u16,
        output: MemoryBit,
    },
}

/// The compiled ladder program, which the scan executes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Code {
    pub ops: Vec<Op>,
    pub functions: Vec<Function>,
    /// Index of the operation END1; level 1 consists of the operations before it.
    pub end1: usize,
    /// Index after the last operation of each part of level 2; never empty.
    pub part_ends: Vec<usize>,
    /// Number of CTRC instructions; the scan state stores the previous input of each.
    pub counter_count: usize,
    /// The timers in level 1, as a bit set with one bit per timer number.
    pub level1_timers: u128,
}

/// Generates the code of a program that has passed all checks.
pub(crate) fn generate(
    statements: &[Statement],
    structure: &LadderStructure,
    directives: &Directives,
) -> Code {
    let mut code = Code {
        end1: structure.end1,
        part_ends: divide_level2(statements, structure, directives.undivided),
        ..Code::default()
    };
    for (at, statement) in statements.iter().enumerate() {
        let level1 = at < structure.end1;
        let op = translate_statement(statement, level1, structure, directives, &mut code);
        // A program that has passed the checks has no statement without an operation.
        code.ops.push(op.unwrap_or(Op::Nop));
    }
    code
}

/// Divides level 2 into parts of one slot each. A part ends after the rung that fills the
/// slot.
fn divide_level2(
    statements: &[Statement],
    structure: &LadderStructure,
    undivided: bool,
) -> Vec<usize> {
    let budget = MAX_SLOT_STEPS.saturating_sub(structure.level1_steps);
    let mut ends = Vec::new();
    let mut steps: u32 = 0;
    let first = structure.end1 + 1;
    let level2 = statements.get(first..structure.end2).unwrap_or_default();
    let mut rung = 0;
    for (at, statement) in level2.iter().enumerate() {
        let fresh =
            statement.rung != rung && statement.mnemonic.row().role != InstructionRole::Output;
        if fresh && steps > 0 && steps >= budget && !undivided {
            ends.push(first + at);
            steps = 0;
        }
        rung = statement.rung;
        steps += statement.steps();
    }
    ends.push(structure.end2);
    ends
}

fn translate_statement(
    statement: &Statement,
    level1: bool,
    structure: &LadderStructure,
    directives: &Directives,
    code: &mut Code,
) -> Option<Op> {
    let operands = statement.operands.as_slice();
    let contact = |operand: &Operand| resolve_bit(*operand, !level1);
    let op = match (statement.mnemonic, operands) {
        (Mnemonic::Ld, [b]) => Op::Ld(contact(b)?),
        (Mnemonic::Ldi, [b]) => Op::Ldi(contact(b)?),
        (Mnemonic::And, [b]) => Op::And(contact(b)?),
        (Mnemonic::Ani, [b]) => Op::Ani(contact(b)?),
        (Mnemonic::Or, [b]) => Op::Or(contact(b)?),
        (Mnemonic::Ori, [b]) => Op::Ori(contact(b)?),
        (Mnemonic::Orb, []) => Op::Orb,
        (Mnemonic::Anb, []) => Op::Anb,
        (Mnemonic::Out, [b]) => Op::Out(contact(b)?),
        (Mnemonic::Set, [b]) => Op::Set(contact(b)?),
        (Mnemonic::Rst, [b]) => Op::Rst(contact(b)?),
        (Mnemonic::Jmpb, [Operand::Label(label)]) => {
            Op::Jump(u16::try_from(*structure.labels.get(label)?).ok()?)
        }
        (Mnemonic::Call, [Operand::Subprogram(number)]) => {
            Op::Call(u16::try_from(*structure.subprograms.get(number)?).ok()?)
        }
        (Mnemonic::Spe, []) => Op::Return,
        (Mnemonic::Lbl | Mnemonic::Sp | Mnemonic::End1 | Mnemonic::End2, _) => Op::Nop,
        _ => {
            let function = translate_function(statement, level1, directives, code)?;
            let index = u16::try_from(code.functions.len()).ok()?;
            code.functions.push(function);
            Op::Function(index)
        }
    };
    Some(op)
}

fn translate_function(
    statement: &Statement,
    level1: bool,
    directives: &Directives,
    code: &mut Code,
) -> Option<Function> {
    use Operand::{Bit as BitOperand, Byte, Format, Number};
    let latched = !level1;
    let function = match (statement.mnemonic, statement.operands.as_slice()) {
        (Mnemonic::Cmp, [Number(length), a, b, BitOperand(result)]) => Function::Compare {
            length: u8::try_from(*length).ok()?,
            a: resolve_value(*a, latched)?,
            b: resolve_value(*b, latched)?,
            at: resolve_address(Byte(result.byte_address()), latched)?,
            bit: result.bit,
        },
        (Mnemonic::Tmrb, [Byte(timer), preset, output]) => {
            let number = u8::try_from(timer.byte).ok()?;
            if level1 {
                code.level1_timers |= 1 << number;
            }
            Function::Timer {
                timer: number,
                at: resolve_address(Byte(*timer), latched)?,
                preset: resolve_value(*preset, latched)?,
                output: resolve_bit(*output, latched)?,
            }
        }
        (Mnemonic::Ctrc, [Format(format), reset, counter, preset, output]) => {
            let edge = u16::try_from(code.counter_count).ok()?;
            code.counter_count += 1;
            Function::Counter {
                down: format & 1 == 1,
                initial: i32::from(format >> 1 & 1),
                reset: resolve_bit(*reset, latched)?,
                at: resolve_address(*counter, latched)?,
                preset: resolve_value(*preset, latched)?,
                output: resolve_bit(*output, latched)?,
                edge,
            }
        }
        (Mnemonic::Movn, [Number(length), from, to]) => Function::Move {
            length: u8::try_from(*length).ok()?,
            from: resolve_value(*from, latched)?,
            to: resolve_address(*to, latched)?,
        },
        (Mnemonic::Decb, [Number(length), from, Number(base), to]) => Function::Decode {
            length: u8::try_from(*length).ok()?,
            from: resolve_value(*from, latched)?,
            base: *base,
            to: resolve_address(*to, latched)?,
        },
        (Mnemonic::Codb, [Number(length), Number(_), index, to]) => Function::Table {
            length: u8::try_from(*length).ok()?,
            first: u8::from(!directives.table_from_0),
            index: resolve_address(*index, latched)?,
            to: resolve_address(*to, latched)?,
            entries: statement.table.as_slice().into(),
        },
        (
            Mnemonic::Rotb,
            [
                Format(format),
                Number(stations),
                Number(length),
                current,
                target,
                result,
                output,
            ],
        ) => Function::Rotate {
            format: *format,
            stations: *stations,
            length: u8::try_from(*length).ok()?,
            current: resolve_value(*current, latched)?,
            target: resolve_value(*target, latched)?,
            result: resolve_address(*result, latched)?,
            output: resolve_bit(*output, latched)?,
        },
        _ => return None,
    };
    Some(function)
}

/// Resolves a byte address to its index in the memory array; `None` for other operands. With
/// `latched`, as in level 2 and subprograms, X and F resolve to their latched copies.
fn resolve_address(operand: Operand, latched: bool) -> Option<u16> {
    let Operand::Byte(address) = operand else {
        return None;
    };
    let at = offset(address)?;
    // X and F are the first two areas; their copies start where they end.
    let at = if latched && at < LATCH_OFFSET {
        at + LATCH_OFFSET
    } else {
        at
    };
    u16::try_from(at).ok()
}

fn resolve_bit(operand: Operand, latched: bool) -> Option<MemoryBit> {
    let Operand::Bit(address) = operand else {
        return None;
    };
    Some(MemoryBit {
        at: resolve_address(Operand::Byte(address.byte_address()), latched)?,
        mask: 1 << (address.bit & 7),
    })
}

fn resolve_value(operand: Operand, latched: bool) -> Option<OperandValue> {
    match operand {
        Operand::Number(number) => Some(OperandValue::Number(number)),
        Operand::Byte(_) => resolve_address(operand, latched).map(OperandValue::Address),
        _ => None,
    }
}
