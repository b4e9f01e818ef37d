//! Drawings that are refused, each with its rule, and programs that a tool cannot cut.

use super::*;
use crate::{CutRule, OutlineFormat, ProgramOptions, RoughingValues};

fn refused_lines(corners: &[(f64, f64)]) -> String {
    refusal(&dxf_of_pieces(&lines(corners)))
}

#[test]
fn files_that_are_no_drawings() {
    for (file, rule) in [
        ("", "outline_no_drawing"),
        ("O0001\nG00 X0\n", "outline_no_drawing"),
        ("0\nEOF\n", "outline_no_sections"),
        ("0\nSECTION\nx\nHEADER\n", "outline_bad_group_code"),
        ("<svg><path", "outline_bad_xml"),
        ("<svg><path d='M0 0 L5'/></svg>", "outline_bad_path"),
        (
            "<svg><g transform='turn(3)'><line/></g></svg>",
            "outline_bad_transform",
        ),
        ("<svg><line x1='1e999'/></svg>", "outline_bad_number"),
        ("<svg/>", "outline_empty"),
    ] {
        assert_eq!(refusal(file), rule, "{file}");
    }
    let binary = read_drawing(b"AutoCAD Binary DXF\r\n\x1a\0").expect_err("binary");
    assert_eq!(binary.id().name(), "outline_binary_dxf");
}

#[test]
fn values_and_entities_that_are_not_read() {
    let line = "0\nLINE\n8\n0\n10\n0\n20\nNaN\n11\n5\n21\n5\n";
    assert_eq!(refusal(&dxf_file(4, line)), "outline_bad_number");
    let line = "0\nLINE\n8\n0\n10\n0\n20\n0\n11\n5\n";
    assert_eq!(refusal(&dxf_file(4, line)), "outline_value_missing");
    let line = "0\nLINE\n8\n0\n10\n0\n20\n0\n11\n5\n21\n1e300\n";
    assert_eq!(refusal(&dxf_file(4, line)), "outline_too_large");
    assert_eq!(refusal(&dxf_file(6, line)), "outline_too_large");
    assert_eq!(refusal(&dxf_file(19, "")), "outline_unknown_unit");
    assert_eq!(refusal(&dxf_file(4, "")), "outline_empty");
    let spline = dxf_file(4, "0\nSPLINE\n8\nPART\n70\n8\n");
    let message = profile_of(&spline).expect_err("a spline");
    assert_eq!(message.id().name(), "outline_unsupported");
    assert_eq!(message.find_value("kind"), Some("SPLINE"));
    assert_eq!(message.find_value("layer"), Some("PART"));
    assert_eq!(message.find_value("line"), Some("16"));
    let circle = "0\nCIRCLE\n8\n0\n10\n-10\n20\n0\n40\n-3\n";
    assert_eq!(refusal(&dxf_file(4, circle)), "outline_bad_number");
}

#[test]
fn outlines_that_are_not_one_chain() {
    let mut pieces = lines(&[(0.0, 0.0), (0.0, 5.0), (-15.0, 5.0)]);
    pieces.extend(lines(&[(-15.2, 5.0), (-15.2, 10.0), (-40.0, 10.0)]));
    let gap = profile_of(&dxf_of_pieces(&pieces)).expect_err("a gap");
    assert_eq!(gap.id().name(), "outline_gap");
    assert_eq!(gap.plain_value("gap"), Some("0.200"));
    let wider = ProfileOptions {
        gap: 0.3,
        ..ProfileOptions::default()
    };
    assert!(profile_with(&dxf_of_pieces(&pieces), &wider).is_ok());

    let mut branch = lines(&[(0.0, 0.0), (0.0, 5.0), (-15.0, 5.0), (-30.0, 9.0)]);
    branch.extend(lines(&[(-15.0, 5.0), (-15.0, 12.0)]));
    assert_eq!(refusal(&dxf_of_pieces(&branch)), "outline_branch");

    let square = |z: f64| lines(&[(z, 5.0), (z, 9.0), (z - 4.0, 9.0), (z - 4.0, 5.0), (z, 5.0)]);
    let two = [square(0.0), square(-10.0)].concat();
    assert_eq!(refusal(&dxf_of_pieces(&two)), "outline_separate");
    let crossing = [
        (0.0, 0.0),
        (0.0, 5.0),
        (-20.0, 5.0),
        (-20.0, 8.0),
        (-10.0, 2.0),
        (-30.0, 2.0),
    ];
    assert_eq!(refused_lines(&crossing), "outline_crossing");
    let open = [(-5.0, 5.0), (0.0, 5.0), (0.0, 8.0), (-40.0, 8.0)];
    assert_eq!(refused_lines(&open), "outline_open_side");
    let uneven = [(0.0, -4.0), (0.0, 5.0), (-30.0, 5.0)];
    assert_eq!(refused_lines(&uneven), "outline_not_symmetric");
}

/// The rule that a program of these lines breaks; `None` if it is written.
fn program_refusal(corners: &[(f64, f64)], options: &ProgramOptions) -> Option<String> {
    let profile = profile_of(&dxf_of_pieces(&lines(corners))).expect("an outline");
    let message = profile.write_program(options).err()?;
    Some(message.id().name().to_owned())
}

