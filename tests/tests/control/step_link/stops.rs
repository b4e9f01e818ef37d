//! What stops the axes, and where they stand then.

use gsk_core::units::{Axis, PerAxis, Pulses};
use gsk_link::{
    AwaitedInput, Backend, Input, InputCondition, LinkEvent, LinkState, MotionRefused, Stop,
};
use gsk_twins::klipper::KlipperState;

use super::bench::Bench;

#[test]
fn a_flush_keeps_the_count_and_when_it_was_slow_the_position() {
    for (speed, slow) in [(-0.9, true), (-4.0, false)] {
        for at in (1..400).step_by(39) {
            let mut bench = Bench::ready();
            assert!(bench.feed(speed, at));
            bench.link.stop(Stop::Flush);
            let wanted = if slow {
                LinkState::Ready
            } else {
                LinkState::Locked
            };
            // Before the first step nothing moved, and nothing is lost.
            let wanted = if at < 131 { LinkState::Ready } else { wanted };
            assert!(bench.gets(wanted, 500), "{at}: {:?}", bench.events);
            let (x, z) = bench.made();
            let stood = PerAxis::new(Pulses(x), Pulses(z));
            assert!(
                bench.events.contains(&LinkEvent::Position(stood)),
                "{at}: {:?}",
                bench.events
            );
            bench.stands(300);
            assert_eq!(bench.link.position().is_some(), wanted == LinkState::Ready);
            // And it goes on from there.
            bench.at = (x as f64, z as f64);
            if wanted == LinkState::Locked {
                bench.set_position();
            }
            assert!(
                bench.job() && bench.gets(LinkState::Ready, 500),
                "{:?}",
                bench.events
            );
            assert_eq!(bench.made(), (x, z - 100));
        }
    }
}

#[test]
fn a_kill_loses_the_position_and_reset_sets_the_board_up_again() {
    let mut bench = Bench::ready();
    assert!(bench.feed(-4.0, 300));
    bench.link.stop(Stop::Kill);
    bench.write();
    bench.pass(20);
    assert_eq!(
        bench.twin.state(),
        KlipperState::Shutdown("Command request")
    );
    assert_eq!(bench.twin.output("PL0"), Some(0));
    assert_eq!(
        (bench.link.state(), bench.alarms()),
        (LinkState::Fault, vec![])
    );
    bench.stands(2000);
    assert_eq!(bench.link.position(), None);
    bench.link.reset();
    assert!(bench.gets(LinkState::Locked, 3000), "{:?}", bench.events);
    assert!(!bench.sample(0.0, 0.0));
}

#[test]
fn a_limit_switch_stops_both_axes_in_the_board() {
    for delay in 0..12 {
        let mut bench = Bench::ready();
        assert!(bench.feed(-0.9, 200));
        bench.twin.advance(delay * 90_000);
        bench.twin.set_pin("PC1", true);
        let edge = bench.twin.now();
        for _ in 0..40 {
            let _ = bench.give(bench.at.0, bench.at.1 - 0.9);
            bench.ms();
        }
        let ns = bench.twin.last_pulse_ns().saturating_sub(edge);
        assert!(ns <= 1_500_000, "{ns}");
        assert!(bench.gets(LinkState::Tripped, 200), "{:?}", bench.events);
        assert_eq!(bench.alarms(), [622]);
        let (x, z) = bench.made();
        let stood = LinkEvent::Position(PerAxis::new(Pulses(x), Pulses(z)));
        assert!(bench.events.contains(&stood), "{:?}", bench.events);
        bench.stands(1000);
        // The position was kept: jogging away is allowed, farther is not.
        assert!(bench.link.knows_position());
        bench.link.reset();
        assert_eq!(bench.link.state(), LinkState::Locked);
        bench.at = (x as f64, z as f64);
        bench.set_position();
        assert_eq!(
            bench.give(bench.at.0, bench.at.1 - 2.0),
            Err(MotionRefused::TowardLimit(Axis::Z))
        );
        bench.pass(200);
        assert!(bench.feed(0.5, 200));
        bench.twin.set_pin("PC1", false);
        bench.link.finish().unwrap();
        assert!(bench.gets(LinkState::Ready, 500), "{:?}", bench.events);
        bench.pass(500);
        // Free again, it counts again.
        assert!(bench.feed(-0.9, 50));
        bench.pass(120);
        bench.events.clear();
        bench.twin.set_pin("PC1", true);
        bench.pass(100);
        assert!(bench.alarms().contains(&622), "{:?}", bench.events);
    }
}

