//! Ported texts, word by word.

use gsk_messages::Language;

use crate::{ForeignDialect, MachineNeeds, PlainNumbers, PortOptions, guess_dialect, port_program};

fn port(dialect: ForeignDialect, text: &str) -> String {
    port_program(text, dialect, PortOptions::default()).text
}

fn fanuc(text: &str) -> String {
    port(ForeignDialect::Fanuc0t, text)
}

fn first_finding(dialect: ForeignDialect, text: &str) -> String {
    let ported = port_program(text, dialect, PortOptions::default());
    let first = ported.findings.first().expect("a finding");
    format!("{}: {}", first.line, first.message().text(Language::En))
}

#[test]
fn numbers_without_a_point_are_increments_unless_an_option_says_otherwise() {
    assert_eq!(fanuc("G00X1500Z-200\n"), "G00X1.5Z-0.2\n");
    assert_eq!(fanuc("G00 X15. Z0\n"), "G00 X15. Z0\n");
    let options = PortOptions {
        plain_numbers: Some(PlainNumbers::AsWritten),
        starts_in_inches: true,
    };
    let ported = port_program("G00X1Z-2.5\n", ForeignDialect::Fanuc0t, options);
    assert_eq!(ported.text, "G00X25.4Z-63.5\n");
}

#[test]
fn roundings_of_inch_increments_do_not_add_up() {
    let text = "G20 G99\nG0 X1. Z0\nG1 U.0001 F.01\nU.0001\nU.0001\nU.0001\n";
    let ported = fanuc(text);
    let sum: f64 = (ported.lines().skip(2))
        .filter_map(|line| line.split_once('U'))
        .filter_map(|(_, rest)| rest.split(' ').next()?.parse::<f64>().ok())
        .sum();
    assert!((sum - 0.0004 * 25.4).abs() < 0.000_51, "{ported}");
}

#[test]
fn leads_and_tapers_change_their_letters() {
    let ten = ForeignDialect::Fanuc10t;
    assert_eq!(
        port(ten, "G92 X30. Z-20. I-1. E1.5\nX29. I-1.\n"),
        "G92 X30. Z-20. R-1. F1.5\nX29. R-1.\n"
    );
    assert_eq!(port(ten, "G32 Z-20. E2.\n"), "G32 Z-20. F2.\n");
    assert_eq!(
        port(ForeignDialect::Haas, "M24\nG92 X30. Z-20. F1.5\nX29.\n"),
        "(M24)\nG92 X30. Z-20. F1.5 J0 K0\nX29.\n"
    );
    assert_eq!(
        port(ForeignDialect::LinuxCnc, "G7 G90\nG33 Z-20 K1.5\n"),
        "(G7 G90)\nG32 Z-20 F1.5\n"
    );
}

#[test]
fn corners_between_slanted_lines_become_blocks() {
    let text = "G0 X20. Z0\nG98 G1 Z-10. ,R2. F99.\nX40. Z-20.\n";
    assert_eq!(
        fanuc(text),
        "G0 X20. Z0\nG98 G1 F99. Z-9.172\nG02 X21.172 Z-10.586 R2.\nG01\nX40. Z-20.\n"
    );
    assert_eq!(
        fanuc("G0 X20. Z0\nG98 G1 Z-10. ,C2. F99.\nX40.\n"),
        "G0 X20. Z0\nG98 G1 Z-10. F99. I2.\nX40.\n"
    );
    let refused = first_finding(ForeignDialect::Fanuc0t, "G98 G1 Z-10.,C2. F99.\nM30\n");
    assert!(refused.starts_with("1: ,C2. is not ported"), "{refused}");
}

#[test]
fn drilling_becomes_moves() {
    assert_eq!(
        port(
            ForeignDialect::Haas,
            "G99\nG0 X0 Z5.\nG84 Z-20. R3. F1.25\nG80\n"
        ),
        "G99\nG0 X0 Z5.\nG00 Z3.\nG33 Z-20. F1.25\nM03\nG00 Z5.\n(G80)\n"
    );
    assert_eq!(
        port(
            ForeignDialect::Haas,
            "G99\nG0 X0 Z5.\nG83 Z-3. R1. Q2. F0.1\n"
        ),
        "G99\nG0 X0 Z5.\nG00 Z1.\nG01 Z-1. F0.1\nG00 Z1.\nG00 Z-0.5\nG01 Z-3.\nG00 Z5.\n"
    );
}

