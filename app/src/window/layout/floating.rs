//! Positions the separate windows of views: at their last position, else beside the LCD. They
//! are never larger than the screen and cover no key that stops the machine (WINDOW-25).

use egui::{Context, Pos2, Rect, Vec2, ViewportInfo, pos2, vec2};

use super::Place;
use crate::window::clear;

/// Width and height that the frame and the title of a window add, points.
const FRAME: Vec2 = vec2(12.0, 44.0);

/// The screen and the rectangles that must stay visible on it, points.
#[derive(Clone, Debug, PartialEq)]
pub struct Screen {
    size: Option<Vec2>,
    /// The LCD on the screen; `None` where the system does not report the window's position.
    lcd: Option<Rect>,
    /// The keys that stop the machine; empty where the position is unknown.
    stops: Vec<Rect>,
}

impl Screen {
    /// The screen of the main window. `lcd` is the rectangle of the LCD inside the window.
    pub fn of(context: &Context, lcd: Option<Rect>) -> Self {
        let stops = clear::remembered(context);
        context.input(|input| {
            let viewport = input.viewport();
            let inner = viewport.inner_rect;
            Self {
                size: viewport.monitor_size.filter(|size| size.min_elem() > 1.0),
                lcd: inner
                    .zip(lcd)
                    .map(|(inner, lcd)| lcd.translate(inner.min.to_vec2())),
                stops: inner.map_or_else(Vec::new, |inner| {
                    let stops = stops.iter();
                    stops.map(|it| it.translate(inner.min.to_vec2())).collect()
                }),
            }
        })
    }

    /// Position and size for a new window: those of `last`, else where it leaves the LCD
    /// visible. The position is `None` where the system has to choose it.
    pub fn open(&self, last: Option<Place>, wanted: Vec2, least: Vec2) -> (Option<Pos2>, Vec2) {
        let wanted = last.map_or(wanted, |place| {
            vec2(place.size.0 as f32, place.size.1 as f32)
        });
        let Some(size) = self.size else {
            return (None, wanted);
        };
        let wanted = wanted.min(size - FRAME).max(vec2(1.0, 1.0));
        if let Some((x, y)) = last.and_then(|place| place.corner) {
            // The stored position may lie on a screen that is gone, or on a smaller one.
            let most = (size - wanted - FRAME).max(Vec2::ZERO);
            let corner = pos2((x as f32).clamp(0.0, most.x), (y as f32).clamp(0.0, most.y));
            let window = Rect::from_min_size(corner, wanted + FRAME);
            if !self.stops.iter().any(|stop| stop.intersects(window)) {
                return (Some(corner), wanted);
            }
        }
        // With several screens, an LCD on another one says nothing about this one.
        let screen = Rect::from_min_size(Pos2::ZERO, size);
        let lcd = self.lcd.filter(|lcd| screen.contains_rect(*lcd));
        if lcd.is_none() && self.stops.is_empty() {
            return (None, wanted);
        }
        let (corner, size) = beside(screen, lcd, &self.stops, wanted, least.min(wanted));
        (Some(corner), size)
    }
}

/// Position and size of the main window: those of `last`, else centred on the screen with the
/// share `share` of its width and height.
pub fn main_window(last: Option<Place>, screen: Vec2, share: f32) -> (Pos2, Vec2) {
    let most = screen * share;
    let size = last.map_or(most, |place| vec2(place.size.0 as f32, place.size.1 as f32));
    let size = size.min(most);
    let room = (screen - size - FRAME).max(Vec2::ZERO);
    let middle = (room / 2.0).to_pos2();
    let corner = last.and_then(|place| place.corner);
    let corner = corner.map_or(middle, |(x, y)| {
        pos2((x as f32).clamp(0.0, room.x), (y as f32).clamp(0.0, room.y))
    });
    (corner, size)
}

/// Position and size of a window that is neither maximized nor hidden, else `None`.
pub fn place(viewport: &ViewportInfo) -> Option<Place> {
    let unusual = [viewport.maximized, viewport.fullscreen, viewport.minimized];
    if unusual.contains(&Some(true)) {
        return None;
    }
    let size = viewport.inner_rect?.size().round();
    let corner = viewport.outer_rect.map(|outer| outer.min.round());
    Some(Place {
        corner: corner.map(|corner| (corner.x as i32, corner.y as i32)),
        size: (size.x as u32, size.y as u32),
    })
}

