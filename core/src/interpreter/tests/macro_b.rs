//! Macro B: formulas, variables, jumps, loops, calls with arguments.

use super::InterpreterBench;
use crate::memory::ToolOffset;
use crate::program::Program;

fn bench() -> InterpreterBench {
    let mut bench = InterpreterBench::new();
    bench.interpreter.set_macro_b(true);
    bench
}

/// Runs a program that must end without an alarm, and returns the value of #100; `None` for
/// null.
fn run_result(text: &str) -> Option<f64> {
    let mut bench = bench();
    bench.open(text);
    let (_, alarm) = bench.run_to_end();
    assert_eq!(alarm, None, "{text}");
    bench.variables.real_value(100)
}

fn evaluate(formula: &str) -> f64 {
    run_result(&format!("#100={formula};")).unwrap_or_else(|| panic!("null: {formula}"))
}

fn fault(text: &str) -> (u16, u32) {
    bench().run_to_alarm(text)
}

#[test]
fn formulas() {
    for (formula, expected) in [
        ("1+2*3", 7.0),
        ("[1+2]*3", 9.0),
        ("2*3+4*5", 26.0),
        ("10-4-3", 3.0),
        ("100/10/5", 2.0),
        ("-3*-2", 6.0),
        ("7MOD3", 1.0),
        ("-7 MOD 3", -1.0),
        ("12 AND 10", 8.0),
        ("12 OR 3", 15.0),
        ("12 XOR 10", 6.0),
        ("1 OR 2 AND 0", 1.0),
        ("SIN[30]", 0.5),
        ("COS[60]", 0.5),
        ("TAN[45]", 1.0),
        ("ATAN[1]/[-1]", 135.0),
        ("ATAN[-1]/[1]", 315.0),
        ("ASIN[-1]", 270.0),
        ("ACOS[-1]", 180.0),
        ("SQRT[2]*SQ[2]", 2.0),
        ("ABS[-2.5]", 2.5),
        ("ROUND[1.2345]", 1.0),
        ("ROUND[-1.5]", -2.0),
        ("FIX[1.2]", 1.0),
        ("FUP[1.2]", 2.0),
        ("FIX[-1.2]", -1.0),
        ("FUP[-1.2]", -2.0),
        ("FIX[37.8-25.8]", 12.0),
        ("FUP[0.1+0.2-0.3]", 0.0),
        ("20.4*43.75XOR5", 888.0),
        ("LN[EXP[2]]", 2.0),
        ("BIN[37]", 25.0),
        ("BCD[25]", 37.0),
        ("# 1+1", 1.0),
        ("[[[[[1]]]]]", 1.0),
        ("2 * ( two ) 3", 6.0),
        ("#[99+1]+1", 1.0),
        ("7ANDABS[-3]", 3.0),
        ("7MODFIX[3.9]", 1.0),
        ("4XORSQRT[1]", 5.0),
    ] {
        if formula.starts_with("# ") {
            // A blank between # and its number is wrong.
            assert_eq!(fault(&format!("#100={formula};")), (114, 1), "{formula}");
            continue;
        }
        let difference = evaluate(formula) - expected;
        assert!(
            difference.abs() < 1e-9,
            "{formula} is {}",
            evaluate(formula)
        );
    }
}

/// Variables store eight significant digits (manual of macro B, precision).
#[test]
fn variables_keep_eight_digits() {
    let text = "#1=9876543210123.456;\n#2=9876543277777.777;\n#100=#2-#1;";
    assert_eq!(run_result(text), Some(100_000.0));
    assert_eq!(evaluate("9876543210123.456"), 9_876_543_200_000.0);
    assert_eq!(evaluate("0.123456785"), 0.123_456_79);
    assert_eq!(evaluate("-99999999.5"), -100_000_000.0);
    assert_eq!(
        run_result("#1=0.002;\n#2=#1*1000;\n#100=FIX[#2];"),
        Some(2.0)
    );
}

