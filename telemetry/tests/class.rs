//! A class with seats: what they publish arrives in the view of the class.

#![allow(clippy::expect_used, reason = "tests fail by panicking")]

use gsk_messages::Language;
use gsk_telemetry::TelemetryMessage;
use gsk_telemetry::class::class_address::ClassAddress;
use gsk_telemetry::class::class_roster::{ClassRoster, RosterEvent, SeatUrgency};
use gsk_telemetry::class::class_table::write_table;
use gsk_telemetry::class::lcd_picture::{LCD_DOTS, LcdPicture};
use gsk_telemetry::class::part_outline::CoarseOutline;
use gsk_telemetry::class::seat_publisher::{MAX_RESULT_BYTES, SeatPublisher};
use gsk_telemetry::class::seat_report::{SeatReport, SeatText, SeatTrouble, SeatTroubleKind};
use gsk_telemetry::class::seat_request::{SeatAnswer, SeatRefusal};

fn class() -> ClassAddress {
    ClassAddress::parse("K7M2@host").expect("a class")
}

fn report(name: &str) -> SeatReport {
    SeatReport {
        name: name.to_owned(),
        is_online: true,
        ..SeatReport::default()
    }
}

fn seat(id: &str, name: &str) -> SeatPublisher {
    SeatPublisher::new(class().topics(), id.to_owned(), report(name))
}

fn trouble(kind: SeatTroubleKind) -> Option<SeatTrouble> {
    let text = SeatText {
        en: "Alarm 2001".to_owned(),
        zh: "报警 2001".to_owned(),
    };
    Some(SeatTrouble { kind, text })
}

fn deliver(
    roster: &mut ClassRoster,
    messages: &[TelemetryMessage],
    now_ms: u64,
) -> Vec<RosterEvent> {
    let events = messages.iter();
    let events = events.filter_map(|it| roster.take(&it.topic, &it.payload, now_ms));
    events.collect()
}

#[test]
fn the_seat_that_needs_help_is_first() {
    let mut roster = ClassRoster::new(class().topics());
    let reports = [
        (
            "running",
            SeatReport {
                is_running: true,
                ..report("running")
            },
        ),
        ("working", report("working")),
        (
            "idle",
            SeatReport {
                idle_min: 5,
                ..report("idle")
            },
        ),
        (
            "help",
            SeatReport {
                asks_help: true,
                ..report("help")
            },
        ),
        (
            "alarm",
            SeatReport {
                trouble: trouble(SeatTroubleKind::Alarm),
                ..report("alarm")
            },
        ),
        (
            "crash",
            SeatReport {
                trouble: trouble(SeatTroubleKind::Crash),
                ..report("crash")
            },
        ),
        (
            "emergency",
            SeatReport {
                trouble: trouble(SeatTroubleKind::Emergency),
                ..report("emergency")
            },
        ),
    ];
    for (id, report) in reports {
        let mut publisher = seat(id, id);
        publisher.set_report(report);
        deliver(&mut roster, &publisher.take_due(0), 100);
    }
    let gone = seat("gone", "gone");
    deliver(&mut roster, &[gone.will()], 100);
    let order: Vec<&str> = roster
        .by_urgency()
        .iter()
        .map(|seat| seat.id.as_str())
        .collect();
    let expected = [
        "emergency",
        "crash",
        "help",
        "alarm",
        "idle",
        "working",
        "running",
        "gone",
    ];
    assert_eq!(order, expected);
    assert_eq!(roster.count(), (7, 8));
    let table = write_table(&roster, Language::En);
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 10);
    assert!(
        rows[2].starts_with("emergency") && rows[2].ends_with("Alarm 2001"),
        "{table}"
    );
    assert!(write_table(&roster, Language::Zh).contains("报警 2001"));
}

#[test]
fn among_equals_the_longest_wait_is_first() {
    let mut roster = ClassRoster::new(class().topics());
    for (now, id) in [(300, "a"), (100, "c"), (200, "b")] {
        let mut publisher = seat(id, id);
        publisher.set_report(SeatReport {
            asks_help: true,
            ..report(id)
        });
        deliver(&mut roster, &publisher.take_due(0), now);
    }
    let order: Vec<&str> = roster
        .by_urgency()
        .iter()
        .map(|seat| seat.id.as_str())
        .collect();
    assert_eq!(order, ["c", "b", "a"]);
}

