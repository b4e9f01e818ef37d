//! Ways in which a part is drawn that give the same outline.

use gsk_units::Point;

use super::*;
use crate::{DrawingUnit, OutlineFormat, ProfileZero, ProgramOptions};

/// A stepped pin: diameters 10 and 20, lengths 15 and 40.
const PIN: [(f64, f64); 5] = [
    (0.0, 0.0),
    (0.0, 5.0),
    (-15.0, 5.0),
    (-15.0, 10.0),
    (-40.0, 10.0),
];
const PIN_CORNERS: [(f64, f64); 5] = [
    (0.0, 0.0),
    (10.0, 0.0),
    (10.0, -15.0),
    (20.0, -15.0),
    (20.0, -40.0),
];

#[test]
fn an_open_half_profile_is_followed_from_its_right_end() {
    let mut pieces = lines(&PIN);
    pieces.swap(0, 2);
    pieces[1] = pieces[1].reversed();
    let profile = profile_of(&dxf_of_pieces(&pieces)).expect("an outline");
    assert_eq!(corners_of(&profile), PIN_CORNERS);
}

#[test]
fn a_closed_half_loses_axis_and_back_face() {
    let mut corners = PIN.to_vec();
    corners.extend([(-40.0, 0.0), (0.0, 0.0)]);
    let profile = profile_of(&dxf_of_pieces(&lines(&corners))).expect("an outline");
    assert_eq!(corners_of(&profile), PIN_CORNERS);
    let notes: Vec<&str> = profile.notes.iter().map(|note| note.id().name()).collect();
    assert_eq!(notes, ["outline_note_axis", "outline_note_back_face"]);
}

#[test]
fn a_half_below_the_axis_is_mirrored() {
    let below = PIN.map(|(z, x)| (z, -x));
    let profile = profile_of(&dxf_of_pieces(&lines(&below))).expect("an outline");
    assert_eq!(corners_of(&profile), PIN_CORNERS);
}

#[test]
fn a_full_profile_with_edge_lines_gives_its_upper_half() {
    let upper = [(0.0, 5.0), (-15.0, 5.0), (-15.0, 10.0), (-40.0, 10.0)];
    let lower = upper.map(|(z, x)| (z, -x));
    let mut pieces = [lines(&upper), lines(&lower)].concat();
    // Faces through the axis, and the edge of the shoulder.
    for (z, x) in [(0.0, 5.0), (-40.0, 10.0), (-15.0, 10.0)] {
        pieces.extend(lines(&[(z, x), (z, -x)]));
    }
    // Beside the zero of the drawing, with a centre line.
    for piece in &mut pieces {
        *piece = piece.placed(1.0, Point::new(70.0, 120.0));
    }
    let outline: String = pieces.iter().map(|piece| dxf_entity(piece, "0")).collect();
    let center = dxf_entity(&lines(&[(60.0, 70.0), (130.0, 70.0)])[0], "0\n6\nCENTER2");
    let profile = profile_of(&dxf_file(4, &(outline.clone() + &center))).expect("an outline");
    assert_eq!(corners_of(&profile), PIN_CORNERS);
    // Without the centre line the axis is given.
    let options = ProfileOptions {
        zero: ProfileZero::At(Point::new(70.0, 100.0)),
        ..ProfileOptions::default()
    };
    let profile = profile_with(&dxf_file(4, &outline), &options).expect("an outline");
    let shifted = PIN_CORNERS.map(|(x, z)| (x, z + 20.0));
    assert_eq!(corners_of(&profile), shifted);
}

#[test]
fn a_circle_is_a_ball() {
    let circle = "0\nCIRCLE\n8\n0\n10\n-10\n20\n0\n40\n10\n";
    let profile = profile_of(&dxf_file(4, circle)).expect("an outline");
    let pieces: Vec<_> = profile.pieces().copied().collect();
    assert_eq!(pieces.len(), 1);
    assert!((pieces[0].radius() - 10.0).abs() < 1e-9);
    assert!((pieces[0].point_at(0.5) - Point::new(10.0, -10.0)).length() < 1e-9);
    let contour = ProgramOptions {
        format: OutlineFormat::Contour,
        ..ProgramOptions::default()
    };
    let text = profile.write_program(&contour).expect("a contour");
    assert_eq!(text, "G01 X0. Z0. F0.1\nG03 Z-20. R10.\n");
}

