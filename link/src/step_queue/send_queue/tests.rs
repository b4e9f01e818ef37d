use super::*;

fn ms(ms: u64) -> HostTime {
    HostTime::from_millis(ms)
}

fn message(byte: u8, size: usize) -> QueuedMessage {
    QueuedMessage::plain(vec![byte; size])
}

/// Creates a send queue that knows the sequence number that the board expects: 5.
fn synced() -> SendQueue {
    let mut send_queue = SendQueue::new();
    send_queue.begin();
    send_queue.send(ms(1), None).unwrap();
    assert_eq!(send_queue.outgoing, [5, 0x10, 0x9e, 0x81, 0x7e]);
    send_queue.outgoing.clear();
    send_queue.block_received(5, true, ms(3));
    assert!(send_queue.is_synced());
    send_queue
}

fn sequences(send_queue: &mut SendQueue) -> Vec<u8> {
    let mut reader = block::Reader::default();
    reader.give(&core::mem::take(&mut send_queue.outgoing));
    core::iter::from_fn(|| reader.next())
        .map(|block| block.sequence)
        .collect()
}

#[test]
fn the_window_is_kept() {
    let mut send_queue = synced();
    send_queue.set_window(Some(192));
    for byte in 0..10 {
        send_queue.push(message(byte, 40));
    }
    send_queue.send(ms(4), None).unwrap();
    assert_eq!(
        sequences(&mut send_queue),
        [5, 6, 7],
        "45 bytes each, some stay free"
    );
    send_queue.block_received(6, true, ms(6));
    send_queue.send(ms(6), None).unwrap();
    assert_eq!(sequences(&mut send_queue), [8]);
    // An urgent message takes the free part of the window.
    send_queue.push_urgent(message(1, 4));
    send_queue.send(ms(6), None).unwrap();
    assert_eq!(sequences(&mut send_queue), [9]);
    let mut send_queue = synced();
    send_queue.set_window(None);
    for byte in 0..40 {
        send_queue.push(message(byte, 50));
    }
    send_queue.send(ms(4), None).unwrap();
    assert_eq!(sequences(&mut send_queue).len(), 10);
    for byte in 0..4 {
        send_queue.push_urgent(message(byte, 50));
    }
    send_queue.send(ms(4), None).unwrap();
    assert_eq!(sequences(&mut send_queue).len(), 2);
}

#[test]
fn a_nak_causes_one_retransmission() {
    let mut send_queue = synced();
    send_queue.set_window(Some(192));
    for byte in 0..3 {
        send_queue.push(message(byte, 50));
    }
    send_queue.send(ms(4), None).unwrap();
    assert_eq!(sequences(&mut send_queue), [5, 6, 7]);
    send_queue.block_received(6, true, ms(5));
    // Block 6 was damaged: the board sends a NAK for 6 and for 7.
    send_queue.block_received(6, true, ms(6));
    send_queue.send(ms(6), None).unwrap();
    assert_eq!(sequences(&mut send_queue), [6, 7]);
    send_queue.block_received(6, true, ms(7));
    send_queue.send(ms(7), None).unwrap();
    assert_eq!(sequences(&mut send_queue), [0_u8; 0]);
    send_queue.block_received(8, true, ms(9));
    assert!(send_queue.is_empty());
}

#[test]
fn an_acknowledgement_after_its_reply_is_not_a_nak() {
    let mut send_queue = synced();
    send_queue.set_window(Some(192));
    send_queue.push(message(1, 50));
    send_queue.push(message(2, 50));
    send_queue.send(ms(4), None).unwrap();
    sequences(&mut send_queue);
    send_queue.block_received(6, false, ms(5));
    send_queue.block_received(6, true, ms(5));
    send_queue.send(ms(5), None).unwrap();
    assert_eq!(sequences(&mut send_queue), [0_u8; 0]);
}

#[test]
fn silence_causes_retransmissions_until_the_board_is_lost() {
    let mut send_queue = synced();
    send_queue.push(message(1, 5));
    let mut sent = Vec::new();
    for now in 4..=510 {
        match send_queue.send(ms(now), None) {
            Ok(()) => {
                if !sequences(&mut send_queue).is_empty() {
                    sent.push(now);
                }
            }
            Err(trouble) => {
                assert_eq!((trouble, now), (SendError::Silent, 504));
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

fn step(due: u64) -> QueuedMessage {
    QueuedMessage {
        due: Some(due),
        motion: true,
        vital: true,
        ..message(1, 5)
    }
}

#[test]
fn a_late_vital_message_stops_the_link() {
    let mut send_queue = synced();
    send_queue.push(step(1000));
    assert_eq!(
        send_queue.send(ms(4), times(900, 1001)),
        Err(SendError::Late)
    );
    send_queue.send(ms(5), times(900, 999)).unwrap();
    assert_eq!(sequences(&mut send_queue), [5]);
    // The block may have arrived, with its confirmation in transit.
    send_queue.send(ms(60), times(999, 1001)).unwrap();
    assert_eq!(sequences(&mut send_queue), [0_u8; 0]);
    // The due time of the step has passed.
    assert_eq!(
        send_queue.send(ms(61), times(1001, 1003)),
        Err(SendError::Late)
    );
    send_queue.drop_motion();
    send_queue.send(ms(61), times(1001, 1003)).unwrap();
    let again = core::mem::take(&mut send_queue.outgoing);
    assert_eq!(
        again,
        block::encode_block(5, &[]),
        "the number stays, the motion is gone"
    );
}

#[test]
fn a_line_that_becomes_slow_causes_few_retransmissions() {
    let mut send_queue = synced();
    let mut sent: Vec<(u64, u8)> = Vec::new();
    for now in 4..2000_u64 {
        if now % 20 == 0 {
            send_queue.push(message(1, 5));
        }
        send_queue.send(ms(now), None).unwrap();
        for number in sequences(&mut send_queue) {
            if !sent.iter().any(|(_, sent)| *sent == number) {
                sent.push((now, number));
            }
        }
        // Each block is confirmed once, 103 ms after its first transmission.
        while let Some(&(at, number)) = sent.first()
            && now >= at + 103
        {
            sent.remove(0);
            send_queue.block_received(number.wrapping_add(1) & 0x0F, true, ms(now));
        }
    }
    assert!(send_queue.round_trip.slowness() >= ms(70));
    assert!(
        send_queue.resent <= 40,
        "{} of {} blocks came twice",
        send_queue.resent,
        send_queue.blocks
    );
}

#[test]
fn a_restarted_sequence_is_a_reset() {
    let mut send_queue = synced();
    send_queue.push(message(1, 5));
    send_queue.send(ms(4), None).unwrap();
    assert_eq!(
        send_queue.block_received(1, true, ms(5)),
        Some(Ack::Strange)
    );
    send_queue.send(ms(6), None).unwrap();
    assert_eq!(
        send_queue.block_received(1, true, ms(40)),
        Some(Ack::Strange)
    );
    assert_eq!(send_queue.send(ms(106), None), Err(SendError::Restarted));
}

#[test]
fn an_old_reply_does_not_answer_a_new_question() {
    let mut send_queue = synced();
    assert!(!send_queue.answers(Mark::Position, 21), "no query was sent");
    send_queue.push(QueuedMessage {
        mark: Some(Mark::Position),
        ..message(1, 5)
    });
    send_queue.send(ms(4), None).unwrap();
    assert!(!send_queue.answers(Mark::Position, 16 + 5));
    assert!(send_queue.answers(Mark::Position, 16 + 6));
}
