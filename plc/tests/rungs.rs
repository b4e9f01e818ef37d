//! Tests ladder diagrams, power flow, the cross reference, forced bits and single-rung
//! steps.

#![allow(
    clippy::unwrap_used,
    reason = "a test that cannot go on should say where"
)]

use std::sync::Arc;

use gsk_plc::{
    Access, Area, BitAddress, ByteAddress, Element, INSTRUCTIONS, InstructionRole, InstructionRow,
    Ladder, Mnemonic, Operand, OperandKind, Plc, PlcAddress, RungBody, Statement,
};
use proptest::prelude::*;

const STANDARD: &str = include_str!("../../assets/ladder/standard.il");

/// Returns an instruction without its line and rung.
fn instruction_parts(statement: &Statement) -> (Mnemonic, Vec<Operand>, Vec<i32>) {
    let Statement {
        mnemonic,
        operands,
        table,
        ..
    } = statement;
    (*mnemonic, operands.clone(), table.clone())
}

/// Asserts that instruction lists convert to diagrams and back without a difference.
fn assert_round_trip(ladder: &Ladder) {
    let before: Vec<_> = ladder.statements().iter().map(instruction_parts).collect();
    let after: Vec<_> = ladder
        .networks()
        .flat_map(|network| network.statements())
        .collect();
    assert_eq!(
        before,
        after.iter().map(instruction_parts).collect::<Vec<_>>()
    );
    let text: String = after.iter().map(|line| format!("{line}\n")).collect();
    let again = Ladder::compile(&text).unwrap();
    let again: Vec<_> = again.statements().iter().map(instruction_parts).collect();
    assert_eq!(before, again);
}

#[test]
fn standard_ladder_round_trips_through_networks() {
    let ladder = Ladder::compile(STANDARD).unwrap();
    assert_round_trip(&ladder);
    assert_eq!(ladder.networks().count(), ladder.rung_count() as usize);
    for network in ladder.networks() {
        assert_eq!(ladder.network(network.number).as_ref(), Some(&network));
        if let RungBody::Rung { contacts, outputs } = &network.body {
            assert_eq!(contacts.len(), 1, "rung {}", network.number);
            assert!(!outputs.is_empty(), "rung {}", network.number);
        }
    }
}

#[test]
fn all_contact_connections_round_trip() {
    for rung in [
        "LD R1.0",
        "LDI R1.0\nAND R1.1\nANI R1.2\nAND R1.3",
        "LD R1.0\nOR R1.1\nORI R1.2\nAND R1.3\nOR R1.4",
        "LD R1.0\nAND R1.1\nLD R1.2\nAND R1.3\nORB\nOR R1.4",
        "LD R1.0\nOR R1.1\nLD R1.2\nAND R1.3\nLD R1.4\nAND R1.5\nORB\nANB",
        // A single contact as a block, and blocks connected from last to first.
        "LD R1.0\nLD R1.1\nANB\nLD R1.2\nORB",
        "LD R1.0\nLD R1.1\nLD R1.2\nANB\nANB",
        "LD R1.0\nLD R1.1\nLD R1.2\nORB\nANB\nORI R1.3",
    ] {
        let source = format!("END1\n{rung}\nOUT R2.0\nSET R2.1\nEND2");
        assert_round_trip(&Ladder::compile(&source).unwrap());
    }
    // Rungs without effect, structural instructions, a subprogram.
    assert_round_trip(&Ladder::compile("END1\nLD R1.0\nLD R1.1\nEND2\nSP P1\nSPE").unwrap());
    assert_round_trip(&Ladder::compile("LD R1.0\nJMPB L1\nLBL L1\nEND1\nEND2").unwrap());
}

#[test]
fn the_drawing_has_contacts_where_the_list_puts_them() {
    let ladder = Ladder::compile("END1\nLD R1.0\nOR R1.1\nANI R1.2\nOUT R2.0\nEND2").unwrap();
    let Some(RungBody::Rung { contacts, outputs }) = ladder.network(2).map(|network| network.body)
    else {
        panic!("rung 2 is a rung");
    };
    assert_eq!(outputs[0].to_string(), "OUT R0002.0");
    let [Element::Series(series)] = &contacts[..] else {
        panic!("a series: {contacts:?}");
    };
    let Element::Parallel(parallel) = &series[0].element else {
        panic!("beginning with branches: {series:?}");
    };
    assert_eq!(parallel.len(), 2);
    assert!(matches!(&series[1].element, Element::Contact(c) if c.normally_closed && c.at == 2));
}

