//! The drawn caliper: what the pointer is at, with its measures, and the distance
//! between two features.

use std::sync::Arc;

use egui::{Align2, Color32, Context, FontId, Painter, Pos2, Shape, Stroke, Vec2, pos2, vec2};
use gsk_core::units::Point;
use gsk_messages::{Language, Message, say};
use gsk_runner::report::in_words;
use gsk_workpiece::measure::{Feature, MeasuredFeature, SectionSide, measure_with_outlines};
use gsk_workpiece::region::Region;

use super::camera::Camera;
use super::path::nearest_on;
use super::place;
use super::rest::Rest;

/// How near the pointer must be to an edge, points.
const REACH: f32 = 14.0;
/// A part that is being cut is measured that often, s.
const PAUSE: f64 = 0.25;
const MEANT: Color32 = Color32::from_rgb(255, 240, 120);
const KEPT: Color32 = Color32::from_rgb(255, 150, 220);
const JAW: Color32 = Color32::from_rgb(190, 220, 255);
const GROUND: Color32 = Color32::from_rgba_premultiplied(10, 12, 16, 220);
/// How far the jaws stand out over the edge, points.
const JAW_LENGTH: f32 = 26.0;

/// The caliper.
#[derive(Default)]
pub struct Caliper {
    section: Arc<Region>,
    rest: Rest,
    features: Vec<MeasuredFeature>,
    /// The feature under the pointer, and the pointer as the part has it.
    meant: Option<(usize, Pos2)>,
    /// The feature that was clicked.
    kept: Option<MeasuredFeature>,
}

impl Caliper {
    /// Measures the part anew when it has changed.
    pub fn take(&mut self, section: &Arc<Region>, context: &Context) {
        if Arc::ptr_eq(&self.section, section) || !self.rest.is_over(context, PAUSE) {
            return;
        }
        self.section = Arc::clone(section);
        self.meant = None;
        let sides = [SectionSide::Outside, SectionSide::Inside].into_iter();
        self.features = sides
            .flat_map(|side| measure_with_outlines(section, side))
            .collect();
    }

    /// The pointer is there; none: it is elsewhere. Both halves of the picture count.
    pub fn point(&mut self, at: Option<Pos2>, camera: &Camera) {
        self.meant = None;
        let Some(at) = at else { return };
        let folded = pos2(at.x, at.y.abs());
        let reach = REACH / camera.scale;
        let distances = self.features.iter().map(|it| distance(&it.outline, folded));
        let nearest = distances
            .enumerate()
            .min_by(|one, other| one.1.total_cmp(&other.1));
        self.meant = nearest
            .filter(|(_, distance)| *distance <= reach)
            .map(|(index, _)| (index, at));
    }

    /// A click keeps the feature under the pointer, or lets go of the one that was kept.
    pub fn click(&mut self) {
        let meant = self.meant.and_then(|(index, _)| self.features.get(index));
        self.kept = match (meant, self.kept.take()) {
            (Some(meant), Some(kept)) if *meant == kept => None,
            (meant, _) => meant.cloned(),
        };
    }

    /// What is measured: the feature under the pointer, the one that was kept, and the
    /// distance between them.
    pub fn words(&self) -> Vec<Message> {
        let meant = self.meant_feature();
        let hint = say::caliper_hint();
        let mut words = vec![meant.map_or(hint, |it| in_words(&it.feature))];
        if let Some(kept) = &self.kept {
            words.push(say::caliper_from(in_words(&kept.feature)));
            words.extend(meant.and_then(|meant| between(&kept.feature, &meant.feature)));
        }
        words
    }

    fn meant_feature(&self) -> Option<&MeasuredFeature> {
        let (index, _) = self.meant?;
        self.features.get(index)
    }

    /// Draws what is meant and kept, the jaws and the measure.
    pub fn draw(&self, painter: &Painter, camera: &Camera, language: Language) {
        if let Some(kept) = &self.kept {
            trace(painter, camera, &kept.outline, KEPT);
        }
        let (Some(meant), Some((_, at))) = (self.meant_feature(), self.meant) else {
            return;
        };
        trace(painter, camera, &meant.outline, MEANT);
        if let Feature::Cylinder { diameter, z } = meant.feature {
            let z = at.x.clamp(z.0.min(z.1) as f32, z.0.max(z.1) as f32);
            jaws(painter, camera, z, diameter.radius() as f32);
        }
        let words = short(&meant.feature).text(language);
        label(painter, camera.screen(at) + vec2(16.0, -16.0), words);
    }
}

/// The measure beside the pointer.
fn short(feature: &Feature) -> Message {
    match *feature {
        Feature::Cylinder { diameter, .. } => say::caliper_diameter(diameter.0),
        Feature::Face { z, .. } => say::caliper_depth(z),
        Feature::Cone { angle, z, .. } => say::caliper_angle(angle, (z.0 - z.1).abs()),
        Feature::Arc { radius, .. } => say::caliper_radius(radius.abs()),
        Feature::Thread {
            pitch, diameters, ..
        } => say::caliper_pitch(pitch, (diameters.0.0 - diameters.1.0) / 2.0),
    }
}