#[test]
fn the_section_of_a_tube_gives_its_outside() {
    let ring = [
        (0.0, 8.0),
        (0.0, 14.0),
        (-2.0, 15.0),
        (-30.0, 15.0),
        (-30.0, 9.0),
        (-12.0, 8.0),
        (0.0, 8.0),
    ];
    let profile = profile_of(&dxf_of_pieces(&lines(&ring))).expect("an outline");
    let expected = [(16.0, 0.0), (28.0, 0.0), (30.0, -2.0), (30.0, -30.0)];
    assert_eq!(corners_of(&profile), expected);
    let bore = profile
        .notes
        .iter()
        .find(|note| note.id().name() == "outline_note_bore");
    assert_eq!(
        bore.and_then(|note| note.plain_value("diameter")),
        Some("16.000")
    );
}

#[test]
fn inches_polylines_and_mirrored_planes_are_read() {
    let polyline = "0\nLWPOLYLINE\n8\n0\n90\n4\n70\n0\n10\n0\n20\n0\n10\n0\n20\n0.25\n42\n\
                    0.41421356237309503\n10\n-0.25\n20\n0.5\n10\n-1\n20\n0.5\n";
    let profile = profile_of(&dxf_file(1, polyline)).expect("an outline");
    assert_eq!(
        corners_of(&profile),
        [(0.0, 0.0), (12.7, 0.0), (25.4, -6.35), (25.4, -25.4)]
    );
    let arc = profile
        .pieces()
        .find(|piece| piece.is_arc())
        .expect("an arc");
    assert!((arc.radius() - 6.35).abs() < 1e-9);

    let vertex = |z: f64, x: f64| format!("0\nVERTEX\n8\n0\n10\n{z}\n20\n{x}\n30\n0\n");
    // Seen from the other side of its plane the polyline is mirrored left to right.
    let corners = [
        (0.0, 0.0),
        (0.0, 5.0),
        (15.0, 5.0),
        (15.0, 10.0),
        (40.0, 10.0),
    ];
    let vertices: String = corners.iter().map(|(z, x)| vertex(*z, *x)).collect();
    let head = "0\nPOLYLINE\n8\n0\n66\n1\n70\n0\n210\n0\n220\n0\n230\n-1\n";
    let file = dxf_file(4, &format!("{head}{vertices}0\nSEQEND\n"));
    assert_eq!(
        corners_of(&profile_of(&file).expect("an outline")),
        PIN_CORNERS
    );
}

#[test]
fn layers_are_selected_and_hidden_ones_left_out() {
    let frame = lines(&[(-200.0, 90.0), (50.0, 90.0), (50.0, -90.0)]);
    let mut entities: String = frame
        .iter()
        .map(|piece| dxf_entity(piece, "图框"))
        .collect();
    entities += &lines(&PIN)
        .iter()
        .map(|piece| dxf_entity(piece, "轮廓"))
        .collect::<String>();
    let file = dxf_file(4, &entities);
    assert_eq!(refusal(&file), "outline_gap");
    let options = ProfileOptions {
        layers: vec!["轮廓".to_owned()],
        ..ProfileOptions::default()
    };
    let profile = profile_with(&file, &options).expect("an outline");
    assert_eq!(corners_of(&profile), PIN_CORNERS);

    let off = "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n0\nLAYER\n2\n图框\n70\n0\n62\n-7\n0\n\
               ENDTAB\n0\nENDSEC\n";
    let hidden = file.replacen(
        "0\nSECTION\n2\nENTITIES",
        &format!("{off}0\nSECTION\n2\nENTITIES"),
        1,
    );
    assert_eq!(
        corners_of(&profile_of(&hidden).expect("an outline")),
        PIN_CORNERS
    );
    // The same file in the code page of a Chinese CAD program.
    let page = "9\n$DWGCODEPAGE\n3\nANSI_936\n9\n$INSUNITS";
    let text = file.replacen("9\n$INSUNITS", page, 1);
    let bytes = encoding_rs::GBK.encode(&text).0;
    let drawing = read_drawing(&bytes).expect("a drawing");
    assert_eq!(drawing.layers()[1].name, "轮廓");
    assert_eq!(drawing.layers()[1].pieces, 4);
}