#[test]
fn a_seat_returns_and_leaves() {
    let mut roster = ClassRoster::new(class().topics());
    let mut first = seat("a1", "Ann");
    deliver(&mut roster, &first.take_due(0), 0);
    deliver(&mut roster, &[first.will()], 10);
    assert_eq!(roster.by_urgency()[0].urgency, SeatUrgency::Offline);
    // The window starts again.
    let mut second = seat("b2", "Ann");
    deliver(&mut roster, &second.take_due(0), 20);
    assert_eq!(roster.count(), (1, 1));
    assert_eq!(roster.take_replaced(), ["a1"]);
    assert!(roster.take_replaced().is_empty());
    deliver(&mut roster, &second.farewell(), 30);
    assert_eq!(roster.count(), (0, 0));
}

#[test]
fn a_seat_publishes_changes_at_a_limited_rate() {
    let mut publisher = seat("a1", "Ann");
    assert_eq!(publisher.take_due(0).len(), 2);
    assert!(publisher.take_due(10).is_empty());
    for line in 0..100 {
        publisher.set_report(SeatReport {
            line: Some(line),
            ..report("Ann")
        });
    }
    assert!(publisher.take_due(20).is_empty());
    let due = publisher.take_due(250);
    assert_eq!(due.len(), 1);
    assert!(String::from_utf8_lossy(&due[0].payload).contains("\"line\":99"));
    publisher.forget_published();
    assert_eq!(publisher.take_due(260).len(), 2);
}

#[test]
fn the_lcd_is_published_only_while_it_is_watched() {
    let picture = || LcdPicture {
        background: [0; 3],
        text: [255; 3],
        dots: vec![false; LCD_DOTS],
    };
    let mut roster = ClassRoster::new(class().topics());
    let mut publisher = seat("a1", "Ann");
    deliver(&mut roster, &publisher.take_due(0), 0);
    publisher.set_lcd(picture());
    assert!(publisher.take_due(1000).is_empty());
    publisher.watch_lcd(1000, 10);
    let events = deliver(&mut roster, &publisher.take_due(1000), 1000);
    assert!(matches!(&events[..], [RosterEvent::Lcd { seat, .. }] if seat == "a1"));
    publisher.set_lcd(picture());
    assert!(publisher.take_due(1100).is_empty());
    assert_eq!(publisher.take_due(1300).len(), 1);
    publisher.set_lcd(picture());
    assert!(publisher.take_due(11_001).is_empty());
}

#[test]
fn answers_and_results_arrive_once() {
    let mut roster = ClassRoster::new(class().topics());
    let mut publisher = seat("a1", "Ann");
    deliver(&mut roster, &publisher.take_due(0), 0);
    let answer = SeatAnswer {
        subject: "shaft".to_owned(),
        refusal: Some(SeatRefusal::Learner),
    };
    publisher.answer(&answer);
    assert!(publisher.hand_in(vec![1, 2, 3]));
    assert!(!publisher.hand_in(vec![0; MAX_RESULT_BYTES + 1]));
    let events = deliver(&mut roster, &publisher.take_due(10), 10);
    let name = "Ann".to_owned();
    let expected = [
        RosterEvent::Answer {
            name: name.clone(),
            answer,
        },
        RosterEvent::Result {
            seat: "a1".to_owned(),
            name,
            bytes: vec![1, 2, 3],
        },
    ];
    assert_eq!(events, expected);
    assert!(publisher.take_due(20).is_empty());
}

#[test]
fn malformed_messages_change_nothing() {
    let mut roster = ClassRoster::new(class().topics());
    let mut publisher = seat("a1", "Ann");
    publisher.set_part(CoarseOutline {
        lines: vec![vec![[0.0, 1.0], [2.0, 3.0], [4.0, 0.0]]],
    });
    let messages = publisher.take_due(0);
    deliver(&mut roster, &messages, 0);
    let before = roster.by_urgency()[0].clone();
    let topics = ["state", "part", "lcd", "answer", "request", "key", ""];
    let mut seed = 11_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) as usize
    };
    for _ in 0..10_000 {
        let topic = format!("gsk980td/class/K7M2/seats/a1/{}", topics[random() % 7]);
        let mut payload = vec![b'{'];
        payload.extend((0..random() % 30).map(|_| random() as u8));
        assert_eq!(roster.take(&topic, &payload, 1), None);
    }
    assert_eq!(*roster.by_urgency()[0], before);
    // A flood of seats ends at a limit.
    for number in 0..5000 {
        let topic = format!("gsk980td/class/K7M2/seats/s{number}/state");
        roster.take(&topic, report("x").to_json().as_bytes(), 2);
    }
    assert_eq!(roster.count().1, 2000);
}
