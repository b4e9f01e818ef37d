//! Reads the outline of a turned part from a DXF or SVG drawing and writes the program that
//! turns it.
//!
//! ```text
//! bytes -> Drawing -> TurnedProfile -> OutlineBlocks -> program
//!          lines,     half above the   ends on the      G71 and G70, or the
//!          arcs,      axis, in order,  grid, arcs by    blocks alone
//!          layers     checked          R or I and K
//! ```
//!
//! ```
//! use gsk_outline::{ProfileOptions, ProgramOptions, read_drawing};
//!
//! let svg = br#"<svg><path d="M0 0 V-10 H-20 V-15 H-50 V0 Z"/></svg>"#;
//! let profile = read_drawing(svg)
//!     .and_then(|drawing| drawing.find_profile(&ProfileOptions::default()))
//!     .expect("an outline");
//! assert_eq!(profile.largest_diameter(), 30.0);
//! let program = profile.write_program(&ProgramOptions::default()).expect("a program");
//! assert!(program.contains("N10 G00 X0.\nG01 Z0. F0.1\nX20.\nZ-20.\nX30.\nN20 Z-50.\n"));
//! ```

mod block_words;
mod blocks;
mod chain;
mod crossing;
mod curve_fit;
mod drawing;
mod dxf;
mod half;
mod nose;
mod piece;
mod pocket;
mod profile;
mod program;
mod rules;
mod svg;
#[cfg(test)]
mod tests;

use gsk_messages::{Message, say};

pub use blocks::{ArcFormat, BlockShape, GridEnd, OutlineBlock, OutlineBlocks};
pub use crossing::meeting_points;
pub use drawing::{Drawing, DrawingFault, DrawingFormat, DrawingLayer, DrawingUnit};
pub use nose::{find_gouge, follow_outline};
pub use piece::ProfilePiece;
pub use pocket::{CoveredOutline, cover_pockets};
pub use profile::{DEFAULT_GAP_MM, ProfileOptions, ProfileZero, TurnedProfile};
pub use program::{OutlineFormat, ProgramOptions, RoughingValues};
pub use rules::{CutRule, DirectionFault, ENTERING_DEGREES, end_clearance};

/// Reads a drawing file, DXF or SVG.
///
/// # Errors
/// The bytes are neither, or damaged: the message names the line.
pub fn read_drawing(bytes: &[u8]) -> Result<Drawing, Message> {
    if svg::is_svg(bytes) {
        svg::read(bytes)
    } else if dxf::is_dxf(bytes) {
        dxf::read(bytes)
    } else {
        Err(say::outline_no_drawing())
    }
}
