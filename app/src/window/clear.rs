//! Finds space for windows inside the main window that covers no key that stops the machine
//! (WINDOW-25).

use egui::{Context, Id, Rect, Vec2, pos2};
use gsk_panel::faceplate;

use super::placing::{self, STOPS, View};

/// Margin around each key, points.
const AROUND: f32 = 4.0;

/// Rectangles of the keys that stop the machine, with their margin.
pub fn stops(placed: &[View]) -> Vec<Rect> {
    let parts = STOPS.iter().filter_map(|key| faceplate::part_of(*key));
    let places = parts.filter_map(|part| Some(placing::of_part(placed, part)?.rect(part.rect)));
    places.map(|place| place.expand(AROUND)).collect()
}

/// Stores the rectangles of the keys that stop the machine, for windows that views draw.
pub fn remember(context: &Context, placed: &[View]) {
    let stops = stops(placed);
    context.data_mut(|data| data.insert_temp(place_of_stops(), stops));
}

/// The stored rectangles of these keys in the main window, from the last frame.
pub fn remembered(context: &Context) -> Vec<Rect> {
    let stops = context.data(|data| data.get_temp(place_of_stops()));
    stops.unwrap_or_default()
}

fn place_of_stops() -> Id {
    Id::unique("stops")
}

/// The rectangle without these keys that shows most of a dialog of `size`.
pub fn free(context: &Context, size: Vec2) -> Rect {
    let mut screen = context.content_rect();
    screen.min.y += super::BAR;
    room(screen, &remembered(context), |room| holds(room, size))
}

/// Rates `room` for a window of `size` that may cover everything else: the visible area of the
/// window; among equals the larger rectangle.
pub fn holds(room: Rect, size: Vec2) -> f32 {
    let shown = size.min(room.size());
    shown.x * shown.y + room.area() / 1000.0
}

/// The rectangle inside `screen` with the greatest `worth` that intersects none of `without`.
pub fn room(screen: Rect, without: &[Rect], worth: impl Fn(Rect) -> f32) -> Rect {
    let edges = |low: f32, high: f32, of: &dyn Fn(&Rect) -> [f32; 2]| {
        let inside = without.iter().flat_map(of);
        let inside = inside.filter(move |edge| (low..=high).contains(edge));
        let mut edges: Vec<f32> = [low, high].into_iter().chain(inside).collect();
        edges.sort_by(f32::total_cmp);
        edges
    };
    let xs = edges(screen.left(), screen.right(), &|it| [it.left(), it.right()]);
    let ys = edges(screen.top(), screen.bottom(), &|it| [it.top(), it.bottom()]);
    let pairs = |edges: &[f32]| {
        let mut pairs = Vec::new();
        for (index, low) in edges.iter().enumerate() {
            pairs.extend(edges.iter().skip(index + 1).map(|high| (*low, *high)));
        }
        pairs
    };
    let mut best = screen;
    let mut most = f32::NEG_INFINITY;
    for (left, right) in pairs(&xs) {
        for (top, bottom) in pairs(&ys) {
            let room = Rect::from_min_max(pos2(left, top), pos2(right, bottom));
            let covers = |place: &Rect| room.shrink(0.5).intersects(*place);
            if !without.iter().any(covers) && worth(room) > most {
                most = worth(room);
                best = room;
            }
        }
    }
    best
}

/// Rates `room` for a window of `size`: the visible area of the window, less the area of the
/// panel that it covers.
pub fn worth(room: Rect, size: Vec2, placed: &[View]) -> f32 {
    let window = size.min(room.size());
    let corner = pos2(room.right() - window.x, room.top());
    let window = Rect::from_min_size(corner, window);
    let covered = placed.iter().map(|view| view.whole().intersect(window));
    let covered: f32 = covered
        .filter(Rect::is_positive)
        .map(|place| place.area())
        .sum();
    // The visible area counts twice the covered panel; among equals the larger rectangle wins.
    2.0 * window.area() - covered + room.area() / 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::vec2;

    #[test]
    fn no_stop_is_under_a_window_of_help_whatever_the_screen() {
        for (width, height) in [
            (1024.0, 768.0),
            (1280.0, 800.0),
            (1366.0, 768.0),
            (1920.0, 1080.0),
            (3840.0, 2160.0),
            (800.0, 1280.0),
        ] {
            let screen = Rect::from_min_size(pos2(0.0, 28.0), vec2(width, height - 50.0));
            for share in [1.0, 0.6] {
                let panel =
                    Rect::from_min_size(screen.min, vec2(screen.width() * share, screen.height()));
                let placed = placing::views(panel, 1.0);
                let stops = stops(&placed);
                assert_eq!(stops.len(), 3);
                let size = vec2(440.0, 420.0);
                let room = room(screen, &stops, |room| worth(room, size, &placed));
                assert!(screen.contains_rect(room));
                assert!(!stops.iter().any(|stop| stop.shrink(1.0).intersects(room)));
                assert!(room.width() > 330.0, "{width} x {height}: {room}");
                assert!(room.height() > 250.0, "{width} x {height}: {room}");
                if share < 1.0 && width > 1300.0 {
                    assert!(room.right() > panel.right() + 440.0, "beside it: {room}");
                }
            }
        }
    }
}
