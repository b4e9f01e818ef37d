//! Any bytes from a pulse board, at any time, between any acts of the operator:
//! motion goes out only where the state allows it, and never more than the
//! lookahead.
//!
//! Bytes below F0 come from the board; the others are acts and time.

use core::mem::discriminant;
use core::time::Duration;
use std::cell::OnceCell;

use gsk_core::linked::drives;
use gsk_core::memory::Parameters;
use gsk_core::units::{PerAxis, Pulses};
use gsk_link::line::LineLink;
use gsk_link::{Backend, LinkConfig, LinkState, RunTime, Sample, Stop};
use gsk_twins::grbl::{GrblSettings, GrblTwin, Variant};

use super::watch;

/// The longest line a board reads.
const LINE: usize = 70;

#[derive(Clone)]
struct Desk {
    link: LineLink,
    now: Duration,
    run: RunTime,
    z: i64,
}

pub(super) fn run(input: &[u8]) {
    thread_local! {
        static READY: [OnceCell<Desk>; 2] = const { [OnceCell::new(), OnceCell::new()] };
    }
    // The first byte says which board it is.
    let (input, which) = match input {
        [0xEF, rest @ ..] => (rest, 1),
        whole => (whole, 0),
    };
    let variant = [Variant::Grbl, Variant::FluidNc][which];
    let mut desk = READY.with(|ready| ready[which].get_or_init(|| ready_desk(variant)).clone());
    for &byte in input {
        let before = desk.link.state();
        watch::unit(|| act(&mut desk, byte));
        watch::seen("state", discriminant(&desk.link.state()));
        let lines = String::from_utf8_lossy(desk.link.tx()).into_owned();
        for line in lines.lines() {
            assert!(line.len() <= LINE, "a line of {} bytes", line.len());
            let moves = line.contains(['X', 'Z']) && !line.starts_with('$');
            assert!(
                !moves || before.takes_motion(),
                "motion in {before:?}: {line}"
            );
        }
        let sent = desk.link.tx().len();
        desk.link.consumed(sent);
        let most = Duration::from_millis(150) + Duration::from_millis(500);
        assert!(desk.link.outstanding() <= most);
        desk.link.events();
    }
}

fn act(desk: &mut Desk, byte: u8) {
    match byte {
        0xF0 => {
            desk.run += Duration::from_millis(1);
            desk.z -= 2;
            let pulses = PerAxis::new(Pulses(0), Pulses(desk.z));
            if desk.link.free_lookahead() > Duration::ZERO {
                let _ = desk.link.push(Sample::new(desk.run, pulses));
            }
        }
        0xF1 => desk.now += Duration::from_millis(5),
        0xF2 => desk.now += Duration::from_millis(300),
        0xF3 => desk.link.stop(Stop::Flush),
        0xF4 => desk.link.stop(Stop::Kill),
        0xF5 => desk.link.reset(),
        0xF6 => {
            let at = PerAxis::new(Pulses(0), Pulses(desk.z));
            let _ = desk.link.set_position(at, desk.run);
        }
        0xF7 => {
            let _ = desk.link.finish();
        }
        0xF8 => desk.link.write_settings(),
        0xF9 => {
            desk.link = LineLink::open(
                LinkConfig::default(),
                &drives(&Parameters::default()),
                desk.now,
            );
        }
        0xFA.. => {}
        _ => desk.link.rx(&[byte], desk.now),
    }
    desk.link.tick(desk.now);
}

/// A link that has come to know its board and may move it.
fn ready_desk(variant: Variant) -> Desk {
    let mut settings = GrblSettings::default();
    let mut link = LineLink::open(
        LinkConfig::default(),
        &drives(&Parameters::default()),
        Duration::ZERO,
    );
    for setting in &link.required().settings {
        let _ = settings.set(setting.number, setting.value);
    }
    let mut twin = GrblTwin::new(variant, settings);
    for ms in 1..=9000 {
        twin.advance(1_000_000);
        let now = Duration::from_millis(ms);
        link.rx(&twin.read(), now);
        link.tick(now);
        twin.write(link.tx());
        let sent = link.tx().len();
        link.consumed(sent);
        match ms {
            // What a FluidNC board is to be set to it is told by name.
            4000 => link.write_settings(),
            6000 => link.reset(),
            8500 => {
                let _ = link.set_position(PerAxis::default(), RunTime::ZERO);
            }
            _ => {}
        }
    }
    link.events();
    assert_eq!(
        link.state(),
        LinkState::Ready,
        "the twin agrees with the link"
    );
    Desk {
        link,
        now: Duration::from_secs(9),
        run: RunTime::ZERO,
        z: 0,
    }
}
