//! Words, ranges and alarms.

use super::super::block::MAX_WORDS;
use super::super::*;

fn parse(text: &str) -> Result<ProgramBlock, BlockError> {
    parse_block(text, Syntax::default())
}

fn print_block(text: &str) -> String {
    parse(text).unwrap().to_string()
}

#[track_caller]
fn assert_alarms(cases: &[(&str, u16)]) {
    for (text, alarm) in cases {
        let error = parse(text).expect_err(text);
        assert_eq!(error.alarm, *alarm, "{text}: {error}");
    }
}

#[track_caller]
fn assert_accepted(cases: &[&str]) {
    for text in cases {
        parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    }
}

#[test]
fn words_keep_their_order() {
    let block = parse("/N10 G01 G98 X-50.5 Z2 F100;").unwrap();
    assert!(block.skip);
    assert_eq!(block.n, Some(10));
    let words: Vec<_> = block
        .words()
        .iter()
        .map(|word| (char::from(word.address), word.value.value()))
        .collect();
    assert_eq!(
        words,
        [
            ('G', 1.0),
            ('G', 98.0),
            ('X', -50.5),
            ('Z', 2.0),
            ('F', 100.0)
        ]
    );
    assert_eq!(block.g_codes().collect::<Vec<_>>(), [1, 98]);
    assert!(block.has_g(98) && !block.has_g(0) && !block.has_g(200));
    assert_eq!(
        block.number(b'X').map(WordNumber::millionths),
        Some(-50_500_000)
    );
    assert!(block.number(b'X').unwrap().has_point() && !block.number(b'Z').unwrap().has_point());
    assert_eq!(block.word(b'Z').unwrap().span, (20, 22));
    assert_eq!(block.number(b'U'), None);
}

#[test]
fn blocks_are_printed() {
    for (text, print) in [
        ("o1", "O0001 ;"),
        ("g1x-.5z+3.250", "G1 X-0.5 Z3.25;"),
        ("M3 S0302 T0101", "M3 S0302 T0101;"),
        ("X 1 2.", ""),
        ("G65 H80 P-10", "G65 H80 P-10;"),
        ("X-#200 G#230", "X-#200 G#230;"),
        ("X0012.3456", "X12.346;"),
        ("X-0.0005", "X-0.001;"),
        ("X-0.0004", "X0.;"),
        ("F0.0001", "F0.0001;"),
        ("/", "/;"),
        ("", ";"),
    ] {
        match parse(text) {
            Ok(block) => assert_eq!(block.to_string(), print, "{text}"),
            Err(error) => assert_eq!((print, error.alarm), ("", 6), "{text}"),
        }
    }
}

#[test]
fn the_block_ends() {
    for text in [
        "G0 X1;Z2",
        "G0 X1*Z2",
        "G0 X1\nZ2",
        "G0 X1\r\nZ2",
        "G0 X1\rZ2",
    ] {
        assert_eq!(print_block(text), "G0 X1;", "{text:?}");
    }
}

#[test]
fn comments_and_full_width() {
    for text in [
        "G0(快;速)X1",
        "(外圆*粗车)G0X1(a)(b)",
        "G0 X(x)1",
        "G0(全角（括号）X9)X1",
        "Ｇ０　Ｘ１；",
        "ｇ０（全角（括号）X1",
        "\u{feff}G0\u{a0}X\t1",
        "g0 x1",
    ] {
        assert_eq!(print_block(text), "G0 X1;", "{text}");
    }
    assert_alarms(&[
        ("G0 (open", 6),
        ("G0 (open\n)", 6),
        ("G0 )", 6),
        ("(a（b）", 6),
        ("外圆", 6),
        ("G0 X1 é", 6),
    ]);
}

#[test]
fn errors_name_their_columns() {
    for (text, column) in [
        ("G0 (外圆) X1 A5", 12),
        ("外", 1),
        ("G0 X1.2.3", 8),
        ("G0X", 3),
    ] {
        assert_eq!(parse(text).unwrap_err().column, column, "{text}");
    }
    assert_eq!(parse("X9999.9999").unwrap_err().column, 1);
    let text = parse("G1 X12000").unwrap_err().to_string();
    assert_eq!(
        text,
        "043 at column 4: X12000 is outside -9999.999 to 9999.999"
    );
}

