//! Motion: counts, times, rates.

use core::time::Duration;

use gsk_link::{Backend, LinkEvent, LinkState, MotionRefused};
use gsk_twins::klipper::KlipperHardware;

use super::bench::{Bench, MS, config};

#[test]
fn a_job_ends_on_the_commanded_pulse() {
    for ppm in [-100, 0, 100] {
        let mut bench = Bench::new(KlipperHardware {
            clock_error_ppm: ppm,
            ..KlipperHardware::default()
        });
        assert!(bench.gets(LinkState::Locked, 3000));
        bench.set_position();
        for count in 1..=3 {
            assert!(bench.job(), "{:?}", bench.events);
            assert!(bench.gets(LinkState::Ready, 1000), "{:?}", bench.events);
            assert_eq!(bench.counted(), (0, -100 * count));
            assert_eq!(bench.made(), bench.counted());
        }
        assert_eq!(bench.alarms(), [0_u16; 0]);
        assert!(bench.events.contains(&LinkEvent::Drained));
        let figures = bench.twin.statistics();
        assert!(figures.max_queue_entries <= 657 - 32, "{figures:?}");
        assert!(figures.min_lead_ns > 15_000_000, "{figures:?}");
        // X 800 there and back; Z 2450 there, 2350 back.
        assert_eq!(figures.step_count, 3 * (1600 + 4800));
    }
}

#[test]
fn motion_keeps_the_time_of_the_kernel_and_the_lookahead() {
    let mut bench = Bench::ready();
    assert!(bench.feed(-0.5, 100));
    let (from, run) = (bench.twin.now(), bench.run);
    for _ in 0..2000 {
        assert!(bench.feed(-5.0, 1));
        assert!(bench.link.outstanding() <= Duration::from_millis(135));
    }
    let took = (bench.twin.now() - from) as f64 * 1e-9;
    assert!((took - 2.0).abs() < 0.01, "{took}");
    bench.link.finish().unwrap();
    // Shown is what has been executed, never more.
    let behind = bench.run - bench.link.executed();
    assert!(
        (Duration::from_millis(90)..Duration::from_millis(135)).contains(&behind),
        "{behind:?}"
    );
    assert!(run < bench.link.executed());
    assert!(bench.gets(LinkState::Ready, 500), "{:?}", bench.events);
    assert_eq!(bench.made(), bench.counted());
    assert_eq!(bench.link.executed(), bench.run);
}

#[test]
fn a_rate_the_board_cannot_make_is_refused() {
    let mut bench = Bench::ready();
    assert!(bench.feed(32.0, 50));
    assert_eq!(
        bench.give(0.0, bench.at.1 + 40.0),
        Err(MotionRefused::TooFast)
    );
    bench.link.finish().unwrap();
    assert!(bench.gets(LinkState::Ready, 500));
    assert_eq!(bench.made(), (0, 1600));
}

#[test]
fn a_dwell_takes_its_time_and_a_pause_at_rest_is_none() {
    let mut bench = Bench::ready();
    assert!(bench.feed(-1.0, 100));
    let from = bench.twin.now();
    assert!(bench.feed(0.0, 3000));
    let took = (bench.twin.now() - from) / MS;
    assert!((2990..=3010).contains(&took), "{took}");
    bench.twin.advance(150 * MS);
    assert!(
        bench.feed(-1.0, 100),
        "{:?} {:?}",
        bench.link.state(),
        bench.events
    );
    bench.link.finish().unwrap();
    bench.pass(800);
    assert_eq!(
        (bench.link.state(), bench.alarms()),
        (LinkState::Ready, vec![])
    );
    assert_eq!(bench.made(), (0, -200));
}

/// `!` before the pin of a direction counts as it does before every other: it turns the
/// axis over, and `invert_direction` turns it back.
#[test]
fn a_direction_is_turned_over_by_its_pin_or_by_its_axis() {
    for (sign, invert, way) in [
        ("", false, 1),
        ("!", false, -1),
        ("", true, -1),
        ("!", true, 1),
    ] {
        let mut config = config();
        config.z.dir = format!("{sign}PA3");
        config.z.invert_direction = invert;
        config.x.dir = format!("{sign}PA1");
        config.x.invert_direction = invert;
        let mut bench = Bench::wired(config, KlipperHardware::default());
        assert!(bench.gets(LinkState::Locked, 3000));
        bench.set_position();
        assert!(bench.follow(500, |ms| (0.4 * ms, -0.8 * ms)));
        bench.link.finish().unwrap();
        assert!(bench.gets(LinkState::Ready, 1000), "{:?}", bench.events);
        assert_eq!(bench.alarms(), [0_u16; 0]);
        assert_eq!(bench.made(), (way * 200, way * -400), "{sign:?} {invert}");
    }
}

/// Both axes at 25 000 pulses a second, 40 µs apart: the times the board is told lie no
/// farther from their own than a quarter of the way; those it makes are later by the steps of
/// the other axis, and no later.
#[test]
fn steps_of_two_fast_axes_keep_their_times() {
    const TOP: f64 = 25.0;
    const APART: f64 = 1e6 / 25_000.0;
    let mut bench = Bench::ready();
    let ramp = |k: u32| TOP * f64::from(k.min(500)) / 500.0;
    bench.twin.start_recording_steps();
    let mut steps = Vec::new();
    for k in 0..2000 {
        let (x, z) = bench.at;
        assert!(
            bench.sample(x + ramp(k), z + 0.97 * ramp(k)),
            "{:?}",
            bench.events
        );
        steps.extend(bench.twin.take_recorded_steps());
    }
    for (axis, apart) in [(0, APART), (1, APART / 0.97)] {
        let fast: Vec<_> = steps
            .iter()
            .filter(|step| step.stepper == axis)
            .skip(10_000)
            .collect();
        assert!(fast.len() > 10_000, "{}", fast.len());
        let told: Vec<f64> = fast
            .iter()
            .map(|step| step.due_ns as f64 / 1000.0)
            .collect();
        let made: Vec<f64> = fast.iter().map(|step| step.at_ns as f64 / 1000.0).collect();
        let begin = told[0];
        let off = |times: &[f64]| {
            let off = times
                .iter()
                .enumerate()
                .map(|(k, at)| at - begin - apart * k as f64);
            let (least, most) = off.fold((f64::MAX, f64::MIN), |(least, most), off| {
                (least.min(off), most.max(off))
            });
            most - least
        };
        // To either side.
        assert!(off(&told) <= 2.0 * apart / 4.0, "{}", off(&told));
        assert!(off(&made) <= 2.0 * apart / 4.0 + 11.0, "{}", off(&made));
    }
}
