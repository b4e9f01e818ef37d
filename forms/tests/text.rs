//! The text of forms: comments, changes by hand, errors, the thread table.

#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use gsk_forms::{
    FormKind, FormValues, find_sections, find_thread, form_fields, free_sequence_number,
    thread_rows, whole_program, write_form,
};
use gsk_messages::Language;
use gsk_workpiece::cutting::CuttingMaterial;

fn section(form: FormKind) -> String {
    write_form(&FormValues::new(form)).unwrap()
}

#[test]
fn every_form_writes_its_defaults_in_ascii() {
    for form in FormKind::ALL {
        let text = section(form);
        assert!(text.is_ascii(), "{text}");
        assert!(text.lines().all(|line| line.len() <= 72), "{text}");
        let first = text.lines().next().unwrap();
        assert!(
            first.starts_with(&format!("(FORM {} ", form.word())),
            "{first}"
        );
        assert_eq!(FormKind::from_word(&form.word().to_uppercase()), Some(form));
        for field in form_fields(form) {
            let twins = form_fields(form).iter().filter(|it| it.id == field.id);
            assert_eq!(twins.count(), 1, "{} of {form:?}", field.id);
        }
    }
}

#[test]
fn a_change_by_hand_is_noticed() {
    let text = section(FormKind::Turn);
    let is_edited = |text: &str| find_sections(text)[0].is_edited;
    assert!(!is_edited(&text));
    // The control may store a block with other blanks and line ends.
    assert!(!is_edited(
        &text
            .replace("G71 U2. R0.5", "G71U2.R0.5")
            .replace('\n', "\r\n")
    ));
    assert!(is_edited(&text.replace("G71 U2.", "G71 U3.")));
    assert!(is_edited(&text.replace("G70 P100 Q101\n", "")));
    assert!(is_edited(&text.replace("(FORM END", "(END")));
}

#[test]
fn a_long_outline_is_split_into_comment_lines() {
    let points: Vec<String> = (0..40)
        .map(|index| format!("X{}.125Z-{}.375C0.125", 20 + index, index))
        .collect();
    let mut values = FormValues::new(FormKind::Contour);
    values.set_text("POINTS", &points.join(";")).unwrap();
    values.set_text("STOCK", "70").unwrap();
    values.set_text("NOSE", "0").unwrap();
    let text = write_form(&values).unwrap();
    assert!(text.lines().all(|line| line.len() <= 72), "{text}");
    let found = find_sections(&text);
    assert_eq!(*found[0].values.as_ref().unwrap(), values.complete());
    assert!(!found[0].is_edited);
}

#[test]
fn sections_are_found_among_other_blocks() {
    let (one, two) = (section(FormKind::Face), section(FormKind::Thread));
    let text = format!("O0001\nG00 X100 (FORM)\n{one}M01\n(FORM odd X=1)\n{two}M30\n%\n");
    let found = find_sections(&text);
    let forms: Vec<Option<FormKind>> = found
        .iter()
        .map(|it| it.values.as_ref().ok().map(FormValues::form))
        .collect();
    assert_eq!(forms, [Some(FormKind::Face), None, Some(FormKind::Thread)]);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(found[0].lines.start, 2);
    assert_eq!(lines[found[0].lines.clone()].join("\n") + "\n", one);
    assert_eq!(lines[found[2].lines.clone()].join("\n") + "\n", two);
}

#[test]
fn sequence_numbers_of_a_program_are_avoided() {
    let program = whole_program(7, &section(FormKind::Turn));
    assert!(program.starts_with("O0007\n") && program.ends_with("M30\n%\n"));
    assert_eq!(free_sequence_number(&program), 110);
    assert_eq!(free_sequence_number("N9 G00\n"), 100);
    assert_eq!(free_sequence_number("n101 G00\n"), 110);
}

