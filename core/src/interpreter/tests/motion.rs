//! G00 to G04, G28, G50.

use super::InterpreterBench;

#[test]
fn increments_and_absolutes_mix() {
    let mut bench = InterpreterBench::at(30.0, 100.0);
    bench.trace("U40 W-60;");
    assert_eq!(bench.displayed_position(), (70.0, 40.0));
    for text in ["U200 W-400;", "X400 W-400;", "U200 Z50;", "X400.0 Z50.0;"] {
        let mut bench = InterpreterBench::at(200.0, 450.0);
        bench.trace(text);
        assert_eq!(bench.displayed_position(), (400.0, 50.0), "{text}");
    }
}

#[test]
fn absolute_wins_over_increment() {
    let mut bench = InterpreterBench::at(10.0, 10.0);
    bench.trace("G00 X20 U5 Z3 W7;");
    assert_eq!(bench.displayed_position(), (20.0, 3.0));
}

#[test]
fn a_chain_of_increments_does_not_drift() {
    let mut bench = InterpreterBench::at(0.0, 0.0);
    let text = "U0.001 W-0.1;\n".repeat(9000);
    bench.trace(&text);
    assert_eq!(bench.displayed_position(), (9.0, -900.0));
    assert_eq!((bench.machine.x, bench.machine.z), (4.5, -900.0));
}

#[test]
fn radius_programming() {
    let mut bench = InterpreterBench::at(0.0, 0.0).with_bit(1, 2, true);
    bench.trace("G00 X20; U-5;");
    assert_eq!(bench.displayed_position(), (30.0, 0.0));
}

#[test]
fn the_feed_is_modal_and_needed() {
    let trace = InterpreterBench::at(0.0, 0.0)
        .trace("G00 X10 F120;\nG01 Z-5;\nG99 Z-6 F0.2;\nG98 F80 X20;\n");
    assert_eq!(
        trace,
        [
            "1: rapid X10 Z0 |",
            "2: line X10 Z-5 F120 |",
            "3: line X10 Z-6 F0.2/r |",
            "4: line X20 Z-6 F80 |",
            "4: end counts false m30 false",
        ]
    );
    assert_eq!(
        InterpreterBench::new().run_to_alarm("G00 X10;\nG01 Z-5;\n"),
        (11, 2)
    );
    assert_eq!(
        InterpreterBench::new().run_to_alarm("G01 Z-5 F0;\n"),
        (11, 1)
    );
}

#[test]
fn arcs_by_radius() {
    let trace = InterpreterBench::at(0.0, 0.0).trace("G03 U24 W-24 R15 F100;\nG02 X26 Z-31 R5;\n");
    assert_eq!(trace[0], "1: ccw X24 Z-24 about X0 Z-15 F100 |");
    assert_eq!(trace[1], "2: cw X26 Z-31 about X32 Z-27 F100 |");
}

#[test]
fn arcs_by_centre() {
    let trace =
        InterpreterBench::at(0.0, 0.0).trace("G03 X24 Z-24 K-15 F100;\nG02 X26 Z-31 I4 K-3;\n");
    assert_eq!(trace[0], "1: ccw X24 Z-24 about X0 Z-15 F100 |");
    assert_eq!(trace[1], "2: cw X26 Z-31 about X32 Z-27 F100 |");
    // R overrides I and K.
    let trace = InterpreterBench::at(0.0, 0.0).trace("G03 X24 Z-24 R15 I99 K99 F100;");
    assert_eq!(trace[0], "1: ccw X24 Z-24 about X0 Z-15 F100 |");
}

#[test]
fn full_circles_need_a_centre() {
    let trace = InterpreterBench::at(20.0, 0.0)
        .trace("G02 I-10 F50;\nG02 X20 Z0 I-10;\nG02 R10;\nG02 X20 R10;");
    assert_eq!(
        trace[..4],
        [
            "1: cw X20 Z0 about X0 Z0 F50 |",
            "2: cw X20 Z0 about X0 Z0 F50 |",
            "3: nothing |",
            "4: nothing |",
        ]
    );
}

