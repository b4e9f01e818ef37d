//! Boards that give up, that are found shut down, or set up for somebody else.

use gsk_link::{Backend, LinkEvent, LinkState};
use gsk_twins::klipper::{KlipperHardware, KlipperState};

use super::bench::Bench;

/// What the firmware says, the alarm, and a word of what the operator is told to do.
const TEXTS: [(&str, u16, &str); 12] = [
    ("Timer too close", 612, "less load"),
    ("Stepper too far in past", 612, "less load"),
    ("Rescheduled timer in the past", 612, "less load"),
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
        "was silent",
    ),
    (
        "Missed scheduling of next hard pwm event",
        605,
        "was silent",
    ),
    (
        "Scheduled digital out event will exceed max_duration",
        607,
        "by itself",
    ),
    (
        "Scheduled pwm event will exceed max_duration",
        607,
        "by itself",
    ),
];

/// A board that resets itself, and one that only forgets.
fn makes() -> [KlipperHardware; 2] {
    [true, false].map(|resets| KlipperHardware {
        has_reset_command: resets,
        ..KlipperHardware::default()
    })
}

#[test]
fn every_reason_has_its_alarm_and_its_way_out() {
    for make in makes() {
        let ready = Bench::ready_with(make);
        for (text, number, help) in TEXTS {
            let mut bench = ready.clone();
            assert!(bench.feed(-3.0, 300));
            bench.twin.force_shutdown(text);
            bench.pass(100);
            let place = format!("{text}, {make:?}: {:?}", bench.events);
            assert_eq!(bench.link.state(), LinkState::Fault, "{place}");
            assert_eq!(bench.alarms(), [number], "{place}");
            let told = |event: &LinkEvent| match event {
                LinkEvent::Alarm { detail, .. } => {
                    let said = detail.to_string();
                    [text, help, "reference return"]
                        .into_iter()
                        .all(|part| said.contains(part))
                }
                _ => false,
            };
            assert!(bench.events.iter().any(told), "{place}");
            assert_eq!(bench.link.position(), None, "{place}");
            bench.stands(300);
            // What it is told to do helps.
            bench.link.reset();
            assert!(bench.gets(LinkState::Locked, 3000), "{place}");
            assert_eq!(bench.twin.state(), KlipperState::Running, "{place}");
            assert_eq!(bench.link.position(), None, "{place}");
            bench.stands(300);
            bench.at = (0.0, 0.0);
            bench.events.clear();
            bench.set_position();
            let before = bench.made();
            assert!(bench.job() && bench.gets(LinkState::Ready, 1000), "{place}");
            assert_eq!(bench.made(), (before.0, before.1 - 100), "{place}");
        }
    }
}

#[test]
fn a_board_found_shut_down_is_set_up_anew() {
    for make in makes() {
        let ready = Bench::ready_with(make);
        for (text, ..) in TEXTS.into_iter().chain([("Command request", 0, "")]) {
            let mut bench = ready.clone();
            bench.twin.force_shutdown(text);
            bench.pass(50);
            bench.open_again();
            let place = format!("{text}, {make:?}");
            assert!(
                bench.gets(LinkState::Locked, 5000),
                "{place}: {:?}",
                bench.events
            );
            assert_eq!(bench.alarms(), [0_u16; 0], "{place}");
            assert_eq!(bench.twin.state(), KlipperState::Running, "{place}");
            assert_eq!(bench.link.position(), None, "{place}");
        }
    }
}

/// With another configuration, running or shut down, and whichever way it forgets.
#[test]
fn a_board_set_up_for_somebody_else_forgets_that() {
    for make in makes() {
        for shut_down in [false, true] {
            let mut bench = Bench::new(make);
            bench.twin.configure_for_another_host();
            if shut_down {
                bench.twin.force_shutdown("Command request");
            }
            let place = format!("{make:?}, shut down: {shut_down}");
            assert!(
                bench.gets(LinkState::Locked, 5000),
                "{place}: {:?}",
                bench.events
            );
            assert_eq!(bench.alarms(), [0_u16; 0], "{place}");
            bench.set_position();
            assert!(bench.job() && bench.gets(LinkState::Ready, 1000), "{place}");
            assert_eq!(bench.made(), (0, -100), "{place}");
        }
    }
}

/// Reconfigured behind our back: it is not the board that was checked.
#[test]
fn a_configuration_that_changes_under_way_is_606() {
    let mut bench = Bench::ready();
    bench.twin.configure_for_another_host();
    bench.pass(1500);
    assert_eq!(
        (bench.link.state(), bench.alarms()),
        (LinkState::Fault, vec![606])
    );
    assert_eq!(bench.link.position(), None);
}

#[test]
fn a_board_met_before_is_not_asked_for_its_dictionary() {
    let mut bench = Bench::new(KlipperHardware::default());
    assert!(bench.gets(LinkState::Locked, 5000));
    assert_eq!(bench.twin.statistics().identify_count, 91);
    let learned = bench.learned();
    assert_eq!(learned.len(), 1);
    assert_eq!(learned[0].0, "atmega2560 v0.13.0-730");
    assert_eq!(learned[0].1.len(), 3574);
    let other = {
        let mut bench = Bench::new(makes()[1]);
        assert!(bench.gets(LinkState::Locked, 5000));
        bench.learned()[0].1.clone()
    };
    assert_ne!(other, learned[0].1);
    let mut damaged = learned[0].1.clone();
    damaged[2000] ^= 1;
    let right = learned[0].1.clone();
    for (known, fewest, most) in [
        (vec![right.clone()], 2, 2),
        (vec![other.clone(), right], 2, 3),
        // Another firmware, and a damaged file: read once more.
        (vec![other], 91, 92),
        (vec![damaged], 91, 91),
    ] {
        let mut again = bench.clone();
        let before = again.twin.statistics().identify_count;
        again.open_again();
        let count = known.len();
        again.link.add_dictionaries(known);
        assert!(again.gets(LinkState::Locked, 5000), "{:?}", again.events);
        let asked = again.twin.statistics().identify_count - before;
        assert!((fewest..=most).contains(&asked), "{count} known: {asked}");
        assert_eq!(again.link.board().firmware, "atmega2560 v0.13.0-730");
        assert_eq!(again.learned().len(), usize::from(most > 3));
    }
    // And not by the same link, after RESET.
    let mut bench = Bench::ready();
    let before = bench.twin.statistics().identify_count;
    bench.twin.force_shutdown("Invalid command");
    bench.pass(100);
    bench.link.reset();
    assert!(bench.gets(LinkState::Locked, 3000));
    assert_eq!(bench.twin.statistics().identify_count - before, 2);
}
