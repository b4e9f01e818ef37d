//! The order within a block, M codes, conflicts of G groups, and blocks that wait.

use super::InterpreterBench;
use crate::command::MotionCode;
use crate::interpreter::InterpreterStep;

#[test]
fn actions_of_a_block_keep_their_order() {
    let trace = InterpreterBench::new()
        .trace("G00 X100 M03 S600 T0101;\nM08;\nM05 G01 Z200 F100;\nX0 M30;");
    assert_eq!(
        trace,
        [
            "1: Speed(600.0)",
            "1: M03",
            "1: T0101",
            "1: frame X0 Z0 offset X0.04 Z0.02",
            "1: rapid X100.04 Z300 |",
            "2: M08 |",
            "3: M05",
            "3: line X100.04 Z200.02 F100 |",
            "4: line X0.04 Z200.02 F100",
            "4: end counts true m30 true |",
        ]
    );
}

#[test]
fn program_stop_keeps_the_modal_state() {
    let trace = InterpreterBench::new().trace("G01 F50 X10 M00;\nZ1;");
    assert_eq!(
        trace[..3],
        ["1: line X10 Z300 F50", "1: stop |", "2: line X10 Z1 F50 |"]
    );
}

#[test]
fn codes_the_control_does_not_have() {
    for (text, number) in [
        ("G05 X1;", 10),
        ("G02.5 X1;", 7),
        ("M06;", 19),
        ("M01;", 19),
        ("M61;", 19),
        ("G00 G04 X1;", 24),
        ("G28 G01 U0;", 24),
        ("M03 M08;", 18),
    ] {
        assert_eq!(
            InterpreterBench::new().run_to_alarm(text),
            (number, 1),
            "{text}"
        );
    }
}

#[test]
fn the_last_code_of_a_group_counts() {
    let trace = InterpreterBench::new().trace("G01 G00 X10 G99 G98;");
    assert_eq!(trace[0], "1: rapid X10 Z300 |");
}

#[test]
fn standard_output_codes() {
    for code in [3, 4, 5, 8, 9, 10, 11, 12, 13, 32, 33, 41, 42, 43, 44] {
        let trace = InterpreterBench::new().trace(&format!("M{code};"));
        assert_eq!(trace[0], format!("1: M{code:02} |"));
    }
    assert_eq!(
        InterpreterBench::new()
            .with_bit(164, 7, false)
            .run_to_alarm("M41;"),
        (19, 1)
    );
    assert_eq!(
        InterpreterBench::new()
            .with_bit(1, 4, false)
            .run_to_alarm("M41;"),
        (19, 1)
    );
}

#[test]
fn block_skip() {
    let text = "/G00 X10;\nZ10;";
    assert_eq!(
        InterpreterBench::new().trace(text)[0],
        "1: rapid X10 Z300 |"
    );
    let mut bench = InterpreterBench::new();
    bench.block_skip = true;
    assert_eq!(bench.trace(text)[0], "2: rapid X300 Z10 |");
}

#[test]
fn commands_hold_the_modal_state_after_the_block() {
    let mut bench = InterpreterBench::new();
    bench.open("G01 G99 X1 F0.2 T0102 S500 M03;");
    let (commands, _) = bench.run_to_end();
    let modal = commands[0].modal;
    assert_eq!(
        (modal.motion, modal.feed, modal.spindle),
        (MotionCode::Line, 0.2, 500.0)
    );
    assert_eq!((modal.tool, modal.offset, modal.m), (1, 2, Some(3)));
    assert!(modal.feed_per_revolution);
}

#[test]
fn some_blocks_wait_for_standstill() {
    for (text, waits) in [
        ("G00 X1;", false),
        ("G01 X1 F9;", false),
        ("G02 X301 R1 F9;", false),
        ("G90 X1 Z1 F9;", false),
        ("G99;", false),
        ("N10;", false),
        ("G04 P1;", true),
        ("G50 X1;", true),
        ("G28 U0;", true),
        ("M03;", true),
        ("S500;", true),
        ("T0101;", true),
        ("G96;", true),
        ("M98 P1 U0;", true),
        ("X1 M30;", true),
    ] {
        let mut bench = InterpreterBench::new();
        bench.programs.store("O1; M99;").unwrap();
        bench.open(text);
        bench.settled = false;
        assert_eq!(
            bench.next().unwrap() == InterpreterStep::Wait,
            waits,
            "{text}"
        );
    }
}

#[test]
fn reading_stops_at_a_program_stop() {
    let mut bench = InterpreterBench::new();
    bench.open("M00;\nG05;");
    assert!(matches!(bench.next(), Ok(InterpreterStep::Command(_))));
    bench.settled = false;
    assert_eq!(bench.next(), Ok(InterpreterStep::Wait));
    bench.settled = true;
    assert_eq!(bench.next().unwrap_err().number, 10);
}

#[test]
fn an_alarm_leaves_the_state_alone() {
    let mut bench = InterpreterBench::new();
    bench.open("G01 F50 X10;\nG03 G99 F3 S900 X20 T0101 R1;");
    let (commands, alarm) = bench.run_to_end();
    assert_eq!((commands.len(), alarm.unwrap().number), (1, 13));
    assert_eq!(*bench.interpreter.modal(), commands[0].modal);
    assert_eq!(bench.displayed_position(), (10.0, 300.0));
}

#[test]
fn alarms_name_the_sequence_number() {
    let mut bench = InterpreterBench::new();
    bench.open("N10 G00 X10;\n\nN30 G01 Z1;");
    let (_, alarm) = bench.run_to_end();
    let source = alarm.unwrap().source.unwrap();
    assert_eq!((source.line, source.sequence), (3, Some(30.into())));
}

#[test]
fn several_blocks_in_a_line() {
    let trace = InterpreterBench::new().trace("G00 X10; Z10; X20 Z20;");
    assert_eq!(
        trace[..3],
        [
            "1: rapid X10 Z300 |",
            "1: rapid X10 Z10 |",
            "1: rapid X20 Z20 |"
        ]
    );
}

#[test]
fn an_alarm_of_the_syntax_names_the_number_of_its_block() {
    let mut bench = InterpreterBench::new();
    bench.open("N10 G00 X10;\nN20 X1 X2;\n");
    let (_, alarm) = bench.run_to_end();
    let source = alarm.and_then(|alarm| alarm.source);
    assert_eq!(
        source.map(|source| (source.line, source.sequence)),
        Some((2, Some(20.into())))
    );
}
