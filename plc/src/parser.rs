//! Parses an instruction list line by line to statements and directives.
//!
//! The parser checks everything that depends on one line: the instruction, the number of
//! its operands, their areas and their ranges. The module `check` checks several lines
//! together.

use gsk_messages::{Message, say};

use crate::address::{AddressError, Area, BitAddress, ByteAddress, parse_decimal, split_once_at};
use crate::diagnostic::{CompileError, Rule, RuleViolation};
use crate::directive::{self, Directives};
use crate::instruction::{InstructionRole, Mnemonic, Operand, OperandKind, Statement};

/// First byte of R that the system owns.
const SYSTEM_RELAYS: u16 = 900;
/// First byte of K that the system owns.
const SYSTEM_KEEP_RELAYS: u16 = 30;
/// Highest number of a label or a subprogram.
const LAST_LABEL: u32 = 9999;

/// The statements, directives and errors of a ladder text.
#[derive(Clone, Debug, Default)]
pub(crate) struct ParsedLadder {
    pub statements: Vec<Statement>,
    pub directives: Directives,
    pub errors: Vec<CompileError>,
    /// Number of rungs that were parsed so far.
    pub rungs: u32,
}

pub(crate) fn parse(source: &str) -> ParsedLadder {
    let mut parsed = ParsedLadder::default();
    let source = source.strip_prefix('\u{feff}').unwrap_or(source);
    for (index, line) in split_lines(source).enumerate() {
        let number = u32::try_from(index).map_or(u32::MAX, |index| index.saturating_add(1));
        let code = strip_comment(line).trim();
        if code.is_empty() {
            continue;
        }
        let result = if code.starts_with('.') {
            let first_statement = parsed.statements.len();
            directive::parse(code, first_statement, &mut parsed.directives)
        } else {
            parse_statement(code, number, &mut parsed)
        };
        if let Err((code, message)) = result {
            parsed.errors.push(CompileError {
                line: number,
                rung: parsed.rungs,
                code,
                message,
            });
        }
    }
    parsed
}

/// Parses only the initial values and M codes of a text and ignores errors, which [`parse`]
/// reports.
pub(crate) fn parse_declarations(source: &str) -> Directives {
    let mut directives = Directives::default();
    for line in split_lines(source) {
        let line = line.trim_start();
        let declares = [".INIT", ".MCODE"].iter().any(|name| {
            line.get(..name.len())
                .is_some_and(|start| start.eq_ignore_ascii_case(name))
        });
        if declares {
            let code = strip_comment(line).trim_end();
            let _wrong = directive::parse(code, 0, &mut directives);
        }
    }
    directives
}

/// Splits a text into lines, each with its trailing whitespace.
fn split_lines(source: &str) -> impl Iterator<Item = &str> {
    let mut rest = Some(source);
    core::iter::from_fn(move || {
        let text = rest?;
        let (line, after) = match split_once_at(text, b'\n') {
            Some((line, after)) => (line, Some(after)),
            None => (text, None),
        };
        rest = after;
        Some(line)
    })
}

/// Returns the line without the comment that begins at the first `;` outside a string.
fn strip_comment(line: &str) -> &str {
    let mut quoted = false;
    let end = line.bytes().position(|byte| {
        quoted ^= byte == b'"';
        byte == b';' && !quoted
    });
    end.and_then(|end| line.get(..end)).unwrap_or(line)
}

fn parse_statement(code: &str, line: u32, parsed: &mut ParsedLadder) -> Result<(), RuleViolation> {
    let (head, table) = match split_once_at(code, b',') {
        Some((head, table)) => (head, Some(table)),
        None => (code, None),
    };
    let mut tokens = head.split_whitespace();
    let name = tokens.next().unwrap_or_default();
    let mnemonic = Mnemonic::from_name(name).ok_or_else(|| unknown_instruction_violation(name))?;
    parsed.rungs += u32::from(starts_rung(mnemonic, &parsed.statements));
    // A statement with wrong operands remains part of its rung, so that one mistake gives
    // one message.
    parsed.statements.push(Statement {
        mnemonic,
        operands: Vec::new(),
        table: Vec::new(),
        line,
        rung: parsed.rungs,
    });
    let tokens: Vec<&str> = tokens.collect();
    let operands = parse_operands(mnemonic, &tokens)?;
    let table = parse_table_entries(mnemonic, &operands, table)?;
    check_widths(mnemonic, &operands, &table)?;
    if let Some(statement) = parsed.statements.last_mut() {
        statement.operands = operands;
        statement.table = table;
    }
    Ok(())
}

fn unknown_instruction_violation(name: &str) -> RuleViolation {
    let message = match name.to_ascii_uppercase().as_str() {
        "ADDB" | "SUBB" | "COMB" => say::ladder_instruction_of_others(name),
        _ => say::ladder_instruction_unknown(name),
    };
    (Rule::E00, message)
}

