#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use super::*;

const BAUD: u32 = 9600;

/// Passes bytes to a reader without waiting and returns all its events.
fn read(bytes: &[u8]) -> Vec<TextEvent> {
    let mut reader = TextReader::new(BAUD);
    let mut events = Vec::new();
    let mut now = PortTime::ZERO;
    for chunk in bytes.chunks(7) {
        reader.receive(chunk, now);
        now += PortTime::from_millis(10);
        while let Some(event) = reader.advance(now) {
            events.push(event);
        }
    }
    for _ in 0..2000 {
        now += PortTime::from_millis(10);
        while let Some(event) = reader.advance(now) {
            events.push(event);
        }
    }
    events
}

fn whole(text: &str) -> Vec<TextEvent> {
    vec![TextEvent::Started, TextEvent::Complete(text.to_owned())]
}

#[test]
fn all_line_ends_leaders_and_parities_are_read() {
    let lines = "O0001\nG00 X10\n\nM30\n";
    for end in ["\r\n", "\n", "\r", "\n\r", "\n\r\r"] {
        let text = lines.replace('\n', end);
        for bytes in [
            format!("%{end}{text}%{end}"),
            format!("\0\0\0\r\n\x12%{end}{text}\0%\0\0\0"),
            format!("{text}%"),
        ] {
            assert_eq!(read(bytes.as_bytes()), whole(lines), "{bytes:?}");
            let parity: Vec<u8> = bytes
                .bytes()
                .map(|byte| byte | ((byte.count_ones() as u8 & 1) << 7))
                .collect();
            assert_eq!(read(&parity), whole(lines), "{bytes:?} with parity");
        }
    }
}

#[test]
fn programs_and_consecutive_texts_are_separated() {
    let text = "O0001 (A)\nM30\nO0002\nM99\n";
    assert_eq!(split_programs(text), ["O0001 (A)\nM30\n", "O0002\nM99\n"]);
    assert_eq!(split_programs("G0 X1\n"), ["G0 X1\n"]);
    assert_eq!(parse_program_number("O0012 (A)\n"), Some(12));
    assert_eq!(parse_program_number("\n:7\n"), Some(7));
    assert_eq!(parse_program_number("G0\nO1\n"), None);
    assert_eq!(parse_program_number("O99999\n"), None);
    let two = read(b"%\nO1\nM30\n%\n%\nO2\nM30\n%\n");
    assert_eq!(two, [whole("O1\nM30\n"), whole("O2\nM30\n")].concat());
}

#[test]
fn incomplete_text_is_not_delivered() {
    let long = [b"%\nO0001\n".to_vec(), b"G00 X1.\n".repeat(50)].concat();
    assert_eq!(read(&long), [TextEvent::Started, TextEvent::Interrupted]);
    assert_eq!(read(b"%\nO1\n"), [TextEvent::Started, TextEvent::Noise]);
    // A control character ends any text with an error.
    let noise = [long, b"\x05M30\n%\n".to_vec()].concat();
    let events = read(&noise);
    assert_eq!(events[..2], [TextEvent::Started, TextEvent::Interrupted]);
    assert!(
        !events
            .iter()
            .any(|event| matches!(event, TextEvent::Complete(text) if text.contains("G00")))
    );
}

#[test]
fn fast_sender_is_stopped_without_loss() {
    let text: String = (1..2000).map(|n| format!("N{n} G01 X{n}\n")).collect();
    let text = format!("O0001\n{text}");
    let mut writer = TextWriter::new(&text, TextLineEnd::CrLf, 115_200).unwrap();
    let mut reader = TextReader::new(BAUD);
    let (mut stops, mut found) = (0, None);
    let mut now = PortTime::ZERO;
    while found.is_none() {
        now += PortTime::from_millis(1);
        assert!(now < PortTime::from_secs(120));
        let due = writer.pending_bytes(now).to_vec();
        writer.mark_sent(due.len(), now);
        reader.receive(&due, now);
        let replies = reader.take_flow_control();
        stops += replies.iter().filter(|reply| **reply == XOFF).count();
        writer.receive(&replies);
        while let Some(event) = reader.advance(now) {
            found = Some(event).filter(|event| *event != TextEvent::Started);
        }
    }
    assert_eq!(found, Some(TextEvent::Complete(text)));
    assert!(stops > 10, "{stops}");
    // A sender that ignores XOFF is reported.
    reader.receive(&b"%\nG00\n".repeat(20_000), now);
    let last_event = core::iter::from_fn(|| reader.advance(now + PortTime::from_secs(1))).last();
    assert!(
        matches!(last_event, Some(TextEvent::Noise | TextEvent::Interrupted)),
        "{last_event:?}"
    );
}

#[test]
fn written_text_is_enclosed_in_percent_signs() {
    let bytes = |text, end| TextWriter::new(text, end, BAUD).unwrap().bytes;
    for text in [
        "O0001\nM30\n",
        "%\nO0001\r\nM30\r\n%\r\n",
        "\nO0001\nM30\n%",
    ] {
        assert_eq!(
            bytes(text, TextLineEnd::CrLf),
            b"%\r\nO0001\r\nM30\r\n%\r\n"
        );
        assert_eq!(
            bytes(text, TextLineEnd::LfCrCr),
            b"%\n\r\rO0001\n\r\rM30\n\r\r%\n\r\r"
        );
    }
    let refused = TextWriter::new("O0001\n(轴)\n", TextLineEnd::Lf, BAUD).unwrap_err();
    assert_eq!((refused.line, refused.character), (2, '轴'));
}