/// The distance of two features: along Z between faces, across between cylinders.
fn between(from: &Feature, to: &Feature) -> Option<Message> {
    match (*from, *to) {
        (Feature::Face { z: from, .. }, Feature::Face { z: to, .. }) if from != to => {
            Some(say::caliper_length((to - from).abs()))
        }
        (Feature::Cylinder { diameter: from, .. }, Feature::Cylinder { diameter: to, .. })
            if from != to =>
        {
            Some(say::caliper_step((to.0 - from.0).abs() / 2.0))
        }
        _ => None,
    }
}

/// From a point to a line of points, mm.
fn distance(outline: &[Point], at: Pos2) -> f32 {
    let pairs = outline.windows(2);
    let each = pairs.map(|pair| {
        let (a, b) = (place(pair[0]), place(pair[1]));
        (at - nearest_on(a, b, at)).length()
    });
    each.fold(f32::INFINITY, f32::min)
}

/// An outline and its mirror image beyond the axis.
fn trace(painter: &Painter, camera: &Camera, outline: &[Point], color: Color32) {
    for side in [1.0, -1.0] {
        let points = outline.iter().map(|point| {
            let at = place(*point);
            camera.screen(pos2(at.x, at.y * side))
        });
        painter.add(Shape::line(points.collect(), Stroke::new(3.0, color)));
    }
}

/// The jaws of a caliper over a diameter, and the measure's arrows.
fn jaws(painter: &Painter, camera: &Camera, z: f32, radius: f32) {
    let stroke = Stroke::new(1.5, JAW);
    let ends = [1.0, -1.0].map(|side| camera.screen(pos2(z, radius * side)));
    for end in ends {
        let half = vec2(JAW_LENGTH, 0.0);
        painter.line_segment([end - half, end + half], stroke);
    }
    let bar = vec2(JAW_LENGTH, 0.0);
    let way = (ends[1] - ends[0]).normalized();
    for (tip, toward) in [(ends[0], way), (ends[1], -way)] {
        let tip = tip + bar;
        let side = Vec2::new(toward.y, -toward.x) * 4.0;
        let back = tip + toward * 11.0;
        let head = vec![tip, back + side, back - side];
        painter.add(Shape::convex_polygon(head, JAW, Stroke::NONE));
    }
    painter.line_segment([ends[0] + bar, ends[1] + bar], Stroke::new(1.0, JAW));
}

/// Words on a dark ground, kept within the picture.
fn label(painter: &Painter, at: Pos2, words: String) {
    let galley = painter.layout_no_wrap(words, FontId::monospace(16.0), MEANT);
    let place = Align2::LEFT_BOTTOM.anchor_size(at, galley.size());
    let room = painter.clip_rect().shrink(6.0);
    let over = vec2(
        (place.right() - room.right()).max(0.0) - (room.left() - place.left()).max(0.0),
        (place.bottom() - room.bottom()).max(0.0) - (room.top() - place.top()).max(0.0),
    );
    let place = place.translate(-over);
    painter.rect_filled(place.expand2(vec2(6.0, 3.0)), 3.0, GROUND);
    painter.galley(place.min, galley, MEANT);
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::Rect;
    use gsk_workpiece::grid::{GridPoint, grid};

    fn stepped() -> Arc<Region> {
        let corner = |(z, x): (f64, f64)| GridPoint::new(grid(z), grid(x));
        let corners = [
            (-40.0, 0.0),
            (0.0, 0.0),
            (0.0, 10.0),
            (-15.0, 10.0),
            (-15.0, 14.0),
            (-40.0, 14.0),
        ];
        Arc::new(Region::from_contours(&[corners.map(corner).to_vec()]))
    }

    fn camera() -> Camera {
        let room = Rect::from_min_size(Pos2::ZERO, vec2(800.0, 600.0));
        Camera::fit(
            Rect::from_two_pos(pos2(-40.0, -14.0), pos2(0.0, 14.0)),
            true,
            room,
        )
    }

    fn said(caliper: &Caliper) -> String {
        let words = caliper.words();
        let words: Vec<String> = words.iter().map(|it| it.text(Language::En)).collect();
        words.join("\n")
    }

    #[test]
    fn pointing_at_a_diameter_measures_it_on_either_side_of_the_axis() {
        let mut caliper = Caliper::default();
        caliper.take(&stepped(), &Context::default());
        for x in [10.1, -10.1] {
            caliper.point(Some(pos2(-5.0, x)), &camera());
            assert!(said(&caliper).contains("⌀20.000"), "{}", said(&caliper));
        }
        caliper.point(Some(pos2(-5.0, 4.0)), &camera());
        assert!(!said(&caliper).contains("⌀20"), "far from every edge");
    }

    #[test]
    fn two_faces_have_a_length_between_them_and_two_cylinders_a_step() {
        let mut caliper = Caliper::default();
        caliper.take(&stepped(), &Context::default());
        caliper.point(Some(pos2(0.0, 5.0)), &camera());
        caliper.click();
        caliper.point(Some(pos2(-15.0, 12.0)), &camera());
        assert!(said(&caliper).contains("15.000"), "{}", said(&caliper));
        caliper.point(Some(pos2(-5.0, 10.0)), &camera());
        caliper.click();
        caliper.point(Some(pos2(-30.0, 14.0)), &camera());
        assert!(said(&caliper).contains("4.000"), "{}", said(&caliper));
        caliper.click();
        caliper.click();
        assert!(caliper.kept.is_none());
    }
}
