//! Formats the traffic of line boards as text for the log.

use super::realtime::{CYCLE_START, FEED_HOLD, SOFT_RESET, STATUS_QUERY};

/// Removes the next complete line from the collected bytes of one direction and returns it as text;
/// `None` without one. `outward`: the bytes go to the board, where a real-time character is a line.
/// Bytes that are not printable ASCII become `\xNN`.
pub(crate) fn next_line(outward: bool, collected: &mut Vec<u8>) -> Option<String> {
    // A real-time character is a line without a line end.
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
