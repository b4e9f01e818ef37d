//! The Huaxing lathes: threads, taps, cycles in steps, deep holes, scaling, returns. The
//! decisions on them give the expected values.

use super::InterpreterBench;
use crate::model::ModelId;

/// Runs a program from X`x` Z2 on and returns its commands as short texts, without the one at
/// the end of the program.
fn trace_from(x: f64, text: &str) -> Vec<String> {
    trace(InterpreterBench::at(x, 2.0), text)
}

fn trace(bench: InterpreterBench, text: &str) -> Vec<String> {
    let mut lines = bench.of_model(ModelId::Hx31).trace(&format!("{text}M02\n"));
    let end = lines.pop();
    assert!(
        end.as_deref()
            .is_some_and(|line| line.contains("end counts")),
        "{text}: {end:?} after {lines:?}"
    );
    lines
        .iter()
        .map(|line| line.trim_end_matches(" |").to_owned())
        .collect()
}

fn fault(text: &str) -> (u16, u32) {
    InterpreterBench::at(50.0, 2.0)
        .of_model(ModelId::Hx31)
        .run_to_alarm(text)
}

/// C55: the depths R·√(p/L) of G86 are 2.6·√(1/4), 2.6·√(2/4), 2.6·√(3/4) and 2.6·√(4/4).
#[test]
fn the_depth_of_a_thread_follows_square_roots() {
    let lines = trace_from(30.0, "G86 Z-30 K2 R2.6 L4\n");
    let pass = |x: &str| {
        [
            format!("1: rapid X{x} Z2"),
            format!("1: thread X{x} Z-30 Z lead 2 at 0"),
            "1: rapid X30 Z-30".to_owned(),
            "1: rapid X30 Z2".to_owned(),
        ]
    };
    let expected: Vec<_> = ["28.7", "28.162", "27.748", "27.4"]
        .into_iter()
        .flat_map(pass)
        .collect();
    assert_eq!(lines, expected);
}

/// The run-out is J long and I high. G87 cuts all starts at each depth. 8 threads per inch are
/// a lead of 3.175 mm.
#[test]
fn a_thread_has_a_run_out_and_starts() {
    assert_eq!(
        trace_from(30.0, "G87 Z-30 K8 R2 L1 I6 J3 N2\n"),
        [
            "1: rapid X28 Z2",
            "1: thread X28 Z-27 Z lead 3.175 at 0",
            "1: run-out X34 Z-30 Z lead 3.175 continued",
            "1: rapid X34 Z-30",
            "1: rapid X34 Z2",
            "1: rapid X28 Z2",
            "1: thread X28 Z-27 Z lead 3.175 at 180",
            "1: run-out X34 Z-30 Z lead 3.175 continued",
            "1: rapid X34 Z-30",
            "1: rapid X34 Z2",
            "1: rapid X30 Z2",
        ]
    );
    // On an inner thread the depth counts outwards, and the tool leaves towards the axis.
    assert_eq!(
        trace_from(20.0, "G86 Z-30 K2 R2 I-1\n"),
        [
            "1: rapid X22 Z2",
            "1: thread X22 Z-30 Z lead 2 at 0",
            "1: rapid X20 Z-30",
            "1: rapid X20 Z2",
        ]
    );
    // A taper: the tool returns clear of the thicker end.
    assert_eq!(
        trace_from(30.0, "G86 X34 Z-30 P2 R2\n"),
        [
            "1: rapid X28 Z2",
            "1: thread X32 Z-30 Z lead 2 at 0",
            "1: rapid X34 Z-30",
            "1: rapid X34 Z2",
            "1: rapid X30 Z2",
        ]
    );
}

#[test]
fn a_single_pass_makes_three_moves() {
    assert_eq!(
        trace_from(30.0, "G33 Z-20 K1.5 D-4 I6\nG00 Z2\n"),
        [
            "1: rapid X26 Z2",
            "1: thread X26 Z-20 Z lead 1.5 at 0",
            "1: rapid X32 Z-20",
            "2: rapid X32 Z2",
        ]
    );
    // 10 threads per inch with a taper to X28; without D and I the pass has no approach and no
    // departure.
    assert_eq!(
        trace_from(26.0, "G91 G34 X2 Z-22 K10\n"),
        ["1: thread X28 Z-20 Z lead 2.54 at 0"]
    );
    assert_eq!(
        trace_from(26.0, "G33 Z-20 P1.25\n"),
        ["1: thread X26 Z-20 Z lead 1.25 at 0"]
    );
}

#[test]
fn taps_have_their_lead_in_k_or_i() {
    assert_eq!(
        trace_from(0.0, "G84 Z-20 K1.5\nG85 Z-18 I20\nG85 Z-18 K10\n"),
        [
            "1: tap X0 Z-20 lead 1.5 at 0",
            "2: tap X0 Z-18 lead 1.27 at 0",
            "3: tap X0 Z-18 lead 2.54 at 0",
        ]
    );
}

