//! Damage on the wire, cables and other hosts: a job ends on the pulse or with an alarm, and
//! the motion until then is bounded.

use core::time::Duration;

use gsk_link::{Backend, LinkState};
use gsk_twins::grbl::Variant;
use gsk_twins::wire::Damage;

use super::{ALL, LineBench, MS_IN_NS};

#[test]
fn an_unplugged_cable_is_an_alarm_within_a_second() {
    for variant in ALL {
        let mut bench = LineBench::ready(variant);
        for k in 1..=300 {
            assert!(bench.send_sample(0, -k * 4));
        }
        bench.twin.to_host.set_cut(true);
        bench.twin.to_board.set_cut(true);
        bench.run_ms(1000);
        assert_eq!(
            (bench.link.state(), bench.alarms()),
            (LinkState::Lost, vec![605])
        );
        // The board executes what it holds, then it stops.
        let stood = bench.twin.pulses();
        bench.run_ms(2000);
        assert_eq!(bench.twin.pulses(), stood);
    }
}

/// A decimal point lost on the wire makes a valid line with another meaning, because the wire
/// has no checksum. The link stops the board as soon as it reports a position off the path.
#[test]
fn a_board_off_the_path_is_stopped() {
    for variant in ALL {
        let mut alarms = Vec::new();
        for byte in 0..16 {
            let mut bench = LineBench::ready(variant);
            for k in 1..=300 {
                assert!(bench.send_sample(k, -k * 4));
            }
            // Somewhere in the next lines: a digit changes to another one; the board refuses a
            // letter.
            let from = bench.twin.to_board.sent_count();
            bench
                .twin
                .to_board
                .damage(from + byte, Damage::Changed(b'2' ^ b'6'));
            for k in 301..=600 {
                if !bench.send_sample(k, -k * 4) {
                    break;
                }
            }
            bench.run_ms(2000);
            if bench.alarms().is_empty() {
                // Within the tolerance of a report.
                continue;
            }
            assert_eq!(bench.link.state(), LinkState::Fault, "{:?}", bench.events);
            let stood = bench.twin.pulses();
            bench.run_ms(2000);
            assert_eq!(bench.twin.pulses(), stood);
            alarms.extend(bench.alarms());
        }
        assert!(alarms.iter().all(|alarm| matches!(alarm, 608 | 611)));
        assert!(alarms.contains(&611), "{alarms:?}");
    }
}

/// Makes a fault at every byte of a short job, in each direction. The job ends on the pulse
/// with the count compared, or it stops with an alarm. There is no third result.
#[test]
fn a_fault_at_any_byte_ends_known_or_declared_unknown() {
    for variant in ALL {
        // EVERY_BYTE=1 omits none, and tries every fault on each.
        let every = std::env::var_os("EVERY_BYTE").is_some();
        let step = if every { 1 } else { 7 };
        let damages = [
            Damage::Lost,
            Damage::Changed(0x15),
            Damage::Doubled,
            Damage::Delayed(100 * MS_IN_NS),
            Damage::Cut,
        ];
        let ready = LineBench::ready(variant);
        let clean = {
            let mut bench = ready.clone();
            assert!(bench.run_job() && bench.is_ready_at_end());
            (
                bench.twin.to_board.sent_count(),
                bench.twin.to_host.sent_count(),
            )
        };
        let (mut proved, mut stopped) = (0, 0);
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
                    let whole = bench.run_job();
                    bench.run_ms(4000);
                    let place = format!("{damage:?} at {byte}, to the board: {to_board}");
                    match bench.link.state() {
                        LinkState::Ready if whole && bench.alarms().is_empty() => {
                            assert_eq!(bench.twin.pulses(), [0, -100], "{place}");
                            proved += 1;
                        }
                        LinkState::Locked
                        | LinkState::Fault
                        | LinkState::Lost
                        | LinkState::Tripped => {
                            assert!(!bench.alarms().is_empty(), "{place}");
                            stopped += 1;
                        }
                        state => panic!("{place}: {state:?} {:?}", bench.events),
                    }
                    let stood = bench.twin.pulses();
                    bench.run_ms(1000);
                    assert_eq!(bench.twin.pulses(), stood, "{place}: it moves on");
                }
            }
        }
        assert!(proved > 0 && stopped > 0, "{proved} {stopped}");
    }
}

/// An operator opened the door of the board, or another host changed its state: the link stops
/// it and raises the alarm.
#[test]
fn an_unexpected_state_is_607() {
    for state in ["Door:0", "Tool", "Sleep", "Check", "Jog"] {
        let mut bench = LineBench::ready(Variant::GrblHal);
        for k in 1..=300 {
            assert!(bench.send_sample(0, -k * 4));
        }
        let report = format!("<{state}|MPos:0.000,0.000,-4.000|Bf:90,1000|FS:0,0>\r\n");
        let now = bench.twin.now();
        bench.twin.to_host.send(report.as_bytes(), now);
        bench.run_ms(2000);
        assert_eq!(bench.alarms(), [607], "{state}: {:?}", bench.events);
        assert_eq!(bench.link.state(), LinkState::Fault, "{state}");
        let stood = bench.twin.pulses();
        bench.run_ms(1000);
        assert_eq!(bench.twin.pulses(), stood, "{state}");
    }
}

/// The line protocol has no checksum: `X1.005` may arrive as `X9.005` or `X1005`. The motion
/// until the next report is bounded: at a feed of 1200 mm/min it is less than 1 mm, and 5 mm
/// with FluidNC, whose pulse timer makes 120 ms more.
#[test]
fn a_damaged_number_is_stopped_within_millimetres() {
    for variant in ALL {
        let every = std::env::var_os("EVERY_BYTE").is_some();
        let mut stopped = 0;
        let mut in_motion = LineBench::ready(variant);
        for k in 1..=300 {
            assert!(in_motion.send_sample(k, -4 * k));
        }
        for byte in (0..160).step_by(if every { 1 } else { 7 }) {
            let bits = (0..8).map(|bit| Damage::Changed(1 << bit));
            for damage in bits.chain([Damage::Lost]) {
                let place = format!("{damage:?} at {byte}");
                let mut bench = in_motion.clone();
                let from = bench.twin.to_board.sent_count();
                bench.twin.to_board.damage(from + byte, damage);
                let (mut k, mut farthest) = (300, 0);
                for _ in 0..1500 {
                    let room = bench.link.free_lookahead() >= Duration::from_millis(10);
                    if k < 600 && room && bench.link.state().takes_motion() {
                        k += 1;
                        bench.send_sample(k, -4 * k);
                    } else {
                        bench.run_one_ms();
                    }
                    let [x, z] = bench.twin.pulses();
                    // The nearest sample is between the nearest in X and the nearest in Z.
                    let [in_x, in_z] = [x, -z / 4].map(|k| k.clamp(0, 600));
                    let nearest = in_x.min(in_z - 1).max(0)..=in_x.max(in_z + 1).min(600);
                    let off = nearest.map(|k| (x - k).abs().max((z + 4 * k).abs()));
                    farthest = farthest.max(off.min().unwrap());
                }
                let most = match variant {
                    Variant::Grbl | Variant::GrblHal => 200,
                    Variant::FluidNc => 1000,
                };
                assert!(farthest <= most, "{variant:?} {place}: {farthest} pulses");
                stopped += i32::from(!bench.alarms().is_empty());
            }
        }
        assert!(stopped > 0);
    }
}