/// The largest rectangle, at most `wanted`, beside the LCD and the keys that stop the machine.
/// Where it is smaller than `least`, only these keys stay visible.
fn beside(
    screen: Rect,
    lcd: Option<Rect>,
    stops: &[Rect],
    wanted: Vec2,
    least: Vec2,
) -> (Pos2, Vec2) {
    let fitted = |without: &[Rect]| {
        let room = clear::room(screen, without, |room| clear::holds(room, wanted + FRAME));
        let size = wanted.min(room.size() - FRAME).max(vec2(1.0, 1.0));
        (room.max - size - FRAME, size)
    };
    let all: Vec<Rect> = lcd.into_iter().chain(stops.iter().copied()).collect();
    let (corner, size) = fitted(&all);
    if size.x >= least.x && size.y >= least.y {
        return (corner, size);
    }
    let (corner, size) = fitted(stops);
    // The window covers a part of the LCD with its least size.
    let small = least.min(size);
    (corner + size - small, small)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_opens_beside_the_lcd_and_on_the_screen() {
        let lcd = Rect::from_min_size(pos2(80.0, 90.0), vec2(640.0, 480.0));
        for (screen, over) in [
            (vec2(3840.0, 2160.0), false),
            (vec2(1920.0, 1080.0), false),
            (vec2(1366.0, 768.0), true),
        ] {
            let on = Screen {
                size: Some(screen),
                lcd: Some(lcd),
                stops: Vec::new(),
            };
            let (corner, size) = on.open(None, vec2(1120.0, 720.0), vec2(760.0, 360.0));
            let window = Rect::from_min_size(corner.unwrap(), size + FRAME);
            let room = Rect::from_min_size(Pos2::ZERO, screen);
            assert!(room.contains_rect(window), "{window:?} on {screen}");
            assert_eq!(
                window.shrink(0.1).intersects(lcd),
                over,
                "{window:?} on {screen}"
            );
            assert!(size.x >= 760.0 && size.y >= 360.0);
        }
    }

    #[test]
    fn a_window_of_its_own_covers_no_key_that_stops_the_machine() {
        use crate::window::{placing, view::VIEWS};
        for screen in [
            vec2(1024.0, 768.0),
            vec2(1366.0, 768.0),
            vec2(1920.0, 1080.0),
            vec2(800.0, 1280.0),
        ] {
            let room = Rect::from_min_size(pos2(0.0, 50.0), screen - vec2(0.0, 80.0));
            let stops = clear::stops(&placing::views(room, 1.0));
            let on = Screen {
                size: Some(screen),
                lcd: None,
                stops: stops.clone(),
            };
            for row in &VIEWS {
                let (wanted, least) = (Vec2::from(row.size), Vec2::from(row.least));
                let covering = Place {
                    corner: Some((stops[0].left() as i32 - 50, stops[0].top() as i32 - 50)),
                    size: (wanted.x as u32, wanted.y as u32),
                };
                for last in [None, Some(covering)] {
                    let (corner, size) = on.open(last, wanted, least);
                    let window = Rect::from_min_size(corner.unwrap(), size + FRAME);
                    let covers = |stop: &Rect| stop.shrink(1.0).intersects(window);
                    assert!(!stops.iter().any(covers), "{:?} on {screen}", row.view);
                    assert!(size.x > 150.0 && size.y > 150.0, "{size} on {screen}");
                }
            }
        }
    }

    #[test]
    fn the_main_window_stands_in_the_middle_or_where_it_was() {
        let screen = vec2(1366.0, 768.0);
        let (corner, size) = main_window(None, screen, 0.92);
        assert_eq!(size, screen * 0.92);
        assert!(corner.x > 40.0 && corner.y >= 0.0);
        let place = Place {
            corner: Some((-100, 500)),
            size: (600, 5000),
        };
        let (corner, size) = main_window(Some(place), screen, 0.92);
        assert_eq!((corner.x, size.x), (0.0, 600.0));
        assert!(corner.y + size.y <= screen.y);
    }

    #[test]
    fn it_comes_back_where_it_was_also_on_a_smaller_screen() {
        let on = |screen| Screen {
            size: Some(screen),
            lcd: None,
            stops: Vec::new(),
        };
        let place = Place {
            corner: Some((1500, 300)),
            size: (1120, 720),
        };
        let open = |screen| on(screen).open(Some(place), vec2(100.0, 100.0), vec2(50.0, 50.0));
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
        assert_eq!(size, vec2(800.0, 600.0) - FRAME);
    }
}
