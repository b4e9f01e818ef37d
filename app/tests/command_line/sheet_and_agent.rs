//! `sheet`, and the options of the MTConnect agent.

use std::path::Path;

use super::{TempFile, run_gsk};

#[test]
fn a_sheet_is_written_beside_its_program() {
    let program = TempFile::new(
        "collar.CNC",
        b"O0044;\nG50 X100 Z50;\nM03 S800;\nT0101;\nG00 X40 Z2;\nN60 G98 G01 Z-20 F100;\n\
          G00 X100 Z50;\nM30;\n",
    );
    let offset = ["--offset", "01=1.5,-2.25,0.8,3"];
    let (code, out, err) =
        run_gsk(&[&["sheet", program.path(), "--lang", "en"], &offset[..]].concat());
    assert_eq!(code, 0, "{err}");
    let path = Path::new(program.path()).with_extension("sheet.html");
    assert!(out.contains("collar.sheet.html"), "{out}");
    let sheet = std::fs::read_to_string(path).unwrap();
    for part in [
        "Setup sheet collar.CNC",
        ">O0044",
        "X\u{a0}1.500 Z\u{a0}-2.250 R\u{a0}0.800 T\u{a0}3",
        ">⌀40<",
        ">N60<",
        "Line 2, G50 X100 Z50;",
        // The hash of these bytes, as sha256sum prints it.
        "3cb90b6d4b5240db6108d42088cb2a5285a3d40b50ccdd09e5a1b3ac87606789",
        "Stock and tools are guessed",
    ] {
        assert!(sheet.contains(part), "{part}\n{sheet}");
    }
    let (code, zh, err) = run_gsk(&["sheet", program.path(), "-o", "-", "--lang", "zh"]);
    assert_eq!(code, 0, "{err}");
    assert!(
        zh.contains("加工准备单 collar.CNC") && zh.contains("<html lang=\"zh-CN\">"),
        "{zh}"
    );
}

#[test]
fn a_sheet_prints_the_subprograms_in_the_order_of_their_calls() {
    let program = TempFile::new(
        "calls.CNC",
        b"O0048;\nG50 X100 Z50;\nM03 S800;\nT0101;\nG00 X40 Z2;\nM98 P7002;\nM98 P27001;\n\
          M98 P7002;\nG00 X100 Z50;\nM30;\n",
    );
    let folder = Path::new(program.path()).parent().unwrap();
    for (name, text) in [
        (
            "O7001.CNC",
            "O7001;\nG98 G01 Z-10 F100 (FIRST);\nG00 Z2;\nM99;\n",
        ),
        (
            "O7002.CNC",
            "O7002;\nG98 G01 Z-20 F100 (SECOND);\nG00 Z2;\nM99;\n",
        ),
        (
            "O7003.CNC",
            "O7003;\nG98 G01 Z-30 F100 (NEVER);\nG00 Z2;\nM99;\n",
        ),
    ] {
        std::fs::write(folder.join(name), text).unwrap();
    }
    let (_, sheet, err) = run_gsk(&["sheet", program.path(), "-o", "-", "--lang", "en"]);
    let place = |part: &str| sheet.find(part).unwrap_or_else(|| panic!("{part} {err}"));
    let second = place("Subprogram O7002</h2>");
    let first = place("Subprogram O7001</h2>");
    assert!(second < place("<em>SECOND</em>") && place("<em>SECOND</em>") < first);
    assert!(first < place("<em>FIRST</em>"));
    assert_eq!(sheet.matches("Subprogram").count(), 2);
    assert!(!sheet.contains("NEVER"));
}

#[test]
fn a_sheet_is_html_or_pdf_and_keeps_its_inputs() {
    let program = TempFile::new("ring.html", b"O0045;\nM30;\n");
    let (code, _, err) = run_gsk(&["sheet", program.path(), "-o", "ring.odt"]);
    assert_eq!(code, 2);
    assert!(err.contains("ring.odt") && err.contains(".pdf"), "{err}");
    let (code, _, err) = run_gsk(&["sheet", program.path(), "-o", program.path()]);
    assert_eq!(code, 2, "{err}");
    assert_eq!(std::fs::read(program.path()).unwrap(), b"O0045;\nM30;\n");
}

#[test]
fn an_agent_reports_its_address_and_wrong_ones_are_refused() {
    let program = TempFile::new("short.CNC", b"O0046;\nM30;\n");
    let run = ["run", program.path(), "--lang", "en"];
    let with = |options: &[&str]| run_gsk(&[&run[..], options].concat());
    let (code, _, err) = with(&["--mtconnect", "127.0.0.1:0", "--mtconnect-schema", "1.8"]);
    assert_eq!(code, 0, "{err}");
    assert!(err.contains("MTConnect agent: http://127.0.0.1:"), "{err}");
    let (_, _, quiet) = with(&[]);
    assert!(!quiet.contains("MTConnect"), "{quiet}");
    let (code, _, err) = with(&["--mtconnect", "shaft.CNC"]);
    assert_eq!(code, 2);
    assert!(err.contains("'shaft.CNC' is not an address"), "{err}");
    let (code, _, err) = with(&["--mtconnect", "--mtconnect-schema", "2.6"]);
    assert_eq!(code, 2);
    assert!(err.contains("2.6 is not one of 1.8, 2.0"), "{err}");
    let (code, _, err) = with(&["--mtconnect", "192.0.2.1:5000"]);
    assert_eq!(code, 2);
    assert!(err.contains("cannot listen at 192.0.2.1:5000"), "{err}");
}

#[test]
fn a_broker_that_is_not_there_does_not_stop_a_run_and_wrong_addresses_are_refused() {
    let program = TempFile::new("quick.CNC", b"O0047;\nG04 X0.5;\nM30;\n");
    let run = ["run", program.path(), "--lang", "en"];
    let with = |options: &[&str]| run_gsk(&[&run[..], options].concat());
    // Nothing listens at port 9 of this computer.
    let (code, _, err) = with(&["--mqtt", "mqtt://ann:secret@127.0.0.1:9/hall"]);
    assert_eq!(code, 0, "{err}");
    assert!(err.contains("MQTT: mqtt://127.0.0.1:9/hall: "), "{err}");
    assert!(!err.contains("secret"), "{err}");
    let (_, _, quiet) = with(&[]);
    assert!(!quiet.contains("MQTT"), "{quiet}");
    for (options, reason) in [
        (
            &["--mqtt", "http://host"][..],
            "not the address of an MQTT broker",
        ),
        (&["--mqtt", "mqtts://host:0"], "mqtts:// with TLS"),
        (
            &["--mqtt", "host/a/#"],
            "cannot be the start of MQTT topics",
        ),
        (&["--mqtt", "host", "--mqtt-rate", "0"], "1 to 50"),
        (
            &["--mqtt", "host", "--mqtt-password-file", "no-such-file"],
            "no-such-file",
        ),
    ] {
        let (code, _, err) = with(options);
        assert_eq!(code, 2, "{options:?}: {err}");
        assert!(err.contains(reason), "{options:?}: {err}");
    }
}
