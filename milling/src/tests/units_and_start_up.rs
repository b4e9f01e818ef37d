//! Tests of increment systems, inch machines, soft limits after the reference return, flexible
//! taps and the parameters of the cutter compensation.

use super::*;

fn run_with(parameters: &[(u16, i32)], text: &str) -> (MillPreview, Vec<MillMove>) {
    let (preview, moves) = run_program(&with(parameters), text, &[]);
    assert_eq!(preview.alarm, None, "{text}");
    (preview, moves)
}

fn last_point(parameters: &[(u16, i32)], text: &str) -> [f64; 3] {
    let (_, moves) = run_with(parameters, text);
    moves.last().expect("a move").to.mm()
}

#[track_caller]
fn assert_point(found: [f64; 3], expected: [f64; 3]) {
    let off = found.iter().zip(&expected).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 1e-7, "{found:?} {expected:?}");
}

/// Starts G41 before an outer corner of 90 degrees, and cancels it after another one.
const SQUARE: &str = "G41 D1 G01 X20 F100\nY-20\nX0\nG40 Y0\nM30\n";

fn square_with(start_up: i32) -> Vec<[f64; 3]> {
    let mut setup = with(&[(2, start_up)]);
    setup.memory.take_offset("1=0,5").expect("offset");
    let (preview, moves) = run_program(&setup, SQUARE, &[]);
    assert_eq!(preview.alarm, None);
    ends(&moves)
}

#[test]
fn start_up_by_type_a_is_square_to_the_compensated_block() {
    // 002:575-583 (002.6 = 0): one vector, square to the block after the start-up and to the
    // block before the cancel.
    let path = square_with(0b0000_0010);
    let expected = [
        [25., 0., 100.],
        [25., -25., 100.],
        [0., -25., 100.],
        [0., 0., 100.],
    ];
    assert_near(&path, &expected);
}

#[test]
fn start_up_by_type_b_goes_round_the_corner() {
    // 002:575-583 (002.6 = 1): square to the start-up block, then the meeting point.
    let path = square_with(0b0100_0010);
    let expected = [
        [20., 5., 100.],
        [25., 5., 100.],
        [25., -25., 100.],
        [-5., -25., 100.],
        [-5., -20., 100.],
        [0., 0., 100.],
    ];
    assert_near(&path, &expected);
}

#[test]
fn a_start_up_within_5012_of_a_straight_line_has_one_vector() {
    // 002:1257: the greatest error of angles at which two lines count as 0 or 180 degrees.
    // The contour turns away from the cutter by 0.8 degrees.
    let text = "G41 D1 G01 X10 F100\nX110 Y-1.396\nG40 X120\nM30\n";
    let moves_to_corner = |parameters: &[(u16, i32)]| {
        let mut all = vec![(2, 0b0100_0010)];
        all.extend_from_slice(parameters);
        let mut setup = with(&all);
        setup.memory.take_offset("1=0,5").expect("offset");
        let (preview, moves) = run_program(&setup, text, &[]);
        assert_eq!(preview.alarm, None);
        moves.iter().filter(|made| made.to.mm()[0] < 50.0).count()
    };
    assert_eq!(moves_to_corner(&[]), 2);
    assert_eq!(moves_to_corner(&[(5012, 1000)]), 1);
    // In IS-C the value counts in 0.0001 degrees.
    assert_eq!(moves_to_corner(&[(1, 0b10), (5012, 1000)]), 2);
    assert_eq!(moves_to_corner(&[(1, 0b10), (5012, 9000)]), 1);
}

#[test]
fn lines_within_5012_of_180_degrees_are_too_sharp() {
    let alarm = |angle: i32| {
        let mut setup = with(&[(5012, angle)]);
        setup.memory.take_offset("1=0,1").expect("offset");
        // Back at 0.5 degrees, on the side of the cutter.
        let text = "G41 D1 G01 X1 F100\nX9000\nX0 Y78.55\nG40 Y100\nM30\n";
        let (preview, _) = run_program(&setup, text, &[]);
        preview.alarm.map(|alarm| alarm.number)
    };
    assert_eq!(
        alarm(1000),
        Some(gsk_core::alarm::number::NOSE_SHARP_CORNER)
    );
    assert_eq!(alarm(10), None);
}

#[test]
fn increments_are_those_of_the_increment_system() {
    // 002:569-570 (001.1): IS-B 0.001 mm and 0.0001 inch, IS-C a tenth of them.
    let (b, c) = (&[(1, 0)], &[(1, 0b10)]);
    let word = "G01 X1.234567 F100\nM30\n";
    assert_point(last_point(b, word), [1.235, 0., 100.]);
    assert_point(last_point(c, word), [1.2346, 0., 100.]);
    let inch = "G20\nG01 X1.000067 F10\nM30\n";
    assert_point(last_point(b, inch), [1.0001 * 25.4, 0., 100.]);
    assert_point(last_point(c, inch), [1.00007 * 25.4, 0., 100.]);
    let turned = "G68 X0 Y0 R45.0\nG01 X10 Y0 F100\nM30\n";
    assert_point(last_point(b, turned), [7.071, 7.071, 100.]);
    assert_point(last_point(c, turned), [7.0711, 7.0711, 100.]);
}

