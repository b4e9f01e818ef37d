use gsk_core::command::ProgramId;
use gsk_core::setup::Setup;
use gsk_panel::keys::Key;

use super::*;

#[test]
fn a_machine_zero_return_moves_the_tip_no_farther_than_the_slides() {
    let slides = Point::new(-20.0, -60.0);
    let mut emulator = Emulator::new(Setup {
        lathe: LatheConfig::with_long_slides(),
        slides: Some(slides),
        ..Setup::default()
    });
    let views = Arc::new(ArrayQueue::new(1));
    let mut part = KernelPart::new(Arc::clone(&views));
    let mut job = Job::new(gsk_workpiece::stock::Stock::bar(40.0, 0.0, 60.0));
    job.tools.insert(1, Tool::turning());
    job.zero = Some(gsk_workpiece::job::DiameterPoint {
        x: gsk_core::units::Diameter(-200.0),
        z: -300.0,
    });
    job.lengths
        .insert(1, gsk_workpiece::job::DiameterPoint::default());
    part.set_job(
        Some(SelectedJob { job, file: None }),
        &LatheConfig::default(),
    );
    part.set_visible(true);
    let mut tip = |emulator: &mut Emulator, ticks: u32| {
        for _ in 0..ticks {
            emulator.tick();
            part.after_tick(emulator, true);
        }
        part.force_publish();
        part.publish(emulator);
        views.pop().unwrap().tip
    };
    let start = tip(&mut emulator, 1);
    assert!((start - (slides + Point::new(100.0, 300.0))).length() < 0.01);
    // The control shows other coordinates, as after a power-on without a reference.
    assert_eq!(emulator.cnc().position_machine(), Point::new(150.0, 300.0));
    tip(&mut emulator, 5000);
    emulator.press(Key::MachineZero);
    emulator.key_down(Key::ZRight);
    for _ in 0..2400 {
        let moved = tip(&mut emulator, 25) - start;
        let lathe = emulator.lathe();
        let slides_moved = lathe.slide_position() + lathe.following_error() - slides;
        assert!((moved - slides_moved).length() < 0.3, "{moved:?}");
    }
    // The slide has moved to the machine zero, which the control now shows.
    let z = tip(&mut emulator, 1).z - start.z;
    assert!((z - 60.0).abs() < 0.3, "{z}");
    assert_eq!(emulator.cnc().position_machine().z, 0.0);
}

/// Runs the control, and cuts the part after each tick.
fn follow(part: &mut KernelPart, emulator: &mut Emulator, ticks: u32, simulated: bool) {
    for _ in 0..ticks {
        emulator.tick();
        part.after_tick(emulator, simulated);
    }
}

/// The collisions after a jog into the face of a bar whose place only the coordinates give,
/// and the part. `is_real`: the slides are those of a real lathe.
fn jog_into_bar(file: Option<&str>, is_real: bool) -> (usize, KernelPart) {
    let mut emulator = Emulator::new(Setup {
        start: Some(Point::new(10.0, 5.0)),
        referenced: true,
        ..Setup::default()
    });
    let mut job = Job::new(gsk_workpiece::stock::Stock::bar(40.0, 0.0, 60.0));
    job.tools.insert(1, Tool::turning());
    let mut part = KernelPart::new(Arc::new(ArrayQueue::new(1)));
    let file = file.map(Into::into);
    part.set_job(Some(SelectedJob { job, file }), &LatheConfig::default());
    let mut run =
        |emulator: &mut Emulator, ticks: u32| follow(&mut part, emulator, ticks, !is_real);
    run(&mut emulator, 5000);
    emulator.press(Key::Jog);
    emulator.key_down(Key::ZLeft);
    run(&mut emulator, 5000);
    let findings = part.state().machining().map_or(0, |it| it.findings().len());
    (findings, part)
}

#[test]
fn by_hand_the_tool_meets_the_drawn_part_of_a_given_job() {
    let (count, part) = jog_into_bar(Some("bar.job.ron"), false);
    assert_eq!(count, 1, "the spindle stands");
    // What it has met stays there when the work zero changes.
    let frame = gsk_core::command::Frame {
        zero: Point::new(0.0, -30.0),
        ..Default::default()
    };
    let machining = part.state().machining().unwrap();
    let zero = machining.mounting().slide_at_part_zero(1, &frame);
    assert!((zero - Point::default()).length() < 1e-9, "{zero:?}");
    assert_eq!(jog_into_bar(None, false).0, 0, "the part is guessed");
    assert_eq!(jog_into_bar(Some("bar.job.ron"), true).0, 0, "real slides");
}

