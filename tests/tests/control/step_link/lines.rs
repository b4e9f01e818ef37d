//! Real lines and clocks: slow, lossy, drifting; and motion that needs many messages.

use core::f64::consts::TAU;
use core::time::Duration;

use gsk_link::{Backend, LinkState};
use gsk_twins::klipper::{KlipperHardware, KlipperTwin};
use gsk_twins::wire::{Damage, TwinWire};

use super::bench::{MS_IN_NS, StepBench};

/// A disturbance of the future traffic.
type StepLineDisturbance = fn(&mut KlipperTwin);

fn repeat_damage(wire: &mut TwinWire, every: u64, damage: Damage) {
    let from = wire.sent_count();
    for count in 1..400 {
        wire.damage(from + count * every, damage);
    }
}

const LINES: [(&str, i32, StepLineDisturbance); 13] = [
    ("whole", 0, |_| {}),
    ("the board's clock is fast", 100, |_| {}),
    ("the board's clock is slow", -100, |_| {}),
    ("bytes are lost", 100, |twin| {
        repeat_damage(&mut twin.to_board, 601, Damage::Lost);
        repeat_damage(&mut twin.to_host, 907, Damage::Lost);
    }),
    ("bytes are changed", -100, |twin| {
        repeat_damage(&mut twin.to_board, 701, Damage::Changed(0x40));
        repeat_damage(&mut twin.to_host, 503, Damage::Changed(0x01));
    }),
    ("bytes come twice", 0, |twin| {
        repeat_damage(&mut twin.to_board, 607, Damage::Doubled);
        repeat_damage(&mut twin.to_host, 809, Damage::Doubled);
    }),
    ("it waits, to the board", 0, |twin| {
        repeat_damage(&mut twin.to_board, 1500, Damage::Stalled(100 * MS_IN_NS));
    }),
    ("it waits, to the host", 0, |twin| {
        repeat_damage(&mut twin.to_host, 1500, Damage::Stalled(100 * MS_IN_NS));
    }),
    ("it waits both ways", 100, |twin| {
        repeat_damage(&mut twin.to_board, 2000, Damage::Stalled(60 * MS_IN_NS));
        repeat_damage(&mut twin.to_host, 1700, Damage::Stalled(40 * MS_IN_NS));
    }),
    ("it becomes slow, to the board", 0, |twin| {
        let byte = twin.to_board.sent_count() + 700;
        twin.to_board.damage(byte, Damage::Delayed(50 * MS_IN_NS));
    }),
    ("it becomes very slow, to the board", 0, |twin| {
        let byte = twin.to_board.sent_count() + 700;
        twin.to_board.damage(byte, Damage::Delayed(100 * MS_IN_NS));
    }),
    ("it becomes very slow, to the host", 0, |twin| {
        let byte = twin.to_host.sent_count() + 700;
        twin.to_host.damage(byte, Damage::Delayed(100 * MS_IN_NS));
    }),
    ("it becomes slow both ways", -100, |twin| {
        let byte = twin.to_board.sent_count() + 700;
        twin.to_board.damage(byte, Damage::Delayed(50 * MS_IN_NS));
        let byte = twin.to_host.sent_count() + 900;
        twin.to_host.damage(byte, Damage::Delayed(50 * MS_IN_NS));
    }),
];

