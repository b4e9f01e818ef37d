//! The panel as two ready pictures: every key up, and every key down.
//!
//! A software renderer pays for every pixel of every layer; painting the hundred
//! parts anew for each picture costs it ten times as much as one picture of them
//! all. The pictures are made by the panel's own painter in a thread of their own,
//! at the size of the window in physical pixels. Until they are there, and in
//! tests, the parts are painted one by one.

use std::thread;

use crossbeam::channel::{Receiver, Sender, TryRecvError, bounded};
use egui::{Color32, ColorImage, Rect, TextureHandle, TextureOptions, Vec2, pos2};
use gsk_panel::faceplate::{self, FaceState, SIZE};
use gsk_panel::keys::{KEYS, Key};

use super::paint::View;

/// Two scales are the same if the pictures have the same size in pixels.
fn pixels(scale: f32) -> [u32; 2] {
    [SIZE.0, SIZE.1].map(|units| (units * scale).round().max(1.0) as u32)
}

/// A picture of the whole panel.
#[derive(Clone)]
pub struct Sheet {
    texture: TextureHandle,
    /// Physical pixels a panel unit.
    scale: f32,
}

impl Sheet {
    /// Whether it is made for this view, dot by dot.
    pub fn fits(&self, view: View) -> bool {
        pixels(self.scale) == pixels(view.scale * view.pixels_per_point)
    }

    /// Draws the whole panel.
    pub fn paint(&self, painter: &egui::Painter, view: View) {
        let [width, height] = if self.fits(view) {
            pixels(self.scale).map(|side| side as f32 / view.pixels_per_point)
        } else {
            [SIZE.0, SIZE.1].map(|units| view.length(units))
        };
        let place = Rect::from_min_size(view.corner, Vec2::new(width, height));
        self.image(
            painter,
            place,
            Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0)),
        );
    }

    /// Draws what lies in a rectangle of the panel, on whole pixels.
    pub fn paint_part(&self, painter: &egui::Painter, view: View, part: faceplate::Rect) {
        let [width, height] = pixels(self.scale).map(|side| side as f32);
        let snap = |units: f32| (units * self.scale).round();
        let (left, top) = (snap(part.x), snap(part.y));
        let (right, bottom) = (snap(part.x + part.w), snap(part.y + part.h));
        let at = |x: f32, y: f32| view.corner + Vec2::new(x, y) / view.pixels_per_point;
        let place = Rect::from_min_max(at(left, top), at(right, bottom));
        let from = pos2(left / width, top / height);
        self.image(
            painter,
            place,
            Rect::from_min_max(from, pos2(right / width, bottom / height)),
        );
    }

    fn image(&self, painter: &egui::Painter, place: Rect, from: Rect) {
        painter.image(self.texture.id(), place, from, Color32::WHITE);
    }
}

/// What the painting thread delivers.
struct Painted {
    image: ColorImage,
    scale: f32,
    down: bool,
}

/// The two pictures, made anew when the size has changed.
#[derive(Default)]
pub struct Backdrop {
    wanted: bool,
    job: Option<Receiver<Painted>>,
    up: Option<Sheet>,
    down: Option<Sheet>,
}

impl Backdrop {
    /// From now on the pictures are made.
    pub const fn turn_on(&mut self) {
        self.wanted = true;
    }

    /// The picture with every key up, and the one with every key down if it is
    /// ready for this view.
    pub fn sheets(
        &mut self,
        context: &egui::Context,
        view: View,
    ) -> (Option<Sheet>, Option<Sheet>) {
        self.collect(context);
        let ready = |sheet: &Option<Sheet>| sheet.as_ref().is_some_and(|sheet| sheet.fits(view));
        let complete = ready(&self.up) && ready(&self.down);
        if self.wanted && !complete && self.job.is_none() {
            self.begin(context, view);
        }
        (
            self.up.clone(),
            self.down.clone().filter(|sheet| sheet.fits(view)),
        )
    }

    fn begin(&mut self, context: &egui::Context, view: View) {
        let scale = view.scale * view.pixels_per_point;
        let side = pixels(scale).into_iter().max().unwrap_or(0) as usize;
        if side > context.input(|input| input.max_texture_side) {
            self.up = None;
            return;
        }
        let (deliver, job) = bounded(2);
        let context = context.clone();
        let started = thread::Builder::new()
            .name("faceplate".to_owned())
            .spawn(move || make(scale, &deliver, &context));
        // Without a thread the parts are painted one by one, as in a test.
        self.wanted = started.is_ok();
        self.job = started.is_ok().then_some(job);
    }

    fn collect(&mut self, context: &egui::Context) {
        let Some(job) = &self.job else { return };
        loop {
            match job.try_recv() {
                Ok(painted) => {
                    let name = if painted.down { "keys down" } else { "keys up" };
                    let texture =
                        context.load_texture(name, painted.image, TextureOptions::NEAREST);
                    let sheet = Some(Sheet {
                        texture,
                        scale: painted.scale,
                    });
                    if painted.down {
                        self.down = sheet;
                    } else {
                        self.up = sheet;
                    }
                }
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => break,
            }
        }
        self.job = None;
    }
}

fn make(scale: f32, deliver: &Sender<Painted>, context: &egui::Context) {
    let all: Vec<Key> = KEYS.iter().map(|row| row.key).collect();
    for (pressed, down) in [(&[][..], false), (&all[..], true)] {
        let state = FaceState {
            pressed,
            ..FaceState::default()
        };
        let Some(picture) = faceplate::paint(&state, scale) else {
            return;
        };
        let size = [picture.width() as usize, picture.height() as usize];
        let (dots, _) = picture.data().as_chunks::<4>();
        let dots = dots
            .iter()
            .map(|[r, g, b, a]| Color32::from_rgba_premultiplied(*r, *g, *b, *a));
        let image = ColorImage::new(size, dots.collect());
        if deliver.send(Painted { image, scale, down }).is_err() {
            return;
        }
        context.request_repaint();
    }
}
