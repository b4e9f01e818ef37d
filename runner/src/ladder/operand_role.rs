//! Names the operands of an instruction.

use gsk_core::plc::{Mnemonic, OperandKind, Statement};
use gsk_messages::{Language, say};

/// Returns the number of operand lines in the box of a function instruction; 0 for a coil.
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
