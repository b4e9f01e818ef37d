//! Scans of whole program files for single bytes. Their loops have no branch, so that they
//! vectorize; they are here because packages that are built for size do not vectorize them.

/// Number of bytes that one pass of a search checks.
const CHUNK_BYTES: usize = 64;

/// The index of the first byte that is M, P, S or T or part of a character beyond ASCII, with
/// `g_can_call` also G; `None` without one. No other byte begins the call of a program.
pub fn find_call_candidate(bytes: &[u8], g_can_call: bool) -> Option<usize> {
    let g = if g_can_call { b'g' } else { b'm' };
    let can_call = |byte: &u8| {
        let small = byte | 0x20;
        let letter = small == b'm' || small == b'p' || small == b's' || small == b't';
        letter || small == g || *byte >= 0x80
    };
    let mut from = 0;
    for chunk in bytes.chunks(CHUNK_BYTES) {
        if chunk.iter().fold(false, |any, byte| any | can_call(byte)) {
            break;
        }
        from += chunk.len();
    }
    let rest = bytes.get(from..)?;
    Some(from + rest.iter().position(can_call)?)
}

/// Whether a text has control characters other than tabs and line ends. Most texts have none.
pub fn has_control_characters(text: &[u8]) -> bool {
    let is_control = |byte: u8| byte < b' ' && byte != b'\n' && byte != b'\r' && byte != b'\t';
    (text.iter()).fold(false, |any, byte| any | is_control(*byte))
}
