//! Tests the listing of the standard ladder.

use std::collections::BTreeMap;

use gsk_plc::Ladder;

use crate::SOURCE;

#[test]
fn compiles_without_warnings_and_round_trips() {
    let ladder = Ladder::compile(SOURCE).unwrap();
    assert_eq!(ladder.warnings(), []);
    assert_eq!(ladder.header().remark, "980TD标准梯形图");
    assert_eq!(ladder.header().version, "2005.2.28");
    assert_eq!(ladder.part_count(), 3);
    assert_eq!(ladder.messages().len(), 11);
    let listing = ladder.to_source();
    let again = Ladder::compile(&listing).unwrap();
    assert_eq!(again.to_source(), listing);
    assert_eq!(again.steps(), ladder.steps());
    assert_eq!(again.messages(), ladder.messages());
    assert_eq!(again.comments(), ladder.comments());
    assert_eq!(again.start_values(), ladder.start_values());
    // The control, not the ladder, implements F22, the start enable.
    for function in (1..=28).filter(|function| *function != 22) {
        let title = format!(".NET \"F{function:02} ");
        assert!(SOURCE.contains(&title), "{title}");
    }
}

#[test]
fn every_external_contact_and_coil_has_a_name() {
    let ladder = Ladder::compile(SOURCE).unwrap();
    let mut unnamed = BTreeMap::new();
    for statement in ladder.statements() {
        for operand in &statement.operands {
            let gsk_plc::Operand::Bit(bit) = operand else {
                continue;
            };
            let outside = !matches!(bit.area, gsk_plc::Area::R | gsk_plc::Area::A);
            // F54, G54 and G55 have names as bytes, because their bits are alike.
            let alike = matches!(bit.byte, 54 | 55);
            let named = ladder.comment(gsk_plc::PlcAddress::Bit(*bit)).is_some();
            if outside && !alike && !named {
                unnamed.insert(*bit, statement.line);
            }
        }
    }
    assert_eq!(unnamed, BTreeMap::new());
}
