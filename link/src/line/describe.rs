//! The traffic as text, for who watches it.

use super::realtime::{CYCLE_START, FEED_HOLD, SOFT_RESET, STATUS_QUERY};

/// The next line, taken from the bytes of one direction that are collected; bytes that
/// are no text are shown as `\\xNN`.
pub(crate) fn next_line(outward: bool, collected: &mut Vec<u8>) -> Option<String> {
    // Characters that act at once stand for themselves.
    let acts =
        |byte: &u8| outward && matches!(*byte, STATUS_QUERY | FEED_HOLD | CYCLE_START | SOFT_RESET);
    loop {
        let end = match collected
            .iter()
            .position(|byte| *byte == b'\n' || acts(byte))?
        {
            0 if acts(&collected[0]) => 1,
            end if acts(&collected[end]) => end,
            end => end + 1,
        };
        let line: Vec<u8> = collected.drain(..end).collect();
        let text = line.iter().filter(|byte| !matches!(byte, b'\n' | b'\r'));
        let text: String = text
            .map(|&byte| match byte {
                b' '..=b'~' => char::from(byte).to_string(),
                _ => format!("\\x{byte:02X}"),
            })
            .collect();
        if !text.is_empty() {
            return Some(text);
        }
    }
}