#[test]
fn null_is_not_a_number() {
    assert_eq!(run_result("#100=1;\n#100=#0;"), None);
    assert_eq!(run_result("#100=#1;"), None);
    assert_eq!(evaluate("#1+#1"), 0.0);
    assert_eq!(evaluate("#1*5"), 0.0);
    for (condition, null, zero) in [
        ("#1EQ#0", true, false),
        ("#1NE#0", false, true),
        ("#1EQ0", false, true),
        ("#1NE0", true, false),
        ("#1GE0", true, true),
        ("#1GT0", false, false),
        ("#1LE0", true, true),
        ("#1LT0", false, false),
        ("#1EQSIN[0]", false, true),
    ] {
        for (before, expected) in [("", null), ("#1=0;\n", zero)] {
            let text = format!("#100=1;\n{before}IF[{condition}]GOTO9;\n#100=0;\nN9;");
            assert_eq!(
                run_result(&text),
                Some(f64::from(u8::from(expected))),
                "{text}"
            );
        }
    }
}

#[test]
fn words_take_formulas() {
    let trace = bench().trace("#1=12.3456;\nG00 X#1 Z[#1*2];\nG#0 X20 Z-#2;\nU[ROUND[#1]] W-#1;\n");
    assert_eq!(
        trace[1..4],
        [
            "2: rapid X12.346 Z24.691 |",
            "3: rapid X20 Z24.691 |",
            "4: rapid X32.346 Z12.345 |"
        ]
    );
}

/// ROUND in a word rounds to 0.001 mm, so the two rounded moves lead back to the start.
#[test]
fn round_in_a_word_rounds_to_the_increment() {
    let mut bench = bench();
    let text = "G50 X0 Z0;\n#1=1.2345;\n#2=2.3456;\nG00 W-#1;\nG01 W-#2 F100;\nG00 W[#1+#2];\n";
    bench.trace(text);
    assert_eq!(bench.displayed_position().1, -0.001);
    bench.trace("G50 X0 Z0;\n#1=1.2345;\n#2=2.3456;\nG00 W-#1;\nG01 W-#2 F100;\nG00 W[ROUND[#1]+ROUND[#2]];\n");
    assert_eq!(bench.displayed_position().1, 0.0);
}

/// The example of the manual of macro B computes the sum of 1 to 10, by GOTO and by WHILE.
#[test]
fn sums_of_the_manual() {
    let jumps =
        "#1=0;\n#2=1;\nN1 IF[#2 GT 10] GOTO 2;\n#1=#1+#2;\n#2=#2+1;\nGOTO 1;\nN2 #100=#1*100+#2;";
    let loops = "#1=0;\n#2=1;\nWHILE[#2 LE 10] DO 1;\n#1=#1+#2;\n#2=#2+1;\nEND 1;\n#100=#1*100+#2;";
    assert_eq!(run_result(jumps), Some(5511.0));
    assert_eq!(run_result(loops), Some(5511.0));
}

#[test]
fn loops_can_be_nested() {
    let text = "#1=0;\nWHILE[#1LT3]DO1;\n#1=#1+1;\n#2=0;\nWHILE[#2LT4]DO2;\n#2=#2+1;\n#3=0;\nDO3;\n\
                #3=#3+1;\nIF[#3GE5]GOTO50;\n#100=#100+1;\nEND3;\nN50;\nEND2;\nEND1;";
    assert_eq!(run_result(text), Some(3.0 * 4.0 * 4.0));
    // The same number for two loops in sequence.
    let text =
        "DO1;\n#100=#100+1;\nIF[#100GT3]GOTO2;\nEND1;\nN2 WHILE[#100LT9]DO1;\n#100=#100+1;\nEND1;";
    assert_eq!(run_result(text), Some(9.0));
    // A condition that never holds skips everything inside the loop.
    let text = "#100=1;\nWHILE[1EQ2]DO1;\nWHILE[1EQ1]DO2;\n#100=5;\nEND2;\nEND1;\n";
    assert_eq!(run_result(text), Some(1.0));
}