/// G83 from Z2 pecks to Z-6, Z-14 and Z-20, retracts by 2 after each peck, and leaves the
/// hole.
#[test]
fn a_deep_hole_is_pecked() {
    assert_eq!(
        trace_from(0.0, "G83 Z-20 I8 K2 F100\n"),
        [
            "1: line X0 Z-6 F100",
            "1: rapid X0 Z-4",
            "1: line X0 Z-14 F100",
            "1: rapid X0 Z-12",
            "1: line X0 Z-20 F100",
            "1: rapid X0 Z2",
        ]
    );
    // The tool never retracts beyond the start.
    assert_eq!(
        trace_from(0.0, "G83 Z-6 I4 K99 F100\n")[1..3],
        ["1: rapid X0 Z2", "1: line X0 Z-6 F100"]
    );
}

/// G81 cuts 10 mm of diameter, with a finishing cut of 1 mm, at the depths 4, 8, 9 and 10.
#[test]
fn turning_in_steps() {
    let round = |x: &str| {
        [
            format!("1: rapid X{x} Z2"),
            format!("1: line X{x} Z-20 F100"),
            "1: line X50 Z-20 F100".to_owned(),
            "1: rapid X50 Z2".to_owned(),
        ]
    };
    let expected: Vec<_> = ["46", "42", "41", "40"]
        .into_iter()
        .flat_map(round)
        .collect();
    assert_eq!(trace_from(50.0, "G81 X40 Z-20 I-4 K-1 F100\n"), expected);
    // A bore in one cut.
    assert_eq!(
        trace_from(20.0, "G81 X24 Z-20 F100\n"),
        [
            "1: rapid X24 Z2",
            "1: line X24 Z-20 F100",
            "1: line X20 Z-20 F100",
            "1: rapid X20 Z2",
        ]
    );
}

/// G81 cuts a cone from X40 to X50 in two passes of 5 mm. The first pass, from X45 to X55,
/// reaches X50, the X of the start, half way at Z-9.
#[test]
fn a_cone_in_steps_is_not_cut_beyond_the_start() {
    assert_eq!(
        trace_from(50.0, "G81 X50 Z-20 R40 I-5 F100\n"),
        [
            "1: rapid X45 Z2",
            "1: line X50 Z-9 F100",
            "1: rapid X50 Z2",
            "1: rapid X40 Z2",
            "1: line X50 Z-20 F100",
            "1: rapid X50 Z2",
        ]
    );
    // In the opposite direction the cut begins where the cone reaches X50.
    assert_eq!(
        trace_from(50.0, "G81 X40 Z-20 R50 I-5 F100\n")[..3],
        [
            "1: rapid X50 Z-9",
            "1: line X45 Z-20 F100",
            "1: line X50 Z-20 F100",
        ]
    );
}

/// G82 faces from Z2 to Z-2 in steps of 1.5 mm with a finishing cut of 0.5 mm: the depths are
/// 1.5, 3, 3.5 and 4.
#[test]
fn facing_in_steps() {
    let round = |z: &str| {
        [
            format!("1: rapid X60 Z{z}"),
            format!("1: line X20 Z{z} F100"),
            "1: line X20 Z2 F100".to_owned(),
            "1: rapid X60 Z2".to_owned(),
        ]
    };
    let expected: Vec<_> = ["0.5", "-1", "-1.5", "-2"]
        .into_iter()
        .flat_map(round)
        .collect();
    assert_eq!(trace_from(60.0, "G82 X20 Z-2 I-1.5 K-0.5 F100\n"), expected);
}

/// K of M20 is a relay number, which gives no centre under G03 and no chamfer under G01.
#[test]
fn a_relay_number_is_not_a_length() {
    assert_eq!(
        trace_from(50.0, "G03 X50 Z-18 I0 K-10 F100\nM20 K3\nG01 Z-30 M21 K4\n"),
        [
            "1: ccw X50 Z-18 about X50 Z-8 F100",
            "2: outputs on 100 off 0 0ms",
            "3: outputs on 0 off 1000 0ms",
            "3: line X50 Z-30 F100",
        ]
    );
}

#[test]
fn cycles_are_not_modal() {
    let lines = trace_from(50.0, "G01 X50 F100\nG81 X46 Z-5\nX40\n");
    assert_eq!(
        lines.last().map(String::as_str),
        Some("3: line X40 Z2 F100")
    );
}

#[test]
fn all_lengths_are_scaled_and_nothing_else() {
    let text = "G31 L2\nG01 X40 Z-10 F100\nG30\nX40 Z-10\nG31 L0.5\nU8 W-4\n\
                G03 X88 Z-64 I0 K-20\nG04 K2\nM20 K3\nG01 Z-80 R2\nX100\nG92 X7 Z9\n";
    assert_eq!(
        trace_from(50.0, text),
        [
            "1: nothing",
            "2: line X80 Z-20 F100",
            "3: nothing",
            "4: line X40 Z-10 F100",
            "5: nothing",
            "6: line X44 Z-12 F100",
            // Half a circle: the centre is 10 before the start, the end 20.
            "7: ccw X44 Z-32 about X44 Z-22 F100",
            "8: dwell 2000",
            "9: outputs on 100 off 0 0ms",
            // The corner at Z-40 is rounded by 1 towards X50.
            "10: line X44 Z-39 F100",
            "10: cw X46 Z-40 about X46 Z-39 F100",
            "11: line X50 Z-40 F100",
            "12: frame X43 Z-49 offset X0 Z0 program zero relative",
        ]
    );
}

