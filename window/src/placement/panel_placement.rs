//! Positions the panel in the window: as a whole, or split into its sections. The arrangement
//! with the largest legends is used.

mod sections;

use std::cell::RefCell;
use std::collections::VecDeque;

use egui::{Pos2, Rect, Vec2, pos2, vec2};
use gsk_core::model::ModelId;
use gsk_panel::faceplate::{self, PanelArea, PanelPart, SIZE, parts};
use gsk_panel::keys::Key;

use super::lcd_placement;
use sections::{ARRANGEMENTS, SectionPlan};

/// Minimum side of a key for fingers, points: 9 mm at 96 points per inch.
pub const FINGER_KEY_SIZE: f32 = 9.0 / 25.4 * 96.0;
/// The keys that stop the machine, in their order from the right.
pub const STOP_KEYS: [Key; 3] = [Key::EmergencyStop, Key::FeedHold, Key::Reset];
/// The model by whose panel positions are computed. Every panel has the same areas and the same
/// positions of the stop keys, and no smaller keys.
const PLACED_MODEL: ModelId = ModelId::Gsk980td;
/// Gap between two stop keys (feed hold, reset, emergency stop), points.
const STOP_KEY_GAP: f32 = 8.0;
/// Value of the whole panel, compared with sections of equal legends: it looks as on the
/// machine, but dots of the LCD that are no whole pixels are blurred.
const CRISP_WHOLE_VALUE: f32 = 1.15;
const BLURRED_WHOLE_VALUE: f32 = 0.7;
/// Panel units per dot of the LCD in the drawing of the panel.
pub const UNITS_PER_DOT: f32 = 2.0;
/// Highest zoom of the LCD in a split panel, physical pixels per dot.
const MAX_LCD_ZOOM: u32 = 6;
/// Scale of legends up to which enlarging them is worth more than a higher zoom of the LCD,
/// divided by the scale of the LCD. An upright window is usually touched, and needs large keys.
const LCD_TEXT_GAIN: f32 = 1.5;
const UPRIGHT_LCD_TEXT_GAIN: f32 = 2.4;
/// Value of a larger LCD among arrangements with equal legends.
const LCD_WEIGHT: f32 = 0.2;
/// Value of larger keys among arrangements in which the LCD limits the score.
const KEY_WEIGHT: f32 = 0.1;
/// Loss of value of an arrangement that leaves all of its pane unused.
const UNUSED_WEIGHT: f32 = 0.5;
/// Greatest factor by which a section without the LCD is stretched in one direction: its keys grow,
/// its legends do not.
const MAX_STRETCH: f32 = 1.4;
/// The same of a section with the LCD, whose frame grows.
const MAX_LCD_STRETCH: f32 = 1.1;
/// Height divided by width from which the available area counts as upright.
const UPRIGHT_RATIO: f32 = 1.25;
/// Height of the smallest printed legend, panel units.
const LEGEND_HEIGHT: f32 = 15.04;
/// Least height of a legend that is easy to read, physical pixels.
pub const MIN_LEGEND_HEIGHT: f32 = 11.0;
/// The same while the time line takes a strip of the window: who drags it wants to see panel and
/// lathe together.
pub const MIN_LEGEND_HEIGHT_ABOVE_TIME_LINE: f32 = 9.8;

/// Bounds and scale with the areas of the panel placed for them.
type Placement = (Rect, f32, Vec<PlacedArea>);

/// Number of placements that are kept: those of the panes of one layout.
const KEPT_PLACEMENTS: usize = 32;

/// Position and scale of one area of the panel in the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedArea {
    /// The area of the panel that is placed.
    pub area: PanelArea,
    /// Position of the upper left corner of the whole panel at this scale, points.
    pub origin: Pos2,
    /// Number of points per panel unit.
    pub scale: f32,
    /// Number of physical pixels per point.
    pub pixels_per_point: f32,
}

