//! Draws the part as a lit solid. The solid is built when the part changes and drawn when
//! anything changes. Its edges are smoothed once nothing moves.

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::emath::GuiRounding as _;
use egui::{Color32, ColorImage, Painter, Pos2, Rect, TextureHandle, TextureOptions, pos2, vec2};
use gsk_core::units::Point;
use gsk_runner::solid::{Body, Canvas, Fineness, clamping, part, tool};
use gsk_workpiece::job::Job;
use gsk_workpiece::region::Region;

use super::camera::Camera;
use crate::kernel::part::PartView;

/// Time without a change after which the edges are smoothed, s.
const STILL: f64 = 0.15;
/// Samples across a pixel of the smoothed picture.
const SMOOTH: usize = 2;

/// The solid and its picture.
#[derive(Default)]
pub struct Space {
    bodies: Bodies,
    canvas: Canvas,
    texture: Option<TextureHandle>,
    shown: Option<Shown>,
    /// Time at which the picture was made, seconds of the window's clock.
    since: f64,
    smooth: bool,
}

/// The inputs of a picture. It is made again when one of them changes.
struct Shown {
    camera: Camera,
    section: Arc<Region>,
    job: Arc<Job>,
    /// The chuck is open.
    open: bool,
    tool: u8,
    tip: Point,
    pixels_per_point: f32,
}

impl Shown {
    fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.section, &other.section)
            && Arc::ptr_eq(&self.job, &other.job)
            && self.camera == other.camera
            && (self.tool, self.tip, self.open) == (other.tool, other.tip, other.open)
            && self.pixels_per_point == other.pixels_per_point
    }
}

impl Space {
    /// Draws part, clamping and tool. Returns `false` if the job does not describe the tool.
    pub fn draw(&mut self, painter: &Painter, camera: &Camera, part: &PartView) -> bool {
        let now = painter.ctx().input(|input| input.time);
        let shown = Shown {
            camera: *camera,
            section: Arc::clone(&part.section),
            job: Arc::clone(&part.job),
            open: part.chuck_open,
            tool: part.tool,
            tip: part.tip,
            pixels_per_point: painter.pixels_per_point(),
        };
        let known = self.shown.as_ref();
        if !known.is_some_and(|known| known.is_same(&shown)) {
            self.render(painter, &shown, 1);
            self.shown = Some(shown);
            (self.since, self.smooth) = (now, false);
        } else if !self.smooth && now - self.since >= STILL {
            self.render(painter, &shown, SMOOTH);
            self.smooth = true;
        }
        if !self.smooth {
            let wait = std::time::Duration::from_secs_f64(STILL);
            painter.ctx().request_repaint_after(wait);
        }
        if let Some(texture) = &self.texture {
            let corner = camera.room.min.round_to_pixels(painter.pixels_per_point());
            let size = texture.size_vec2() / painter.pixels_per_point();
            let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
            let place = Rect::from_min_size(corner, size);
            painter.image(texture.id(), place, whole, Color32::WHITE);
        }
        part.job.tools.contains_key(&part.tool)
    }

    fn render(&mut self, painter: &Painter, shown: &Shown, samples: usize) {
        let view = shown.camera.view(shown.pixels_per_point);
        let size = shown.camera.room.size() * shown.pixels_per_point;
        let size = vec2(size.x.round().max(1.0), size.y.round().max(1.0));
        let size = (size.x as usize, size.y as usize);
        self.bodies.take(shown, Fineness::of(view.scale));
        let pixels = self
            .canvas
            .draw(self.bodies.placed(shown), &view, size, samples);
        let pixels = pixels
            .into_iter()
            .map(|[red, green, blue, cover]| {
                Color32::from_rgba_premultiplied(red, green, blue, cover)
            })
            .collect();
        let image = ColorImage::new([size.0, size.1], pixels);
        let options = TextureOptions::NEAREST;
        match &mut self.texture {
            Some(texture) => texture.set(image, options),
            None => self.texture = Some(painter.ctx().load_texture("solid", image, options)),
        }
    }
}

/// The bodies that were built, and their inputs.
#[derive(Default)]
struct Bodies {
    made_of: Option<(Arc<Job>, bool, Fineness)>,
    section: Arc<Region>,
    stock: Region,
    part: Vec<Body>,
    clamps: Vec<Body>,
    /// By T number.
    tools: BTreeMap<u8, Vec<Body>>,
}

impl Bodies {
    fn take(&mut self, shown: &Shown, fineness: Fineness) {
        let made_of = self.made_of.as_ref();
        let same = made_of.is_some_and(|(job, open, made)| {
            Arc::ptr_eq(job, &shown.job) && (*open, *made) == (shown.open, fineness)
        });
        if !same {
            self.made_of = Some((Arc::clone(&shown.job), shown.open, fineness));
            self.stock = shown.job.stock.section();
            self.clamps = clamping(&shown.job.stock, shown.open, fineness);
            self.tools.clear();
        }
        if !same || !Arc::ptr_eq(&self.section, &shown.section) {
            self.section = Arc::clone(&shown.section);
            self.part = part(&self.section, &self.stock, fineness).into();
        }
        if let Some(described) = shown.job.tools.get(&shown.tool) {
            let made = self.tools.entry(shown.tool);
            made.or_insert_with(|| tool(described, fineness));
        }
    }

    /// All bodies with their offsets, Z and X, mm. The tool's offset is its tip.
    fn placed(&self, shown: &Shown) -> impl Iterator<Item = (&Body, (f32, f32))> {
        let fixed = self.part.iter().chain(&self.clamps);
        let tool = self.tools.get(&shown.tool).into_iter().flatten();
        let tip = (shown.tip.z as f32, shown.tip.x as f32);
        let fixed = fixed.map(|body| (body, (0.0, 0.0)));
        fixed.chain(tool.map(move |body| (body, tip)))
    }
}
