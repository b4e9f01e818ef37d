use std::fs;

use gsk_core::setup::Setup;
use gsk_history::replay::replay;
use gsk_panel::keys::Key;
use gsk_tests::test_folder;

use super::disk::{ENDING, MAX_FOLDER_BYTES, prepare_folder};
use super::*;

/// A machine that a flight recorder records tick by tick.
struct Flight {
    emulator: Emulator,
    part: MachinePart,
    recorder: FlightRecorder,
}

impl Flight {
    fn start(target: RecordingTarget) -> Self {
        let mut emulator = Emulator::new(Setup::default());
        emulator.record_inputs();
        Self {
            emulator,
            part: MachinePart::default(),
            recorder: FlightRecorder::start(target).expect("a thread"),
        }
    }

    fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.emulator.tick();
            let inputs = join_inputs(0, self.emulator.take_inputs(), Vec::new());
            self.recorder
                .follow(&self.emulator, &self.part, &inputs, &[]);
        }
    }
}

#[test]
fn a_recording_reaches_the_end_of_the_session() {
    let folder = test_folder("flight-session");
    let file = folder.join("flight.gskrec");
    let mut flight = Flight::start(RecordingTarget::File(file.clone()));
    flight.run(3000);
    for key in [Key::Jog, Key::ZLeft, Key::Reset, Key::EmergencyStop] {
        flight.emulator.key_down(key);
        flight.run(5000);
        flight.emulator.key_up(key);
        flight.run(1000);
        assert_eq!(flight.recorder.flush(&flight.emulator), None);
    }
    let end = flight.emulator.clone();
    flight.recorder.finish(true);
    let replayed = replay(&fs::read(&file).expect("a file")).expect("a recording");
    assert_eq!((replayed.error, replayed.difference), (None, None));
    assert!(replayed.is_complete && replayed.equal_hashes == 2);
    assert_eq!(replayed.program, env!("CARGO_PKG_VERSION"));
    let history = replayed.history.expect("a session");
    assert!(history.present().expect("its end").emulator == end);
}

#[test]
fn a_board_whose_opening_is_missing_interrupts_the_recording() {
    let folder = test_folder("flight-board");
    let file = folder.join("flight.gskrec");
    let mut flight = Flight::start(RecordingTarget::File(file.clone()));
    flight.run(100);
    // The opening of the link is not among the steps.
    flight.recorder.follow_board(&[], true);
    flight.recorder.follow_board(&[], true);
    // Unrecorded time with a board.
    flight.emulator.press(Key::EmergencyStop);
    flight.emulator.take_inputs();
    flight.run(100);
    let end = flight.emulator.clone();
    flight.recorder.finish(true);
    let replayed = replay(&fs::read(&file).expect("a file")).expect("a recording");
    assert_eq!(replayed.error, None);
    let history = replayed.history.expect("the second section");
    assert!(history.present().expect("its end").emulator == end);
}

#[test]
fn a_file_that_cannot_be_written_ends_the_recording() {
    let folder = test_folder("flight-unwritable");
    let target = RecordingTarget::File(folder.join("missing").join("flight.gskrec"));
    let mut flight = Flight::start(target);
    flight.run(10);
    let mut report = None;
    for _ in 0..1000 {
        report = report.or_else(|| flight.recorder.flush(&flight.emulator));
        std::thread::sleep(core::time::Duration::from_millis(2));
        if report.is_some() {
            break;
        }
    }
    assert!(report.is_some());
    flight.recorder.finish(true);
}

#[test]
fn a_folder_keeps_the_newest_recordings() {
    let folder = test_folder("flight-folder");
    let path = |number: u64| folder.join(format!("session-{number:06}.{ENDING}"));
    assert_eq!(prepare_folder(&folder).expect("a folder"), 1);
    let length = usize::try_from(MAX_FOLDER_BYTES / 5).expect("a length");
    for number in 7..=10 {
        fs::write(path(number), vec![0; length]).expect("written");
    }
    fs::write(folder.join("note.txt"), "mine").expect("written");
    assert_eq!(prepare_folder(&folder).expect("a folder"), 11);
    let kept: Vec<u64> = (7..=10).filter(|number| path(*number).exists()).collect();
    assert_eq!(kept, [8, 9, 10]);
    assert!(folder.join("note.txt").exists());
    let unused = Flight::start(RecordingTarget::Folder(folder.to_path_buf()));
    unused.recorder.finish(true);
    assert!(!path(11).exists(), "nothing was recorded");
    let mut flight = Flight::start(RecordingTarget::Folder(folder.to_path_buf()));
    flight.run(10);
    flight.recorder.finish(true);
    assert!(path(11).exists());
}

#[test]
fn only_a_session_without_its_end_is_offered() {
    let folder = test_folder("flight-unfinished");
    let (offers, received) = std::sync::mpsc::channel();
    let offered = || {
        let offers = offers.clone();
        offer_unfinished(&folder, move |message| {
            offers.send(message).expect("a receiver");
        });
        let wait = core::time::Duration::from_millis(500);
        received.recv_timeout(wait).ok()
    };
    assert_eq!(offered(), None, "no recordings");
    for (is_complete, number) in [(true, 1), (false, 2), (true, 3)] {
        let mut flight = Flight::start(RecordingTarget::Folder(folder.to_path_buf()));
        flight.run(10);
        flight.recorder.finish(is_complete);
        let path = folder.join(format!("session-{number:06}.{ENDING}"));
        let message = say::flight_not_ended(path.display());
        assert_eq!(offered(), (!is_complete).then_some(message));
    }
}