#[test]
fn mismatched_loops_raise_alarms() {
    assert_eq!(fault("DO1;\nG00 X1;\n"), (124, 1));
    assert_eq!(fault("#1=0;\nEND1;\n"), (124, 2));
    assert_eq!(fault("DO1;\nDO2;\nEND1;\nEND2;\n"), (124, 1));
    assert_eq!(fault("DO1;\nDO1;\nEND1;\nEND1;\n"), (124, 1));
    assert_eq!(fault("GOTO5;\nDO1;\nN5 #1=1;\nEND1;\n"), (124, 4));
    assert_eq!(fault("DO4;\nEND4;\n"), (126, 1));
    assert_eq!(fault("DO12;\nEND12;\n"), (126, 1));
}

#[test]
fn invalid_statements_raise_alarms() {
    for (text, alarm) in [
        ("#1=;", 114),
        ("#1=1+;", 114),
        ("#1;", 114),
        ("#1=SON[1];", 114),
        ("#1=[1;", 114),
        ("#1=1];", 114),
        ("IF[1]GOTO1;", 114),
        ("IF[1EQ1]#1=2;", 114),
        ("X[1;", 114),
        ("N#1 G00;", 114),
        ("#1=[[[[[[1]]]]]];", 118),
        ("#1=1 X2;", 127),
        ("G00 #1=1;", 127),
        ("G00 X1 GOTO 5;\n", 127),
        ("#0=1;", 116),
        ("#5001=1;", 116),
        ("#34=1;", 115),
        ("#1=#400;", 115),
        ("#1=#[0-1];", 115),
        ("#1=1/0;", 112),
        ("#1=TAN[90];", 112),
        ("#1=SQRT[-1];", 119),
        ("#1=ASIN[2];", 119),
        ("#1=-1AND1;", 119),
        ("#1=BIN[26];", 119),
        ("#1=EXP[200];", 111),
        ("#200=1*99999999999;", 111),
        ("GOTO0;", 128),
        ("GOTO10000;", 128),
        ("#1=1;\nGOTO77;", 128),
        ("#3000=100;", 43),
        ("X[10000];", 43),
    ] {
        let mut bench = bench();
        bench.open(text);
        let (_, raised) = bench.run_to_end();
        assert_eq!(raised.map(|it| it.number), Some(alarm), "{text}");
    }
}

#[test]
fn a_program_can_raise_alarms() {
    let mut bench = bench();
    bench.open("#1=1;\n#3000=#1 (TOOL NOT FOUND);\n");
    let (_, alarm) = bench.run_to_end();
    let alarm = alarm.expect("an alarm");
    assert_eq!(alarm.number, 3001);
    assert_eq!(alarm.line_text(), "P/S 3001: TOOL NOT FOUND");
    assert_eq!(alarm.to_string(), "P/S 3001: TOOL NOT FOUND");
}

fn bench_with_programs(programs: &[&str]) -> InterpreterBench {
    let mut bench = bench();
    for text in programs {
        bench.programs.store(Program::new(*text).text()).unwrap();
    }
    bench
}

/// Each run of a macro starts with the arguments of its call (manual of macro B, 2.8).
#[test]
fn a_call_has_separate_variables() {
    let called = "O9010;\n#3=#1+#2;\nIF[#3GT360]GOTO9;\nG00 W#3;\nN9 M99;\n";
    let mut bench = bench_with_programs(&[called]);
    bench.open("O1;\n#1=7;\nG50 X0 Z0;\nG65 P9010 L2 A1.0 B2.0;\n#100=#1;\n#101=#3;\nM30;\n");
    let (_, alarm) = bench.run_to_end();
    assert_eq!(alarm, None);
    assert_eq!(bench.displayed_position().1, 6.0);
    assert_eq!(bench.variables.real_value(100), Some(7.0));
    assert_eq!(bench.variables.real_value(101), None);
}