#[test]
fn calls_have_their_count_before_the_number() {
    assert_eq!(fanuc("M98 P12 L3\n"), "G99\nM98 P30012\n");
    assert_eq!(fanuc("G98\nM98 P51002\n"), "G98\nM98 P51002\n");
    assert_eq!(
        port(
            ForeignDialect::Haas,
            "O1\nM97 P50 L2\nM30\nN50 G0 Z1.\nM99\n"
        ),
        "O1\nG99\nM98 P29001\nM30\nO9001\nN50 G0 Z1.\nM99\n"
    );
    let refused = first_finding(
        ForeignDialect::Haas,
        "O1\nM97 P50\nG0 X1.\nN50 G0 Z1.\nM99\n",
    );
    assert!(refused.starts_with("2: P50 is not ported"), "{refused}");
}

#[test]
fn machine_codes_follow_the_machine() {
    assert_eq!(fanuc("M03\nM04\n"), "M03\nM05\nM04\n");
    assert_eq!(fanuc("N5 M01 (CHECK)\n"), "/N5 M00 (CHECK)\n");
    assert_eq!(fanuc("G0 X1. M01\n"), "G0 X1.\n/M00\n");
    assert_eq!(port(ForeignDialect::Haas, "M10\nM11\n"), "M12\nM13\n");
    let refused = first_finding(ForeignDialect::Fanuc0t, "M61\n");
    assert!(refused.starts_with("1: M61 is not ported"), "{refused}");
    assert_eq!(
        port(ForeignDialect::Mach3, "T2 M6\nT3\nM6\n"),
        "T0202\n(T3)\nT0303\n"
    );
}

#[test]
fn coordinate_systems_and_returns() {
    let haas = ForeignDialect::Haas;
    assert_eq!(port(haas, "G54 G0 X1.\nG54\n"), "G0 X1.\n(G54)\n");
    let refused = first_finding(haas, "G54 G0 X1.\nG55 X2.\n");
    assert!(refused.starts_with("2: G55 is not ported"), "{refused}");
    assert_eq!(port(haas, "G53 G0 X0 Z0 M9\n"), "G00\nG28 U0 W0 M9\n");
    assert!(first_finding(haas, "G53 X-100.\n").contains("G53 X-100."));
    assert_eq!(port(haas, "G30 P2 U0\n"), "G28 U0\n");
}

#[test]
fn radius_mode_doubles_x() {
    assert_eq!(
        port(
            ForeignDialect::LinuxCnc,
            "G8\nG1 X10 Z-5 F100\nG2 X12 Z-7 I2 K0\n"
        ),
        "(G8)\nG1 X20. Z-5 F100\nG2 X24. Z-7 I2 K0\n"
    );
}

#[test]
fn variables_of_macro_a_are_renumbered() {
    assert_eq!(
        fanuc("G65 H01 P#100 Q1500\nG0 X#100\n"),
        "G65 H01 P#200 Q1500\nG0 X#200\n"
    );
    let refused = first_finding(ForeignDialect::Fanuc0t, "#100=#101+1\n");
    assert!(refused.contains("is not ported"), "{refused}");
}

#[test]
fn a_profile_keeps_motion_and_feed_only() {
    let text = "G99\nG0 X50. Z2.\nG71 U2. R1.\nG71 P1 Q2 U0.4 W0.1 F0.2 S500\n\
                N1 G0 G42 X20. Z2. S900\nN2 G1 Z-20. F0.1\n";
    assert_eq!(
        fanuc(text),
        "G99\nG0 X50. Z2.\nG71 U2. R1.\nG71 P1 Q2 U0.4 W0.1 F0.2 S500\n\
         N1 G0 X20.\nN2 G1 Z-20. F0.1\n"
    );
}

#[test]
fn a_corner_in_a_numbered_block_without_a_code_keeps_its_line() {
    assert_eq!(
        fanuc("G98 G1 X20. Z0 F99.\nN30 Z-10. ,C2.\nX40. Z-20.\n"),
        "G98 G1 X20. Z0 F99.\nN30 Z-8.\nG01 X22.828 Z-11.414\nX40. Z-20.\n"
    );
}

#[test]
fn distances_after_a_corner_count_from_the_corner() {
    // From the end of the chamfer to the corner plus U and W.
    assert_eq!(
        fanuc("G98 G1 X20. Z0 F99.\nZ-10. ,C2.\nU20. W-10. ,C1.\nW-5.\n"),
        "G98 G1 X20. Z0 F99.\nZ-8.\nG01 X22.828 Z-11.414\nX38.586 Z-19.293\nG01 X40. Z-21.\nW-4.\n"
    );
    // Two corners do not fit on a line of 14 mm.
    let refused = first_finding(
        ForeignDialect::Fanuc0t,
        "G98 G1 X20. Z0 F99.\nZ-10. ,C8.\nX40. Z-20. ,C8.\nZ-40.\n",
    );
    assert!(refused.starts_with("3: ,C8. is not ported"), "{refused}");
    // The control's own chamfer needs a block after it that moves the other axis only.
    assert_eq!(
        fanuc("G98 G1 X20. Z0 F99.\nZ-10. ,C1.\nX40. ,C2.\nX50. Z-20.\n"),
        "G98 G1 X20. Z0 F99.\nZ-10. I1.\nX36.\nG01 X41.789 Z-11.789\nX50. Z-20.\n"
    );
}

