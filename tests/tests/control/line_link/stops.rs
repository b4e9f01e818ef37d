//! Stops of a line board: resets, limit switches, restarts, pauses of the computer, and the
//! stop bytes of the port guard.

use core::time::Duration;

use gsk_core::linked::drives_from_parameters;
use gsk_core::memory::ControlParameters;
use gsk_core::units::{PerAxis, Pulses};
use gsk_link::line::LineLink;
use gsk_link::{Backend, LinkConfig, LinkEvent, LinkState, Sample, Stop};
use gsk_twins::grbl::Variant;
use gsk_twins::wire::Damage;

use super::{ALL, LineBench, MS_IN_NS};

#[test]
fn a_flush_in_motion_keeps_the_position() {
    for variant in ALL {
        for at in (60..900).step_by(37) {
            let mut bench = LineBench::ready(variant);
            for k in 1..=at {
                assert!(bench.send_sample(k * 2, -k * 4));
            }
            bench.link.stop(Stop::Flush);
            assert!(bench.is_ready_at_end(), "{at}: {:?}", bench.events);
            let [x, z] = bench.twin.pulses();
            let stood = LinkEvent::Position(PerAxis::new(Pulses(x), Pulses(z)));
            assert!(
                bench.events.contains(&stood),
                "{at}: {x} {z} {:?}",
                bench.events
            );
            // And it continues from there.
            bench.at = (x, z);
            assert!(
                bench.run_job() && bench.is_ready_at_end(),
                "{at}: {:?}",
                bench.events
            );
            assert_eq!(bench.twin.pulses(), [x, z - 100]);
        }
    }
}

#[test]
fn a_kill_loses_the_position_and_reports_it() {
    for variant in ALL {
        let mut bench = LineBench::ready(variant);
        for k in 1..=300 {
            assert!(bench.send_sample(0, -k * 4));
        }
        bench.link.stop(Stop::Kill);
        bench.run_ms(1000);
        assert_eq!(bench.link.state(), LinkState::Locked);
        assert!(!bench.send_sample(0, 0));
        let stood = bench.twin.pulses();
        bench.run_ms(2000);
        assert_eq!(bench.twin.pulses(), stood);
    }
}

/// The link sends nothing twice except the reset, which it repeats until the board answers.
#[test]
fn a_reset_that_is_lost_on_the_wire_is_sent_again() {
    for variant in ALL {
        for lost in [0, 1, 4] {
            let mut bench = LineBench::ready(variant);
            for k in 1..=300 {
                assert!(bench.send_sample(0, -k * 4));
            }
            let next = bench.twin.to_board.sent_count();
            for byte in next..next + lost {
                bench.twin.to_board.damage(byte, Damage::Changed(0x01));
            }
            bench.link.stop(Stop::Kill);
            // FluidNC executes what its pulse timer has received.
            let coasts = if variant == Variant::FluidNc { 200 } else { 0 };
            bench.run_ms(100 * lost as u32 + 60 + coasts);
            let stood = bench.twin.pulses();
            bench.run_ms(3000);
            assert_eq!(bench.twin.pulses(), stood);
            assert_eq!(bench.link.state(), LinkState::Locked, "{lost}");
            assert_eq!(bench.alarms(), [0_u16; 0], "{:?}", bench.events);
            bench.at = (0, 0);
            bench.set_position();
            assert!(bench.run_job() && bench.is_ready_at_end());
        }
    }
}