#[test]
fn directions_that_a_tool_cannot_follow() {
    let contour = |insert| ProgramOptions {
        format: OutlineFormat::Contour,
        insert,
        ..ProgramOptions::default()
    };
    let g71 = ProgramOptions::default();
    // A neck of 30 degrees.
    let neck = [
        (0.0, 0.0),
        (0.0, 10.0),
        (-10.0, 10.0),
        (-15.0, 7.113),
        (-20.0, 7.113),
        (-20.0, 12.0),
        (-30.0, 12.0),
    ];
    assert_eq!(
        program_refusal(&neck, &g71).as_deref(),
        Some("outline_descends")
    );
    assert_eq!(program_refusal(&neck, &contour(None)), None);
    assert_eq!(program_refusal(&neck, &contour(Some(35.0))), None);
    assert_eq!(program_refusal(&neck, &contour(Some(55.0))), None);
    let undercut = program_refusal(&neck, &contour(Some(80.0)));
    assert_eq!(undercut.as_deref(), Some("outline_undercut"));
    // An undercut face leans back by 6 degrees.
    let face = [
        (0.0, 0.0),
        (0.0, 10.0),
        (-20.0, 10.0),
        (-19.0, 20.0),
        (-30.0, 20.0),
    ];
    for options in [g71, contour(None), contour(Some(35.0))] {
        let refused = program_refusal(&face, &options);
        assert_eq!(refused.as_deref(), Some("outline_turns_back"));
    }
}

#[test]
fn arcs_that_turn_back_are_found_inside_the_piece() {
    // A bulge between two points of one diameter falls towards its end.
    let mut pieces = lines(&[(0.0, 0.0), (0.0, 10.0), (-20.0, 10.0)]);
    pieces[1].bulge = 0.2;
    let profile = profile_of(&dxf_of_pieces(&pieces)).expect("an outline");
    let refused = profile
        .check_directions(CutRule::Roughing)
        .expect_err("an arc");
    assert_eq!(refused.id().name(), "outline_descends");
    assert_eq!(refused.find_value("kind"), Some("ARC"));
    let finishing = CutRule::Finishing { insert: Some(35.0) };
    assert!(profile.check_directions(finishing).is_ok());
}

#[test]
fn values_outside_their_range() {
    let pin = [(0.0, 0.0), (0.0, 5.0), (-15.0, 5.0)];
    let base = RoughingValues::default();
    for values in [
        RoughingValues { depth: 0.0, ..base },
        RoughingValues {
            depth: f64::NAN,
            ..base
        },
        RoughingValues {
            feed: f64::INFINITY,
            ..base
        },
        RoughingValues {
            allowance_x: -1.0,
            ..base
        },
        RoughingValues { speed: 0, ..base },
        RoughingValues { tool: 0, ..base },
    ] {
        let options = ProgramOptions {
            values,
            ..ProgramOptions::default()
        };
        let refused = program_refusal(&pin, &options);
        assert_eq!(
            refused.as_deref(),
            Some("outline_value_range"),
            "{values:?}"
        );
    }
    let small = ProgramOptions {
        stock: Some(9.9),
        ..ProgramOptions::default()
    };
    assert_eq!(
        program_refusal(&pin, &small).as_deref(),
        Some("outline_small_stock")
    );
    let steps: Vec<(f64, f64)> = (0..120)
        .map(|index| (-f64::from(index), f64::from(index % 2 + index)))
        .map(|(z, x)| (z, x.max(0.0)))
        .collect();
    let refused = program_refusal(&steps, &ProgramOptions::default());
    assert!(refused.is_some(), "more than 100 blocks");
}

#[test]
fn all_gaps_and_branches_are_reported_with_their_place() {
    // Three pieces with two gaps, the smaller one first.
    let mut pieces = lines(&[(0.0, 0.0), (0.0, 5.0), (-15.0, 5.0)]);
    pieces.extend(lines(&[(-15.2, 5.0), (-15.2, 8.0), (-30.0, 8.0)]));
    pieces.extend(lines(&[(-30.1, 8.0), (-50.0, 8.0)]));
    let faults_of = |pieces: &[ProfilePiece]| {
        let drawing = read_drawing(dxf_of_pieces(pieces).as_bytes()).expect("a drawing");
        let found = drawing.find_profile_or_faults(&ProfileOptions::default());
        let faults = found.expect_err("faults");
        let position = |at: Point| (at.x, libm::round(at.z * 1e6) / 1e6);
        faults
            .iter()
            .map(|fault| (fault.message.id().name().to_owned(), fault.at.map(position)))
            .collect::<Vec<_>>()
    };
    let gap = "outline_gap".to_owned();
    let found = faults_of(&pieces);
    assert_eq!(found.len(), 2);
    for (fault, at) in found.iter().zip([[-30.0, -30.1], [-15.0, -15.2]]) {
        assert_eq!(fault.0, gap);
        let z = fault.1.expect("a place").1;
        assert!(at.contains(&z), "{z}");
    }
    // Two lines from corners of the outline upwards.
    let mut branched = lines(&[
        (0.0, 0.0),
        (0.0, 5.0),
        (-15.0, 5.0),
        (-15.0, 8.0),
        (-30.0, 8.0),
    ]);
    branched.extend(lines(&[(-15.0, 5.0), (-17.0, 4.0)]));
    branched.extend(lines(&[(-15.0, 8.0), (-12.0, 12.0)]));
    let mut places: Vec<_> = faults_of(&branched).into_iter().map(|it| it.1).collect();
    places.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    assert_eq!(places, [Some((5.0, -15.0)), Some((8.0, -15.0))]);
}
