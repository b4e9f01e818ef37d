//! Holes, taps, threads and boring.

use super::{alarm, assert_near, ends, run_program, run_to_end, with};
use crate::MillMoveKind;

#[test]
fn holes_by_level_and_by_number() {
    let (_, moves) =
        run_to_end("G90 G00 X0 Y0 Z50\nG99 G81 X10 Y0 R2 Z-5 F100\nG98 X20\nG80 X0\nM30\n");
    assert_near(
        &ends(&moves[1..]),
        &[
            [10., 0., 50.],
            [10., 0., 2.],
            [10., 0., -5.],
            [10., 0., 2.],
            [20., 0., 2.],
            [20., 0., -5.],
            [20., 0., 50.],
            [0., 0., 50.],
        ],
    );
    let (_, moves) = run_to_end("G90 G00 X0 Y0 Z10\nG91 G99 G82 X5 R-8 Z-4 P500 K3 F100\nM30\n");
    let drilled: Vec<_> = moves
        .iter()
        .filter(|it| it.kind == MillMoveKind::Feed)
        .collect();
    let bottoms: Vec<_> = drilled.iter().map(|it| it.to.mm()).collect();
    assert_near(&bottoms, &[[5., 0., -2.], [10., 0., -2.], [15., 0., -2.]]);
    let dwells = moves.iter().filter(|it| it.kind == MillMoveKind::Dwell);
    assert_eq!(dwells.map(|it| it.duration_s).sum::<f64>(), 1.5);
    let (_, moves) = run_to_end("G90 G00 X0 Y0 Z10\nG81 R2 Z-5 F100 K0\nX1\nM30\n");
    assert_eq!(
        moves
            .iter()
            .filter(|it| it.kind == MillMoveKind::Feed)
            .count(),
        1
    );
}

#[test]
fn holes_in_pecks() {
    let (_, moves) = run_to_end("G90 G00 X0 Y0 Z2\nG98 G83 R2 Z-8 Q4 F100\nM30\n");
    let z: Vec<f64> = moves.iter().map(|it| it.to.mm()[2]).collect();
    // 5115: 2 mm before the last depth.
    assert_eq!(z, [2., -2., 2., 0., -6., 2., -4., -8., 2.]);
    let (_, moves) = run_to_end("G90 G00 X0 Y0 Z2\nG98 G73 R2 Z-7 Q4 F100\nM30\n");
    let z: Vec<f64> = moves.iter().map(|it| it.to.mm()[2]).collect();
    assert_eq!(z, [2., -2., 0., -6., -4., -7., 2.]);
    assert_eq!(alarm("G83 X1 R2 Z-5 F100\n"), (62, 1));
    assert_eq!(alarm("G81 X1 R2 F100\n"), (62, 1));
}

#[test]
fn rigid_taps_in_pecks() {
    let text = "G90 G00 X0 Y0 Z2\nM03 S500\nM29\nG98 G84 R2 Z-7 Q4 F500\nG80 M30\n";
    let taps = |bits| {
        let (preview, moves) = run_program(&with(&[(588, bits)]), text, &[]);
        assert_eq!(preview.alarm, None);
        let taps = moves.into_iter().filter(|it| it.kind == MillMoveKind::Tap);
        taps.map(|it| it.to.mm()[2]).collect::<Vec<_>>()
    };
    assert_eq!(taps(0), [-2., 2., -6., 2., -7., 2.]);
    assert_eq!(taps(32), [-2., 0., -6., -4., -7., 2.]);
    // Without M29, Q remains from other holes.
    let (_, moves) = run_to_end("G90 G00 X0 Y0 Z2\nG84 R2 Z-7 Q4 F500\nM30\n");
    assert_eq!(
        moves
            .iter()
            .filter(|it| it.kind == MillMoveKind::Tap)
            .count(),
        2
    );
}

#[test]
fn threads_follow_the_spindle() {
    // 20 mm with a lead of 2 are ten turns, 2 s at 300 r/min, and a stop after them.
    let text = "M03 S300\nG00 X0 Z10\nG01 Z9 F60\nG33 Z-10 X5 F1\nG33 Z-30 F2\nG01 Z-31\nM30\n";
    let (preview, moves) = run_to_end(text);
    assert_eq!(preview.alarm, None);
    let threads: Vec<_> = moves
        .iter()
        .filter(|it| it.kind == MillMoveKind::Thread)
        .collect();
    let seconds: Vec<f64> = threads.iter().map(|it| it.duration_s).collect();
    assert!((seconds[0] - 19.0 / 5.0).abs() < 1e-9, "{seconds:?}");
    assert!((seconds[1] - 2.0).abs() < 1e-9, "{seconds:?}");
    // The feed is unchanged.
    let last = moves.last().expect("a move");
    assert_eq!(last.feed, Some(gsk_core::units::Feed::PerMinute(60.0)));
    assert_eq!(alarm("M03 S300\nG33 Z-10\n"), (11, 2));
    assert_eq!(alarm("G33 Z-10 F1\n"), (94, 1));
    assert_eq!(alarm("M03 S300\nG33 Z-10 F501\n"), (43, 2));
}

#[test]
fn boring_retracts_beside_the_wall() {
    let setup = with(&[(584, 3)]);
    let (preview, moves) = run_program(
        &setup,
        "G90 G00 X0 Y0 Z20\nM03 S500\nG98 G76 X5 R2 Z-10 Q0.5 F50\nM30\n",
        &[],
    );
    assert_eq!(preview.alarm, None);
    assert_near(
        &ends(&moves[1..]),
        &[
            [5., 0., 20.],
            [5., 0., 2.],
            [5., 0., -10.],
            [5., -0.5, -10.],
            [5., -0.5, 20.],
            [5., 0., 20.],
        ],
    );
}
