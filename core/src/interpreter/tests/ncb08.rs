//! The NC-B08: codes with another meaning there, and codes that only it has.

use super::InterpreterBench;
use crate::model::{ControlModel, ModelId};
use crate::units::PerAxis;

fn bench() -> InterpreterBench {
    InterpreterBench::at(10.0, 20.0).of_model(ModelId::Ncb08)
}

fn trace(text: &str) -> Vec<String> {
    trace_bench(bench(), text)
}

/// Runs a program and returns its commands as short texts, without line numbers and stops of
/// single block.
fn trace_bench(mut bench: InterpreterBench, text: &str) -> Vec<String> {
    let lines = bench.trace(text);
    let strip_line_number = |line: &String| {
        let after = line.split_once(": ").map_or("", |(_, after)| after);
        after.trim_end_matches(" |").to_owned()
    };
    lines.iter().map(strip_line_number).collect()
}

/// C46: I and K lead from the start to the centre, I as a radius, and give a full circle of
/// radius 8.
#[test]
fn a_full_circle_has_its_centre_by_i_and_k() {
    assert_eq!(
        trace("G02 X10 Z20 I3.873 K-7 F100;\nM2;"),
        [
            "cw X10 Z20 about X17.746 Z13 F100",
            "end counts true m30 true"
        ]
    );
}

/// C47: a full circle by R raises E433, because R does not define its centre.
#[test]
fn a_full_circle_by_r_is_e433() {
    for text in ["G02 X10 Z20 R8 F100;", "G02 R8 F100;", "G03 R-8 F100;"] {
        assert_eq!(bench().run_to_alarm(text), (433, 1), "{text}");
    }
}

#[test]
fn a_negative_radius_is_the_longer_arc() {
    // From X10 Z20 to X10 Z14: the chord is 6, the radius 5: centres 4 beside it.
    let near = trace("G02 X10 Z14 R5 F100;\nM2;");
    let far = trace("G02 X10 Z14 R-5 F100;\nM2;");
    assert_eq!(near[0], "cw X10 Z14 about X18 Z17 F100");
    assert_eq!(far[0], "cw X10 Z14 about X2 Z17 F100");
    let other = trace("G03 X10 Z14 R-5 F100;\nM2;");
    assert_eq!(other[0], "ccw X10 Z14 about X18 Z17 F100");
}

/// C48: in G04 the control reads X (seconds) before P (milliseconds).
#[test]
fn a_dwell_in_seconds_comes_first() {
    let lines = trace("G04 X2;\nG04 P1000;\nG04 X1 P5000;\nM2;");
    assert_eq!(
        lines,
        [
            "dwell 2000",
            "dwell 1000",
            "dwell 1000",
            "end counts true m30 true"
        ]
    );
}

/// C49: M10, M11 and other M codes switch outputs without the PLC.
#[test]
fn outputs_are_switched_by_the_program() {
    for (block, expected) in [
        ("M10 P3 D500", "outputs on 1000 off 0 500ms"),
        ("M10 P15", "outputs on 1000000000000000 off 0 0ms"),
        ("M11 P3", "outputs on 0 off 1000 0ms"),
        ("M21", "outputs on 10000 off 0 0ms"),
        ("M22", "outputs on 0 off 10000 0ms"),
        ("M40", "outputs on 1000 off 1000000 0ms"),
        ("M81", "outputs on 10000000000 off 100000000000 0ms"),
    ] {
        assert_eq!(trace(&format!("{block};\nM2;"))[0], expected, "{block}");
    }
    for wrong in ["M10", "M10 P16", "M10 P-1", "M11 P99"] {
        assert_eq!(
            bench().run_to_alarm(&format!("{wrong};")),
            (43, 1),
            "{wrong}"
        );
    }
}

#[test]
fn the_time_of_the_clamp_is_a_parameter() {
    let mut bench = bench();
    let mut model = ControlModel::new(ModelId::Ncb08);
    model.set_parameter(41, 800).unwrap();
    bench.interpreter.set_model(&model);
    assert_eq!(
        trace_bench(bench, "M21;\nM2;")[0],
        "outputs on 10000 off 0 800ms"
    );
}

#[test]
fn the_spindle_has_its_output_and_its_ladder() {
    assert_eq!(
        trace("M03;\nM2;"),
        [
            "outputs on 1000000000000 off 110000000000000 0ms",
            "M03",
            "end counts true m30 true"
        ]
    );
}

#[test]
fn a_program_waits_for_an_input() {
    assert_eq!(trace("M01 H8;\nM2;")[0], "wait for X8 true");
    assert_eq!(trace("M01 L0;\nM2;")[0], "wait for X0 false");
    for wrong in ["M01", "M01 H24", "M01 L24", "M01 H1 L2"] {
        assert_eq!(
            bench().run_to_alarm(&format!("{wrong};")),
            (43, 1),
            "{wrong}"
        );
    }
}

#[test]
fn the_reference_point_is_that_of_its_parameters() {
    let mut model = ControlModel::new(ModelId::Ncb08);
    model.set_parameter(108, 200_000).unwrap();
    model.set_parameter(109, 150_500).unwrap();
    let bench_with_reference = || {
        let mut bench = bench();
        bench.interpreter.set_model(&model);
        bench
    };
    let direct = trace_bench(bench_with_reference(), "G27;\nM2;");
    assert_eq!(direct[0], "rapid X200 Z150.5");
    let through = trace_bench(bench_with_reference(), "G28 X50 Z60;\nM2;");
    assert_eq!(through[..2], ["rapid X50 Z60", "rapid X200 Z150.5"]);
    assert_eq!(bench_with_reference().run_to_alarm("G27 X0;"), (12, 1));
    let mut unreferenced = bench_with_reference();
    unreferenced.referenced = PerAxis::new(true, false);
    assert_eq!(unreferenced.run_to_alarm("G27;"), (90, 1));
    let mut unreferenced = bench_with_reference();
    unreferenced.referenced = PerAxis::new(false, true);
    assert_eq!(unreferenced.run_to_alarm("G28 X50;"), (90, 1));
}

#[test]
fn missing_codes_raise_alarm_010() {
    for code in ["G40", "G41", "G20", "G54", "G09", "G91"] {
        assert_eq!(bench().run_to_alarm(&format!("{code};")), (10, 1), "{code}");
    }
    assert_eq!(bench().run_to_alarm("M12;"), (19, 1));
    // The GSK980TD does not have the codes of other models.
    assert_eq!(InterpreterBench::new().run_to_alarm("G27;"), (10, 1));
    assert_eq!(InterpreterBench::new().run_to_alarm("M21;"), (19, 1));
    assert_eq!(InterpreterBench::new().run_to_alarm("M10 P3 D500;"), (9, 1));
}