#[test]
fn an_arc_may_exceed_half_a_turn_by_centre_only() {
    // A quarter circle the long way round: only I and K can command it.
    let trace = InterpreterBench::at(20.0, 0.0).trace("G02 X0 Z-10 I-10 F50;");
    assert_eq!(trace[0], "1: cw X0 Z-10 about X0 Z0 F50 |");
}

#[test]
fn a_centre_off_the_arc_is_moved() {
    // Start (0,0), end (0,-20), programmed centre 1 mm off the middle. The radius sqrt(101)
    // stays, so the centre moves to the nearer side.
    let trace = InterpreterBench::at(0.0, 0.0).trace("G02 X0 Z-20 I1 K-10 F50;");
    assert_eq!(trace[0], "1: cw X0 Z-20 about X2 Z-10 F50 |");
    let trace = InterpreterBench::at(0.0, 0.0).trace("G02 X0 Z-18 I0 K-10 F50;");
    assert_eq!(trace[0], "1: cw X0 Z-18 about X8.717798 Z-9 F50 |");
    // An error of 0.002 mm leaves the centre as programmed.
    let trace = InterpreterBench::at(0.0, 0.0).trace("G02 X0 Z-20.002 K-10 F50;");
    assert_eq!(trace[0], "1: cw X0 Z-20.002 about X0 Z-10 F50 |");
}

#[test]
fn wrong_arcs_raise_alarms() {
    for (text, number) in [
        ("G02 X310 F50;", 13),
        ("G02 X340 Z300 R9.999 F50;", 13),
        ("G03 X400 Z100 I1 K1 F50;", 13),
        ("G03 X310 I0 K0 F50;", 13),
        ("G02 X310 R-10 F50;", 23),
        ("G02 X310 R10;", 11),
        ("G02 U9999 W9999 R9999 F1;", 43),
    ] {
        assert_eq!(
            InterpreterBench::new().run_to_alarm(text),
            (number, 1),
            "{text}"
        );
    }
    // Exactly half a turn.
    let trace = InterpreterBench::new().trace("G02 X340 Z300 R10 F50;");
    assert_eq!(trace[0], "1: cw X340 Z300 about X320 Z300 F50 |");
}

#[test]
fn an_arc_word_without_axes_sets_the_mode_only() {
    let trace = InterpreterBench::at(0.0, 0.0).trace("G03 F100;\nX20 Z-10 R10;");
    assert_eq!(
        trace[..2],
        ["1: nothing |", "2: ccw X20 Z-10 about X0 Z-10 F100 |"]
    );
}

#[test]
fn dwell_times() {
    let trace = InterpreterBench::new()
        .trace("G04 P1500;\nG04 X1.5;\nG04 U1.5;\nG04 P200 X9;\nG04 X1 U2;\nG04;");
    let times: Vec<_> = trace
        .iter()
        .filter_map(|line| line.split("dwell ").nth(1))
        .collect();
    assert_eq!(
        times,
        ["1500 |", "1500 |", "1500 |", "200 |", "1000 |", "0 |"]
    );
    for text in ["G04 X-1;", "G04 U-0.001;", "G04 P-500;", "G04 P500 X-1;"] {
        assert_eq!(
            InterpreterBench::new().run_to_alarm(text),
            (43, 1),
            "{text}"
        );
    }
}

#[test]
fn dwell_moves_nothing_and_keeps_the_mode() {
    let mut bench = InterpreterBench::at(10.0, 0.0);
    bench.trace("G01 F100 Z-1;\nG04 X2 U3;\nZ-2;");
    assert_eq!(bench.displayed_position(), (10.0, -2.0));
}

#[test]
fn coordinates_by_value_and_by_difference() {
    let mut bench = InterpreterBench::at(300.0, 300.0);
    let trace = bench.trace("G50 X100.0 Z150.0;\nG00 X90 W-10;\nG50 U10 W-40;");
    assert_eq!(
        trace[..3],
        [
            "1: frame X200 Z150 offset X0 Z0 program zero relative |",
            "2: rapid X290 Z290 |",
            "3: frame X190 Z190 offset X0 Z0 program zero relative |",
        ]
    );
    assert_eq!(bench.displayed_position(), (100.0, 100.0));
    assert_eq!(InterpreterBench::new().run_to_alarm("G50;"), (14, 1));
    assert_eq!(InterpreterBench::new().run_to_alarm("G50 F100;"), (14, 1));
}

