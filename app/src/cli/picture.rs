//! Options of drawings of a toolpath.

use clap::Args;
use gsk_plot::{DrawingOptions, PictureSize};

/// Options of a drawing of a toolpath.
#[derive(Args, Clone, Copy, Debug)]
pub struct PictureArgs {
    /// Size of the picture, pixels [default: 1280x800]
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    pub size: Option<PictureSize>,
    /// Fit the picture to the whole path; without it the cuts fill it and rapids end at its frame
    #[arg(long)]
    pub whole: bool,
    /// Label the end of each block with its N word or, without one, its line number; labels that
    /// would overlap are omitted
    #[arg(long)]
    pub labels: bool,
    /// Write the dimensions of the part: diameters, radii, angles, pitches, and the positions of
    /// its shoulders; draws the part under the path
    #[arg(long)]
    pub dimensions: bool,
    /// Draw each tool at its last cut; draws the part under the path
    #[arg(long)]
    pub tools: bool,
}

impl PictureArgs {
    /// Converts the options to those of the plot package.
    pub fn to_look(self) -> DrawingOptions {
        DrawingOptions {
            size: self.size.unwrap_or_default(),
            shows_whole_path: self.whole,
            labels: self.labels,
            dimensions: self.dimensions,
            tools: self.tools,
        }
    }

    /// Whether one of the options requires the part to be cut for the drawing.
    pub const fn needs_part(self) -> bool {
        self.dimensions || self.tools
    }
}
