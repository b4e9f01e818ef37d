//! Finds space for windows inside the main window that covers no key that stops the machine
//! (WINDOW-25).

use egui::{Context, Id, Rect, Vec2, pos2};

use super::panel_placement::{self, PlacedArea};

/// Margin that is kept free around each stop key, points.
const KEY_MARGIN: f32 = 4.0;

/// The rectangles of those placed keys that stop the machine, with their margin, points.
pub fn stop_key_rects(placed: &[PlacedArea]) -> Vec<Rect> {
    let parts = panel_placement::stop_key_parts();
    let places =
        parts.filter_map(|part| Some(panel_placement::area_of_part(placed, part)?.part_rect(part)));
    places.map(|place| place.expand(KEY_MARGIN)).collect()
}

/// Stores the rectangles of the keys that stop the machine in the context, for windows that
/// views draw.
pub fn store_stop_keys(context: &Context, placed: &[PlacedArea]) {
    let stops = stop_key_rects(placed);
    context.data_mut(|data| data.insert_temp(stop_keys_id(), stops));
}

/// The stored rectangles of the keys that stop the machine in the main window, from the last
/// frame.
pub fn stored_stop_keys(context: &Context) -> Vec<Rect> {
    let stops = context.data(|data| data.get_temp(stop_keys_id()));
    stops.unwrap_or_default()
}

fn stop_keys_id() -> Id {
    Id::unique("stops")
}

/// The rectangle of the window, clear of the keys that stop the machine, that shows most of a
/// dialog of `size`.
pub fn free_rect(context: &Context, size: Vec2) -> Rect {
    let mut screen = context.content_rect();
    screen.min.y += crate::TOP_BAR_HEIGHT;
    best_rect(screen, &stored_stop_keys(context), |room| {
        visible_area(room, size)
    })
}

/// Rates `candidate` for a window of `size` that may cover everything else: by the visible
/// area of the window; among equals the larger rectangle wins.
pub fn visible_area(candidate: Rect, size: Vec2) -> f32 {
    let visible = size.min(candidate.size());
    visible.x * visible.y + candidate.area() / 1000.0
}

/// The rectangle inside `screen` with the highest `rate` that intersects none of `obstacles`.
pub fn best_rect(screen: Rect, obstacles: &[Rect], rate: impl Fn(Rect) -> f32) -> Rect {
    let edges = |low: f32, high: f32, edges_of: &dyn Fn(&Rect) -> [f32; 2]| {
        let inside = obstacles.iter().flat_map(edges_of);
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
    let mut best_rating = f32::NEG_INFINITY;
    for (left, right) in pairs(&xs) {
        for (top, bottom) in pairs(&ys) {
            let candidate = Rect::from_min_max(pos2(left, top), pos2(right, bottom));
            let covers = |place: &Rect| candidate.shrink(0.5).intersects(*place);
            if !obstacles.iter().any(covers) && rate(candidate) > best_rating {
                best_rating = rate(candidate);
                best = candidate;
            }
        }
    }
    best
}

/// Rates `candidate` for a window of `size`: by the visible area of the window, less the area
/// of the panel that it covers.
pub fn rate_beside_panel(candidate: Rect, size: Vec2, placed: &[PlacedArea]) -> f32 {
    let window = size.min(candidate.size());
    let corner = pos2(candidate.right() - window.x, candidate.top());
    let window = Rect::from_min_size(corner, window);
    let covered = placed.iter().map(|view| view.bounds().intersect(window));
    let covered: f32 = covered
        .filter(Rect::is_positive)
        .map(|place| place.area())
        .sum();
    // The visible area counts twice the covered panel; among equals the larger rectangle wins.
    2.0 * window.area() - covered + candidate.area() / 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::vec2;

    #[test]
    fn help_covers_no_stop_key_on_any_screen() {
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
                let placed = panel_placement::place_panel(panel, 1.0);
                let stops = stop_key_rects(&placed);
                assert_eq!(stops.len(), 3);
                let size = vec2(440.0, 420.0);
                let room = best_rect(screen, &stops, |room| {
                    rate_beside_panel(room, size, &placed)
                });
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
