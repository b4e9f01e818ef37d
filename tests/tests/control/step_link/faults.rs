//! What goes wrong.

use core::time::Duration;

use gsk_core::linked::drives;
use gsk_core::units::{PerAxis, Pulses};
use gsk_link::step_queue::StepLink;
use gsk_link::{Backend, LinkEvent, LinkState, Stop};
use gsk_twins::klipper::KlipperState;
use gsk_twins::wire::Damage;

use super::bench::{Bench, MS, config, parameters};

/// The host dies: nobody renews anything any more.
#[test]
fn a_dead_host_stops_the_axes_within_250_ms() {
    let mut bench = Bench::ready();
    // Motion for longer than the heartbeat lasts lies in the board.
    let mut long = config();
    long.lookahead_ms = Some(400);
    bench.link = StepLink::open(
        long,
        &drives(&parameters()),
        Duration::from_nanos(bench.twin.now()),
    );
    bench.pass(1500);
    assert_eq!(bench.link.state(), LinkState::Locked, "{:?}", bench.events);
    bench.set_position();
    assert!(bench.feed(-4.0, 800));
    let died = bench.twin.now();
    bench.twin.advance(2000 * MS);
    let stood = bench.twin.last_pulse_ns() - died;
    assert!(stood <= 250 * MS, "{stood}");
    assert!(
        matches!(bench.twin.state(), KlipperState::Shutdown(text) if text.starts_with("Missed"))
    );
    let made = bench.made();
    // It comes back and finds all it needs to know.
    bench.host();
    bench.pass(100);
    assert_eq!(bench.made(), made);
    assert!(bench.alarms().contains(&605), "{:?}", bench.events);
    assert_eq!(bench.link.position(), None);
}

#[test]
fn a_host_that_pauses_is_not_noticed_or_ends_in_the_defined_stop() {
    for (pause, noticed) in [
        (10, false),
        (50, false),
        (90, false),
        (150, true),
        (400, true),
        (2000, true),
    ] {
        let mut bench = Bench::ready();
        let mut whole = bench.feed(-4.0, 500);
        bench.twin.advance(pause * MS);
        bench.host();
        whole &= bench.feed(-4.0, 500);
        assert_eq!(whole, !noticed, "{pause}: {:?}", bench.events);
        assert!(
            bench.twin.statistics().min_lead_ns > 0,
            "{pause}: a step came late"
        );
        if noticed {
            bench.pass(1000);
            let known = [605, 612];
            assert!(
                bench.alarms().iter().all(|number| known.contains(number)),
                "{:?}",
                bench.events
            );
            assert!(!bench.alarms().is_empty());
            assert_eq!(bench.link.position(), None, "{pause}: it was stopped fast");
            assert!(!bench.link.state().takes_motion());
            if bench.twin.state() == KlipperState::Running {
                let (x, z) = bench.made();
                let stood = LinkEvent::Position(PerAxis::new(Pulses(x), Pulses(z)));
                assert!(bench.events.contains(&stood), "{pause}: {:?}", bench.events);
            }
            bench.stands(2000);
        } else {
            bench.link.finish().unwrap();
            assert!(
                bench.gets(LinkState::Ready, 500),
                "{pause}: {:?}",
                bench.events
            );
            assert_eq!(bench.made(), (0, -4000));
        }
    }
}

#[test]
fn a_slow_motion_that_runs_dry_keeps_its_position() {
    let mut bench = Bench::ready();
    assert!(bench.feed(-0.9, 500));
    bench.twin.advance(180 * MS);
    bench.pass(300);
    assert_eq!(
        (bench.link.state(), bench.alarms()),
        (LinkState::Fault, vec![612])
    );
    let (x, z) = bench.made();
    assert_eq!(
        bench.link.position(),
        Some(PerAxis::new(Pulses(x), Pulses(z)))
    );
    bench.stands(500);
    bench.link.reset();
    assert_eq!(bench.link.state(), LinkState::Locked);
    bench.at = (x as f64, z as f64);
    bench.set_position();
    assert!(bench.job() && bench.gets(LinkState::Ready, 500));
    assert_eq!(bench.made(), bench.counted());
}

