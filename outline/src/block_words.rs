//! Writes the blocks of an outline as text, with the words that change from block to block.
//!
//! Numbers always have a decimal point: they mean the same with every setting of parameter
//! 013.

use crate::blocks::{BlockShape, OutlineBlock, OutlineBlocks};

/// A number with a decimal point and at most three decimals.
pub(crate) fn pointed(value: f64) -> String {
    thousandths(libm::round(value * 1000.0) as i64)
}

/// Thousandths as a decimal number with a decimal point.
fn thousandths(value: i64) -> String {
    let sign = if value < 0 { "-" } else { "" };
    let (whole, rest) = (value.unsigned_abs() / 1000, value.unsigned_abs() % 1000);
    let rest = format!("{rest:03}");
    format!("{sign}{whole}.{}", rest.trim_end_matches('0'))
}

fn word(letter: &str, value: i64) -> String {
    format!(" {letter}{}", thousandths(value))
}

const fn arc_code(clockwise: bool) -> &'static str {
    if clockwise { "G02" } else { "G03" }
}

/// The words of the last block, which the next one omits if they do not change.
#[derive(Default)]
struct ModalWords {
    code: &'static str,
    x: Option<i64>,
    z: Option<i64>,
}

impl ModalWords {
    fn write(&mut self, block: &OutlineBlock) -> String {
        let (code, center) = match block.shape {
            BlockShape::Line => ("G01", String::new()),
            BlockShape::Radius { clockwise, r } => (arc_code(clockwise), word("R", r)),
            BlockShape::Center { clockwise, i, k } => {
                let words = [("I", i), ("K", k)].map(|(letter, value)| match value {
                    0 => String::new(),
                    _ => word(letter, value),
                });
                (arc_code(clockwise), words.concat())
            }
        };
        let mut words = String::new();
        if self.code != code {
            words.push_str(code);
            self.code = code;
        }
        for (letter, last, value) in [
            ("X", &mut self.x, block.end.x),
            ("Z", &mut self.z, block.end.z),
        ] {
            if *last != Some(value) {
                words.push_str(&word(letter, value));
                *last = Some(value);
            }
        }
        words.push_str(&center);
        words.trim_start().to_owned()
    }
}

impl OutlineBlocks {
    /// The blocks of the outline alone, from its start. The first block has the feed.
    pub fn contour_lines(&self, feed: &str) -> Vec<String> {
        let mut modal = ModalWords::default();
        let start = OutlineBlock {
            end: self.start,
            shape: BlockShape::Line,
        };
        let first = format!("{} F{feed}", modal.write(&start));
        let rest = self.blocks.iter().map(|block| modal.write(block));
        [first].into_iter().chain(rest).collect()
    }

    /// The blocks between the sequence numbers of a cycle: a rapid along X from the start point
    /// of the cycle, whose Z is that of the start, then the outline. Its first block has the
    /// feed.
    pub fn cycle_lines(&self, (first, last): (u16, u16), feed: &str) -> Vec<String> {
        let mut modal = ModalWords {
            code: "G00",
            x: Some(self.start.x),
            z: Some(self.start.z),
        };
        let mut lines = vec![format!("N{first} G00{}", word("X", self.start.x))];
        for (index, block) in self.blocks.iter().enumerate() {
            let number = match index + 1 == self.blocks.len() {
                true => format!("N{last} "),
                false => String::new(),
            };
            let feed = match index {
                0 => format!(" F{feed}"),
                _ => String::new(),
            };
            lines.push(format!("{number}{}{feed}", modal.write(block)));
        }
        lines
    }
}
