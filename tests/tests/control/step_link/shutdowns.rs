//! Boards that shut down, that are found shut down, or that are configured for another host.

use gsk_link::{Backend, LinkEvent, LinkState};
use gsk_twins::klipper::{KlipperHardware, KlipperState};

use super::bench::StepBench;

/// The message of the firmware, the alarm, and a word of the advice to the operator.
const SHUTDOWN_TEXTS: [(&str, u16, &str); 12] = [
    ("Timer too close", 612, "reduce the load"),
    ("Stepper too far in past", 612, "reduce the load"),
    ("Rescheduled timer in the past", 612, "reduce the load"),
    ("Move queue overflow", 608, "cable and earth"),
    ("Invalid count parameter", 608, "cable and earth"),
    (
        "Can't reset time when stepper active",
        608,
        "cable and earth",
    ),
    ("Command parser error", 608, "cable and earth"),
    ("Invalid command", 608, "cable and earth"),
    (
        "Missed scheduling of next digital out event",
        605,
        "no data from the computer",
    ),
    (
        "Missed scheduling of next hard pwm event",
        605,
        "no data from the computer",
    ),
    (
        "Scheduled digital out event will exceed max_duration",
        607,
        "has a fault",
    ),
    (
        "Scheduled pwm event will exceed max_duration",
        607,
        "has a fault",
    ),
];

/// A board that resets itself, and one that only forgets its configuration.
fn board_kinds() -> [KlipperHardware; 2] {
    [true, false].map(|resets| KlipperHardware {
        has_reset_command: resets,
        ..KlipperHardware::default()
    })
}

#[test]
fn every_reason_has_its_alarm_and_its_way_out() {
    for make in board_kinds() {
        let ready = StepBench::ready_with(make);
        for (text, number, help) in SHUTDOWN_TEXTS {
            let mut bench = ready.clone();
            assert!(bench.feed_z(-3.0, 300));
            bench.twin.force_shutdown(text);
            bench.run_ms(100);
            let place = format!("{text}, {make:?}: {:?}", bench.events);
            assert_eq!(bench.link.state(), LinkState::Fault, "{place}");
            assert_eq!(bench.alarms(), [number], "{place}");
            let is_expected_alarm = |event: &LinkEvent| match event {
                LinkEvent::Alarm { detail, .. } => {
                    let detail_text = detail.to_string();
                    [text, help, "reference return"]
                        .into_iter()
                        .all(|part| detail_text.contains(part))
                }
                _ => false,
            };
            assert!(bench.events.iter().any(is_expected_alarm), "{place}");
            assert_eq!(bench.link.position(), None, "{place}");
            bench.assert_stands_still(300);
            // The advice helps.
            bench.link.reset();
            assert!(bench.reaches_state(LinkState::Locked, 3000), "{place}");
            assert_eq!(bench.twin.state(), KlipperState::Running, "{place}");
            assert_eq!(bench.link.position(), None, "{place}");
            bench.assert_stands_still(300);
            bench.at = (0.0, 0.0);
            bench.events.clear();
            bench.set_position();
            let before = bench.made_pulses();
            assert!(
                bench.run_job() && bench.reaches_state(LinkState::Ready, 1000),
                "{place}"
            );
            assert_eq!(bench.made_pulses(), (before.0, before.1 - 100), "{place}");
        }
    }
}

#[test]
fn a_board_found_shut_down_is_set_up_again() {
    for make in board_kinds() {
        let ready = StepBench::ready_with(make);
        for (text, ..) in SHUTDOWN_TEXTS
            .into_iter()
            .chain([("Command request", 0, "")])
        {
            let mut bench = ready.clone();
            bench.twin.force_shutdown(text);
            bench.run_ms(50);
            bench.open_again();
            let place = format!("{text}, {make:?}");
            assert!(
                bench.reaches_state(LinkState::Locked, 5000),
                "{place}: {:?}",
                bench.events
            );
            assert_eq!(bench.alarms(), [0_u16; 0], "{place}");
            assert_eq!(bench.twin.state(), KlipperState::Running, "{place}");
            assert_eq!(bench.link.position(), None, "{place}");
        }
    }
}

/// With another configuration, running or shut down, and with either way of forgetting it.
#[test]
fn a_board_set_up_for_another_host_is_set_up_again() {
    for make in board_kinds() {
        for shut_down in [false, true] {
            let mut bench = StepBench::new(make);
            bench.twin.configure_for_another_host();
            if shut_down {
                bench.twin.force_shutdown("Command request");
            }
            let place = format!("{make:?}, shut down: {shut_down}");
            assert!(
                bench.reaches_state(LinkState::Locked, 5000),
                "{place}: {:?}",
                bench.events
            );
            assert_eq!(bench.alarms(), [0_u16; 0], "{place}");
            bench.set_position();
            assert!(
                bench.run_job() && bench.reaches_state(LinkState::Ready, 1000),
                "{place}"
            );
            assert_eq!(bench.made_pulses(), (0, -100), "{place}");
        }
    }
}

/// Reconfigured without this link: it is not the board that was checked.
#[test]
fn a_configuration_that_changes_under_way_is_606() {
    let mut bench = StepBench::ready();
    bench.twin.configure_for_another_host();
    bench.run_ms(1500);
    assert_eq!(
        (bench.link.state(), bench.alarms()),
        (LinkState::Fault, vec![606])
    );
    assert_eq!(bench.link.position(), None);
}

#[test]
fn the_dictionary_of_a_known_board_is_not_read_again() {
    let mut bench = StepBench::new(KlipperHardware::default());
    assert!(bench.reaches_state(LinkState::Locked, 5000));
    assert_eq!(bench.twin.statistics().identify_count, 91);
    let learned = bench.read_dictionaries();
    assert_eq!(learned.len(), 1);
    assert_eq!(learned[0].0, "atmega2560 v0.13.0-730");
    assert_eq!(learned[0].1.len(), 3574);
    let other = {
        let mut bench = StepBench::new(board_kinds()[1]);
        assert!(bench.reaches_state(LinkState::Locked, 5000));
        bench.read_dictionaries()[0].1.clone()
    };
    assert_ne!(other, learned[0].1);
    let mut damaged = learned[0].1.clone();
    damaged[2000] ^= 1;
    let right = learned[0].1.clone();
    for (known, fewest, most) in [
        (vec![right.clone()], 2, 2),
        (vec![other.clone(), right], 2, 3),
        // Another firmware, and a damaged file: the dictionary is read again.
        (vec![other], 91, 92),
        (vec![damaged], 91, 91),
    ] {
        let mut again = bench.clone();
        let before = again.twin.statistics().identify_count;
        again.open_again();
        let count = known.len();
        again.link.add_dictionaries(known);
        assert!(
            again.reaches_state(LinkState::Locked, 5000),
            "{:?}",
            again.events
        );
        let identify_count = again.twin.statistics().identify_count - before;
        assert!(
            (fewest..=most).contains(&identify_count),
            "{count} known: {identify_count}"
        );
        assert_eq!(again.link.board().firmware, "atmega2560 v0.13.0-730");
        assert_eq!(again.read_dictionaries().len(), usize::from(most > 3));
    }
    // And not by the same link, after RESET.
    let mut bench = StepBench::ready();
    let before = bench.twin.statistics().identify_count;
    bench.twin.force_shutdown("Invalid command");
    bench.run_ms(100);
    bench.link.reset();
    assert!(bench.reaches_state(LinkState::Locked, 3000));
    assert_eq!(bench.twin.statistics().identify_count - before, 2);
}
