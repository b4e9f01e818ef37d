//! Parts of contours with arcs, undercuts, G41 and G42, and outlines from drawings.

use gsk_forms::{
    FormKind, FormValues, drawn_outline, find_sections, outline_of_profile, program_job, write_form,
};
use gsk_outline::{ProfileOptions, read_drawing};
use gsk_workpiece::measure::SectionSide;

use super::cut::CutPart;

/// Cuts a contour and compares the part with the middle of each line and arc.
fn check_contour(fields: &[(&str, &str)]) -> CutPart {
    let mut values = FormValues::new(FormKind::Contour);
    for (id, text) in fields {
        values.set_text(id, text).unwrap();
    }
    let section = write_form(&values);
    let section = section.unwrap_or_else(|error| panic!("{fields:?}: {error:?}"));
    let found = find_sections(&section);
    assert_eq!(*found[0].values.as_ref().unwrap(), values.complete());
    let outline = drawn_outline(&values);
    let part = CutPart::cut(values, section);
    let side = match part.is_inside() {
        true => SectionSide::Inside,
        false => SectionSide::Outside,
    };
    for piece in &outline.pieces {
        let middle = piece.point_at(0.5);
        part.assert_passes(side, middle.x * 2.0, middle.z);
    }
    part
}

#[test]
fn arcs_are_cut_outside_and_inside() {
    for nose in ["0", "0.4", "0.8"] {
        let ball = "X0/X4/CCW8TA0/Z-15/CW6T/X50A40/CCW5TA0/Z-50";
        check_contour(&[("POINTS", ball), ("STOCK", "60"), ("NOSE", nose)]);
        let inside = "X60C1/Z-8/CCW5TA60/X40A60/CW3TA0/Z-45";
        check_contour(&[
            ("SIDE", "IN"),
            ("POINTS", inside),
            ("HOLE", "28"),
            ("NOSE", nose),
        ]);
    }
}

#[test]
fn undercuts_are_cut_with_a_pointed_insert() {
    let neck = "X20C1/Z-10/X14A-30R1/Z-25R1/X24A30/Z-35/X34Z-42CW12/Z-50";
    let mut values = FormValues::new(FormKind::Contour);
    values.set_text("POINTS", neck).unwrap();
    assert!(write_form(&values).is_err(), "undercuts are refused");
    for nose in ["0", "0.4"] {
        let part = check_contour(&[
            ("POINTS", neck),
            ("UNDER", "YES"),
            ("STOCK", "40"),
            ("NOSE", nose),
        ]);
        assert!(part.section.contains("G73 U"), "{}", part.section);
        assert!(part.section.contains("G70 P102 Q103"), "{}", part.section);
    }
    values.set_text("UNDER", "YES").unwrap();
    values.set_text("INSERT", "80").unwrap();
    let error = write_form(&values).unwrap_err();
    assert_eq!(error.rule.id().name(), "form_outline_insert");
}

#[test]
fn a_neck_narrower_than_the_nose_is_refused() {
    let mut values = FormValues::new(FormKind::Contour);
    for (id, text) in [
        ("POINTS", "X20/Z-10/X19A-30/X20A30/Z-30"),
        ("UNDER", "YES"),
        ("NOSE", "2.4"),
    ] {
        values.set_text(id, text).unwrap();
    }
    let error = write_form(&values).unwrap_err();
    assert_eq!(error.rule.id().name(), "form_corner_below_nose");
}

#[test]
fn the_control_allows_for_the_nose_with_g41_and_g42() {
    let points = "X16C1/Z-15/X30A30R3/Z-35R2/X44Z-42CCW9/Z-50";
    let part = check_contour(&[("POINTS", points), ("COMP", "G41"), ("NOSE", "0.8")]);
    assert!(part.section.contains("N100 G42 G00 X"), "{}", part.section);
    assert!(part.section.contains("N101 G40 "), "{}", part.section);
    let inside = "X60C1/Z-10/X40A45R2/Z-35";
    let part = check_contour(&[
        ("SIDE", "IN"),
        ("POINTS", inside),
        ("HOLE", "30"),
        ("COMP", "G41"),
    ]);
    assert!(part.section.contains("N100 G41 G00 X"), "{}", part.section);
}

#[test]
fn the_outline_of_a_drawing_becomes_points() {
    let svg = br#"<svg><path d="M0,0 A5 5 0 0 0 -5 -5 H-15 A5 5 0 0 1 -20 -10 H-30 L-40 -8 H-45
        V-14 H-60"/></svg>"#;
    let profile = read_drawing(svg)
        .unwrap()
        .find_profile(&ProfileOptions::default())
        .unwrap();
    let outline = outline_of_profile(&profile).unwrap();
    assert_eq!(
        outline.to_string(),
        "X0Z0/X10Z-5CCW5/X10Z-15/X20Z-20CW5/X20Z-30/X16Z-40/X16Z-45/X28Z-45/X28Z-60"
    );
    let part = check_contour(&[
        ("POINTS", &outline.to_string()),
        ("UNDER", "YES"),
        ("STOCK", "30"),
    ]);
    let text = format!("O0001\n{}M30\n", part.section);
    let job = program_job(&text).unwrap();
    assert!(job.stock.overhang > 60.0);
    assert_eq!(job.tools.len(), 1);
    assert_eq!(program_job("O0001\nM30\n"), None);
}
