//! The G, M, S and T codes of single blocks (manual I-3.1 to I-3.2, I-4).

pub(super) mod arc;
pub(super) mod coordinates;
pub(super) mod corner;
pub(super) mod count_words;
pub(super) mod dwell;
pub(super) mod inch;
pub(super) mod miscellaneous;
pub(super) mod nose_radius;
pub(super) mod positioning;
pub(super) mod reference;
pub(super) mod scale;
pub(super) mod spindle_speed;
pub(super) mod start_return;
pub(super) mod tool;
pub(super) mod zero_offset;
