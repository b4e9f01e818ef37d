//! Subprograms, ends of programs, repetition and MDI.

use super::InterpreterBench;
use crate::command::{Action, ProgramId};
use crate::interpreter::InterpreterStep;
use crate::program::Program;

fn bench(programs: &[&str]) -> InterpreterBench {
    let mut bench = InterpreterBench::at(0.0, 0.0);
    for text in programs {
        bench.programs.store(*text).unwrap();
    }
    bench
}

#[test]
fn calls_repeat() {
    let mut bench = bench(&["O1002; U1; M99;"]);
    let trace = bench.trace("M98 P51002;\nM98 P1002;\nW1 M98 P1002;\nM30;");
    assert_eq!(trace.len(), 9);
    assert_eq!(bench.displayed_position(), (7.0, 1.0));
    assert_eq!(trace[6], "3: rapid X6 Z1 |");
    assert_eq!(trace[8], "4: end counts true m30 true |");
}

#[test]
fn motion_comes_before_the_call_and_the_return() {
    let mut bench = bench(&["O2; U10 M99;"]);
    let trace = bench.trace("W5 M98 P2;\nU1;");
    assert_eq!(
        trace[..3],
        ["1: rapid X0 Z5 |", "1: rapid X10 Z5 |", "2: rapid X11 Z5 |"]
    );
}

#[test]
fn calls_are_nested_four_levels_at_most() {
    let mut programs: Vec<String> = (1..5)
        .map(|n| format!("O{n}; U1; M98 P{}; M99;", n + 1))
        .collect();
    programs.push("O5; U1; M99;".into());
    let texts: Vec<_> = programs.iter().map(String::as_str).collect();
    let mut bench = bench(&texts);
    assert_eq!(bench.run_to_alarm("M98 P2;\nM98 P1;"), (77, 1));
    assert_eq!(bench.displayed_position(), (8.0, 0.0));
    let source = bench.interpreter.cursor().unwrap();
    assert_eq!(
        (source.program, bench.interpreter.call_depth()),
        (ProgramId::Stored(4), 4)
    );
}

#[test]
fn returns_to_a_sequence_number() {
    let mut bench = bench(&["O7; U1; M99 P30;", "O8; M99 P31;"]);
    bench.trace("M98 P7;\nU100;\nN30 W1;");
    assert_eq!(bench.displayed_position(), (1.0, 1.0));
    assert_eq!(bench.run_to_alarm("M98 P8;\nN30;"), (78, 1));
}

#[test]
fn call_faults() {
    assert_eq!(InterpreterBench::new().run_to_alarm("\nM98;"), (76, 2));
    assert_eq!(InterpreterBench::new().run_to_alarm("M98 P1234;"), (78, 1));
    assert_eq!(InterpreterBench::new().run_to_alarm("M99 P5;"), (78, 1));
}

#[test]
fn a_main_program_repeats() {
    let mut bench = bench(&[]);
    bench.open("U1;\nM99;");
    let actions: Vec<_> = (0..6)
        .map(|_| match bench.next().unwrap() {
            InterpreterStep::Command(command) => (command.action, command.stop_point),
            step => panic!("{step:?}"),
        })
        .collect();
    assert_eq!(actions[1], (Action::Repeat, false));
    assert_eq!(actions[5], (Action::Repeat, false));
    assert_eq!(bench.displayed_position(), (3.0, 0.0));
}

#[test]
fn a_jump_forward_counts_no_part() {
    let mut bench = bench(&[]);
    let trace = bench.trace("M99 P20;\nU100;\nN20 W1;");
    assert_eq!(trace, ["3: rapid X0 Z1 |", "3: end counts false m30 false"]);
}

#[test]
fn texts_can_end_without_m30() {
    let mut bench = bench(&["O9; U1;"]);
    let trace = bench.trace("M98 P20009;\nW1;");
    assert_eq!(bench.displayed_position(), (2.0, 1.0));
    assert_eq!(trace[3], "2: end counts false m30 false");
    assert_eq!(bench.next(), Ok(InterpreterStep::Ended));
}

#[test]
fn silent_loops_do_not_delay_a_tick() {
    let mut bench = bench(&["O10; M99;"]);
    bench.open("M98 P99990010;\nM99;");
    for _ in 0..100 {
        let InterpreterStep::Command(command) = bench.next().unwrap() else {
            panic!("no command")
        };
        assert_eq!(
            (command.action, command.stop_point),
            (Action::Nothing, false)
        );
    }
}

#[test]
fn program_names_are_not_a_stop() {
    let trace = bench(&[]).trace("O0001;\nU1;");
    assert_eq!(trace[0], "2: rapid X1 Z0 |");
}

#[test]
fn starts_at_any_line() {
    let mut bench = bench(&[]);
    bench.open("U100;\nU10;\nU1;");
    let (interpreter, world) = bench.split_for_run();
    interpreter.start(ProgramId::External, 2, &world);
    bench.run_to_end();
    assert_eq!(bench.displayed_position(), (11.0, 0.0));
}

#[test]
fn an_mdi_block_is_a_separate_run() {
    let mut bench = bench(&["O11; M99;"]);
    bench.open("G00 U1;\nU1;");
    bench.next().unwrap();
    let keyed = |bench: &mut InterpreterBench, text: &str| {
        let (interpreter, world) = bench.split_for_run();
        interpreter.start_mdi(Program::new(text), &world);
    };
    keyed(&mut bench, "W5");
    let InterpreterStep::Command(command) = bench.next().unwrap() else {
        panic!("no command")
    };
    assert_eq!(command.source.program, ProgramId::Mdi);
    assert_eq!(bench.next(), Ok(InterpreterStep::Ended));
    // The automatic run continues at its position.
    bench.next().unwrap();
    assert_eq!(bench.displayed_position(), (2.0, 5.0));
    for text in ["M98 P11", "M99"] {
        keyed(&mut bench, text);
        assert_eq!(bench.next().unwrap_err().number, 19);
    }
}

#[test]
fn manual_motion_updates_the_position() {
    let mut bench = bench(&[]);
    bench.open("X10;\nW1;");
    bench.next().unwrap();
    bench.machine.z = -7.0;
    let (interpreter, world) = bench.split_for_run();
    interpreter.resync(&world);
    bench.run_to_end();
    assert_eq!(bench.displayed_position(), (10.0, -6.0));
}
