//! Sessions with a broker in memory, and random bytes from a broker.

#![allow(clippy::expect_used, reason = "tests fail by panicking")]

use gsk_telemetry::{
    BrokerSession, BrokerUrl, SessionEvent, SessionFailure, SessionOptions, TelemetryMessage,
};

/// A packet that a broker has received: its first byte and its body.
type ReceivedPacket = (u8, Vec<u8>);

/// Splits bytes into packets as the standard defines them.
fn packets(mut bytes: &[u8]) -> Vec<ReceivedPacket> {
    let mut found = Vec::new();
    while let [first, rest @ ..] = bytes {
        let (mut length, mut shift, mut used) = (0_usize, 0, 0);
        for byte in rest {
            length |= usize::from(byte & 0x7f) << shift;
            shift += 7;
            used += 1;
            if byte & 0x80 == 0 {
                break;
            }
        }
        let body = &rest[used..used + length];
        found.push((*first, body.to_vec()));
        bytes = &rest[used + length..];
    }
    found
}

/// A text with its length, as packets contain it.
fn field(text: &[u8]) -> Vec<u8> {
    let mut bytes = (text.len() as u16).to_be_bytes().to_vec();
    bytes.extend(text);
    bytes
}

fn options() -> SessionOptions {
    let url = BrokerUrl::parse("mqtt://ann:secret@host/hall/7").expect("an address");
    SessionOptions {
        will: Some(TelemetryMessage::retained(
            "hall/7/online".to_owned(),
            "offline",
        )),
        subscriptions: vec!["hall/7/request".to_owned()],
        ..SessionOptions::new("client-1".to_owned(), &url)
    }
}

const ACCEPTED: [u8; 4] = [0x20, 2, 0, 0];

fn connected() -> BrokerSession {
    let mut session = BrokerSession::new(options(), 0);
    session.take_output();
    assert_eq!(session.receive(&ACCEPTED, 10), [SessionEvent::Connected]);
    session.take_output();
    session
}

#[test]
fn connect_names_user_and_last_will() {
    let mut session = BrokerSession::new(options(), 0);
    let sent = packets(&session.take_output());
    // Protocol level 4; user, password, retained will, clean session; ten seconds.
    let mut body = field(b"MQTT");
    body.extend([4, 0b1110_0110, 0, 10]);
    for text in [
        &b"client-1"[..],
        b"hall/7/online",
        b"offline",
        b"ann",
        b"secret",
    ] {
        body.extend(field(text));
    }
    assert_eq!(sent, [(0x10, body)]);
    // The answer arrives byte by byte.
    let events: Vec<SessionEvent> = ACCEPTED
        .iter()
        .flat_map(|byte| session.receive(&[*byte], 10))
        .collect();
    assert_eq!(events, [SessionEvent::Connected]);
    assert!(session.is_connected());
    let mut body = vec![0, 1];
    body.extend(field(b"hall/7/request"));
    body.push(0);
    assert_eq!(packets(&session.take_output()), [(0x82, body)]);
}

#[test]
fn messages_travel_in_both_directions() {
    let mut session = connected();
    let message = TelemetryMessage::retained("hall/7/path".to_owned(), "{}");
    session.publish(&message, 20);
    let mut body = field(b"hall/7/path");
    body.extend(b"{}");
    assert_eq!(packets(&session.take_output()), [(0x31, body)]);
    let mut received = field(b"hall/7/request");
    received.extend(b"text");
    let mut bytes = vec![0x30, received.len() as u8];
    bytes.extend(&received);
    // Two messages in one read.
    bytes.extend(bytes.clone());
    let event = SessionEvent::Received {
        topic: "hall/7/request".to_owned(),
        payload: b"text".to_vec(),
    };
    assert_eq!(session.receive(&bytes, 30), [event.clone(), event]);
    session.disconnect(40);
    assert_eq!(packets(&session.take_output()), [(0xe0, Vec::new())]);
}

#[test]
fn nothing_is_published_before_the_answer_and_no_wildcard_ever() {
    let mut session = BrokerSession::new(options(), 0);
    session.take_output();
    let message = |topic: &str| TelemetryMessage::transient(topic.to_owned(), "1");
    session.publish(&message("a"), 1);
    assert!(session.take_output().is_empty());
    session.receive(&ACCEPTED, 10);
    session.take_output();
    session.publish(&message("a/#"), 20);
    assert!(session.take_output().is_empty());
    session.publish(&message("a"), 30);
    assert_eq!(packets(&session.take_output()).len(), 1);
}

#[test]
fn pings_keep_the_connection_and_silence_ends_it() {
    let mut session = connected();
    let mut pings = 0;
    for now in (0..60_000).step_by(500) {
        assert_eq!(session.poll(now), None);
        for packet in packets(&session.take_output()) {
            assert_eq!(packet, (0xc0, Vec::new()));
            pings += 1;
            session.receive(&[0xd0, 0], now);
        }
    }
    assert!((14..=16).contains(&pings), "{pings}");
    assert_eq!(session.poll(70_000), Some(SessionFailure::Silent));
}

#[test]
fn refusals_are_named() {
    for (code, failure) in [
        (1, SessionFailure::Refused),
        (4, SessionFailure::NotAuthorized),
        (5, SessionFailure::NotAuthorized),
    ] {
        let mut session = BrokerSession::new(options(), 0);
        let events = session.receive(&[0x20, 2, 0, code], 10);
        assert_eq!(events, [SessionEvent::Failed(failure)]);
    }
}

#[test]
fn malformed_packets_end_the_session_without_a_panic() {
    let mut seed = 7_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) as usize
    };
    let mut ended = 0;
    for round in 0..10_000 {
        let mut session = match round % 2 {
            0 => connected(),
            _ => BrokerSession::new(options(), 0),
        };
        // A valid packet with damaged bytes, or bytes at random.
        let mut bytes = field(b"hall/7/request");
        bytes.extend(b"{\"request\":\"task\"}");
        bytes.splice(0..0, [0x30, bytes.len() as u8]);
        for _ in 0..random() % 8 {
            let at = random() % bytes.len();
            bytes[at] = random() as u8;
        }
        if round % 3 == 0 {
            bytes = (0..random() % 40).map(|_| random() as u8).collect();
        }
        bytes.truncate(random() % (bytes.len() + 1) + 1);
        let events = session.receive(&bytes, 20);
        assert!(events.len() <= bytes.len() + 1);
        let is_failed = |event: &SessionEvent| matches!(event, SessionEvent::Failed(_));
        ended += usize::from(events.iter().any(is_failed));
        assert!(session.take_output().len() < 100);
    }
    assert!(ended > 300, "{ended}");
    // A length of 256 MB is refused before memory is taken.
    let events = connected().receive(&[0x30, 0xff, 0xff, 0xff, 0x7f], 20);
    assert_eq!(events, [SessionEvent::Failed(SessionFailure::Malformed)]);
}
