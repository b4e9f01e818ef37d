//! G70 to G73.

use super::InterpreterBench;
use crate::command::MotionCode;

/// The G71 program of figure 3-38 of the manual: a shaft.
const SHAFT: &str = "G71 U4.0 R1.0;
G71 P080 Q120 U1 W2.0 F100 S200;
N080 G00 X40.0;
N090 G01 Z-30.0 F100 S200;
N100 X60.0 W-30.0;
N110 W-20.0;
N120 X100.0 W-10.0;
N130 G00 X220.0 Z50.0;
";

fn count(trace: &[String], start: &str) -> usize {
    trace.iter().filter(|line| line.starts_with(start)).count()
}

#[test]
fn the_shaft_of_the_manual() {
    let mut bench = InterpreterBench::at(200.0, 10.0);
    let trace = bench.trace(SHAFT);
    assert_eq!(
        [51, 52].map(|number| bench.parameters.value(number)),
        [4000, 1000]
    );
    assert_eq!(
        trace[..12],
        [
            "1: nothing |",
            "2: Speed(200.0)",
            "2: rapid X201 Z12 |",
            "2: rapid X193 Z12 |",
            "2: line X193 Z-88 F100 |",
            "2: line X195 Z-87 F100 |",
            "2: rapid X195 Z12 |",
            "2: rapid X185 Z12 |",
            "2: line X185 Z-88 F100 |",
            "2: line X187 Z-87 F100 |",
            "2: rapid X187 Z12 |",
            "2: rapid X177 Z12 |",
        ]
    );
    // 19 levels: each one cut and one escape; then the contour of four lines.
    assert_eq!(count(&trace, "2: line"), 19 * 2 + 4);
    // Level 13: X97 on the cone from (61, -78) to (101, -88).
    assert!(trace.contains(&"2: line X97 Z-87 F100 |".to_string()));
    // The last infeed reaches B' exactly: from X49 of level 19 to X41.
    let tail = &trace[trace.len() - 9..];
    assert_eq!(
        tail,
        [
            "2: rapid X51 Z12 |",
            "2: rapid X41 Z12 |",
            "2: line X41 Z-28 F100 |",
            "2: line X61 Z-58 F100 |",
            "2: line X61 Z-78 F100 |",
            "2: line X101 Z-88 F100 |",
            "2: rapid X200 Z10 |",
            "8: rapid X220 Z50 |",
            "8: end counts false m30 false",
        ]
    );
}

#[test]
fn the_last_contour_point_extends_the_levels() {
    // Level 19 of the shaft, X49, on the line (41,-28)-(61,-58): Z -40.
    let trace = InterpreterBench::at(200.0, 10.0).trace(SHAFT);
    assert!(trace.contains(&"2: line X49 Z-40 F100 |".to_string()));
    assert!(trace.contains(&"2: line X51 Z-39 F100 |".to_string()));
}

#[test]
fn the_composite_example() {
    let mut bench = InterpreterBench::at(136.0, 180.0);
    let trace = bench.trace(
        "G71 U2 R1 F200;\nG71 P60 Q150 U1 W1;\nN60 G0 X16;\nN70 G1 Z153 F100 S400;\nN80 X40;\nN100 W-63;\n\
         N110 G3 X80 W-20 R20;\nN120 G2 X120 W-20 R20;\nN130 G1 W-20;\nN140 G1 X130 W-5;\nN150 G1 W-25;\nN160 G0 X150 Z185;\n",
    );
    let cuts = count(&trace, "2: line") + count(&trace, "2: c");
    assert_eq!(cuts, 29 * 2 + 8);
    // Level 13, X85: on the concave arc about X121 Z71 (r 20):
    // z = 71 - sqrt(400 - 18²) = 62.282202.
    assert!(trace.contains(&"2: line X85 Z62.282 F200 |".to_string()));
    // Level 20, X57: on the convex arc about X41 Z71: z = 71 + sqrt(400 - 8²).
    assert!(trace.contains(&"2: line X57 Z89.33 F200 |".to_string()));
    assert!(trace.contains(&"2: ccw X81 Z71 about X41 Z71 F200 |".to_string()));
    assert!(trace.contains(&"2: cw X121 Z51 about X121 Z71 F200 |".to_string()));
}

