//! Every program under G41 and G42 ends or raises an alarm.

use std::fmt::Write;

use proptest::prelude::*;

use super::cases::run_with_nose;
use crate::memory::ToolOffset;
use crate::units::Point;

const WORDS: [&str; 22] = [
    "G40", "G41", "G42", "G00", "G01", "G02", "G03", "G04 P5", "G50", "G28", "G90", "G94", "M08",
    "M00", "T0101", "T0102", "T0100", "S500", "G32 F1", "", "G75", "M30",
];

fn blocks() -> impl Strategy<Value = Vec<(usize, usize, i32, i32, i32)>> {
    let size = -20_000_i32..20_000;
    prop::collection::vec(
        (0..WORDS.len(), 0_usize..9, size.clone(), size, 0_i32..9_000),
        1..30,
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_program_ends(blocks in blocks(), r in -2_000_i32..2_000, t in 0_u8..10) {
        let mut text = String::from("T0101 F100\nG42\n");
        for (word, kind, x, z, arc) in blocks {
            let mm = |value: i32| f64::from(value) / 1000.0;
            write!(text, "{} ", WORDS[word]).unwrap();
            match kind {
                0 | 1 => write!(text, "X{:.3}", mm(x)).unwrap(),
                2 => write!(text, "W{:.3}", mm(z)).unwrap(),
                3 | 4 => write!(text, "U{:.3} W{:.3}", mm(x), mm(z)).unwrap(),
                5 => write!(text, "U{:.3} W{:.3} R{:.3}", mm(x), mm(z), mm(arc)).unwrap(),
                6 => write!(text, "U{:.3} W{:.3} I{:.3}", mm(x), mm(z), mm(arc)).unwrap(),
                _ => {}
            }
            text.push('\n');
        }
        let nose = ToolOffset { r: f64::from(r) / 1000.0, t, ..ToolOffset::default() };
        let (moves, _) = run_with_nose(&text, nose, Point::new(20.0, 10.0));
        for made in moves {
            prop_assert!(made.to.length().is_finite() && made.to.length() < 1e5, "{}", text);
        }
    }
}
