//! The dry run of `check`.

use crate::command::{ExecutedMove, MoveKind};
use crate::preview::{Preview, PreviewEnd, SpindleRotation, preview};
use crate::program::{Program, ProgramMemory};
use crate::setup::Setup;
use crate::units::Point;

fn check_with(setup: &Setup, text: &str) -> (Preview, Vec<ExecutedMove>) {
    let mut programs = ProgramMemory::default();
    programs.open_external(Program::new(text));
    let mut moves = Vec::new();
    let result = preview(setup, &programs, &mut |executed| moves.push(*executed));
    (result, moves)
}

fn check(text: &str) -> (Preview, Vec<ExecutedMove>) {
    check_with(&Setup::default(), text)
}

#[test]
fn a_small_part_is_previewed() {
    let (result, moves) = check(
        "O0001;\nG00 X50 Z2 T0101;\nM03 S600;\nG99 G01 Z-20 F0.3;\nG02 X60 Z-25 R5;\nG04 X1;\nG00 X300 Z300;\nG00 X300;\nM30;",
    );
    assert_eq!((result.end, result.alarm), (PreviewEnd::M30, None));
    let kinds: Vec<_> = moves.iter().map(|executed| executed.kind).collect();
    use MoveKind::{Clockwise, Dwell, Feed, Rapid};
    assert_eq!(kinds, [Rapid, Feed, Clockwise, Dwell, Rapid]);
    assert_eq!((result.moves, result.parts, result.stops), (5, 1, 0));
    assert_eq!(result.tools, [(1, 1)]);
    assert_eq!(result.absolute, Point::new(150.0, 300.0));
    assert_eq!(result.spindle, SpindleRotation::Stopped);
    assert!((result.lengths.feed - 22.0).abs() < 1e-9);
    assert!((result.lengths.clockwise - core::f64::consts::PI * 2.5).abs() < 1e-9);
    // 0.3 mm/rev at 600 r/min is 180 mm/min.
    assert!((result.cutting_s - (22.0 + result.lengths.clockwise) / 3.0).abs() < 1.1);
    let bounds = result.bounds.unwrap();
    assert_eq!(
        (bounds.least, bounds.greatest),
        (Point::new(25.0, -25.0), Point::new(150.0, 300.0))
    );
    let mut now = 0.0;
    for executed in &moves {
        assert!(executed.start_s >= now - 1e-9);
        now = executed.start_s + executed.duration_s;
    }
    assert!(result.time_s >= now);
}

#[test]
fn offsets_do_not_show_in_the_path() {
    let mut setup = Setup::default();
    let mut row = setup.memory.offsets.get(1);
    (row.x, row.z) = (0.37, -1.23);
    setup.memory.offsets.set(1, row).unwrap();
    let (result, moves) = check_with(&setup, "T0101;\nG00 X33.3 Z-7.7;\nG01 X44.4 F100;\n");
    assert_eq!(moves[0].to, Point::new(16.65, -7.7));
    assert_eq!(moves[1].to, Point::new(22.2, -7.7));
    assert_eq!(result.absolute, Point::new(22.2, -7.7));
    assert_eq!(result.end, PreviewEnd::Text);
}

#[test]
fn a_stopped_spindle_is_found() {
    let (result, _) = check("M03 S500;\nG99 G01 Z0 F0.2;\nM05;\nZ1;");
    assert_eq!(result.end, PreviewEnd::Alarm);
    let alarm = result.alarm.unwrap();
    assert_eq!((alarm.number, alarm.source.unwrap().line), (11, 4));
}

#[test]
fn endless_programs_end() {
    let (result, _) = check("U1;\nM99;");
    assert_eq!((result.end, result.parts), (PreviewEnd::M99, 1));
    let mut programs = ProgramMemory::default();
    programs.store("O1; N1; M99;").unwrap();
    programs.open_external(Program::new("M98 P99990001;\n".repeat(200)));
    assert!(programs.select(crate::command::ProgramId::External));
    assert_eq!(
        preview(&Setup::default(), &programs, &mut |_| ()).end,
        PreviewEnd::Limit
    );
}

#[test]
fn the_preview_continues_after_a_program_stop() {
    let (result, _) = check("M00;\nG00 X1;\nM00;\nM30;");
    assert_eq!((result.stops, result.end), (2, PreviewEnd::M30));
}

#[test]
fn relative_coordinates_follow_a_preset_only_with_ppd() {
    let mut setup = Setup::default();
    setup.memory.parameters.set_bit(5, 1, true).unwrap();
    assert_eq!(
        check_with(&setup, "G50 X10 Z20;").0.relative,
        Point::new(5.0, 20.0)
    );
    setup.memory.parameters.set_bit(5, 1, false).unwrap();
    assert_eq!(
        check_with(&setup, "G50 X10 Z20;").0.relative,
        Point::new(150.0, 300.0)
    );
}

#[test]
fn bounds_include_the_bulge_of_an_arc() {
    let (result, _) =
        check("G00 X20 Z0;\nG50 X20 Z0;\nG00 X20;\nG01 X20.0 F100;\nG03 X20 Z-20 K-10;");
    let bounds = result.bounds.unwrap();
    assert!((bounds.greatest.x - 150.0).abs() < 1e-9);
    let (result, _) = check_with(
        &Setup {
            start: Some(Point::new(10.0, 0.0)),
            ..Setup::default()
        },
        "G03 X20 Z-20 K-10 F100;",
    );
    let bounds = result.bounds.unwrap();
    assert!((bounds.greatest.x - 20.0).abs() < 1e-9 && bounds.least.x == 10.0);
    assert_eq!((bounds.least.z, bounds.greatest.z), (-20.0, 0.0));
}

#[test]
fn machine_times_are_counted() {
    let motionless = check("M08;\nM09;\nT0301;").0.time_s;
    // Twice 080, two stations, the clamping time and 085.
    assert!(
        (motionless - (0.5 + 0.5 + 2.0 * 0.6 + 0.1 + 1.0)).abs() < 1e-9,
        "{motionless}"
    );
}
