//! The Huaxing lathes: zero offsets, increments, calls by blocks, cycles over the next blocks.

use super::InterpreterBench;
use crate::command::Action;
use crate::model::ModelId;

fn bench() -> InterpreterBench {
    InterpreterBench::at(100.0, 50.0).of_model(ModelId::Hx31)
}

/// Runs a program and returns for each move its line and the X (diameter) and Z of its end,
/// machine coordinates in mm.
fn trace_moves(text: &str) -> Vec<(u32, f64, f64)> {
    let mut bench = bench();
    bench.open(text);
    let (commands, alarm) = bench.run_to_end();
    assert_eq!(alarm, None, "{text}");
    let ends = commands.iter().filter_map(|command| match command.action {
        Action::Rapid { to } | Action::Line { to, .. } | Action::Arc { to, .. } => {
            Some((command.source.line, round(to.x * 2.0), round(to.z)))
        }
        _ => None,
    });
    ends.collect()
}

fn round(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

fn trace_lines(text: &str) -> Vec<u32> {
    trace_moves(text)
        .iter()
        .map(|move_data| move_data.0)
        .collect()
}

/// A corner also reads the block after it when G91 (increments) is in force.
#[test]
fn corners_under_increments() {
    let absolute = trace_moves("G01 Z40 R2 F100\nX120\nM02\n");
    let increments = trace_moves("G91 G01 Z-10 R2 F100\nX20\nM02\n");
    assert_eq!(
        absolute,
        [(1, 100.0, 42.0), (1, 104.0, 40.0), (2, 120.0, 40.0)]
    );
    assert_eq!(increments, absolute);
}

/// C54: G92 and G54 to G57 shift the displayed coordinates.
#[test]
fn zero_offsets() {
    let mut bench = bench();
    let mut shown = Vec::new();
    bench.open("G92 X100 Z50\nG55 X20 Z10\nG56 X5 Z5\nG57\nG57 X3 Z4\nG54\nM02\n");
    while let Ok(crate::interpreter::InterpreterStep::Command(command)) = bench.next() {
        if matches!(command.action, Action::Frame { .. }) {
            shown.push(bench.displayed_position());
        }
    }
    assert_eq!(
        shown,
        [
            (100.0, 50.0),
            (80.0, 40.0),
            (75.0, 35.0),
            (0.0, 0.0),
            (3.0, 4.0),
            (100.0, 50.0)
        ]
    );
}

#[test]
fn increments_are_modal() {
    let ends = trace_moves("G91 G00 X-20 Z-10\nX-5\nG90 X40 Z3\nU4 W-1\nM02\n");
    assert_eq!(
        ends,
        [
            (1, 80.0, 40.0),
            (2, 75.0, 40.0),
            (3, 40.0, 3.0),
            (4, 44.0, 2.0)
        ]
    );
}

/// C43: I of an arc is a difference of diameters, K a distance along Z.
#[test]
fn an_arc_has_i_as_a_diameter() {
    let mut bench = bench();
    let text = "G00 X70 Z0\nN0420 G03 X70 Z-40 I0 K-20 F100\nG02 X90 Z-30 I0 K10\nG02 X110 Z-30 I10 K0\nM02\n";
    bench.open(text);
    let (commands, alarm) = bench.run_to_end();
    assert_eq!(alarm, None);
    let centers: Vec<_> = commands
        .iter()
        .filter_map(|command| match command.action {
            Action::Arc { center, .. } => Some((round(center.x * 2.0), round(center.z))),
            _ => None,
        })
        .collect();
    assert_eq!(centers, [(70.0, -20.0), (70.0, -30.0), (100.0, -30.0)]);
}

#[test]
fn subprograms_are_in_the_same_file() {
    let text = "G20 N05 L3\nG20 N06.2\nM02\nG22 N05\nG00 X1\nG24\nG22 N06\nG00 X2\nG20 N05\nG24\n";
    assert_eq!(trace_lines(text), [5, 5, 5, 8, 5, 8, 5]);
    assert_eq!(bench().run_to_alarm("G20 N07\nM02\n"), (78, 1));
    assert_eq!(bench().run_to_alarm("G20\nM02\n").0, 76);
    let deep = "G20 N01\nM02\nG22 N01\nG20 N01\nG24\n";
    assert_eq!(bench().run_to_alarm(deep).0, 77);
}

#[test]
fn blocks_are_repeated() {
    let text = "N90 G00 X90\nN100 X80\nN140 X70\nN150 X60\nN160 G25 N100.140.3\nM02\n";
    // G25 continues after N140 and meets N150 and itself again: the loop never ends.
    let mut bench = bench();
    bench.open(text);
    let (commands, _) = bench.run_to_end();
    assert_eq!(commands.len(), 10_000);
    let ahead = "N10 G25 N100.140.3\nN20 G00 X99\nN100 X80\nN140 X70\nN150 X60\nM02\n";
    assert_eq!(trace_lines(ahead), [3, 4, 3, 4, 3, 4, 5]);
    let back = "N10 G26 N100.140.2\nN20 G00 X99\nN100 X80\nN140 X70\nM02\n";
    assert_eq!(trace_lines(back), [3, 4, 3, 4, 2, 3, 4]);
    let words = "N10 G26 N100 P140 L2\nN20 G00 X99\nN100 X80\nN140 X70\nM02\n";
    assert_eq!(trace_lines(words), trace_lines(back));
    assert_eq!(
        self::bench()
            .run_to_alarm("G25 N140.100.2\nN100 X1\nN140 X2\n")
            .0,
        78
    );
    assert_eq!(self::bench().run_to_alarm("G26 N7\nM02\n").0, 78);
}

#[test]
fn an_endless_loop_counts_a_part() {
    let mut bench = bench();
    bench.open("N10 G00 X90\nX80\nG27 N10\nM02\n");
    let (commands, _) = bench.run_to_end();
    assert_eq!(commands.len(), 10_000);
    let parts = commands
        .iter()
        .filter(|command| command.action == Action::Repeat);
    assert!(parts.count() > 1000);
}

/// C44: G72 over the next blocks makes ten passes, nine of 2 mm and one of 1.8 mm; then the
/// blocks run as ordinary ones.
#[test]
fn facing_by_the_next_blocks() {
    let text = "G00 X104 Z2\nG72 I2 K1 N3 X0.4 Z0.2 F100\nN30 G00 Z-18\nN40 G01 X60 F80\nN50 G01 X40 Z2\nM02\n";
    let ends = trace_moves(text);
    let mut levels: Vec<f64> = ends
        .iter()
        .filter(|(line, ..)| *line == 2)
        .map(|(_, _, z)| *z)
        .collect();
    levels.retain(|z| (z / 2.0).fract() == 0.0 && *z <= 0.0 || *z == -17.8);
    levels.dedup();
    assert_eq!(
        levels,
        [
            0.0, -2.0, -4.0, -6.0, -8.0, -10.0, -12.0, -14.0, -16.0, -17.8
        ]
    );
    let finish: Vec<_> = ends.iter().filter(|(line, ..)| *line > 2).collect();
    assert_eq!(
        finish,
        [&(3, 104.0, -18.0), &(4, 60.0, -18.0), &(5, 40.0, 2.0)]
    );
    // The tool is at A between the cycle and the contour.
    let last = ends.iter().rfind(|(line, ..)| *line == 2);
    assert_eq!(last, Some(&(2, 104.0, 2.0)));
}

#[test]
fn turning_by_the_next_blocks() {
    let text = "G00 X60 Z2\nG71 I7 K2 N3 X0.4 Z0.2 F100\nG00 X30\nG01 Z-20\nX60 Z-30\nM02\n";
    let ends = trace_moves(text);
    // I7 is 3.5 mm per side: X53, X46, X39, X32, then the contour at 30.4.
    for x in [53.0, 46.0, 39.0, 32.0, 30.4] {
        assert!(
            ends.iter().any(|(line, at, _)| *line == 2 && *at == x),
            "X{x}"
        );
    }
    assert!(!ends.iter().any(|(line, at, _)| *line == 2 && *at < 30.4));
    for wrong in [
        "G71 I7 K2 N1 F100\nG00 X30\nM02\n",
        "G71 I7 K2 N9 F100\nG00 X30\nM02\n",
    ] {
        assert!(matches!(bench().run_to_alarm(wrong).0, 61 | 63), "{wrong}");
    }
}

/// C45: pass p of 3 of a G73 is shifted by I(1 - p/3) plus the allowance X.
#[test]
fn a_closed_contour_by_the_next_blocks() {
    let text = "G00 X60 Z2\nG73 I12 K6 N2 L3 X0.4 Z0.2 F100\nG00 X30\nG01 Z-20\nM02\n";
    let ends = trace_moves(text);
    let cuts: Vec<_> = ends
        .iter()
        .filter(|(line, x, z)| *line == 2 && *z < -10.0 && *x < 50.0)
        .map(|(_, x, z)| (*x, *z))
        .collect();
    assert_eq!(cuts, [(38.4, -15.8), (34.4, -17.8), (30.4, -19.8)]);
}

#[test]
fn dwells_relays_and_tools() {
    let mut bench = bench();
    let text =
        "G04 K2\nG04 K0.01\nM20 K3\nM21 K17\nM71\nM85\nT1\nT32\nM24 K5\nG09 G01 X99 F100\nM02\n";
    let bare: Vec<String> = bench
        .trace(text)
        .iter()
        .map(|line| line.trim_end_matches(" |").to_owned())
        .collect();
    for expected in [
        "1: dwell 2000",
        "2: dwell 10",
        "3: outputs on 100 off 0 0ms",
        "4: outputs on 0 off 10000000000000000 0ms",
        "5: outputs on 1 off 0 100ms",
        "6: outputs on 100000000000000 off 0 100ms",
        "10: dwell 0",
    ] {
        assert!(
            bare.iter().any(|line| line == expected),
            "{expected} of {bare:?}"
        );
    }
    let tools: Vec<_> = bare.iter().filter(|line| line.contains(": T")).collect();
    assert_eq!(tools.len(), 3, "{bare:?}");
    for (wrong, number) in [
        ("T9", 32),
        ("T19", 32),
        ("M20 K18", 43),
        ("M20", 43),
        ("M24 K9", 43),
    ] {
        assert_eq!(
            self::bench().run_to_alarm(&format!("{wrong}\n")).0,
            number,
            "{wrong}"
        );
    }
}

/// Sequence numbers have up to five digits, at the beginning of a block and as a word of a code.
#[test]
fn block_numbers_have_five_digits() {
    let text = "N10010 G26 N70000.99999.2\nN10020 G27 N99998\nN70000 G91 G00 X1\n\
                N99999 Z1\nN99998 M02\n";
    assert_eq!(trace_lines(text), [3, 4, 3, 4]);
    assert_eq!(bench().run_to_alarm("G27 N65546\nN10 M02\n"), (78, 1));
    assert_eq!(bench().run_to_alarm("N100000 G00 X1\nM02\n"), (43, 1));
    assert_eq!(
        InterpreterBench::at(100.0, 50.0).run_to_alarm("N10000 G00 X1;\nM30;\n"),
        (43, 1)
    );
}

#[test]
fn codes_of_other_controls_are_not_there() {
    for foreign in ["G28", "G32", "G50", "G70", "G94", "M98"] {
        assert!(
            matches!(bench().run_to_alarm(&format!("{foreign}\n")).0, 10 | 19),
            "{foreign}"
        );
    }
}
