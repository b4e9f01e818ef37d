//! Draws the faceplate of the panel: one image of it, or of each of its areas, in which only
//! changed parts are repainted.
//!
//! A software renderer pays for every pixel of every layer: painting a hundred parts in each
//! frame takes ten times as long as one image of them all. Threads render the images with the
//! panel's own painter at the size of the window in physical pixels, a few areas at a time: on a
//! busy computer all of them together would be late at the same moment. Until an image is
//! finished, the last one is stretched. A key, a lamp or the wheel is repainted into the image
//! when its look changes.

use crossbeam::channel::{Receiver, Sender, TryRecvError, bounded};
use egui::{Color32, ColorImage, Painter, Pos2, Rect, TextureHandle, TextureOptions, Vec2, pos2};
use gsk_core::model::ModelId;
use gsk_host::platform;
use gsk_panel::faceplate::{self, FaceState, PanelArea, PanelPart, PartKind, Pixmap};

use crate::placement::panel_placement::PlacedArea;
use crate::theme;

/// Texture filtering of the images: none, because their pixels match the physical ones.
const PIXEL_EXACT: TextureOptions = TextureOptions::NEAREST;

/// Number of areas that are rendered at the same time.
const MAX_RENDERINGS: usize = 2;

/// The image of an area of the panel, and how its keys and lamps look in the image.
struct AreaImage {
    texture: TextureHandle,
    /// The area as it was stretched for the image.
    area: PanelArea,
    /// The control model whose panel the image shows.
    model: ModelId,
    /// Number of physical pixels per panel unit.
    scale: f32,
    /// The keys and lamps of the area, each with the number of its look in the image.
    looks: Vec<(PanelPart, u32)>,
}

/// An image that a thread has rendered, its area, its model and its scale, physical pixels per
/// panel unit.
type AreaRendering = (ColorImage, PanelArea, ModelId, f32);
/// Receives the image that a background thread renders.
type RenderedImage = Receiver<AreaRendering>;

/// An area of the panel with its image, which is rendered again when its size changes.
struct AreaSlot {
    area: PanelArea,
    /// Number of physical pixels per panel unit that the image should have.
    scale: f32,
    /// Whether the image is missing or has another size, and is not being rendered.
    is_waiting: bool,
    job: Option<RenderedImage>,
    picture: Option<AreaImage>,
}

/// The images of all areas of the panel that are visible.
#[derive(Default)]
pub struct FaceplateImage {
    is_enabled: bool,
    slots: Vec<AreaSlot>,
}

impl FaceplateImage {
    /// Enables the rendering of images. Without images the panel consists of plain shapes.
    pub const fn enable(&mut self) {
        self.is_enabled = true;
    }

    /// Draws the panel except for the content of the LCD.
    pub fn paint(&mut self, painter: &Painter, placed: &[PlacedArea], state: &FaceState<'_>) {
        self.slots
            .retain(|piece| placed.iter().any(|view| view.area.rect == piece.area.rect));
        for view in placed {
            let existing_index = self.slots.iter().position(|it| it.shows(view));
            let index = existing_index.unwrap_or_else(|| {
                self.slots.push(AreaSlot {
                    area: view.area,
                    scale: view.scale,
                    is_waiting: false,
                    job: None,
                    picture: None,
                });
                self.slots.len() - 1
            });
            if let Some(piece) = self.slots.get_mut(index) {
                piece.update(painter.ctx(), *view, state.model);
            }
        }
        if self.is_enabled {
            self.start_renderings(painter.ctx(), state.model);
        }
        for view in placed {
            let piece = self.slots.iter_mut().find(|it| it.shows(view));
            if let Some(piece) = piece {
                piece.paint(painter, *view, state);
            }
        }
    }

    /// Renders the areas whose image is missing or has another size, [`MAX_RENDERINGS`] at a
    /// time: areas without an image first, the largest of them before the others.
    fn start_renderings(&mut self, context: &egui::Context, model: ModelId) {
        let running = self.slots.iter().filter(|it| it.job.is_some()).count();
        let mut waiting: Vec<&mut AreaSlot> =
            self.slots.iter_mut().filter(|it| it.is_waiting).collect();
        waiting.sort_by(|one, other| {
            let has_picture = one.has_picture(model).cmp(&other.has_picture(model));
            has_picture.then(other.size().total_cmp(&one.size()))
        });
        let free = MAX_RENDERINGS.saturating_sub(running);
        for slot in waiting.into_iter().take(free) {
            slot.start_rendering(context, model);
        }
    }
}

impl AreaSlot {
    /// Whether the slot holds the image of a placed area.
    fn shows(&self, view: &PlacedArea) -> bool {
        self.area.rect == view.area.rect
    }

    /// Whether an image of the model's panel exists, of any size.
    fn has_picture(&self, model: ModelId) -> bool {
        self.picture.as_ref().is_some_and(|it| it.model == model)
    }

    /// Size of the area in the window, square pixels.
    fn size(&self) -> f32 {
        let bounds = self.area.bounds();
        bounds.w * bounds.h * self.scale * self.scale
    }

    /// Takes a finished image, and determines whether another one is needed.
    fn update(&mut self, context: &egui::Context, view: PlacedArea, model: ModelId) {
        self.area = view.area;
        self.collect_image(context);
        let side = context.input(|input| input.max_texture_side) as f32;
        let longest = self.area.bounds().w.max(self.area.bounds().h);
        self.scale = (view.scale * view.pixels_per_point).min(side / longest);
        let scale = self.scale;
        let same = |ready: &AreaImage| {
            ready.model == model
                && image_size(ready.area, ready.scale) == image_size(self.area, scale)
                && image_size(PanelArea::WHOLE, ready.scale) == image_size(PanelArea::WHOLE, scale)
        };
        self.is_waiting = self.job.is_none() && !self.picture.as_ref().is_some_and(same);
    }

