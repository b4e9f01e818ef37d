//! A recording with a pulse board: the replay computes the link and the machine again without the
//! board, bit for bit, and notices bytes that do not belong to it.

use std::time::Duration;

use gsk_core::linked::LinkedControl;
use gsk_core::setup::Setup;
use gsk_history::board_exchange::{BoardStep, ExchangeLog, ExchangedBytes};
use gsk_history::moment::{HistoryInput, RecordedInput, state_hash};
use gsk_history::recording::{
    FORMAT, RecordingEncoder, RecordingEvent, RecordingReader, join_exchange,
};
use gsk_history::replay::replay;
use gsk_link::{LinkConfig, LinkState};
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;
use gsk_twins::grbl::{GrblSettings, GrblTwin, Variant};
use gsk_twins::klipper::{KlipperHardware, KlipperTwin};

use crate::board_path::board::{BenchBoard, TimedBoard};

/// A panel with a board whose exchange is recorded as the kernel does it.
struct RecordedLathe<T> {
    emulator: Emulator,
    linked: LinkedControl,
    twin: T,
    log: ExchangeLog,
    events: Vec<RecordingEvent>,
    sent: u64,
}

impl<T: BenchBoard> RecordedLathe<T> {
    fn connect(twin: T, config: LinkConfig) -> Self {
        let mut setup = Setup::delivered();
        for number in [17, 18] {
            setup.memory.parameters.set(number, 5).unwrap();
        }
        let mut emulator = Emulator::new(setup);
        emulator.record_inputs();
        for _ in 0..100 {
            emulator.tick();
        }
        let events = vec![
            RecordingEvent::Start {
                format: FORMAT,
                program: "test".to_owned(),
            },
            RecordingEvent::State {
                emulator: Box::new(emulator.clone()),
                part: Vec::new(),
            },
        ];
        let log = ExchangeLog::open(emulator.ticks(), config.clone(), Vec::new());
        let linked = LinkedControl::open(config, emulator.board_simulation(), Duration::ZERO);
        Self {
            emulator,
            linked,
            twin,
            log,
            events,
            sent: 0,
        }
    }

    /// Runs for some milliseconds, of which the kernel reads the port every second one.
    fn run_ms(&mut self, ms: u32) {
        for _ in 0..ms / 2 {
            self.twin.advance(2_000_000);
            let bytes = self.twin.read();
            let now = Duration::from_nanos(self.twin.now());
            self.log.add_read(now, &bytes);
            self.linked.pump(&bytes, now);
            loop {
                let is_permitted = self.linked.can_tick();
                self.log.add_tick_request(is_permitted);
                if !is_permitted {
                    break;
                }
                self.linked.before_tick(self.emulator.board_simulation());
                self.emulator.tick();
                self.linked.after_tick(self.emulator.board_simulation());
            }
            let bytes = self.linked.tx().to_vec();
            self.twin.write(&bytes);
            self.sent += bytes.len() as u64;
            self.log.add_written(&bytes);
            self.linked.mark_written(bytes.len());
            self.linked.take_notes();
        }
        self.flush();
    }

    /// Stores what was collected, with the hash of the machine.
    fn flush(&mut self) {
        let inputs: Vec<RecordedInput> = (self.emulator.take_inputs().into_iter())
            .map(|stamped| RecordedInput {
                tick: stamped.tick,
                input: HistoryInput::Machine(stamped.input),
            })
            .collect();
        let tick = self.emulator.ticks();
        let steps = self.log.take_steps();
        self.events.extend(join_exchange(&inputs, &steps));
        let hash = state_hash(&self.emulator).unwrap();
        self.events.push(RecordingEvent::Reached(tick));
        self.events.push(RecordingEvent::Hash { tick, hash });
    }

    fn press(&mut self, key: Key, ms: u32) {
        self.emulator.key_down(key);
        self.run_ms(ms);
        self.emulator.key_up(key);
        self.run_ms(300);
    }

    fn wait_for(&mut self, state: LinkState) {
        for _ in 0..100 {
            if self.linked.state() == state {
                return;
            }
            self.run_ms(100);
        }
        panic!("{:?}, not {state:?}", self.linked.state());
    }

    /// Disconnects the board, lets the machine run on, and returns the recording.
    fn finish(mut self) -> (Vec<u8>, Emulator, u64) {
        self.log.add(BoardStep::Closed);
        self.linked.check_count_before_close();
        let linked = self.linked.clone();
        linked.close(self.emulator.board_simulation());
        for _ in 0..500 {
            self.emulator.tick();
        }
        self.flush();
        let end = self.emulator.ticks();
        self.events.push(RecordingEvent::End(end));
        (encode(&self.events), self.emulator, self.sent)
    }
}

fn encode(events: &[RecordingEvent]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = RecordingEncoder::new(&mut bytes);
    for event in events {
        encoder.encode(event, &mut bytes).unwrap();
    }
    bytes
}

