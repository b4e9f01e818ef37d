//! The nose radius microscope: the programmed path, the path of the nose's centre, and the
//! deviation of the resulting surface from the intended one.

use std::sync::Arc;

use egui::{Color32, Context, Painter, Pos2, Shape, Stroke, Ui, pos2};
use gsk_messages::{Language, Message, say};
use gsk_runner::machining::part_comparison::{PartComparison, PathPiece};
use gsk_workpiece::compare::{SurfaceDeviation, deviations};
use gsk_workpiece::job::Job;
use gsk_workpiece::region::Region;

use super::camera::Camera;
use super::path::{DrawnPath, nearest_point_on};
use super::repeat_limit::RepeatLimit;
use super::to_pos2;
use crate::theme;

/// Minimum interval between two comparisons while a part is being cut, s.
const COMPARISON_INTERVAL_S: f64 = 0.3;
/// Maximum distance of the pointer from a line to select it, points.
const REACH_POINTS: f32 = 24.0;

/// The surface that is compared with the intended one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ComparedSurface {
    /// The microscope compares the part in the lathe as it is now.
    Now,
    /// The microscope compares the finished part that the program makes.
    Finished,
    /// The finished part that the program makes without tool nose radius compensation.
    Uncompensated,
}

impl ComparedSurface {
    const ALL: [Self; 3] = [Self::Finished, Self::Uncompensated, Self::Now];

    fn label(self) -> Message {
        match self {
            Self::Now => say::microscope_now(),
            Self::Finished => say::microscope_finished(),
            Self::Uncompensated => say::microscope_uncompensated(),
        }
    }
}

/// Path and job of a comparison that the worker carries out.
type ComparisonInputs = (Arc<DrawnPath>, Arc<Job>);

/// The microscope, which shows the deviations of a surface from the intended one.
pub struct Microscope {
    comparison: Option<Arc<PartComparison>>,
    requested: Option<ComparisonInputs>,
    surface: ComparedSurface,
    /// Largest deviation from the intended surface that counts as correct, mm.
    tolerance_mm: f64,
    /// The deviations along each outline of the surface. `computed_from` holds their inputs.
    deviations: Vec<Vec<SurfaceDeviation>>,
    computed_from: Option<(Arc<PartComparison>, ComparedSurface, Arc<Region>)>,
    repeat_limit: RepeatLimit,
    pointer: Option<Pos2>,
    /// Maximum distance of a line from the pointer to be selected, mm.
    reach_mm: f32,
}

impl Default for Microscope {
    fn default() -> Self {
        Self {
            comparison: None,
            requested: None,
            surface: ComparedSurface::Finished,
            tolerance_mm: 0.005,
            deviations: Vec::new(),
            computed_from: None,
            repeat_limit: RepeatLimit::default(),
            pointer: None,
            reach_mm: 0.0,
        }
    }
}

impl Microscope {
    /// Whether the worker must compare for this path and job. If true, records the comparison
    /// as requested.
    pub fn needs_comparison(&mut self, path: &Arc<DrawnPath>, job: &Arc<Job>) -> bool {
        let last_request = self.requested.as_ref();
        if last_request.is_some_and(|(of, with)| Arc::ptr_eq(of, path) && Arc::ptr_eq(with, job)) {
            return false;
        }
        self.requested = Some((Arc::clone(path), Arc::clone(job)));
        true
    }

    /// Stores a comparison that the background thread has finished.
    pub fn set_comparison(&mut self, compared: Arc<PartComparison>) {
        self.comparison = Some(compared);
    }

    /// Discards the comparison, because another program is shown.
    pub fn clear(&mut self) {
        self.comparison = None;
        self.requested = None;
        self.deviations.clear();
        self.computed_from = None;
    }