/// The factor of G31 scales the blocks of a contour, and the block that a corner reads ahead.
#[test]
fn corners_and_contours_are_scaled() {
    let bare = trace_from(50.0, "G01 Z-40 R2 F100\nX100\n");
    let scaled = trace_from(50.0, "G31 L2\nG01 Z-20 R1 F100\nX50\n");
    let renumbered: Vec<_> = scaled[1..]
        .iter()
        .map(|line| match line.split_once(':') {
            Some((n, rest)) => format!("{}:{rest}", n.parse::<u32>().unwrap_or(0) - 1),
            None => line.clone(),
        })
        .collect();
    assert_eq!(renumbered, bare);
    let ends = |lines: &[String]| -> Vec<String> {
        let parts = lines.iter().filter_map(|line| line.split_once(": "));
        parts.map(|(_, rest)| rest.to_owned()).collect()
    };
    let bare = trace_from(
        60.0,
        "G71 I8 K2 N3 X0.4 Z0.2 F100\nG00 X30\nG01 Z-20\nX60 Z-30\n",
    );
    let scaled = trace_from(
        60.0,
        "G31 L0.5\nG71 I16 K4 N3 X0.8 Z0.4 F100\nG00 X60\nG01 Z-40\nX120 Z-60\n",
    );
    assert_eq!(ends(&scaled[1..]), ends(&bare));
}

#[test]
fn returns_lead_to_machine_zero_and_to_the_start() {
    let at = |x, z| InterpreterBench::at(x, z);
    assert_eq!(
        trace(at(100.0, 50.0), "G74\n"),
        ["1: rapid X0 Z0", "1: referenced true true"]
    );
    assert_eq!(
        trace(at(100.0, 50.0), "G74 Z0\n"),
        ["1: rapid X100 Z0", "1: referenced false true"]
    );
    assert_eq!(
        trace(at(100.0, 50.0), "G00 X60 Z2\nG75\nG00 X60\nG76\n"),
        [
            "1: rapid X60 Z2",
            "2: rapid X100 Z50",
            "3: rapid X60 Z50",
            "4: rapid X100 Z50",
        ]
    );
    // G92 makes (200, 80) the start. G55 moves the zero by (10, 5), and with it the target of
    // G76.
    let lines = trace(
        at(100.0, 50.0),
        "G92 X200 Z80\nG00 X160 Z40\nG55 X10 Z5\nG76\nG75\n",
    );
    assert_eq!(
        lines[1..],
        [
            "2: rapid X60 Z10",
            "3: frame X-90 Z-25 offset X0 Z0",
            "4: rapid X110 Z55",
            "5: rapid X100 Z50",
        ]
    );
}

/// G92 sets the coordinates of the current point to X and Z also under G91.
#[test]
fn coordinates_are_set_under_increments() {
    let mut bench = InterpreterBench::at(100.0, 50.0).of_model(ModelId::Hx31);
    bench.open("G91 G92 X30 Z7\nM02\n");
    let (_, alarm) = bench.run_to_end();
    assert_eq!(alarm, None);
    assert_eq!(bench.displayed_position(), (30.0, 7.0));
}

#[test]
fn missing_and_wrong_words_raise_alarms() {
    for (text, number) in [
        ("G33 Z-20 D-2", 11),
        ("G34 Z-20 P2", 11),
        ("G33 K501 Z-20", 43),
        ("G33 K1", 62),
        ("G86 Z-20 K2", 62),
        ("G86 Z-20 K2 R-1", 62),
        ("G86 X40 K2 R1", 62),
        ("G86 Z-20 K2 R1 J2", 62),
        ("G86 Z-20 K2 R1 N0", 62),
        ("G84 X10 Z-20 K1", 62),
        ("G84 Z-20", 11),
        ("G85 Z-20", 11),
        ("G83 Z-20 F100", 62),
        ("G83 X10 Z-20 I2 F100", 62),
        ("G81 X40 Z-20 I4 F100", 62),
        ("G81 X40 Z-20 I-4 K1 F100", 62),
        ("G81 X40 Z-20", 11),
        ("G81 X40 F100", 62),
        ("G81 Z-20 F100", 62),
        ("G31", 43),
        ("G31 L0", 43),
        ("G31 L100", 43),
        ("G75 X1", 12),
        ("G76 Z1", 12),
        ("G20 L1.5 N1", 7),
        ("G01 D1.5", 7),
    ] {
        assert_eq!(fault(&format!("{text}\nM02\n")), (number, 1), "{text}");
    }
    let mut unreferenced = InterpreterBench::at(50.0, 2.0).of_model(ModelId::Hx31);
    unreferenced.referenced.x = false;
    assert_eq!(unreferenced.run_to_alarm("G75\nM02\n"), (90, 1));
    assert_eq!(unreferenced.trace("G76\nM02\n")[0], "1: rapid X50 Z2 |");
}
