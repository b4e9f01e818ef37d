//! Inch input (英制编程 of the setting page): converts the words of a block to mm.
//!
//! Lengths and the feed are inches. Times, counts, angles and threads per inch stay as they
//! are. P and Q of cycles count in 0.0001 inch.

use super::count_words::CountWords;
use crate::command::MotionCode;
use crate::program::{ProgramBlock, WordNumber};

/// Converts a block in inches to millimetres. `motion` is the code of group 01 in force before
/// the block.
pub(crate) fn convert_to_metric(block: &mut ProgramBlock, motion: MotionCode) {
    let is_dwell = block.has_g(4);
    let counts = CountWords::find(block, motion);
    let is_r_count = block.has_g(76) && block.number(b'R').is_some_and(|r| !r.has_point());
    let has_end = block.has(b'X') || block.has(b'U') || block.has(b'Z') || block.has(b'W');
    let has_steps = (block.has_g(74) || block.has_g(75) || block.has_g(76)) && has_end;
    // The first block of G76: P is no length, Q is the minimum infeed.
    let has_minimum_infeed = block.has_g(76);
    block.map_numbers(|address, number| match address {
        b'X' | b'U' if is_dwell => number,
        _ if counts.has(address) => number,
        b'R' if is_r_count => convert_increments(number),
        b'X' | b'U' | b'Z' | b'W' | b'R' | b'I' | b'J' | b'K' | b'F' => number.inches_to_mm(),
        b'P' if has_steps => convert_increments(number),
        b'Q' if has_steps || has_minimum_infeed => convert_increments(number),
        _ => number,
    });
}

/// Converts a count of 0.0001 inch to a count of 0.001 mm, rounded to the nearest.
fn convert_increments(number: WordNumber) -> WordNumber {
    let (count, half) = (number.integer() * 254, 50 * number.integer().signum());
    WordNumber::from_integer((count + half) / 100, number.digits())
}
