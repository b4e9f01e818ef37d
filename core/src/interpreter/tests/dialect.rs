//! Programs for other controls: the refusal contains the code of this control.

use super::InterpreterBench;

fn refusal_of(text: &str) -> (u16, String) {
    let mut bench = InterpreterBench::new();
    bench.open(text);
    let (_, alarm) = bench.run_to_end();
    let alarm = alarm.unwrap_or_else(|| panic!("no alarm: {text}"));
    (alarm.number, alarm.detail_en())
}

#[test]
fn codes_of_other_controls_are_refused_with_advice() {
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
        let (found, detail) = refusal_of(text);
        assert_eq!(found, number, "{text}: {detail}");
        assert!(detail.contains(advice), "{text}: {detail}");
    }
}

#[test]
fn a_code_of_no_control_gets_no_advice() {
    for text in ["G05", "G93"] {
        let (_, detail) = refusal_of(text);
        assert!(
            detail.ends_with("is not a code of this control"),
            "{detail}"
        );
    }
}