#[test]
fn rapids_in_is_c_are_slower() {
    // 002:691-695: 022 up to 60000 in IS-B, 24000 in IS-C, 6000 for the fifth axis.
    let time = |parameters: &[(u16, i32)], text: &str| run_with(parameters, text).0.time_s;
    let text = "G00 X400\nM30\n";
    let fast = [(10022, 60_000), (23, 10)];
    let at_limit = [(10022, 24_000), (23, 10)];
    let fine = [(10022, 60_000), (23, 10), (1, 0b10)];
    assert!(time(&fast, text) < 0.5);
    assert!((time(&fine, text) - time(&at_limit, text)).abs() < 1e-9);
    let turn = "G00 C60\nM30\n";
    let fifth = [(50022, 60_000), (23, 10), (1, 0b10), (1010, 5)];
    assert!((time(&fifth, turn) - (60.0 / 100.0 + 0.01)).abs() < 1e-9);
}

#[test]
fn further_axes_have_an_increment_of_their_own() {
    // 002:820-835 (187): 01 IS-A, 10 IS-B, 11 IS-C, 00 as X, Y and Z.
    let angle = |kind: i32| {
        let text = "G00 A10.123456\nM30\n";
        let (_, moves) = run_with(&[(1010, 4), (40_187, kind)], text);
        let to = moves.last().expect("a move").to;
        to.get(crate::MillAxis::Fourth).mm()
    };
    let found = [0b01, 0b0100_0001, 0b1000_0001, 0b1100_0001].map(angle);
    let expected = [10.123, 10.12, 10.123, 10.1235];
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
}

#[test]
fn an_inch_machine_has_parameters_in_inches() {
    // 002:601-612 (004.0): travel in 0.0001 inch, speeds in 0.1 inch/min.
    let travel = [(4, 1), (10045, 20_000)];
    assert_point(last_point(&travel, "G00 X50.8\nM30\n"), [50.8, 0., 100.]);
    let (preview, _) = run_program(&with(&travel), "G00 X50.81\nM30\n", &[]);
    assert_eq!(preview.alarm.map(|alarm| alarm.number), Some(201));
    // G20 and G21 do not change them.
    let (preview, _) = run_program(&with(&travel), "G20\nG00 X2.0001\nM30\n", &[]);
    assert_eq!(preview.alarm.map(|alarm| alarm.number), Some(201));
    // 026 = 300: 30 inch/min at power-on.
    let cut = "G01 X76.2\nM30\n";
    let (preview, _) = run_with(&[(4, 1), (26, 300)], cut);
    assert!((preview.time_s - (76.2 / 762.0 * 60.0 + 0.1)).abs() < 1e-9);
    // Computed points are whole increments of 0.0001 inch.
    let turned = "G68 X0 Y0 R45.0\nG01 X10 Y0 F100\nM30\n";
    let end = (10.0 * 0.5_f64.sqrt() / 0.002_54).round() * 0.002_54;
    assert_point(last_point(&[(4, 1)], turned), [end, end, 100.]);
}

#[test]
fn soft_limits_act_after_the_reference_return() {
    // 002:656-657 (012.1): 1 after the return to machine zero, 0 at once.
    let text = "G00 X60\nG28 X0\nG00 X60\nM30\n";
    let line = |parameters: &[(u16, i32)]| {
        let (preview, _) = run_program(&with(parameters), text, &[]);
        let alarm = preview.alarm.expect("an alarm");
        (alarm.number, alarm.source.map_or(0, |source| source.line))
    };
    assert_eq!(line(&[(10045, 50_000)]), (201, 1));
    assert_eq!(line(&[(10045, 50_000), (12, 0b10)]), (201, 3));
    // Y has not returned.
    let other = "G28 X0\nG00 Y60\nM30\n";
    let limits = [(20045, 50_000), (12, 0b10)];
    assert_eq!(run_with(&limits, other).0.alarm, None);
}

#[test]
fn flexible_taps_have_a_ramp_of_their_own() {
    // 002:747-751: 036 the time constant, 037 the speed at which they begin.
    let text = "M03 S100\nG99 G84 X10 Z-10 R2 F100\nG80\nM30\n";
    let time = |parameters: &[(u16, i32)]| run_with(parameters, text).0.time_s;
    let slow = time(&[(36, 1100), (37, 20)]) - time(&[(36, 100), (37, 20)]);
    assert!((slow - 2.0 * (1.0 - 20.0 / 100.0)).abs() < 1e-9, "{slow}");
    assert!((time(&[(36, 4000), (37, 100)]) - time(&[(36, 10), (37, 100)])).abs() < 1e-9);
    // Rigid taps and cuts do not use it.
    let rigid = "M03 S100\nM29\nG99 G84 X10 Z-10 R2 F100\nG80\nG01 X50\nM30\n";
    let of = |parameters: &[(u16, i32)]| run_with(parameters, rigid).0.time_s;
    assert!((of(&[(36, 4000)]) - of(&[])).abs() < 1e-9);
}
