//! Draws the part as a lit solid, with its clamping and its collisions.

use gsk_core::units::Point;

use crate::PictureError;
use crate::canvas::PictureCanvas;
use crate::extent::PictureSize;
use crate::pens::{COLLISION_MARK, MARK_ARM};
use crate::png_file;
use crate::solid::{self, BodyResolution, SolidView, ViewDirection, clamping_bodies, part_bodies};
use gsk_runner::machining::Machining;

/// Margin around the part for its texts, picture units.
const SOLID_MARGIN: f64 = 48.0;
/// Distance of the texts from the upper left corner, picture units.
const TEXT_INSET: f64 = 16.0;
/// Background colours at the top and bottom, red, green, blue: metal contrasts with them.
const BACKGROUND: [[f32; 3]; 2] = [[250.0, 251.0, 252.0], [206.0, 212.0, 220.0]];
/// Number of samples across a pixel, each for pictures up to a number of pixels.
const SAMPLES_BY_PIXELS: [(usize, usize); 2] = [(3, 4_000_000), (2, 16_000_000)];

/// Encodes a 3-D view of the current part of a job as the bytes of a PNG file. `rear` is true
/// for a lathe with a rear tool post.
///
/// # Errors
/// There is not enough memory.
pub fn encode_solid(
    machining: &Machining,
    rear: bool,
    title: &str,
    size: PictureSize,
) -> Result<Vec<u8>, PictureError> {
    let stock = &machining.job().stock;
    let section = machining.scene().part().section();
    let (width, height) = (size.width() as usize, size.height() as usize);
    let unit = f64::from(size.unit_px());
    let (_, jaws) = stock.chuck_section();
    let shown = [&stock.section(), &jaws, &stock.tailstock_section()];
    let margin = (SOLID_MARGIN * unit) as f32;
    let view = SolidView::fit(ViewDirection::oblique(rear), shown, (width, height), margin);
    let fineness = BodyResolution::for_scale(view.pixels_per_mm);
    let mut bodies = part_bodies(&section, &stock.section(), fineness).to_vec();
    bodies.extend(clamping_bodies(stock, false, fineness));
    let samples = SAMPLES_BY_PIXELS
        .iter()
        .find(|(_, most)| width * height <= *most);
    let bodies = bodies.iter().map(|body| (body, (0.0, 0.0)));
    let samples = samples.map_or(1, |(samples, _)| *samples);
    let pixels = solid::SolidCanvas::default().draw(bodies, &view, (width, height), samples);
    let mut canvas = PictureCanvas::new(size)?;
    canvas.fill_gradient(BACKGROUND);
    canvas.blend(&pixels);
    for finding in machining.findings() {
        let Point { x, z } = finding.collision.contact;
        let at = view.project((z as f32, x as f32), (width, height));
        let (x, y) = (f64::from(at.0) / unit, f64::from(at.1) / unit);
        canvas.draw_line(
            COLLISION_MARK,
            (x - MARK_ARM, y - MARK_ARM),
            (x + MARK_ARM, y + MARK_ARM),
        );
        canvas.draw_line(
            COLLISION_MARK,
            (x - MARK_ARM, y + MARK_ARM),
            (x + MARK_ARM, y - MARK_ARM),
        );
    }
    canvas.draw_outlined_text(TEXT_INSET, TEXT_INSET, title);
    png_file::encode(&canvas.into_pixels())
}
