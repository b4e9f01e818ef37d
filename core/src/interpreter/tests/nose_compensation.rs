//! G40, G41 and G42 in the stream of commands. `compensation/tests` tests the geometry.

use super::InterpreterBench;
use crate::command::{Action, ControlCommand};
use crate::interpreter::InterpreterStep;
use crate::memory::ToolOffset;
use crate::program::Program;
use crate::units::{Feed, Point};

/// A bench with nose radius compensation and two offsets without X and Z: 01 is R1 T3, 02 is
/// R2 T3.
fn bench(x: f64, z: f64) -> InterpreterBench {
    let mut bench = InterpreterBench::at(x, z).with_bit(2, 1, true);
    for number in [1, 2] {
        let nose = ToolOffset {
            r: f64::from(number),
            t: 3,
            ..ToolOffset::default()
        };
        bench.offsets.set(number, nose).unwrap();
    }
    bench
}

/// Runs `blocks` after a line `T0101 F100` and returns their commands as short texts, without
/// those of that line and of the end.
fn trace(bench: &mut InterpreterBench, blocks: &str) -> Vec<String> {
    let lines = bench.trace(&format!("T0101 F100\n{blocks}"));
    lines
        .into_iter()
        .filter(|line| !line.starts_with("1: ") && !line.contains(": end counts"))
        .collect()
}

fn fault(blocks: &str) -> (u16, u32) {
    bench(40.0, 10.0).run_to_alarm(&format!("T0101 F100\n{blocks}"))
}

fn next_command(bench: &mut InterpreterBench) -> ControlCommand {
    match bench.next() {
        Ok(InterpreterStep::Command(command)) => *command,
        other => panic!("{other:?}"),
    }
}

#[test]
fn compensation_is_an_option() {
    let mut bench = InterpreterBench::at(40.0, 10.0);
    assert_eq!(bench.run_to_alarm("G40\nG41"), (10, 2));
}

#[test]
fn single_block_stops_at_the_first_vector() {
    assert_eq!(
        trace(
            &mut bench(20.0, -10.0),
            "G42 G01 X40 Z0\nM08 Z-20\nG40 Z-25"
        ),
        [
            "2: line X36.586 Z-0.293 F100 |",
            "3: M08",
            "3: line X38 Z0.414 F100",
            "3: line X40 Z0 F100",
            "3: line X40 Z-21 F100 |",
            "4: line X40 Z-25 F100 |",
        ]
    );
}

#[test]
fn corner_moves_use_the_mode_of_the_next_block() {
    let lines = trace(
        &mut bench(20.0, -10.0),
        "G42 G01 X40 Z0 F50\nG00 Z-20\nG40 Z-25",
    );
    assert_eq!(
        lines[..3],
        [
            "2: line X36.586 Z-0.293 F50 |",
            "3: rapid X38 Z0.414",
            "3: rapid X40 Z0",
        ]
    );
}

#[test]
fn a_stop_ends_the_move_perpendicular() {
    for (stop, text) in [("M00", "stop |"), ("G04 P1\nM08", "dwell 1 |")] {
        let lines = trace(
            &mut bench(40.0, 10.0),
            &format!("G42 G01 Z5\nZ0\n{stop}\nX60\nG40 X70"),
        );
        assert_eq!(lines[1], "3: line X40 Z-1 F100 |");
        assert_eq!(lines[2], format!("4: {text}"));
        assert_eq!(lines[lines.len() - 2][3..], *"line X58 Z0 F100 |");
    }
    let alone = trace(&mut bench(40.0, 10.0), "G42 G01 Z5\nZ0\nM08\nX60\nG40 X70");
    assert_eq!(alone[1..3], ["3: line X40 Z0 F100 |", "4: M08 |"]);
}

#[test]
fn three_blocks_are_under_way_and_m00_ends_reading() {
    let mut bench = bench(40.0, 10.0);
    bench.open("T0101 F100\nG42 G01 Z5\nZ0\nS500 M03\nX60\nM00\nZ-20\nG40 Z-25");
    next_command(&mut bench);
    bench.settled = false;
    let mut reads = Vec::new();
    while let Ok(InterpreterStep::Command(command)) = bench.next() {
        let read = bench.interpreter.cursor().unwrap().line;
        reads.push((command.source.line, read));
    }
    // A move is given out when the next one is known. M, S and T are read early, M00 is not.
    assert_eq!(reads, [(2, 3), (3, 5), (4, 5), (4, 5), (5, 5)]);
    assert_eq!(bench.next(), Ok(InterpreterStep::Wait));
    assert_eq!(bench.machine, Point::new(29.0, 0.0));
    bench.settled = true;
    let (rest, alarm) = bench.run_to_end();
    assert_eq!((rest.len(), alarm), (4, None));
    assert_eq!(bench.machine, Point::new(30.0, -25.0));
}

