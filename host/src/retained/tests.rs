//! Tests of the data directory as the control's memory.

use std::sync::Arc;

use super::keeper::TEXT_CHECKS;
use super::*;
use gsk_core::cnc::ControlRequest;
use gsk_core::memory::ControlParameters;
use gsk_core::plc::Ladder;
use gsk_core::units::Axis;
use gsk_panel::emulator::WaitCondition;
use gsk_panel::keys::Key;

use crate::platform::TaskHandle;

#[test]
fn a_loaded_ladder_is_kept_even_if_power_goes_at_once() {
    let folder = gsk_tests::test_folder("kept-ladder");
    let data = Arc::new(DataDir::open(&folder).expect("open"));
    let mut setup = Setup::default();
    let restored = load(&data, &mut setup);
    let mut emulator = Emulator::new(setup);
    let keeper = Keeper::start(Arc::clone(&data), &restored, &emulator).expect("thread");
    let ladder = Ladder::compile("END1\nLD R1.0\nOUT R2.0\nEND2\n").expect("compiles");
    emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    emulator
        .request(ControlRequest::SetParameterSwitch(true))
        .expect("on");
    emulator.press(Key::Edit);
    emulator
        .request(ControlRequest::LoadLadder(Arc::new(ladder.clone())))
        .expect("taken");
    emulator.power_cycle();
    keeper.finish(&emulator);
    let mut next = Setup::default();
    assert!(load(&data, &mut next).complaints.is_empty());
    assert_eq!(*next.ladder.compiled(), ladder);
}

#[test]
fn without_another_ladder_none_is_written() {
    let folder = gsk_tests::test_folder("own-ladder");
    let data = Arc::new(DataDir::open(&folder).expect("open"));
    let restored = load(&data, &mut Setup::default());
    let emulator = Emulator::new(Setup::default());
    let keeper = Keeper::start(Arc::clone(&data), &restored, &emulator).expect("thread");
    keeper.finish(&emulator);
    assert_eq!(data.load_ladder(), LoadedFile::Missing);
}

#[test]
fn a_variable_that_is_not_finite_is_emptied_and_reported() {
    let folder = gsk_tests::test_folder("not-finite");
    let data = DataDir::open(&folder).expect("open");
    // The content that earlier versions wrote after a project with `nan`.
    std::fs::write(
        folder.join("variables.ron"),
        "{\n500: NaN,\n501: 7,\n600: 2.5,\n}",
    )
    .expect("write");
    let mut setup = Setup::default();
    let restored = load(&data, &mut setup);
    let values = [500, 501, 600].map(|number| setup.memory.variables.real_value(number));
    assert_eq!(values, [Some(0.0), Some(7.0), Some(2.5)]);
    let complaint = restored.complaints[0].to_string();
    assert!(
        complaint.contains("line 2: NaN is not a finite number"),
        "{complaint}"
    );
    assert_eq!(setup.alarms[0].number, number::MEMORY_DAMAGED);
    // The next write contains no such number.
    save(data, &restored, Emulator::new(setup).cnc()).expect("saved");
    let data = DataDir::open(&folder).expect("open");
    assert!(load(&data, &mut Setup::default()).complaints.is_empty());
    // The position of the slides cannot be guessed: the whole file is refused.
    drop(data);
    std::fs::write(
        folder.join("standing.ron"),
        "(machine:(x:inf,z:0.0),absolute:(x:0.0,z:0.0))",
    )
    .expect("write");
    let data = DataDir::open(&folder).expect("open");
    assert_eq!(load(&data, &mut Setup::default()).position, None);
}

