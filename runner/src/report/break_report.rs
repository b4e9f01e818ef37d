//! A location at which a run was to report, and what it found there.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::Value;

/// A breakpoint that a run has reached.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BreakReport {
    /// The location of the breakpoint as the user wrote it.
    pub location: String,
    /// Machine time from cycle start to the breakpoint, s.
    pub t: f64,
    /// The program of the block: its O number or file; `None` before the first block.
    pub program: Option<String>,
    /// Line of the block at the breakpoint, from 1; `None` before the first block.
    pub line: Option<u32>,
    /// Text of the block at the breakpoint.
    pub block: String,
    /// The calls that lead to the block, the innermost first, as `program:line`.
    pub calls: Vec<String>,
    /// The watched values, by name.
    pub values: BTreeMap<String, Value>,
    /// The reason why the condition of the breakpoint could not be evaluated; `None` if it could.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fault: Option<String>,
}
