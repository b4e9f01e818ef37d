#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use super::*;

const BAUD: u32 = 9600;

/// What a reader makes of bytes, with all the time it wants.
fn read(bytes: &[u8]) -> Vec<TextEvent> {
    let mut reader = TextReader::new(BAUD);
    let mut events = Vec::new();
    let mut now = HostTime::ZERO;
    for chunk in bytes.chunks(7) {
        reader.hear(chunk, now);
        now += HostTime::from_millis(10);
        while let Some(event) = reader.advance(now) {
            events.push(event);
        }
    }
    for _ in 0..2000 {
        now += HostTime::from_millis(10);
        while let Some(event) = reader.advance(now) {
            events.push(event);
        }
    }
    events
}

fn whole(text: &str) -> Vec<TextEvent> {
    vec![TextEvent::Begun, TextEvent::Whole(text.to_owned())]
}

#[test]
fn line_ends_leader_and_parity_of_every_kind_are_read() {
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
fn several_programs_of_one_text_and_texts_in_a_row_are_told_apart() {
    let text = "O0001 (A)\nM30\nO0002\nM99\n";
    assert_eq!(programs(text), ["O0001 (A)\nM30\n", "O0002\nM99\n"]);
    assert_eq!(programs("G0 X1\n"), ["G0 X1\n"]);
    assert_eq!(program_number("O0012 (A)\n"), Some(12));
    assert_eq!(program_number("\n:7\n"), Some(7));
    assert_eq!(program_number("G0\nO1\n"), None);
    assert_eq!(program_number("O99999\n"), None);
    let two = read(b"%\nO1\nM30\n%\n%\nO2\nM30\n%\n");
    assert_eq!(two, [whole("O1\nM30\n"), whole("O2\nM30\n")].concat());
}

#[test]
fn a_text_without_its_end_is_nothing() {
    let long = [b"%\nO0001\n".to_vec(), b"G00 X1.\n".repeat(50)].concat();
    assert_eq!(read(&long), [TextEvent::Begun, TextEvent::Broken]);
    assert_eq!(read(b"%\nO1\n"), [TextEvent::Begun, TextEvent::Noise]);
    // A control character is no text, whatever came before it.
    let noise = [long, b"\x05M30\n%\n".to_vec()].concat();
    let events = read(&noise);
    assert_eq!(events[..2], [TextEvent::Begun, TextEvent::Broken]);
    assert!(
        !events
            .iter()
            .any(|event| matches!(event, TextEvent::Whole(text) if text.contains("G00")))
    );
}

#[test]
fn a_partner_that_is_too_fast_is_stopped_and_nothing_is_lost() {
    let text: String = (1..2000).map(|n| format!("N{n} G01 X{n}\n")).collect();
    let text = format!("O0001\n{text}");
    let mut writer = TextWriter::new(&text, LineEnd::CrLf, 115_200).unwrap();
    let mut reader = TextReader::new(BAUD);
    let (mut stops, mut found) = (0, None);
    let mut now = HostTime::ZERO;
    while found.is_none() {
        now += HostTime::from_millis(1);
        assert!(now < HostTime::from_secs(120));
        let due = writer.due(now).to_vec();
        writer.sent(due.len(), now);
        reader.hear(&due, now);
        let replies = reader.take_replies();
        stops += replies.iter().filter(|reply| **reply == STOP).count();
        writer.hear(&replies);
        while let Some(event) = reader.advance(now) {
            found = Some(event).filter(|event| *event != TextEvent::Begun);
        }
    }
    assert_eq!(found, Some(TextEvent::Whole(text)));
    assert!(stops > 10, "{stops}");
    // One that does not stop is told.
    reader.hear(&b"%\nG00\n".repeat(20_000), now);
    let told = core::iter::from_fn(|| reader.advance(now + HostTime::from_secs(1))).last();
    assert!(
        matches!(told, Some(TextEvent::Noise | TextEvent::Broken)),
        "{told:?}"
    );
}

#[test]
fn what_is_written_stands_between_percents() {
    let bytes = |text, end| TextWriter::new(text, end, BAUD).unwrap().bytes;
    for text in [
        "O0001\nM30\n",
        "%\nO0001\r\nM30\r\n%\r\n",
        "\nO0001\nM30\n%",
    ] {
        assert_eq!(bytes(text, LineEnd::CrLf), b"%\r\nO0001\r\nM30\r\n%\r\n");
        assert_eq!(
            bytes(text, LineEnd::LfCrCr),
            b"%\n\r\rO0001\n\r\rM30\n\r\r%\n\r\r"
        );
    }
    let refused = TextWriter::new("O0001\n(轴)\n", LineEnd::Lf, BAUD).unwrap_err();
    assert_eq!((refused.line, refused.character), (2, '轴'));
}