#[test]
fn corners_beside_arcs_become_blocks() {
    // Into a quarter of a circle about X20 Z-20. The centre of the corner arc is at X24, 12 mm from
    // there: Z-8.168.
    assert_eq!(
        fanuc("G98 G1 X20. Z0 F99.\nZ-10. ,R2.\nG3 X40. Z-20. R10.\nG1 Z-30.\n"),
        "G98 G1 X20. Z0 F99.\nZ-8.168\nG02 X23.333 Z-10.14 R2.\nG3 X40. Z-20. R10.\nG1 Z-30.\n"
    );
    // The same with its centre: distances and centre count from the end of the corner.
    assert_eq!(
        fanuc("G98 G1 X20. Z0 F99.\nZ-10. ,R2.\nG3 U20. W-10. K-10.\nG1 Z-30.\n"),
        "G98 G1 X20. Z0 F99.\nZ-8.168\nG02 X23.333 Z-10.14 R2.\n\
         G3 U16.667 W-9.86 K-9.86 I-1.667\nG1 Z-30.\n"
    );
    // Chamfers have 2 mm straight from the corner, on the arc as a chord.
    assert_eq!(
        fanuc("G98 G1 X20. Z-10. F99.\nG3 X40. Z-20. R10. ,C2.\nG1 X50.\n"),
        "G98 G1 X20. Z-10. F99.\nG3 R10. X39.6 Z-18.01\nG01 X44. Z-20.\nG1 X50.\n"
    );
    // Between two arcs, the second without its code.
    assert_eq!(
        fanuc("G98 G1 X20. Z0 F99.\nG3 X40. Z-10. R10. ,C1.\nX60. Z-20. R10.\n"),
        "G98 G1 X20. Z0 F99.\nG3 R10. X39.9 Z-9.001\nG01 X41.997 Z-10.05\nG03 X60. Z-20. R10.\n"
    );
}

#[test]
fn corners_beside_arcs_are_refused_where_they_are_not_certain() {
    let start = "G98 G1 X20. Z0 F99.\n";
    for (text, dialect, wanted) in [
        (
            "Z-10. ,R9.\nG2 X30. Z-15. R5.\n",
            ForeignDialect::Fanuc0t,
            "2: ,R9. is not ported",
        ),
        (
            "Z-10. R1.\nG2 X30. Z-15. R5.\n",
            ForeignDialect::Fanuc0t,
            "write ,C or ,R",
        ),
        (
            "Z-10. I1.\nG2 X30. Z-15. R5.\n",
            ForeignDialect::Fanuc0t,
            "write ,C or ,R",
        ),
        (
            "Z-10. ,C1.\nG2 X30. Z-15. R5.\n",
            ForeignDialect::Haas,
            "Haas",
        ),
        (
            "Z-10. ,C1.\nG2 X30. Z-15. R#1\n",
            ForeignDialect::Fanuc0t,
            "must be a line or an arc",
        ),
        (
            "G2 X30. Z-5. R5. ,C1.\nM30\n",
            ForeignDialect::Fanuc0t,
            "2: ,C1. is not ported",
        ),
        // The arc leaves in the direction of the line.
        (
            "Z-10. ,C1.\nG2 X30. Z-15. R5.\n",
            ForeignDialect::Fanuc0t,
            "same direction",
        ),
    ] {
        let refused = first_finding(dialect, &format!("{start}{text}"));
        assert!(refused.contains(wanted), "{text}: {refused}");
    }
}

#[test]
fn lines_by_their_angle() {
    assert_eq!(
        fanuc("G98 G1 X20. Z0 F99.\nX40. A135.\n"),
        "G98 G1 X20. Z0 F99.\nX40. Z-10.\n"
    );
    // A chamfer on a line that is given by its angle.
    assert_eq!(
        fanuc("G98 G1 X20. Z0 F99.\nX40. A135. ,C2.\nZ-20.\n"),
        "G98 G1 X20. Z0 F99.\nX37.172 Z-8.586\nG01 X40. Z-12.\nZ-20.\n"
    );
    // Two lines meet: the first has an angle only.
    assert_eq!(
        fanuc("G98 G1 X20. Z0 F99.\nA180.\nX40. Z-20. A135.\n"),
        "G98 G1 X20. Z0 F99.\nX20. Z-10.\nX40. Z-20.\n"
    );
    let refused = first_finding(ForeignDialect::Fanuc0t, "G98 G1 X20. Z0 F99.\nA180.\nM30\n");
    assert!(refused.starts_with("2: A180. is not ported"), "{refused}");
}

