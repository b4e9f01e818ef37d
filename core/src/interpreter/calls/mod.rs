//! Calls of subprograms (M98, M99; M, S and T by 006.5; G codes of the Huaxing lathes) and
//! jumps.

pub(super) mod block_call;
pub(super) mod jump;
pub(super) mod special_call;
pub(super) mod subprogram;
