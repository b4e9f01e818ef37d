//! Tests of the three types of offset memory and of G10 (001:5-31).

use super::*;
use crate::MillOffsetMemory;

fn setup(memory: MillOffsetMemory) -> MillSetup {
    let mut setup = MillSetup::default();
    setup.memory.offset_memory = memory;
    setup
}

/// Heights to which Z moves, and number of the alarm.
fn heights(memory: MillOffsetMemory, text: &str) -> (Vec<f64>, Option<u16>) {
    let (preview, moves) = run_program(&setup(memory), text, &[]);
    let heights = moves.iter().map(|made| made.to.mm()[2]).collect();
    (heights, preview.alarm.map(|alarm| alarm.number))
}

#[test]
fn memory_a_has_one_value_for_length_and_radius() {
    let a = MillOffsetMemory::A;
    // H3 and D3 are the same value; G91 adds to it.
    let text = "G10 P3 R5\nG91 G10 P3 R1\nG90 G01 G43 H3 Z10 F500\n#1=#10003\nG01 Z#1\nM30\n";
    let (moves, alarm) = heights(a, text);
    assert_eq!(alarm, None);
    assert_eq!(moves, [10.0, 6.0]);
    let mut memory = setup(a).memory;
    assert_eq!(memory.take_offset("3=6"), Ok(()));
    assert!((memory.cutter_radius(3) - 6.0).abs() < 1e-9);
    assert!(memory.take_offset("3=6,1").is_err());
    for text in ["G10 L10 P3 R5\nM30\n", "G10 L12 P3 R5\nM30\n"] {
        assert_eq!(heights(a, text).1, Some(43), "{text}");
    }
}

#[test]
fn each_memory_has_the_variables_of_its_table() {
    let a = MillOffsetMemory::A;
    let text =
        "G10 P201 R7\n#2001=3\nG01 Z#10001 F500\nZ#2201\nZ0\nZ#10201\n#2400=6\nZ#10400\nM30\n";
    assert_eq!(heights(a, text), (vec![3.0, 7.0, 0.0, 7.0, 6.0], None));
    let b = MillOffsetMemory::B;
    let text = "#2003=1\n#2203=5\nG01 Z#10003 F500\nZ#11003\nM30\n";
    assert_eq!(heights(b, text), (vec![1.0, 5.0], None));
    for (memory, number) in [
        (a, 11_003),
        (a, 12_003),
        (a, 13_003),
        (b, 12_003),
        (b, 13_003),
    ] {
        let text = format!("G01 Z#{number} F500\nM30\n");
        assert!(heights(memory, &text).1.is_some(), "{memory:?} #{number}");
    }
}

#[test]
fn memory_b_has_a_value_and_its_wear() {
    let b = MillOffsetMemory::B;
    let text = "G10 L10 P3 R5\nG10 L11 P3 R-0.5\nG90 G01 G43 H3 Z10 F500\nG01 Z#11003\n\
                G01 Z#10003\nM30\n";
    let (moves, alarm) = heights(b, text);
    assert_eq!(alarm, None);
    assert_eq!(moves, [10.0, 5.0, -0.5]);
    let mut memory = setup(b).memory;
    assert_eq!(memory.take_offset("3=6,-0.02"), Ok(()));
    assert!((memory.cutter_radius(3) - 5.98).abs() < 1e-9);
    for text in [
        "G10 P3 R5\nM30\n",
        "G10 L12 P3 R5\nM30\n",
        "G10 L13 P3 R5\nM30\n",
    ] {
        assert_eq!(heights(b, text).1, Some(43), "{text}");
    }
}

#[test]
fn memory_c_stays_as_delivered() {
    let text = "G10 L12 P3 R5\nG91 G10 L12 P3 R-0.02\nG90 G10 L13 P3 R-0.03\n\
                G01 Z#13003 F500\nG01 Z#11003\nM30\n";
    let (moves, alarm) = heights(MillOffsetMemory::C, text);
    assert_eq!((moves, alarm), (vec![4.98, 0.0], None));
    assert_eq!(heights(MillOffsetMemory::C, "G10 P3 R5\nM30\n").1, Some(43));
}