fn starts_rung(mnemonic: Mnemonic, before: &[Statement]) -> bool {
    let before = before.last().map(|statement| statement.mnemonic.row().role);
    match mnemonic.row().role {
        InstructionRole::Structure => true,
        InstructionRole::Start => !matches!(
            before,
            Some(InstructionRole::Start | InstructionRole::Contact)
        ),
        InstructionRole::Contact | InstructionRole::Output => {
            matches!(before, None | Some(InstructionRole::Structure))
        }
    }
}

fn parse_operands(mnemonic: Mnemonic, tokens: &[&str]) -> Result<Vec<Operand>, RuleViolation> {
    let row = mnemonic.row();
    if tokens.len() != row.operands.len() {
        let message = say::ladder_operand_count(
            row.name,
            operand_count_message(row.operands.len()),
            tokens.len(),
        );
        return Err((Rule::E06, message));
    }
    row.operands
        .iter()
        .zip(tokens)
        .map(|(kind, token)| parse_operand(row.name, *kind, token))
        .collect()
}

fn parse_operand(name: &str, kind: OperandKind, token: &str) -> Result<Operand, RuleViolation> {
    match kind {
        OperandKind::Label => parse_numbered(token, 'L').map(Operand::Label),
        OperandKind::Subprogram => parse_numbered(token, 'P').map(Operand::Subprogram),
        OperandKind::CounterFormat | OperandKind::RotationFormat => parse_format(name, kind, token),
        _ => match parse_decimal(token) {
            Some(number) => parse_number_operand(name, kind, number),
            None if kind.areas().is_empty() => {
                Err((Rule::E03, say::ladder_number_wanted(token, name)))
            }
            None if kind.is_bit() => parse_bit_operand(name, kind, token),
            None => parse_byte_operand(name, kind, token),
        },
    }
}

fn parse_numbered(token: &str, letter: char) -> Result<u16, RuleViolation> {
    let number = token
        .strip_prefix([letter, letter.to_ascii_lowercase()])
        .and_then(parse_decimal)
        .filter(|number| *number <= LAST_LABEL)
        .and_then(|number| u16::try_from(number).ok());
    number.ok_or_else(|| {
        let message = say::ladder_label_wanted(token, letter, LAST_LABEL);
        (Rule::E03, message)
    })
}

fn parse_format(name: &str, kind: OperandKind, token: &str) -> Result<Operand, RuleViolation> {
    let binary = token.len() == 4 && token.bytes().all(|byte| matches!(byte, b'0' | b'1'));
    if !binary {
        let message = say::ladder_format_wrong(token, name);
        return Err((Rule::E03, message));
    }
    let value = token.bytes().fold(0, |value, byte| value << 1 | byte & 1);
    if kind == OperandKind::CounterFormat && value > 0b11 {
        let message = say::ladder_format_digits(token, name);
        return Err((Rule::E03, message));
    }
    Ok(Operand::Format(value))
}

fn parse_number_operand(
    name: &str,
    kind: OperandKind,
    number: u32,
) -> Result<Operand, RuleViolation> {
    if !kind.can_be_number() {
        let message = say::ladder_address_wanted(number, name);
        return Err((Rule::E03, message));
    }
    let Ok(value) = i32::try_from(number) else {
        return Err((Rule::E03, say::ladder_number_too_large(number)));
    };
    match kind {
        OperandKind::Length if !matches!(value, 1 | 2 | 4) => {
            Err((Rule::E06, say::ladder_length_wrong(value, name)))
        }
        OperandKind::TableSize if !(1..=8).contains(&value) => {
            Err((Rule::E06, say::ladder_size_code_wrong(value)))
        }
        OperandKind::Stations if value == 0 => Err((Rule::E03, say::ladder_position_missing(name))),
        _ => Ok(Operand::Number(value)),
    }
}

fn parse_bit_operand(name: &str, kind: OperandKind, token: &str) -> Result<Operand, RuleViolation> {
    let address: BitAddress = token
        .parse()
        .map_err(|error| address_violation(name, &error))?;
    if !kind.areas().contains(&address.area) {
        let message = say::ladder_bit_read_only(token, name, address.area);
        return Err((Rule::E03, message));
    }
    if kind.is_written() {
        check_system_area(token, address.byte_address(), 1)?;
    }
    if kind == OperandKind::ThreeCoils && address.bit > 5 {
        let message = say::ladder_three_coils(token, name);
        return Err((Rule::E03, message));
    }
    Ok(Operand::Bit(address))
}

