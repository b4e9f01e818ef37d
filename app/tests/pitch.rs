//! The command `pitch` and the commissioning view: measurements become parameters, with the
//! rights of the control.

use egui_kittest::kittest::Queryable as _;
use gsk_core::cnc::ControlRequest;
use gsk_core::memory::parameter;
use gsk_core::units::Axis;

use crate::common::WindowBench;
use crate::common::folder::TempFolder;

impl TempFolder {
    /// Runs `pitch …` in this folder. Returns exit code, standard output and standard error.
    fn run_pitch(&self, command: &str) -> (i32, String, String) {
        self.run(&format!("pitch {command}"))
    }
}

/// A screw that is 10 µm too long per 200 mm, with a backlash of 12 µm.
const LASER: &str = "run,direction,target,deviation\n1,+,-200,-10\n1,+,-100,-5\n1,+,0,0\n\
                     1,-,0,12\n1,-,-100,7\n1,-,-200,2\n";

#[test]
fn a_measurement_is_imported_with_a_backup_and_exported() {
    let folder = TempFolder::new("pitch-written");
    folder.write("laser.csv", LASER);
    let dry = folder.run_pitch("import laser.csv --axis z --into data --dry-run");
    assert_eq!(dry.0, 2, "there is no memory yet: {dry:?}");
    let (code, out, error) = folder.run_pitch("import laser.csv --axis z --into data");
    assert_eq!((code, error.as_str()), (0, ""), "{out}");
    assert!(out.contains("backlash 12.0 µm"), "{out}");
    assert!(folder.0.join("data/backups/before-import-0001").is_dir());
    let (_, table, _) = folder.run_pitch("show --axis z --data data");
    assert!(table.starts_with("Z: interval"), "{table}");
    let (_, ren, _) = folder.run_pitch("show --axis z --data data --format ren");
    assert!(ren.contains("backlash: 12\n"), "{ren}");
    // The exported file can be imported: with a cleared table the values stay the same.
    folder.write("z.ren", &ren);
    let (code, out, _) = folder.run_pitch("import z.ren --axis z --into data --clear");
    assert_eq!(code, 0);
    assert!(out.contains("already have these values"), "{out}");
    // Added to the stored values, they double.
    let (code, out, _) = folder.run_pitch("import z.ren --axis z --into data --dry-run --json");
    assert_eq!(code, 0);
    assert!(out.contains("\"written\": false"), "{out}");
    assert!(
        out.contains("\"value\": 2") || out.contains("\"value\": -2"),
        "{out}"
    );
}

#[test]
fn refused_files_name_file_and_line_and_write_nothing() {
    let folder = TempFolder::new("pitch-refused");
    folder.write("laser.csv", LASER);
    folder.write("bad.csv", "target,deviation\n0,0\n10,wide\n");
    folder.write("x.ren", "axis: X\nspacing: 10\n10 2\n");
    folder.write("grid.ren", "spacing: 10\n10 2\n14 2\n");
    for (command, message) in [
        (
            "import bad.csv --axis z --into data",
            "bad.csv: line 3: `wide` is not a number",
        ),
        (
            "import x.ren --axis z --into data",
            "x.ren: the file is for axis X",
        ),
        (
            "import grid.ren --axis z --into data",
            "line 3: position 14.000",
        ),
        ("import none.csv --axis z --into data", "none.csv"),
        (
            "import x.ren --axis x --interval 5 --into data",
            "do not apply to a table",
        ),
        (
            "import laser.csv --axis z --interval -1 --into data",
            "interval",
        ),
        (
            "import laser.csv --axis z --password 0 --into data",
            "password",
        ),
    ] {
        let (code, _, error) = folder.run_pitch(command);
        assert_eq!(code, 2, "{command}: {error}");
        assert!(error.contains(message), "{command}: {error}");
    }
    let backups = folder.0.join("data/backups");
    assert!(!backups.exists());
}

#[test]
fn the_view_writes_only_in_mdi_and_can_undo() {
    let mut bench = WindowBench::new();
    let shift = egui::Modifiers::SHIFT;
    bench.harness.key_press_modifiers(shift, egui::Key::End);
    bench.run(1);
    bench.run(100);
    bench.click("Backlash");
    bench.run(1);
    bench
        .console
        .send(gsk_host::kernel::Command::Request(Box::new(
            ControlRequest::SetParameterSwitch(true),
        )));
    bench.run(100);
    let control = egui::Modifiers::CTRL;
    bench.harness.key_press_modifiers(control, egui::Key::Num1);
    bench.run(300);
    // In automatic mode the view shows why it cannot write, and the button is disabled.
    let zero_speed_and_pitch = |bench: &WindowBench| {
        let cnc = bench.kernel.emulator().cnc();
        (
            cnc.parameters().value(parameter::ZERO_LOW_SPEED),
            cnc.pitch().value(Axis::Z, 1),
        )
    };
    bench.click("Machine zero");
    bench.run(1);
    bench.click("C: one proximity switch");
    bench.run(1);
    bench.click("Propose");
    bench.run(1);
    assert!(
        bench
            .harness
            .query_by_label_contains("cannot be written now:")
            .is_some()
    );
    let previous = bench.kernel.emulator().cnc().parameters().clone();
    bench.harness.get_by_label_contains("Write ").click();
    bench.run(100);
    assert_eq!(*bench.kernel.emulator().cnc().parameters(), previous);
    // In MDI the value is written and undone.
    bench.harness.key_press_modifiers(control, egui::Key::Num3);
    bench.run(300);
    bench.run(100);
    bench.harness.get_by_label_contains("Write ").click();
    bench.run(1);
    bench.run(100);
    let current = bench.kernel.emulator().cnc().parameters().clone();
    let one_switch_of_z = current.has_one_zero_switch(Axis::Z);
    let rate = current.value(parameter::ZERO_HIGH_SPEED);
    assert!(one_switch_of_z && rate == 5000, "{current:?}");
    bench.run(100);
    bench.harness.get_by_label_contains("Undo: ").click();
    bench.run(1);
    bench.run(100);
    assert_eq!(*bench.kernel.emulator().cnc().parameters(), previous);
    assert_eq!(
        zero_speed_and_pitch(&bench),
        (previous.value(parameter::ZERO_LOW_SPEED), 0)
    );
}
