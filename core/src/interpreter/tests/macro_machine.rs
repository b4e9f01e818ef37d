//! Macro B: system variables of the machine, and codes that call by parameters.

use super::InterpreterBench;
use crate::memory::{DayTime, Registers, ToolOffset};
use crate::model::{ControlModel, ModelId};
use crate::program::MdiBlock;

fn bench() -> InterpreterBench {
    let mut bench = InterpreterBench::new();
    bench.interpreter.set_macro_b(true);
    bench
}

/// Runs a program that must end without an alarm.
fn run(bench: &mut InterpreterBench, text: &str) {
    bench.open(text);
    let (_, alarm) = bench.run_to_end();
    assert_eq!(alarm, None, "{text}");
}

fn fault(text: &str) -> (u16, u32) {
    bench().run_to_alarm(text)
}

#[test]
fn offsets_are_read_and_written() {
    let mut bench = bench();
    let row = ToolOffset {
        x: 1.5,
        z: -2.25,
        r: 0.8,
        t: 3,
    };
    bench.offsets.set(32, row).unwrap();
    let text = "#100=#2032;\n#101=#2132;\n#102=#2232;\n#103=#2332;\n\
                #2001=#2001-0.01;\n#2101=-5;\n#2201=0.4;\n#2301=2;\n";
    run(&mut bench, text);
    let read = [100, 101, 102, 103].map(|number| bench.variables.real_value(number));
    assert_eq!(read, [Some(1.5), Some(-2.25), Some(0.8), Some(3.0)]);
    let written = ToolOffset {
        x: 0.03,
        z: -5.0,
        r: 0.4,
        t: 2,
    };
    assert_eq!(bench.offsets.get(1), written);
}

/// An offset that a macro writes takes effect with the next T word.
#[test]
fn a_written_offset_takes_effect_with_the_next_t() {
    let trace = bench().trace("T0101;\nG00 X100 Z50;\n#2001=2;\nX100;\nT0101;\nX100;\n");
    let last = "6: rapid X102 Z50.02 |";
    assert!(trace.iter().any(|line| line == last), "{trace:?}");
    let before: Vec<_> = trace.iter().filter(|line| line.starts_with("4:")).collect();
    assert!(
        before.iter().all(|line| line.contains("X100.04")),
        "{trace:?}"
    );
}

#[test]
fn invalid_offsets_and_values_raise_alarms() {
    assert_eq!(fault("#100=#2000;"), (115, 1));
    assert_eq!(fault("#100=#2033;"), (115, 1));
    assert_eq!(fault("#2033=1;"), (115, 1));
    assert_eq!(fault("#2001=10000;"), (43, 1));
    assert_eq!(fault("#2301=10;"), (43, 1));
    assert_eq!(fault("#2301=-1;"), (111, 1));
    // Row 000 needs 012.6.
    assert_eq!(fault("#2500=1;"), (115, 1));
    let mut bench = bench().with_bit(12, 6, true);
    run(&mut bench, "#2500=4;\n#2600=-1;\n#100=#2500+#2600;");
    assert_eq!(bench.variables.real_value(100), Some(3.0));
    assert_eq!(
        (bench.offsets.get(0).x, bench.offsets.get(0).z),
        (4.0, -1.0)
    );
}

/// C29, C52: #3011 and #3012 read date and time, #3001 and #3002 the timers.
#[test]
fn programs_read_clock_and_timers() {
    let mut bench = bench();
    let moment = DayTime::from_text("1993-03-28 15:34:56").unwrap();
    bench.registers = Registers::new(moment);
    bench.now_ms = 4000;
    bench.counters.started_ms = 5_400_000;
    run(
        &mut bench,
        "#100=#3011;\n#101=#3012;\n#102=#3001;\n#103=#3002;\n#3001=65535;",
    );
    let read = [100, 101, 102, 103].map(|number| bench.variables.real_value(number));
    let expected = [19_930_328.0, 153_500.0, 4000.0, 1.5].map(Some);
    assert_eq!(read, expected);
    bench.now_ms += 16;
    run(&mut bench, "#100=#3001;\n#3002=2.25;");
    assert_eq!(bench.variables.real_value(100), Some(0.0));
    assert_eq!(bench.counters.started_ms, 8_100_000);
    assert_eq!(fault("#3011=1;"), (116, 1));
    assert_eq!(fault("#3012=1;"), (116, 1));
    assert_eq!(fault("#3001=65536;"), (111, 1));
    assert_eq!(fault("#3002=1145324.7;"), (111, 1));
    assert_eq!(fault("#3002=-1;"), (111, 1));
}