#[test]
fn defaults_of_a_form_that_was_read_follow_other_fields_again() {
    let mut values = FormValues::new(FormKind::Turn);
    values.set_text("D", "36").unwrap();
    let text = write_form(&values).unwrap();
    let mut read = find_sections(&text)[0].values.clone().unwrap();
    assert_eq!(read.without_defaults(), values);
    assert_eq!(write_form(&read.without_defaults()).unwrap(), text);
    read.set_text("D", "30").unwrap();
    assert!(write_form(&read).is_err(), "the front keeps its 36 mm");
    read = find_sections(&text)[0]
        .values
        .clone()
        .unwrap()
        .without_defaults();
    read.set_text("D", "30").unwrap();
    assert!(write_form(&read).unwrap().contains("DF=30"));
}

#[test]
fn errors_name_the_field_and_the_rule() {
    type Case = (
        FormKind,
        &'static [(&'static str, &'static str)],
        &'static str,
    );
    let cases: [Case; 15] = [
        (FormKind::Face, &[("BORE", "60")], "BORE: must be less"),
        (
            FormKind::Face,
            &[("ALLOW", "50"), ("DEPTH", "0.1")],
            "DEPTH: more than",
        ),
        (FormKind::Turn, &[("D", "60")], "STOCK: the stock must be"),
        (FormKind::Turn, &[("DF", "45")], "DF: the front"),
        (FormKind::Turn, &[("R", "0.2")], "narrower than the nose"),
        (
            FormKind::Turn,
            &[("EDGE", "CHAMFER"), ("C", "40")],
            "does not fit",
        ),
        (
            FormKind::Turn,
            &[("SAFEX", "50")],
            "SAFEX: must be at least 52",
        ),
        (FormKind::Bore, &[("D", "10")], "HOLE: the hole must"),
        (
            FormKind::Contour,
            &[("POINTS", "X20;Z-10;X15;Z-20")],
            "POINTS: at X15 Z-10",
        ),
        (
            FormKind::Contour,
            &[("POINTS", "X20")],
            "POINTS: the outline needs",
        ),
        (FormKind::Groove, &[("TW", "6")], "TW: the blade"),
        (FormKind::Groove, &[("DB", "45")], "DB: the bottom"),
        (
            FormKind::Thread,
            &[("S", "5000")],
            "S: must be at most 4000",
        ),
        (
            FormKind::Thread,
            &[("LAST", "0.5"), ("THREAD", "M3")],
            "LAST: must be less",
        ),
        (
            FormKind::Thread,
            &[("THREAD", "NPT1"), ("STARTS", "2")],
            "STARTS: a taper",
        ),
    ];
    for (form, values, wanted) in cases {
        let mut filled = FormValues::new(form);
        for (id, text) in values {
            filled.set_text(id, text).unwrap();
        }
        let error = write_form(&filled).unwrap_err();
        let text = error.message().text(Language::En);
        assert!(text.contains(wanted), "{form:?} {values:?}: {text}");
    }
    for (id, text, wanted) in [
        ("D", "abc", "D: abc is not a number"),
        (
            "D",
            "1.2345",
            "D: 1.2345 is not a number with at most three",
        ),
        ("D", "0.5", "D: 0.5 is not between 1 and 500"),
        ("TOOL", "1.5", "TOOL: 1.5 must be a whole number"),
        (
            "EDGE",
            "round",
            "EDGE: round is not one of SHARP CHAMFER RADIUS",
        ),
        ("Q", "1", "no field Q"),
    ] {
        let error = FormValues::new(FormKind::Turn)
            .set_text(id, text)
            .unwrap_err();
        let shown = error.message().text(Language::En);
        assert!(shown.contains(wanted), "{shown}");
    }
}

