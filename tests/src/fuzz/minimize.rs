//! Minimizes an input that shows a fault.

/// Number of shortened inputs that one minimization tries.
const MAX_ATTEMPTS: u32 = 3000;

/// Returns a shorter input: removes lines, then parts of lines, while `shows` returns true for
/// the rest.
pub fn minimize(input: &[u8], shows: &mut dyn FnMut(&[u8]) -> bool) -> Vec<u8> {
    let mut left = MAX_ATTEMPTS;
    let by_lines = remove_pieces(input, b'\n', &mut left, shows);
    remove_pieces(&by_lines, b' ', &mut left, shows)
}

/// Removes pieces between separators for which `shows` still returns true for the rest.
fn remove_pieces(
    input: &[u8],
    separator: u8,
    remaining_attempts: &mut u32,
    shows: &mut dyn FnMut(&[u8]) -> bool,
) -> Vec<u8> {
    let mut pieces: Vec<&[u8]> = input.split_inclusive(|&byte| byte == separator).collect();
    let mut chunk = pieces.len().div_ceil(2);
    while chunk > 0 && *remaining_attempts > 0 {
        let mut at = 0;
        while at < pieces.len() && *remaining_attempts > 0 {
            let end = (at + chunk).min(pieces.len());
            let shorter: Vec<&[u8]> = [&pieces[..at], &pieces[end..]].concat();
            *remaining_attempts -= 1;
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
