//! Tests every instruction with the tables of inputs and outputs in `tests/tables/*.txt`.
//!
//! A file has one or more blocks. A block is a ladder, then a line of addresses with an
//! arrow, then rows of values. Values left of the arrow are written before the slot; values
//! right of it are compared after the slot.
//!
//! ```text
//! # Series contact.
//! LD R1.0
//! AND R1.1
//! OUT R2.0
//! R1.0 R1.1 -> R2.0
//! 0    1    -> 0
//! 1    1    -> 1
//! ```
//!
//! `.` leaves an input unchanged and does not compare an output. `R10:2` and `R10:4` are
//! values of two and four bytes. The column `slots` is the number of slots to run, 1 by
//! default. `power` with 1 switches the PLC off and on first. The ladder is in level 2
//! unless it contains END1.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test that cannot go on should say where"
)]

use std::path::Path;
use std::sync::Arc;

use gsk_plc::{ByteAddress, INSTRUCTIONS, Ladder, Plc, PlcMemory};

/// A column of a table.
#[derive(Clone, Copy, Debug)]
enum Column {
    Bit(gsk_plc::BitAddress),
    Byte(ByteAddress),
    Word(ByteAddress),
    Long(ByteAddress),
    Slots,
    Power,
}

impl Column {
    fn parse(text: &str) -> Column {
        if text == "slots" {
            return Column::Slots;
        }
        if text == "power" {
            return Column::Power;
        }
        if let Ok(bit) = text.parse() {
            return Column::Bit(bit);
        }
        let (address, width) = text.split_once(':').unwrap_or((text, "1"));
        let address: ByteAddress = address
            .parse()
            .unwrap_or_else(|error| panic!("column {text}: {error}"));
        match width {
            "2" => Column::Word(address),
            "4" => Column::Long(address),
            _ if address.area.is_entry() => Column::Long(address),
            _ => Column::Byte(address),
        }
    }

    fn read(self, memory: &PlcMemory) -> i64 {
        match self {
            Column::Bit(bit) => memory.bit(bit).into(),
            Column::Byte(byte) => memory.byte(byte).into(),
            Column::Word(word) => memory.word(word).into(),
            Column::Long(long) => memory.long(long).into(),
            Column::Slots | Column::Power => panic!("only left of the arrow"),
        }
    }

    fn write(self, memory: &mut PlcMemory, value: i64) {
        match self {
            Column::Bit(bit) => memory.set_bit(bit, value != 0),
            Column::Byte(byte) => memory.set_byte(byte, value.try_into().unwrap()),
            Column::Word(word) => memory.set_word(word, value.try_into().unwrap()),
            Column::Long(long) => memory.set_long(long, value.try_into().unwrap()),
            Column::Slots | Column::Power => {}
        }
    }
}

fn parse_number(text: &str) -> i64 {
    match text.strip_prefix("0b") {
        Some(binary) => i64::from_str_radix(binary, 2).unwrap(),
        None => text.parse().unwrap_or_else(|_| panic!("no number: {text}")),
    }
}

/// Returns the values of a row with their columns, without those marked `.`.
fn parse_values<'a>(columns: &'a [Column], text: &'a str) -> Vec<(Column, i64)> {
    let texts: Vec<&str> = text.split_whitespace().collect();
    assert_eq!(texts.len(), columns.len(), "values of the row {text}");
    columns
        .iter()
        .zip(texts)
        .filter(|(_, text)| *text != ".")
        .map(|(column, text)| (*column, parse_number(text)))
        .collect()
}

fn compile_plc(lines: &[&str]) -> Plc {
    let text = lines.join("\n");
    let whole = lines.iter().any(|line| line.trim() == "END1");
    let source = if whole {
        text
    } else {
        format!("END1\n{text}\nEND2")
    };
    Plc::new(Arc::new(
        Ladder::compile(&source).unwrap_or_else(|errors| panic!("{errors}\n{source}")),
    ))
}

/// Runs all rows of a file and returns their number.
fn run_table(text: &str) -> usize {
    let mut ladder: Vec<&str> = Vec::new();
    let mut table: Option<(Plc, Vec<Column>, Vec<Column>)> = None;
    let mut rows = 0;
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        let Some((inputs, outputs)) = line.split_once("->") else {
            if table.take().is_some() {
                ladder.clear();
            }
            ladder.push(line);
            continue;
        };
        let Some((plc, left, right)) = &mut table else {
            let columns = |text: &str| text.split_whitespace().map(Column::parse).collect();
            table = Some((compile_plc(&ladder), columns(inputs), columns(outputs)));
            continue;
        };
        let inputs = parse_values(left, inputs);
        let given = |wanted: fn(&Column) -> bool| inputs.iter().find(|(c, _)| wanted(c));
        if given(|column| matches!(column, Column::Power)).is_some_and(|(_, on)| *on == 1) {
            plc.power_on();
        }
        for (column, value) in &inputs {
            column.write(plc.memory_mut(), *value);
        }
        let slots = given(|column| matches!(column, Column::Slots)).map_or(1, |(_, n)| *n);
        for _ in 0..slots {
            plc.run_slot();
        }
        for (column, expected) in parse_values(right, outputs) {
            let seen = column.read(plc.memory());
            assert_eq!(seen, expected, "line {number}: {column:?} after {line}");
        }
        rows += 1;
    }
    rows
}

#[test]
fn each_instruction_matches_its_table() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tables");
    for row in &INSTRUCTIONS {
        let path = folder.join(format!("{}.txt", row.name.to_lowercase()));
        let text = std::fs::read_to_string(&path)
            .unwrap_or_else(|error| panic!("{} has no table: {error}", row.name));
        println!("{}", row.name);
        assert!(run_table(&text) >= 2, "{} has rows", row.name);
    }
}
