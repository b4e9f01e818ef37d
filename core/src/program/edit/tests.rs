use super::*;

const PART: &str = "O0001;\nN10 G0 X10;\nN20 G1 Z-5 F100;\nM30;\n";

fn editor_at(text: &str, line: u32, column: u32) -> ProgramEditor {
    let mut editing = ProgramEditor::new(Program::new(text), line);
    for _ in 0..column {
        editing.move_right();
    }
    assert_eq!(editing.cursor(), (line, column));
    editing
}

fn type_text(editing: &mut ProgramEditor, text: &str, completion: Completion) {
    for character in text.chars() {
        if character == ';' {
            editing.end_block(completion);
        } else {
            editing.insert(character);
        }
    }
}

fn finished_text(editing: &mut ProgramEditor) -> String {
    editing.finish().text().to_owned()
}

#[test]
fn a_new_program_is_typed_block_by_block() {
    let mut editing = editor_at("O0001;\n", 2, 0);
    type_text(&mut editing, "G0X150Z185;M3S300", Completion::default());
    assert_eq!(editing.open_line(), Some(3));
    assert_eq!(editing.cursor(), (3, 6));
    type_text(&mut editing, ";", Completion::default());
    assert_eq!(editing.open_line(), None);
    assert_eq!(editing.cursor(), (4, 0));
    assert_eq!(
        finished_text(&mut editing),
        "O0001;\nG0X150Z185;\nM3S300;\n"
    );
}

#[test]
fn cancelling_what_was_typed_leaves_the_text_as_it_was() {
    for source in [PART, "O0001;\nM30;\n%\n", "O0001;\r\nM30\r\n%"] {
        let mut editing = ProgramEditor::new(Program::new(source), 99);
        type_text(&mut editing, "G0X9", Completion::default());
        for _ in 0..4 {
            assert!(editing.backspace());
        }
        let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(lines(&finished_text(&mut editing)), lines(source));
        assert_eq!(editing.cursor().0, editing.program().last_listed());
    }
}

#[test]
fn text_goes_in_front_of_the_cursor_and_the_end_of_block_splits_the_line() {
    let mut editing = editor_at(PART, 3, 4);
    type_text(&mut editing, "G99 ", Completion::default());
    assert_eq!(editing.program().line(3), "N20 G99 G1 Z-5 F100;");
    let mut editing = editor_at(PART, 3, 0);
    type_text(&mut editing, "M3;", Completion::default());
    assert_eq!(
        finished_text(&mut editing),
        "O0001;\nN10 G0 X10;\nM3;\nN20 G1 Z-5 F100;\nM30;\n"
    );
    assert_eq!(editing.cursor(), (4, 0));
    let mut editing = editor_at(PART, 2, 10);
    type_text(&mut editing, ";M8", Completion::default());
    assert_eq!(
        finished_text(&mut editing),
        "O0001;\nN10 G0 X10;\nM8;\nN20 G1 Z-5 F100;\nM30;\n"
    );
}

#[test]
fn a_point_gets_its_zero_when_a_word_or_the_end_follows() {
    let mut editing = editor_at("O0001;\n", 2, 0);
    type_text(&mut editing, "G0X10.Z5.;X1.5Z2;", Completion::default());
    assert_eq!(
        finished_text(&mut editing),
        "O0001;\nG0X10.0Z5.0;\nX1.5Z2;\n"
    );
    let points = Completion {
        points: true,
        ..Completion::default()
    };
    let mut editing = editor_at("O0001;\n", 2, 0);
    type_text(&mut editing, "G0X10Z5.5;", points);
    assert_eq!(editing.program().line(2), "G0X10.Z5.5;");
}

#[test]
fn new_blocks_are_numbered() {
    let by_ten = Completion {
        numbering: Some(10),
        ..Completion::default()
    };
    let mut editing = editor_at("O0001;\n", 2, 0);
    type_text(&mut editing, "M3;G0X1;", by_ten);
    assert_eq!(editing.program().line(3), "N0010G0X1;");
    assert_eq!(editing.open_line(), Some(4));
    // A block that only has its automatic number is not stored.
    assert_eq!(finished_text(&mut editing), "O0001;\nM3;\nN0010G0X1;\n");
    let mut editing = editor_at(PART, 2, 10);
    type_text(&mut editing, ";M8", by_ten);
    assert_eq!(editing.program().line(3), "N0020M8;");
    let mut full = editor_at("O0001;\nN9995;\n", 3, 0);
    type_text(&mut full, "M3;", by_ten);
    assert_eq!(finished_text(&mut full), "O0001;\nN9995;\nM3;\n");
}

#[test]
fn altering_writes_over_characters_but_not_over_the_end() {
    let mut editing = editor_at(PART, 2, 5);
    assert!(editing.overwrite('1', false));
    assert_eq!(editing.program().line(2), "N10 G1 X10;");
    assert_eq!(editing.cursor(), (2, 6));
    assert!(editing.overwrite('P', true) && editing.overwrite('Q', true));
    assert_eq!(editing.program().line(2), "N10 G1QX10;");
    let mut editing = editor_at(PART, 2, 10);
    editing.overwrite('5', false);
    assert_eq!(editing.program().line(2), "N10 G0 X105;");
    assert!(editing.replace_before('7'));
    assert_eq!(editing.program().line(2), "N10 G0 X107;");
}

