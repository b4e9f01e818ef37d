//! Tests that a scan that skips rungs leaves the same memory, slot by slot, as a scan of
//! every rung.
//!
//! The reference is the same PLC with an unused bit forced: it runs every rung, one
//! operation after the other.

#![allow(
    clippy::unwrap_used,
    reason = "a test that cannot go on should say where"
)]

use std::sync::Arc;

use gsk_plc::{ByteAddress, Ladder, Plc};
use proptest::prelude::*;

const STANDARD: &str = include_str!("../../assets/ladder/standard.il");

/// A write to memory from outside before a slot.
#[derive(Clone, Debug)]
struct MemoryWrite {
    byte: String,
    value: u8,
}

fn compare_with_full_scan(
    ladder: &Arc<Ladder>,
    slots: &[Vec<MemoryWrite>],
) -> Result<(), TestCaseError> {
    compare_with_full_scan_and_forces(ladder, slots, usize::MAX)
}

/// Forces a bit in every `every`-th slot, so that all rungs run in it.
fn compare_with_full_scan_and_forces(
    ladder: &Arc<Ladder>,
    slots: &[Vec<MemoryWrite>],
    every: usize,
) -> Result<(), TestCaseError> {
    let mut plc = Plc::new(Arc::clone(ladder));
    let mut whole = plc.clone();
    whole.force("R999.7".parse().unwrap(), Some(false));
    for (slot, writes) in slots.iter().enumerate() {
        for MemoryWrite { byte, value } in writes {
            let address: ByteAddress = byte.parse().unwrap();
            plc.memory_mut().set_byte(address, *value);
            whole.memory_mut().set_byte(address, *value);
        }
        // Forcing a bit invalidates the cache, so the bit is forced only in these slots.
        let held = slot % every == every - 1;
        if held {
            plc.force("R999.6".parse().unwrap(), Some(false));
        }
        plc.run_slot();
        if held {
            plc.force("R999.6".parse().unwrap(), None);
        }
        whole.run_slot();
        prop_assert_eq!(plc.memory(), whole.memory(), "slot {}", slot);
    }
    Ok(())
}

fn memory_write(byte: impl Strategy<Value = String>) -> impl Strategy<Value = MemoryWrite> {
    let value = prop_oneof![any::<u8>(), 0..3u8];
    (byte, value).prop_map(|(byte, value)| MemoryWrite { byte, value })
}

/// Generates slots; most of them have no write.
fn slots(
    byte: impl Strategy<Value = String>,
    most: usize,
) -> impl Strategy<Value = Vec<Vec<MemoryWrite>>> {
    let writes = prop::collection::vec(memory_write(byte), 1..4);
    let slot = prop_oneof![6 => Just(Vec::new()), 1 => writes];
    prop::collection::vec(slot, 1..most)
}

/// Generates few different bytes, so that the rungs of a small ladder share them.
fn byte() -> impl Strategy<Value = String> {
    prop_oneof![
        (0..2u8).prop_map(|n| format!("X{n}")),
        (0..2u8).prop_map(|n| format!("F{n}")),
        (0..2u8).prop_map(|n| format!("G{n}")),
        (0..4u8).prop_map(|n| format!("R{n}")),
        (0..4u8).prop_map(|n| format!("D{n}")),
        (0..2u8).prop_map(|n| format!("C{n}")),
    ]
}

fn written() -> impl Strategy<Value = String> {
    prop_oneof![
        (0..2u8).prop_map(|n| format!("G{n}")),
        (0..4u8).prop_map(|n| format!("R{n}")),
        (0..4u8).prop_map(|n| format!("D{n}")),
    ]
}

fn read_bit() -> impl Strategy<Value = String> {
    let byte = prop_oneof![
        Just("X0"),
        Just("X1"),
        Just("F0"),
        Just("G0"),
        Just("R0"),
        Just("R1"),
        Just("R2"),
    ];
    (byte, 0..3u8).prop_map(|(byte, bit)| format!("{byte}.{bit}"))
}