#[test]
fn without_g41_nothing_is_read_ahead() {
    let mut bench = bench(40.0, 10.0);
    bench.open("T0101 F100\nG01 Z5\nZ0\nG42\nZ-5\nZ-10\nG40\nZ-15\nZ-20");
    let mut reads = Vec::new();
    while let Ok(InterpreterStep::Command(command)) = bench.next() {
        let read = bench.interpreter.cursor().unwrap().line;
        reads.push((command.source.line, read));
    }
    let lines = [
        (1, 1),
        (2, 2),
        (3, 3),
        (4, 4),
        (5, 6),
        (6, 8),
        (7, 8),
        (8, 8),
        (9, 9),
    ];
    assert_eq!(reads[..9], lines);
}

#[test]
fn calls_and_returns_need_cancelled_compensation() {
    let mut bench = bench(40.0, 10.0);
    bench
        .programs
        .store("O5; G42 G01 Z5; Z0; X60; G40 X70; M99;")
        .unwrap();
    bench.programs.store("O6; G42 G01 Z5; Z0; M99;").unwrap();
    bench.programs.store("O7; G42 G01 Z5; Z0;").unwrap();
    let lines = bench.trace("T0101 F100\nM98 P5\nM30");
    assert_eq!(lines[2], "1: line X40 Z0 F100 |");
    assert_eq!(lines.last().unwrap(), "3: end counts true m30 true |");
    bench.reset();
    for (text, line) in [
        ("M98 P6", 1),
        ("M98 P7", 1),
        ("G42 G01 Z5\nZ0\nM98 P5", 4),
        ("G42 G01 Z5 M98 P5", 2),
    ] {
        bench.machine = Point::new(20.0, 10.0);
        let alarm = bench.run_to_alarm(&format!("T0101 F100\n{text}"));
        assert_eq!(alarm, (36, line), "{text}");
        bench.reset();
    }
    // The move that cancels may call, and the main program may start again.
    bench.machine = Point::new(20.0, 10.0);
    assert!(
        !trace(&mut bench, "G42 G01 Z5\nZ0\nG40 X50 M98 P5\nM30")
            .iter()
            .any(|line| line.contains("alarm"))
    );
    bench.reset();
    bench.open("T0101 F100\nG42 G01 U-1 W-1\nM99");
    for _ in 0..20 {
        next_command(&mut bench);
    }
}

#[test]
fn a_new_nose_acts_from_the_end_of_its_block() {
    let lines = trace(
        &mut bench(40.0, 10.0),
        "G42 G01 Z5\nZ0\nX60 T0102\nZ-20\nG40 Z-25",
    );
    assert_eq!(
        lines[1..],
        [
            "3: line X40 Z0 F100 |",
            "4: T0102",
            "4: line X60 Z0 F100 |",
            "5: line X60 Z-22 F100 |",
            "6: line X60 Z-25 F100 |",
        ]
    );
}

#[test]
fn an_offset_is_travelled_with_its_vector() {
    let mut bench = bench(40.0, 10.0).with_bit(3, 4, false);
    let mut row = bench.offsets.get(2);
    (row.x, row.z, row.r) = (0.4, 0.2, 1.0);
    bench.offsets.set(2, row).unwrap();
    let lines = trace(&mut bench, "G42 G01 Z5\nZ0\nT0102\nX60\nZ-20\nG40 Z-25");
    assert_eq!(
        lines[1..],
        [
            "3: line X40 Z0 F100 |",
            "4: T0102",
            "4: frame X0 Z0 offset X0.4 Z0.2",
            "4: rapid X40.4 Z0.2 |",
            "5: line X60.4 Z0.2 F100 |",
            "6: line X60.4 Z-20.8 F100 |",
            "7: line X60.4 Z-24.8 F100 |",
        ]
    );
}

#[test]
fn offset_number_00_disables_compensation() {
    let lines = bench(40.0, 10.0).trace("F100\nG42 G01 Z5\nZ0\nT0101\nX60\nZ-20\nG40 Z-25\nM30");
    assert_eq!(
        lines[1..],
        [
            "2: line X40 Z5 F100 |",
            "3: line X40 Z0 F100 |",
            "4: T0101 |",
            "5: line X58 Z0 F100 |",
            "6: line X60 Z0 F100",
            "6: line X60 Z-21 F100 |",
            "7: line X60 Z-25 F100 |",
            "8: end counts true m30 true |",
        ]
    );
}