/// A session with a Grbl board: settings, RESET, return to machine zero, jog.
fn session() -> (Vec<u8>, Emulator, u64) {
    let twin = GrblTwin::new(Variant::Grbl, GrblSettings::default());
    let mut lathe = RecordedLathe::connect(twin, LinkConfig::default());
    lathe.wait_for(LinkState::Configure);
    lathe.log.add(BoardStep::SettingsWritten);
    lathe.linked.write_settings();
    lathe.wait_for(LinkState::Locked);
    lathe.press(Key::Reset, 100);
    move_slides(lathe)
}

fn move_slides<T: BenchBoard>(mut lathe: RecordedLathe<T>) -> (Vec<u8>, Emulator, u64) {
    lathe.press(Key::MachineZero, 100);
    for key in [Key::XDown, Key::ZRight] {
        lathe.press(key, 8000);
    }
    lathe.wait_for(LinkState::Ready);
    let from = lathe.twin.pulses();
    lathe.press(Key::Jog, 100);
    lathe.press(Key::ZLeft, 1500);
    assert_ne!(lathe.twin.pulses(), from, "the slides move");
    lathe.finish()
}

#[test]
fn the_exchange_is_replayed_without_the_board() {
    let (recording, end, sent) = session();
    let replayed = replay(&recording).unwrap();
    assert_eq!((replayed.error, replayed.difference), (None, None));
    assert!(replayed.is_complete && replayed.equal_hashes > 10);
    let exchange = replayed.exchange.unwrap();
    assert_eq!(exchange.first_difference, None);
    assert_eq!(exchange.sent_bytes, sent);
    assert!(exchange.received_bytes > 1000, "{exchange:?}");
    let history = replayed.history.unwrap();
    assert!(history.present().unwrap().emulator == end);
    // Machine time without the board alone can be reached.
    assert_eq!(history.start() + 500, history.end());
    let per_second = recording.len() as f64 / (replayed.replayed_ticks as f64 / 1000.0);
    println!("{per_second:.0} bytes a second");
    assert!(per_second < 40_000.0, "{per_second}");
}

#[test]
fn the_exchange_with_timed_steps_is_replayed_without_the_board() {
    let config: LinkConfig = ron::from_str(
        r#"(protocol: StepQueue, baud: 250000, x: (step: "PA0", dir: "PA1", limit: "^PC0"),
            z: (step: "PA2", dir: "PA3", limit: "^PC1"), io: (enable: "PL0"))"#,
    )
    .unwrap();
    let twin = TimedBoard(
        KlipperTwin::new(KlipperHardware::default()),
        [800, 400],
        false,
    );
    let mut lathe = RecordedLathe::connect(twin, config);
    lathe.wait_for(LinkState::Locked);
    lathe.press(Key::Reset, 100);
    let (recording, end, sent) = move_slides(lathe);
    let replayed = replay(&recording).unwrap();
    assert_eq!((replayed.error, replayed.difference), (None, None));
    let exchange = replayed.exchange.unwrap();
    assert_eq!(
        (exchange.first_difference, exchange.sent_bytes),
        (None, sent)
    );
    assert!(replayed.history.unwrap().present().unwrap().emulator == end);
}

/// Replays the session with one of its steps changed.
fn replay_changed(change: impl Fn(&mut BoardStep) -> bool) -> gsk_history::replay::Replay {
    let (recording, ..) = session();
    let mut reader = RecordingReader::new(&recording).unwrap();
    let mut events = Vec::new();
    let mut is_changed = false;
    while let Some(mut event) = reader.next_event().unwrap() {
        if let RecordingEvent::Board(step) = &mut event
            && !is_changed
        {
            is_changed = change(step);
        }
        events.push(event);
    }
    assert!(is_changed);
    replay(&encode(&events)).unwrap()
}

#[test]
fn other_bytes_than_recorded_are_noticed() {
    let sent = replay_changed(|step| match step {
        BoardStep::Written(ExchangedBytes(bytes)) if bytes.len() > 10 => {
            bytes[5] ^= 1;
            true
        }
        _ => false,
    });
    assert!(sent.exchange.unwrap().first_difference.is_some());
}

#[test]
fn steps_of_a_board_that_is_not_connected_are_out_of_order() {
    let (recording, ..) = session();
    let mut reader = RecordingReader::new(&recording).unwrap();
    let mut events = Vec::new();
    while let Some(event) = reader.next_event().unwrap() {
        let is_opening = matches!(
            &event,
            RecordingEvent::Board(step) if matches!(**step, BoardStep::Opened { .. })
        );
        if !is_opening {
            events.push(event);
        }
    }
    let replayed = replay(&encode(&events)).unwrap();
    assert!(matches!(
        replayed.error,
        Some(gsk_history::recording::RecordingError::OutOfOrder(_))
    ));
}
