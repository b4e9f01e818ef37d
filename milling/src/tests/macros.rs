//! Macro B: variables, calls and formulas.

use super::{alarm, assert_near, ends, run_program, run_to_end, with};
use crate::{MillMove, MillMoveKind, MillSetup};

/// Appendix 4, 2 of the manual: which variables can be written, and their ranges.
#[test]
fn timers_and_counters_are_written() {
    let text = "#3001=0\nG04 P1000\n#1=#3001\n#3001=65535\n#2=#3001\n#3002=2.25\n#3=#3002\n#3901=7\n#3902=9\nG00 X#1 Y#3901 Z[#3902+#3*100]\n#1103=5\n#4=#1132\n#1132=6\n#5=#1101+#1102*10\nX#4 Y#5\nM30\n";
    let (_, moves) = run_to_end(text);
    assert_near(
        &ends(&moves[moves.len() - 2..]),
        &[[992.0, 7.0, 234.0], [8.0, 11.0, 234.0]],
    );
    let (_, moves) = run_to_end("#3005=16\n#1=#4006\nG21\nG00 X#1 Y#3005\nM30\n");
    assert_near(&ends(&moves), &[[20.0, 0.0, 100.0]]);
    let number = |text: &str| alarm(text).0;
    for wrong in [
        "#3001=65536",
        "#3003=4",
        "#3004=8",
        "#1132=65536",
        "#3902=-1",
    ] {
        assert_eq!(number(&format!("{wrong}\n")), 111, "{wrong}");
    }
    for read_only in [
        "#3011=1", "#3012=1", "#4001=1", "#5001=1", "#1000=1", "#1032=1",
    ] {
        assert_eq!(number(&format!("{read_only}\n")), 116, "{read_only}");
    }
}

/// Fact C27 of `tests/model-facts.tsv` as corrected: five holes on a circle by macro B.
#[test]
fn a_bolt_circle_by_macro() {
    let circle = "O9100\n#3=#4003\nIF [#3 EQ 90] GOTO 1\n#24=#5001+#24\n#25=#5002+#25\nN1 G81 Z#26 R#18 F#9 K0\nWHILE [#11 GT 0] DO 1\n#5=#24+#4*COS[#1]\n#6=#25+#4*SIN[#1]\nG90 X#5 Y#6\n#1=#1+#2\n#11=#11-1\nEND 1\nG#3 G80\nM99\n";
    let main =
        "G90 G00 X0 Y0 Z100\nG65 P9100 X100.0 Y50.0 R30.0 Z-50.0 F500 I100.0 A0 B45.0 H5\nM30\n";
    let (preview, moves) = run_program(&MillSetup::default(), main, &[circle]);
    assert_eq!(preview.alarm, None);
    let drilled = moves.iter().filter(|it| it.kind == MillMoveKind::Feed);
    let bottoms: Vec<_> = drilled.map(|it| it.to.mm()).collect();
    let p = |x, y| [x, y, -50.0];
    assert_near(
        &bottoms,
        &[
            p(200., 50.),
            p(170.711, 120.711),
            p(100., 150.),
            p(29.289, 120.711),
            p(0., 50.),
        ],
    );
}

/// Fact C31 of `tests/model-facts.tsv`: a hole after each of four moves, and its retraction.
#[test]
fn a_modal_drill_by_macro() {
    let drill = "O9110\n#1=#4001\n#3=#4003\n#4=#4109\n#5=#5003\nG00 G90 Z#18\nG01 Z#26 F#9\nIF [#4010 EQ 98] GOTO 1\nG00 Z#18\nGOTO 2\nN1 G00 Z#5\nN2 G#1 G#3 F#4\nM99\n";
    for (code, back) in [(98, 50.0), (99, 5.0)] {
        let main = format!(
            "G92 X0 Y0 Z50.0\nG00 G90 G{code}\nG66 P9110 Z-20.0 R5.0 F500\nX20 Y20\nX50\nY50\nX70 Y80\nG67\nM30\n"
        );
        let (preview, moves) = run_program(&MillSetup::default(), &main, &[drill]);
        assert_eq!(preview.alarm, None);
        let down: Vec<_> = moves
            .iter()
            .filter(|it| it.kind == MillMoveKind::Feed)
            .collect();
        assert_eq!(down.len(), 4);
        assert!(
            down.iter()
                .all(|it| (it.from.mm()[2], it.to.mm()[2]) == (5.0, -20.0))
        );
        assert_eq!(preview.work.mm(), [70.0, 80.0, back]);
    }
}

/// Fact C30 of `tests/model-facts.tsv`, for the third axis: the zero of G54.1 P48.
#[test]
fn zeros_by_their_variables() {
    let (preview, _) = run_to_end("#7943=12.5\n#2501=-3\nG54.1 P48 G00 G90 X0 Y0 Z0\nM30\n");
    assert_eq!(preview.machine.mm(), [0.0, 0.0, 12.5]);
}

/// Facts C32 and C33 of `tests/model-facts.tsv`: M codes that call programs.
#[test]
fn m_codes_call_programs() {
    let setup = with(&[(6044, 2000), (6045, 300), (6046, 100)]);
    let subs: Vec<String> = [300, 301, 302, 399]
        .iter()
        .map(|number| format!("O0{number}\nG91 G00 X{number}\nM99\n"))
        .collect();
    let subs: Vec<&str> = subs.iter().map(String::as_str).collect();
    let (preview, moves) = run_program(&setup, "M2000\nM2001\nM2002\nM2099\nM30\n", &subs);
    assert_eq!(preview.alarm, None);
    let distance = |made: &MillMove| (made.to - made.from).mm()[0];
    assert_eq!(
        moves.iter().map(distance).collect::<Vec<_>>(),
        [300., 301., 302., 399.]
    );
    let beyond = with(&[(6044, 2000), (6045, 9901), (6046, 100)]);
    let (preview, _) = run_program(&beyond, "M2000\n", &subs);
    assert_eq!(preview.alarm.map(|it| it.number), Some(19));
    let (_, moves) = run_program(
        &setup,
        "M9005 X1 Y2\nM30\n",
        &["O9005\nG00 X[#24*10] Y#25\nM99\n"],
    );
    assert_near(&ends(&moves), &[[10., 2., 100.]]);
}

/// Fact C56 of `tests/model-facts.tsv`: 520.7 selects the turn of an angle.
#[test]
fn inverse_functions_by_parameter() {
    let text = "G00 X[ASIN[-1]] Y[ATAN[-1]/[1]] Z[ATAN[0-0]/[-1]]\nM30\n";
    let (preview, _) = run_program(&MillSetup::default(), text, &[]);
    assert_eq!(preview.work.mm(), [270.0, 315.0, 180.0]);
    let (preview, _) = run_program(&with(&[(520, 128)]), text, &[]);
    assert_eq!(preview.work.mm(), [-90.0, -45.0, 180.0]);
}