    fn paint(&mut self, painter: &Painter, view: PlacedArea, state: &FaceState<'_>) {
        let shown = self.picture.as_mut();
        let Some(picture) = shown.filter(|picture| picture.model == state.model) else {
            paint_shapes(painter, view, state.model);
            return;
        };
        picture.repaint_changed_parts(state);
        let size = image_size(picture.area, picture.scale);
        let target = if size == image_size(self.area, view.scale * view.pixels_per_point) {
            let size = size.map(|side| side as f32 / view.pixels_per_point);
            Rect::from_min_size(view.bounds().min, Vec2::from(size))
        } else {
            view.bounds()
        };
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        painter.image(picture.texture.id(), target, whole, theme::NO_TINT);
    }

    fn start_rendering(&mut self, context: &egui::Context, model: ModelId) {
        let (sender, job) = bounded(1);
        self.job = Some(job);
        self.is_waiting = false;
        let (area, scale) = (self.area, self.scale);
        let waker = context.clone();
        let thread_sender = sender.clone();
        let started = platform::run_in_background("faceplate", move || {
            render(area, model, scale, &thread_sender, &waker);
        });
        if started.is_err() {
            render(area, model, scale, &sender, context);
        }
    }

    fn collect_image(&mut self, context: &egui::Context) {
        let Some(job) = &self.job else { return };
        match job.try_recv() {
            Ok((image, area, model, scale)) => {
                let dark = dark(model);
                let parts = area.parts(model);
                self.picture = Some(AreaImage {
                    texture: context.load_texture("panel", image, PIXEL_EXACT),
                    area,
                    model,
                    scale,
                    looks: parts
                        .map(|part| (part, faceplate::part_state(&part, &dark)))
                        .collect(),
                });
            }
            Err(TryRecvError::Empty) => return,
            Err(TryRecvError::Disconnected) => {}
        }
        self.job = None;
    }
}

/// Draws plates and keys as plain shapes, until an image of the area is finished.
fn paint_shapes(painter: &Painter, view: PlacedArea, model: ModelId) {
    for part in view.area.parts(model) {
        let is_shape = match part.what {
            PartKind::Housing | PartKind::Plate | PartKind::Bezel | PartKind::Key(_) => true,
            PartKind::Lcd
            | PartKind::Strip(_)
            | PartKind::Handwheel
            | PartKind::Model
            | PartKind::Text(..)
            | PartKind::Emulator
            | PartKind::RealMotion => false,
        };
        if is_shape {
            let [red, green, blue] = part.colour.rgb();
            let colour = Color32::from_rgb(red, green, blue);
            theme::fill_unthemed(painter, view.to_window(part.rect), colour);
        }
    }
}

impl AreaImage {
    /// Repaints those keys and lamps whose appearance has changed.
    fn repaint_changed_parts(&mut self, state: &FaceState<'_>) {
        for (part, shown_look) in &mut self.looks {
            let look = faceplate::part_state(part, state);
            if look == *shown_look {
                continue;
            }
            *shown_look = look;
            if let Some((piece, at)) = faceplate::paint_part(self.area, part, state, self.scale) {
                let at = at.map(|side| side as usize);
                let size = self.texture.size();
                let free = [0, 1].map(|axis| size[axis].saturating_sub(at[axis]));
                if let Some(image) = crop(to_color_image(&piece), free) {
                    self.texture.set_partial(at, image, PIXEL_EXACT);
                }
            }
        }
    }
}

/// Crops an image to a size, pixels: a key at the edge may be rounded beyond it. `None` if
/// nothing remains.
fn crop(image: ColorImage, [width, height]: [usize; 2]) -> Option<ColorImage> {
    let size = [image.size[0].min(width), image.size[1].min(height)];
    if size.contains(&0) {
        return None;
    }
    if size == image.size {
        return Some(image);
    }
    let rows = image.pixels.chunks_exact(image.size[0]).take(size[1]);
    let pixels = rows.flat_map(|row| row.iter().take(size[0])).copied();
    Some(ColorImage::new(size, pixels.collect()))
}

/// Size of the image of an area at `scale` (pixels per panel unit), pixels.
fn image_size(area: PanelArea, scale: f32) -> [u32; 2] {
    [area.bounds().w, area.bounds().h].map(|units| (units * scale).round().max(1.0) as u32)
}

/// The panel of a model without lit lamps and pressed keys.
fn dark(model: ModelId) -> FaceState<'static> {
    FaceState {
        model,
        ..FaceState::default()
    }
}

fn render(
    area: PanelArea,
    model: ModelId,
    scale: f32,
    sender: &Sender<AreaRendering>,
    context: &egui::Context,
) {
    let Some(picture) = faceplate::paint(area, &dark(model), scale) else {
        return;
    };
    // A window that is closed by now needs no image.
    let _ = sender.send((to_color_image(&picture), area, model, scale));
    context.request_repaint();
}

fn to_color_image(picture: &Pixmap) -> ColorImage {
    let size = [picture.width() as usize, picture.height() as usize];
    let (dots, _) = picture.data().as_chunks::<4>();
    let dots = dots
        .iter()
        .map(|[r, g, b, a]| Color32::from_rgba_premultiplied(*r, *g, *b, *a));
    ColorImage::new(size, dots.collect())
}