#[test]
fn the_side_changes_one_block_after_the_start_up() {
    let lines = trace(&mut bench(40.0, 10.0), "G42 G01 Z5\nG41 Z0\nX60\nG40 X70");
    assert_eq!(
        lines[..2],
        ["2: line X40 Z4 F100 |", "3: line X40 Z-2 F100 |"]
    );
}

#[test]
fn threads_g28_and_cycles_run_uncompensated() {
    let lines = trace(
        &mut bench(40.0, 10.0),
        "G42 G01 Z5\nZ0\nG32 Z-10 F1\nG01 Z-20\nG40 Z-25",
    );
    assert_eq!(lines[1], "3: line X40 Z0 F100 |");
    assert!(lines[2].starts_with("4: thread X40 Z-10"), "{lines:?}");
    assert_eq!(
        lines[3..],
        ["5: line X40 Z-21 F100 |", "6: line X40 Z-25 F100 |"]
    );
    let lines = trace(
        &mut bench(40.0, 10.0),
        "G42 G01 Z5\nZ0\nG28 U0 W0\nG01 Z-20\nZ-30\nG40 Z-35",
    );
    assert_eq!(
        lines[1..],
        [
            "3: line X40 Z0 F100 |",
            "4: rapid X40 Z0 |",
            "4: rapid X0 Z0",
            "4: referenced true true |",
            "5: line X0 Z-21 F100 |",
            "6: line X0 Z-31 F100 |",
            "7: line X0 Z-35 F100 |",
        ]
    );
    let lines = trace(
        &mut bench(40.0, 10.0),
        "G42 G01 Z5\nZ0\nG75 R0.5\nG75 X36 P1000\nG01 Z-20\nG40 Z-25",
    );
    let ends = (lines[1].as_str(), lines[lines.len() - 2].as_str());
    assert_eq!(ends, ("3: line X40 Z0 F100 |", "6: line X40 Z-21 F100 |"));
}

#[test]
fn g70_compensates_the_profile() {
    let lines = trace(
        &mut bench(40.0, 10.0),
        "G42 G00 X40 Z5\nG70 P10 Q20\nG40 G00 X60\nM30\nN10 G01 Z0\nX60\nN20 Z-20",
    );
    let moves: Vec<_> = lines
        .iter()
        .filter(|line| line.contains("line") || line.contains("rapid"))
        .map(String::as_str)
        .collect();
    assert_eq!(
        moves[..4],
        [
            "2: rapid X40 Z4 |",
            "6: line X40 Z0 F100 |",
            "7: line X60 Z0 F100 |",
            "8: line X60 Z-21 F100 |",
        ]
    );
}

#[test]
fn alarms_name_their_blocks() {
    let arc = |words: &str| fault(&format!("G42 G01 Z5\nZ0\nG02 X60 Z-10 {words}"));
    assert_eq!(arc("I10 K0.05"), (48, 4));
    assert_eq!(arc("I0 K0"), (51, 4));
    assert_eq!(arc("I10 K-10"), (52, 4));
    assert_eq!(fault("G42 G01 Z5\nZ0\nZ0"), (50, 4));
    assert_eq!(fault("G42\nG02 X60 Z0 R10"), (34, 3));
    assert_eq!(fault("G42 G01 Z5\nZ0\nG40\nG02 X60 Z-10 R10"), (56, 5));
    // Arc data without compensation: alarm 013, and the centre moves.
    assert_eq!(fault("G02 X60 Z-10 I0 K0"), (13, 2));
}

#[test]
fn an_alarm_stops_the_tool_at_a_defined_point() {
    // Between two moves: at the start of the first one.
    let stop_position = |blocks: &str| {
        let mut bench = bench(40.0, 10.0);
        trace(&mut bench, blocks);
        (bench.machine.diameter().0, bench.machine.z)
    };
    assert_eq!(stop_position("G42 G01 Z5\nZ0\nZ0"), (40.0, 4.0));
    assert_eq!(
        stop_position("G42 G01 Z5\nZ0\nG02 X60 Z-10 I0 K0"),
        (40.0, 4.0)
    );
    assert_eq!(
        stop_position("G42 G01 Z5\nZ0\nG02 X41 Z-0.5 R0.5"),
        (40.0, 4.0)
    );
    // At the start of a block: the previous block is carried out.
    assert_eq!(
        stop_position("G42 G01 Z5\nZ0\nG02 X60 Z-10 I10 K0.05"),
        (40.0, -1.0)
    );
    assert_eq!(stop_position("G42 G01 Z5\nZ0\nM98 P9"), (40.0, -1.0));
    assert_eq!(stop_position("G42 G02 X60 Z0 R10"), (40.0, 10.0));
    // After the moves round the corner.
    assert_eq!(
        stop_position("G42 G01 Z5\nZ0\nX20 Z10\nX20 Z10"),
        (38.0, -2.414)
    );
}

