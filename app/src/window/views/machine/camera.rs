//! The camera of the machine view: which section of the part is visible, from which direction
//! and at which scale. Converts mm in the plane of the tools to points of the window and back.

use egui::{Pos2, Rect, Vec2, pos2, vec2};
use gsk_runner::solid::{Turn, View};
use gsk_workpiece::region::Region;

/// Least and greatest scale, points a millimetre.
const SCALES: (f32, f32) = (0.02, 20_000.0);
/// Margin around a fitted picture, as a share of a side.
const MARGIN: f32 = 0.06;
/// Turn of the solid per point that is dragged, degrees.
const DEGREES: f32 = 0.4;

/// What the machine view shows.
#[derive(Default)]
pub struct Sight {
    /// The camera that the user has moved; `None`: the picture shows everything.
    pub camera: Option<Camera>,
    /// The picture follows the tool.
    pub follow: bool,
    /// Shows the part as a solid instead of a half section.
    pub solid: bool,
}

/// The view on the part. Part coordinates: x is Z, y is X as a radius, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The position shown in the middle, part coordinates.
    pub centre: Pos2,
    /// Points a millimetre.
    pub scale: f32,
    /// The rectangle of the window that the picture fills.
    pub room: Rect,
    /// The direction of view.
    turn: Turn,
    /// Directions of Z and X in the window, points per mm at scale 1, y downwards.
    axes: [Vec2; 2],
}

impl Camera {
    /// Shows a whole box, straight from above. `rear`: the tool post is on the far side of the
    /// spindle.
    pub fn fit(bounds: Rect, rear: bool, room: Rect) -> Self {
        let size = bounds.size().max(vec2(1.0, 1.0));
        let free = room.size() * (1.0 - 2.0 * MARGIN);
        let scale = (free.x / size.x).min(free.y / size.y);
        Self::new(bounds.center(), scale, Turn::flat(rear), room)
    }

    /// Shows the solids of half sections whole, at an angle.
    pub fn fit_solid(regions: &[&Region], rear: bool, room: Rect) -> Self {
        let size = (room.width() as usize, room.height() as usize);
        let margin = MARGIN * room.size().min_elem();
        let regions = regions.iter().copied();
        let view = View::fit(Turn::oblique(rear), regions, size, margin);
        Self::new(view.centre.into(), view.scale, view.turn, room)
    }

    fn new(centre: Pos2, scale: f32, turn: Turn, room: Rect) -> Self {
        Self {
            centre,
            scale: scale.clamp(SCALES.0, SCALES.1),
            room,
            turn,
            axes: turn.axes().map(Vec2::from),
        }
    }

    /// The same view in another rectangle.
    #[must_use]
    pub const fn within(self, room: Rect) -> Self {
        Self { room, ..self }
    }

    /// The same view with another position in the middle.
    #[must_use]
    pub const fn centred(self, centre: Pos2) -> Self {
        Self { centre, ..self }
    }

    /// The same view for an image with this number of pixels a point.
    pub fn view(&self, pixels_per_point: f32) -> View {
        View {
            turn: self.turn,
            centre: self.centre.into(),
            scale: self.scale * pixels_per_point,
        }
    }

    /// Converts a position of the part to the window.
    pub fn screen(&self, at: Pos2) -> Pos2 {
        let at = at - self.centre;
        let [z, x] = self.axes;
        self.room.center() + (z * at.x + x * at.y) * self.scale
    }

    /// Converts a position in the window to the part.
    pub fn part(&self, at: Pos2) -> Pos2 {
        self.centre + self.back(at - self.room.center())
    }

    /// Converts a vector from points of the window to mm of the part. The plane of the tools
    /// is never seen from its edge, so the conversion exists.
    fn back(&self, by: Vec2) -> Vec2 {
        let [z, x] = self.axes;
        let all = (z.x * x.y - z.y * x.x) * self.scale;
        vec2(by.x * x.y - by.y * x.x, by.y * z.x - by.x * z.y) / all
    }

    /// Changes the scale. The position drawn at `at` remains there.
    pub fn zoom(&mut self, factor: f32, at: Pos2) {
        let fixed = self.part(at);
        self.scale = (self.scale * factor).clamp(SCALES.0, SCALES.1);
        self.centre += fixed - self.part(at);
    }

    /// Moves the picture by points of the window.
    pub fn pan(&mut self, by: Vec2) {
        self.centre -= self.back(by);
    }

    /// Turns the solid after a drag by `by`, points.
    pub fn orbit(&mut self, by: Vec2) {
        let turn = self.turn.turned(by.x * DEGREES, by.y * DEGREES);
        *self = Self::new(self.centre, self.scale, turn, self.room);
    }

    /// The bounding box of the visible section of the part.
    pub fn seen(&self) -> Rect {
        let Rect { min, max } = self.room;
        let corners = [min, max, pos2(min.x, max.y), pos2(max.x, min.y)];
        Rect::from_points(&corners.map(|corner| self.part(corner)))
    }

    /// Moves the picture by the least distance that brings a position into its inner part.
    pub fn follow(&mut self, at: Pos2) {
        let at = self.screen(at);
        let inner = self.room.shrink2(self.room.size() * 0.2);
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
                let axis = camera.screen(pos2(-10.0, 0.0));
                assert_eq!(camera.screen(tip).y < axis.y, rear);
                camera.orbit(turned);
                assert!((camera.part(camera.screen(tip)) - tip).length() < 1e-3);
                let at = camera.screen(tip);
                camera.zoom(3.0, at);
                assert!((camera.screen(tip) - at).length() < 0.01);
                camera.pan(vec2(30.0, -20.0));
                assert!((camera.screen(tip) - at - vec2(30.0, -20.0)).length() < 0.01);
            }
        }
    }

    #[test]
    fn a_tool_that_leaves_the_picture_is_followed() {
        let mut camera = camera(true);
        let before = camera.centre;
        camera.follow(pos2(-40.0, 0.0));
        assert_eq!(camera.centre, before);
        camera.follow(pos2(300.0, 90.0));
        assert!(camera.seen().contains(pos2(300.0, 90.0)));
    }

    #[test]
    fn lines_lie_on_the_solid_that_is_drawn_below_them() {
        let stock = gsk_workpiece::stock::Stock::bar(50.0, 0.0, 60.0);
        let camera = Camera::fit_solid(&[&stock.section()], true, room());
        let view = camera.view(2.0);
        for tip in [(-10.0, 20.0), (-60.0, -5.0)] {
            let (x, y) = view.place(tip, (800, 600));
            let drawn = room().min + vec2(x, y) / 2.0;
            assert!((camera.screen(tip.into()) - drawn).length() < 0.01);
        }
    }
}