fn written_bit() -> impl Strategy<Value = String> {
    let byte = prop_oneof![Just("G0"), Just("R0"), Just("R1"), Just("R2"), Just("Y0")];
    (byte, 0..3u8).prop_map(|(byte, bit)| format!("{byte}.{bit}"))
}

fn value() -> impl Strategy<Value = String> {
    prop_oneof![byte(), (0..6u8).prop_map(|number| number.to_string())]
}

fn contacts() -> impl Strategy<Value = String> {
    let further = (0..4usize, read_bit());
    let name = |kind: usize| ["AND", "ANI", "OR", "ORI"][kind];
    let further = further.prop_map(move |(kind, bit)| format!("{} {bit}\n", name(kind)));
    let first = (any::<bool>(), read_bit());
    let first = first.prop_map(|(not, bit)| format!("LD{} {bit}\n", if not { "I" } else { "" }));
    (first, prop::collection::vec(further, 0..3)).prop_map(|(first, rest)| first + &rest.concat())
}

fn coils() -> impl Strategy<Value = String> {
    prop_oneof![
        (0..2u8).prop_map(|n| format!("G{n}")),
        (0..4u8).prop_map(|n| format!("R{n}")),
    ]
}

/// With `result`, some rungs read R900.
fn output(result: bool) -> BoxedStrategy<String> {
    let copied = if result { "R900" } else { "R3" };
    prop_oneof![
        4 => written_bit().prop_map(|bit| format!("OUT {bit}\n")),
        2 => written_bit().prop_map(|bit| format!("SET {bit}\n")),
        2 => written_bit().prop_map(|bit| format!("RST {bit}\n")),
        3 => (value(), value(), coils())
            .prop_map(|(a, b, to)| format!("CMP 1 {a} {b} {to}.0\n")),
        // `ladder` replaces `#` by a unique timer number.
        2 => (0..2u8, written_bit()).prop_map(|(time, bit)| format!("TMRB T# DT{time} {bit}\n")),
        1 => (0..2u8, 0..2u8, read_bit(), 0..2u8, 0..2u8, written_bit()).prop_map(
            |(first, down, reset, counter, preset, bit)|
                format!("CTRC 00{first}{down} {reset} C{counter} DC{preset} {bit}\n")
        ),
        2 => (value(), written()).prop_map(|(from, to)| format!("MOVN 1 {from} {to}\n")),
        1 => (byte(), coils()).prop_map(|(from, to)| format!("DECB 1 {from} 1 {to}\n")),
        1 => (written(), written())
            .prop_map(|(index, to)| format!("CODB 1 2 {index} {to} , 3 1 7 0\n")),
        1 => (written(), written(), written(), written_bit()).prop_map(
            |(current, target, result, bit)|
                format!("ROTB 1110 0006 1 {current} {target} {result} {bit}\n")
        ),
        1 => Just(format!("MOVN 1 {copied} D3\n")),
    ]
    .boxed()
}

fn rungs(most: usize, result: bool) -> impl Strategy<Value = String> {
    let rung = (contacts(), prop::collection::vec(output(result), 1..3));
    let rung = rung.prop_map(|(contacts, outputs)| contacts + &outputs.concat());
    prop::collection::vec(rung, 0..most).prop_map(|rungs| rungs.concat())
}

fn ladder() -> impl Strategy<Value = String> {
    let rungs = |result| (rungs(4, result), rungs(12, result));
    prop_oneof![3 => rungs(false), 1 => rungs(true)].prop_map(|(first, second)| {
        let presets = ".INIT DT0 0\n.INIT DT1 30\n.INIT DC0 1\n.INIT DC1 3\n";
        let text = format!("{presets}{first}END1\n{second}END2\n");
        let mut numbered = String::new();
        for (number, part) in text.split('#').enumerate() {
            if number > 0 {
                numbered.push_str(&(number - 1).to_string());
            }
            numbered.push_str(part);
        }
        numbered
    })
}

