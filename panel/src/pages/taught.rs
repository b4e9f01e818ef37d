//! Stores points taught by hand, and writes them as a program.

use serde::{Deserialize, Serialize};

/// The points taught since power-on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TaughtProgram {
    /// The number of the program.
    pub program: u16,
    /// Whether the next point is reached by G00.
    pub rapid: bool,
    /// The F of cuts as typed.
    pub feed: String,
    /// The points, in order.
    pub points: Vec<TaughtPoint>,
    /// 命令: whether the first points are shown instead of the last.
    pub from_first: bool,
}

/// A taught point.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TaughtPoint {
    /// The F of a G01 to the point. `None` for G00.
    pub feed: Option<String>,
    /// X as programmed.
    pub x: String,
    /// Z as programmed.
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
    /// Returns the blocks of the program: number, G0 or G1 and end point. The last block is M2.
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

    /// Returns the text of the program.
    pub fn text(&self) -> String {
        let mut text = format!("O{:04};\n", self.program);
        for block in self.blocks() {
            text.push_str(&block);
            text.push_str(";\n");
        }
        text
    }
}
