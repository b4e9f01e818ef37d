//! The camera of the machine view: which section of the part is visible, from which direction
//! and at which scale. Converts mm in the plane of the tools to points of the window and back.

use std::sync::Arc;

use egui::{Pos2, Rect, Vec2, pos2, vec2};
use gsk_plot::solid::{SolidView, ViewDirection};
use gsk_workpiece::job::Job;
use gsk_workpiece::region::Region;

/// Minimum and maximum scale of the picture, points per millimetre.
const SCALE_LIMITS: (f32, f32) = (0.02, 20_000.0);
/// Margin around a fitted picture, as a share of its side, 0–1.
const MARGIN_SHARE: f32 = 0.06;
/// Angle by which the solid turns per point of a drag, degrees.
const TURN_DEGREES_PER_POINT: f32 = 0.4;

/// The settings of the machine view's picture: scale, position and instrument.
#[derive(Default)]
pub struct PictureState {
    /// The camera that the user has moved; `None` if the picture shows everything.
    pub camera: Option<Camera>,
    /// Position of the tip when the user fitted the picture, which then shows the tool there, too;
    /// part coordinates, mm. `None`: only the tool at the end of the stock.
    pub fitted_tip: Option<Pos2>,
    /// The job of the part, and the box around its tools with their tips at the origin.
    pub tool_bounds: Option<(Arc<Job>, Rect)>,
    /// Whether the picture follows the tool tip.
    pub follows_tool: bool,
    /// True to show the part as a solid, false for a half section.
    pub is_solid: bool,
    /// Whether the user has requested the lathe in space, until the window takes the request.
    pub requests_space: bool,
}

impl PictureState {
    /// Returns to the camera that shows the part with the tool at the end of the stock.
    pub const fn show_whole_part(&mut self) {
        (self.camera, self.fitted_tip) = (None, None);
    }
}

/// Position, scale and direction of the view on the part. Part coordinates: x is Z, y is X as
/// a radius, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The position in the middle of the picture, part coordinates, mm.
    pub centre: Pos2,
    /// Scale of the picture, points per millimetre.
    pub points_per_mm: f32,
    /// The rectangle of the window that the picture fills.
    pub rect: Rect,
    /// The direction from which the part is seen.
    turn: ViewDirection,
    /// Directions of Z and X in the window, points per mm at scale 1, y downwards.
    axes: [Vec2; 2],
}

impl Camera {
    /// Creates a camera that shows the box `bounds` (part coordinates) whole and straight from
    /// above in `rect`. `rear`: the tool post is on the far side of the spindle.
    pub fn fit(bounds: Rect, rear: bool, rect: Rect) -> Self {
        let size = bounds.size().max(vec2(1.0, 1.0));
        let free = rect.size() * (1.0 - 2.0 * MARGIN_SHARE);
        let scale = (free.x / size.x).min(free.y / size.y);
        Self::new(bounds.center(), scale, ViewDirection::flat(rear), rect)
    }

    /// Creates a camera that shows the solids of half sections whole, at an angle, in `rect`.
    pub fn fit_solid(regions: &[&Region], rear: bool, rect: Rect) -> Self {
        let size = (rect.width() as usize, rect.height() as usize);
        let margin = MARGIN_SHARE * rect.size().min_elem();
        let regions = regions.iter().copied();
        let view = SolidView::fit(ViewDirection::oblique(rear), regions, size, margin);
        Self::new(view.centre.into(), view.pixels_per_mm, view.direction, rect)
    }

    fn new(centre: Pos2, scale: f32, turn: ViewDirection, rect: Rect) -> Self {
        Self {
            centre,
            points_per_mm: scale.clamp(SCALE_LIMITS.0, SCALE_LIMITS.1),
            rect,
            turn,
            axes: turn.axes().map(Vec2::from),
        }
    }

    /// Returns the same view in another rectangle of the window.
    #[must_use]
    pub const fn with_rect(self, rect: Rect) -> Self {
        Self { rect, ..self }
    }

    /// Returns the same view with another position, part coordinates, in the middle.
    #[must_use]
    pub const fn with_centre(self, centre: Pos2) -> Self {
        Self { centre, ..self }
    }

    /// Converts the camera to a view for an image with `pixels_per_point` pixels per point.
    pub fn solid_view(&self, pixels_per_point: f32) -> SolidView {
        SolidView {
            direction: self.turn,
            centre: self.centre.into(),
            pixels_per_mm: self.points_per_mm * pixels_per_point,
        }
    }

    /// Converts a position in part coordinates to one in the window, points.
    pub fn screen_position(&self, at: Pos2) -> Pos2 {
        let at = at - self.centre;
        let [z, x] = self.axes;
        self.rect.center() + (z * at.x + x * at.y) * self.points_per_mm
    }