#[test]
fn values_that_cannot_be_read() {
    assert_alarms(&[
        ("X-", 2),
        ("X.", 2),
        ("X-.", 2),
        ("X--5", 2),
        ("X+-5", 2),
        ("X5-3", 2),
        ("X5#1", 2),
        ("X-Z5", 2),
        ("X#", 2),
        ("N#1", 2),
        ("O#1", 2),
        ("J#1", 2),
        ("L#1", 2),
        ("X#12345", 115),
        ("X#1.5", 7),
    ]);
}

#[test]
fn missing_numbers_and_characters() {
    assert_alarms(&[
        ("X", 5),
        ("X;", 5),
        ("G X5", 5),
        ("XZ5", 5),
        ("X (5)", 5),
        ("X%", 5),
        ("X=5", 6),
        ("X/5", 6),
        ("X外", 6),
        ("5", 6),
        ("G0 X1 5", 6),
        (".5", 6),
        ("-5", 2),
        ("N10 /G0", 6),
        ("//G0", 6),
        ("G0 [1]", 6),
        ("\0", 6),
    ]);
}

#[test]
fn addresses() {
    for letter in "ABCDEVYabcdevy".chars() {
        assert_alarms(&[(&format!("{letter}1"), 9)]);
    }
    for letter in "FGHIJKLMNOPQRSTUWXZ".chars() {
        assert_accepted(&[&format!("{letter}1")]);
    }
    assert_alarms(&[
        ("X1 Z1 X2", 18),
        ("M3 M8", 18),
        ("N1 G0 N2", 18),
        ("O1 O2", 18),
        ("T0101 T0202", 18),
        ("x1 X1", 18),
    ]);
    assert_accepted(&["G0 G1 G98 G40", "X1 U1 Z1 W1", "G0 X1 N10", "O1 N1 G0"]);
}

#[test]
fn decimal_points() {
    for letter in "GHLMNOPQST".chars() {
        assert_alarms(&[(&format!("{letter}1."), 7), (&format!("{letter}1.0"), 7)]);
    }
    for letter in "FIJKRUWXZ".chars() {
        assert_accepted(&[&format!("{letter}1."), &format!("{letter}.1")]);
        assert_alarms(&[(&format!("{letter}1.."), 7), (&format!("{letter}1.1.1"), 7)]);
    }
    let syntax = Syntax {
        point_required: true,
        ..Syntax::default()
    };
    for letter in "FIJKRUWXZ".chars() {
        let error = parse_block(&format!("{letter}1"), syntax).unwrap_err();
        assert_eq!(error.alarm, 7);
        parse_block(&format!("{letter}1."), syntax).unwrap();
    }
    for text in ["G1 M3 S1 T1 P1 Q1 H1 L1 N1 O1", "X#1", "G65 H1 P#200 Q1 R1"] {
        parse_block(text, syntax).unwrap();
    }
}

