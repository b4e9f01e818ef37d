#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use super::*;

fn path(name: &str) -> RemotePath {
    RemotePath {
        partition: Partition::User1,
        name: FileName::new(name).unwrap(),
    }
}

fn requests() -> Vec<TransferRequest> {
    vec![
        TransferRequest::Connect { version: 1 },
        TransferRequest::Bye,
        TransferRequest::Directory(Partition::User2),
        TransferRequest::Entry {
            name: FileName::new("ParaW.par").unwrap(),
            size: 423_020,
        },
        TransferRequest::End,
        TransferRequest::Put(PutRequest {
            remote_path: path("O0331.CNC"),
            size: 70_000,
            overwrite: true,
        }),
        TransferRequest::Data((0..=255).chain(0..=255).collect()),
        TransferRequest::Data(Vec::new()),
        TransferRequest::Eof,
        TransferRequest::Get(path("A")),
        TransferRequest::Delete(path("A.B")),
        TransferRequest::Rename {
            from: path("O0001.CNC"),
            to: FileName::new("O0002.CNC").unwrap(),
        },
    ]
}

fn read(bytes: &[u8]) -> Vec<ReaderOutput> {
    let mut reader = FrameReader::default();
    let mut outputs = Vec::new();
    for byte in bytes {
        reader.push_bytes(&[*byte]);
        while let Some(output) = reader.next() {
            outputs.push(output);
        }
    }
    outputs
}

#[test]
fn crc_matches_published_check_value() {
    // Check value of CRC-16/IBM-3740, also called CCITT-FALSE.
    assert_eq!(compute_crc(b"123456789"), 0x29B1);
}

#[test]
fn frame_has_documented_layout() {
    let put = TransferRequest::Put(PutRequest {
        remote_path: path("A.B"),
        size: 0x0102_0304,
        overwrite: true,
    });
    let frame = put.encode(9);
    let request = [0x30, 9, 10, 0, 1, 3, b'A', b'.', b'B', 4, 3, 2, 1, 1];
    assert_eq!(frame[0], 1);
    assert_eq!(frame[1..15], request);
    assert_eq!(frame[15..], compute_crc(&request).to_le_bytes());
    assert_eq!(encode_reply(5, Ok(()))[..6], [1, 0x7E, 5, 1, 0, 5]);
    let refused = encode_reply(5, Err(TransferFault::Busy));
    assert_eq!(refused[..7], [1, 0x7F, 5, 2, 0, 5, 7]);
}

#[test]
fn encoded_frames_decode_to_same_requests() {
    let mut bytes = Vec::new();
    let mut expected = Vec::new();
    for (seq, request) in (250..=255).chain(0..).zip(requests()) {
        bytes.extend(request.encode(seq));
        bytes.extend(encode_reply(seq, Err(TransferFault::Full)));
        expected.push(ReaderOutput::Frame(TransferFrame::Request {
            seq,
            request: Ok(request),
        }));
        expected.push(ReaderOutput::Frame(TransferFrame::Reply {
            seq,
            result: Err(TransferFault::Full),
        }));
    }
    assert_eq!(read(&bytes), expected);
}

#[test]
fn frame_after_damaged_one_is_found() {
    for request in requests() {
        let good = TransferRequest::Eof.encode(77);
        let whole = request.encode(3);
        for at in 0..whole.len() {
            let mut flipped = whole.clone();
            flipped[at] ^= 0x10;
            let mut lost = whole.clone();
            lost.remove(at);
            let mut doubled = whole.clone();
            doubled.insert(at, whole[at]);
            for damaged in [flipped, lost, doubled.clone()] {
                // The reader may wait for a long frame after it, so more than one frame follows.
                let mut bytes = damaged.clone();
                (0..80).for_each(|_| bytes.extend(&good));
                let outputs = read(&bytes);
                let frames = outputs
                    .iter()
                    .filter(|output| matches!(output, ReaderOutput::Frame(_)));
                let wrong = frames.filter(|output| {
                    let eof = TransferFrame::Request {
                        seq: 77,
                        request: Ok(TransferRequest::Eof),
                    };
                    **output != ReaderOutput::Frame(eof)
                });
                // A byte doubled before or after the frame leaves the frame whole.
                let left_whole = damaged == doubled;
                assert!(wrong.count() <= usize::from(left_whole), "{request:?} {at}");
                let found = outputs.iter().rev().take(10).count();
                assert!(found == 10, "{request:?} {at}");
            }
        }
    }
}

#[test]
fn invalid_names_and_payloads_are_refused() {
    let refused = |type_code, payload: &[u8]| match read(&encode_frame(type_code, 1, payload)).pop()
    {
        Some(ReaderOutput::Frame(TransferFrame::Request { request, .. })) => request.err(),
        other => panic!("{other:?}"),
    };
    assert_eq!(
        refused(GET, &[0, 3, b'.', b'.', b'/']),
        Some(TransferFault::BadName)
    );
    assert_eq!(refused(GET, &[0, 9, b'A']), Some(TransferFault::Content));
    assert_eq!(refused(GET, &[3, 1, b'A']), Some(TransferFault::BadName));
    assert_eq!(refused(BYE, &[0]), Some(TransferFault::Content));
    assert_eq!(refused(0x60, &[]), Some(TransferFault::Content));
    assert_eq!(
        refused(PUT, &[0, 1, b'A', 1, 2]),
        Some(TransferFault::Content)
    );
}

#[test]
fn random_bytes_never_hang_the_reader() {
    let mut state = 1_u32;
    let mut bytes = Vec::new();
    for _ in 0..200_000 {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        bytes.push((state >> 24) as u8 & if state & 0x80 == 0 { 1 } else { 0xFF });
    }
    let mut reader = FrameReader::default();
    reader.push_bytes(&bytes);
    while reader.next().is_some() {}
    while reader.is_in_frame() {
        reader.skip_byte();
        while reader.next().is_some() {}
    }
    assert!(reader.noise() > 190_000);
}
