//! Colours and line styles. The colours are those of Okabe and Ito, which people with any kind
//! of colour vision can distinguish, without the yellow, which is invisible on white.

use crate::path_pieces::PathLine;

/// The style of a line: colour, width and dashes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinePen {
    /// Red, green and blue of the line, 0 to 255.
    pub color: [u8; 3],
    /// Width of the line, picture units.
    pub width: f32,
    /// Lengths of dash and gap, picture units; empty for a solid line.
    pub dash: &'static [f32],
}

/// Colours for the cuts of the tools: blue, vermilion, green, purple, orange, sky blue, black.
const COLORS: [[u8; 3]; 7] = [
    [0x00, 0x72, 0xB2],
    [0xD5, 0x5E, 0x00],
    [0x00, 0x9E, 0x73],
    [0xCC, 0x79, 0xA7],
    [0xE6, 0x9F, 0x00],
    [0x56, 0xB4, 0xE9],
    [0x00, 0x00, 0x00],
];

/// Dash patterns for the cuts of further tools, used when the colours repeat.
const DASHES: [&[f32]; 3] = [&[], &[14.0, 3.0], &[3.0, 2.0]];

/// Length of each arm of the cross that marks a collision, picture units.
pub(super) const MARK_ARM: f64 = 6.0;
pub(super) const COLLISION_MARK: LinePen = LinePen {
    color: [0xE0, 0x00, 0x20],
    width: 2.5,
    dash: &[],
};

/// The style of the line from a shoulder to its Z value.
pub(super) const DIMENSION: LinePen = LinePen {
    color: [0x60; 3],
    width: 0.8,
    dash: &[],
};

impl LinePen {
    /// Returns the style of a rapid, or of the cuts of a tool.
    pub const fn for_line(made: PathLine) -> Self {
        match made {
            PathLine::Rapid => Self {
                color: [0x90, 0x90, 0x90],
                width: 1.0,
                dash: &[6.0, 4.0],
            },
            PathLine::Cut(index) => {
                let index = index as usize;
                Self {
                    color: COLORS[index % COLORS.len()],
                    width: 2.0,
                    dash: DASHES[index / COLORS.len() % DASHES.len()],
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twenty_tools_can_be_distinguished() {
        let pens: Vec<LinePen> = (0..20)
            .map(|index| LinePen::for_line(PathLine::Cut(index)))
            .collect();
        for (index, pen) in pens.iter().enumerate() {
            assert!(!pens[..index].contains(pen), "{index}");
        }
    }
}