#[test]
fn both_argument_lists_are_read() {
    let mut bench =
        bench_with_programs(&["O9010;\n#101=#1;\n#102=#2;\n#104=#4;\n#107=#7;\n#103=#3;\nM99;\n"]);
    bench.trace("O1;\nG65 A1.0 B2.0 I-3.0 I4.0 D5.0 P9010;\n");
    let read = |number| bench.variables.real_value(number);
    assert_eq!(
        [101, 102, 103, 104, 107].map(read),
        [Some(1.0), Some(2.0), None, Some(-3.0), Some(5.0)]
    );
    let mut bench =
        bench_with_programs(&["O9010;\n#100=#24*10000+#25*100+#31;\n#101=#33;\n#102=#5;\nM99;\n"]);
    bench.trace("O1;\nG65 P9010 X3 Y4 I1 J2 K3 I4I5I6I7I8I9I10I11 I31 J32 K33;\n");
    // The tenth I comes after the Y and is the same variable.
    assert_eq!(bench.variables.real_value(100), Some(31_031.0));
    assert_eq!(bench.variables.real_value(101), Some(33.0));
    assert_eq!(bench.variables.real_value(102), Some(2.0));
    let eleven = "I1 I2 I3 I4 I5 I6 I7 I8 I9 I10 I11";
    assert_eq!(
        bench_with_programs(&["O9010;\nM99;\n"]).run_to_alarm(&format!("G65 P9010 {eleven};")),
        (129, 1)
    );
    assert_eq!(
        bench_with_programs(&["O9010;\nM99;\n"]).run_to_alarm("G65 P9010 N1;"),
        (129, 1)
    );
}

#[test]
fn a_statement_can_follow_a_program_name() {
    assert_eq!(run_result("O0001 #100=5;\nM30;\n"), Some(5.0));
}

#[test]
fn calls_return_to_their_callers() {
    let called =
        "O9010;\nWHILE[#1LT9]DO1;\n#1=#1+1;\nIF[#1EQ5]GOTO9;\nEND1;\nN9 #100=#100+#1;\nM99;\n";
    let mut bench = bench_with_programs(&[called]);
    bench.open("O1;\n#100=0;\nDO1;\nG65 P9010 L3 A2;\n#2=#2+1;\nIF[#2GE2]GOTO5;\nEND1;\nN5 M30;\n");
    assert_eq!(bench.run_to_end().1, None);
    assert_eq!(bench.variables.real_value(100), Some(30.0));
    assert_eq!(fault("G65 P9011;"), (78, 1));
    assert_eq!(fault("G65 A1;"), (76, 1));
    assert_eq!(
        bench_with_programs(&["O9010;\nG65 P9010;\nM99;\n"])
            .run_to_alarm("G65 P9010;")
            .0,
        77
    );
    // A subprogram shares the variables of its caller.
    let mut bench = bench_with_programs(&["O9010;\n#100=#1;\n#1=#1+1;\nM99;\n"]);
    bench.trace("O1;\n#1=3;\nM98 P9010;\nM98 P9010;\n");
    assert_eq!(bench.variables.real_value(100), Some(4.0));
}

#[test]
fn moves_call_the_modal_macro() {
    let mut bench = bench_with_programs(&["O9110;\n#100=#100+#26;\n#26=#26*2;\nM99;\n"]);
    bench.open("O1;\n#100=0;\nG66 P9110 Z1;\nM08;\nG00 X10;\nG00 X20;\n#5=1;\nG00 X30;\nG67;\nG00 X40;\nM30;\n");
    assert_eq!(bench.run_to_end().1, None);
    // One, two and four: the variables stay until G67.
    assert_eq!(bench.variables.real_value(100), Some(7.0));
    // A move in the macro calls the earlier G66.
    let outer = "O9111;\n#101=#101+1;\nG00 W-1;\nM99;\n";
    let inner = "O9112;\n#102=#102+1;\nG00 W-1;\nG00 W-1;\nM99;\n";
    let mut bench = bench_with_programs(&[outer, inner]);
    bench.open("O1;\nG66 P9111;\nG66 P9112;\nG00 X10;\nG67;\nG00 X20;\nG67;\nG00 X30;\nM30;\n");
    assert_eq!(bench.run_to_end().1, None);
    assert_eq!(bench.variables.real_value(101), Some(3.0));
    assert_eq!(bench.variables.real_value(102), Some(1.0));
    // No call under nose radius compensation, where M98 is refused, too.
    let compensated =
        "G66 P9111;\nT0101;\nG42 G00 X10 Z10;\nG01 Z0 F100;\nG01 Z-5;\nG40 G00 X20;\n";
    let mut bench = bench_with_programs(&[outer]).with_bit(2, 1, true);
    let alarm = ToolOffset {
        r: 0.4,
        t: 3,
        ..ToolOffset::default()
    };
    bench.offsets.set(1, alarm).unwrap();
    let called = bench.run_to_alarm(compensated);
    let mut bench = bench_with_programs(&[outer]).with_bit(2, 1, true);
    bench.offsets.set(1, alarm).unwrap();
    assert_eq!(
        called,
        bench.run_to_alarm(
            &compensated
                .replace("G66 P9111;\n", ";\n")
                .replace("Z10;", "Z10 M98 P9111;")
        )
    );
    let five = "G66 P9111;\n".repeat(5);
    assert_eq!(bench_with_programs(&[outer]).run_to_alarm(&five), (122, 5));
}

