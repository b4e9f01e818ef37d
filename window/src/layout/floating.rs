//! Positions the separate windows of views: at their last position, else beside the LCD. They
//! are never larger than the screen and cover no key that stops the machine (WINDOW-25).

use egui::{Context, Pos2, Rect, Vec2, ViewportInfo, pos2, vec2};

use super::WindowGeometry;
use crate::placement::stop_key_clearance;

/// Width and height that the frame and the title of a window add, points.
const FRAME_SIZE: Vec2 = vec2(12.0, 44.0);

/// The screen for separate windows, and the rectangles that must stay visible on it, points.
#[derive(Clone, Debug, PartialEq)]
pub struct WindowScreen {
    size: Option<Vec2>,
    /// The LCD on the screen; `None` if the system does not report the window's position.
    lcd: Option<Rect>,
    /// The keys that stop the machine; empty if the position is unknown.
    stop_keys: Vec<Rect>,
}

impl WindowScreen {
    /// Creates the screen of the main window. `lcd` is the rectangle of the LCD inside the
    /// window.
    pub fn of_main_window(context: &Context, lcd: Option<Rect>) -> Self {
        let stops = stop_key_clearance::stored_stop_keys(context);
        context.input(|input| {
            let viewport = input.viewport();
            let inner = viewport.inner_rect;
            Self {
                size: viewport.monitor_size.filter(|size| size.min_elem() > 1.0),
                lcd: inner
                    .zip(lcd)
                    .map(|(inner, lcd)| lcd.translate(inner.min.to_vec2())),
                stop_keys: inner.map_or_else(Vec::new, |inner| {
                    let stops = stops.iter();
                    stops.map(|it| it.translate(inner.min.to_vec2())).collect()
                }),
            }
        })
    }

    /// Position and size for a new window: those of `last`, else beside the LCD. The position
    /// is `None` if the system has to choose it.
    pub fn place_window(
        &self,
        last: Option<WindowGeometry>,
        default_size: Vec2,
        min_size: Vec2,
    ) -> (Option<Pos2>, Vec2) {
        let wanted = last.map_or(default_size, |place| {
            vec2(place.size.0 as f32, place.size.1 as f32)
        });
        let Some(size) = self.size else {
            return (None, wanted);
        };
        let wanted = wanted.min(size - FRAME_SIZE).max(vec2(1.0, 1.0));
        if let Some((x, y)) = last.and_then(|place| place.corner) {
            // The stored position may lie on a screen that is gone, or on a smaller one.
            let max_corner = (size - wanted - FRAME_SIZE).max(Vec2::ZERO);
            let corner = pos2(
                (x as f32).clamp(0.0, max_corner.x),
                (y as f32).clamp(0.0, max_corner.y),
            );
            let window = Rect::from_min_size(corner, wanted + FRAME_SIZE);
            if !self.stop_keys.iter().any(|stop| stop.intersects(window)) {
                return (Some(corner), wanted);
            }
        }
        // With several screens, an LCD on another one says nothing about this one.
        let screen = Rect::from_min_size(Pos2::ZERO, size);
        let lcd = self.lcd.filter(|lcd| screen.contains_rect(*lcd));
        if lcd.is_none() && self.stop_keys.is_empty() {
            return (None, wanted);
        }
        let (corner, size) =
            place_beside(screen, lcd, &self.stop_keys, wanted, min_size.min(wanted));
        (Some(corner), size)
    }
}

/// Position and size of the main window: those of `last`, else centred on the screen, with
/// `share` (0–1) of its width and height.
pub fn place_main_window(last: Option<WindowGeometry>, screen: Vec2, share: f32) -> (Pos2, Vec2) {
    let max_size = screen * share;
    let size = last.map_or(max_size, |place| {
        vec2(place.size.0 as f32, place.size.1 as f32)
    });
    let size = size.min(max_size);
    let free_size = (screen - size - FRAME_SIZE).max(Vec2::ZERO);
    let middle = (free_size / 2.0).to_pos2();
    let corner = last.and_then(|place| place.corner);
    let corner = corner.map_or(middle, |(x, y)| {
        pos2(
            (x as f32).clamp(0.0, free_size.x),
            (y as f32).clamp(0.0, free_size.y),
        )
    });
    (corner, size)
}

/// Position and size of a window; `None` if the window is maximized, full screen or minimized.
pub fn normal_geometry(viewport: &ViewportInfo) -> Option<WindowGeometry> {
    let special_states = [viewport.maximized, viewport.fullscreen, viewport.minimized];
    if special_states.contains(&Some(true)) {
        return None;
    }
    let size = viewport.inner_rect?.size().round();
    let corner = viewport.outer_rect.map(|outer| outer.min.round());
    Some(WindowGeometry {
        corner: corner.map(|corner| (corner.x as i32, corner.y as i32)),
        size: (size.x as u32, size.y as u32),
    })
}

