//! The life of an insert: minutes in the cut for each of its edges.

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// Greatest life of an edge, minutes.
const MAX_MINUTES: f64 = 10_000.0;

/// Minutes in the cut that an edge bears, and those that it has cut.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToolLife {
    /// Minutes in the cut after which an edge is worn.
    pub minutes: f64,
    /// Number of edges of an insert; 1 for a drill.
    #[serde(default = "one_edge")]
    pub edges: u8,
    /// Number of the edge in use, from 1.
    #[serde(default = "one_edge")]
    pub edge: u8,
    /// Minutes in the cut of the edge in use.
    #[serde(default)]
    pub used_minutes: f64,
}

const fn one_edge() -> u8 {
    1
}

impl ToolLife {
    /// A new insert with this many edges.
    pub const fn new(minutes: f64, edges: u8) -> Self {
        Self {
            minutes,
            edges,
            edge: 1,
            used_minutes: 0.0,
        }
    }

    /// Minutes that the edge in use still bears; negative if it is worn.
    pub fn remaining_minutes(&self) -> f64 {
        self.minutes - self.used_minutes
    }

    /// Whether the edge in use is worn.
    pub fn is_used_up(&self) -> bool {
        self.remaining_minutes() <= 0.0
    }

    /// Adds time in the cut, minutes.
    pub fn add_minutes(&mut self, minutes: f64) {
        if minutes.is_finite() && minutes > 0.0 {
            self.used_minutes = (self.used_minutes + minutes).min(10.0 * MAX_MINUTES);
        }
    }

    /// Turns the insert to its next edge; after the last one a new insert is fitted.
    pub const fn turn_edge(&mut self) {
        self.edge = if self.edge >= self.edges {
            1
        } else {
            self.edge + 1
        };
        self.used_minutes = 0.0;
    }

    /// Checks the ranges of the values.
    ///
    /// # Errors
    /// The first value out of range.
    pub fn check(&self) -> Result<(), Message> {
        let in_range = |value: f64, least: f64, most: f64| (least..=most).contains(&value);
        let (edge, edges) = (f64::from(self.edge), f64::from(self.edges));
        if !in_range(self.minutes, 0.1, MAX_MINUTES) {
            let word = say::tool_word_life();
            return Err(say::tool_value_out_of_range(
                word,
                self.minutes,
                0.1,
                MAX_MINUTES,
            ));
        }
        if !in_range(edges, 1.0, 12.0) {
            let word = say::tool_word_edges();
            return Err(say::tool_value_out_of_range(word, edges, 1, 12));
        }
        if !in_range(edge, 1.0, edges) {
            let word = say::tool_word_edge();
            return Err(say::tool_value_out_of_range(word, edge, 1, edges));
        }
        if !in_range(self.used_minutes, 0.0, 10.0 * MAX_MINUTES) {
            let (word, most) = (say::tool_word_used(), 10.0 * MAX_MINUTES);
            return Err(say::tool_value_out_of_range(
                word,
                self.used_minutes,
                0,
                most,
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_wears_and_the_next_one_is_new() {
        let mut life = ToolLife::new(15.0, 2);
        life.add_minutes(14.0);
        assert!(!life.is_used_up());
        life.add_minutes(1.5);
        life.add_minutes(f64::NAN);
        assert_eq!((life.is_used_up(), life.remaining_minutes()), (true, -0.5));
        life.turn_edge();
        assert_eq!((life.edge, life.used_minutes), (2, 0.0));
        life.turn_edge();
        assert_eq!(life.edge, 1, "a new insert");
        life.check().unwrap();
    }

    #[test]
    fn values_out_of_range_are_refused() {
        for life in [
            ToolLife::new(0.0, 4),
            ToolLife::new(f64::NAN, 4),
            ToolLife::new(15.0, 0),
            ToolLife {
                edge: 5,
                ..ToolLife::new(15.0, 4)
            },
            ToolLife {
                used_minutes: -1.0,
                ..ToolLife::new(15.0, 4)
            },
        ] {
            assert!(life.check().is_err(), "{life:?}");
        }
    }
}