#[test]
fn svg_paths_shapes_and_transforms_are_read() {
    let path = r#"<svg viewBox="0 0 100 50" width="100mm" height="50mm"><g id="part">
        <path d="M 80 30 v-5 h-15 v-5 h-25"/></g><text>10</text></svg>"#;
    let profile = profile_of(path).expect("an outline");
    assert_eq!(corners_of(&profile), PIN_CORNERS);

    let turned = r#"<svg width="50mm" viewBox="0 0 100 100">
        <g transform="translate(50 60) rotate(90) scale(2)">
        <polyline points="0,0 -5,0 -5,15 -10,15 -10,40"/></g></svg>"#;
    let profile = profile_of(turned).expect("an outline");
    assert_eq!(corners_of(&profile), PIN_CORNERS);

    let arcs = r#"<svg><path d="M0,0 A5 5 0 0 0 -5 -5 H-15 C-15 -7.76142 -17.23858 -10 -20 -10 H-40"/></svg>"#;
    let profile = profile_of(arcs).expect("an outline");
    let corners = corners_of(&profile);
    assert_eq!(corners.first(), Some(&(0.0, 0.0)));
    assert_eq!(corners[1], (10.0, -5.0));
    assert_eq!(corners.last(), Some(&(20.0, -40.0)));
    let radii: Vec<f64> = profile
        .pieces()
        .filter(|it| it.is_arc())
        .map(ProfilePiece::radius)
        .collect();
    assert!(
        radii.iter().all(|radius| (radius - 5.0).abs() < 0.1),
        "{radii:?}"
    );
    let notes: Vec<&str> = profile.notes.iter().map(|note| note.id().name()).collect();
    assert!(notes.contains(&"outline_note_fitted"), "{notes:?}");
}

#[test]
fn units_can_be_given() {
    let file = dxf_of_pieces(&lines(&PIN)).replacen("70\n4", "70\n0", 1);
    let profile = profile_of(&file).expect("an outline");
    assert_eq!(profile.notes[0].id().name(), "outline_note_unit");
    let options = ProfileOptions {
        unit: Some(DrawingUnit::Centimetre),
        zero: ProfileZero::Left,
        ..ProfileOptions::default()
    };
    let profile = profile_with(&file, &options).expect("an outline");
    assert_eq!(corners_of(&profile)[0], (0.0, 400.0));
}

#[test]
fn a_whole_program_is_written() {
    let mut pieces = lines(&PIN);
    pieces[2] = ProfilePiece {
        bulge: 0.2,
        end: Point::new(10.0, -18.0),
        ..pieces[2]
    };
    pieces[3].start = pieces[2].end;
    let profile = profile_of(&dxf_of_pieces(&pieces)).expect("an outline");
    let options = ProgramOptions {
        name: "pin (1).dxf".to_owned(),
        ..ProgramOptions::default()
    };
    let text = profile.write_program(&options).expect("a program");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "O0001 (pin 1.dxf)");
    let begin = lines
        .iter()
        .position(|line| *line == "N10 G00 X0.")
        .expect("N10");
    assert_eq!(lines[begin - 3], "G00 X24. Z2.");
    assert_eq!(lines[begin - 2], "G71 U1.5 R0.5");
    assert_eq!(lines[begin - 1], "G71 P10 Q20 U0.4 W0.1 F0.2");
    assert_eq!(lines[begin + 1], "G01 Z0. F0.1");
    assert_eq!(lines[begin + 2..begin + 4], ["X10.", "Z-15."]);
    assert_eq!(lines[begin + 4], "G03 X20. Z-18. R7.58");
    assert_eq!(
        lines[begin + 5..begin + 7],
        ["N20 G01 Z-40.", "G70 P10 Q20"]
    );
}
