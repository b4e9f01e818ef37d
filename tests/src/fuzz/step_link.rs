//! Any bytes from a board of timed steps, at any time, between any acts of the
//! operator: no panic, nothing without a bound, and the axes move only when motion
//! was taken.
//!
//! Bytes below F0 are collected; the others are acts and time, or send what was
//! collected: as it is, or as the content of a block that is whole.

use core::mem::discriminant;
use core::time::Duration;
use std::cell::OnceCell;

use gsk_core::linked::drives;
use gsk_core::memory::Parameters;
use gsk_core::units::{PerAxis, Pulses};
use gsk_link::step_queue::StepLink;
use gsk_link::{AwaitedInput, Backend, Input, InputCondition, LinkConfig, RunTime, Sample, Stop};
use gsk_twins::klipper::{KlipperHardware, KlipperTwin, encode_block};

use super::watch;

const WIRED: &str = r#"(protocol: StepQueue,
    x: (step: "PA0", dir: "PA1", limit: "^PC0"), z: (step: "PA2", dir: "PA3", limit: "PC1", dec: "PC6"),
    io: (enable: "PL0", estop: "PC2", coolant: "PB7", index: "PC3"))"#;
/// Motion in the board may be made so long after it was taken.
const LATER: Duration = Duration::from_millis(1500);

#[derive(Clone)]
struct Desk {
    link: StepLink,
    twin: KlipperTwin,
    run: RunTime,
    z: i64,
    collected: Vec<u8>,
    /// Sequence of the last block sent.
    sequence: u8,
    /// When motion was last taken.
    took: Duration,
}

pub(super) fn run(input: &[u8]) {
    thread_local! {
        static READY: OnceCell<Desk> = const { OnceCell::new() };
    }
    let mut desk = READY.with(|ready| ready.get_or_init(ready_desk).clone());
    for &byte in input {
        let before = desk.twin.pulses();
        watch::unit(|| act(&mut desk, byte));
        watch::seen("state", discriminant(&desk.link.state()));
        let now = desk.now();
        if desk.link.takes_motion() {
            desk.took = now;
        }
        assert!(
            desk.twin.pulses() == before || now - desk.took < LATER,
            "motion in {:?}",
            desk.link.state()
        );
        assert!(
            desk.link.tx().len() < 16_384,
            "{} bytes",
            desk.link.tx().len()
        );
        desk.send();
        for event in desk.link.events() {
            watch::seen("event", discriminant(&event));
        }
    }
}

impl Desk {
    fn now(&self) -> Duration {
        Duration::from_nanos(self.twin.now())
    }

    fn send(&mut self) {
        let bytes = self.link.tx().to_vec();
        if let Some(&last) = bytes.len().checked_sub(1).and_then(|_| bytes.get(1)) {
            self.sequence = last & 0x0F;
        }
        self.twin.write(&bytes);
        self.link.consumed(bytes.len());
    }

    fn pass(&mut self, ms: u64, hears: bool) {
        self.twin.advance(ms * 1_000_000);
        let said = self.twin.read();
        if hears {
            self.link.rx(&said, self.now());
        }
    }
}

fn act(desk: &mut Desk, byte: u8) {
    let at = PerAxis::new(Pulses(0), Pulses(desk.z));
    match byte {
        0xF0 => {
            desk.run += Duration::from_millis(1);
            desk.z -= 2;
            let pulses = PerAxis::new(Pulses(0), Pulses(desk.z));
            if desk.link.free_lookahead() > Duration::ZERO {
                let _ = desk.link.push(Sample::new(desk.run, pulses));
            }
        }
        0xF1 => desk.pass(1, true),
        0xF2 => desk.pass(20, true),
        0xF3 => desk.pass(20, false),
        0xF4 => desk.pass(300, true),
        0xF5 => desk.link.stop(if desk.z % 4 == 0 {
            Stop::Flush
        } else {
            Stop::Kill
        }),
        0xF6 => desk.link.reset(),
        0xF7 => {
            let _ = desk.link.set_position(at, desk.run);
        }
        0xF8 => {
            let _ = desk.link.release(at, desk.run);
        }
        0xF9 => {
            let _ = desk.link.finish();
        }
        0xFA => {
            let until = match desk.z.rem_euclid(3) {
                0 => InputCondition::Operated,
                1 => InputCondition::Free,
                _ => InputCondition::Changed,
            };
            let _ = desk.link.arm(AwaitedInput {
                input: Input::DecelerationZ,
                until,
                rate: 1000.0,
            });
        }
        0xFB => desk.twin.set_pin("PC1", desk.z % 4 == 0),
        0xFC => {
            let said = core::mem::take(&mut desk.collected);
            desk.link.rx(&said, desk.now());
        }
        0xFD | 0xFE => {
            let mut said = core::mem::take(&mut desk.collected);
            said.truncate(59);
            let sequence = desk.sequence.wrapping_add(byte & 1);
            desk.link.rx(&encode_block(sequence, &said), desk.now());
        }
        0xFF => desk.twin.press_reset(),
        _ => desk.collected.push(byte),
    }
    desk.link.tick(desk.now());
}

/// A link that has come to know its board and may move it.
fn ready_desk() -> Desk {
    let config: LinkConfig = ron::from_str(WIRED).unwrap_or_default();
    let mut desk = Desk {
        link: StepLink::open(config, &drives(&Parameters::default()), Duration::ZERO),
        twin: KlipperTwin::new(KlipperHardware::default()),
        run: RunTime::ZERO,
        z: 0,
        collected: Vec::new(),
        sequence: 0,
        took: Duration::ZERO,
    };
    for _ in 0..2000 {
        desk.pass(1, true);
        let now = desk.now();
        desk.link.tick(now);
        desk.send();
    }
    let placed = desk.link.set_position(PerAxis::default(), RunTime::ZERO);
    assert_eq!(placed, Ok(()), "the twin agrees with the link");
    desk.link.events();
    desk
}