/// A rung clears a bit that its counter sets again in the scan with the counter's edge. Its
/// bytes are unchanged after that scan, but not after the next.
#[test]
fn counter_after_its_edge_runs_again() {
    let text = "\
        .INIT DC0 1\n\
        LD R1.0\nSET R1.1\nEND1\n\
        LD R0.1\nCTRC 0000 R0.2 C1 DC0 G0.0\nOUT G0.0\n\
        LD R0.0\nORI G0.0\nOUT R1.0\n\
        LDI R0.0\nANI R1.0\nMOVN 1 D0 R1\nCTRC 0010 R2.0 C1 DC0 R1.1\n\
        LDI X0.0\nSET R0.1\nEND2\n";
    let ladder = Arc::new(Ladder::compile(text).unwrap());
    compare_with_full_scan(&ladder, &[const { Vec::new() }; 6]).unwrap();
}

/// The ACT of the counter falls in a slot that runs all rungs and rises in the next slot.
#[test]
fn counter_edge_after_full_slot_counts() {
    let text = "\
        .INIT DC0 1\n\
        LD X0.0\nMOVN 1 D0 R1\nCTRC 0010 R2.0 C1 DC0 R1.1\nEND1\n\
        LD X1.0\nOUT G0.0\nEND2\n";
    let ladder = Arc::new(Ladder::compile(text).unwrap());
    let memory_write = |byte: &str, value| MemoryWrite {
        byte: byte.into(),
        value,
    };
    let slots = [
        vec![memory_write("X0", 1)],
        Vec::new(),
        Vec::new(),
        // A slot that runs all rungs.
        vec![memory_write("X0", 0)],
        vec![
            memory_write("X0", 1),
            memory_write("R1", 2),
            memory_write("C1", 1),
        ],
        Vec::new(),
        Vec::new(),
    ];
    compare_with_full_scan_and_forces(&ladder, &slots, 4).unwrap();
}

/// Every scan clears a number, reads it and sets it again. The rungs rest until one rung of
/// their pass must run.
#[test]
fn rungs_sharing_written_bytes_match_full_scan() {
    let text = "\
        LD X0.0\nOUT R0.0\nEND1\n\
        LDI X0.7\nMOVN 1 0 R5\n\
        LD R0.0\nOUT R1.0\n\
        LD X0.1\nMOVN 1 R5 R6\n\
        LD R1.0\nMOVN 1 7 R5\n\
        LD X0.2\nMOVN 1 R5 R7\n\
        LDI X0.3\nMOVN 1 9 R5\n\
        END2\n";
    let ladder = Arc::new(Ladder::compile(text).unwrap());
    let mut slots = Vec::new();
    for round in 0..256u32 {
        slots.push(vec![MemoryWrite {
            byte: "X0".into(),
            value: (round * 37 % 251) as u8,
        }]);
        slots.extend((0..6).map(|_| Vec::new()));
    }
    compare_with_full_scan(&ladder, &slots).unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn random_ladder_matches_full_scan(text in ladder(), slots in slots(byte(), 60)) {
        match Ladder::compile(&text) {
            Ok(ladder) => compare_with_full_scan(&Arc::new(ladder), &slots)?,
            Err(errors) => prop_assert!(false, "{}\n{}", text, errors),
        }
    }

    #[test]
    fn random_ladder_with_some_full_slots_matches_full_scan(
        text in ladder(),
        slots in slots(byte(), 60),
        every in 2..9usize,
    ) {
        match Ladder::compile(&text) {
            Ok(ladder) => compare_with_full_scan_and_forces(&Arc::new(ladder), &slots, every)?,
            Err(errors) => prop_assert!(false, "{}\n{}", text, errors),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn standard_ladder_matches_full_scan(
        slots in slots(
            prop_oneof![
                (0..30u8).prop_map(|n| format!("X{n}")),
                (0..=255u8).prop_map(|n| format!("F{n}")),
                (0..40u8).prop_map(|n| format!("K{n}")),
                (0..14u8).prop_map(|n| format!("DT{n}")),
            ],
            1500,
        ),
    ) {
        compare_with_full_scan(&Arc::new(Ladder::compile(STANDARD).unwrap()), &slots)?;
    }
}