#[test]
fn a_board_that_restarts_is_noticed_in_every_state() {
    for state in 0..3 {
        let mut bench = Bench::ready();
        match state {
            0 => {}
            1 => assert!(bench.feed(-4.0, 300)),
            _ => bench.link.stop(Stop::Flush),
        }
        bench.twin.press_reset();
        bench.pass(1500);
        assert_eq!(
            bench.link.state(),
            LinkState::Fault,
            "{state}: {:?}",
            bench.events
        );
        assert_eq!(bench.alarms(), [606], "{state}");
        assert_eq!(bench.link.position(), None);
        bench.stands(500);
        bench.link.reset();
        assert!(
            bench.gets(LinkState::Locked, 3000),
            "{state}: {:?}",
            bench.events
        );
    }
}

#[test]
fn an_unplugged_cable_is_605() {
    let mut bench = Bench::ready();
    assert!(bench.feed(-4.0, 300));
    bench.twin.to_host.set_cut(true);
    bench.twin.to_board.set_cut(true);
    bench.pass(1000);
    assert_eq!(
        (bench.link.state(), bench.alarms()),
        (LinkState::Lost, vec![605])
    );
    bench.stands(2000);
}

/// The job with damage on the wire: it ends on the pulse with the count compared, or
/// it stands with an alarm and says whether it knows where. Nothing third.
fn ends_defined(mut bench: Bench, place: &str) -> (bool, i64) {
    let whole = bench.job();
    bench.pass(1500);
    let proved = match bench.link.state() {
        LinkState::Ready if whole && bench.alarms().is_empty() => {
            assert_eq!(bench.made(), (0, -100), "{place}");
            true
        }
        LinkState::Locked | LinkState::Fault | LinkState::Lost | LinkState::Tripped => {
            assert!(!bench.alarms().is_empty(), "{place}: {:?}", bench.events);
            if let Some(position) = bench.link.position() {
                assert_eq!((position.x.0, position.z.0), bench.made(), "{place}");
            }
            false
        }
        state => panic!("{place}: {state:?} {:?}", bench.events),
    };
    bench.stands(500);
    (proved, bench.twin.statistics().min_lead_ns)
}

/// A fault at every byte of a short job, either way.
#[test]
fn a_fault_at_any_byte_ends_known_or_declared_unknown() {
    // EVERY_BYTE=1 leaves none out, and does everything to each.
    let every = std::env::var_os("EVERY_BYTE").is_some();
    let step = if every { 1 } else { 149 };
    let damages = [
        Damage::Lost,
        Damage::Changed(0x15),
        Damage::Doubled,
        Damage::Delayed(100 * MS),
        Damage::Cut,
    ];
    let ready = Bench::ready();
    let clean = {
        let mut bench = ready.clone();
        assert!(bench.job() && bench.gets(LinkState::Ready, 1000));
        (
            bench.twin.to_board.sent_count(),
            bench.twin.to_host.sent_count(),
        )
    };
    let (mut proved, mut stopped) = (0, 0);
    // Jobs on a line that becomes slow at this byte, and those that broke off.
    let (mut slow, mut too_slow) = (0, 0);
    for (to_board, first, last) in [
        (true, ready.twin.to_board.sent_count(), clean.0),
        (false, ready.twin.to_host.sent_count(), clean.1),
    ] {
        for (index, byte) in (first..last).step_by(step).enumerate() {
            let one = index % damages.len();
            let kinds = if every {
                &damages[..]
            } else {
                &damages[one..=one]
            };
            for &damage in kinds {
                let mut bench = ready.clone();
                if to_board {
                    bench.twin.to_board.damage(byte, damage);
                } else {
                    bench.twin.to_host.damage(byte, damage);
                }
                let place = format!("{damage:?} at {byte}, to the board: {to_board}");
                let (proves, lead) = ends_defined(bench, &place);
                assert!(lead > 0, "{place}: a step came late");
                slow += i32::from(damage == Damage::Delayed(100 * MS));
                too_slow += i32::from(damage == Damage::Delayed(100 * MS) && !proves);
                if proves {
                    proved += 1;
                    assert_ne!(damage, Damage::Cut);
                } else {
                    stopped += 1;
                }
            }
        }
    }
    println!("{proved} jobs ended on the pulse, {stopped} in the defined stop");
    println!("of {slow} on a line that became slow {too_slow} broke off");
    assert!(slow > 0 && too_slow * 33 <= slow, "{too_slow} of {slow}");
    assert!(proved > stopped && stopped > 0, "{proved} {stopped}");
}