/// On a line that becomes slow, each reset brings a late banner.
#[test]
fn the_banners_of_a_reset_that_was_sent_again_are_no_restart() {
    for held_up in [150, 300] {
        let mut bench = LineBench::ready(Variant::Grbl);
        for k in 1..=300 {
            assert!(bench.send_sample(0, -k * 4));
        }
        let next = bench.twin.to_host.sent_count();
        bench
            .twin
            .to_host
            .damage(next, Damage::Delayed(held_up * MS_IN_NS));
        bench.link.stop(Stop::Kill);
        bench.run_ms(3000);
        assert_eq!(bench.link.state(), LinkState::Locked);
        bench.link.reset();
        bench.run_ms(1500);
        let set = bench.link.set_position(PerAxis::default(), bench.run);
        assert_eq!(set, Ok(()));
        bench.run_ms(1500);
        assert_eq!(bench.alarms(), [0_u16; 0], "{:?}", bench.events);
        assert_eq!(bench.link.state(), LinkState::Ready);
    }
}

/// The board's queue shows the direction in which its switch was hit. If the axis reversed
/// about then, the direction is unknown.
#[test]
fn the_direction_into_a_limit_switch_is_that_of_the_motion_that_hit_it() {
    for (turned, known) in [
        (0, true),
        (30, false),
        (100, false),
        (200, false),
        (600, true),
    ] {
        let mut bench = LineBench::ready(Variant::Grbl);
        for k in 1..=300 {
            assert!(bench.send_sample(0, -k * 2));
        }
        for k in 1..=turned {
            assert!(bench.send_sample(0, -600 + k * 2));
        }
        bench.twin.pins.limit_z = true;
        bench.run_ms(500);
        assert_eq!(bench.link.state(), LinkState::Tripped);
        bench.link.reset();
        bench.run_ms(500);
        let [_, z] = bench.twin.pulses();
        bench.at = (0, z);
        bench.set_position();
        bench.run_ms(200);
        let into = if turned == 600 { 1 } else { -1 };
        let mut gone = [0; 2];
        for (gone, way) in gone.iter_mut().zip([into, -into]) {
            let (mut link, run) = (bench.link.clone(), bench.run);
            for k in 1..=400 {
                let end = run + Duration::from_millis(k as u64);
                let pulses = PerAxis::new(Pulses(0), Pulses(z + way * k));
                if link.push(Sample::new(end, pulses)).is_err() {
                    break;
                }
                *gone = k;
            }
        }
        let wanted = if known { [0, 400] } else { [200, 200] };
        assert_eq!(gone, wanted, "turned {turned} ms before");
    }
}

#[test]
fn a_limit_switch_stops_the_board_and_names_its_axis() {
    for variant in ALL {
        for (x, number) in [(true, 621), (false, 622)] {
            let mut bench = LineBench::ready(variant);
            for k in 1..=300 {
                let way = -k * 4;
                assert!(bench.send_sample(if x { way } else { 0 }, if x { 0 } else { way }));
            }
            bench.twin.pins.limit_x = x;
            bench.twin.pins.limit_z = !x;
            bench.run_ms(500);
            assert_eq!(bench.link.state(), LinkState::Tripped);
            assert_eq!(bench.alarms(), [number], "{:?}", bench.events);
            let stood = bench.twin.pulses();
            bench.twin.pins.limit_x = false;
            bench.twin.pins.limit_z = false;
            bench.run_ms(3000);
            assert_eq!(bench.twin.pulses(), stood, "nothing restarts by itself");
            bench.link.reset();
            bench.run_ms(500);
            assert_eq!(
                bench.link.state(),
                LinkState::Locked,
                "the position has to be found again"
            );
        }
    }
}

#[test]
fn a_board_that_restarts_is_noticed_in_every_state() {
    for variant in ALL {
        for moving in [false, true] {
            let mut bench = LineBench::ready(variant);
            if moving {
                for k in 1..=300 {
                    assert!(bench.send_sample(0, -k * 4));
                }
            }
            bench.twin.press_reset();
            bench.run_ms(4000);
            assert!(
                !bench.link.state().takes_motion(),
                "{moving} {:?}",
                bench.link.state()
            );
            let known = [605, 606, 607];
            assert!(
                bench.alarms().iter().any(|number| known.contains(number)),
                "{:?}",
                bench.events
            );
        }
    }
}

