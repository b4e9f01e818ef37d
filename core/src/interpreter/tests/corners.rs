//! Chamfers and corner arcs of G01.

use super::InterpreterBench;

#[test]
fn chamfers() {
    let trace = InterpreterBench::at(20.0, 0.0).trace("G01 Z-20 I5 F100;\nX50 K-3;\nW-10;\n");
    assert_eq!(
        trace[..5],
        [
            "1: line X20 Z-15 F100",
            "1: line X30 Z-20 F100 |",
            "2: line X44 Z-20 F100",
            "2: line X50 Z-23 F100 |",
            // From the corner Z-20.
            "3: line X50 Z-30 F100 |",
        ]
    );
}

#[test]
fn corner_arcs_in_every_direction() {
    for (first, second, expected) in [
        ("Z-20 R5", "X60", ["X40 Z-15", "cw X50 Z-20 about X50 Z-15"]),
        (
            "Z-20 R-5",
            "X20",
            ["X40 Z-15", "ccw X30 Z-20 about X30 Z-15"],
        ),
        ("Z20 R5", "X60", ["X40 Z15", "ccw X50 Z20 about X50 Z15"]),
        ("Z20 R-5", "X20", ["X40 Z15", "cw X30 Z20 about X30 Z15"]),
        ("X60 R-5", "Z-20", ["X50 Z0", "ccw X60 Z-5 about X50 Z-5"]),
        ("X60 R5", "Z20", ["X50 Z0", "cw X60 Z5 about X50 Z5"]),
        ("X20 R-5", "Z-20", ["X30 Z0", "cw X20 Z-5 about X30 Z-5"]),
        ("X20 R5", "Z20", ["X30 Z0", "ccw X20 Z5 about X30 Z5"]),
    ] {
        let trace = InterpreterBench::at(40.0, 0.0).trace(&format!("G01 {first} F50;\n{second};"));
        assert_eq!(trace[0], format!("1: line {} F50", expected[0]), "{first}");
        assert_eq!(trace[1], format!("1: {} F50 |", expected[1]), "{first}");
    }
}

#[test]
fn a_thread_may_follow_a_chamfer_only() {
    let trace = InterpreterBench::at(20.0, 0.0).trace("G01 X30 K-2 F100;\nG32 W-30 F2;");
    assert_eq!(trace[1], "1: line X30 Z-2 F100 |");
    assert_eq!(trace[2], "2: thread X30 Z-30 Z lead 2 at 0 |");
    assert_eq!(
        InterpreterBench::at(20.0, 0.0).run_to_alarm("G01 X30 R-2 F100;\nG32 W-30 F2;"),
        (13, 1)
    );
}

#[test]
fn a_corner_can_take_up_both_moves() {
    let trace = InterpreterBench::at(20.0, 0.0).trace("G01 Z-5 I5 F100;\nX30;");
    assert_eq!(
        trace[..2],
        ["1: line X30 Z-5 F100 |", "2: line X30 Z-5 F100 |"]
    );
}

#[test]
fn wrong_corners_raise_alarms() {
    for text in [
        "G01 Z-20 I5 F100;",
        "G01 Z-20 I5 F100;\nG00 X50;",
        "G01 Z-20 I5 F100;\nX50 Z-30;",
        "G01 Z-20 I5 F100;\nZ-50;",
        "G01 Z-20 I5 F100;\nM08;",
        "G01 Z-20 I5 F100;\nG02 X50 R20;",
        "G01 Z-20 I5 F100;\nX29.999;",
        "G01 Z-20 I-5 F100;\nX50;",
        "G01 Z-20 K5 F100;\nX50;",
        "G01 X40 I5 F100;\nZ-50;",
        "G01 Z-4.999 I5 F100;\nX50;",
        "G01 Z-20 I5 R5 F100;\nX50;",
        "G01 X40 Z-20 R5 F100;\nX50;",
        "G01 Z-20 I5 F100;\nX50 Y9;",
    ] {
        assert_eq!(
            InterpreterBench::at(20.0, 0.0).run_to_alarm(text),
            (13, 1),
            "{text}"
        );
    }
    // Words of 0 command no corner.
    let trace = InterpreterBench::at(20.0, 0.0).trace("G01 X30 Z-20 I0 K0 R0 F100;");
    assert_eq!(trace[0], "1: line X30 Z-20 F100 |");
}

#[test]
fn keyed_in_blocks_have_no_corner() {
    let mut bench = InterpreterBench::at(20.0, 0.0);
    let program = crate::program::Program::new("G01 Z-20 I5 F100;");
    let (interpreter, world) = bench.split_for_run();
    interpreter.start_mdi(program, &world);
    assert_eq!(bench.run_to_end().1.map(|alarm| alarm.number), Some(13));
}
