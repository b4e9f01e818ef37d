//! Where the panel lies in the window: whole, or its three areas below each other
//! where a narrow window leaves the whole panel much less room.

use egui::{Pos2, Rect, Vec2, pos2, vec2};
use gsk_panel::faceplate::{self, Area, Part, SIZE};

/// The areas stand apart when that makes the LCD larger at least by this factor.
const WORTH_IT: f32 = 1.15;

/// Where an area of the panel lies in the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// What of the panel it is.
    pub area: Area,
    /// Where the upper left corner of the whole panel would lie, points.
    pub origin: Pos2,
    /// Points a panel unit.
    pub scale: f32,
    /// Physical pixels a point.
    pub pixels_per_point: f32,
}

impl View {
    /// The largest picture of an area that fits into a room, in its middle, on whole
    /// pixels.
    fn fit(area: Area, room: Rect, pixels_per_point: f32) -> Self {
        let faceplate::Rect { x, y, w, h } = area.rect;
        let scale = (room.width() / w).min(room.height() / h).max(0.01);
        let corner = room.center() - vec2(w, h) * scale / 2.0;
        // The picture of the area begins at a whole pixel of the panel, too.
        let snap = |at: f32| (at * pixels_per_point).round() / pixels_per_point;
        Self {
            area,
            origin: pos2(
                snap(corner.x) - snap(x * scale),
                snap(corner.y) - snap(y * scale),
            ),
            scale,
            pixels_per_point,
        }
    }

    /// A rectangle of the panel in the window, its edges on whole pixels.
    pub fn rect(&self, rect: faceplate::Rect) -> Rect {
        let snap = |at: f32| (at * self.pixels_per_point).round() / self.pixels_per_point;
        let x = |units: f32| snap(self.origin.x + units * self.scale);
        let y = |units: f32| snap(self.origin.y + units * self.scale);
        Rect::from_min_max(
            pos2(x(rect.x), y(rect.y)),
            pos2(x(rect.x + rect.w), y(rect.y + rect.h)),
        )
    }

    /// A place of the window in panel units.
    pub fn units(&self, at: Pos2) -> (f32, f32) {
        let from_origin = (at - self.origin) / self.scale;
        (from_origin.x, from_origin.y)
    }

    /// The whole area, points.
    pub fn whole(&self) -> Rect {
        self.rect(self.area.rect)
    }
}

/// The panel in a room: as it is built, or in three areas below each other.
pub fn views(room: Rect, pixels_per_point: f32) -> Vec<View> {
    let whole = View::fit(Area::WHOLE, room, pixels_per_point);
    let Some(apart) = below_each_other(room) else {
        return vec![whole];
    };
    let screen = apart[0].width() / Area::APART[0].rect.w;
    if screen < whole.scale * WORTH_IT {
        return vec![whole];
    }
    let areas = Area::APART.into_iter().zip(apart);
    areas
        .map(|(area, room)| View::fit(area, room, pixels_per_point))
        .collect()
}

/// Rooms for LCD, edit keyboard and machine keys below each other: the machine keys as
/// wide as the room, LCD and edit keyboard alike in what they leave.
fn below_each_other(room: Rect) -> Option<[Rect; 3]> {
    let [screen, keys, machine] = Area::APART.map(|area| vec2(area.rect.w, area.rect.h));
    let width = room.width();
    let together = screen.y + keys.y + machine.y;
    let machine_scale = (width / machine.x).min(room.height() / together);
    let rest = room.height() - machine.y * machine_scale;
    let screen_scale = (width / screen.x).min(rest / (screen.y + keys.y));
    let rest = rest - screen.y * screen_scale;
    let keys_scale = (width / keys.x).min(rest / keys.y);
    let sizes: [Vec2; 3] = [
        screen * screen_scale,
        keys * keys_scale,
        machine * machine_scale,
    ];
    if !sizes.iter().all(|size| size.min_elem() > 1.0) {
        return None;
    }
    let height: f32 = sizes.iter().map(|size| size.y).sum();
    let mut top = room.center().y - height / 2.0;
    Some(sizes.map(|size| {
        let centre = pos2(room.center().x, top + size.y / 2.0);
        top += size.y;
        Rect::from_center_size(centre, size)
    }))
}

/// A place of the window in panel units, if the panel lies there.
pub fn units(views: &[View], at: Pos2) -> Option<(f32, f32)> {
    views.iter().find_map(|view| {
        let (x, y) = view.units(at);
        view.area.rect.contains(x, y).then_some((x, y))
    })
}

/// The view that shows a part.
pub fn of_part<'a>(views: &'a [View], part: &Part) -> Option<&'a View> {
    views.iter().find(|view| view.area.holds(part))
}

/// Points a panel unit of the LCD in a room, were the panel whole.
pub fn whole_scale(room: Vec2) -> f32 {
    (room.x / SIZE.0).min(room.y / SIZE.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_panel::faceplate::{What, parts};

    #[test]
    fn the_panel_fits_and_stands_in_the_middle() {
        for (width, height) in [(1280.0, 756.0), (640.0, 480.0), (3840.0, 800.0)] {
            let room = Rect::from_min_size(pos2(0.0, 26.0), vec2(width, height));
            let views = views(room, 2.0);
            assert_eq!(views.len(), 1);
            let (w, h) = SIZE;
            let whole = views[0].rect(faceplate::Rect::new(0.0, 0.0, w, h));
            assert!(room.expand(0.51).contains_rect(whole), "{whole:?}");
            assert!((whole.center() - room.center()).length() < 1.0);
            let (x, y) = units(&views, whole.center()).unwrap();
            assert!((x - w / 2.0).abs() < 2.0 && (y - h / 2.0).abs() < 2.0);
        }
    }

    #[test]
    fn in_a_narrow_window_the_areas_stand_below_each_other_and_hold_every_part() {
        for (width, height) in [(400.0, 900.0), (800.0, 1230.0), (1080.0, 1870.0)] {
            let room = Rect::from_min_size(pos2(3.0, 28.0), vec2(width, height));
            let views = views(room, 1.0);
            assert_eq!(views.len(), 3, "{width} x {height}");
            let mut bottom = room.top();
            for view in &views {
                let place = view.whole();
                assert!(room.expand(1.01).contains_rect(place), "{place:?}");
                assert!(place.top() >= bottom - 1.01);
                bottom = place.bottom();
            }
            let used: f32 = views.iter().map(|view| view.whole().area()).sum();
            assert!(used > 0.6 * room.area(), "{used} of {}", room.area());
            for part in parts().iter().filter(|part| part.what != What::Housing) {
                let place = of_part(&views, part).unwrap().rect(part.rect);
                let (x, y) = units(&views, place.center()).unwrap();
                assert!(part.rect.contains(x, y), "{part:?}");
            }
        }
    }
}
