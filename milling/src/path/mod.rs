//! The path of the tool: arcs, cutter radius and holes become moves with their time and bounds.

pub(crate) mod arc;
pub(crate) mod bounds;
pub(crate) mod cutter;
pub(crate) mod moves;
pub(crate) mod spindle;
pub(crate) mod time;
pub(crate) mod tracker;
pub(crate) mod travel;
