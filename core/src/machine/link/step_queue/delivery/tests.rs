use super::*;

fn ms(ms: u64) -> HostTime {
    HostTime::from_millis(ms)
}

fn message(byte: u8, size: usize) -> Message {
    Message::plain(vec![byte; size])
}

/// Synced, the board expects block 5.
fn synced() -> Delivery {
    let mut delivery = Delivery::new();
    delivery.begin();
    delivery.send(ms(1), None).unwrap();
    assert_eq!(delivery.outgoing, [5, 0x10, 0x9e, 0x81, 0x7e]);
    delivery.outgoing.clear();
    delivery.hear(5, true, ms(3));
    assert!(delivery.is_synced());
    delivery
}

fn sequences(delivery: &mut Delivery) -> Vec<u8> {
    let mut reader = block::Reader::default();
    reader.give(&core::mem::take(&mut delivery.outgoing));
    core::iter::from_fn(|| reader.next())
        .map(|block| block.sequence)
        .collect()
}

#[test]
fn the_window_is_kept() {
    let mut delivery = synced();
    delivery.set_window(Some(192));
    for byte in 0..10 {
        delivery.say(message(byte, 40));
    }
    delivery.send(ms(4), None).unwrap();
    assert_eq!(
        sequences(&mut delivery),
        [5, 6, 7],
        "45 bytes each, some are kept"
    );
    delivery.hear(6, true, ms(6));
    delivery.send(ms(6), None).unwrap();
    assert_eq!(sequences(&mut delivery), [8]);
    // What is urgent has the rest.
    delivery.say_first(message(1, 4));
    delivery.send(ms(6), None).unwrap();
    assert_eq!(sequences(&mut delivery), [9]);
    let mut delivery = synced();
    delivery.set_window(None);
    for byte in 0..40 {
        delivery.say(message(byte, 50));
    }
    delivery.send(ms(4), None).unwrap();
    assert_eq!(sequences(&mut delivery).len(), 10);
    for byte in 0..4 {
        delivery.say_first(message(byte, 50));
    }
    delivery.send(ms(4), None).unwrap();
    assert_eq!(sequences(&mut delivery).len(), 2);
}

#[test]
fn a_complaint_sends_again_once() {
    let mut delivery = synced();
    delivery.set_window(Some(192));
    for byte in 0..3 {
        delivery.say(message(byte, 50));
    }
    delivery.send(ms(4), None).unwrap();
    assert_eq!(sequences(&mut delivery), [5, 6, 7]);
    delivery.hear(6, true, ms(5));
    // Block 6 was damaged: both it and 7 are complained about.
    delivery.hear(6, true, ms(6));
    delivery.send(ms(6), None).unwrap();
    assert_eq!(sequences(&mut delivery), [6, 7]);
    delivery.hear(6, true, ms(7));
    delivery.send(ms(7), None).unwrap();
    assert_eq!(sequences(&mut delivery), [0_u8; 0]);
    delivery.hear(8, true, ms(9));
    assert!(delivery.is_empty());
}

#[test]
fn an_acknowledgement_behind_its_reply_is_no_complaint() {
    let mut delivery = synced();
    delivery.set_window(Some(192));
    delivery.say(message(1, 50));
    delivery.say(message(2, 50));
    delivery.send(ms(4), None).unwrap();
    sequences(&mut delivery);
    delivery.hear(6, false, ms(5));
    delivery.hear(6, true, ms(5));
    delivery.send(ms(5), None).unwrap();
    assert_eq!(sequences(&mut delivery), [0_u8; 0]);
}

#[test]
fn silence_sends_again_ever_later_and_ends() {
    let mut delivery = synced();
    delivery.say(message(1, 5));
    let mut sent = Vec::new();
    for now in 4..=510 {
        match delivery.send(ms(now), None) {
            Ok(()) => {
                if !sequences(&mut delivery).is_empty() {
                    sent.push(now);
                }
            }
            Err(trouble) => {
                assert_eq!((trouble, now), (Trouble::Silent, 504));
                assert_eq!(sent, [4, 29, 79, 179, 379]);
                return;
            }
        }
    }
    panic!("never ends: {sent:?}");
}

fn times(now: u64, earliest: u64) -> Option<Times> {
    let again = earliest;
    Some(Times {
        now,
        earliest,
        again,
    })
}

fn step(due: u64) -> Message {
    Message {
        due: Some(due),
        motion: true,
        vital: true,
        ..message(1, 5)
    }
}

#[test]
fn what_would_come_late_is_not_sent() {
    let mut delivery = synced();
    delivery.say(step(1000));
    assert_eq!(delivery.send(ms(4), times(900, 1001)), Err(Trouble::Late));
    delivery.send(ms(5), times(900, 999)).unwrap();
    assert_eq!(sequences(&mut delivery), [5]);
    // It may have arrived, its confirmation be on its way.
    delivery.send(ms(60), times(999, 1001)).unwrap();
    assert_eq!(sequences(&mut delivery), [0_u8; 0]);
    // Now it should have been made.
    assert_eq!(delivery.send(ms(61), times(1001, 1003)), Err(Trouble::Late));
    delivery.drop_motion();
    delivery.send(ms(61), times(1001, 1003)).unwrap();
    let again = core::mem::take(&mut delivery.outgoing);
    assert_eq!(
        again,
        block::block(5, &[]),
        "the number stays, the motion is gone"
    );
}

#[test]
fn a_line_that_becomes_slow_is_waited_for() {
    let mut delivery = synced();
    let mut sent: Vec<(u64, u8)> = Vec::new();
    for now in 4..2000_u64 {
        if now % 20 == 0 {
            delivery.say(message(1, 5));
        }
        delivery.send(ms(now), None).unwrap();
        for number in sequences(&mut delivery) {
            if !sent.iter().any(|(_, sent)| *sent == number) {
                sent.push((now, number));
            }
        }
        // Every block is confirmed 103 ms after it came, once.
        while let Some(&(at, number)) = sent.first()
            && now >= at + 103
        {
            sent.remove(0);
            delivery.hear(number.wrapping_add(1) & 0x0F, true, ms(now));
        }
    }
    assert!(delivery.slowness() >= ms(70));
    assert!(
        delivery.resent <= 40,
        "{} of {} blocks came twice",
        delivery.resent,
        delivery.blocks
    );
}

#[test]
fn a_board_that_counts_anew_was_reset() {
    let mut delivery = synced();
    delivery.say(message(1, 5));
    delivery.send(ms(4), None).unwrap();
    assert_eq!(delivery.hear(1, true, ms(5)), Some(Heard::Strange));
    delivery.send(ms(6), None).unwrap();
    assert_eq!(delivery.hear(1, true, ms(40)), Some(Heard::Strange));
    assert_eq!(delivery.send(ms(106), None), Err(Trouble::Restarted));
}

#[test]
fn an_old_reply_does_not_answer_a_new_question() {
    let mut delivery = synced();
    assert!(!delivery.answers(Mark::Position, 21), "nothing was asked");
    delivery.say(Message {
        mark: Some(Mark::Position),
        ..message(1, 5)
    });
    delivery.send(ms(4), None).unwrap();
    assert!(!delivery.answers(Mark::Position, 16 + 5));
    assert!(delivery.answers(Mark::Position, 16 + 6));
}
