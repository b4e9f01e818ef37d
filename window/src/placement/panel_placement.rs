//! Positions the panel in the window: as a whole, or split into its areas where an upright
//! window leaves the whole panel much less space.

use egui::{Pos2, Rect, Vec2, pos2, vec2};
use gsk_panel::faceplate::{self, PanelArea, PanelPart, SIZE};
use gsk_panel::keys::Key;

/// Minimum side of a key for fingers, points: 9 mm at 96 points per inch.
pub const FINGER_KEY_SIZE: f32 = 9.0 / 25.4 * 96.0;
/// The keys that stop the machine, in their order from the right.
pub const STOP_KEYS: [Key; 3] = [Key::EmergencyStop, Key::FeedHold, Key::Reset];
/// Gap between two stop keys, points.
const STOP_KEY_GAP: f32 = 8.0;
/// Factor by which splitting the panel must enlarge its keys to be used.
const MIN_GAIN: f32 = 1.15;
/// Height divided by width from which the available area counts as upright.
const UPRIGHT_RATIO: f32 = 1.25;
/// Maximum share of the width for the keys beside the LCD, 0–1.
const MAX_SIDE_SHARE: f32 = 0.52;

/// Position and scale of one area of the panel in the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedArea {
    /// The area of the panel that is placed.
    pub area: PanelArea,
    /// Position of the upper left corner of the whole panel at this scale, points.
    pub origin: Pos2,
    /// Points per panel unit.
    pub scale: f32,
    /// Physical pixels per point.
    pub pixels_per_point: f32,
}

impl PlacedArea {
    /// Places an area in `bounds`: as large as possible, centred, on whole pixels.
    fn fit(area: PanelArea, bounds: Rect, pixels_per_point: f32) -> Self {
        let faceplate::Rect { x, y, w, h } = area.rect;
        let scale = (bounds.width() / w).min(bounds.height() / h).max(0.01);
        let corner = bounds.center() - vec2(w, h) * scale / 2.0;
        // The area also begins at a whole pixel of the panel.
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

    /// Converts a rectangle of the panel to window points, with its edges on whole pixels.
    pub fn to_window(self, rect: faceplate::Rect) -> Rect {
        let snap = |at: f32| (at * self.pixels_per_point).round() / self.pixels_per_point;
        let x = |units: f32| snap(self.origin.x + units * self.scale);
        let y = |units: f32| snap(self.origin.y + units * self.scale);
        Rect::from_min_max(
            pos2(x(rect.x), y(rect.y)),
            pos2(x(rect.x + rect.w), y(rect.y + rect.h)),
        )
    }

    /// Converts a position in the window to panel units.
    pub fn to_panel(self, position: Pos2) -> (f32, f32) {
        let from_origin = (position - self.origin) / self.scale;
        (from_origin.x, from_origin.y)
    }

    /// The rectangle of the whole area in the window, points.
    pub fn bounds(&self) -> Rect {
        self.to_window(self.area.rect)
    }
}

/// Smallest side of a key when the panel is placed in `bounds`, points.
pub fn min_key_size(bounds: Rect) -> f32 {
    let areas = place_panel(bounds, 1.0);
    let sides = finger_keys().filter_map(|part| {
        let view = area_of_part(&areas, part)?;
        Some(part.rect.w.min(part.rect.h) * view.scale)
    });
    sides.fold(f32::INFINITY, f32::min)
}

/// Width of the whole panel at which its keys are at least `min_key_size` points large,
/// points.
pub fn width_for_key_size(min_key_size: f32) -> f32 {
    let sides = finger_keys().map(|part| part.rect.w.min(part.rect.h));
    min_key_size / sides.fold(f32::INFINITY, f32::min) * SIZE.0
}

/// The keys that must be large enough for fingers. The overtravel release is not among them:
/// it is as small as on the machine, because it must be pressed on purpose.
fn finger_keys() -> impl Iterator<Item = &'static PanelPart> {
    let keys = faceplate::parts()
        .iter()
        .filter(|part| part.key().is_some());
    keys.filter(|part| part.key() != Some(Key::OvertravelRelease))
}