impl PlacedArea {
    /// Places an area in `bounds`: as large as possible, centred, on whole pixels.
    fn fit(area: PanelArea, bounds: Rect, pixels_per_point: f32) -> Self {
        let faceplate::Rect { x, y, w, h } = area.bounds();
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

    /// Places an area in `bounds` at a scale, stretched to fill them by at most `max_stretch`.
    fn fill(
        rect: faceplate::Rect,
        bounds: Rect,
        (scale, max_stretch): (f32, f32),
        pixels_per_point: f32,
    ) -> Self {
        let stretch = |available: f32, size: f32| {
            let factor = available / (size * scale).max(0.01);
            factor.clamp(1.0, max_stretch)
        };
        let area = PanelArea {
            rect,
            stretch: (
                stretch(bounds.width(), rect.w),
                stretch(bounds.height(), rect.h),
            ),
        };
        let bounds = Rect::from_center_size(
            bounds.center(),
            vec2(area.bounds().w, area.bounds().h) * scale,
        );
        // Rounding in `bounds` does not change the scale.
        Self {
            scale,
            ..Self::fit(area, bounds, pixels_per_point)
        }
    }

    /// The rectangle of a part of the area in the window, points.
    pub fn part_rect(&self, part: &PanelPart) -> Rect {
        self.to_window(self.area.stretched_rect(part))
    }

    /// Converts a rectangle of the stretched area to window points, with its edges on whole
    /// pixels.
    pub fn to_window(self, rect: faceplate::Rect) -> Rect {
        let snap = |at: f32| (at * self.pixels_per_point).round() / self.pixels_per_point;
        let x = |units: f32| snap(self.origin.x + units * self.scale);
        let y = |units: f32| snap(self.origin.y + units * self.scale);
        Rect::from_min_max(
            pos2(x(rect.x), y(rect.y)),
            pos2(x(rect.x + rect.w), y(rect.y + rect.h)),
        )
    }

    /// Converts a position in the window to panel units of the stretched area.
    pub fn to_area(self, position: Pos2) -> (f32, f32) {
        let from_origin = (position - self.origin) / self.scale;
        (from_origin.x, from_origin.y)
    }

    /// The rectangle of the whole area in the window, points.
    pub fn bounds(&self) -> Rect {
        self.to_window(self.area.bounds())
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
    let keys = parts(PLACED_MODEL)
        .iter()
        .filter(|part| part.key().is_some());
    keys.filter(|part| part.key() != Some(Key::OvertravelRelease))
}

/// The parts of the keys that stop the machine, in their order from the right.
pub fn stop_key_parts() -> impl Iterator<Item = &'static PanelPart> {
    let keys = STOP_KEYS.into_iter();
    keys.filter_map(|key| faceplate::part_of(PLACED_MODEL, key))
}

/// Places the keys that stop the machine side by side at the right end of a bar. They stay
/// visible while a view is shown instead of the panel (WINDOW-22).
pub fn place_stop_keys(bar: Rect, pixels_per_point: f32) -> Vec<PlacedArea> {
    let mut right = bar.right() - STOP_KEY_GAP;
    let mut placed = Vec::new();
    for part in stop_key_parts() {
        let area = PanelArea::new(part.rect);
        let width = bar.height() * part.rect.w / part.rect.h;
        let room = Rect::from_min_max(pos2(right - width, bar.top()), pos2(right, bar.bottom()));
        placed.push(PlacedArea::fit(area, room.shrink(1.0), pixels_per_point));
        right -= width + STOP_KEY_GAP;
    }
    placed
}

/// Places the panel in `bounds`: as a whole, or split into its sections if that makes the
/// legends larger or the dots of the LCD whole pixels.
pub fn place_panel(bounds: Rect, pixels_per_point: f32) -> Vec<PlacedArea> {
    thread_local! {
        /// The last results: the search takes longer than the rest of a frame without changes,
        /// and layout and panel need the same few panes in each frame.
        static LAST_PLACEMENTS: RefCell<VecDeque<Placement>> = const {
            RefCell::new(VecDeque::new())
        };
    }
    LAST_PLACEMENTS.with_borrow_mut(|last| {
        let known = last
            .iter()
            .find(|(of, pixels, _)| *of == bounds && *pixels == pixels_per_point);
        if let Some((_, _, placed)) = known {
            return placed.clone();
        }
        let placed = find_best_placement(bounds, pixels_per_point);
        last.truncate(KEPT_PLACEMENTS - 1);
        last.push_front((bounds, pixels_per_point, placed.clone()));
        placed
    })
}

fn find_best_placement(bounds: Rect, pixels_per_point: f32) -> Vec<PlacedArea> {
    let whole = place_whole(bounds, pixels_per_point);
    let lcd = faceplate::lcd_part(PLACED_MODEL).map(|part| whole.part_rect(part));
    let is_crisp = lcd.is_some_and(|lcd| lcd_placement::fit(lcd, pixels_per_point).is_crisp);
    let whole_value = match is_crisp {
        true => CRISP_WHOLE_VALUE,
        false => BLURRED_WHOLE_VALUE,
    };
    let whole_score = whole.scale
        * (1.0 + LCD_WEIGHT + KEY_WEIGHT)
        * whole_value
        * value_of_use(&[whole], bounds);
    let text_gain = match bounds.height() < bounds.width() * UPRIGHT_RATIO {
        true => LCD_TEXT_GAIN,
        false => UPRIGHT_LCD_TEXT_GAIN,
    };
    let mut best: Option<(f32, Vec<PlacedArea>)> = None;
    for zoom in 1..=MAX_LCD_ZOOM {
        let lcd_scale = zoom as f32 / UNITS_PER_DOT / pixels_per_point;
        for arrangement in &ARRANGEMENTS {
            let plan = SectionPlan::fit(arrangement, lcd_scale, bounds.size());
            let score = match plan.key_scale > 0.01 {
                true => {
                    plan.key_scale.min(text_gain * lcd_scale)
                        + LCD_WEIGHT * lcd_scale
                        + KEY_WEIGHT * plan.key_scale
                }
                false => 0.0,
            };
            let best_score = best.as_ref().map_or(whole_score, |(score, _)| *score);
            if score <= best_score {
                continue;
            }
            let placed = plan.place(bounds, pixels_per_point);
            let score = score * value_of_use(&placed, bounds);
            if score > best_score {
                best = Some((score, placed));
            }
        }
    }
    best.map_or_else(|| vec![whole], |(_, placed)| placed)
}

/// Places the whole panel, stretched like a section with the LCD.
fn place_whole(bounds: Rect, pixels_per_point: f32) -> PlacedArea {
    let rect = PanelArea::WHOLE.rect;
    let scale = scale_of_whole(bounds.size()).max(0.01);
    PlacedArea::fill(rect, bounds, (scale, MAX_LCD_STRETCH), pixels_per_point)
}

/// Share of `bounds` that no area covers, 0–1.
pub fn unused_share(placed: &[PlacedArea], bounds: Rect) -> f32 {
    let used: f32 = placed.iter().map(|area| area.bounds().area()).sum();
    (1.0 - used / bounds.area().max(1.0)).clamp(0.0, 1.0)
}

/// Factor by which the space that an arrangement leaves unused reduces its value.
fn value_of_use(placed: &[PlacedArea], bounds: Rect) -> f32 {
    1.0 - UNUSED_WEIGHT * unused_share(placed, bounds)
}

/// Height of the smallest legends of keys when the panel is placed in `bounds`, physical
/// pixels.
pub fn legend_height(bounds: Rect, pixels_per_point: f32) -> f32 {
    let placed = place_panel(bounds, pixels_per_point);
    let scales = parts(PLACED_MODEL)
        .iter()
        .filter(|part| !part.legend().is_empty())
        .filter_map(|part| Some(area_of_part(&placed, part)?.scale));
    scales.fold(f32::INFINITY, f32::min) * LEGEND_HEIGHT * pixels_per_point
}

/// Physical pixels per dot of the LCD when the panel is placed in `bounds`.
pub fn lcd_zoom(bounds: Rect, pixels_per_point: f32) -> f32 {
    let placed = place_panel(bounds, pixels_per_point);
    let screen = faceplate::lcd();
    let view = placed.iter().find(|view| view.area.rect.encloses(&screen));
    view.map_or(0.0, |view| view.scale * UNITS_PER_DOT * pixels_per_point)
}

/// The topmost part of a model's panel at a position in the window; `None` outside the panel.
pub fn part_at(views: &[PlacedArea], model: ModelId, position: Pos2) -> Option<&'static PanelPart> {
    views.iter().find_map(|view| {
        let (x, y) = view.to_area(position);
        view.area.part_at(model, x, y)
    })
}

