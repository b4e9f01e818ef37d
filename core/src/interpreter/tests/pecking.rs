//! G74 and G75.

use super::InterpreterBench;

fn count(trace: &[String], kind: &str) -> usize {
    trace.iter().filter(|line| line.contains(kind)).count()
}

#[test]
fn the_first_block_writes_the_retract() {
    for code in ["G74", "G75"] {
        let mut bench = InterpreterBench::at(40.0, 5.0);
        let trace = bench.trace(&format!("{code} R1;"));
        assert_eq!(trace[0], "1: nothing |");
        assert_eq!(bench.parameters.value(56), 1000);
        assert_eq!(
            InterpreterBench::new().run_to_alarm(&format!("{code} R-1;")),
            (62, 1)
        );
    }
}

#[test]
fn the_face_groove_of_the_manual() {
    for (z, pecks) in [("-60", 33), ("60", 28)] {
        let text = format!("G74 R1;\nG74 X20 Z{z} P2000 Q2000 F50;");
        let trace = InterpreterBench::at(40.0, 5.0).trace(&text);
        assert_eq!(count(&trace, "line"), 11 * pecks, "{z}");
    }
    let trace = InterpreterBench::at(40.0, 5.0).trace("G74 R1;\nG74 X20 Z-60 P2000 Q2000 F50;");
    assert_eq!(
        trace[1..5],
        [
            "2: line X40 Z3 F50 |",
            "2: rapid X40 Z4 |",
            "2: line X40 Z1 F50 |",
            "2: rapid X40 Z2 |",
        ]
    );
    // 33 pecks with 32 retracts, then out of the groove and to the next column.
    assert_eq!(
        trace[64..70],
        [
            "2: rapid X40 Z-58 |",
            "2: line X40 Z-60 F50 |",
            "2: rapid X40 Z5 |",
            "2: rapid X38 Z5 |",
            "2: line X38 Z3 F50 |",
            "2: rapid X38 Z4 |",
        ]
    );
    assert_eq!(
        trace[trace.len() - 4..],
        [
            "2: line X20 Z-60 F50 |",
            "2: rapid X20 Z5 |",
            "2: rapid X40 Z5 |",
            "2: end counts false m30 false",
        ]
    );
}

#[test]
fn the_groove_of_the_manual() {
    let trace = InterpreterBench::at(125.0, -20.0).trace("G75 R1;\nG75 X40 Z-50 P2000 Q2000 F50;");
    assert_eq!(count(&trace, "line"), 16 * 43);
    assert_eq!(
        trace[1..4],
        [
            "2: line X123 Z-20 F50 |",
            // R(e) is a radius.
            "2: rapid X125 Z-20 |",
            "2: line X121 Z-20 F50 |",
        ]
    );
    assert!(trace.contains(&"2: rapid X125 Z-22 |".to_string()));
    assert_eq!(trace[trace.len() - 2], "2: rapid X125 Z-20 |");
}

#[test]
fn the_relief_and_the_last_column() {
    // Columns at X40, 37 and 35; a relief of 0.8 against the direction of the columns.
    let trace = InterpreterBench::at(40.0, 0.0).trace("G74 X35 Z-5 P3000 Q3000 R0.8 F50;");
    assert_eq!(
        trace[..16],
        [
            "1: line X40 Z-3 F50 |",
            "1: line X40 Z-5 F50 |",
            "1: rapid X40.8 Z-5 |",
            "1: rapid X40.8 Z0 |",
            "1: rapid X37 Z0 |",
            "1: line X37 Z-3 F50 |",
            "1: line X37 Z-5 F50 |",
            "1: rapid X37.8 Z-5 |",
            "1: rapid X37.8 Z0 |",
            "1: rapid X35 Z0 |",
            "1: line X35 Z-3 F50 |",
            "1: line X35 Z-5 F50 |",
            "1: rapid X35.8 Z-5 |",
            "1: rapid X35.8 Z0 |",
            "1: rapid X40 Z0 |",
            "1: end counts false m30 false",
        ]
    );
}