#[test]
fn mdi_runs_uncompensated_and_moves_the_vectors() {
    let mut bench = bench(40.0, 10.0);
    bench.open("T0101 F100\nG42 G01 X40 Z5\nX40 Z0\nX60 Z0\nX60 Z-20\nG40 Z-25");
    while next_command(&mut bench).source.line < 3 {}
    assert_eq!(bench.machine, Point::new(20.0, 0.0));
    let (interpreter, world) = bench.split_for_run();
    interpreter.start_mdi(Program::new("G01 X50 Z5"), &world);
    let command = next_command(&mut bench);
    assert_eq!(
        command.action,
        Action::Line {
            to: Point::new(25.0, 5.0),
            feed: Feed::PerMinute(100.0),
        }
    );
    assert_eq!(bench.next(), Ok(InterpreterStep::Ended));
    let (commands, alarm) = bench.run_to_end();
    assert_eq!(alarm, None);
    let lines: Vec<_> = commands
        .iter()
        .map(|command| bench.describe(command))
        .collect();
    assert_eq!(
        lines,
        [
            "4: line X60 Z-0.586 F100 |",
            "5: line X60 Z-21 F100 |",
            "6: line X60 Z-25 F100 |",
            "6: end counts false m30 false",
        ]
    );
}

#[test]
fn reset_drops_the_vector() {
    let mut bench = bench(40.0, 10.0);
    bench.open("T0101 F100\nG42 G01 X40 Z5\nX40 Z0\nX60 Z0\nX60 Z-20");
    while next_command(&mut bench).source.line < 4 {}
    bench.reset();
    assert_eq!(bench.interpreter.modal().nose_compensation, 40);
    assert_eq!(bench.displayed_position(), (60.0, 0.0));
    bench.open("G01 F100 Z-5");
    assert_eq!(bench.run_to_end().1, None);
    assert_eq!(bench.machine, Point::new(30.0, -5.0));
}

/// Runs `blocks` from X40 Z10 and returns their commands as short texts, without line numbers.
fn trace_path(blocks: &str) -> Vec<String> {
    trace(&mut bench(40.0, 10.0), blocks)
        .iter()
        .filter_map(|line| line.split_once(": "))
        .map(|(_, step)| step.trim_end_matches(" |").to_owned())
        .collect()
}

#[test]
fn chamfers_and_corner_arcs_are_two_moves() {
    for (short, long) in [
        (
            "G42 G00 X40 Z2\nG01 Z-20 I5\nX60 K-3\nZ-40\nG40 G00 X80",
            "G42 G00 X40 Z2\nG01 Z-15\nX50 Z-20\nX54\nX60 Z-23\nZ-40\nG40 G00 X80",
        ),
        (
            "G42 G00 X40 Z2\nG01 Z-20 R5\nX60 R-3\nZ-40\nG40 G00 X80",
            "G42 G00 X40 Z2\nG01 Z-15\nG02 X50 Z-20 R5\nG01 X54\nG03 X60 Z-23 R3\n\
             G01 Z-40\nG40 G00 X80",
        ),
        // In the moves that start and cancel the compensation.
        (
            "G42 G01 Z-20 I5\nX60\nZ-40 I4\nG40 X80",
            "G42 G01 Z-15\nX50 Z-20\nX60\nZ-36\nX68 Z-40\nG40 X80",
        ),
        (
            "G42 G01 Z-20\nG40 X60 R-3\nZ-40",
            "G42 G01 Z-20\nG40 X54\nG03 X60 Z-23 R3\nG01 Z-40",
        ),
    ] {
        assert_eq!(trace_path(short), trace_path(long), "{short}");
    }
}

#[test]
fn a_corner_arc_alone_cannot_start_compensation() {
    assert_eq!(fault("G42 G01 Z5 R5\nX60"), (34, 2));
}

#[test]
fn a_corner_arc_smaller_than_the_nose_is_an_alarm() {
    // The nose does not fit into the inner corner from the face down to the cylinder.
    assert_eq!(fault("G41 G00 X60 Z2\nG01 Z-20 R-0.5\nX20\nG40 X10").0, 53);
}