fn parse_byte_operand(
    name: &str,
    kind: OperandKind,
    token: &str,
) -> Result<Operand, RuleViolation> {
    let address: ByteAddress = token
        .parse()
        .map_err(|error| address_violation(name, &error))?;
    if !kind.areas().contains(&address.area) {
        let areas: Vec<&str> = kind.areas().iter().map(|area| area.letter()).collect();
        let areas = areas.join(", ");
        let message = if kind.can_be_number() {
            say::ladder_area_or_number_wrong(token, name, areas)
        } else {
            say::ladder_area_wrong(token, name, areas)
        };
        return Err((Rule::E03, message));
    }
    Ok(Operand::Byte(address))
}

fn address_violation(name: &str, error: &AddressError) -> RuleViolation {
    (
        Rule::E03,
        say::ladder_instruction_reason(name, error.message()),
    )
}

/// Checks that a write does not reach the bytes that the system owns.
fn check_system_area(token: &str, address: ByteAddress, width: u16) -> Result<(), RuleViolation> {
    let first = match address.area {
        Area::R => SYSTEM_RELAYS,
        Area::K => SYSTEM_KEEP_RELAYS,
        _ => return Ok(()),
    };
    if address.byte.saturating_add(width) <= first {
        return Ok(());
    }
    let message = say::ladder_system_area(token, address.area, first);
    Err((Rule::E03, message))
}

/// Parses the table entries after the comma of a CODB; empty for all other instructions.
fn parse_table_entries(
    mnemonic: Mnemonic,
    operands: &[Operand],
    table: Option<&str>,
) -> Result<Vec<i32>, RuleViolation> {
    let [Operand::Number(_), Operand::Number(code), ..] = operands else {
        return refuse_table(mnemonic, table);
    };
    if mnemonic != Mnemonic::Codb {
        return refuse_table(mnemonic, table);
    }
    let size = 1usize << code.clamp(&1, &8);
    let entries = table.unwrap_or_default().split_whitespace();
    let entries = entries
        .map(|token| {
            let entry = parse_decimal(token).and_then(|number| i32::try_from(number).ok());
            entry.ok_or_else(|| (Rule::E03, say::ladder_table_entry_wrong(token)))
        })
        .collect::<Result<Vec<i32>, RuleViolation>>()?;
    if entries.len() != size {
        let message = say::ladder_table_size_wrong(code, size, entries.len());
        return Err((Rule::E06, message));
    }
    Ok(entries)
}

fn refuse_table(mnemonic: Mnemonic, table: Option<&str>) -> Result<Vec<i32>, RuleViolation> {
    match table {
        None => Ok(Vec::new()),
        Some(_) => Err((Rule::E06, say::ladder_table_not_taken(mnemonic.row().name))),
    }
}

/// Checks that source and target have enough bytes for the length of the instruction.
fn check_widths(
    mnemonic: Mnemonic,
    operands: &[Operand],
    table: &[i32],
) -> Result<(), RuleViolation> {
    let kinds = mnemonic.row().operands;
    let length = kinds
        .iter()
        .zip(operands)
        .find_map(|(kind, operand)| match operand {
            Operand::Number(length) if *kind == OperandKind::Length => u16::try_from(*length).ok(),
            _ => None,
        });
    let length = length.unwrap_or(1);
    for (kind, operand) in kinds.iter().zip(operands) {
        match operand {
            Operand::Number(number) if kind.has_instruction_length() => {
                check_number_fits(*number, length)?;
            }
            Operand::Byte(address) => {
                let width = if kind.has_instruction_length() {
                    length
                } else {
                    1
                };
                check_bytes_in_area(*address, width)?;
                if kind.is_written() {
                    check_system_area(&address.to_string(), *address, width)?;
                }
            }
            _ => {}
        }
    }
    table
        .iter()
        .try_for_each(|entry| check_number_fits(*entry, length))
}

fn check_number_fits(number: i32, length: u16) -> Result<(), RuleViolation> {
    let largest = match length {
        1 => 0xFF,
        2 => 0xFFFF,
        _ => i32::MAX,
    };
    if number <= largest {
        return Ok(());
    }
    let message = say::ladder_number_too_wide(number, byte_count_message(length));
    Err((Rule::E03, message))
}

fn check_bytes_in_area(address: ByteAddress, width: u16) -> Result<(), RuleViolation> {
    if address.area.is_entry() || address.byte + width <= address.area.count() {
        return Ok(());
    }
    let message =
        say::ladder_bytes_beyond_area(address, width, address.area, address.area.count() - 1);
    Err((Rule::E03, message))
}

fn operand_count_message(operands: usize) -> Message {
    match operands {
        0 => say::ladder_no_operands(),
        1 => say::ladder_one_operand(),
        _ => say::ladder_operands(operands),
    }
}

fn byte_count_message(bytes: u16) -> Message {
    match bytes {
        1 => say::ladder_one_byte(),
        _ => say::ladder_bytes(bytes),
    }
}
