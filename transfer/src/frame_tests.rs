#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use super::*;

fn place(name: &str) -> Place {
    Place {
        partition: Partition::User1,
        name: FileName::new(name).unwrap(),
    }
}

fn bodies() -> Vec<Body> {
    vec![
        Body::Connect { version: 1 },
        Body::Bye,
        Body::Directory(Partition::User2),
        Body::Entry {
            name: FileName::new("ParaW.par").unwrap(),
            size: 423_020,
        },
        Body::End,
        Body::Put(Put {
            place: place("O0331.CNC"),
            size: 70_000,
            overwrite: true,
        }),
        Body::Data((0..=255).chain(0..=255).collect()),
        Body::Data(Vec::new()),
        Body::Eof,
        Body::Get(place("A")),
        Body::Delete(place("A.B")),
        Body::Rename {
            from: place("O0001.CNC"),
            to: FileName::new("O0002.CNC").unwrap(),
        },
    ]
}

fn read(bytes: &[u8]) -> Vec<Piece> {
    let mut reader = Reader::default();
    let mut pieces = Vec::new();
    for byte in bytes {
        reader.give(&[*byte]);
        while let Some(piece) = reader.next() {
            pieces.push(piece);
        }
    }
    pieces
}

#[test]
fn the_checksum_is_that_of_the_catalogues() {
    // CRC-16/IBM-3740, also called CCITT-FALSE: its check value.
    assert_eq!(crc(b"123456789"), 0x29B1);
}

#[test]
fn a_frame_has_the_form_of_the_table() {
    let put = Body::Put(Put {
        place: place("A.B"),
        size: 0x0102_0304,
        overwrite: true,
    });
    let frame = put.encode(9);
    let body = [0x30, 9, 10, 0, 1, 3, b'A', b'.', b'B', 4, 3, 2, 1, 1];
    assert_eq!(frame[0], 1);
    assert_eq!(frame[1..15], body);
    assert_eq!(frame[15..], crc(&body).to_le_bytes());
    assert_eq!(encode_answer(5, Ok(()))[..6], [1, 0x7E, 5, 1, 0, 5]);
    let refused = encode_answer(5, Err(Fault::Busy));
    assert_eq!(refused[..7], [1, 0x7F, 5, 2, 0, 5, 7]);
}

#[test]
fn what_is_encoded_is_decoded() {
    let mut bytes = Vec::new();
    let mut expected = Vec::new();
    for (seq, body) in (250..=255).chain(0..).zip(bodies()) {
        bytes.extend(body.encode(seq));
        bytes.extend(encode_answer(seq, Err(Fault::Full)));
        expected.push(Piece::Frame(Frame::Body {
            seq,
            body: Ok(body),
        }));
        expected.push(Piece::Frame(Frame::Answer {
            seq,
            result: Err(Fault::Full),
        }));
    }
    assert_eq!(read(&bytes), expected);
}

#[test]
fn a_frame_after_a_damaged_one_is_found() {
    for body in bodies() {
        let good = Body::Eof.encode(77);
        let whole = body.encode(3);
        for at in 0..whole.len() {
            let mut flipped = whole.clone();
            flipped[at] ^= 0x10;
            let mut lost = whole.clone();
            lost.remove(at);
            let mut doubled = whole.clone();
            doubled.insert(at, whole[at]);
            for damaged in [flipped, lost, doubled.clone()] {
                // Behind it a frame of any length may be waited for: more than one.
                let mut bytes = damaged.clone();
                (0..80).for_each(|_| bytes.extend(&good));
                let pieces = read(&bytes);
                let frames = pieces
                    .iter()
                    .filter(|piece| matches!(piece, Piece::Frame(_)));
                let wrong = frames.filter(|piece| {
                    let eof = Frame::Body {
                        seq: 77,
                        body: Ok(Body::Eof),
                    };
                    **piece != Piece::Frame(eof)
                });
                // A byte doubled before the frame or behind it leaves the frame whole.
                let left_whole = damaged == doubled;
                assert!(wrong.count() <= usize::from(left_whole), "{body:?} {at}");
                let found = pieces.iter().rev().take(10).count();
                assert!(found == 10, "{body:?} {at}");
            }
        }
    }
}

#[test]
fn names_and_payloads_that_nobody_has_are_refused() {
    let refused = |kind, payload: &[u8]| match read(&encoded(kind, 1, payload)).pop() {
        Some(Piece::Frame(Frame::Body { body, .. })) => body.err(),
        other => panic!("{other:?}"),
    };
    assert_eq!(
        refused(GET, &[0, 3, b'.', b'.', b'/']),
        Some(Fault::BadName)
    );
    assert_eq!(refused(GET, &[0, 9, b'A']), Some(Fault::Content));
    assert_eq!(refused(GET, &[3, 1, b'A']), Some(Fault::BadName));
    assert_eq!(refused(BYE, &[0]), Some(Fault::Content));
    assert_eq!(refused(0x60, &[]), Some(Fault::Content));
    assert_eq!(refused(PUT, &[0, 1, b'A', 1, 2]), Some(Fault::Content));
}

#[test]
fn any_bytes_are_read_without_end() {
    let mut state = 1_u32;
    let mut bytes = Vec::new();
    for _ in 0..200_000 {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        bytes.push((state >> 24) as u8 & if state & 0x80 == 0 { 1 } else { 0xFF });
    }
    let mut reader = Reader::default();
    reader.give(&bytes);
    while reader.next().is_some() {}
    while reader.is_within() {
        reader.give_up();
        while reader.next().is_some() {}
    }
    assert!(reader.noise() > 190_000);
}
