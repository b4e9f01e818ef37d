//! The faceplate in the window: where it lies, and one ready picture of it, in which
//! only what has changed is painted anew.
//!
//! A software renderer pays for every pixel of every layer: a hundred parts painted
//! anew for each frame cost it ten times as much as one picture of them all. The
//! whole picture is made by the panel's own painter in a thread, at the size of the
//! window in physical pixels; until it is there the last one is stretched. A key, a
//! lamp or the wheel is then painted into it when it looks different.

use std::thread;

use crossbeam::channel::{Receiver, Sender, TryRecvError, bounded};
use egui::{
    Color32, ColorImage, Painter, Pos2, Rect, TextureHandle, TextureOptions, Vec2, pos2, vec2,
};
use gsk_panel::faceplate::{self, Colour, FaceState, Pixmap, SIZE};

/// The picture is made for whole pixels.
const DOTS: TextureOptions = TextureOptions::NEAREST;

/// Where the panel lies in the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Upper left corner of the panel, points.
    pub corner: Pos2,
    /// Points a panel unit.
    pub scale: f32,
    /// Physical pixels a point.
    pub pixels_per_point: f32,
}

impl View {
    /// The largest panel that fits into a room, in its middle, on whole pixels.
    pub fn fit(room: Rect, pixels_per_point: f32) -> Self {
        let (width, height) = SIZE;
        let scale = (room.width() / width).min(room.height() / height).max(0.01);
        let corner = room.center() - vec2(width, height) * scale / 2.0;
        let snap = |at: f32| (at * pixels_per_point).round() / pixels_per_point;
        Self {
            corner: pos2(snap(corner.x), snap(corner.y)),
            scale,
            pixels_per_point,
        }
    }

    /// A rectangle of the panel in the window, its edges on whole pixels.
    pub fn rect(&self, rect: faceplate::Rect) -> Rect {
        let snap = |at: f32| (at * self.pixels_per_point).round() / self.pixels_per_point;
        let x = |units: f32| snap(self.corner.x + units * self.scale);
        let y = |units: f32| snap(self.corner.y + units * self.scale);
        Rect::from_min_max(
            pos2(x(rect.x), y(rect.y)),
            pos2(x(rect.x + rect.w), y(rect.y + rect.h)),
        )
    }

    /// A place of the window in panel units.
    pub fn units(&self, at: Pos2) -> (f32, f32) {
        let way = (at - self.corner) / self.scale;
        (way.x, way.y)
    }

    /// The whole panel, points.
    fn whole(&self) -> Rect {
        Rect::from_min_size(self.corner, vec2(SIZE.0, SIZE.1) * self.scale)
    }
}

/// A picture of the panel and what it shows.
struct Picture {
    texture: TextureHandle,
    /// Physical pixels a panel unit.
    scale: f32,
    /// How each part looks in it, in the order of the parts.
    looks: Vec<u32>,
}

/// The picture of the panel, made anew when the size has changed.
#[derive(Default)]
pub struct Face {
    wanted: bool,
    job: Option<Receiver<(ColorImage, f32)>>,
    picture: Option<Picture>,
}

impl Face {
    /// From now on the picture is made.
    pub const fn turn_on(&mut self) {
        self.wanted = true;
    }

    /// Draws the panel; the LCD's picture is drawn by its owner.
    pub fn paint(&mut self, painter: &Painter, view: View, state: &FaceState<'_>) {
        self.collect(painter.ctx());
        let side = painter.ctx().input(|input| input.max_texture_side) as f32;
        let scale = (view.scale * view.pixels_per_point).min(side / SIZE.0.max(SIZE.1));
        let ready = self.picture.as_ref().map(|picture| picture.scale);
        if self.wanted
            && self.job.is_none()
            && ready.is_none_or(|ready| pixels(ready) != pixels(scale))
        {
            self.begin(painter.ctx(), scale);
        }
        let Some(picture) = &mut self.picture else {
            let [red, green, blue] = Colour::Housing.rgb();
            painter.rect_filled(view.whole(), 0.0, Color32::from_rgb(red, green, blue));
            return;
        };
        picture.follow(state);
        let exact = pixels(picture.scale) == pixels(view.scale * view.pixels_per_point);
        let place = if exact {
            let size = pixels(picture.scale).map(|side| side as f32 / view.pixels_per_point);
            Rect::from_min_size(view.corner, Vec2::from(size))
        } else {
            view.whole()
        };
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        painter.image(picture.texture.id(), place, whole, Color32::WHITE);
    }

    fn begin(&mut self, context: &egui::Context, scale: f32) {
        let (deliver, job) = bounded(1);
        self.job = Some(job);
        let waker = context.clone();
        let outside = deliver.clone();
        let started = thread::Builder::new()
            .name("faceplate".to_owned())
            .spawn(move || make(scale, &outside, &waker));
        if started.is_err() {
            make(scale, &deliver, context);
        }
    }

    fn collect(&mut self, context: &egui::Context) {
        let Some(job) = &self.job else { return };
        match job.try_recv() {
            Ok((image, scale)) => {
                let dark = FaceState::default();
                let looks = faceplate::parts().iter();
                self.picture = Some(Picture {
                    texture: context.load_texture("panel", image, DOTS),
                    scale,
                    looks: looks.map(|part| faceplate::look(part, &dark)).collect(),
                });
            }
            Err(TryRecvError::Empty) => return,
            Err(TryRecvError::Disconnected) => {}
        }
        self.job = None;
    }
}

impl Picture {
    /// Paints the parts that look different now.
    fn follow(&mut self, state: &FaceState<'_>) {
        for (part, shown) in faceplate::parts().iter().zip(&mut self.looks) {
            let look = faceplate::look(part, state);
            if look == *shown {
                continue;
            }
            *shown = look;
            if let Some((piece, at)) = faceplate::paint_part(part, state, self.scale) {
                let at = at.map(|side| side as usize);
                self.texture.set_partial(at, image(&piece), DOTS);
            }
        }
    }
}

/// Size of a picture: two scales are the same if it is the same.
fn pixels(scale: f32) -> [u32; 2] {
    [SIZE.0, SIZE.1].map(|units| (units * scale).round().max(1.0) as u32)
}

fn make(scale: f32, deliver: &Sender<(ColorImage, f32)>, context: &egui::Context) {
    let Some(picture) = faceplate::paint(&FaceState::default(), scale) else {
        return;
    };
    // A window that has been closed meanwhile needs none.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_panel_fits_and_stands_in_the_middle() {
        for (width, height) in [
            (1280.0, 756.0),
            (640.0, 480.0),
            (400.0, 900.0),
            (3840.0, 800.0),
        ] {
            let room = Rect::from_min_size(pos2(0.0, 26.0), vec2(width, height));
            let view = View::fit(room, 2.0);
            let (w, h) = SIZE;
            let whole = view.rect(faceplate::Rect::new(0.0, 0.0, w, h));
            assert!(room.expand(0.51).contains_rect(whole), "{whole:?}");
            assert!((whole.center() - room.center()).length() < 1.0);
            let (x, y) = view.units(whole.center());
            assert!((x - w / 2.0).abs() < 2.0 && (y - h / 2.0).abs() < 2.0);
        }
    }
}
