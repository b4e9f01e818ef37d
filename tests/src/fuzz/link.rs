//! Fuzzes the line link with any bytes from a pulse board at any time, between any actions of
//! the operator. Motion is sent only in the states that allow it, and never more than the
//! lookahead.
//!
//! Bytes below F0 come from the board; the others are actions and time.

use core::mem::discriminant;
use core::time::Duration;
use std::cell::OnceCell;

use gsk_core::linked::drives_from_parameters;
use gsk_core::memory::ControlParameters;
use gsk_core::units::{PerAxis, Pulses};
use gsk_link::line::LineLink;
use gsk_link::{Backend, LinkConfig, LinkState, RunTime, Sample, Stop};
use gsk_twins::grbl::{GrblSettings, GrblTwin, Variant};

use super::watch;

/// Length of the longest line that a board reads, bytes.
const MAX_LINE_BYTES: usize = 70;

#[derive(Clone)]
struct LineLinkFixture {
    link: LineLink,
    now: Duration,
    run: RunTime,
    z: i64,
}

pub(super) fn fuzz_line_link(input: &[u8]) {
    thread_local! {
        static READY: [OnceCell<LineLinkFixture>; 2] = const { [OnceCell::new(), OnceCell::new()] };
    }
    // The first byte selects the board.
    let (input, which) = match input {
        [0xEF, rest @ ..] => (rest, 1),
        whole => (whole, 0),
    };
    let variant = [Variant::Grbl, Variant::FluidNc][which];
    let mut desk = READY.with(|ready| ready[which].get_or_init(|| ready_fixture(variant)).clone());
    for &byte in input {
        let before = desk.link.state();
        watch::run_unit(|| execute_action(&mut desk, byte));
        watch::record_event("state", discriminant(&desk.link.state()));
        let lines = String::from_utf8_lossy(desk.link.tx()).into_owned();
        for line in lines.lines() {
            assert!(
                line.len() <= MAX_LINE_BYTES,
                "a line of {} bytes",
                line.len()
            );
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

fn execute_action(fixture: &mut LineLinkFixture, byte: u8) {
    match byte {
        0xF0 => {
            fixture.run += Duration::from_millis(1);
            fixture.z -= 2;
            let pulses = PerAxis::new(Pulses(0), Pulses(fixture.z));
            if fixture.link.free_lookahead() > Duration::ZERO {
                let _ = fixture.link.push(Sample::new(fixture.run, pulses));
            }
        }
        0xF1 => fixture.now += Duration::from_millis(5),
        0xF2 => fixture.now += Duration::from_millis(300),
        0xF3 => fixture.link.stop(Stop::Flush),
        0xF4 => fixture.link.stop(Stop::Kill),
        0xF5 => fixture.link.reset(),
        0xF6 => {
            let at = PerAxis::new(Pulses(0), Pulses(fixture.z));
            let _ = fixture.link.set_position(at, fixture.run);
        }
        0xF7 => {
            let _ = fixture.link.finish();
        }
        0xF8 => fixture.link.write_settings(),
        0xF9 => {
            fixture.link = LineLink::open(
                LinkConfig::default(),
                &drives_from_parameters(&ControlParameters::default()),
                fixture.now,
            );
        }
        0xFA.. => {}
        _ => fixture.link.rx(&[byte], fixture.now),
    }
    fixture.link.tick(fixture.now);
}

/// Returns a link that has identified its board and may move it.
fn ready_fixture(variant: Variant) -> LineLinkFixture {
    let mut settings = GrblSettings::default();
    let mut link = LineLink::open(
        LinkConfig::default(),
        &drives_from_parameters(&ControlParameters::default()),
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
            // The FluidNC settings are written by name.
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
    LineLinkFixture {
        link,
        now: Duration::from_secs(9),
        run: RunTime::ZERO,
        z: 0,
    }
}
