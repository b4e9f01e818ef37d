//! Draws the part as a lit solid. The solid is built when the part changes and drawn when
//! anything changes. Its edges are smoothed once nothing moves.

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::emath::GuiRounding as _;
use egui::{Color32, ColorImage, Painter, Pos2, Rect, TextureHandle, TextureOptions, pos2, vec2};
use gsk_core::units::Point;
use gsk_host::kernel::part::PartView;
use gsk_plot::solid::{
    BodyResolution, SolidBody, SolidCanvas, clamping_bodies, part_bodies, tool_bodies,
};
use gsk_workpiece::job::Job;
use gsk_workpiece::region::Region;

use super::camera::Camera;
use crate::theme;

/// Time without a change of the picture after which its edges are smoothed, s.
const SMOOTHING_DELAY_S: f64 = 0.15;
/// Number of samples across a pixel of the smoothed picture.
const SMOOTH_SAMPLES: usize = 2;

/// Draws the part as a solid, and keeps the rendered picture.
#[derive(Default)]
pub struct SolidDrawing {
    bodies: SolidBodies,
    canvas: SolidCanvas,
    texture: Option<TextureHandle>,
    drawn_inputs: Option<SolidInputs>,
    /// Time at which the picture was rendered, seconds of the window's clock.
    drawn_at_s: f64,
    is_smooth: bool,
}

/// The inputs of a picture, which is rendered again when one of them changes.
struct SolidInputs {
    camera: Camera,
    section: Arc<Region>,
    job: Arc<Job>,
    /// Whether the jaws of the chuck are open.
    chuck_open: bool,
    tool: u8,
    tip: Point,
    pixels_per_point: f32,
}

impl SolidInputs {
    fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.section, &other.section)
            && Arc::ptr_eq(&self.job, &other.job)
            && self.camera == other.camera
            && (self.tool, self.tip, self.chuck_open) == (other.tool, other.tip, other.chuck_open)
            && self.pixels_per_point == other.pixels_per_point
    }
}

impl SolidDrawing {
    /// Draws part, clamping and tool as solids. Returns `false` if the job does not describe
    /// the tool.
    pub fn draw(&mut self, painter: &Painter, camera: &Camera, part: &PartView) -> bool {
        let now = painter.ctx().input(|input| input.time);
        let inputs = SolidInputs {
            camera: *camera,
            section: Arc::clone(&part.section),
            job: Arc::clone(&part.job),
            chuck_open: part.chuck_open,
            tool: part.tool,
            tip: part.tip,
            pixels_per_point: painter.pixels_per_point(),
        };
        let known = self.drawn_inputs.as_ref();
        if !known.is_some_and(|known| known.is_same(&inputs)) {
            self.render(painter, &inputs, 1);
            self.drawn_inputs = Some(inputs);
            (self.drawn_at_s, self.is_smooth) = (now, false);
        } else if !self.is_smooth && now - self.drawn_at_s >= SMOOTHING_DELAY_S {
            self.render(painter, &inputs, SMOOTH_SAMPLES);
            self.is_smooth = true;
        }
        if !self.is_smooth {
            let wait = std::time::Duration::from_secs_f64(SMOOTHING_DELAY_S);
            painter.ctx().request_repaint_after(wait);
        }
        if let Some(texture) = &self.texture {
            let corner = camera.rect.min.round_to_pixels(painter.pixels_per_point());
            let size = texture.size_vec2() / painter.pixels_per_point();
            let full_uv = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
            let rect = Rect::from_min_size(corner, size);
            painter.image(texture.id(), rect, full_uv, theme::NO_TINT);
        }
        part.job.tools.contains_key(&part.tool)
    }

    fn render(&mut self, painter: &Painter, inputs: &SolidInputs, samples: usize) {
        let view = inputs.camera.solid_view(inputs.pixels_per_point);
        let size = inputs.camera.rect.size() * inputs.pixels_per_point;
        let size = vec2(size.x.round().max(1.0), size.y.round().max(1.0));
        let size = (size.x as usize, size.y as usize);
        self.bodies
            .update(inputs, BodyResolution::for_scale(view.pixels_per_mm));
        let pixels = self
            .canvas
            .draw(self.bodies.positioned(inputs), &view, size, samples);
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

/// The bodies in the picture, and the inputs from which they were built.
#[derive(Default)]
struct SolidBodies {
    built_for: Option<(Arc<Job>, bool, BodyResolution)>,
    section: Arc<Region>,
    stock: Region,
    part: Vec<SolidBody>,
    clamps: Vec<SolidBody>,
    /// The bodies of those tools that were already drawn, by T number.
    tools: BTreeMap<u8, Vec<SolidBody>>,
}

impl SolidBodies {
    fn update(&mut self, inputs: &SolidInputs, fineness: BodyResolution) {
        let made_of = self.built_for.as_ref();
        let same = made_of.is_some_and(|(job, open, made)| {
            Arc::ptr_eq(job, &inputs.job) && (*open, *made) == (inputs.chuck_open, fineness)
        });
        if !same {
            self.built_for = Some((Arc::clone(&inputs.job), inputs.chuck_open, fineness));
            self.stock = inputs.job.stock.section();
            self.clamps = clamping_bodies(&inputs.job.stock, inputs.chuck_open, fineness);
            self.tools.clear();
        }
        if !same || !Arc::ptr_eq(&self.section, &inputs.section) {
            self.section = Arc::clone(&inputs.section);
            self.part = part_bodies(&self.section, &self.stock, fineness).into();
        }
        if let Some(described) = inputs.job.tools.get(&inputs.tool) {
            let made = self.tools.entry(inputs.tool);
            made.or_insert_with(|| tool_bodies(described, fineness));
        }
    }

    /// All bodies of the picture with their offsets, Z and X, mm. The tool's offset is the
    /// position of its tip.
    fn positioned(&self, inputs: &SolidInputs) -> impl Iterator<Item = (&SolidBody, (f32, f32))> {
        let fixed = self.part.iter().chain(&self.clamps);
        let tool = self.tools.get(&inputs.tool).into_iter().flatten();
        let tip = (inputs.tip.z as f32, inputs.tip.x as f32);
        let fixed = fixed.map(|body| (body, (0.0, 0.0)));
        fixed.chain(tool.map(move |body| (body, tip)))
    }
}