/// The rectangle of the LCD's picture in the window, points; `None` if the LCD is not placed.
pub fn lcd_rect(views: &[PlacedArea]) -> Option<Rect> {
    let lcd = faceplate::lcd_part(PLACED_MODEL)?;
    Some(area_of_part(views, lcd)?.part_rect(lcd))
}

/// The rectangle of the glass around the LCD's picture in the window, points: the frame around it
/// is equally wide at all four sides. `None` if the LCD is not placed.
pub fn glass_rect(views: &[PlacedArea]) -> Option<Rect> {
    let frame = faceplate::frame_part(PLACED_MODEL)?;
    let view = area_of_part(views, frame)?;
    let (frame, picture) = (view.part_rect(frame), lcd_rect(views)?.size());
    let width = faceplate::frame_width(frame.size().into(), picture.into());
    let pixels = view.pixels_per_point;
    Some(frame.shrink((width * pixels).floor() / pixels))
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
    use gsk_panel::faceplate::PartKind;

    #[test]
    fn the_panel_fits_and_is_centred() {
        for (width, height) in [(1280.0, 756.0), (640.0, 378.0), (1290.0, 770.0)] {
            let room = Rect::from_min_size(pos2(0.0, 26.0), vec2(width, height));
            let views = place_panel(room, 1.0);
            assert_eq!(views.len(), 1);
            let whole = views[0].bounds();
            assert!(room.expand(0.51).contains_rect(whole), "{whole:?}");
            assert!((whole.center() - room.center()).length() < 1.0);
            let (x, y) = views[0].to_area(whole.center());
            let (cx, cy) = views[0].area.bounds().center();
            assert!((x - cx).abs() < 2.0 && (y - cy).abs() < 2.0);
            assert!(unused_share(&views, room) < 0.01);
        }
    }

    #[test]
    fn the_frame_of_the_lcd_is_as_wide_at_each_side() {
        for (width, height) in [
            (680.0, 718.0),
            (717.0, 850.0),
            (800.0, 550.0),
            (1920.0, 1030.0),
        ] {
            let room = Rect::from_min_size(pos2(0.0, 28.0), vec2(width, height));
            let views = place_panel(room, 1.0);
            let part = faceplate::frame_part(PLACED_MODEL).unwrap();
            let frame = area_of_part(&views, part).unwrap().part_rect(part);
            let (glass, lcd) = (glass_rect(&views).unwrap(), lcd_rect(&views).unwrap());
            assert!(glass.contains_rect(lcd), "{glass} {lcd}");
            let [before, after] = [glass.min - frame.min, frame.max - glass.max];
            for side in [before.x, before.y, after.x, after.y] {
                assert!(
                    side >= 1.0 && (side - before.x).abs() < 0.01,
                    "{frame} {glass}"
                );
            }
        }
    }

    #[test]
    fn no_bare_strip_is_beside_the_lcd_in_a_wide_window() {
        let room = Rect::from_min_size(pos2(0.0, 28.0), vec2(1920.0, 1030.0));
        let views = place_panel(room, 1.0);
        let frame = faceplate::frame_part(PLACED_MODEL).unwrap();
        let lcd = area_of_part(&views, frame).unwrap().bounds();
        let beside = views.iter().map(PlacedArea::bounds);
        let beside = beside.filter(|it| it.left() >= lcd.right() - 1.0 && it.top() < lcd.bottom());
        let gap = beside.map(|it| it.left() - lcd.right());
        assert!(gap.fold(f32::INFINITY, f32::min) < 12.0, "{views:?}");
    }

    /// A 10.1-inch tablet held upright has 800 × 1280 pixels, 149 per inch; the bars of the
    /// window take 50 pixels.
    #[test]
    fn keys_are_as_large_as_a_finger_on_a_tablet() {
        let room = Rect::from_min_size(pos2(0.0, 28.0), vec2(800.0, 1230.0));
        let views = place_panel(room, 1.0);
        for part in parts(PLACED_MODEL)
            .iter()
            .filter(|part| part.key().is_some())
        {
            if part.key() == Some(Key::OvertravelRelease) {
                continue; // It must be pressed on purpose: as small as on the machine.
            }
            let rect = area_of_part(&views, part).unwrap().part_rect(part);
            let side = rect.size().min_elem() / 149.0 * 25.4;
            assert!(side >= 9.0, "{part:?} is {side} mm");
        }
        let screen = lcd_rect(&views).unwrap();
        assert!(screen.width() >= 320.0, "a pixel a dot: {screen:?}");
    }

    #[test]
    fn an_upright_window_splits_the_panel_and_shows_every_part() {
        for (width, height) in [(400.0, 900.0), (800.0, 1230.0), (1080.0, 1870.0)] {
            let room = Rect::from_min_size(pos2(3.0, 28.0), vec2(width, height));
            let views = place_panel(room, 1.0);
            assert_eq!(views.len(), 7, "{width} x {height}");
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
            assert!(used > 0.65 * room.area(), "{used} of {}", room.area());
            let zoom = lcd_zoom(room, 1.0);
            assert!((zoom - zoom.round()).abs() < 0.01, "{zoom} pixels per dot");
            for part in parts(PLACED_MODEL)
                .iter()
                .filter(|part| part.what != PartKind::Housing)
            {
                let place = area_of_part(&views, part).unwrap().part_rect(part);
                let found = part_at(&views, PLACED_MODEL, place.center()).unwrap();
                assert!(found.layer > part.layer || found == part, "{part:?}");
            }
        }
    }
}
