//! Fuzzes the step link with any bytes from a board of timed steps, at any time, between any
//! actions of the operator. It must not panic or use unbounded memory, and the axes move only
//! after motion was accepted.
//!
//! Bytes below F0 are collected. The others are actions and time, or send the collected bytes:
//! unchanged, or as the content of a valid block.

use core::mem::discriminant;
use core::time::Duration;
use std::cell::OnceCell;

use gsk_core::linked::drives_from_parameters;
use gsk_core::memory::ControlParameters;
use gsk_core::units::{PerAxis, Pulses};
use gsk_link::step_queue::StepLink;
use gsk_link::{AwaitedInput, Backend, Input, InputCondition, LinkConfig, RunTime, Sample, Stop};
use gsk_twins::klipper::{KlipperHardware, KlipperTwin, encode_block};

use super::watch;

const WIRED: &str = r#"(protocol: StepQueue,
    x: (step: "PA0", dir: "PA1", limit: "^PC0"), z: (step: "PA2", dir: "PA3", limit: "PC1", dec: "PC6"),
    io: (enable: "PL0", estop: "PC2", coolant: "PB7", index: "PC3"))"#;
/// Time after accepted motion within which the board may still move the axes.
const EXECUTION_DELAY: Duration = Duration::from_millis(1500);

#[derive(Clone)]
struct StepLinkFixture {
    link: StepLink,
    twin: KlipperTwin,
    run: RunTime,
    z: i64,
    collected: Vec<u8>,
    /// Sequence number of the last block sent to the link.
    sequence: u8,
    /// Time at which the link last accepted motion.
    last_accepted: Duration,
}

pub(super) fn fuzz_step_link(input: &[u8]) {
    thread_local! {
        static READY: OnceCell<StepLinkFixture> = const { OnceCell::new() };
    }
    let mut desk = READY.with(|ready| ready.get_or_init(ready_fixture).clone());
    for &byte in input {
        let before = desk.twin.pulses();
        watch::run_unit(|| execute_action(&mut desk, byte));
        watch::record_event("state", discriminant(&desk.link.state()));
        let now = desk.now();
        if desk.link.takes_motion() {
            desk.last_accepted = now;
        }
        assert!(
            desk.twin.pulses() == before || now - desk.last_accepted < EXECUTION_DELAY,
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
            watch::record_event("event", discriminant(&event));
        }
    }
}

impl StepLinkFixture {
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

    fn pass(&mut self, ms: u64, can_receive: bool) {
        self.twin.advance(ms * 1_000_000);
        let bytes = self.twin.read();
        if can_receive {
            self.link.rx(&bytes, self.now());
        }
    }
}

fn execute_action(fixture: &mut StepLinkFixture, byte: u8) {
    let at = PerAxis::new(Pulses(0), Pulses(fixture.z));
    match byte {
        0xF0 => {
            fixture.run += Duration::from_millis(1);
            fixture.z -= 2;
            let pulses = PerAxis::new(Pulses(0), Pulses(fixture.z));
            if fixture.link.free_lookahead() > Duration::ZERO {
                let _ = fixture.link.push(Sample::new(fixture.run, pulses));
            }
        }
        0xF1 => fixture.pass(1, true),
        0xF2 => fixture.pass(20, true),
        0xF3 => fixture.pass(20, false),
        0xF4 => fixture.pass(300, true),
        0xF5 => fixture.link.stop(if fixture.z % 4 == 0 {
            Stop::Flush
        } else {
            Stop::Kill
        }),
        0xF6 => fixture.link.reset(),
        0xF7 => {
            let _ = fixture.link.set_position(at, fixture.run);
        }
        0xF8 => {
            let _ = fixture.link.release(at, fixture.run);
        }
        0xF9 => {
            let _ = fixture.link.finish();
        }
        0xFA => {
            let until = match fixture.z.rem_euclid(3) {
                0 => InputCondition::Operated,
                1 => InputCondition::Free,
                _ => InputCondition::Changed,
            };
            let _ = fixture.link.arm(AwaitedInput {
                input: Input::DecelerationZ,
                until,
                rate: 1000.0,
            });
        }
        0xFB => fixture.twin.set_pin("PC1", fixture.z % 4 == 0),
        0xFC => {
            let collected = core::mem::take(&mut fixture.collected);
            fixture.link.rx(&collected, fixture.now());
        }
        0xFD | 0xFE => {
            let mut collected = core::mem::take(&mut fixture.collected);
            collected.truncate(59);
            let sequence = fixture.sequence.wrapping_add(byte & 1);
            fixture
                .link
                .rx(&encode_block(sequence, &collected), fixture.now());
        }
        0xFF => fixture.twin.press_reset(),
        _ => fixture.collected.push(byte),
    }
    fixture.link.tick(fixture.now());
}

/// Returns a link that has identified its board and may move it.
fn ready_fixture() -> StepLinkFixture {
    let config: LinkConfig = ron::from_str(WIRED).unwrap_or_default();
    let mut desk = StepLinkFixture {
        link: StepLink::open(
            config,
            &drives_from_parameters(&ControlParameters::default()),
            Duration::ZERO,
        ),
        twin: KlipperTwin::new(KlipperHardware::default()),
        run: RunTime::ZERO,
        z: 0,
        collected: Vec::new(),
        sequence: 0,
        last_accepted: Duration::ZERO,
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