#[test]
fn the_emergency_stop_trips_the_board_and_holds_until_it_is_released() {
    let mut bench = Bench::ready();
    assert!(bench.feed(-4.0, 300));
    bench.twin.set_pin("PC2", false);
    assert!(bench.gets(LinkState::Tripped, 100), "{:?}", bench.events);
    assert_eq!(bench.alarms(), [207]);
    bench.stands(300);
    assert_eq!(bench.twin.output("PL0"), Some(0));
    bench.link.reset();
    bench.pass(100);
    assert_eq!(bench.link.state(), LinkState::Tripped);
    bench.twin.set_pin("PC2", true);
    bench.pass(100);
    bench.link.reset();
    bench.pass(10);
    assert_eq!(bench.link.state(), LinkState::Locked, "it was fast");
    bench.stands(1000);
}

#[test]
fn inputs_end_a_move_where_the_board_saw_them() {
    let mut bench = Bench::ready();
    let awaited = |input, until| AwaitedInput {
        input,
        until,
        rate: 1000.0,
    };
    assert_eq!(
        bench
            .link
            .arm(awaited(Input::ZeroZ, InputCondition::Operated)),
        Err(MotionRefused::NotWired)
    );
    bench
        .link
        .arm(awaited(Input::DecelerationZ, InputCondition::Operated))
        .unwrap();
    assert!(!bench.link.is_armed(Axis::Z));
    assert!(bench.wait(300, |bench| bench.link.is_armed(Axis::Z)));
    for k in 0..300 {
        if !bench.feed(-0.9, 1) {
            break;
        }
        if k == 200 {
            bench.twin.set_pin("PC6", true);
        }
    }
    assert!(bench.gets(LinkState::Ready, 300), "{:?}", bench.events);
    let (x, z) = bench.made();
    let there = PerAxis::new(Pulses(x), Pulses(z));
    assert!(
        bench
            .events
            .contains(&LinkEvent::Reached(Input::DecelerationZ, there)),
        "{:?}",
        bench.events
    );
    assert_eq!(
        (bench.alarms(), bench.link.position()),
        (vec![], Some(there))
    );
    // Off the switch again: the same the other way round.
    bench.at = (x as f64, z as f64);
    bench.events.clear();
    bench
        .link
        .arm(awaited(Input::DecelerationZ, InputCondition::Free))
        .unwrap();
    assert!(bench.wait(300, |bench| bench.link.is_armed(Axis::Z)));
    assert!(bench.feed(0.5, 150));
    bench.twin.set_pin("PC6", false);
    bench.pass(100);
    let (x, z) = bench.made();
    let there = PerAxis::new(Pulses(x), Pulses(z));
    assert!(
        bench
            .events
            .contains(&LinkEvent::Reached(Input::DecelerationZ, there)),
        "{:?}",
        bench.events
    );
    // The standard group is in force again.
    bench.at = (x as f64, z as f64);
    bench.pass(300);
    assert!(bench.feed(0.5, 150));
    bench.twin.set_pin("PC1", true);
    bench.pass(100);
    assert_eq!(bench.alarms(), [622]);
}

/// Whatever was written last, and wherever it was broken off: the bytes for whoever holds
/// the port when the program is gone stop the board.
#[test]
fn the_bytes_that_stop_the_board_do_so_behind_any_broken_block() {
    let mut begun = Bench::ready();
    assert!(begun.feed(-4.0, 300));
    for cut in 0..40 {
        // Each time another number is awaited.
        assert!(begun.feed(-4.0, 1));
        let mut bench = begun.clone();
        let mut broken = [0; 40];
        (broken[0], broken[1]) = (40, 0x13);
        bench.twin.write(&broken[..cut]);
        bench.twin.write(&bench.link.stop_bytes());
        bench.twin.advance(20_000_000);
        let state = bench.twin.state();
        assert_eq!(state, KlipperState::Shutdown("Command request"), "{cut}");
        assert_eq!(bench.twin.output("PL0"), Some(0));
    }
}

#[test]
fn a_board_that_is_not_known_or_shut_down_is_not_to_be_stopped() {
    let mut bench = Bench::new(gsk_twins::klipper::KlipperHardware::default());
    assert!(bench.link.stop_bytes().is_empty());
    assert!(bench.gets(LinkState::Locked, 5000));
    assert!(!bench.link.stop_bytes().is_empty());
    bench.link.stop(Stop::Kill);
    assert!(bench.link.stop_bytes().is_empty());
}