/// Places the keys that stop the machine side by side at the right end of a bar. They stay
/// visible while a view is shown instead of the panel (WINDOW-22).
pub fn place_stop_keys(bar: Rect, pixels_per_point: f32) -> Vec<PlacedArea> {
    let mut right = bar.right() - STOP_KEY_GAP;
    let mut placed = Vec::new();
    for key in STOP_KEYS {
        let Some(part) = faceplate::part_of(key) else {
            continue;
        };
        let area = PanelArea { rect: part.rect };
        let width = bar.height() * part.rect.w / part.rect.h;
        let room = Rect::from_min_max(pos2(right - width, bar.top()), pos2(right, bar.bottom()));
        placed.push(PlacedArea::fit(area, room.shrink(1.0), pixels_per_point));
        right -= width + STOP_KEY_GAP;
    }
    placed
}

/// Places the panel in `bounds`: as a whole, or split into its areas if that makes the keys
/// larger.
pub fn place_panel(bounds: Rect, pixels_per_point: f32) -> Vec<PlacedArea> {
    let whole = PlacedArea::fit(PanelArea::WHOLE, bounds, pixels_per_point);
    let (key_scale, section_bounds) = split_sections(bounds);
    if bounds.height() < bounds.width() * UPRIGHT_RATIO || key_scale < whole.scale * MIN_GAIN {
        return vec![whole];
    }
    let areas = PanelArea::SECTIONS.into_iter().zip(section_bounds);
    areas
        .map(|(area, room)| PlacedArea::fit(area, room, pixels_per_point))
        .collect()
}

/// Points per panel unit of the keys, and the rectangles of the areas, in upright `bounds`.
/// The LCD and the name plate are beside the keys that run and stop the machine; below are the
/// edit keyboard and then the keys for modes and directions. All keys are as large as the
/// space allows, for fingers.
fn split_sections(bounds: Rect) -> (f32, [Rect; 6]) {
    let [screen, name, edit, modes, run, additional] =
        PanelArea::SECTIONS.map(|area| vec2(area.rect.w, area.rect.h));
    let side_width = run.x.max(additional.x);
    let total_height = run.y + additional.y + edit.y + modes.y;
    let key_scale = (bounds.height() / total_height)
        .min(bounds.width() / edit.x.max(modes.x))
        .min(bounds.width() * MAX_SIDE_SHARE / side_width)
        .max(0.01);
    let left = bounds.width() - side_width * key_scale;
    let (screen, name) = (screen * (left / screen.x), name * (left / name.x));
    let upper = (run.y + additional.y) * key_scale;
    // Space that is left in a higher rectangle goes between the rows.
    let row_gap = (bounds.height() - total_height * key_scale).max(0.0) / 4.0;
    let top = bounds.top() + row_gap;
    let right = bounds.left() + left;
    let at = |x: f32, y: f32, size: Vec2| Rect::from_min_size(pos2(x, y), size);
    let below = |y: f32, size: Vec2| {
        let x = bounds.center().x - size.x * key_scale / 2.0;
        at(x, y, size * key_scale)
    };
    let free = (upper - screen.y - name.y).max(0.0) / 2.0;
    let section_bounds = [
        at(
            bounds.left(),
            top + free,
            vec2(left, screen.y.min(upper - name.y)),
        ),
        at(bounds.left(), top + upper - free - name.y, name),
        below(top + upper + row_gap, edit),
        below(top + upper + edit.y * key_scale + 2.0 * row_gap, modes),
        at(right, top + additional.y * key_scale, run * key_scale),
        at(
            right + (side_width - additional.x) * key_scale / 2.0,
            top,
            additional * key_scale,
        ),
    ];
    (key_scale, section_bounds)
}

