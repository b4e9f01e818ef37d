//! The nose radius microscope: the path as it is programmed, the way of the nose's
//! centre, and how far the surface that comes of it stands off the one that is meant.

use std::sync::Arc;

use egui::{Color32, Context, Painter, Pos2, Shape, Stroke, Ui, pos2};
use gsk_messages::{Language, Message, say};
use gsk_runner::machining::ideal::{Compared, Piece};
use gsk_workpiece::compare::{SurfaceDeviation, deviations};
use gsk_workpiece::job::Job;
use gsk_workpiece::region::Region;

use super::camera::Camera;
use super::path::{Path, nearest_on};
use super::rest::Rest;
use super::{lines, place};

/// A part that is being cut is compared that often, s.
const PAUSE: f64 = 0.3;
/// How near the pointer must be to a line, points.
const REACH: f32 = 24.0;
const RIGHT: Color32 = Color32::from_rgb(90, 215, 110);
/// Material was left.
const LEFT: Color32 = Color32::from_rgb(80, 150, 255);
/// It was cut too deep.
const DEEP: Color32 = Color32::from_rgb(255, 70, 60);
const PROGRAMMED: Color32 = Color32::WHITE;
const CENTERS: Color32 = Color32::from_rgb(200, 130, 255);

/// The surface that is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Surface {
    /// The part in the lathe as it is.
    Now,
    /// The part that comes of the program.
    Finished,
    /// The same without nose radius compensation.
    Uncompensated,
}

impl Surface {
    const ALL: [Self; 3] = [Self::Finished, Self::Uncompensated, Self::Now];

    fn words(self) -> Message {
        match self {
            Self::Now => say::microscope_now(),
            Self::Finished => say::microscope_finished(),
            Self::Uncompensated => say::microscope_uncompensated(),
        }
    }
}

/// What was asked of the worker: for this path and this job.
type Asked = (Arc<Path>, Arc<Job>);

/// The microscope.
pub struct Microscope {
    compared: Option<Arc<Compared>>,
    asked: Option<Asked>,
    surface: Surface,
    /// What is still right, mm.
    tolerance: f64,
    /// The surface and its deviations, and what they were made of.
    found: Vec<Vec<SurfaceDeviation>>,
    made_of: Option<(Arc<Compared>, Surface, Arc<Region>)>,
    rest: Rest,
    pointer: Option<Pos2>,
    /// How near a line must be to it, mm.
    reach: f32,
}

impl Default for Microscope {
    fn default() -> Self {
        Self {
            compared: None,
            asked: None,
            surface: Surface::Finished,
            tolerance: 0.005,
            found: Vec::new(),
            made_of: None,
            rest: Rest::default(),
            pointer: None,
            reach: 0.0,
        }
    }
}

impl Microscope {
    /// Whether the worker must compare for this path and this job; from now on it has
    /// been asked.
    pub fn asks(&mut self, path: &Arc<Path>, job: &Arc<Job>) -> bool {
        let known = self.asked.as_ref();
        if known.is_some_and(|(of, with)| Arc::ptr_eq(of, path) && Arc::ptr_eq(with, job)) {
            return false;
        }
        self.asked = Some((Arc::clone(path), Arc::clone(job)));
        true
    }

    /// The worker has compared.
    pub fn receive(&mut self, compared: Arc<Compared>) {
        self.compared = Some(compared);
    }

    /// Another program: nothing is known of it.
    pub fn clear(&mut self) {
        self.compared = None;
        self.asked = None;
        self.found.clear();
        self.made_of = None;
    }

    /// Finds the deviations of the surface that is looked at.
    pub fn take(&mut self, section: &Arc<Region>, clamped: f64, context: &Context) {
        let Some(compared) = &self.compared else {
            return;
        };
        let same = self.made_of.as_ref().is_some_and(|(of, surface, part)| {
            Arc::ptr_eq(of, compared)
                && *surface == self.surface
                && (*surface != Surface::Now || Arc::ptr_eq(part, section))
        });
        let now = self.surface == Surface::Now;
        if same || (now && !self.rest.is_over(context, PAUSE)) {
            return;
        }
        let surface = match self.surface {
            Surface::Now => section.as_ref(),
            Surface::Finished => &compared.finished,
            Surface::Uncompensated => &compared.uncompensated,
        };
        self.found = deviations(surface, &compared.wanted, clamped);
        self.made_of = Some((Arc::clone(compared), self.surface, Arc::clone(section)));
    }

    /// The pointer is there.
    pub fn point(&mut self, at: Option<Pos2>, camera: &Camera) {
        self.pointer = at;
        self.reach = REACH / camera.scale;
    }

