//! The caliper: measures the feature under the pointer, and the distance between two features.

use std::sync::Arc;

use egui::{
    Align2, Color32, Context, FontId, Label, Painter, Pos2, Rect, RichText, Shape, Stroke, Ui,
    Vec2, pos2, vec2,
};
use gsk_core::units::Point;
use gsk_messages::{Language, Message, say};
use gsk_runner::report::feature_message;
use gsk_workpiece::measure::{Feature, MeasuredFeature, SectionSide, measure_with_outlines};
use gsk_workpiece::region::Region;

use super::camera::Camera;
use super::path::nearest_point_on;
use super::repeat_limit::RepeatLimit;
use super::to_pos2;
use crate::theme;

/// Maximum distance of the pointer from an edge to select it, points.
const REACH_POINTS: f32 = 14.0;
/// Minimum interval between two measurements while a part is being cut, s.
const MEASURE_INTERVAL_S: f64 = 0.25;
/// Length by which the drawn jaws extend beyond the edge, points.
const JAW_LENGTH: f32 = 26.0;

/// The caliper, with which the user measures the part in the picture.
#[derive(Default)]
pub struct Caliper {
    section: Arc<Region>,
    repeat_limit: RepeatLimit,
    features: Vec<MeasuredFeature>,
    /// Index of the feature under the pointer, and the pointer in part coordinates; `None` if
    /// there is no feature.
    hovered: Option<(usize, Pos2)>,
    /// The feature that the user has clicked, which stays in the picture; `None` without one.
    kept: Option<MeasuredFeature>,
}

impl Caliper {
    /// Measures the part again if its half section has changed.
    pub fn update(&mut self, section: &Arc<Region>, context: &Context) {
        if Arc::ptr_eq(&self.section, section)
            || !self.repeat_limit.is_due(context, MEASURE_INTERVAL_S)
        {
            return;
        }
        self.section = Arc::clone(section);
        self.hovered = None;
        let sides = [SectionSide::Outside, SectionSide::Inside].into_iter();
        self.features = sides
            .flat_map(|side| measure_with_outlines(section, side))
            .collect();
    }

    /// Sets the pointer's position in part coordinates; `None` if it is outside the picture.
    /// Both halves of the picture count.
    pub fn set_pointer(&mut self, at: Option<Pos2>, camera: &Camera) {
        self.hovered = None;
        let Some(at) = at else { return };
        let folded = pos2(at.x, at.y.abs());
        let reach = REACH_POINTS / camera.points_per_mm;
        let distances = self
            .features
            .iter()
            .map(|it| outline_distance(&it.outline, folded));
        let nearest = distances
            .enumerate()
            .min_by(|one, other| one.1.total_cmp(&other.1));
        self.hovered = nearest
            .filter(|(_, distance)| *distance <= reach)
            .map(|(index, _)| (index, at));
    }

    /// Keeps the feature under the pointer; if that feature is kept already, releases it.
    pub fn toggle_kept(&mut self) {
        let meant = self.hovered.and_then(|(index, _)| self.features.get(index));
        self.kept = match (meant, self.kept.take()) {
            (Some(meant), Some(kept)) if *meant == kept => None,
            (meant, _) => meant.cloned(),
        };
    }

    /// Returns the feature that the user has clicked; `None` without one.
    pub fn kept(&self) -> Option<Feature> {
        self.kept.as_ref().map(|kept| kept.feature)
    }

    /// Describes the measurements: the feature under the pointer, the kept one, and the
    /// distance between them.
    pub fn messages(&self) -> Vec<Message> {
        let meant = self.hovered_feature();
        let hint = say::caliper_hint();
        let mut words = vec![meant.map_or(hint, |it| feature_message(&it.feature))];
        if let Some(kept) = &self.kept {
            words.push(say::caliper_from(feature_message(&kept.feature)));
            words.extend(meant.and_then(|meant| describe_distance(&kept.feature, &meant.feature)));
        }
        words
    }

    /// Writes the measurements into the lower left corner of the picture in `rect`.
    pub fn show_readings(&self, ui: &mut Ui, rect: Rect, language: Language) {
        let messages = self.messages();
        let mut bottom = rect.left_bottom() + vec2(48.0, -22.0);
        for message in messages.iter().rev() {
            let words = RichText::new(message.text(language)).monospace();
            let job = egui::WidgetText::from(words).into_galley(
                ui,
                Some(egui::TextWrapMode::Wrap),
                (rect.right() - bottom.x - 8.0).max(40.0),
                egui::TextStyle::Body,
            );
            let place = Align2::LEFT_BOTTOM.anchor_size(bottom, job.size());
            let ground = place.expand2(vec2(4.0, 1.0));
            ui.painter()
                .rect_filled(ground, 2.0, theme::CALIPER_LABEL_GROUND);
            ui.put(place, Label::new(job));
            bottom.y = place.top() - 3.0;
        }
    }

    fn hovered_feature(&self) -> Option<&MeasuredFeature> {
        let (index, _) = self.hovered?;
        self.features.get(index)
    }

    /// Draws the feature under the pointer, the kept one, the jaws and the measurement.
    pub fn draw(&self, painter: &Painter, camera: &Camera, language: Language) {
        if let Some(kept) = &self.kept {
            draw_outline(painter, camera, &kept.outline, theme::KEPT_MEASUREMENT);
        }
        let (Some(meant), Some((_, at))) = (self.hovered_feature(), self.hovered) else {
            return;
        };
        draw_outline(painter, camera, &meant.outline, theme::MEASURED_FEATURE);
        if let Feature::Cylinder { diameter, z } = meant.feature {
            let z = at.x.clamp(z.0.min(z.1) as f32, z.0.max(z.1) as f32);
            draw_jaws(painter, camera, z, diameter.radius() as f32);
        }
        let words = describe_briefly(&meant.feature).text(language);
        draw_label(
            painter,
            camera.screen_position(at) + vec2(16.0, -16.0),
            words,
        );
    }
}