#[test]
fn characters_ends_and_blocks_are_deleted() {
    let mut editing = editor_at(PART, 2, 4);
    assert!(editing.delete());
    assert_eq!(editing.program().line(2), "N10 0 X10;");
    let mut editing = editor_at(PART, 2, 10);
    assert!(editing.delete());
    assert_eq!(editing.program().line(2), "N10 G0 X10N20 G1 Z-5 F100;");
    let mut editing = editor_at(PART, 3, 0);
    assert!(editing.backspace());
    assert_eq!(editing.program().line(2), "N10 G0 X10N20 G1 Z-5 F100;");
    assert_eq!(editing.cursor(), (2, 10));
    let mut editing = editor_at(PART, 2, 0);
    assert!(editing.delete());
    assert_eq!(
        finished_text(&mut editing),
        "O0001;\nN20 G1 Z-5 F100;\nM30;\n"
    );
    let mut editing = editor_at("O0001;\nN10 M3; M8;\n", 2, 0);
    assert!(editing.delete());
    assert_eq!(finished_text(&mut editing), "O0001;\nM8;\n");
    // In the first column also before the blanks of the number.
    let mut editing = editor_at("O0001;\n  N10 M3;\nM8;\n", 2, 0);
    assert!(editing.delete());
    assert_eq!(finished_text(&mut editing), "O0001;\nM8;\n");
    let mut editing = editor_at(PART, 5, 0);
    assert!(!editing.delete());
    assert!(editing.backspace());
    assert_eq!(editing.open_line(), Some(4));
    assert_eq!(editing.cursor(), (4, 3));
    assert_eq!(finished_text(&mut editing), PART);
}

#[test]
fn a_range_goes_from_the_cursor_to_the_end_of_a_block() {
    let long = "O0001;\nN10;\nN20 M3;\nN30;\nN40;\nM30;\n";
    let mut editing = editor_at(long, 3, 0);
    assert!(editing.delete_to(40));
    assert_eq!(finished_text(&mut editing), "O0001;\nN10;\nM30;\n");
    let mut editing = editor_at(long, 3, 3);
    assert!(editing.delete_to(30));
    assert_eq!(
        finished_text(&mut editing),
        "O0001;\nN10;\nN20;\nN40;\nM30;\n"
    );
    let mut editing = editor_at(long, 4, 0);
    assert!(!editing.delete_to(10), "only behind the cursor");
    assert!(!editing.is_changed());
}

#[test]
fn the_name_is_protected() {
    let mut editing = editor_at(PART, 1, 2);
    assert!(!editing.insert('5') && !editing.delete() && !editing.backspace());
    assert!(!editing.end_block(Completion::default()));
    assert!(!editing.overwrite('5', false));
    let mut editing = editor_at(PART, 2, 0);
    assert!(!editing.backspace(), "the end of the name stays");
    assert!(!editing.is_changed());
}

#[test]
fn searching_goes_both_ways() {
    let mut editing = editor_at(PART, 1, 0);
    assert!(editing.move_to_text("G", true));
    assert_eq!(editing.cursor(), (2, 4));
    assert!(editing.move_to_text("G", true));
    assert_eq!(editing.cursor(), (3, 4));
    assert!(!editing.move_to_text("G", true));
    assert!(editing.move_to_text("G", false));
    assert_eq!(editing.cursor(), (2, 4));
    assert!(editing.move_to_text("N0020", true));
    assert_eq!(editing.cursor(), (3, 0));
    assert!(
        editing.move_to_text("N10", true),
        "numbers are found in front too"
    );
    assert_eq!(editing.cursor(), (2, 0));
    assert!(!editing.move_to_text("N0099", true) && !editing.move_to_text("", true));
    assert!(!editing.move_to_text("N2", true), "a whole number");
}

#[test]
fn the_cursor_walks_over_ends_of_lines() {
    let mut editing = editor_at(PART, 2, 10);
    editing.move_right();
    assert_eq!(editing.cursor(), (3, 0));
    editing.move_left();
    assert_eq!(editing.cursor(), (2, 10));
    editing.move_up();
    assert_eq!(editing.cursor(), (1, 5));
    editing.move_to_line(13);
    assert_eq!(editing.cursor(), (5, 0));
    editing.move_to_line(2);
    assert_eq!(editing.cursor(), (2, 0));
    editing.move_left();
    editing.move_to_head();
    editing.move_left();
    editing.move_up();
    assert_eq!(editing.cursor(), (1, 0));
}

#[test]
fn leaving_a_block_ends_it() {
    let mut editing = editor_at("O0001;\nM3;\n", 3, 0);
    type_text(&mut editing, "M5", Completion::default());
    editing.move_up();
    assert_eq!(editing.cursor(), (2, 2));
    assert_eq!(finished_text(&mut editing), "O0001;\nM3;\nM5;\n");
    let mut editing = editor_at("O0001;\nM3;\n", 3, 0);
    type_text(&mut editing, "M5", Completion::default());
    editing.move_down();
    assert_eq!(editing.cursor(), (4, 0));
}