#[test]
fn all_four_quadrants() {
    for (sx, sz) in [(1, 1), (1, -1), (-1, 1), (-1, -1)] {
        let trace = InterpreterBench::at(100.0, 0.0).trace(&format!(
            "G74 R0.5;\nG74 U{} W{} P4000 Q3000 R1 F50;",
            sx * 6,
            sz * 5
        ));
        let expected = [
            format!("2: line X100 Z{} F50 |", sz * 3),
            format!("2: rapid X100 Z{} |", f64::from(sz) * 2.5),
            format!("2: line X100 Z{} F50 |", sz * 5),
            format!("2: rapid X{} Z{} |", 100 - sx, sz * 5),
            format!("2: rapid X{} Z0 |", 100 - sx),
            format!("2: rapid X{} Z0 |", 100 + sx * 4),
        ];
        assert_eq!(trace[1..7], expected);
        let trace = InterpreterBench::at(100.0, 0.0).trace(&format!(
            "G75 R0.5;\nG75 U{} W{} P4000 Q3000 R1 F50;",
            sx * 6,
            sz * 5
        ));
        let expected = [
            format!("2: line X{} Z0 F50 |", 100 + sx * 4),
            format!("2: rapid X{} Z0 |", 100 + sx * 3),
            format!("2: line X{} Z0 F50 |", 100 + sx * 6),
            format!("2: rapid X{} Z{} |", 100 + sx * 6, -sz),
            format!("2: rapid X100 Z{} |", -sz),
            format!("2: rapid X100 Z{} |", sz * 3),
        ];
        assert_eq!(trace[1..7], expected);
    }
}

#[test]
fn a_cycle_can_have_one_column() {
    for text in [
        "G74 Z-5 Q3000 F50;",
        // Without X and P the relief is 0.
        "G74 Z-5 Q3000 R1 F50;",
        "G74 X40 Z-5 P1000 Q3000 R1 F50;",
    ] {
        let trace = InterpreterBench::at(40.0, 0.0).trace(text);
        assert_eq!(
            trace[..4],
            [
                "1: line X40 Z-3 F50 |",
                "1: line X40 Z-5 F50 |",
                "1: rapid X40 Z0 |",
                "1: end counts false m30 false",
            ],
            "{text}"
        );
    }
    let trace = InterpreterBench::at(40.0, 0.0).trace("G75 X34 P4000 F50;");
    assert_eq!(trace[1], "1: line X34 Z0 F50 |");
}

#[test]
fn wrong_data_raises_alarms() {
    for (text, number) in [
        ("G74 X20 Z-5 P2000 F50;", 62),
        ("G74 X20 Z-5 P2000 Q0 F50;", 62),
        ("G74 X20 Z-5 Q2000 F50;", 62),
        ("G74 X20 Z-5 P-1 Q2000 F50;", 62),
        ("G74 X20 Z-5 P1 Q-2000 F50;", 62),
        ("G74 X20 Z-5 P1000 Q2000 R-1 F50;", 62),
        ("G74 X20 P2000 Q2000 F50;", 62),
        ("G74 P2000 Q2000 F50;", 62),
        ("G74 X20 Z-5 P2000 Q2000;", 11),
        ("G75 X20 Z-5 Q2000 F50;", 62),
        ("G75 X20 Z-5 P2000 F50;", 62),
        ("G75 Z-5 P2000 Q2000 F50;", 62),
    ] {
        assert_eq!(
            InterpreterBench::at(40.0, 0.0).run_to_alarm(text),
            (number, 1),
            "{text}"
        );
    }
}

#[test]
fn radius_programming_leaves_p_a_diameter() {
    let trace = InterpreterBench::at(40.0, 0.0)
        .with_bit(1, 2, true)
        .trace("G75 X10 P8000 F50;");
    assert_eq!(trace[0], "1: line X32 Z0 F50 |");
    assert_eq!(trace[1], "1: line X24 Z0 F50 |");
    assert_eq!(trace[2], "1: line X20 Z0 F50 |");
}