/// Converts a position in the window to panel units; `None` outside the panel.
pub fn to_panel(views: &[PlacedArea], position: Pos2) -> Option<(f32, f32)> {
    views.iter().find_map(|view| {
        let (x, y) = view.to_panel(position);
        view.area.rect.contains(x, y).then_some((x, y))
    })
}

/// The placed area that contains a part of the panel; `None` if that area is not placed.
pub fn area_of_part<'a>(views: &'a [PlacedArea], part: &PanelPart) -> Option<&'a PlacedArea> {
    views.iter().find(|view| view.area.contains(part))
}

/// Points per panel unit if the whole panel is placed in an area of this size, points.
pub fn scale_of_whole(room: Vec2) -> f32 {
    (room.x / SIZE.0).min(room.y / SIZE.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_panel::faceplate::{PartKind, parts};

    #[test]
    fn the_panel_fits_and_is_centred() {
        for (width, height) in [(1280.0, 756.0), (640.0, 480.0), (3840.0, 800.0)] {
            let room = Rect::from_min_size(pos2(0.0, 26.0), vec2(width, height));
            let views = place_panel(room, 2.0);
            assert_eq!(views.len(), 1);
            let (w, h) = SIZE;
            let whole = views[0].to_window(faceplate::Rect::new(0.0, 0.0, w, h));
            assert!(room.expand(0.51).contains_rect(whole), "{whole:?}");
            assert!((whole.center() - room.center()).length() < 1.0);
            let (x, y) = to_panel(&views, whole.center()).unwrap();
            assert!((x - w / 2.0).abs() < 2.0 && (y - h / 2.0).abs() < 2.0);
        }
    }

    /// A 10.1-inch tablet held upright has 800 × 1280 pixels, 149 per inch; the bars of the
    /// window take 50 pixels.
    #[test]
    fn keys_are_as_large_as_a_finger_on_a_tablet() {
        let room = Rect::from_min_size(pos2(0.0, 28.0), vec2(800.0, 1230.0));
        let views = place_panel(room, 1.0);
        for part in parts().iter().filter(|part| part.key().is_some()) {
            if part.key() == Some(Key::OvertravelRelease) {
                continue; // It must be pressed on purpose: as small as on the machine.
            }
            let rect = area_of_part(&views, part).unwrap().to_window(part.rect);
            let side = rect.size().min_elem() / 149.0 * 25.4;
            assert!(side >= 9.0, "{part:?} is {side} mm");
        }
        let screen = views[0].to_window(faceplate::lcd());
        assert!(screen.width() >= 320.0, "a pixel a dot: {screen:?}");
    }

    #[test]
    fn an_upright_window_splits_the_panel_and_shows_every_part() {
        for (width, height) in [(400.0, 900.0), (800.0, 1230.0), (1080.0, 1870.0)] {
            let room = Rect::from_min_size(pos2(3.0, 28.0), vec2(width, height));
            let views = place_panel(room, 1.0);
            assert_eq!(views.len(), 6, "{width} x {height}");
            for (index, view) in views.iter().enumerate() {
                let place = view.bounds();
                assert!(room.expand(1.01).contains_rect(place), "{place:?}");
                let mut others = views[index + 1..].iter().map(PlacedArea::bounds);
                assert!(
                    !others.any(|it| it.shrink(1.01).intersects(place)),
                    "{place:?}"
                );
            }
            let used: f32 = views.iter().map(|view| view.bounds().area()).sum();
            assert!(used > 0.5 * room.area(), "{used} of {}", room.area());
            for part in parts().iter().filter(|part| part.what != PartKind::Housing) {
                let place = area_of_part(&views, part).unwrap().to_window(part.rect);
                let (x, y) = to_panel(&views, place.center()).unwrap();
                assert!(part.rect.contains(x, y), "{part:?}");
            }
        }
    }
}