    /// Which surface, what is still right, what the colours mean, and the worst places;
    /// returns one that was clicked. `partial`: the end of the path is not known.
    pub fn bar(&mut self, ui: &mut Ui, partial: bool, language: Language) -> Option<Pos2> {
        let mut meant = None;
        ui.horizontal_wrapped(|ui| {
            for surface in Surface::ALL {
                let words = surface.words().text(language);
                ui.radio_value(&mut self.surface, surface, words);
            }
            ui.separator();
            ui.label(say::microscope_tolerance().text(language));
            let drag = egui::DragValue::new(&mut self.tolerance)
                .range(0.000_1..=1.0)
                .speed(0.000_5)
                .fixed_decimals(4);
            ui.add(drag);
            ui.separator();
            for (color, words) in [
                (PROGRAMMED, say::microscope_programmed()),
                (lines::FEED, say::microscope_tips()),
                (CENTERS, say::microscope_centers()),
                (RIGHT, say::microscope_right()),
                (LEFT, say::microscope_left()),
                (DEEP, say::microscope_deep()),
            ] {
                ui.colored_label(color, words.text(language));
            }
        });
        ui.horizontal_wrapped(|ui| {
            if self.compared.is_none() {
                let words = match partial {
                    true => say::microscope_waits(),
                    false => say::window_one_moment(),
                };
                ui.label(words.text(language));
                return;
            }
            let (deep, left) = self.worst();
            for (worst, color, words) in [
                (
                    deep,
                    DEEP,
                    say::microscope_deepest as fn(_, _, _) -> Message,
                ),
                (left, LEFT, say::microscope_most_left),
            ] {
                let Some(worst) = worst else { continue };
                let (x, z) = (worst.at.diameter().0, worst.at.z);
                let words = words(worst.distance.abs() * 1000.0, x, z).text(language);
                if ui.link(egui::RichText::new(words).color(color)).clicked() {
                    meant = Some(place(worst.at));
                }
            }
            if deep.is_none() && left.is_none() {
                let words = say::microscope_all_right(self.tolerance * 1000.0).text(language);
                ui.colored_label(RIGHT, words);
            }
        });
        // Always a row: what is pointed at must not move.
        let here = self.under_pointer().map_or_else(String::new, |it| {
            let (x, z) = (it.at.diameter().0, it.at.z);
            say::microscope_here(it.distance * 1000.0, x, z).text(language)
        });
        ui.label(egui::RichText::new(here).monospace());
        meant
    }

    /// The deepest cut and the most material left, beyond what is right.
    fn worst(&self) -> (Option<SurfaceDeviation>, Option<SurfaceDeviation>) {
        let all = || self.found.iter().flatten().copied();
        let deepest = all().min_by(|one, other| one.distance.total_cmp(&other.distance));
        let most = all().max_by(|one, other| one.distance.total_cmp(&other.distance));
        let tolerance = self.tolerance;
        (
            deepest.filter(|it| it.distance < -tolerance),
            most.filter(|it| it.distance > tolerance),
        )
    }

    /// The place of the surface nearest to the pointer.
    fn under_pointer(&self) -> Option<SurfaceDeviation> {
        let pointer = self.pointer?;
        let pointer = pos2(pointer.x, pointer.y.abs());
        let distance = |it: &SurfaceDeviation| (place(it.at) - pointer).length();
        let all = self.found.iter().flatten();
        let nearest = all.min_by(|one, other| distance(one).total_cmp(&distance(other)))?;
        (distance(nearest) <= self.reach).then_some(*nearest)
    }

    /// Draws it over the part.
    pub fn draw(&self, painter: &Painter, camera: &Camera) {
        let Some(compared) = &self.compared else {
            return;
        };
        for (pieces, color) in [
            (&compared.programmed, PROGRAMMED),
            (&compared.tips, lines::FEED),
            (&compared.centers, CENTERS),
        ] {
            let stroke = Stroke::new(1.0, color.gamma_multiply(0.6));
            for piece in pieces {
                let ends = piece.ends.map(|end| camera.screen(place(end)));
                painter.line_segment(ends, stroke);
            }
        }
        for outline in &self.found {
            let next = outline.iter().cycle().skip(1);
            for (from, to) in outline.iter().zip(next) {
                let ends = [from, to].map(|it| camera.screen(place(it.at)));
                painter.line_segment(ends, Stroke::new(3.0, self.color(from.distance)));
            }
        }
        if let Some(pointer) = self.pointer
            && let Some((center, nose)) = nearest_center(&compared.centers, pointer)
            && (center - pointer).length() * camera.scale <= REACH + nose * camera.scale
        {
            let at = camera.screen(center);
            let stroke = Stroke::new(1.5, CENTERS);
            painter.add(Shape::circle_stroke(at, nose * camera.scale, stroke));
            painter.circle_filled(at, 2.5, CENTERS);
        }
    }

    fn color(&self, off: f64) -> Color32 {
        match off {
            off if off < -self.tolerance => DEEP,
            off if off > self.tolerance => LEFT,
            _ => RIGHT,
        }
    }
}

/// The place of the nose's centre nearest to a point, and its radius.
fn nearest_center(centers: &[Piece], at: Pos2) -> Option<(Pos2, f32)> {
    let on = |piece: &Piece| {
        let [from, to] = piece.ends.map(place);
        nearest_on(from, to, at)
    };
    let places = centers.iter().map(|piece| (on(piece), piece.nose as f32));
    places.min_by(|one, other| {
        let distance = |it: &(Pos2, f32)| (it.0 - at).length_sq();
        distance(one).total_cmp(&distance(other))
    })
}
