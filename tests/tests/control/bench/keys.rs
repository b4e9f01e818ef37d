//! Keys of the machine panel.

#![allow(dead_code, reason = "each test presses its own")]

use gsk_core::plc::address::{Area, BitAddress};

pub const AUTO: BitAddress = key(20, 1);
pub const MDI: BitAddress = key(20, 2);
pub const ZERO: BitAddress = key(20, 3);
pub const STEP: BitAddress = key(20, 4);
pub const JOG: BitAddress = key(20, 5);
pub const SINGLE_BLOCK: BitAddress = key(20, 6);
pub const MACHINE_LOCK: BitAddress = key(21, 0);
pub const DRY_RUN: BitAddress = key(21, 2);
/// Selects Z for the handwheel.
pub const WHEEL_Z: BitAddress = key(22, 1);
pub const INCREMENT_100: BitAddress = key(21, 6);
/// Arrows up and down: X-, X+.
pub const X_MINUS: BitAddress = key(22, 3);
pub const X_PLUS: BitAddress = key(23, 1);
/// Arrows left and right: Z-, Z+.
pub const Z_MINUS: BitAddress = key(22, 5);
pub const Z_PLUS: BitAddress = key(22, 7);
/// Manual rapid.
pub const RAPID: BitAddress = key(22, 6);
/// Feed override down.
pub const SLOWER: BitAddress = key(24, 6);
pub const FEED_HOLD: BitAddress = key(24, 7);
pub const CYCLE_START: BitAddress = key(25, 0);
pub const RESET: BitAddress = key(26, 0);

const fn key(byte: u16, bit: u8) -> BitAddress {
    BitAddress {
        area: Area::X,
        byte,
        bit,
    }
}
