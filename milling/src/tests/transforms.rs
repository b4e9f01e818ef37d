//! Scaling, mirroring, rotation and polar coordinates.

use super::{alarm, assert_near, ends, run_program, run_to_end, with};
use crate::MillSetup;

/// Appendix 2 of the manual and parameter 562: an axis without its bit is not scaled, not even
/// by P.
#[test]
fn only_axes_with_their_bit_are_scaled() {
    let text = "G00 X0 Y0 Z0\nG51 X0 Y0 Z0 P2000\nG01 X1 Y1 Z1 F100\nG50\nM30\n";
    let last = |bits: i32| {
        let (preview, moves) = run_program(&with(&[(562, bits)]), text, &[]);
        assert_eq!(preview.alarm, None);
        moves.last().map(|made| made.to.mm())
    };
    assert_eq!(last(0b111), Some([2.0, 2.0, 2.0]));
    assert_eq!(last(0b011), Some([2.0, 2.0, 1.0]));
    assert_eq!(last(0b000), Some([1.0, 1.0, 1.0]));
    // 5411 in place of P.
    let setup = with(&[(562, 0b100), (5411, 3000)]);
    let (_, moves) = run_program(&setup, &text.replace(" P2000", ""), &[]);
    assert_eq!(moves.last().map(|it| it.to.mm()), Some([1.0, 1.0, 3.0]));
}

/// Appendices 1 to 3 of the manual: ranges of G10, G51 and G68.
#[test]
fn ranges_of_the_appendices() {
    assert_eq!(alarm("G68 X0 Y0 R360.001\n"), (43, 1));
    assert_eq!(alarm("G68 X0 Y0 R-360.001\n"), (43, 1));
    run_to_end("G68 X0 Y0 R360.\nG69\nG68 X0 Y0 R-360\nG69\nM30\n");
    let each = with(&[(562, 0b1_0111)]);
    let number =
        |setup: &MillSetup, text: &str| run_program(setup, text, &[]).0.alarm.map(|it| it.number);
    assert_eq!(number(&each, "G51 X0 Y0 I9999 J-9999 K1\nM30\n"), None);
    assert_eq!(number(&each, "G51 X0 Y0 I10000 J1000\nM30\n"), Some(43));
    assert_eq!(number(&each, "G51 X0 Y0 I1000 J0\nM30\n"), Some(43));
    let fine = with(&[(562, 0b1_0111), (60_036, 128)]);
    assert_eq!(number(&fine, "G51 X0 Y0 I999999 J100000\nM30\n"), None);
    assert_eq!(number(&fine, "G51 X0 Y0 I1000000\nM30\n"), Some(43));
    assert_eq!(alarm("G51 P-1\n"), (43, 1));
    assert_eq!(alarm("G10 L10 P1 R1000\n"), (43, 1));
    // 99.9999 inches.
    run_to_end("G20\nG10 L10 P1 R99.9999\nM30\n");
    assert_eq!(alarm("G20 G10 L10 P1 R100\n"), (43, 1));
}

/// Facts C1 to C3 of `tests/model-facts.tsv`: the mirror of the worked example.
#[test]
fn mirrors_about_fifty() {
    let setup = with(&[(562, 19)]);
    let sub = "O9000\nG90 G00 X60 Y60\nG01 X100 F100\nY100\nX60 Y60\nM99\n";
    let main = "G17 G90\nM98 P9000\nG51 X50 Y50 I-1000 J1000\nM98 P9000\nG51 X50 Y50 I-1000 J-1000\nM98 P9000\nG51 X50 Y50 I1000 J-1000\nM98 P9000\nG50\nM30\n";
    let (preview, moves) = run_program(&setup, main, &[sub]);
    assert_eq!(preview.alarm, None);
    let p = |x, y| [x, y, 100.0];
    assert_near(
        &ends(&moves),
        &[
            p(60., 60.),
            p(100., 60.),
            p(100., 100.),
            p(60., 60.),
            p(40., 60.),
            p(0., 60.),
            p(0., 100.),
            p(40., 60.),
            p(40., 40.),
            p(0., 40.),
            p(0., 0.),
            p(40., 40.),
            p(60., 40.),
            p(100., 40.),
            p(100., 0.),
            p(60., 40.),
        ],
    );
}

/// Facts C4 to C6 of `tests/model-facts.tsv`: scaled by half about (300,150), rotated by 45°
/// about (250,125).
#[test]
fn scaled_and_turned() {
    let (_, moves) = run_to_end(
        "G90 G00 X1 Y0\nG51 X300.0 Y150.0 P500\nG68 X200.0 Y100.0 R45.0\nG01 X400.0 Y100.0 F100\nG91 Y100.0\nX-200.0\nY-100.0\nX200.0\nG69\nG50\nM30\n",
    );
    let p = |x, y| [x, y, 100.0];
    assert_near(
        &ends(&moves[1..]),
        &[
            p(320.711, 195.711),
            p(285.355, 231.066),
            p(214.645, 160.355),
            p(250., 125.),
            p(320.711, 195.711),
        ],
    );
}

/// Facts C7 and C8 of `tests/model-facts.tsv`: an arc by R under two scales.
#[test]
fn arcs_under_two_scales() {
    let setup = with(&[(562, 23)]);
    let begin = "G90 G00 X0 Y100\nG51 X0 Y0 Z0 I2000 J1000\n";
    let (preview, moves) =
        run_program(&setup, &format!("{begin}G02 X100 Y0 R100 F500\nM30\n"), &[]);
    assert_eq!(preview.alarm, None);
    let last = moves.last().expect("arc");
    assert_near(&[last.to.mm()], &[[200., 0., 100.]]);
    let arc = last.arc.expect("arc");
    assert!(((last.to.flat(arc.plane) - arc.center).length() - 200.0).abs() < 1e-6);
    let (preview, _) = run_program(&setup, &format!("{begin}G02 X100 Y0 I0 J-100 F500\n"), &[]);
    assert_eq!(preview.alarm.map(|it| it.number), Some(13));
}

#[test]
fn polar_coordinates() {
    let (_, moves) = run_to_end("G90 G00 X0 Y0\nG16 X10 Y30\nY120\nG91 Y30\nG15 G90 X0 Y0\nM30\n");
    assert_near(
        &ends(&moves[..2]),
        &[[8.660, 5.0, 100.], [-5.0, 8.660, 100.]],
    );
}

#[test]
fn what_scaling_and_rotation_refuse() {
    assert_eq!(alarm("G51 X0 Y0 P500 F100\n"), (12, 1));
    assert_eq!(alarm("G51 X0 I2000\n"), (12, 1));
    assert_eq!(alarm("G51 X0 P0\n"), (43, 1));
    assert_eq!(alarm("G51 X0 P1.5\n"), (7, 1));
    assert_eq!(alarm("G68 X0 Y0 R10\nG18\n"), (10, 2));
    assert_eq!(alarm("G68 X0 Y0 R10\nG92 X0\n"), (10, 2));
}

#[test]
fn a_rotation_starts_at_the_tool_with_an_increment() {
    let (_, moves) = run_to_end("G90 G00 X10 Y0\nG68 X0 Y0 R90\nG91 X5\nG69 X1\nM30\n");
    assert_near(&ends(&moves[1..]), &[[10., 5., 100.], [11., 5., 100.]]);
}