#[test]
fn what_is_set_back_or_deleted_is_so_on_the_disk_too() {
    let folder = gsk_tests::test_folder("set-back");
    let keep = |change: fn(&mut Setup)| {
        let data = DataDir::open(&folder).expect("open");
        let mut setup = Setup::default();
        let restored = load(&data, &mut setup);
        change(&mut setup);
        save(data, &restored, Emulator::new(setup).cnc()).expect("saved");
    };
    keep(|setup| {
        setup.memory.parameters.set(24, 584).expect("in range");
        setup
            .memory
            .programs
            .store("O0007;\nM30;\n")
            .expect("stored");
    });
    keep(|setup| {
        let delivered = ControlParameters::default().value(24);
        assert_eq!(setup.memory.parameters.value(24), 584);
        setup
            .memory
            .parameters
            .set(24, delivered)
            .expect("in range");
        setup.memory.programs.delete(7).expect("deleted");
    });
    let data = DataDir::open(&folder).expect("open");
    let mut setup = Setup::default();
    load(&data, &mut setup);
    assert_eq!(
        setup.memory.parameters.value(24),
        ControlParameters::default().value(24)
    );
    assert!(setup.memory.programs.stored(7).is_none());
}

#[test]
fn a_damaged_file_is_alarm_069_and_a_broken_off_writing_101() {
    let folder = gsk_tests::test_folder("alarms-of-the-memory");
    std::fs::create_dir_all(folder.join("programs")).expect("make");
    std::fs::write(folder.join("offsets.ron"), "(1, 2").expect("write");
    std::fs::write(folder.join("programs/.O0003.CNC.gsk980td-new"), "O00").expect("write");
    let data = DataDir::open(&folder).expect("open");
    let mut setup = Setup::default();
    load(&data, &mut setup);
    let emulator = Emulator::new(setup);
    let alarms = emulator.cnc().alarms();
    let find_alarm = |number| alarms.iter().find(|alarm| alarm.number == number);
    let detail = |number| find_alarm(number).map(Alarm::detail_en);
    assert!(detail(69).is_some_and(|detail| detail.contains("offsets.ron")));
    assert!(detail(101).is_some_and(|detail| detail.contains("O0003")));
}

#[test]
fn what_is_typed_is_on_the_disk_before_its_page_is_left() {
    let folder = gsk_tests::test_folder("typed");
    let data = Arc::new(DataDir::open(&folder).expect("open"));
    let mut setup = Setup::delivered();
    let restored = load(&data, &mut setup);
    let mut emulator = Emulator::new(setup);
    let mut keeper = Keeper::start(Arc::clone(&data), &restored, &emulator).expect("thread");
    emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    emulator.press(Key::Edit);
    emulator.press(Key::Program);
    emulator.type_text("O12");
    emulator.press(Key::Eob);
    emulator.type_text("G0X17");
    for _ in 0..TEXT_CHECKS {
        keeper.save_if_changed(&emulator);
    }
    // The thread writes all its snapshots before it ends; the emulator is gone, as after a
    // kill.
    keeper.to_disk = None;
    assert!(keeper.task.take().is_some_and(TaskHandle::finish));
    let mut next = Setup::delivered();
    load(&data, &mut next);
    let text = next
        .memory
        .programs
        .stored(12)
        .map(|program| program.text().to_owned());
    assert!(text.is_some_and(|text| text.contains("G0X17")));
}

#[test]
fn every_damage_of_every_file_is_noticed_and_mended() {
    let folder = gsk_tests::test_folder("every-damage");
    let data = DataDir::open(&folder).expect("open");
    let mut setup = Setup::delivered();
    setup.memory.parameters.set(24, 584).expect("in range");
    setup
        .memory
        .programs
        .store("O0007;\nG00 X10;\nM30;\n")
        .expect("stored");
    let restored = load(&data, &mut setup);
    save_emulator(data, &restored, &Emulator::new(setup)).expect("saved");
    let read = || {
        let data = DataDir::open_read_only(&folder).expect("open");
        let mut setup = Setup::delivered();
        let complaints = load(&data, &mut setup).complaints;
        (
            complaints,
            setup.memory.parameters.value(24),
            setup.memory.programs.stored(7).cloned(),
        )
    };
    let (complaints, value, program) = read();
    assert_eq!((complaints, value), (Vec::new(), 584));
    let mut files = vec![folder.join("programs/O0007.CNC")];
    files.extend(
        std::fs::read_dir(&folder)
            .expect("list")
            .filter_map(|entry| {
                let path = entry.expect("entry").path();
                path.extension()
                    .is_some_and(|ending| ending == "ron")
                    .then_some(path)
            }),
    );
    assert_eq!(files.len(), 15, "{files:?}");
    for path in files {
        let good = std::fs::read(&path).expect("read");
        let name = path
            .file_name()
            .and_then(|name| name.to_str())
            .expect("name");
        let mut damages = vec![None, Some(good[..good.len() / 2].to_vec())];
        damages.extend((0..good.len()).step_by(1 + good.len() / 5).map(|at| {
            let mut flipped = good.clone();
            flipped[at] ^= 1;
            Some(flipped)
        }));
        for damage in damages {
            match damage {
                None => std::fs::remove_file(&path).expect("removed"),
                Some(bytes) => std::fs::write(&path, bytes).expect("write"),
            }
            let (complaints, value, found) = read();
            assert_eq!(complaints.len(), 1, "{name}: {complaints:?}");
            let complaint = complaints[0].to_string();
            assert!(complaint.contains(name), "{complaint}");
            assert_eq!((value, &found), (584, &program), "{name}");
        }
        std::fs::write(&path, good).expect("write");
    }
}