/// Returns a valid operand of a kind, selected by `choice`.
fn operand(kind: OperandKind, choice: u32, length: u16) -> Operand {
    let areas = kind.areas();
    let area = areas.get(choice as usize % areas.len().max(1)).copied();
    let offset = choice / 16;
    // Excludes the bytes that the system owns and the last bytes of the area.
    let area_size = |area: Area| match area {
        Area::K => 30 - length,
        Area::R => 900 - length,
        area if area.is_entry() => area.count(),
        area => area.count() - length,
    };
    match (kind, area) {
        (OperandKind::Length, _) => Operand::Number(i32::from(length)),
        (OperandKind::TableSize, _) => Operand::Number(1 + (choice % 4) as i32),
        (OperandKind::Stations, _) => Operand::Number(1 + (choice % 255) as i32),
        (OperandKind::CounterFormat, _) => Operand::Format((choice % 4) as u8),
        (OperandKind::RotationFormat, _) => Operand::Format((choice % 16) as u8),
        (_, None) => Operand::Number((choice % 256) as i32),
        (kind, _) if kind.can_be_number() && choice.is_multiple_of(3) => {
            Operand::Number((choice % 256) as i32)
        }
        (kind, Some(area)) => {
            let byte = (offset % u32::from(area_size(area))) as u16;
            let bits = if kind == OperandKind::ThreeCoils {
                6
            } else {
                8
            };
            if kind.is_bit() {
                Operand::Bit(BitAddress::new(area, byte, (choice / 7 % bits) as u8))
            } else {
                Operand::Byte(ByteAddress::new(area, byte))
            }
        }
    }
}

/// Generates the contacts of one rung, as a list with one result.
fn contacts() -> impl Strategy<Value = Vec<String>> {
    let contact = (any::<bool>(), any::<u32>()).prop_map(|(closed, choice)| {
        let bit = operand(OperandKind::Contact, choice, 1);
        (if closed { "I" } else { "" }, bit.to_string())
    });
    let leaf = contact
        .clone()
        .prop_map(|(closed, bit)| vec![format!("LD{closed} {bit}")]);
    leaf.prop_recursive(6, 24, 2, move |inner| {
        prop_oneof![
            (inner.clone(), contact.clone()).prop_map(|(mut list, (closed, bit))| {
                list.push(format!(
                    "AN{} {bit}",
                    if closed.is_empty() { "D" } else { "I" }
                ));
                list
            }),
            (inner.clone(), contact.clone()).prop_map(|(mut list, (closed, bit))| {
                list.push(format!("OR{closed} {bit}"));
                list
            }),
            (inner.clone(), inner, any::<bool>()).prop_map(|(mut list, right, series)| {
                list.extend(right);
                list.push(if series { "ANB" } else { "ORB" }.to_owned());
                list
            }),
        ]
    })
}

/// Returns an output instruction with operands selected by `choices`; jumps excluded.
fn output(row: &InstructionRow, choices: &[u32; 8], timer: &mut u16) -> String {
    let length = [1, 2, 4][choices[7] as usize % 3];
    let operands: Vec<Operand> = row
        .operands
        .iter()
        .zip(choices)
        .map(|(kind, choice)| match kind {
            // A timer number is unique in a program.
            OperandKind::Timer => {
                *timer += 1;
                Operand::Byte(ByteAddress::new(Area::T, *timer - 1))
            }
            kind => operand(*kind, *choice, length),
        })
        .collect();
    let size = match (row.mnemonic, operands.get(1)) {
        (Mnemonic::Codb, Some(Operand::Number(code))) => 1usize << code,
        _ => 0,
    };
    let table = (0..size).map(|at| (at * 7 % 256) as i32).collect();
    Statement {
        mnemonic: row.mnemonic,
        operands,
        table,
        line: 0,
        rung: 0,
    }
    .to_string()
}

