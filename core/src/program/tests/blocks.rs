//! Lines and blocks of a program.

use super::super::*;

fn block_lines(text: &str) -> Vec<u32> {
    let program = Program::new(text);
    (0..program.block_count())
        .map(|index| program.block_line(index))
        .collect()
}

#[test]
fn texts_are_split_into_blocks() {
    for (text, expected) in [
        ("", &[][..]),
        ("\n\n", &[]),
        ("G0 X1", &[1]),
        ("G0 X1\nZ1\n", &[1, 2]),
        ("G0;X1*Z1;\nX2;", &[1, 1, 1, 2]),
        ("G0;\n;\n\nX1;", &[1, 2, 4]),
        ("G0;;\n", &[1, 1]),
        ("  ;\n", &[1]),
        ("(comment)\n(comment);\nG0;(end)\n", &[3]),
        ("N10\nN20;\n", &[1, 2]),
        ("/;\n/\n", &[1, 2]),
        ("G0 (a;b*c\n", &[1]),
        ("%\nO1;\nM30;\n%\nG0\n", &[2, 3]),
        ("\n % leader\nO1\nG0 X1 % no end\nG0 X2 %\n", &[3, 4, 5]),
        ("％\nG0；Ｘ１＊\n％X1", &[2, 2]),
        ("G0\r\nX1\rZ1\r\n", &[1, 2, 3]),
    ] {
        assert_eq!(block_lines(text), expected, "{text:?}");
    }
}

#[test]
fn lines_of_the_file() {
    let program = Program::new("O1;\r\n\n(外圆)\nG0 X1; X2;\nX3\r;\n%\nrest\n");
    let all: Vec<_> = (0..=10).map(|line| program.line(line)).collect();
    let expected = [
        "",
        "O1;",
        "",
        "(外圆)",
        "G0 X1; X2;",
        "X3",
        ";",
        "%",
        "rest",
        "",
        "",
    ];
    assert_eq!(all, expected);
    assert_eq!(program.line_count(), 8);
    assert_eq!(program.block_count(), 5);
    assert_eq!(program.block_from_line(2), 1);
    assert_eq!(program.block_from_line(4), 1);
    assert_eq!(program.block_from_line(5), 3);
    assert_eq!(program.block_from_line(9), 5);
    assert_eq!(program.block_line(99), 7);
    for (text, count) in [
        ("", 0),
        ("a", 1),
        ("a\n", 1),
        ("a\nb", 2),
        ("%", 1),
        ("%\n", 1),
        ("G0\n%", 2),
        ("G0%\n\n", 2),
    ] {
        assert_eq!(Program::new(text).line_count(), count, "{text:?}");
    }
}

#[test]
fn blocks_are_parsed_by_index() {
    let program = Program::new("O7;\nG0 X#1;\nX5;\nG65 H1 P#1 Q2;\nX99999;");
    let syntax = Syntax::default();
    assert_eq!(program.parse(0, syntax).unwrap().o, Some(7));
    assert_eq!(program.parse(1, syntax).unwrap_err().alarm, 115);
    assert!(
        program
            .parse_with_variables(1, syntax)
            .unwrap()
            .has_variables()
    );
    assert_eq!(program.parse(2, syntax).unwrap().line, 3);
    assert!(program.parse(3, syntax).unwrap().has_g(65));
    assert_eq!(program.parse(4, syntax).unwrap_err().alarm, 43);
    assert!(program.parse(5, syntax).unwrap().is_empty());
}

#[test]
fn numbers_and_sequences() {
    let program =
        Program::new("(head)\nO0012 (NAME);\nN10 G0;\n/N20 X1;\nG0 N30;\nO5 n 0010;\nＮ４０");
    assert_eq!(program.number(), Some(12));
    assert_eq!(program.find_sequence(10, 1), Some(3));
    assert_eq!(program.find_sequence(10, 4), Some(6));
    assert_eq!(program.find_sequence(20, 1), Some(4));
    assert_eq!(program.find_sequence(30, 1), None);
    assert_eq!(program.find_sequence(40, 1), Some(7));
    assert_eq!(program.find_sequence_block(10, 2..99), Some(4));
    assert_eq!(program.find_sequence_block(10, 2..4), None);
    assert_eq!(program.sequence(1), Some(10));
    assert_eq!(Program::new("G0 X1;").number(), None);
    assert_eq!(Program::new("O12345;").number(), None);
}

#[test]
fn renumbering_replaces_the_name_only() {
    for (text, expected) in [
        ("(O9)\nO1 (a);\nO2;", "(O9)\nO0077 (a);\nO2;"),
        ("%\nＯ１;", "%\nO0077;"),
        ("G0;", "O0077;\nG0;"),
        ("%\nG0;", "%\nO0077;\nG0;"),
        ("(nothing)", "O0077;\n(nothing)"),
    ] {
        let program = Program::new(text).renumbered(77);
        assert_eq!(program.text(), expected);
        assert_eq!(program.number(), Some(77));
    }
}

#[test]
fn a_file_of_several_programs() {
    let programs = split_programs("%\n(job)\nO1;\nM98 P2;\nM30;\nO0002;\nX1;\nM99;\n%\nO3");
    assert_eq!(programs.len(), 2);
    assert_eq!(programs[0].number(), Some(1));
    assert_eq!(programs[1].number(), Some(2));
    assert_eq!(programs[1].text(), "O0002;\nX1;\nM99;\n");
    assert_eq!(programs[1].block_line(1), 7);
    assert_eq!(programs[1].line(8), "M99;");
    assert_eq!(programs[1].line(5), "");
    assert_eq!(programs[1].find_sequence(1, 1), None);
    let text = ron::to_string(&programs).unwrap();
    assert_eq!(ron::from_str::<Vec<Program>>(&text).unwrap(), programs);
    assert_eq!(split_programs("G0;").len(), 1);
    assert_eq!(split_programs("").len(), 1);
}

#[test]
fn full_width_is_reported_outside_comments() {
    assert_eq!(
        Program::new("(全角：Ａ)\nG0\nＸ1").full_width_line(),
        Some(3)
    );
    assert_eq!(Program::new("G0（外圆）").full_width_line(), Some(1));
    assert_eq!(Program::new("\u{feff}G0 (Ａ)").full_width_line(), None);
}