#[test]
fn reference_return_goes_through_the_intermediate_point() {
    let trace = InterpreterBench::at(50.0, -30.0).trace("G28 X60 W10;\nG28;\nG28 U0;");
    assert_eq!(
        trace[..7],
        [
            "1: rapid X60 Z-20 |",
            "1: rapid X0 Z0",
            "1: referenced true true |",
            "2: nothing |",
            "3: rapid X0 Z0 |",
            "3: rapid X0 Z0",
            "3: referenced true false |",
        ]
    );
}

#[test]
fn reference_return_of_one_axis_leaves_the_other() {
    let mut bench = InterpreterBench::at(50.0, -30.0);
    bench.trace("G28 W0;");
    assert_eq!((bench.machine.x, bench.machine.z), (25.0, 0.0));
    assert_eq!(bench.displayed_position(), (50.0, 0.0));
}

#[test]
fn reference_return_cancels_the_offset_and_may_set_coordinates() {
    let mut bench = InterpreterBench::at(50.0, -30.0);
    let trace = bench.trace("G00 X40 T0101;\nG28 U0 W0;");
    assert_eq!(
        trace.last().map(String::as_str),
        Some("2: end counts false m30 false")
    );
    assert_eq!(trace[trace.len() - 2], "2: frame X0 Z0 offset X0 Z0 |");
    assert_eq!(bench.interpreter.modal().offset, 0);
    assert_eq!(bench.displayed_position(), (0.0, 0.0));

    let mut bench = InterpreterBench::at(50.0, -30.0).with_bit(12, 7, true);
    bench.parameters.set(49, 120_000).unwrap();
    bench.parameters.set(50, 200_000).unwrap();
    bench.trace("G28 U0 W0;");
    assert_eq!(bench.displayed_position(), (120.0, 200.0));
}

#[test]
fn an_axis_without_a_reference_seeks_it_from_the_intermediate_point() {
    let mut bench = InterpreterBench::at(50.0, -30.0);
    bench.referenced.z = false;
    assert_eq!(
        bench.trace("G28 U10 W5;")[..3],
        [
            "1: rapid X60 Z-25 |",
            "1: rapid X0 Z-25",
            "1: zero return true true |",
        ]
    );
}

#[test]
fn an_axis_without_a_zero_switch_needs_its_zero_set_by_hand() {
    let mut bench = InterpreterBench::new().with_bit(14, 1, false);
    bench.referenced.z = false;
    assert_eq!(bench.run_to_alarm("G28 U0;\nG28 W0;"), (93, 2));
}

#[test]
fn end_points_stay_within_the_stroke() {
    assert_eq!(
        InterpreterBench::new().run_to_alarm("U9000;\nU9000;"),
        (43, 2)
    );
    let mut bench = InterpreterBench::new();
    bench.trace("X9999.999 Z-9999.999;");
    assert_eq!(bench.displayed_position(), (9999.999, -9999.999));
}

#[test]
fn the_stroke_of_x_is_a_radius_under_radius_programming() {
    let mut bench = InterpreterBench::at(0.0, 0.0).with_bit(1, 2, true);
    bench.trace("X9999.999;");
    assert_eq!(bench.machine.x, 9999.999);
    assert_eq!(bench.run_to_alarm("U0.001;"), (43, 1));
}

#[test]
fn one_feed_register_is_read_in_the_unit_in_force() {
    let mut bench = InterpreterBench::at(0.0, 0.0);
    bench.trace("G99 G01 X10 F1;");
    bench.trace("G98 X20;");
    assert_eq!(bench.interpreter.modal().feed, 10_000.0);
    bench.trace("G99 X30;");
    assert_eq!(bench.interpreter.modal().feed, 1.0);
    bench.trace("G98 F200 X40;");
    assert_eq!(bench.interpreter.modal().feed, 200.0);
}