/// A block with a value that the machine changes waits until every earlier command is
/// finished.
#[test]
fn values_of_the_machine_wait_until_it_is_idle() {
    for text in ["#100=#3001;", "#100=#3901;", "#3003=1;", "#2001=1;"] {
        let mut bench = bench();
        bench.settled = false;
        bench.open(text);
        assert!(
            matches!(bench.next(), Ok(super::InterpreterStep::Wait)),
            "{text}"
        );
    }
}

#[test]
fn counters_and_switches() {
    let mut bench = bench();
    bench.counters.parts = 41;
    run(
        &mut bench,
        "#3901=#3901+1;\n#3902=100;\n#100=#3902-#3901;\n#3003=3;\n#3004=5;\n#101=#3003*10+#3004;",
    );
    assert_eq!(bench.variables.real_value(100), Some(58.0));
    assert_eq!((bench.counters.parts, bench.counters.required), (42, 100));
    assert_eq!(bench.variables.real_value(101), Some(35.0));
    for text in [
        "#3003=4;",
        "#3004=8;",
        "#3901=10000;",
        "#3902=-1;",
        "#3005=1024;",
    ] {
        assert_eq!(fault(text), (111, 1), "{text}");
    }
    assert_eq!(fault("#100=#3006;"), (115, 1));
    assert_eq!(fault("#3006=1;"), (115, 1));
}

/// Bit 4 of #3005 switches inch input on, from the next block on.
#[test]
fn settings_are_bits() {
    let mut bench = bench();
    let trace = bench.trace("#100=#3005;\n#3005=#3005 OR 16;\nG00 X1.0 Z2.0;\n");
    // The default of ISO code is on.
    assert_eq!(bench.variables.real_value(100), Some(8.0));
    assert!(bench.settings.inch && bench.settings.iso);
    assert_eq!(trace[2], "3: rapid X25.4 Z50.8 |");
}

fn bench_with_calls(parameters: &[(u16, i32)], programs: &[&str]) -> InterpreterBench {
    let mut bench = bench();
    let mut model = ControlModel::new(ModelId::Gsk980td);
    for (number, value) in parameters {
        model.set_parameter(*number, *value).unwrap();
    }
    bench.interpreter.set_model(&model);
    for program in programs {
        bench.programs.store(*program).unwrap();
    }
    bench
}

#[test]
fn a_g_code_calls_with_arguments() {
    let mut bench = bench_with_calls(
        &[(221, 81), (220, 1)],
        &["O9011;\n#100=#100+#1+#2;\n#101=#24;\nM99;"],
    );
    run(&mut bench, "/N10 G81 A1.5 B#102 X20 L3;\nM30;");
    // 1.5 and null, three times.
    assert_eq!(bench.variables.real_value(100), Some(4.5));
    assert_eq!(bench.variables.real_value(101), Some(20.0));
}

/// In a macro that a G code calls, no code calls a program: G01 cuts.
#[test]
fn a_g_code_redefines_one_of_the_control() {
    let mut bench = bench_with_calls(&[(220, 1)], &["O9010;\nG01 Z-#26 F100;\nM99;"]);
    let trace = bench.trace("G00 X50 Z2;\nG1 Z5;\n");
    assert!(trace.iter().any(|line| line.contains("Z-5")), "{trace:?}");
}

#[test]
fn m_codes_call() {
    let mut bench = bench_with_calls(
        &[(230, 70), (240, 71)],
        &[
            "O9020;\n#100=#1;\nM99;",
            "O9001;\n#101=#101+1;\nG00 X[10*#101];\nM70;\nM99;",
        ],
    );
    run(&mut bench, "M70 A2;\nM30;");
    assert_eq!(bench.variables.real_value(100), Some(2.0));
    // A block of M71 moves first, then O9001 runs L times. In it M70 is an ordinary code,
    // which the control does not have.
    bench.open("G00 Z7 M71 L2;\nM30;");
    let (commands, alarm) = bench.run_to_end();
    assert_eq!(alarm.map(|alarm| alarm.number), Some(19));
    assert!(commands.len() >= 2);
    assert_eq!(bench.machine.z, 7.0);
    assert_eq!(bench.variables.real_value(101), Some(1.0));
}

#[test]
fn t_calls() {
    let mut bench = bench_with_calls(&[(243, 1)], &["O9000;\n#100=#149;\nT#149;\nM99;"]);
    let trace = bench.trace("G00 X100 Z100;\nT0202;\nX100;\n");
    assert_eq!(bench.variables.real_value(100), Some(202.0));
    assert!(
        trace
            .iter()
            .any(|line| line.starts_with("3:") && line.contains("T02")),
        "{trace:?}"
    );
}