/// The board loses power at any moment of a job.
#[test]
fn a_reset_at_any_moment_of_a_job_is_606() {
    let ready = Bench::ready();
    for at in (0..1200).step_by(97) {
        let mut bench = ready.clone();
        for k in 0..1000_i64 {
            if k == at {
                bench.twin.press_reset();
            }
            if !bench.feed(if k < 500 { -3.0 } else { 3.0 }, 1) {
                break;
            }
        }
        if at >= 1000 {
            bench.twin.press_reset();
        }
        bench.pass(1500);
        assert_eq!(
            bench.link.state(),
            LinkState::Fault,
            "{at}: {:?}",
            bench.events
        );
        assert!(bench.alarms().contains(&606), "{at}: {:?}", bench.alarms());
        assert_eq!(bench.link.position(), None);
        bench.stands(500);
    }
}

/// A line on which every so many bytes one is lost: what comes through is whole.
#[test]
fn a_bad_line_is_survived() {
    let mut bench = Bench::ready();
    let (out, back) = (
        bench.twin.to_board.sent_count(),
        bench.twin.to_host.sent_count(),
    );
    for k in 1..200 {
        bench.twin.to_board.damage(out + k * 601, Damage::Lost);
        bench
            .twin
            .to_board
            .damage(out + k * 907, Damage::Changed(0x40));
        bench.twin.to_host.damage(back + k * 701, Damage::Doubled);
        bench.twin.to_host.damage(back + k * 1103, Damage::Lost);
    }
    assert!(bench.job(), "{:?}", bench.events);
    assert!(bench.gets(LinkState::Ready, 1000), "{:?}", bench.events);
    assert_eq!((bench.made(), bench.alarms()), ((0, -100), vec![]));
    assert!(
        bench.link.traffic().resent > 10,
        "{:?}",
        bench.link.traffic()
    );
}

/// The PC is away for longer than the heartbeat lasts, not for as long as the drives
/// keep their enable: standing slides lose neither drives nor count.
#[test]
fn a_heartbeat_lost_at_rest_leaves_the_board_running() {
    for lookahead in [100, 400] {
        for phase in (0..100).step_by(13) {
            let mut bench = Bench::ready();
            let mut config = config();
            config.lookahead_ms = Some(lookahead);
            let now = Duration::from_nanos(bench.twin.now());
            bench.link = StepLink::open(config, &drives(&parameters()), now);
            bench.pass(2000);
            bench.set_position();
            bench.pass(500 + phase);
            bench.events.clear();
            bench.twin.advance(430 * MS);
            bench.pass(500);
            let place = format!("{lookahead} {phase}: {:?}", bench.events);
            assert_eq!(bench.twin.state(), KlipperState::Running, "{place}");
            assert_eq!(bench.link.state(), LinkState::Tripped, "{place}");
            assert_eq!(bench.alarms(), [605], "{place}");
            assert!(bench.link.position().is_some(), "{place}");
        }
    }
}
