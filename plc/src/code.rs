//! The compiled program: one small operation a statement, places resolved.

use crate::check::{SLOT_STEPS, Structure};
use crate::directive::Directives;
use crate::instruction::{Mnemonic, Operand, Role, Statement};
use crate::memory::{LATCH, offset};

/// One operation. Operation and statement have the same index, so that a
/// place in the code is a place in the listing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Op {
    Ld(Bit),
    Ldi(Bit),
    And(Bit),
    Ani(Bit),
    Or(Bit),
    Ori(Bit),
    Orb,
    Anb,
    Out(Bit),
    Set(Bit),
    Rst(Bit),
    /// Index in the function table.
    Function(u16),
    /// Operation to go on with.
    Jump(u16),
    /// First operation of the subprogram.
    Call(u16),
    Return,
    /// END1, END2, LBL, SP: nothing to do.
    Mark,
}

/// One bit of the flat memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Bit {
    pub at: u16,
    pub mask: u8,
}

/// A number, or the place in flat memory to read it from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Value {
    Number(i32),
    At(u16),
}

/// A function instruction with resolved operands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    Compare {
        length: u8,
        a: Value,
        b: Value,
        at: u16,
        bit: u8,
    },
    Timer {
        timer: u8,
        at: u16,
        preset: Value,
        output: Bit,
    },
    Counter {
        down: bool,
        /// CN0: 0 or 1.
        initial: i32,
        reset: Bit,
        at: u16,
        preset: Value,
        output: Bit,
        /// Index of the edge memory.
        edge: u16,
    },
    Move {
        length: u8,
        from: Value,
        to: u16,
    },
    Decode {
        length: u8,
        from: Value,
        base: i32,
        to: u16,
    },
    Table {
        length: u8,
        /// Index of the first entry: 1, or 0 with `.OPT codb0`.
        first: u8,
        index: u16,
        to: u16,
        entries: Box<[i32]>,
    },
    Rotate {
        format: u8,
        stations: i32,
        length: u8,
        current: Value,
        target: Value,
        result: u16,
        output: Bit,
    },
}

/// Everything the scan needs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Code {
    pub ops: Vec<Op>,
    pub functions: Vec<Function>,
    /// END1: level 1 is the operations before it.
    pub end1: usize,
    /// Where each part of level 2 ends; at least one.
    pub part_ends: Vec<usize>,
    /// Number of CTRC instructions, each with an edge memory.
    pub counters: usize,
    /// Timers that stand in level 1, one bit each.
    pub level1_timers: u128,
}

/// Generates the code of a program that passed all checks.
pub(crate) fn generate(
    statements: &[Statement],
    structure: &Structure,
    directives: &Directives,
) -> Code {
    let mut code = Code {
        end1: structure.end1,
        part_ends: divide(statements, structure, directives.undivided),
        ..Code::default()
    };
    for (at, statement) in statements.iter().enumerate() {
        let level1 = at < structure.end1;
        let op = operation(statement, level1, structure, directives, &mut code);
        // The checks leave no statement that cannot be translated.
        code.ops.push(op.unwrap_or(Op::Mark));
    }
    code
}

/// Divides level 2: a part ends with the first rung that fills its slot.
fn divide(statements: &[Statement], structure: &Structure, undivided: bool) -> Vec<usize> {
    let budget = SLOT_STEPS.saturating_sub(structure.level1_steps);
    let mut ends = Vec::new();
    let mut steps: u32 = 0;
    let first = structure.end1 + 1;
    let level2 = statements.get(first..structure.end2).unwrap_or_default();
    let mut rung = 0;
    for (at, statement) in level2.iter().enumerate() {
        let fresh = statement.rung != rung && statement.mnemonic.row().role != Role::Output;
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

fn operation(
    statement: &Statement,
    level1: bool,
    structure: &Structure,
    directives: &Directives,
    code: &mut Code,
) -> Option<Op> {
    let operands = statement.operands.as_slice();
    let contact = |operand: &Operand| bit(*operand, !level1);
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
        (Mnemonic::Lbl | Mnemonic::Sp | Mnemonic::End1 | Mnemonic::End2, _) => Op::Mark,
        _ => {
            let function = function(statement, level1, directives, code)?;
            let index = u16::try_from(code.functions.len()).ok()?;
            code.functions.push(function);
            Op::Function(index)
        }
    };
    Some(op)
}

fn function(
    statement: &Statement,
    level1: bool,
    directives: &Directives,
    code: &mut Code,
) -> Option<Function> {
    use Operand::{Bit as BitOperand, Byte, Format, Number};
    let latch = !level1;
    let function = match (statement.mnemonic, statement.operands.as_slice()) {
        (Mnemonic::Cmp, [Number(length), a, b, BitOperand(result)]) => Function::Compare {
            length: u8::try_from(*length).ok()?,
            a: value(*a, latch)?,
            b: value(*b, latch)?,
            at: place(Byte(result.byte_address()), latch)?,
            bit: result.bit,
        },
        (Mnemonic::Tmrb, [Byte(timer), preset, output]) => {
            let number = u8::try_from(timer.byte).ok()?;
            if level1 {
                code.level1_timers |= 1 << number;
            }
            Function::Timer {
                timer: number,
                at: place(Byte(*timer), latch)?,
                preset: value(*preset, latch)?,
                output: bit(*output, latch)?,
            }
        }
        (Mnemonic::Ctrc, [Format(format), reset, counter, preset, output]) => {
            let edge = u16::try_from(code.counters).ok()?;
            code.counters += 1;
            Function::Counter {
                down: format & 1 == 1,
                initial: i32::from(format >> 1 & 1),
                reset: bit(*reset, latch)?,
                at: place(*counter, latch)?,
                preset: value(*preset, latch)?,
                output: bit(*output, latch)?,
                edge,
            }
        }
        (Mnemonic::Movn, [Number(length), from, to]) => Function::Move {
            length: u8::try_from(*length).ok()?,
            from: value(*from, latch)?,
            to: place(*to, latch)?,
        },
        (Mnemonic::Decb, [Number(length), from, Number(base), to]) => Function::Decode {
            length: u8::try_from(*length).ok()?,
            from: value(*from, latch)?,
            base: *base,
            to: place(*to, latch)?,
        },
        (Mnemonic::Codb, [Number(length), Number(_), index, to]) => Function::Table {
            length: u8::try_from(*length).ok()?,
            first: u8::from(!directives.table_from_0),
            index: place(*index, latch)?,
            to: place(*to, latch)?,
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
            current: value(*current, latch)?,
            target: value(*target, latch)?,
            result: place(*result, latch)?,
            output: bit(*output, latch)?,
        },
        _ => return None,
    };
    Some(function)
}

/// Place in flat memory; level 2 and subprograms read X and F from the latch.
fn place(operand: Operand, latch: bool) -> Option<u16> {
    let Operand::Byte(address) = operand else {
        return None;
    };
    let at = offset(address)?;
    // X and F are the first two areas, and they end where their copy begins.
    let at = if latch && at < LATCH { at + LATCH } else { at };
    u16::try_from(at).ok()
}

fn bit(operand: Operand, latch: bool) -> Option<Bit> {
    let Operand::Bit(address) = operand else {
        return None;
    };
    Some(Bit {
        at: place(Operand::Byte(address.byte_address()), latch)?,
        mask: 1 << (address.bit & 7),
    })
}

fn value(operand: Operand, latch: bool) -> Option<Value> {
    match operand {
        Operand::Number(number) => Some(Value::Number(number)),
        Operand::Byte(_) => place(operand, latch).map(Value::At),
        _ => None,
    }
}