#[test]
fn wrong_calls_raise_alarms() {
    let fault = |text: &str| {
        bench_with_calls(&[(220, 81), (240, 71)], &["O9010;\nM99;"]).run_to_alarm(text)
    };
    assert_eq!(fault("G81 P9010;"), (129, 1));
    assert_eq!(fault("G81 A1 G01;"), (129, 1));
    assert_eq!(fault("G81 L10000;"), (43, 1));
    assert_eq!(fault("M71;"), (78, 1));
    assert_eq!(fault("M71 L0;"), (43, 1));
    // Without the option the code has its ordinary meaning.
    let mut bench = bench_with_calls(&[(220, 81)], &["O9010;\nM99;"]);
    bench.interpreter.set_macro_b(false);
    assert_eq!(bench.run_to_alarm("G81 X1;"), (10, 1));
    // Four macros may be nested.
    let nested = bench_with_calls(&[(230, 70)], &["O9020;\nM70;\nM99;"]).run_to_alarm("M70;");
    assert_eq!(nested.0, 77);
}

/// Blocks with statements and formulas run from the MDI page.
#[test]
fn statements_run_from_the_mdi_page() {
    let mut bench = bench();
    let mut mdi = MdiBlock::default();
    let mut enter = |bench: &mut InterpreterBench, words: &[&str]| {
        mdi.clear();
        for word in words {
            mdi.enter(word, &bench.parameters, true).unwrap();
        }
        bench.mdi(&mdi.text());
        let (_, alarm) = bench.run_to_end();
        (
            mdi.statement().map(str::to_owned),
            alarm.map(|it| it.number),
        )
    };
    let statement = "#100=SIN[30]*40".to_owned();
    // The statement replaces a word that was keyed in before.
    assert_eq!(
        enter(&mut bench, &["X5", "#100=sin[30]*40;"]),
        (Some(statement), None)
    );
    assert_eq!(bench.variables.real_value(100), Some(20.0));
    assert_eq!(
        enter(&mut bench, &["G00 X[#100+SQRT[4]]", "Z#100"]),
        (None, None)
    );
    assert_eq!((bench.machine.x, bench.machine.z), (11.0, 20.0));
    let (_, alarm) = enter(&mut bench, &["IF[#100EQ20]THEN#101=7"]);
    assert_eq!((alarm, bench.variables.real_value(101)), (None, Some(7.0)));
    assert_eq!(enter(&mut bench, &["G65 P9010"]).1, Some(10));
    assert_eq!(enter(&mut bench, &["G66 P9010"]).1, Some(10));
    assert_eq!(enter(&mut bench, &["GOTO5"]).1, Some(128));
    // G65 H consists of words, and a word replaces a statement.
    assert_eq!(
        enter(&mut bench, &["#100=1", "G65", "H1", "P#200", "Q7"]).0,
        None
    );
    assert_eq!(bench.variables.get(200), Some(7));
    let mut mdi = MdiBlock::default();
    let mut fault = |text| mdi.enter(text, &bench.parameters, true).unwrap_err().number;
    assert_eq!(
        (fault("#100=1+"), fault("X[1"), fault("G01#100=1")),
        (114, 114, 127)
    );
    let mut mdi = MdiBlock::default();
    let without = mdi.enter("#100=1", &bench.parameters, false);
    assert!(without.is_err() && mdi.is_empty());
}

/// The Huaxing lathes have #1 to #99, values and formulas, and no other statements.
#[test]
fn variables_of_the_huaxing_lathes() {
    let bench = || InterpreterBench::new().of_model(ModelId::Hx31);
    let mut huaxing_bench = bench();
    let trace =
        huaxing_bench.trace("#99=12.5;\n#1=#99*2;\nG00 X#1 Z[#1-#99];\n#2=#0;\nG00 X#2 Z1;\n");
    assert_eq!(trace[2], "3: rapid X25 Z12.5 |");
    assert_eq!(trace[4], "5: rapid X25 Z1 |");
    assert_eq!(huaxing_bench.variables.huaxing_value(99), Some(12.5));
    for text in [
        "#100=1;",
        "#1=#100;",
        "G00 X#100;",
        "G00 X#200;",
        "G00 X#500;",
        "#1=#5001;",
    ] {
        assert_eq!(bench().run_to_alarm(text), (115, 1), "{text}");
    }
    assert_eq!(bench().run_to_alarm("#0=1;"), (116, 1));
    assert_eq!(bench().run_to_alarm("#1=1/0;"), (112, 1));
    for text in ["IF[1EQ1]GOTO5;", "GOTO5;", "WHILE[1EQ1]DO1;", "G65 P9010;"] {
        let (number, line) = bench().run_to_alarm(text);
        assert!(matches!(number, 10 | 114) && line == 1, "{text}: {number}");
    }
    let mut option = bench();
    option.interpreter.set_macro_b(true);
    assert_eq!(option.run_to_alarm("#100=1;"), (115, 1));
}