#[test]
fn coordinates_and_feeds_of_system_b_are_recognised() {
    assert_eq!(fanuc("G92 X180. Z90.\n"), "G50 X180. Z90.\n");
    assert_eq!(fanuc("G94\nG1 X20. F99.\n"), "G98\nG1 X20. F99.\n");
    let thread = "G99\nG92 X20. Z-9. F1.\nX19.\nG0 X30.\nG92 X18. Z-9.\n";
    assert_eq!(fanuc(thread), thread);
}

#[test]
fn feeds_have_seven_digits_at_most() {
    assert_eq!(
        fanuc("G20 G99\nG1 U-.1 F4.475300\n"),
        "G99\nG1 U-2.54 F113.6726\n"
    );
}

#[test]
fn pecks_of_mach3_and_linuxcnc_are_millimetres() {
    let lines = "G0 X0 Z5\nG00 Z2.\nG01 Z-4. F60.\nG00 Z2.\nG00 Z-3.5\nG01 Z-8.\nG00 Z5.\n";
    assert_eq!(
        port(ForeignDialect::Mach3, "G0 X0 Z5\nG83 Z-8 R2 Q6 F60\n"),
        lines
    );
    assert_eq!(
        port(ForeignDialect::LinuxCnc, "G0 X0 Z5\nG73 Z-8 R2 Q6 F60\n"),
        lines.replace("G00 Z2.\nG00 Z-3.5\n", "G00 Z-3.746\n")
    );
}

#[test]
fn keywords_of_macros_are_named_in_full() {
    let refused = first_finding(ForeignDialect::Haas, "WHILE [#100 GE 4] DO1\n");
    assert!(
        refused.starts_with("1: WHILE [#100 GE 4] DO1 is not"),
        "{refused}"
    );
}

#[test]
fn the_needs_of_a_ported_program_are_listed() {
    let text = "T0707 (T0909)\nG42 G1 X1. F.1\nG40 X2.\n";
    let needs = port_program(text, ForeignDialect::Fanuc0t, PortOptions::default()).machine_needs();
    assert_eq!((needs.tool_stations, needs.nose_compensation), (7, true));
    let needs = port_program("G0 X1.\n", ForeignDialect::Haas, PortOptions::default());
    assert_eq!(needs.machine_needs(), MachineNeeds::default());
}

#[test]
fn each_line_knows_its_foreign_line() {
    let ten = ForeignDialect::Fanuc10t;
    let text = "G99\nG71 P1 Q2 D2000 F.2\nG0 X1.; G1 X2.\nM30";
    let ported = port_program(text, ten, PortOptions::default());
    assert_eq!(ported.text.lines().count(), 5, "{}", ported.text);
    assert_eq!(ported.source_lines, [1, 2, 2, 3, 4]);
}

#[test]
fn dialects_are_recognised() {
    let guess = |text| guess_dialect(text).map(|it| (it.dialect, it.line, it.word));
    let own = "O0001\nG50 X100. Z100.\nG0 X50. Z2. T0101\nG71 U2. R1.\nG71 P1 Q2 U.4 F.2\nM98 P20012\nM30\n";
    assert_eq!(guess(own), None);
    let found = |dialect, line, word: &str| Some((dialect, line, word.to_owned()));
    let fanuc = "O1\nG0 X1.\nG1 Z-1. ,C.5\nM30\n";
    assert_eq!(guess(fanuc), found(ForeignDialect::Fanuc0t, 3, ",C.5"));
    let ten = "O1\nG71 P1 Q2 D2000 F.2\n";
    assert_eq!(guess(ten), found(ForeignDialect::Fanuc10t, 2, "D"));
    let haas = "O00012\nG53 G0 X0 Z0\n";
    assert_eq!(guess(haas), found(ForeignDialect::Haas, 2, "G53"));
    let mach = "G21 G90\nT1 M6\nG0 X5\n";
    assert_eq!(guess(mach), found(ForeignDialect::Mach3, 1, "G21"));
    let linuxcnc = "G7 G18\no<a> call\n";
    assert_eq!(guess(linuxcnc), found(ForeignDialect::LinuxCnc, 1, "G7"));
}

#[test]
fn g33_alone_shows_system_b() {
    assert_eq!(
        fanuc("G0 X20. Z5.\nG33 Z-9. F1.5\n"),
        "G0 X20. Z5.\nG32 Z-9. F1.5\n"
    );
}