#[test]
fn an_insert_survives_the_run_down_of_the_spindle_after_reset() {
    let mut setup = Setup::default();
    let text = "O0001\nG50 X60 Z20\nM03 S800\nT0101\nG00 X38 Z2\nG01 Z-50 F400\nM30\n";
    let number = setup.memory.programs.store(text).unwrap();
    setup.memory.programs.select(ProgramId::Stored(number));
    let mut emulator = Emulator::new(setup);
    let mut job = Job::new(gsk_workpiece::stock::Stock::bar(40.0, 0.0, 60.0));
    job.tools.insert(1, Tool::turning());
    let mut part = KernelPart::new(Arc::new(ArrayQueue::new(1)));
    part.set_overload(true);
    part.set_job(
        Some(SelectedJob { job, file: None }),
        &LatheConfig::default(),
    );
    let mut run = |emulator: &mut Emulator, ticks: u32| follow(&mut part, emulator, ticks, true);
    run(&mut emulator, 5000);
    emulator.press(Key::Auto);
    run(&mut emulator, 100);
    emulator.press(Key::CycleStart);
    while emulator.cnc().position_absolute().z > -10.0 {
        run(&mut emulator, 10);
    }
    emulator.press(Key::Reset);
    run(&mut emulator, 3000);
    assert!(!emulator.cnc().is_moving());
    assert!(!emulator.lathe().has_fault(LatheFault::InsertBroken));
}

#[test]
fn tools_of_another_job_leave_the_part_in_the_chuck() {
    let (_, mut part) = jog_into_bar(Some("bar.job.ron"), false);
    let mut job = Job::clone(part.state().job());
    job.tools.insert(2, Tool::drill(10.0));
    part.change_tools(SelectedJob {
        job: job.clone(),
        file: None,
    });
    let machining = part.state().machining().unwrap();
    assert_eq!((machining.findings().len(), machining.job()), (1, &job));
    part.set_job(
        Some(SelectedJob { job, file: None }),
        &LatheConfig::default(),
    );
    assert_eq!(part.state().machining().unwrap().findings().len(), 0);
}

#[test]
fn time_in_the_material_counts_for_tools_of_the_library() {
    let mut setup = Setup::default();
    let text = "O0001\nG50 X60 Z20\nM03 S500\nT0101\nG00 X38 Z2\nG01 Z-20 F600\nG00 X60\nM30\n";
    let number = setup.memory.programs.store(text).unwrap();
    setup.memory.programs.select(ProgramId::Stored(number));
    let mut emulator = Emulator::new(setup);
    let mut part = KernelPart::new(Arc::new(ArrayQueue::new(1)));
    let mut job = Job::new(gsk_workpiece::stock::Stock::bar(40.0, 0.0, 60.0));
    job.tools.insert(1, Tool::turning());
    job.library.insert(1, "rough".to_owned());
    part.set_job(
        Some(SelectedJob { job, file: None }),
        &LatheConfig::default(),
    );
    let mut follow = |emulator: &mut Emulator, ticks: u32| {
        for _ in 0..ticks {
            emulator.tick();
            part.after_tick(emulator, true);
        }
        part.take_tool_minutes()
    };
    assert_eq!(follow(&mut emulator, 5000), []);
    emulator.press(Key::Auto);
    follow(&mut emulator, 100);
    emulator.press(Key::CycleStart);
    let spent = follow(&mut emulator, 15_000);
    // 20 mm at 600 mm/min from the face of the bar, and the end of the deceleration.
    let [
        ToolMinutes {
            number: 1, minutes, ..
        },
    ] = spent.as_slice()
    else {
        panic!("{spent:?}");
    };
    assert!((1.9..2.5).contains(&(minutes * 60.0)), "{minutes}");
    assert_eq!(follow(&mut emulator, 1000), [], "counted once");
}