#[test]
fn programs_can_read_the_state() {
    let mut bench = bench_with_programs(&[]);
    bench.open(
        "O0077;\nG50 X100 Z50;\nG99 G01 U-10 W-5 F0.5;\nN30 #100=#4001;\n#101=#4003;\n#102=#5001;\n#103=#5002;\n\
         #104=#4115;\n#105=#4114;\n#106=#4109;\n#107=#5021;\n#108=#5042;\n#109=#4004;\nM30;\n",
    );
    let (_, alarm) = bench.run_to_end();
    assert_eq!(alarm, None);
    let read = |number| bench.variables.real_value(number).unwrap();
    assert_eq!(
        [100, 101, 102, 103, 104, 105, 106].map(read),
        [1.0, 99.0, 90.0, 45.0, 77.0, 30.0, 0.5]
    );
    assert_eq!(
        [107, 108, 109].map(read),
        [bench.machine.x * 2.0, 45.0, 40.0]
    );
}

#[test]
fn signals_of_the_ladder() {
    let mut bench = bench();
    bench.inputs = 0b101;
    bench.open("#100=#1000+#1001*2+#1002*4;\n#101=#1032;\n#1101=1;\n#1133=5;\n");
    assert_eq!(bench.run_to_end().1, None);
    assert_eq!(bench.variables.real_value(100), Some(5.0));
    assert_eq!(bench.variables.real_value(101), Some(5.0));
    assert_eq!(bench.outputs, 2 | 5 << 16);
    assert_eq!(fault("#1000=1;"), (116, 1));
}

/// A program that uses macro B only for G65 H does the same with and without the option of
/// macro B.
#[test]
fn both_macro_languages_share_variables() {
    for with_option in [false, true] {
        let mut bench = InterpreterBench::new();
        bench.interpreter.set_macro_b(with_option);
        bench.trace("G50 X0 Z0;\nG65 H01 P#200 Q150;\nG00 W#200;\n");
        assert_eq!(bench.displayed_position().1, 0.15, "{with_option}");
    }
    // In a program with formulas the variable is in millimetres.
    let mut bench = bench();
    bench.trace("G50 X0 Z0;\nG65 H01 P#200 Q15;\n#201=1;\nG00 W#200;\n");
    assert_eq!(bench.displayed_position().1, 15.0);
    // Both languages share the variable, except for its fraction.
    let mut bench = self::bench();
    bench.trace("#500=2.75;\nG65 H02 P#501 Q#500 R1;\n#100=#500+#501;\n");
    assert_eq!(bench.variables.real_value(100), Some(5.75));
    assert_eq!(bench.variables.get(500), Some(2));
}

#[test]
fn macro_b_is_refused_without_the_option() {
    for (text, alarm) in [
        ("#1=1;", 6),
        ("G65 P9010 A1;", 9),
        ("X[1];", 6),
        ("GOTO 5;", 5),
    ] {
        assert_eq!(
            InterpreterBench::new().run_to_alarm(text),
            (alarm, 1),
            "{text}"
        );
    }
}

#[test]
fn single_block_skips_statements() {
    let text = "#1=1;\nG00 X1;\n";
    let stops = |bench: &mut InterpreterBench| {
        bench
            .trace(text)
            .iter()
            .filter(|it| it.ends_with('|'))
            .count()
    };
    assert_eq!(stops(&mut bench()), 1);
    let mut stopping = bench().with_bit(13, 4, true);
    assert_eq!(stops(&mut stopping), 2);
}
