//! Makes an input that shows something smaller.

/// Attempts that a minimisation takes at most.
const ATTEMPTS: u32 = 3000;

/// Leaves out lines, then pieces of lines, as long as `shows` holds.
pub fn minimize(input: &[u8], shows: &mut dyn FnMut(&[u8]) -> bool) -> Vec<u8> {
    let mut left = ATTEMPTS;
    let by_lines = without(input, b'\n', &mut left, shows);
    without(&by_lines, b' ', &mut left, shows)
}

/// Leaves out as many pieces between separators as it can.
fn without(
    input: &[u8],
    separator: u8,
    left: &mut u32,
    shows: &mut dyn FnMut(&[u8]) -> bool,
) -> Vec<u8> {
    let mut pieces: Vec<&[u8]> = input.split_inclusive(|&byte| byte == separator).collect();
    let mut chunk = pieces.len().div_ceil(2);
    while chunk > 0 && *left > 0 {
        let mut at = 0;
        while at < pieces.len() && *left > 0 {
            let end = (at + chunk).min(pieces.len());
            let shorter: Vec<&[u8]> = [&pieces[..at], &pieces[end..]].concat();
            *left -= 1;
            if shows(&shorter.concat()) {
                pieces = shorter;
            } else {
                at = end;
            }
        }
        chunk /= 2;
    }
    pieces.concat()
}
