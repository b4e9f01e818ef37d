//! Draws the part as a lit solid, with its clamping and its collisions.

use gsk_core::units::Point;

use super::PictureError;
use super::canvas::Canvas;
use super::extent::Size;
use super::pens::{ARM, MARK};
use super::png_file;
use crate::machining::Machining;
use crate::solid::{self, Fineness, Turn, View, clamping, part};

/// Margin around the part, units; the texts are in it.
const MARGIN: f64 = 48.0;
/// Distance of the texts from the upper left corner, units.
const EDGE: f64 = 16.0;
/// Background colours at the top and bottom, red, green, blue: metal stands out against them.
const GROUND: [[f32; 3]; 2] = [[250.0, 251.0, 252.0], [206.0, 212.0, 220.0]];
/// Samples across a pixel, for pictures up to this number of pixels.
const SAMPLES: [(usize, usize); 2] = [(3, 4_000_000), (2, 16_000_000)];

/// The current part of a job as the bytes of a PNG file. `rear` means a rear tool post.
///
/// # Errors
/// There is not enough memory.
pub fn of_solid(
    machining: &Machining,
    rear: bool,
    title: &str,
    size: Size,
) -> Result<Vec<u8>, PictureError> {
    let stock = &machining.job().stock;
    let section = machining.scene().part().section();
    let (width, height) = (size.width() as usize, size.height() as usize);
    let unit = f64::from(size.pixels_a_unit());
    let (_, jaws) = stock.chuck_section();
    let shown = [&stock.section(), &jaws, &stock.tailstock_section()];
    let margin = (MARGIN * unit) as f32;
    let view = View::fit(Turn::oblique(rear), shown, (width, height), margin);
    let fineness = Fineness::of(view.scale);
    let mut bodies = part(&section, &stock.section(), fineness).to_vec();
    bodies.extend(clamping(stock, false, fineness));
    let samples = SAMPLES.iter().find(|(_, most)| width * height <= *most);
    let bodies = bodies.iter().map(|body| (body, (0.0, 0.0)));
    let samples = samples.map_or(1, |(samples, _)| *samples);
    let pixels = solid::Canvas::default().draw(bodies, &view, (width, height), samples);
    let mut canvas = Canvas::new(size)?;
    canvas.ground(GROUND);
    canvas.lay(&pixels);
    for finding in machining.findings() {
        let Point { x, z } = finding.collision.contact;
        let at = view.place((z as f32, x as f32), (width, height));
        let (x, y) = (f64::from(at.0) / unit, f64::from(at.1) / unit);
        canvas.line(MARK, (x - ARM, y - ARM), (x + ARM, y + ARM));
        canvas.line(MARK, (x - ARM, y + ARM), (x + ARM, y - ARM));
    }
    canvas.text_over_lines(EDGE, EDGE, title);
    png_file::encode(&canvas.into_pixels())
}
