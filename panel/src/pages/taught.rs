//! Stores points taught by hand, and writes them as a program.

use serde::{Deserialize, Serialize};

/// A program that the operator teaches by moving the axes to its points.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TaughtProgram {
    /// The number under which the program is stored.
    pub program: u16,
    /// Whether the next taught point is reached by rapid traverse (G00) instead of a cut
    /// (G01).
    pub rapid: bool,
    /// The feed of the next cuts (F word), as typed; empty until entered.
    pub feed: String,
    /// The taught points, in the order of execution.
    pub points: Vec<TaughtPoint>,
    /// Whether the page shows the first points instead of the last (命令).
    pub from_first: bool,
}

/// A point to which the operator has moved the tool.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TaughtPoint {
    /// The F word of the G01 to the point, empty without one; `None` for G00.
    pub feed: Option<String>,
    /// The X word of the point as it is written in the program.
    pub x: String,
    /// The Z word of the point as it is written in the program.
    pub z: String,
}

impl Default for TaughtProgram {
    fn default() -> Self {
        Self {
            program: 1,
            rapid: true,
            feed: String::new(),
            points: Vec::new(),
            from_first: false,
        }
    }
}

impl TaughtProgram {
    /// Returns the blocks of the program: sequence number, G0 or G1 and end point. The last
    /// block is M2.
    pub fn blocks(&self) -> Vec<String> {
        let points = (1..).zip(&self.points).map(|(number, point)| {
            let TaughtPoint { feed, x, z } = point;
            match feed {
                None => format!("N{number} G0 X{x} Z{z}"),
                Some(feed) if feed.is_empty() => format!("N{number} G1 X{x} Z{z}"),
                Some(feed) => format!("N{number} G1 X{x} Z{z} F{feed}"),
            }
        });
        let end = format!("N{} M2", self.points.len() + 1);
        points.chain([end]).collect()
    }

    /// Returns the text of the program: its O number and the blocks.
    pub fn text(&self) -> String {
        let mut text = format!("O{:04};\n", self.program);
        for block in self.blocks() {
            text.push_str(&block);
            text.push_str(";\n");
        }
        text
    }
}