#[test]
fn a_program_without_room_in_the_memory_stays_on_the_disk() {
    let folder = gsk_tests::test_folder("no-room");
    let data = DataDir::open(&folder).expect("open");
    let large = format!(
        "O0001;\n{}M30;\n",
        "G01 X10.000 Z-20.000 F100;\n".repeat(8000)
    );
    for number in 1..=90 {
        let path = folder.join(format!("programs/O{number:04}.CNC"));
        std::fs::write(path, large.replace("O0001", &format!("O{number:04}"))).expect("write");
    }
    let mut setup = Setup::default();
    let restored = load(&data, &mut setup);
    assert!(!restored.complaints.is_empty(), "all of it fits");
    save(data, &restored, Emulator::new(setup).cnc()).expect("saved");
    let left = std::fs::read_dir(folder.join("programs"))
        .expect("list")
        .count();
    assert_eq!(left, 90);
}

/// Method A: 014.0, 014.1 = 0; 取消 and the letter of the axis set the zero.
#[test]
fn a_machine_zero_set_by_hand_outlasts_the_process() {
    let folder = gsk_tests::test_folder("zero-kept");
    let data = Arc::new(DataDir::open(&folder).expect("open"));
    let without_switch = || {
        let mut setup = Setup::delivered();
        setup.memory.parameters.set_bit(14, 1, false).expect("bit");
        setup
    };
    let mut setup = without_switch();
    let restored = load(&data, &mut setup);
    let mut emulator = Emulator::new(setup);
    let mut keeper = Keeper::start(Arc::clone(&data), &restored, &emulator).expect("thread");
    emulator
        .request(ControlRequest::SetMachineZero(Axis::Z))
        .expect("set");
    keeper.save_if_changed(&emulator);
    keeper.finish(&emulator);
    let mut next = without_switch();
    load(&data, &mut next).place_slides(&mut next);
    let next = Emulator::new(next);
    let referenced = next.cnc().reference_without_switch();
    assert!(referenced.z && !referenced.x);
}

/// Before its first zero return the control counts from its position at power-on; the dogs
/// stay where they are.
#[test]
fn slides_without_a_reference_stand_there_after_the_next_start() {
    let folder = gsk_tests::test_folder("slides-kept");
    let data = Arc::new(DataDir::open(&folder).expect("open"));
    let start = || {
        let mut setup = Setup::delivered();
        let restored = load(&data, &mut setup);
        restored.place_slides(&mut setup);
        (Emulator::new(setup), restored)
    };
    let (emulator, restored) = start();
    let stood = emulator.lathe().slide_position();
    assert!(stood.x < -1.0 && stood.z < -1.0);
    let keeper = Keeper::start(Arc::clone(&data), &restored, &emulator).expect("thread");
    keeper.finish(&emulator);
    let (next, _) = start();
    assert_eq!(next.lathe().slide_position(), stood);
    assert_eq!(next.cnc().position_machine(), Point::default());
}
