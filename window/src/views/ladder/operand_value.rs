//! Names the operands of an instruction and formats their current values.

use gsk_core::plc::{Area, ByteAddress, Mnemonic, Operand, OperandKind, PlcMemory, Statement};

use gsk_messages::{Language, say};

/// Number of operand lines in the box of a function instruction; 0 for a coil.
pub fn operand_line_count(output: &Statement) -> usize {
    match output.mnemonic {
        Mnemonic::Out | Mnemonic::Set | Mnemonic::Rst => 0,
        _ => output.operands.len() + usize::from(!output.table.is_empty()),
    }
}

/// Returns a text about the purpose of an operand.
pub fn operand_role(kind: OperandKind, language: Language) -> String {
    let role = match kind {
        OperandKind::Contact => say::ladder_operand_reset(),
        OperandKind::Coil => say::ladder_operand_output(),
        OperandKind::ThreeCoils => return "> = <".to_owned(),
        OperandKind::Length => say::ladder_operand_bytes(),
        OperandKind::Value | OperandKind::Source => say::ladder_operand_input(),
        OperandKind::Target
        | OperandKind::DecodeTarget
        | OperandKind::TableTarget
        | OperandKind::RotationTarget => say::ladder_operand_result(),
        OperandKind::Index => say::ladder_operand_index(),
        OperandKind::Position => say::ladder_operand_position(),
        OperandKind::Timer => say::ladder_operand_timer(),
        OperandKind::Counter => say::ladder_operand_counter(),
        OperandKind::Time | OperandKind::Count => say::ladder_operand_preset(),
        OperandKind::Number => say::ladder_operand_base(),
        OperandKind::Stations => say::ladder_operand_stations(),
        OperandKind::TableSize => say::ladder_operand_table_size(),
        OperandKind::CounterFormat | OperandKind::RotationFormat => say::ladder_operand_format(),
        OperandKind::Label => say::ladder_operand_label(),
        OperandKind::Subprogram => say::ladder_operand_subprogram(),
    };
    role.text(language)
}

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
