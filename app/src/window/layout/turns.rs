//! Shows panel and docked views as tabs, one at a time, where the window is too small for all
//! of them (WINDOW-22).

use egui::{Rect, Vec2};

use super::panes::{Arranged, InTurn, Pane};
use super::{Scales, UNITS_A_DOT};
use crate::window::placing;
use crate::window::view::View;

/// Height of the tab bar, points: large enough for fingers.
const BAR: f32 = 42.0;
/// Share of a view's least window size that a pane must have. A pane that is a little lower
/// scrolls.
const ENOUGH: Vec2 = Vec2::new(0.95, 0.7);

/// Whether a pane is too small for its content: the LCD has fewer pixels than dots, the keys
/// are smaller than the limit, or a view is smaller than its least size.
pub fn is_crowded(arranged: &Arranged, scales: Scales) -> bool {
    if arranged.panes.len() < 2 {
        return false;
    }
    arranged.panes.iter().any(|(pane, place)| match pane {
        Pane::Panel => {
            let scale = placing::whole_scale(place.size());
            let dot = scale * UNITS_A_DOT * scales.pixels_per_point;
            dot < 0.98 || placing::least_key(*place) < scales.key * 0.98
        }
        Pane::View(view) => {
            let least = Vec2::from(view.row().least) * ENOUGH;
            place.width() < least.x || place.height() < least.y
        }
    })
}

/// Shows one pane in `room`, below the tab bar.
pub fn in_turn(room: Rect, together: Arranged, front: Option<View>) -> Arranged {
    let all: Vec<Pane> = together.panes.iter().map(|(pane, _)| *pane).collect();
    let front = front.map_or(Pane::Panel, Pane::View);
    let front = if all.contains(&front) {
        front
    } else {
        Pane::Panel
    };
    let (bar, below) = room.split_top_bottom_at_y(room.top() + BAR.min(room.height() / 2.0));
    Arranged {
        panes: vec![(front, below)],
        splitters: Vec::new(),
        turns: Some(InTurn {
            bar,
            all,
            together: Box::new(together),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Layout, Layouts};
    use super::*;
    use egui::{pos2, vec2};

    fn room(width: f32, height: f32) -> Rect {
        Rect::from_min_size(pos2(0.0, 28.0), vec2(width, height - 50.0))
    }

    fn shown(layouts: &Layouts, room: Rect, key: f32) -> Vec<Pane> {
        let arranged = layouts.arrange(room, 1.0, key);
        arranged.panes.iter().map(|(pane, _)| *pane).collect()
    }

    #[test]
    fn what_has_no_room_beside_the_panel_is_shown_in_turn() {
        let mut layouts = Layouts::of(Layout::Machine);
        let small = room(1024.0, 768.0);
        let machine = Pane::View(View::Machine);
        assert_eq!(shown(&layouts, small, 0.0), [Pane::Panel, machine]);
        layouts.dock(View::Data);
        assert_eq!(shown(&layouts, small, 0.0), [Pane::View(View::Data)]);
        assert_eq!(shown(&layouts, room(1920.0, 1080.0), 0.0).len(), 3);
        layouts.bring(None);
        assert_eq!(shown(&layouts, small, 0.0), [Pane::Panel]);
        let turns = layouts.arrange(small, 1.0, 0.0).turns.unwrap();
        assert_eq!(turns.all, [Pane::Panel, machine, Pane::View(View::Data)]);
        layouts.keep_together(&turns.together);
        assert_eq!(shown(&layouts, small, 0.0).len(), 3);
        layouts.set_share(0, None);
        assert_eq!(shown(&layouts, small, 0.0), [Pane::Panel]);
        // Closing the front view shows the panel.
        layouts.dock(View::Data);
        layouts.toggle(View::Data);
        assert_eq!(shown(&layouts, small, 0.0), [Pane::Panel, machine]);
    }

    #[test]
    fn keys_are_for_fingers_also_beside_a_view() {
        let key = placing::FINGER;
        for (width, height) in [
            (1024.0, 768.0),
            (1280.0, 800.0),
            (1366.0, 768.0),
            (1920.0, 1080.0),
            (800.0, 1280.0),
        ] {
            for layout in [Layout::Machine, Layout::Programmer, Layout::Instructor] {
                let layouts = Layouts::of(layout);
                let arranged = layouts.arrange(room(width, height), 1.0, key);
                let (pane, place) = arranged.panes[0];
                assert_eq!(pane, Pane::Panel);
                let least = placing::least_key(place);
                assert!(least > key * 0.97, "{least} in {width} x {height}");
            }
        }
        let wide = room(1920.0, 1080.0);
        let layouts = Layouts::of(Layout::Machine);
        assert_eq!(
            shown(&layouts, wide, key).len(),
            2,
            "there is room for both"
        );
    }
}