    /// Computes the deviations of the selected surface if it has changed. `clamped`: Z of the
    /// jaws' front, mm; deviations in the jaws are 0.
    pub fn update_deviations(&mut self, section: &Arc<Region>, clamped: f64, context: &Context) {
        let Some(compared) = &self.comparison else {
            return;
        };
        let same = self
            .computed_from
            .as_ref()
            .is_some_and(|(of, surface, part)| {
                Arc::ptr_eq(of, compared)
                    && *surface == self.surface
                    && (*surface != ComparedSurface::Now || Arc::ptr_eq(part, section))
            });
        let is_current_part = self.surface == ComparedSurface::Now;
        if same || (is_current_part && !self.repeat_limit.is_due(context, COMPARISON_INTERVAL_S)) {
            return;
        }
        let surface = match self.surface {
            ComparedSurface::Now => section.as_ref(),
            ComparedSurface::Finished => &compared.finished,
            ComparedSurface::Uncompensated => &compared.uncompensated,
        };
        self.deviations = deviations(surface, &compared.intended, clamped);
        self.computed_from = Some((Arc::clone(compared), self.surface, Arc::clone(section)));
    }

    /// Sets the pointer's position in part coordinates; `None` if the pointer is outside the
    /// picture.
    pub fn set_pointer(&mut self, at: Option<Pos2>, camera: &Camera) {
        self.pointer = at;
        self.reach_mm = REACH_POINTS / camera.points_per_mm;
    }

    /// Draws the choice of the surface, the tolerance, the legend and the worst positions. Returns
    /// the position, part coordinates, that was clicked; `None` without one. `partial`: the end of
    /// the path is not known.
    pub fn show_bar(&mut self, ui: &mut Ui, partial: bool, language: Language) -> Option<Pos2> {
        let mut clicked = None;
        ui.horizontal_wrapped(|ui| {
            for surface in ComparedSurface::ALL {
                let words = surface.label().text(language);
                ui.radio_value(&mut self.surface, surface, words);
            }
            ui.separator();
            ui.label(say::microscope_tolerance().text(language));
            let drag = egui::DragValue::new(&mut self.tolerance_mm)
                .range(0.000_1..=1.0)
                .speed(0.000_5)
                .fixed_decimals(4);
            ui.add(drag);
            ui.separator();
            for (color, words) in [
                (theme::PROGRAMMED_PATH, say::microscope_programmed()),
                (theme::FEED_PATH, say::microscope_tips()),
                (theme::NOSE_CENTER_PATH, say::microscope_centers()),
                (theme::WITHIN_TOLERANCE, say::microscope_right()),
                (theme::MATERIAL_LEFT, say::microscope_left()),
                (theme::CUT_TOO_DEEP, say::microscope_deep()),
            ] {
                ui.colored_label(color, words.text(language));
            }
        });
        ui.horizontal_wrapped(|ui| {
            if self.comparison.is_none() {
                let words = match partial {
                    true => say::microscope_waits(),
                    false => say::window_one_moment(),
                };
                ui.label(words.text(language));
                return;
            }
            let (deep, left) = self.worst_deviations();
            for (worst, color, words) in [
                (
                    deep,
                    theme::CUT_TOO_DEEP,
                    say::microscope_deepest as fn(_, _, _) -> Message,
                ),
                (left, theme::MATERIAL_LEFT, say::microscope_most_left),
            ] {
                let Some(worst) = worst else { continue };
                let (x, z) = (worst.at.diameter().0, worst.at.z);
                let words = words(worst.distance.abs(), x, z).text(language);
                if ui.link(egui::RichText::new(words).color(color)).clicked() {
                    clicked = Some(to_pos2(worst.at));
                }
            }
            if deep.is_none() && left.is_none() {
                let words = say::microscope_all_right(self.tolerance_mm).text(language);
                ui.colored_label(theme::WITHIN_TOLERANCE, words);
            }
        });
        // Always a row: the picture under the pointer must not move.
        let here = self.deviation_at_pointer().map_or_else(String::new, |it| {
            let (x, z) = (it.at.diameter().0, it.at.z);
            say::microscope_here(it.distance, x, z).text(language)
        });
        ui.label(egui::RichText::new(here).monospace());
        clicked
    }