#[test]
fn the_disc_of_the_manual() {
    let mut bench = InterpreterBench::at(176.0, 10.0);
    let trace = bench.trace(
        "G72 W7.0 R1.0;\nG72 P050 Q090 U4.0 W2.0 F100 S200;\nN050 G00 Z-55.0 S200;\nN060 G01 X160.0 F120;\n\
         N070 X80.0 W20.0;\nN080 W15.0;\nN090 X40.0 W20.0;\nN100 G0 X220.0 Z50.0;\n",
    );
    assert_eq!(bench.parameters.value(51), 7000);
    assert_eq!(count(&trace, "2: line"), 9 * 2 + 4);
    assert_eq!(
        trace[2..7],
        [
            "2: rapid X180 Z12 |",
            "2: rapid X180 Z5 |",
            "2: line X44 Z5 F100 |",
            "2: line X46 Z6 F100 |",
            "2: rapid X180 Z6 |",
        ]
    );
    // Level 9 at Z-51 on the line (164,-53)-(84,-33): X 164 - 80*2/20.
    assert!(trace.contains(&"2: line X156 Z-51 F100 |".to_string()));
    let tail = &trace[trace.len() - 8..trace.len() - 1];
    assert_eq!(
        tail,
        [
            "2: rapid X180 Z-53 |",
            "2: line X164 Z-53 F100 |",
            "2: line X84 Z-33 F100 |",
            "2: line X84 Z-18 F100 |",
            "2: line X44 Z2 F100 |",
            "2: rapid X176 Z10 |",
            "8: rapid X220 Z50 |",
        ]
    );
}

