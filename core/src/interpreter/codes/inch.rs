//! Inch input (英制编程 of the setting page): converts the words of a block to mm.
//!
//! Lengths and the feed are inches. Times, counts, angles and threads per inch stay as they
//! are. P and Q of cycles count in 0.0001 inch.

use crate::program::{Block, Number};

/// Converts a block in inches to millimetres. `motion` is the code of group 01 in force before
/// the block.
pub(crate) fn to_metric(block: &mut Block, motion: u8) {
    let dwell = block.has_g(4);
    let motion = block.g_codes().fold(motion, |motion, code| match code {
        0..=3 | 32..=34 | 90 | 92 | 94 => code,
        _ => motion,
    });
    let counted = block.has_g(76) && block.number(b'R').is_some_and(|r| !r.has_point());
    let thread = block.has_g(76) || matches!(motion, 32..=34 | 92);
    // R of G73 is the number of passes, in both of its blocks.
    let passes = block.has_g(73);
    let ends = block.has(b'X') || block.has(b'U') || block.has(b'Z') || block.has(b'W');
    let steps = (block.has_g(74) || block.has_g(75) || block.has_g(76)) && ends;
    // The first block of G76: P is no length, Q is the minimum infeed.
    let least = block.has_g(76);
    block.change(|address, number| match address {
        b'X' | b'U' if dwell => number,
        b'R' if passes => number,
        b'R' if counted => increments(number),
        b'I' if thread => number,
        b'X' | b'U' | b'Z' | b'W' | b'R' | b'I' | b'J' | b'K' | b'F' => number.inches_to_mm(),
        b'P' if steps => increments(number),
        b'Q' if steps || least => increments(number),
        _ => number,
    });
}

/// A count of 0.0001 inch as a count of 0.001 mm.
fn increments(number: Number) -> Number {
    let (count, half) = (number.integer() * 254, 50 * number.integer().signum());
    Number::from_integer((count + half) / 100, number.digits())
}