/// Position and size of the largest rectangle, at most `wanted_size`, that covers neither the
/// LCD nor the keys that stop the machine. If it is smaller than `min_size`, only these keys
/// stay visible.
fn place_beside(
    screen: Rect,
    lcd: Option<Rect>,
    stop_keys: &[Rect],
    wanted_size: Vec2,
    min_size: Vec2,
) -> (Pos2, Vec2) {
    let fit_without = |without: &[Rect]| {
        let room = stop_key_clearance::best_rect(screen, without, |room| {
            stop_key_clearance::visible_area(room, wanted_size + FRAME_SIZE)
        });
        let size = wanted_size
            .min(room.size() - FRAME_SIZE)
            .max(vec2(1.0, 1.0));
        (room.max - size - FRAME_SIZE, size)
    };
    let all: Vec<Rect> = lcd.into_iter().chain(stop_keys.iter().copied()).collect();
    let (corner, size) = fit_without(&all);
    if size.x >= min_size.x && size.y >= min_size.y {
        return (corner, size);
    }
    let (corner, size) = fit_without(stop_keys);
    // The window covers a part of the LCD with its least size.
    let small = min_size.min(size);
    (corner + size - small, small)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_opens_beside_the_lcd_and_on_the_screen() {
        let lcd = Rect::from_min_size(pos2(80.0, 90.0), vec2(640.0, 480.0));
        for (screen, is_over_lcd) in [
            (vec2(3840.0, 2160.0), false),
            (vec2(1920.0, 1080.0), false),
            (vec2(1366.0, 768.0), true),
        ] {
            let on_screen = WindowScreen {
                size: Some(screen),
                lcd: Some(lcd),
                stop_keys: Vec::new(),
            };
            let (corner, size) =
                on_screen.place_window(None, vec2(1120.0, 720.0), vec2(760.0, 360.0));
            let window = Rect::from_min_size(corner.unwrap(), size + FRAME_SIZE);
            let room = Rect::from_min_size(Pos2::ZERO, screen);
            assert!(room.contains_rect(window), "{window:?} on {screen}");
            assert_eq!(
                window.shrink(0.1).intersects(lcd),
                is_over_lcd,
                "{window:?} on {screen}"
            );
            assert!(size.x >= 760.0 && size.y >= 360.0);
        }
    }

    #[test]
    fn a_separate_window_covers_no_stop_key() {
        use crate::placement::panel_placement;
        use crate::view::VIEWS;
        for screen in [
            vec2(1024.0, 768.0),
            vec2(1366.0, 768.0),
            vec2(1920.0, 1080.0),
            vec2(800.0, 1280.0),
        ] {
            let room = Rect::from_min_size(pos2(0.0, 50.0), screen - vec2(0.0, 80.0));
            let stops =
                stop_key_clearance::stop_key_rects(&panel_placement::place_panel(room, 1.0));
            let on = WindowScreen {
                size: Some(screen),
                lcd: None,
                stop_keys: stops.clone(),
            };
            for row in &VIEWS {
                let (wanted, least) = (Vec2::from(row.size), Vec2::from(row.min_size));
                let covering = WindowGeometry {
                    corner: Some((stops[0].left() as i32 - 50, stops[0].top() as i32 - 50)),
                    size: (wanted.x as u32, wanted.y as u32),
                };
                for last in [None, Some(covering)] {
                    let (corner, size) = on.place_window(last, wanted, least);
                    let window = Rect::from_min_size(corner.unwrap(), size + FRAME_SIZE);
                    let covers = |stop: &Rect| stop.shrink(1.0).intersects(window);
                    assert!(!stops.iter().any(covers), "{:?} on {screen}", row.view);
                    assert!(size.x > 150.0 && size.y > 150.0, "{size} on {screen}");
                }
            }
        }
    }

    #[test]
    fn the_main_window_opens_centred_or_at_its_last_position() {
        let screen = vec2(1366.0, 768.0);
        let (corner, size) = place_main_window(None, screen, 0.92);
        assert_eq!(size, screen * 0.92);
        assert!(corner.x > 40.0 && corner.y >= 0.0);
        let place = WindowGeometry {
            corner: Some((-100, 500)),
            size: (600, 5000),
        };
        let (corner, size) = place_main_window(Some(place), screen, 0.92);
        assert_eq!((corner.x, size.x), (0.0, 600.0));
        assert!(corner.y + size.y <= screen.y);
    }

    #[test]
    fn a_window_keeps_its_position_on_a_smaller_screen() {
        let on = |screen| WindowScreen {
            size: Some(screen),
            lcd: None,
            stop_keys: Vec::new(),
        };
        let place = WindowGeometry {
            corner: Some((1500, 300)),
            size: (1120, 720),
        };
        let open =
            |screen| on(screen).place_window(Some(place), vec2(100.0, 100.0), vec2(50.0, 50.0));
        let (corner, size) = open(vec2(3840.0, 2160.0));
        assert_eq!(
            (corner, size),
            (Some(pos2(1500.0, 300.0)), vec2(1120.0, 720.0))
        );
        let (corner, size) = open(vec2(1366.0, 768.0));
        assert_eq!(
            (corner, size),
            (Some(pos2(234.0, 4.0)), vec2(1120.0, 720.0))
        );
        let (_, size) = open(vec2(800.0, 600.0));
        assert_eq!(size, vec2(800.0, 600.0) - FRAME_SIZE);
    }
}