/// Formats the short measurement that is drawn beside the pointer.
fn describe_briefly(feature: &Feature) -> Message {
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

/// Describes the distance between two features: along Z between faces, along X between
/// cylinders. `None` for other pairs.
fn describe_distance(from: &Feature, to: &Feature) -> Option<Message> {
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

/// Returns the distance from a point to a polyline, mm.
fn outline_distance(outline: &[Point], at: Pos2) -> f32 {
    let pairs = outline.windows(2);
    let each = pairs.map(|pair| {
        let (a, b) = (to_pos2(pair[0]), to_pos2(pair[1]));
        (at - nearest_point_on(a, b, at)).length()
    });
    each.fold(f32::INFINITY, f32::min)
}

/// Draws an outline and its mirror image below the axis.
fn draw_outline(painter: &Painter, camera: &Camera, outline: &[Point], color: Color32) {
    for side in [1.0, -1.0] {
        let points = outline.iter().map(|point| {
            let at = to_pos2(*point);
            camera.screen_position(pos2(at.x, at.y * side))
        });
        painter.add(Shape::line(points.collect(), Stroke::new(3.0, color)));
    }
}

/// Draws the jaws of a caliper at `z` on a cylinder of `radius`, mm, and the arrows of the
/// measurement.
fn draw_jaws(painter: &Painter, camera: &Camera, z: f32, radius: f32) {
    let stroke = Stroke::new(1.5, theme::CALIPER);
    let ends = [1.0, -1.0].map(|side| camera.screen_position(pos2(z, radius * side)));
    for end in ends {
        let half = vec2(JAW_LENGTH, 0.0);
        painter.line_segment([end - half, end + half], stroke);
    }
    let bar = vec2(JAW_LENGTH, 0.0);
    let direction = (ends[1] - ends[0]).normalized();
    for (tip, toward) in [(ends[0], direction), (ends[1], -direction)] {
        let tip = tip + bar;
        let side = Vec2::new(toward.y, -toward.x) * 4.0;
        let back = tip + toward * 11.0;
        let head = vec![tip, back + side, back - side];
        painter.add(Shape::convex_polygon(head, theme::CALIPER, Stroke::NONE));
    }
    painter.line_segment(
        [ends[0] + bar, ends[1] + bar],
        Stroke::new(1.0, theme::CALIPER),
    );
}

/// Draws a text at `at` on a dark background, kept within the picture.
fn draw_label(painter: &Painter, at: Pos2, words: String) {
    let galley = painter.layout_no_wrap(
        words,
        FontId::monospace(theme::LARGE_SIZE),
        theme::MEASURED_FEATURE,
    );
    let rect = Align2::LEFT_BOTTOM.anchor_size(at, galley.size());
    let bounds = painter.clip_rect().shrink(6.0);
    let over = vec2(
        (rect.right() - bounds.right()).max(0.0) - (bounds.left() - rect.left()).max(0.0),
        (rect.bottom() - bounds.bottom()).max(0.0) - (bounds.top() - rect.top()).max(0.0),
    );
    let rect = rect.translate(-over);
    painter.rect_filled(
        rect.expand2(vec2(6.0, 3.0)),
        3.0,
        theme::CALIPER_LABEL_GROUND,
    );
    painter.galley(rect.min, galley, theme::MEASURED_FEATURE);
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

    fn caliper_text(caliper: &Caliper) -> String {
        let words = caliper.messages();
        let words: Vec<String> = words.iter().map(|it| it.text(Language::En)).collect();
        words.join("\n")
    }

    #[test]
    fn pointing_at_a_diameter_measures_it_on_either_side_of_the_axis() {
        let mut caliper = Caliper::default();
        caliper.update(&stepped(), &Context::default());
        for x in [10.1, -10.1] {
            caliper.set_pointer(Some(pos2(-5.0, x)), &camera());
            assert!(
                caliper_text(&caliper).contains("⌀20.000"),
                "{}",
                caliper_text(&caliper)
            );
        }
        caliper.set_pointer(Some(pos2(-5.0, 4.0)), &camera());
        assert!(
            !caliper_text(&caliper).contains("⌀20"),
            "far from every edge"
        );
    }

    #[test]
    fn two_faces_have_a_length_between_them_and_two_cylinders_a_step() {
        let mut caliper = Caliper::default();
        caliper.update(&stepped(), &Context::default());
        caliper.set_pointer(Some(pos2(0.0, 5.0)), &camera());
        caliper.toggle_kept();
        caliper.set_pointer(Some(pos2(-15.0, 12.0)), &camera());
        assert!(
            caliper_text(&caliper).contains("15.000"),
            "{}",
            caliper_text(&caliper)
        );
        caliper.set_pointer(Some(pos2(-5.0, 10.0)), &camera());
        caliper.toggle_kept();
        caliper.set_pointer(Some(pos2(-30.0, 14.0)), &camera());
        assert!(
            caliper_text(&caliper).contains("4.000"),
            "{}",
            caliper_text(&caliper)
        );
        caliper.toggle_kept();
        caliper.toggle_kept();
        assert!(caliper.kept.is_none());
    }
}