/// No pulse is lost, none comes late, and the operator sees nothing of it.
#[test]
fn disturbed_lines_are_survived() {
    for (name, ppm, trouble) in LINES {
        let mut bench = StepBench::new(KlipperHardware {
            clock_error_ppm: ppm,
            ..KlipperHardware::default()
        });
        assert!(bench.reaches_state(LinkState::Locked, 3000), "{name}");
        bench.set_position();
        bench.run_ms(1000);
        trouble(&mut bench.twin);
        let (began, run) = (bench.twin.now(), bench.run);
        for count in 1..=3 {
            assert!(bench.run_job(), "{name}, {count}: {:?}", bench.events);
            assert!(
                bench.reaches_state(LinkState::Ready, 1000),
                "{name}, {count}: {:?}",
                bench.events
            );
            assert_eq!(bench.made_pulses(), (0, -100 * count), "{name}");
        }
        assert_eq!(bench.alarms(), [0_u16; 0], "{name}");
        let figures = bench.twin.statistics();
        assert!(
            figures.min_lead_ns > 0,
            "{name}: a step came late, {figures:?}"
        );
        assert!(
            figures.max_commands_per_s <= 800 && figures.max_queue_entries <= 625,
            "{name}"
        );
        // The kernel's time is kept.
        let took = Duration::from_nanos(bench.twin.now() - began);
        let more = took.as_secs_f64() / (bench.run - run).as_secs_f64();
        println!(
            "{name}: {more:.3} of the time, lead {} ms",
            figures.min_lead_ns / 1_000_000
        );
        assert!(more < 1.8, "{name}: {more}");
    }
}

/// A circle with a radius in pulses and a period in ms, with a slow start.
fn circle_path(radius: f64, around: f64) -> impl Fn(f64) -> (f64, f64) {
    move |tick| {
        let turned = if tick < 200.0 {
            tick * tick / 400.0
        } else {
            tick - 100.0
        };
        let (sin, cos) = libm::sincos(turned / around * TAU);
        (radius * (1.0 - cos), radius / 2.0 * sin)
    }
}

/// Oscillates both axes.
fn oscillation_path(amplitude: f64, every: f64) -> impl Fn(f64) -> (f64, f64) {
    move |tick| {
        let (sin, cos) = libm::sincos(tick / every * TAU);
        (amplitude * sin, amplitude * (cos - 1.0))
    }
}

/// The board never receives more than 700 messages in a second. Motion with more reversals is
/// slowed down, and with far more it is refused. No step is late.
#[test]
fn the_board_gets_no_more_messages_than_it_can_process() {
    let (whole, slower, refused) = ((true, false), (true, true), (false, false));
    let circles = [
        // R5 at 1200 mm/min, 400 and 200 pulses/mm; R0.3 and R0.1.
        (2000.0, 1570.0, whole),
        (120.0, 94.0, slower),
        (40.0, 31.4, refused),
        (4000.0, 1000.0, whole),
        (1000.0, 200.0, slower),
    ];
    for (radius, around, wanted) in circles {
        check_message_rate(circle_path(radius, around), wanted, &format!("R {radius}"));
    }
    for (amplitude, every, wanted) in [
        (1.0, 100.0, whole),
        (2.0, 50.0, whole),
        (2.0, 12.0, slower),
        (2.0, 8.0, refused),
        (50.0, 20.0, refused),
    ] {
        let name = format!("{amplitude} pulses in {every} ms");
        check_message_rate(oscillation_path(amplitude, every), wanted, &name);
    }
}

fn check_message_rate(path: impl Fn(f64) -> (f64, f64), (ends, slower): (bool, bool), name: &str) {
    let mut bench = StepBench::ready();
    let from = bench.twin.now();
    let whole = bench.follow_path(4000, path);
    let took = (bench.twin.now() - from) / MS_IN_NS;
    let figures = bench.twin.statistics();
    println!(
        "{name}: {whole}, 4000 ms in {took}, {} messages/s",
        figures.max_commands_per_s
    );
    assert_eq!(whole, ends, "{name}: {:?}", bench.events);
    if ends {
        assert_eq!(took > 4200, slower, "{name}: {took}");
        bench.link.finish().unwrap();
        assert!(
            bench.reaches_state(LinkState::Ready, 1000),
            "{name}: {:?}",
            bench.events
        );
        assert_eq!(bench.made_pulses(), bench.counted_pulses(), "{name}");
    } else {
        bench.run_ms(1000);
        assert_eq!(bench.alarms(), [604], "{name}");
        assert_eq!(bench.link.state(), LinkState::Fault, "{name}");
    }
    let figures = bench.twin.statistics();
    assert!(figures.max_commands_per_s <= 700, "{name}: {figures:?}");
    assert!(figures.min_lead_ns > 15_000_000, "{name}: {figures:?}");
    bench.assert_stands_still(500);
}
