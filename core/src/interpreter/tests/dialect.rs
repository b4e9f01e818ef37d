//! Programs for other controls: the refusal contains the code of this control.

use super::Bench;

fn refusal(text: &str) -> (u16, String) {
    let mut bench = Bench::new();
    bench.open(text);
    let (_, alarm) = bench.rest();
    let alarm = alarm.unwrap_or_else(|| panic!("no alarm: {text}"));
    (alarm.number, alarm.detail_en())
}

#[test]
fn what_other_controls_write_is_refused_with_the_way_here() {
    for (text, number, advice) in [
        ("G20", 10, "INCH"),
        ("G21 X10", 10, "INCH"),
        ("G18", 10, "leave the code out"),
        ("G54", 10, "G50 sets it"),
        ("G91 X1", 10, "U and W"),
        ("M01", 19, "M00 stops"),
        ("M02", 19, "M30 ends"),
        ("M06 T0101", 19, "T0202"),
        ("G01 X20 C1.5", 9, "a chamfer is I or K"),
        ("G01 X20 A135", 9, "by X and Z"),
        ("G01 X20 ,C1", 6, "without a comma"),
        ("#200=5", 6, "G65 H"),
        ("G01 X20 [1]", 6, "G65 H"),
        ("O12345", 43, "four digits"),
    ] {
        let (found, detail) = refusal(text);
        assert_eq!(found, number, "{text}: {detail}");
        assert!(detail.contains(advice), "{text}: {detail}");
    }
}

#[test]
fn a_code_that_nobody_has_gets_no_advice() {
    for text in ["G05", "G93"] {
        let (_, detail) = refusal(text);
        assert!(
            detail.ends_with("is not a code of this control"),
            "{detail}"
        );
    }
}