    /// Converts a position in the window, points, to part coordinates.
    pub fn part_position(&self, at: Pos2) -> Pos2 {
        self.centre + self.part_vector(at - self.rect.center())
    }

    /// Converts a vector from points of the window to mm of the part. The view is never along
    /// the plane of the tools, so that the conversion exists.
    fn part_vector(&self, by: Vec2) -> Vec2 {
        let [z, x] = self.axes;
        let determinant = (z.x * x.y - z.y * x.x) * self.points_per_mm;
        vec2(by.x * x.y - by.y * x.x, by.y * z.x - by.x * z.y) / determinant
    }

    /// Multiplies the scale by `factor`. The position drawn at `at` remains there.
    pub fn zoom(&mut self, factor: f32, at: Pos2) {
        let fixed = self.part_position(at);
        self.points_per_mm = (self.points_per_mm * factor).clamp(SCALE_LIMITS.0, SCALE_LIMITS.1);
        self.centre += fixed - self.part_position(at);
    }

    /// Moves the picture by `by`, points of the window.
    pub fn pan(&mut self, by: Vec2) {
        self.centre -= self.part_vector(by);
    }

    /// Turns the solid by a drag of `by`, points of the window.
    pub fn orbit(&mut self, by: Vec2) {
        let turn = self
            .turn
            .turn_by(by.x * TURN_DEGREES_PER_POINT, by.y * TURN_DEGREES_PER_POINT);
        *self = Self::new(self.centre, self.points_per_mm, turn, self.rect);
    }

    /// Returns the bounding box of the visible area, part coordinates, mm.
    pub fn visible_bounds(&self) -> Rect {
        let Rect { min, max } = self.rect;
        let corners = [min, max, pos2(min.x, max.y), pos2(max.x, min.y)];
        Rect::from_points(&corners.map(|corner| self.part_position(corner)))
    }

    /// Moves the picture by the shortest distance that brings the position `at`, part
    /// coordinates, into its inner part.
    pub fn keep_visible(&mut self, at: Pos2) {
        let at = self.screen_position(at);
        let inner = self.rect.shrink2(self.rect.size() * 0.2);
        let to = at.clamp(inner.min, inner.max);
        if to != at {
            self.pan(to - at);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn room() -> Rect {
        Rect::from_min_size(pos2(10.0, 20.0), vec2(400.0, 300.0))
    }

    fn camera(rear: bool) -> Camera {
        let bounds = Rect::from_two_pos(pos2(-80.0, -25.0), pos2(2.0, 25.0));
        Camera::fit(bounds, rear, room())
    }

    #[test]
    fn places_go_there_and_back_and_x_points_to_the_tool_post() {
        for rear in [true, false] {
            for turned in [vec2(0.0, 0.0), vec2(-80.0, 50.0), vec2(900.0, -900.0)] {
                let mut camera = camera(rear);
                let tip = pos2(-10.0, 20.0);
                let axis = camera.screen_position(pos2(-10.0, 0.0));
                assert_eq!(camera.screen_position(tip).y < axis.y, rear);
                camera.orbit(turned);
                assert!((camera.part_position(camera.screen_position(tip)) - tip).length() < 1e-3);
                let at = camera.screen_position(tip);
                camera.zoom(3.0, at);
                assert!((camera.screen_position(tip) - at).length() < 0.01);
                camera.pan(vec2(30.0, -20.0));
                assert!((camera.screen_position(tip) - at - vec2(30.0, -20.0)).length() < 0.01);
            }
        }
    }

    #[test]
    fn a_tool_that_leaves_the_picture_is_followed() {
        let mut camera = camera(true);
        let before = camera.centre;
        camera.keep_visible(pos2(-40.0, 0.0));
        assert_eq!(camera.centre, before);
        camera.keep_visible(pos2(300.0, 90.0));
        assert!(camera.visible_bounds().contains(pos2(300.0, 90.0)));
    }

    #[test]
    fn lines_lie_on_the_solid_that_is_drawn_below_them() {
        let stock = gsk_workpiece::stock::Stock::bar(50.0, 0.0, 60.0);
        let camera = Camera::fit_solid(&[&stock.section()], true, room());
        let view = camera.solid_view(2.0);
        for tip in [(-10.0, 20.0), (-60.0, -5.0)] {
            let (x, y) = view.project(tip, (800, 600));
            let drawn = room().min + vec2(x, y) / 2.0;
            assert!((camera.screen_position(tip.into()) - drawn).length() < 0.01);
        }
    }
}
