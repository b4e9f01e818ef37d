//! Reads a message of the language server protocol, or of the debug adapter protocol, from a
//! stream.

use std::io::{self, BufRead, ErrorKind, Read as _};

use lsp_server::Message;

/// Length limit of a message, bytes. The largest program with every character escaped is
/// shorter.
const MAX_MESSAGE_BYTES: u64 = 512 * 1024 * 1024;
/// Length limit of a header line, bytes.
const MAX_HEADER_LINE_BYTES: u64 = 4096;
/// Number of characters of a malformed message that an error quotes.
const QUOTED_CHARS: usize = 200;

/// Reads the next message; `None` at the end of the stream. Memory is allocated as bytes
/// arrive, not by the length in the header.
///
/// # Errors
/// A malformed header or message, one that is too long or broken off, and what the stream
/// reports.
pub fn read_message(input: &mut impl BufRead) -> io::Result<Option<Message>> {
    let Some(text) = read_text(input)? else {
        return Ok(None);
    };
    let message = serde_json::from_str(&text).map_err(|error| {
        let start: String = text.chars().take(QUOTED_CHARS).collect();
        invalid_data(format!("malformed LSP payload `{error}`: {start:?}"))
    })?;
    Ok(Some(message))
}

/// Reads the text of the next message; `None` at the end of the stream.
///
/// # Errors
/// A malformed header, a text that is too long, broken off or not UTF-8, and what the stream
/// reports.
pub fn read_text(input: &mut impl BufRead) -> io::Result<Option<String>> {
    let Some(length) = read_header(input)? else {
        return Ok(None);
    };
    if length > MAX_MESSAGE_BYTES {
        return Err(invalid_data(format!(
            "a message of {length} bytes; the longest has {MAX_MESSAGE_BYTES}"
        )));
    }
    let mut bytes = Vec::new();
    input.by_ref().take(length).read_to_end(&mut bytes)?;
    if (bytes.len() as u64) < length {
        return Err(io::Error::from(ErrorKind::UnexpectedEof));
    }
    let text = String::from_utf8(bytes).map_err(|error| invalid_data(error.to_string()))?;
    Ok(Some(text))
}

/// Reads a header and returns the length of the message after it, bytes; `None` at the end of the
/// stream. Returns an error for a wrong header.
fn read_header(input: &mut impl BufRead) -> io::Result<Option<u64>> {
    let mut length = None;
    loop {
        let mut line = Vec::new();
        input
            .by_ref()
            .take(MAX_HEADER_LINE_BYTES)
            .read_until(b'\n', &mut line)?;
        if line.is_empty() {
            return Ok(None);
        }
        let line = String::from_utf8_lossy(&line).into_owned();
        let malformed = || invalid_data(format!("malformed header: {line:?}"));
        let field = line.strip_suffix("\r\n").ok_or_else(malformed)?;
        if field.is_empty() {
            break;
        }
        let (name, value) = field.split_once(": ").ok_or_else(malformed)?;
        if name.eq_ignore_ascii_case("Content-Length") {
            length = Some(value.parse().map_err(|_| malformed())?);
        }
    }
    length
        .map(Some)
        .ok_or_else(|| invalid_data("no Content-Length".to_owned()))
}

fn invalid_data(text: String) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> io::Result<Option<Message>> {
        read_message(&mut io::Cursor::new(bytes))
    }

    #[test]
    fn a_message_is_read() {
        let body = r#"{"jsonrpc":"2.0","method":"exit"}"#;
        let text = format!(
            "Content-Type: x\r\ncontent-length: {}\r\n\r\n{body}",
            body.len()
        );
        let message = read(text.as_bytes()).expect("read").expect("message");
        assert!(matches!(message, Message::Notification(it) if it.method == "exit"));
        assert!(read(b"").expect("end").is_none());
    }

    #[test]
    fn no_length_allocates_or_aborts() {
        for length in [
            "18446744073709551615",
            "99999999999999999999999",
            "9000000000000000000",
            "-1",
            "x",
        ] {
            let text = format!("Content-Length: {length}\r\n\r\n{{}}");
            let error = read(text.as_bytes()).expect_err(length);
            assert_eq!(error.kind(), ErrorKind::InvalidData, "{length}");
        }
        let error = read(b"Content-Length: 500000000\r\n\r\n{}").expect_err("broken off");
        assert_eq!(error.kind(), ErrorKind::UnexpectedEof);
        let long = [b'a'; 10_000];
        assert_eq!(
            read(&long).expect_err("header").kind(),
            ErrorKind::InvalidData
        );
    }
}
