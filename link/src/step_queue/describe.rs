//! Formats blocks as text for the log.

use core::fmt::Write;

use super::block::{self, LEAST};
use super::dictionary::Dictionary;

/// Formats a block as its sequence number and messages, by the dictionary `board`. Each byte of an
/// incomplete block becomes `\xNN`. `outward`: the block goes to the board.
pub(super) fn block(board: &Dictionary, outward: bool, bytes: &[u8]) -> String {
    let whole = bytes.len() >= LEAST && usize::from(bytes[0]) == bytes.len();
    let mut text = String::new();
    // Writing to a `String` cannot fail.
    if !whole {
        for byte in bytes {
            let _ = write!(text, "\\x{byte:02X}");
        }
        return text;
    }
    let _ = write!(text, "{:2}", bytes[1] & 0x0F);
    let mut content = &bytes[2..bytes.len() - 3];
    while !content.is_empty() {
        let begin = content;
        match message(board, outward, &mut content) {
            Some(message) => {
                let _ = write!(text, " {message};");
            }
            None => {
                let _ = write!(text, " ?{begin:02X?}");
                break;
            }
        }
    }
    text
}

fn message(board: &Dictionary, outward: bool, content: &mut &[u8]) -> Option<String> {
    let form = board.form(outward, block::decode_vlq(content)?)?;
    let mut words = form.split(' ');
    let mut text = words.next()?.to_owned();
    for word in words {
        let (name, kind) = word.split_once('=')?;
        let _ = match kind {
            "%s" | "%*s" | "%.*s" => {
                let (&count, rest) = content.split_first()?;
                *content = rest.get(usize::from(count)..)?;
                write!(text, " {name}=({count} bytes)")
            }
            "%i" | "%hi" => write!(text, " {name}={}", block::decode_vlq(content)? as i32),
            _ => write!(text, " {name}={}", block::decode_vlq(content)?),
        };
    }
    Some(text)
}

/// Removes the next block, or the invalid bytes before it, from the collected bytes and returns
/// these bytes; `None` if the block is incomplete.
pub(super) fn next_block(collected: &mut Vec<u8>) -> Option<Vec<u8>> {
    let length = usize::from(*collected.first()?);
    if (LEAST..=LEAST + block::CONTENT).contains(&length) {
        return (collected.len() >= length).then(|| collected.drain(..length).collect());
    }
    let end = collected.iter().position(|&byte| byte == 0x7E);
    let end = end.or_else(|| collected.len().checked_sub(2 * length.max(64)))?;
    Some(collected.drain(..=end).collect())
}
