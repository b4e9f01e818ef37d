//! Alarm numbers that the interpreter raises (manual, appendix 3).

pub(crate) const BAD_VALUE: u16 = 2;
pub(crate) const BAD_G: u16 = 10;
pub(crate) const NO_FEED: u16 = 11;
pub(crate) const ARC_DATA: u16 = 13;
pub(crate) const EMPTY_G50: u16 = 14;
pub(crate) const CYCLE_TAPER: u16 = 15;
pub(crate) const BAD_M: u16 = 19;
pub(crate) const NEGATIVE_RADIUS: u16 = 23;
pub(crate) const G_CONFLICT: u16 = 24;
pub(crate) const TOOL_TOO_GREAT: u16 = 29;
pub(crate) const BAD_OFFSET: u16 = 30;
pub(crate) const PROGRAM_MISSING: u16 = 31;
pub(crate) const BAD_TOOL: u16 = 32;
pub(crate) const OUT_OF_RANGE: u16 = 43;
pub(crate) const CALL_WITHOUT_P: u16 = 76;
pub(crate) const CALL_TOO_DEEP: u16 = 77;
pub(crate) const TARGET_MISSING: u16 = 78;
pub(crate) const NOT_REFERENCED: u16 = 90;