#[test]
fn ranges() {
    assert_accepted(&[
        "X9999.999",
        "X-9999.999",
        "U9999.999",
        "Z-9999.999",
        "W9999.999",
        "J-9999.999",
        "K9999.999",
        "R-9999.999",
        "I25400",
        "I-9999.999",
        "F0",
        "F9999999",
        "F0.0001",
        "F1234.567",
        "F100.0000000",
        "F0000000100",
        "G99",
        "M99",
        "H99",
        "L1",
        "L99",
        "S9999",
        "S0000",
        "T0",
        "T33",
        "T3232",
        "T0032",
        "P99999999",
        "P-010260",
        "Q9999999",
        "Q-1",
        "N9999",
        "O0",
        "N00000",
        "X000000000000000001",
        "G04 X99999.999",
        "G4 U-5",
        "X5 G04",
        "G76 P010260 Q100 R200",
        "R9999999 G76",
        "G65 H2 P#200 Q-4294967296 R4294967296",
    ]);
    assert_alarms(&[
        ("X10000", 43),
        ("X-10000.", 43),
        ("X9999.9996", 43),
        ("Z10000", 43),
        ("R10000", 43),
        ("K10000", 43),
        ("I25400.001", 43),
        ("I-10000", 43),
        ("F-1", 43),
        ("F10000000", 43),
        ("F1234.5678", 43),
        ("G100", 43),
        ("G-1", 43),
        ("M100", 43),
        ("H100", 43),
        ("L0", 43),
        ("L100", 43),
        ("S10000", 43),
        ("S-1", 43),
        ("T10000", 43),
        ("T-1", 43),
        ("P100000000", 43),
        ("Q10000000", 43),
        ("N10000", 43),
        ("N-1", 43),
        ("O10000", 43),
        ("O-1", 43),
        ("G04 X100000", 43),
        ("G04 Z10000", 43),
        ("G76 R10000.", 43),
        ("G76 R10000000", 43),
        ("X99999999999999999999999999999999", 43),
        ("X-99999999999999999999999999999999.9", 43),
        ("G65 H2 P#200 Q4294967297", 43),
    ]);
}

#[test]
fn macro_blocks() {
    assert_accepted(&["O1 N1 G65 H81 P10 Q#200 R-#201", "G65 P#200 H1 Q1", "G65"]);
    assert_alarms(&[
        ("X1 G65 H1", 125),
        ("H1 G65 P1", 125),
        ("G0 G65 H1", 125),
        ("G65 H1 X1", 125),
        ("G65 H1 N1", 125),
        ("G65 H1 G0", 125),
        ("G65 H1 H2", 18),
        ("G65 H1 Q1.5", 7),
        ("G65 A1", 9),
    ]);
}

#[test]
fn too_many_words() {
    let codes = "G0 ".repeat(MAX_WORDS);
    assert_accepted(&[&codes, &format!("N1 {codes}")]);
    assert_alarms(&[(&format!("{codes} X1"), 12), (&"G0".repeat(10_000), 12)]);
}

#[test]
fn variables_get_values() {
    let block = parse("G#1 X#2 U-#2 F#3 T#4").unwrap();
    assert!(block.has_variables());
    let value = |variable: VariableReference| match variable.number {
        1 => Ok(3),
        2 => Ok(10),
        3 => Ok(15),
        4 => Ok(101),
        _ => Err(BlockError {
            alarm: 115,
            column: 1,
            detail: gsk_messages::say::as_written(""),
        }),
    };
    let block = block.resolve(Syntax::default(), |_| false, value).unwrap();
    assert_eq!(block.to_string(), "G3 X0.01 U-0.01 F15 T101;");
    assert!(block.has_g(3) && !block.has_variables());
    assert_eq!(
        parse("X#9")
            .unwrap()
            .resolve(Syntax::default(), |_| false, value)
            .unwrap_err()
            .alarm,
        115
    );
    let huge = |_| Ok::<_, BlockError>(i64::MAX);
    for text in ["X#1", "X-#1", "M#1", "G#1", "P#1"] {
        assert_eq!(
            parse(text)
                .unwrap()
                .resolve(Syntax::default(), |_| false, huge)
                .unwrap_err()
                .alarm,
            43,
            "{text}"
        );
    }
    let raw = parse("G65 H1 P#200 Q#9")
        .unwrap()
        .resolve(Syntax::default(), |_| false, value)
        .unwrap();
    assert_eq!(raw.number(b'P').unwrap().variable().unwrap().number, 200);
}

#[test]
fn blocks_are_stored_as_their_words() {
    let block = parse("/N5 G1 X-1.5 F#200").unwrap();
    let text = ron::to_string(&block).unwrap();
    assert_eq!(ron::from_str::<ProgramBlock>(&text).unwrap(), block);
    assert!(ron::from_str::<ProgramBlock>(&text.replace("-1500000", "-15000000000")).is_err());
}
