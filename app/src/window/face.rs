//! Draws the faceplate of the panel: one image of it, or of each of its areas, in which only
//! changed parts are repainted.
//!
//! A software renderer pays for every pixel of every layer: painting a hundred parts in each
//! frame takes ten times as long as one image of them all. A thread renders the whole image
//! with the panel's own painter at the size of the window in physical pixels. Until it is
//! finished, the last image is stretched. A key, a lamp or the wheel is repainted into the
//! image when its look changes.

use crossbeam::channel::{Receiver, Sender, TryRecvError, bounded};
use egui::{Color32, ColorImage, Painter, Pos2, Rect, TextureHandle, TextureOptions, Vec2, pos2};
use gsk_panel::faceplate::{self, FaceState, PanelArea, PanelColour, PanelPart, Pixmap};

use super::placing::View;
use super::surroundings::fill_as_it_is;
use crate::platform;

/// The image matches the physical pixels: no filtering.
const DOTS: TextureOptions = TextureOptions::NEAREST;

/// The image of an area and the look of its parts.
struct Picture {
    texture: TextureHandle,
    /// Physical pixels per panel unit.
    scale: f32,
    /// The parts, each with its look in the image.
    looks: Vec<(PanelPart, u32)>,
}

/// Receives the image that a thread renders, with its scale.
type Job = Receiver<(ColorImage, f32)>;

/// An area with its image. The image is rendered again when the size changes.
struct Piece {
    area: PanelArea,
    job: Option<Job>,
    picture: Option<Picture>,
}

/// The images of the panel.
#[derive(Default)]
pub struct Face {
    wanted: bool,
    pieces: Vec<Piece>,
}

impl Face {
    /// Enables the rendering of images. Without it the panel is a plain rectangle.
    pub const fn turn_on(&mut self) {
        self.wanted = true;
    }

    /// Draws the panel without the content of the LCD.
    pub fn paint(&mut self, painter: &Painter, views: &[View], state: &FaceState<'_>) {
        self.pieces
            .retain(|piece| views.iter().any(|view| view.area == piece.area));
        for view in views {
            let known = self.pieces.iter().position(|it| it.area == view.area);
            let index = known.unwrap_or_else(|| {
                self.pieces.push(Piece {
                    area: view.area,
                    job: None,
                    picture: None,
                });
                self.pieces.len() - 1
            });
            if let Some(piece) = self.pieces.get_mut(index) {
                piece.paint(painter, *view, state, self.wanted);
            }
        }
    }
}

impl Piece {
    fn paint(&mut self, painter: &Painter, view: View, state: &FaceState<'_>, wanted: bool) {
        self.collect(painter.ctx());
        let side = painter.ctx().input(|input| input.max_texture_side) as f32;
        let longest = self.area.rect.w.max(self.area.rect.h);
        let scale = (view.scale * view.pixels_per_point).min(side / longest);
        let ready = self.picture.as_ref().map(|picture| picture.scale);
        let same = |ready: f32| pixels(self.area, ready) == pixels(self.area, scale);
        if wanted && self.job.is_none() && !ready.is_some_and(same) {
            self.begin(painter.ctx(), scale);
        }
        let Some(picture) = &mut self.picture else {
            let [red, green, blue] = PanelColour::Housing.rgb();
            let housing = Color32::from_rgb(red, green, blue);
            fill_as_it_is(painter, view.whole(), housing);
            return;
        };
        picture.follow(self.area, state);
        let size = pixels(self.area, picture.scale);
        let place = if size == pixels(self.area, view.scale * view.pixels_per_point) {
            let size = size.map(|side| side as f32 / view.pixels_per_point);
            Rect::from_min_size(view.whole().min, Vec2::from(size))
        } else {
            view.whole()
        };
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        painter.image(picture.texture.id(), place, whole, Color32::WHITE);
    }

    fn begin(&mut self, context: &egui::Context, scale: f32) {
        let (deliver, job) = bounded(1);
        self.job = Some(job);
        let area = self.area;
        let waker = context.clone();
        let outside = deliver.clone();
        let started = platform::beside("faceplate", move || make(area, scale, &outside, &waker));
        if started.is_err() {
            make(area, scale, &deliver, context);
        }
    }

    fn collect(&mut self, context: &egui::Context) {
        let Some(job) = &self.job else { return };
        match job.try_recv() {
            Ok((image, scale)) => {
                let dark = FaceState::default();
                let parts = self.area.parts();
                self.picture = Some(Picture {
                    texture: context.load_texture("panel", image, DOTS),
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

impl Picture {
    /// Repaints the parts whose look has changed.
    fn follow(&mut self, area: PanelArea, state: &FaceState<'_>) {
        for (part, shown) in &mut self.looks {
            let look = faceplate::part_state(part, state);
            if look == *shown {
                continue;
            }
            *shown = look;
            if let Some((piece, at)) = faceplate::paint_part(area, part, state, self.scale) {
                let at = at.map(|side| side as usize);
                self.texture.set_partial(at, image(&piece), DOTS);
            }
        }
    }
}

/// Size of the image of an area at a scale, pixels.
fn pixels(area: PanelArea, scale: f32) -> [u32; 2] {
    [area.rect.w, area.rect.h].map(|units| (units * scale).round().max(1.0) as u32)
}

fn make(area: PanelArea, scale: f32, deliver: &Sender<(ColorImage, f32)>, context: &egui::Context) {
    let Some(picture) = faceplate::paint(area, &FaceState::default(), scale) else {
        return;
    };
    // A window that is closed by now needs no image.
    let _ = deliver.send((image(&picture), scale));
    context.request_repaint();
}

fn image(picture: &Pixmap) -> ColorImage {
    let size = [picture.width() as usize, picture.height() as usize];
    let (dots, _) = picture.data().as_chunks::<4>();
    let dots = dots
        .iter()
        .map(|[r, g, b, a]| Color32::from_rgba_premultiplied(*r, *g, *b, *a));
    ColorImage::new(size, dots.collect())
}
