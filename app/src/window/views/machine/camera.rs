//! Which piece of the part is seen, and how large: from mm to points of the window.

use egui::{Pos2, Rect, Vec2, pos2, vec2};

/// Points a millimetre, least and most.
const SCALES: (f32, f32) = (0.02, 20_000.0);
/// Room around what is fitted, share of a side.
const MARGIN: f32 = 0.06;

/// The view on the part. Positions of the part: x is Z, y is X as a radius, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// What is seen in the middle.
    pub centre: Pos2,
    /// Points a millimetre.
    pub scale: f32,
    /// X points up: the tool post is behind the spindle.
    pub rear: bool,
    /// Where it is drawn.
    pub room: Rect,
}

impl Camera {
    /// Shows a box whole.
    pub fn fit(bounds: Rect, rear: bool, room: Rect) -> Self {
        let size = bounds.size().max(vec2(1.0, 1.0));
        let free = room.size() * (1.0 - 2.0 * MARGIN);
        let scale = (free.x / size.x).min(free.y / size.y);
        Self {
            centre: bounds.center(),
            scale: scale.clamp(SCALES.0, SCALES.1),
            rear,
            room,
        }
    }

    /// Where a position of the part is drawn.
    pub fn screen(&self, at: Pos2) -> Pos2 {
        self.room.center() + self.turned(at - self.centre) * self.scale
    }

    /// The position of the part that is drawn there.
    pub fn part(&self, at: Pos2) -> Pos2 {
        self.centre + self.turned(at - self.room.center()) / self.scale
    }

    /// X grows away from the operator.
    const fn turned(&self, it: Vec2) -> Vec2 {
        vec2(it.x, if self.rear { -it.y } else { it.y })
    }

    /// Larger or smaller; what is drawn at a place stays there.
    pub fn zoom(&mut self, factor: f32, at: Pos2) {
        let fixed = self.part(at);
        self.scale = (self.scale * factor).clamp(SCALES.0, SCALES.1);
        self.centre += fixed - self.part(at);
    }

    /// Moves the picture by so many points.
    pub fn pan(&mut self, by: Vec2) {
        self.centre -= self.turned(by) / self.scale;
    }

    /// The box of the part that is seen.
    pub fn seen(&self) -> Rect {
        Rect::from_two_pos(self.part(self.room.min), self.part(self.room.max))
    }

    /// Moves as little as brings a position well into the picture.
    pub fn follow(&mut self, at: Pos2) {
        let seen = self.seen();
        let inner = seen.shrink2(seen.size() * 0.2);
        let to = pos2(
            at.x.clamp(inner.left(), inner.right()),
            at.y.clamp(inner.top(), inner.bottom()),
        );
        self.centre += at - to;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(rear: bool) -> Camera {
        let room = Rect::from_min_size(pos2(10.0, 20.0), vec2(400.0, 300.0));
        let bounds = Rect::from_two_pos(pos2(-80.0, -25.0), pos2(2.0, 25.0));
        Camera::fit(bounds, rear, room)
    }

    #[test]
    fn places_go_there_and_back_and_x_points_to_the_tool_post() {
        for rear in [true, false] {
            let mut camera = camera(rear);
            let tip = pos2(-10.0, 20.0);
            assert!((camera.part(camera.screen(tip)) - tip).length() < 1e-3);
            let axis = camera.screen(pos2(-10.0, 0.0));
            assert_eq!(camera.screen(tip).y < axis.y, rear);
            let at = camera.screen(tip);
            camera.zoom(3.0, at);
            assert!((camera.screen(tip) - at).length() < 0.01);
            camera.pan(vec2(30.0, -20.0));
            assert!((camera.screen(tip) - at - vec2(30.0, -20.0)).length() < 0.01);
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
}