#[test]
fn threads_agree_with_the_formulas_of_their_standards() {
    let near =
        |found: f64, wanted: f64| assert!((found - wanted).abs() < 0.001, "{found} {wanted}");
    let mut count = 0;
    for row in thread_rows() {
        let (d, p) = (row.diameter_mm, row.pitch.mm());
        let (outside, inside) = (row.profile(false), row.profile(true));
        match row.standard.source() {
            // ISO 724 and ISO 68-1, with the rounded root of ISO 965-1.
            "ISO 261" | "ISO 262" | "ASME B1.1" => {
                near(outside.pitch_diameter, d - 0.649_519 * p);
                near(inside.blank, d - 1.082_532 * p);
                near(outside.root, d - 1.226_869 * p);
                near(outside.depth(), 0.613_434 * p);
                near(inside.depth(), 0.541_266 * p);
            }
            "ISO 228-1" => {
                near(outside.pitch_diameter, d - 0.640_327 * p);
                near(outside.root, d - 1.280_654 * p);
                near(inside.blank, outside.root);
            }
            "ISO 2904" => {
                near(outside.pitch_diameter, d - 0.5 * p);
                near(inside.blank, d - p);
                near(outside.depth(), inside.depth());
            }
            _ => {
                near(outside.depth(), 0.8 * p);
                near(
                    inside.pitch_diameter - outside.pitch_diameter,
                    row.gauge_mm / 16.0,
                );
            }
        }
        assert_eq!(find_thread(&row.designation.to_uppercase()), Some(count));
        count += 1;
    }
    assert_eq!(count, 146);
}

/// Diameters as the standards print them.
#[test]
fn threads_have_the_printed_diameters() {
    // Designation, pitch diameter, minor diameter inside, minor diameter outside or bottom.
    for (name, d2, d1, d3) in [
        ("M6", 5.350, 4.917, 4.773),
        ("M10", 9.026, 8.376, 8.160),
        ("M12", 10.863, 10.106, 9.853),
        ("M20", 18.376, 17.294, 16.933),
        ("M20x1.5", 19.026, 18.376, 18.160),
        ("M36x3", 34.051, 32.752, 32.319),
        ("1/2-13UNC", 11.430, 10.584, 10.302),
        ("1/4-28UNF", 5.761, 5.368, 5.237),
        ("G1/2", 19.793, 18.631, 18.631),
        ("G1", 31.770, 30.291, 30.291),
        ("Tr20x4", 18.0, 16.0, 15.5),
        ("Tr40x7", 36.5, 33.0, 32.0),
    ] {
        let row = thread_rows().nth(find_thread(name).unwrap()).unwrap();
        let (outside, inside) = (row.profile(false), row.profile(true));
        for (found, wanted) in [
            (outside.pitch_diameter, d2),
            (inside.blank, d1),
            (outside.root, d3),
        ] {
            assert!((found - wanted).abs() < 0.001, "{name}: {found}, {wanted}");
        }
    }
    // ASME B1.20.1, table 2: E0 and E1 of NPT 1/2 and NPT 1, inches.
    for (name, e0, e1) in [("NPT1/2", 0.758_43, 0.778_43), ("NPT1", 1.213_63, 1.238_63)] {
        let row = thread_rows().nth(find_thread(name).unwrap()).unwrap();
        assert!(
            (row.profile(false).pitch_diameter / 25.4 - e0).abs() < 0.000_05,
            "{name}"
        );
        assert!(
            (row.profile(true).pitch_diameter / 25.4 - e1).abs() < 0.000_05,
            "{name}"
        );
    }
}

#[test]
fn a_material_sets_speed_feed_and_depth_within_the_nose() {
    let material = CuttingMaterial::from_name("C45").expect("in the table");
    let mut values = FormValues::new(FormKind::Turn);
    assert_eq!(values.propose(&material), Ok(true));
    let text = |values: &FormValues, id| values.text(values.field(id).expect("a field"));
    assert_eq!(text(&values, "S"), "175");
    // The nose of 0.4 mm permits 0.27 mm, the table proposes 0.25 mm.
    assert_eq!(text(&values, "F"), "0.25");
    assert_eq!(text(&values, "DEPTH"), "2");
    values.set_text("NOSE", "0.2").expect("a nose");
    assert_eq!(values.propose(&material), Ok(true));
    assert_eq!(text(&values, "F"), "0.13");
    assert!(write_form(&values).expect("blocks").contains("G96 S175"));
    let mut thread = FormValues::new(FormKind::Thread);
    assert_eq!(thread.propose(&material), Ok(false));
}
