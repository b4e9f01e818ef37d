//! Shows panel and docked views as tabs, one at a time, where the window is too small for all
//! of them (WINDOW-22).

use egui::{Rect, Vec2};

use super::Scales;
use super::panes::{Arrangement, PaneTabs, WindowPane};
use crate::placement::panel_placement;
use crate::view::ViewId;

/// Height of the tab bar, points: large enough for fingers.
const TAB_BAR_HEIGHT: f32 = 42.0;
/// Share of a view's minimum size that its pane must have, in width and height. A pane that is
/// a little lower scrolls.
pub const MIN_SHARE: Vec2 = Vec2::new(0.95, 0.6);

/// Whether a pane is too small for its content: the LCD has fewer pixels than dots, the
/// legends or keys are smaller than the limit, or a view is smaller than its minimum size.
pub fn is_crowded(arranged: &Arrangement, scales: Scales) -> bool {
    if arranged.panes.len() < 2 {
        return false;
    }
    arranged.panes.iter().any(|(pane, place)| match pane {
        WindowPane::Panel => {
            let dot = panel_placement::lcd_zoom(*place, scales.pixels_per_point);
            let legend = panel_placement::legend_height(*place, scales.pixels_per_point);
            dot < 0.98
                || legend < scales.min_legend_height * 0.98
                || panel_placement::min_key_size(*place) < scales.min_key_size * 0.98
        }
        WindowPane::View(view) => {
            let least = Vec2::from(view.row().min_size) * MIN_SHARE;
            place.width() < least.x || place.height() < least.y
        }
    })
}

/// Arranges one pane, that of `front`, in `bounds` below a tab bar.
pub fn arrange_as_tabs(
    bounds: Rect,
    all_together: Arrangement,
    front: Option<ViewId>,
) -> Arrangement {
    let all: Vec<WindowPane> = all_together.panes.iter().map(|(pane, _)| *pane).collect();
    let front = front.map_or(WindowPane::Panel, WindowPane::View);
    let front = if all.contains(&front) {
        front
    } else {
        WindowPane::Panel
    };
    let (bar, below) =
        bounds.split_top_bottom_at_y(bounds.top() + TAB_BAR_HEIGHT.min(bounds.height() / 2.0));
    Arrangement {
        panes: vec![(front, below)],
        splitters: Vec::new(),
        tabs: Some(PaneTabs {
            bar,
            all,
            all_together: Box::new(all_together),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Layouts, WindowLayout};
    use super::*;
    use egui::{pos2, vec2};

    fn room(width: f32, height: f32) -> Rect {
        Rect::from_min_size(pos2(0.0, 28.0), vec2(width, height - 50.0))
    }

    fn with_keys(min_key_size: f32) -> Scales {
        Scales {
            min_key_size,
            ..Scales::new(1.0)
        }
    }

    fn shown_panes(layouts: &Layouts, room: Rect, key: f32) -> Vec<WindowPane> {
        let arranged = layouts.arrange(room, with_keys(key));
        arranged.panes.iter().map(|(pane, _)| *pane).collect()
    }

    #[test]
    fn views_that_do_not_fit_become_tabs() {
        let mut layouts = Layouts::with_layout(WindowLayout::Machine);
        let small = room(1024.0, 768.0);
        let machine = WindowPane::View(ViewId::Machine);
        assert_eq!(
            shown_panes(&layouts, small, 0.0),
            [WindowPane::Panel, machine]
        );
        layouts.dock(ViewId::Data);
        assert_eq!(
            shown_panes(&layouts, small, 0.0),
            [WindowPane::View(ViewId::Data)]
        );
        assert_eq!(shown_panes(&layouts, room(1920.0, 1080.0), 0.0).len(), 3);
        layouts.bring_to_front(None);
        assert_eq!(shown_panes(&layouts, small, 0.0), [WindowPane::Panel]);
        let turns = layouts.arrange(small, Scales::new(1.0)).tabs.unwrap();
        assert_eq!(
            turns.all,
            [WindowPane::Panel, machine, WindowPane::View(ViewId::Data)]
        );
        layouts.keep_together(&turns.all_together);
        assert_eq!(shown_panes(&layouts, small, 0.0).len(), 3);
        layouts.set_share(0, None);
        assert_eq!(shown_panes(&layouts, small, 0.0), [WindowPane::Panel]);
        // Closing the front view shows the panel.
        layouts.dock(ViewId::Data);
        layouts.toggle(ViewId::Data);
        assert_eq!(
            shown_panes(&layouts, small, 0.0),
            [WindowPane::Panel, machine]
        );
    }

    #[test]
    fn the_time_line_does_not_turn_views_into_tabs() {
        let layouts = Layouts::with_layout(WindowLayout::Learner);
        let whole = room(1366.0, 768.0);
        let above = whole.with_max_y(whole.bottom() - crate::chrome::timeline::HEIGHT);
        let shown = |room, scales| layouts.arrange(room, scales).panes.len();
        let all = shown(whole, Scales::new(1.0));
        assert!(all > 2);
        assert_eq!(shown(above, Scales::new(1.0)), 1);
        let scales = Scales {
            min_legend_height: panel_placement::MIN_LEGEND_HEIGHT_ABOVE_TIME_LINE,
            ..Scales::new(1.0)
        };
        assert_eq!(shown(above, scales), all);
    }

    #[test]
    fn keys_are_for_fingers_also_beside_a_view() {
        let key = panel_placement::FINGER_KEY_SIZE;
        for (width, height) in [
            (1024.0, 768.0),
            (1280.0, 800.0),
            (1366.0, 768.0),
            (1920.0, 1080.0),
            (800.0, 1280.0),
        ] {
            for layout in [
                WindowLayout::Machine,
                WindowLayout::Programmer,
                WindowLayout::Instructor,
            ] {
                let layouts = Layouts::with_layout(layout);
                let arranged = layouts.arrange(room(width, height), with_keys(key));
                let (pane, place) = arranged.panes[0];
                assert_eq!(pane, WindowPane::Panel);
                let least = panel_placement::min_key_size(place);
                assert!(least > key * 0.97, "{least} in {width} x {height}");
            }
        }
        let wide = room(1920.0, 1080.0);
        let layouts = Layouts::with_layout(WindowLayout::Machine);
        assert_eq!(
            shown_panes(&layouts, wide, key).len(),
            2,
            "there is room for both"
        );
    }
}