#[test]
fn all_four_quadrants_mirror() {
    // One profile, mirrored about the start point in X and in Z.
    let run = |sx: f64, sz: f64| {
        let f = |x: f64| 100.0 + sx * x;
        let g = |z: f64| sz * z;
        // Turning towards +Z mirrors the direction of an arc, and so does an inner contour.
        let arc = if sx * sz > 0.0 { "G02" } else { "G03" };
        let text = format!(
            "G71 U3 R0.5 F100;\nG71 P1 Q4 U{} W{};\nN1 G01 X{};\nZ{};\n{arc} X{} Z{} R10;\nN4 G01 X{} Z{};\n",
            sx * 0.6,
            sz * 0.2,
            f(-50.0),
            g(-20.0),
            f(-30.0),
            g(-30.0),
            f(-10.0),
            g(-45.0),
        );
        let mut bench = InterpreterBench::at(100.0, 0.0);
        bench.open(&text);
        let (commands, alarm) = bench.run_to_end();
        assert_eq!(alarm, None, "{text}");
        commands
            .iter()
            .filter_map(|command| super::target(&command.action))
            .map(|to| {
                let round = |value: f64| (value * 1e6).round() / 1e6 + 0.0;
                (round(sx * (to.x - 50.0)), round(sz * to.z))
            })
            .collect::<Vec<_>>()
    };
    let outside = run(1.0, 1.0);
    // 50/2/3: eight levels and the contour pass.
    assert_eq!(outside.len(), 1 + 8 * 4 + 1 + 3 + 1);
    for (sx, sz) in [(-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
        assert_eq!(run(sx, sz), outside, "{sx} {sz}");
    }
}

#[test]
fn infeeds_use_the_mode_of_ns() {
    let trace = InterpreterBench::at(50.0, 2.0)
        .trace("G71 U5 R0;\nG71 P1 Q2 F80;\nN1 G01 X30;\nN2 Z-20;\n");
    assert_eq!(
        trace[1..8],
        [
            // Without an allowance there is no approach; without a retract no escape.
            "2: line X40 Z2 F80 |",
            "2: line X40 Z-20 F80 |",
            "2: rapid X40 Z2 |",
            "2: line X30 Z2 F80 |",
            "2: line X30 Z-20 F80 |",
            "2: rapid X50 Z2 |",
            "4: end counts false m30 false",
        ]
    );
}

#[test]
fn a_short_distance_needs_only_the_contour_pass() {
    let trace = InterpreterBench::at(50.0, 2.0)
        .trace("G71 U10 R1;\nG71 P1 Q2 F80;\nN1 G00 X30;\nN2 G01 Z-20;\n");
    assert_eq!(
        trace[1..4],
        [
            "2: rapid X30 Z2 |",
            "2: line X30 Z-20 F80 |",
            "2: rapid X50 Z2 |"
        ]
    );
}

#[test]
fn the_escape_does_not_pass_the_start() {
    // The wall at Z1.5 leaves a cut of only 0.5.
    let trace = InterpreterBench::at(50.0, 2.0)
        .trace("G71 U5 R2;\nG71 P1 Q3 F80;\nN1 G00 X30;\nG01 Z1.5;\nN3 X50;\n");
    assert_eq!(
        trace[1..5],
        [
            "2: rapid X40 Z2 |",
            "2: line X40 Z1.5 F80 |",
            "2: line X44 Z2 F80 |",
            "2: rapid X30 Z2 |",
        ]
    );
}

#[test]
fn a_level_on_a_wall_or_a_cylinder_stops_at_its_beginning() {
    let trace = InterpreterBench::at(50.0, 2.0)
        .trace("G71 U5 R1;\nG71 P1 Q5 F80;\nN1 G00 X30;\nG01 Z-10;\nX40 Z-20;\nZ-30;\nN5 X50;\n");
    assert_eq!(trace[2], "2: line X40 Z-20 F80 |");
}

#[test]
fn arguments_come_from_parameters() {
    let mut bench = InterpreterBench::at(50.0, 2.0);
    bench.parameters.set(51, 5000).unwrap();
    bench.parameters.set(52, 500).unwrap();
    let trace = bench.trace("G71 P1 Q2 F80;\nN1 G00 X30;\nN2 G01 Z-20;\n");
    assert_eq!(trace[2], "1: line X41 Z-19.5 F80 |");
    // R may be in the block of the cycle, too.
    let trace = InterpreterBench::at(50.0, 2.0)
        .trace("G71 U5;\nG71 P1 Q2 R2 F80;\nN1 G00 X30;\nN2 G01 Z-20;\n");
    assert_eq!(trace[3], "2: line X44 Z-18 F80 |");
}

#[test]
fn blocks_before_the_profile_are_skipped() {
    let text = "G71 U5 R1;\nG71 P1 Q2 F80;\nG00 X999;\nN1 G00 X30;\nN2 G01 Z-20;\nM08;\n";
    let trace = InterpreterBench::at(50.0, 2.0).trace(text);
    assert_eq!(count(&trace, "3:"), 0);
    assert_eq!(trace[trace.len() - 2], "6: M08 |");
    // A profile before its cycle: the run continues after the cycle.
    let text =
        "G01 F50;\nM09;\nN1 G00 X30;\nN2 G01 Z-20;\nG00 X50 Z2;\nG71 U10;\nG71 P1 Q2;\nM08;\n";
    let trace = InterpreterBench::at(50.0, 2.0).trace(text);
    assert_eq!(count(&trace, "8:"), 1 + 1);
}

#[test]
fn words_of_the_profile_count_in_finishing_only() {
    let text = "G71 U10 R1 F100;\nG71 P1 Q3;\nN1 G00 X30 S500 M08;\nG01 Z-10 F30;\nN3 X50 Z-20 F20 T0101;\nG00 X60 Z5;\nG70 P1 Q3 F77;\nM09;\n";
    let mut bench = InterpreterBench::at(50.0, 2.0);
    let trace = bench.trace(text);
    assert_eq!(
        trace,
        [
            "1: nothing |",
            "2: rapid X30 Z2 |",
            "2: line X30 Z-10 F100 |",
            "2: line X50 Z-20 F100 |",
            "2: rapid X50 Z2 |",
            "6: rapid X60 Z5 |",
            "3: Speed(500.0)",
            "3: M08",
            "3: rapid X30 Z5 |",
            "4: line X30 Z-10 F30 |",
            "5: T0101",
            "5: frame X0 Z0 offset X0.04 Z0.02",
            "5: line X50.04 Z-19.98 F20 |",
            "7: rapid X60.04 Z5.02 |",
            "8: M09 |",
            "8: end counts false m30 false",
        ]
    );
    assert_eq!(bench.interpreter.modal().motion, MotionCode::Line);
}

#[test]
fn roughing_keeps_group_01() {
    let mut bench = InterpreterBench::at(50.0, 2.0);
    bench.trace("G00 X50 F50;\nG71 U10;\nG71 P1 Q2;\nN1 G01 X30;\nN2 Z-20;\n");
    assert_eq!(bench.interpreter.modal().motion, MotionCode::Rapid);
}

#[test]
fn profiles_have_chamfers_dwells_and_variables() {
    let mut bench = InterpreterBench::at(50.0, 2.0);
    let trace = bench.trace(
        "G65 H01 P#200 Q30000;\nG71 U10 R1 F100;\nG71 P1 Q4;\nN1 G00 X#200;\nG01 Z-10 I2;\nX50;\nG04 P100;\nN4 Z-20;\n",
    );
    let cycle: Vec<_> = trace.iter().filter(|line| line.starts_with("3:")).collect();
    assert_eq!(
        cycle,
        [
            "3: rapid X30 Z2 |",
            "3: line X30 Z-8 F100 |",
            "3: line X34 Z-10 F100 |",
            "3: line X50 Z-10 F100 |",
            "3: dwell 100 |",
            "3: line X50 Z-20 F100 |",
            "3: rapid X50 Z2 |",
        ]
    );
}

#[test]
fn skipped_blocks_are_left_out_of_the_profile() {
    let mut bench = InterpreterBench::at(50.0, 2.0);
    bench.block_skip = true;
    let trace =
        bench.trace("G71 U10 R1 F100;\nG71 P1 Q3;\nN1 G00 X30;\n/G01 X10 Z-5;\nN3 G01 Z-20;\n");
    assert_eq!(trace[2], "2: line X30 Z-20 F100 |");
}

#[test]
fn the_pattern_of_the_manual() {
    let mut bench = InterpreterBench::at(200.0, 10.0);
    let trace = bench.trace(
        "G99;\nG73 U14.0 W14.0 R3;\nG73 P014 Q019 U4.0 W2.0 F0.3 S0180;\nN014 G00 X80.0 W-40.0;\nN015 G01 W-20.0 F0.15 S0600;\n\
         N016 X120.0 W-10.0;\nN017 W-20.0 S0400;\nN018 G02 X160.0 W-20.0 R20.0;\nN019 G01 X180.0 W-10.0 S0280;\nN020 M05;\n",
    );
    assert_eq!(
        [53, 54, 55].map(|number| bench.parameters.value(number)),
        [14000, 14000, 3]
    );
    let moves: Vec<_> = trace
        .iter()
        .filter(|line| line.starts_with("3: "))
        .skip(1)
        .collect();
    // Shifts (32, 16), (18, 9), (4, 2).
    assert_eq!(
        moves[..9],
        [
            "3: rapid X232 Z26 |",
            "3: rapid X112 Z-14 |",
            "3: line X112 Z-34 F0.3/r |",
            "3: line X152 Z-44 F0.3/r |",
            "3: line X152 Z-64 F0.3/r |",
            "3: cw X192 Z-84 about X192 Z-64 F0.3/r |",
            "3: line X212 Z-94 F0.3/r |",
            "3: rapid X218 Z19 |",
            "3: rapid X98 Z-21 |",
        ]
    );
    assert_eq!(moves[14], "3: rapid X204 Z12 |");
    assert_eq!(*moves.last().unwrap(), "3: rapid X200 Z10 |");
    assert_eq!(moves.len(), 3 * 7 + 1);
}

#[test]
fn one_pass_of_a_pattern_is_two_and_thousands_take_no_memory() {
    let text = |d: &str| format!("G73 U1 W-2 R{d};\nG73 P1 Q2 F9;\nN1 G01 X10;\nN2 Z-5;\n");
    let trace = InterpreterBench::at(20.0, 0.0).trace(&text("1"));
    assert_eq!(
        trace[1..6],
        [
            "2: rapid X22 Z-2 |",
            "2: line X12 Z-2 F9 |",
            "2: line X12 Z-7 F9 |",
            "2: rapid X20 Z0 |",
            "2: line X10 Z0 F9 |",
        ]
    );
    let mut bench = InterpreterBench::at(20.0, 0.0);
    bench.open(&text("9999"));
    let mut size_after = |moves| {
        for _ in 0..moves {
            bench.next().unwrap();
        }
        format!("{:?}", bench.interpreter).len()
    };
    let early = size_after(50);
    let late = size_after(5000);
    assert!(late < early + 200, "{early} {late}");
}

#[test]
fn levels_have_explanations() {
    let mut bench = InterpreterBench::at(200.0, 10.0);
    bench.open(SHAFT);
    for _ in 0..5 {
        bench.next().unwrap();
    }
    let explanation = bench.interpreter.explain().unwrap();
    assert_eq!(
        (explanation.code, explanation.pass, explanation.passes),
        (71, 1, Some(20))
    );
    assert_eq!(
        (explanation.level, explanation.depth, explanation.remaining),
        (Some(193.0), 4.0, 76.0)
    );
    assert_eq!(
        explanation.formula.to_string(),
        "X1 = 201.000 -8.000·1 = 193.000"
    );
}

#[test]
fn finishing_returns_to_its_start_in_a_subprogram_too() {
    let text = "G00 X50 Z2 F9;\nM98 P7;\nM30;\n";
    let mut bench = InterpreterBench::at(50.0, 2.0);
    bench
        .programs
        .store("O0007;\nG70 P1 Q2;\nM08;\nM99;\nN1 G01 X30;\nN2 Z-5;\n")
        .unwrap();
    let trace = bench.trace(text);
    assert_eq!(
        trace[1..],
        [
            "5: line X30 Z2 F9 |",
            "6: line X30 Z-5 F9 |",
            "2: rapid X50 Z2 |",
            "3: M08 |",
            "3: end counts true m30 true |",
        ]
    );
}

#[test]
fn feed_hold_waits_for_the_end_of_each_segment() {
    let mut bench = InterpreterBench::at(50.0, 2.0);
    bench.open(
        "G71 U5 R1 F9;\nG71 P1 Q2;\nN1 G00 X30;\nN2 G01 Z-5;\nG70 P1 Q2;\nG76 X40 Z-5 P500 Q500 F1;\nG90 X30 Z-5;\n",
    );
    let (commands, alarm) = bench.run_to_end();
    assert_eq!(alarm, None);
    let whole = |line: u32| {
        let segments: Vec<_> = commands
            .iter()
            .filter(|command| command.source.line == line)
            .map(|command| command.defers_feed_hold)
            .collect();
        assert!(!segments.is_empty());
        segments.into_iter().reduce(|a, b| a && b)
    };
    assert_eq!(
        [2, 3, 4, 5, 6, 7].map(whole),
        [true, true, true, true, false, false].map(Some)
    );
}
