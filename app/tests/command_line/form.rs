//! The output of `form`.

use super::{TempFile, run_gsk};

#[test]
fn a_form_writes_a_program_with_its_job_and_is_read_again() {
    let program = TempFile::new("shaft.CNC", b"");
    let path = program.path();
    let arguments = [
        "form", "turn", "--set", "STOCK=50", "--set", "d=40", "-o", path,
    ];
    let (code, out, error) = run_gsk(&arguments);
    assert_eq!((code, out.as_str()), (0, ""), "{error}");
    let (code, out, _) = run_gsk(&["check", "--measure", path]);
    assert_eq!(code, 0, "{out}");
    assert!(
        out.contains("job ") && out.contains("shaft.job.ron"),
        "{out}"
    );
    assert!(out.contains("cylinder ⌀40.000"), "{out}");
    let (code, out, _) = run_gsk(&["form", "--read", path]);
    assert_eq!(code, 0, "{out}");
    assert!(out.contains(":2: turn STOCK=50 D=40 DF=40 L=30"), "{out}");
    let text = std::fs::read_to_string(path).unwrap();
    std::fs::write(path, text.replace("G71 U2.", "G71 U1.")).unwrap();
    let (code, out, _) = run_gsk(&["form", "--read", path, "--lang", "zh"]);
    assert_eq!(code, 1, "{out}");
    assert!(out.contains("手工修改"), "{out}");
}

#[test]
fn errors_of_a_form_name_field_and_rule() {
    for (arguments, wanted) in [
        (
            &["turn", "--set", "D=60"][..],
            "STOCK: the stock must be at least 60 mm",
        ),
        (&["turn", "--set", "D=x"], "D: x is not a number"),
        (&["groove", "--set", "Q=1"], "the form has no field Q"),
        (&["groove", "--set", "D"], "D is not FIELD=VALUE"),
        (
            &["thread", "--set", "THREAD=M21"],
            "THREAD: M21 is neither in the thread table",
        ),
    ] {
        let arguments = [&["form"], arguments, &["--lang", "en"]].concat();
        let (code, out, error) = run_gsk(&arguments);
        assert_ne!(code, 0);
        assert!(out.is_empty() && error.contains(wanted), "{out} {error}");
    }
}

#[test]
fn forms_fields_and_threads_are_listed() {
    let list = |arguments: &[&str]| {
        let (code, out, error) = run_gsk(&[&["form"], arguments].concat());
        assert_eq!(code, 0, "{error}");
        out
    };
    let forms = list(&["--list", "--lang", "zh"]);
    assert_eq!(forms.lines().count(), 9, "{forms}");
    assert!(forms.contains("thread\t螺纹\t"), "{forms}");
    let fields = list(&["thread", "--set", "THREAD=FREE", "--fields", "--lang", "en"]);
    assert!(
        fields.contains("PITCH\t1.5\tmm\t0.2..12\tPitch\t"),
        "{fields}"
    );
    let threads = list(&["--threads"]);
    let row = "M20\tISO 261\t2.5\t18.376\t20\t16.933\t1.534\t17.294\t20\t1.353\n";
    assert!(threads.contains(row), "{threads}");
    let blocks = list(&["centre", "--blocks"]);
    assert!(blocks.starts_with("(FORM centre D=6 POINT=60"), "{blocks}");
}