/// The program may be cut off anywhere, even in the middle of a line. The port guard then
/// sends its stop bytes a few times: the board stops with its spindle off.
#[test]
fn the_stop_bytes_work_after_any_broken_line() {
    for variant in ALL {
        let begun = LineBench::ready(variant);
        for cut in 0..40 {
            let mut bench = begun.clone();
            assert_eq!(bench.link.stop_bytes(), [0x18]);
            bench.twin.write(b"M3S500\n");
            // Complete pieces of motion, and an incomplete one.
            let lines = "G53G1X10F600\nG53G1X20F600\nG53G1X30F600\n";
            bench.twin.write(&lines.as_bytes()[..cut]);
            bench.twin.advance(cut as u64 * 3 * MS_IN_NS);
            for ms in [0, 30, 70, 150, 350] {
                bench.twin.advance(ms * MS_IN_NS);
                bench.twin.write(&bench.link.stop_bytes());
            }
            bench.twin.advance(1000 * MS_IN_NS);
            let stood = bench.twin.pulses();
            bench.twin.advance(1000 * MS_IN_NS);
            assert_eq!(bench.twin.pulses(), stood, "{variant:?} {cut}: it moves on");
            let (spindle, ..) = bench.twin.outputs();
            assert_eq!(spindle, 5, "{variant:?} {cut}: the spindle goes on");
        }
    }
}

/// This also holds for motion that does not fit into the board yet.
#[test]
fn a_computer_that_paused_is_612_with_any_queue() {
    for variant in ALL {
        for away in [160, 400, 2000] {
            let mut bench = LineBench::ready(variant);
            for k in 1..=600 {
                assert!(bench.send_sample(0, 2 * k));
            }
            // The host answers nothing more, and lines wait here.
            while bench.link.free_lookahead() > Duration::ZERO {
                let (x, z) = bench.at;
                assert!(bench.send_sample(x, z + 2));
            }
            bench.twin.advance(away * MS_IN_NS);
            bench.run_ms(3000);
            let alarms = bench.alarms();
            assert!(
                matches!(*alarms, [] | [612]),
                "{variant:?} {away} {alarms:?}"
            );
            let state = bench.link.state();
            assert!(
                matches!(state, LinkState::Ready | LinkState::Moving),
                "{state:?}"
            );
            if state == LinkState::Ready {
                let detail_text = bench.events.iter().rev().find_map(|event| match event {
                    LinkEvent::Position(at) => Some([at.x.0, at.z.0]),
                    _ => None,
                });
                assert_eq!(detail_text, Some(bench.twin.pulses()), "{variant:?} {away}");
            }
        }
    }
}

/// After a limit switch Grbl accepts nothing but a reset, and the port still holds the banner
/// for an earlier host.
#[test]
fn a_board_on_its_limit_switch_is_identified_despite_an_old_banner() {
    let mut bench = LineBench::ready(Variant::Grbl);
    for k in 1..=300 {
        assert!(bench.send_sample(0, 2 * k));
    }
    // The host is gone.
    bench.twin.pins.limit_z = true;
    bench.twin.advance(3000 * MS_IN_NS);
    bench.twin.pins.limit_z = false;
    let _ = bench.twin.read();
    let now = Duration::from_nanos(bench.twin.now());
    let mut parameters = ControlParameters::default();
    for number in [17, 18] {
        parameters.set(number, 5).unwrap();
    }
    bench.link = LineLink::open(
        LinkConfig::default(),
        &drives_from_parameters(&parameters),
        now,
    );
    bench.events.clear();
    bench.link.rx(b"\r\nGrbl 1.1h ['$' for help]\r\n", now);
    assert!(
        bench.run_until(6000, |bench| bench.link.state() == LinkState::Locked),
        "{:?}",
        bench.events
    );
    assert_eq!(bench.alarms(), [0_u16; 0]);
}
