//! Points taught by hand, and the program that they are.

use serde::{Deserialize, Serialize};

/// What is taught since the power came on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Teaching {
    /// The number of the program.
    pub program: u16,
    /// The next point is reached by G00.
    pub rapid: bool,
    /// The F of cuts, as it was keyed in.
    pub feed: String,
    /// The points, in order.
    pub points: Vec<Taught>,
    /// 命令: the first points are shown instead of the last.
    pub from_first: bool,
}

/// One point.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Taught {
    /// Reached by G00; none: by G01 with this F.
    pub feed: Option<String>,
    /// X and Z as the program says them.
    pub x: String,
    /// Z.
    pub z: String,
}

impl Default for Teaching {
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

impl Teaching {
    /// The blocks: a number, G0 or G1, where to; the last one is the end.
    pub fn blocks(&self) -> Vec<String> {
        let points = (1..).zip(&self.points).map(|(number, point)| {
            let Taught { feed, x, z } = point;
            match feed {
                None => format!("N{number} G0 X{x} Z{z}"),
                Some(feed) if feed.is_empty() => format!("N{number} G1 X{x} Z{z}"),
                Some(feed) => format!("N{number} G1 X{x} Z{z} F{feed}"),
            }
        });
        let end = format!("N{} M2", self.points.len() + 1);
        points.chain([end]).collect()
    }

    /// The program.
    pub fn text(&self) -> String {
        let mut text = format!("O{:04};\n", self.program);
        for block in self.blocks() {
            text.push_str(&block);
            text.push_str(";\n");
        }
        text
    }
}