fn program() -> impl Strategy<Value = String> {
    let outputs: Vec<&'static InstructionRow> = INSTRUCTIONS
        .iter()
        .filter(|row| row.role == InstructionRole::Output)
        .filter(|row| !matches!(row.mnemonic, Mnemonic::Jmpb | Mnemonic::Call))
        .collect();
    let output_choice = (0..outputs.len(), any::<[u32; 8]>());
    let rung = (contacts(), prop::collection::vec(output_choice, 1..4));
    let rungs = prop::collection::vec(rung, 1..30);
    (rungs, 0..5usize).prop_map(move |(rungs, level1)| {
        let mut timer = 0;
        let mut text = String::new();
        let level1 = level1.min(rungs.len());
        for (index, (contacts, chosen)) in rungs.iter().enumerate() {
            if index == level1 {
                text.push_str("END1\n");
            }
            // Some rungs are within a jump and have a call.
            let jumps = index > level1 && chosen.len() == 3;
            if jumps {
                text.push_str(&format!("LD R1.0\nJMPB L{index}\nLD R1.1\nCALL P1\n"));
            }
            for line in contacts {
                text.push_str(line);
                text.push('\n');
            }
            for (row, choices) in chosen {
                text.push_str(&output(outputs[*row], choices, &mut timer));
                text.push('\n');
            }
            if jumps {
                text.push_str(&format!("LBL L{index}\n"));
            }
        }
        if level1 >= rungs.len() {
            text.push_str("END1\n");
        }
        text.push_str("END2\nSP P1\nLD R2.0\nOUT R2.1\nSPE\n");
        text
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn random_programs_round_trip_through_networks(source in program()) {
        let ladder = Ladder::compile(&source)
            .map_err(|errors| TestCaseError::fail(format!("{errors}\n{source}")))?;
        assert_round_trip(&ladder);
        let listed = ladder.to_source();
        let again = Ladder::compile(&listed).unwrap();
        prop_assert_eq!(again.to_source(), listed);
        assert_round_trip(&again);
    }

}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn power_flow_matches_scan_result(list in contacts(), values in any::<[u8; 32]>()) {
        let source = format!("END1\n{}\nOUT R899.7\nEND2", list.join("\n"));
        let ladder = Arc::new(Ladder::compile(&source).unwrap());
        let mut plc = Plc::new(Arc::clone(&ladder));
        for (index, statement) in ladder.statements().iter().enumerate() {
            if let Some(Operand::Bit(bit)) = statement.operands.first() {
                let value = values[index % 32] >> (index % 8) & 1 == 1;
                plc.memory_mut().set_bit(*bit, value);
            }
        }
        plc.run_slot();
        let coil = plc.memory().bit("R899.7".parse().unwrap());
        plc.memory_mut().set_bit("R899.7".parse().unwrap(), false);
        let network = ladder.network(2).unwrap();
        let reads_own_coil = list.iter().any(|line| line.ends_with("R0899.7"));
        let power = plc.power_flow(&network);
        prop_assert_eq!(power.len(), list.len() + 1);
        if !reads_own_coil {
            prop_assert_eq!(power.last().unwrap().live, coil);
        }
    }

    #[test]
    fn stepping_rungs_matches_running_slots(source in program(), inputs in any::<[u8; 16]>()) {
        let ladder = Arc::new(Ladder::compile(&source).unwrap());
        let mut whole = Plc::new(Arc::clone(&ladder));
        let mut stepped = Plc::new(ladder);
        for input in inputs {
            for plc in [&mut whole, &mut stepped] {
                plc.memory_mut().set_x(0, input);
                plc.memory_mut().set_r(1, input);
            }
            whole.run_slot();
            stepped.step_rung();
            let mut steps = 1;
            while stepped.is_within_slot() {
                stepped.step_rung();
                steps += 1;
                prop_assert!(steps < 1000);
            }
            prop_assert_eq!(whole.memory(), stepped.memory());
        }
        prop_assert_eq!(whole, stepped);
    }
}

#[test]
fn power_flow_stops_at_open_contacts() {
    // X0.0 and X0.1 in parallel with X0.2, then X0.3.
    let source = "LD X0.0\nAND X0.1\nOR X0.2\nANI X0.3\nOUT Y0.0\nMOVN 1 1 R5\nEND1\nEND2";
    let ladder = Arc::new(Ladder::compile(source).unwrap());
    let mut plc = Plc::new(Arc::clone(&ladder));
    let network = ladder.network(1).unwrap();
    // X0, then for each statement `closed` and `live` as digits.
    let table = [
        (0b0000, "00 00 00 10 00 00"),
        (0b0001, "11 00 00 10 00 00"),
        (0b0011, "11 11 00 11 11 01"),
        (0b0010, "00 10 00 10 00 00"),
        (0b0100, "00 00 11 11 11 01"),
        (0b1100, "00 00 11 00 00 00"),
    ];
    for (x0, expected) in table {
        plc.memory_mut().set_x(0, x0);
        plc.run_slot();
        let states = plc.power_flow(&network);
        let seen: Vec<String> = states
            .iter()
            .map(|state| format!("{}{}", u8::from(state.closed), u8::from(state.live)))
            .collect();
        assert_eq!(seen.join(" "), expected, "X0 = {x0:04b}");
    }
}

#[test]
fn cross_reference_finds_bits_in_bytes_and_bytes_in_longer_values() {
    let source = "END1
        LD X0.1
        OUT R10.3
        MOVN 2 X0 D300
        CMP 1 R10 5 R20.2
        TMRB T3 DT4 R21.0
        CTRC 0000 X0.2 C7 DC8 R21.1
        LD R20.4
        MOVN 4 D298 R8
        END2";
    let ladder = Ladder::compile(source).unwrap();
    let found = |text: &str| -> Vec<(u32, Access)> {
        let subject = match text.parse() {
            Ok(bit) => PlcAddress::Bit(bit),
            Err(_) => PlcAddress::Byte(text.parse().unwrap()),
        };
        let references = ladder.references(subject);
        references.iter().map(|r| (r.line, r.access)).collect()
    };
    use Access::{Read, ReadWrite, Write};
    assert_eq!(found("X0.1"), [(2, Read), (4, Read)]);
    assert_eq!(found("X0.2"), [(4, Read), (7, Read)]);
    assert_eq!(found("X1"), [(4, Read)]);
    assert_eq!(found("R10.3"), [(3, Write), (5, Read), (9, Write)]);
    assert_eq!(found("D301"), [(4, Write), (9, Read)]);
    assert_eq!(found("R20.3"), [(5, Write)]);
    assert_eq!(found("R20.5"), []);
    assert_eq!(found("R20.4"), [(5, Write), (8, Read)]);
    assert_eq!(found("R900.0"), [(5, Write)]);
    assert_eq!(found("R900.2"), []);
    assert_eq!(found("T3"), [(6, ReadWrite)]);
    assert_eq!(found("DT4"), [(6, Read)]);
    assert_eq!(found("C7"), [(7, ReadWrite)]);
    assert_eq!(found("R11"), [(9, Write)]);
    assert_eq!(found("R12"), []);
    assert!(
        ladder
            .addresses()
            .contains(&PlcAddress::Byte("DC8".parse().unwrap()))
    );
}

#[test]
fn standard_ladder_sets_and_resets_spindle_output() {
    let ladder = Ladder::compile(STANDARD).unwrap();
    let m03 = ladder.references(PlcAddress::Bit("Y1.2".parse().unwrap()));
    let written: Vec<Mnemonic> = m03
        .iter()
        .filter(|r| r.access.is_write())
        .map(|r| r.mnemonic)
        .collect();
    assert_eq!(written, [Mnemonic::Set, Mnemonic::Rst]);
    assert!(m03.iter().filter(|r| r.access.is_read()).count() > 3);
}

#[test]
fn forced_bit_overrides_ladder_and_machine() {
    let bit = |text: &str| -> BitAddress { text.parse().unwrap() };
    let source = "END1\nLD X0.0\nOUT R1.0\nLD R1.0\nOUT Y0.0\nLDI R1.0\nOUT R1.0\nEND2";
    let mut plc = Plc::new(Arc::new(Ladder::compile(source).unwrap()));
    // The coil is forced: instructions after its OUT read the forced value.
    plc.force(bit("R1.0"), Some(true));
    plc.run_slot();
    assert!(plc.memory().bit(bit("Y0.0")) && plc.memory().bit(bit("R1.0")));
    plc.force(bit("R1.0"), None);
    plc.run_slot();
    assert!(!plc.memory().bit(bit("Y0.0")));
    // A forced input does not follow the machine.
    plc.force(bit("X0.0"), Some(true));
    plc.memory_mut().set_x(0, 0);
    plc.run_slot();
    assert!(plc.memory().bit(bit("Y0.0")));
    plc.force(bit("Y0.0"), Some(false));
    plc.run_slot();
    assert!(!plc.memory().bit(bit("Y0.0")));
    assert_eq!(plc.forces().len(), 2);
    plc.power_on();
    assert!(plc.forces().is_empty());
    // Bits that do not exist.
    plc.force(bit("R1.0"), Some(true));
    plc.force(BitAddress::new(Area::D, 0, 0), Some(true));
    plc.force(BitAddress::new(Area::X, 99, 0), Some(true));
    assert_eq!(plc.forces().len(), 1);
}

#[test]
fn steps_follow_jumps_and_treat_calls_as_one_step() {
    let source = "LD R0.0\nOUT R1.0\nEND1
        LD R0.0\nCALL P1\nOUT R1.1
        LDI R0.0\nJMPB L1
        LD R0.0\nOUT R1.2
        LBL L1
        END2
        SP P1\nLDI R9.0\nSET R1.7\nLDI R9.0\nSET R1.6\nSPE";
    let mut plc = Plc::new(Arc::new(Ladder::compile(source).unwrap()));
    let visited = |plc: &mut Plc| {
        let mut rungs = Vec::new();
        loop {
            rungs.push(plc.next_rung().unwrap());
            plc.step_rung();
            if !plc.is_within_slot() {
                return rungs;
            }
        }
    };
    assert_eq!(
        visited(&mut plc),
        [1, 3, 4, 6],
        "the jump leaves rung 5 out"
    );
    assert_eq!(plc.memory().r(1), 0);
    plc.memory_mut().set_r(0, 1);
    assert_eq!(visited(&mut plc), [1, 3, 4, 5, 6]);
    assert_eq!(plc.memory().r(1), 0b1100_0111, "the subprogram is one step");
    // The next whole slot completes a slot started in steps.
    plc.step_rung();
    assert!(plc.is_within_slot());
    plc.run_slot();
    assert_eq!(plc.next_rung(), Some(1));
}

#[test]
fn source_with_rung_replaces_only_its_lines() {
    let source = "; head\nEND1\nLD R0.0\nOUT R1.0 ; old\n; between\nLD R0.1\nOUT R1.1\nEND2\n";
    let ladder = Ladder::compile(source).unwrap();
    assert_eq!(
        ladder.source_with_rung(2, "LDI R0.5\nSET R2.0\n"),
        "; head\nEND1\nLDI R0.5\nSET R2.0\n; between\nLD R0.1\nOUT R1.1\nEND2\n"
    );
    assert_eq!(
        ladder.source_with_rung(3, ""),
        "; head\nEND1\nLD R0.0\nOUT R1.0 ; old\n; between\nEND2\n"
    );
    assert_eq!(ladder.source_with_rung(99, "LD R0.0"), source);
}

/// Returns the number of rungs that only the example has and that only the standard ladder
/// has.
fn differences(example: &str) -> (usize, usize) {
    let rungs = |source: &str| -> Vec<Vec<String>> {
        let ladder = Ladder::compile(source).unwrap();
        assert_eq!(ladder.warnings(), []);
        let rungs = ladder.rungs();
        rungs
            .map(|rung| rung.statements.iter().map(ToString::to_string).collect())
            .collect()
    };
    let (own, standard) = (rungs(example), rungs(STANDARD));
    let missing = |of: &[Vec<String>], from: &[Vec<String>]| {
        of.iter().filter(|rung| !from.contains(rung)).count()
    };
    (missing(&own, &standard), missing(&standard, &own))
}

#[test]
fn example_ladders_differ_from_standard_in_expected_rungs() {
    let two_hands = include_str!("../../assets/ladder/two-hand-start.il");
    let bar_feeder = include_str!("../../assets/ladder/bar-feeder.il");
    assert_eq!(differences(two_hands), (3, 1));
    assert_eq!(differences(bar_feeder), (14, 4));
    let coded_turret = include_str!("../../assets/ladder/coded-turret.il");
    assert_eq!(differences(coded_turret), (7, 9));
    let dnc_teach = include_str!("../../assets/ladder/dnc-teach.il");
    assert_eq!(differences(dnc_teach), (12, 6));
}