    /// The deepest undercut and the most remaining material, each `None` if it is within the
    /// tolerance.
    fn worst_deviations(&self) -> (Option<SurfaceDeviation>, Option<SurfaceDeviation>) {
        let all = || self.deviations.iter().flatten().copied();
        let deepest = all().min_by(|one, other| one.distance.total_cmp(&other.distance));
        let most = all().max_by(|one, other| one.distance.total_cmp(&other.distance));
        let tolerance = self.tolerance_mm;
        (
            deepest.filter(|it| it.distance < -tolerance),
            most.filter(|it| it.distance > tolerance),
        )
    }

    /// The deviation at the position on the surface that is nearest to the pointer; `None` out
    /// of reach.
    fn deviation_at_pointer(&self) -> Option<SurfaceDeviation> {
        let pointer = self.pointer?;
        let pointer = pos2(pointer.x, pointer.y.abs());
        let distance = |it: &SurfaceDeviation| (to_pos2(it.at) - pointer).length();
        let all = self.deviations.iter().flatten();
        let nearest = all.min_by(|one, other| distance(one).total_cmp(&distance(other)))?;
        (distance(nearest) <= self.reach_mm).then_some(*nearest)
    }

    /// Draws the paths, the surface in the colours of its deviations, and the tool nose
    /// nearest to the pointer.
    pub fn draw(&self, painter: &Painter, camera: &Camera) {
        let Some(compared) = &self.comparison else {
            return;
        };
        for (pieces, color) in [
            (&compared.programmed_path, theme::PROGRAMMED_PATH),
            (&compared.tip_path, theme::FEED_PATH),
            (&compared.nose_center_path, theme::NOSE_CENTER_PATH),
        ] {
            let stroke = Stroke::new(1.0, theme::microscope_path(color));
            for piece in pieces {
                let ends = piece.ends.map(|end| camera.screen_position(to_pos2(end)));
                painter.line_segment(ends, stroke);
            }
        }
        for outline in &self.deviations {
            let next = outline.iter().cycle().skip(1);
            for (from, to) in outline.iter().zip(next) {
                let ends = [from, to].map(|it| camera.screen_position(to_pos2(it.at)));
                painter.line_segment(ends, Stroke::new(3.0, self.deviation_color(from.distance)));
            }
        }
        if let Some(pointer) = self.pointer
            && let Some((center, nose)) = nearest_center(&compared.nose_center_path, pointer)
            && (center - pointer).length() * camera.points_per_mm
                <= REACH_POINTS + nose * camera.points_per_mm
        {
            let at = camera.screen_position(center);
            let stroke = Stroke::new(1.5, theme::NOSE_CENTER_PATH);
            painter.add(Shape::circle_stroke(
                at,
                nose * camera.points_per_mm,
                stroke,
            ));
            painter.circle_filled(at, 2.5, theme::NOSE_CENTER_PATH);
        }
    }

    fn deviation_color(&self, deviation_mm: f64) -> Color32 {
        match deviation_mm {
            off if off < -self.tolerance_mm => theme::CUT_TOO_DEEP,
            off if off > self.tolerance_mm => theme::MATERIAL_LEFT,
            _ => theme::WITHIN_TOLERANCE,
        }
    }
}

/// The position of the nose's centre nearest to `at`, and the nose radius, mm; `None` if there
/// is no centre.
fn nearest_center(centers: &[PathPiece], at: Pos2) -> Option<(Pos2, f32)> {
    let on = |piece: &PathPiece| {
        let [from, to] = piece.ends.map(to_pos2);
        nearest_point_on(from, to, at)
    };
    let places = centers
        .iter()
        .map(|piece| (on(piece), piece.nose_radius_mm as f32));
    places.min_by(|one, other| {
        let distance = |it: &(Pos2, f32)| (it.0 - at).length_sq();
        distance(one).total_cmp(&distance(other))
    })
}
