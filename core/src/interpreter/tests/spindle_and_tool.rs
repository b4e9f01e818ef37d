//! S, G96, G97, T and offsets.

use super::InterpreterBench;

#[test]
fn surface_speed_and_back() {
    let trace = InterpreterBench::at(400.0, 0.0)
        .trace("G96 S200;\nG97;\nG96;\nG50 S100;\nG97;\nG97 S800;\nG96 S50 X3000;");
    assert_eq!(
        trace[..8],
        [
            "1: Surface(200.0) |",
            "2: Speed(159.0) |",
            "3: Surface(200.0) |",
            "4: Limit(100.0) |",
            "5: Speed(100.0) |",
            "6: Speed(800.0) |",
            "7: Surface(50.0)",
            "7: rapid X3000 Z0 |",
        ]
    );
}

#[test]
fn speed_at_a_diameter() {
    let rpm = |v, x| crate::interpreter::surface_rpm(v, x, None, 0.0);
    assert!((rpm(50.0, 3000.0) - 5.305).abs() < 5e-4);
    assert!((rpm(200.0, 400.0) - 159.155).abs() < 5e-4);
    assert!((rpm(200.0, -600.0) - 106.103).abs() < 5e-4);
    assert_eq!(
        crate::interpreter::surface_rpm(50.0, 3000.0, None, 99.0),
        99.0
    );
    assert_eq!(rpm(0.0, 100.0), 0.0);
    assert!(rpm(100.0, 0.0).is_finite());
}

#[test]
fn stepped_speeds_use_two_digits() {
    let mut bench = InterpreterBench::new().with_bit(1, 4, false);
    let trace = bench.trace("S0302;\nS4;\nS300;\nS5;");
    assert_eq!(
        trace,
        [
            "1: Step(2) |",
            "2: Step(4) |",
            "3: Step(0) |",
            "alarm 002 line 4"
        ]
    );
}

#[test]
fn an_offset_alone_shifts_the_coordinates() {
    let mut bench = InterpreterBench::at(100.0, 50.0);
    let trace = bench.trace("T0101;");
    assert_eq!(
        trace[..2],
        ["1: T0101", "1: frame X0 Z0 offset X0.04 Z0.02 |"]
    );
    assert_eq!(bench.displayed_position(), (99.96, 49.98));
    bench.trace("X100 Z50;");
    assert_eq!((bench.machine.x, bench.machine.z), (50.02, 50.02));
}

#[test]
fn an_offset_alone_travels_without_003_4() {
    let mut bench = InterpreterBench::at(100.0, 50.0).with_bit(3, 4, false);
    let trace = bench.trace("G01 F50;\nT0101;\nT0100;\nG04 T0101;");
    assert_eq!(
        trace[1..9],
        [
            "2: T0101",
            "2: frame X0 Z0 offset X0.04 Z0.02",
            "2: rapid X100.04 Z50.02 |",
            "3: T0100",
            "3: frame X0 Z0 offset X0 Z0",
            "3: rapid X100 Z50 |",
            "4: T0101",
            "4: dwell 0 |",
        ]
    );
}

#[test]
fn an_offset_with_motion_merges() {
    let mut bench = InterpreterBench::at(100.0, 50.0);
    bench.trace("G00 X80 T0101;");
    // X was programmed and travels; Z only shifts.
    assert_eq!((bench.machine.x, bench.machine.z), (40.02, 50.0));
    assert_eq!(bench.displayed_position(), (80.0, 49.98));
    let mut bench = InterpreterBench::at(100.0, 50.0).with_bit(3, 4, false);
    bench.trace("G00 X80 T0101;");
    assert_eq!((bench.machine.x, bench.machine.z), (40.02, 50.02));
}

#[test]
fn cancelling_with_a_zero_increment_moves_back() {
    let mut bench = InterpreterBench::at(100.0, 50.0);
    bench.trace("G00 X80 Z40 T0101;\nT0100 U0;");
    assert_eq!(bench.machine.x, 40.0);
    assert_eq!(bench.displayed_position(), (80.0, 40.02));
}

#[test]
fn arcs_change_only_the_tool() {
    let trace = InterpreterBench::at(0.0, 0.0).trace("G02 X20 Z-10 R10 F50 T0101;");
    assert_eq!(
        trace[..2],
        ["1: T0101", "1: cw X20 Z-10 about X20 Z0 F50 |"]
    );
}

#[test]
fn coordinates_under_an_offset() {
    // After a travel the display becomes the value.
    let mut bench = InterpreterBench::at(100.0, 50.0);
    bench.trace("G00 X80 Z40 T0101;\nG50 X200 Z100;");
    assert_eq!(bench.displayed_position(), (200.0, 100.0));
    // After a shift only, the display becomes the value minus the offset.
    let mut bench = InterpreterBench::at(100.0, 50.0);
    bench.trace("T0101;\nG50 X200 Z100;");
    assert_eq!(bench.displayed_position(), (199.96, 99.98));
    // In one block the result is the same with either method.
    for method in [false, true] {
        let mut bench = InterpreterBench::at(100.0, 50.0).with_bit(3, 4, method);
        bench.trace("G50 X200 Z100 T0101;");
        assert_eq!(bench.displayed_position(), (199.96, 99.98));
        assert_eq!((bench.machine.x, bench.machine.z), (50.0, 50.0));
    }
}

#[test]
fn short_t_words_keep_the_tool() {
    let trace = InterpreterBench::new().trace("T0301;\nT02;");
    assert_eq!(
        trace[2..4],
        ["2: T0302", "2: frame X0 Z0 offset X0.06 Z0.03 |"]
    );
}

#[test]
fn tool_faults() {
    assert_eq!(InterpreterBench::new().run_to_alarm("T0501;"), (32, 1));
    assert_eq!(InterpreterBench::new().run_to_alarm("T0133;"), (30, 1));
    let mut bench = InterpreterBench::new();
    bench.parameters.set(84, 0).unwrap();
    assert_eq!(bench.trace("T0901;")[0], "1: T0901");
}

#[test]
fn an_edited_offset_waits_for_the_next_t() {
    let mut bench = InterpreterBench::at(100.0, 50.0);
    bench.trace("T0101;\nG00 X90;");
    let mut row = bench.offsets.get(1);
    row.x = 1.0;
    bench.offsets.set(1, row).unwrap();
    bench.trace("G00 X80;");
    assert_eq!(bench.machine.x, 40.02);
    bench.trace("G00 X80 T0101;");
    assert_eq!(bench.machine.x, 40.5);
}

#[test]
fn reset_drops_the_offset_only_without_004_3() {
    let mut bench = InterpreterBench::at(100.0, 50.0);
    bench.trace("T0101;");
    bench.reset();
    assert_eq!(bench.displayed_position(), (99.96, 49.98));
    let mut bench = bench.with_bit(4, 3, false);
    bench.reset();
    assert_eq!(bench.displayed_position(), (100.0, 50.0));
}

#[test]
fn numbers_of_tools_and_offsets() {
    // The default of 084 is 4; without a turret 32 tools are allowed.
    for (text, number) in [
        ("T0501;", 32),
        ("T0133;", 30),
        ("T3301;", 32),
        ("T3333;", 32),
    ] {
        assert_eq!(
            InterpreterBench::new().run_to_alarm(text),
            (number, 1),
            "{text}"
        );
    }
    for (text, number) in [("T3301;", 29), ("T9900;", 29), ("T3233;", 30)] {
        let mut bench = InterpreterBench::new();
        bench.parameters.set(84, 0).unwrap();
        assert_eq!(bench.run_to_alarm(text), (number, 1), "{text}");
    }
}
