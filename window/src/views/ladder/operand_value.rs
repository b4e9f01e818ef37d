//! Formats the current values of operands.

use gsk_core::plc::{Area, ByteAddress, Operand, OperandKind, PlcMemory, Statement};

/// Formats the current value of an operand; `None` for a constant.
pub fn format_operand(
    statement: &Statement,
    kind: OperandKind,
    operand: &Operand,
    memory: &PlcMemory,
) -> Option<String> {
    match operand {
        Operand::Bit(bit) => {
            let state = |bit| u8::from(memory.bit(bit));
            if kind != OperandKind::ThreeCoils {
                return Some(state(*bit).to_string());
            }
            let mut three = String::new();
            for offset in 0..3 {
                let mut bit = *bit;
                bit.bit = (bit.bit + offset).min(7);
                three.push_str(&state(bit).to_string());
            }
            Some(three)
        }
        Operand::Byte(address) => Some(format_value(
            *address,
            operand_bytes(statement, kind),
            memory,
        )),
        _ => None,
    }
}

/// Returns the number of bytes that an operand covers.
fn operand_bytes(statement: &Statement, kind: OperandKind) -> usize {
    if !kind.has_instruction_length() {
        return 1;
    }
    let kinds = statement.mnemonic.row().operands;
    let lengths = kinds.iter().zip(&statement.operands);
    let length = lengths
        .filter(|(kind, _)| **kind == OperandKind::Length)
        .find_map(|(_, operand)| match operand {
            Operand::Number(length) => usize::try_from(*length).ok(),
            _ => None,
        });
    length.unwrap_or(1)
}

/// Formats the current value of a byte, of `width` bytes, or of an entry of a timer or counter
/// area.
pub fn format_value(address: ByteAddress, width: usize, memory: &PlcMemory) -> String {
    let is_entry = matches!(address.area, Area::T | Area::C | Area::Dc | Area::Dt);
    let value = match width {
        _ if is_entry => memory.long(address),
        4 => memory.long(address),
        2 => i32::from(memory.word(address)),
        _ => i32::from(memory.byte(address)),
    };
    let unit = if matches!(address.area, Area::T | Area::Dt) && value != i32::MAX {
        " ms"
    } else {
        ""
    };
    format!("{value}{unit}")
}
