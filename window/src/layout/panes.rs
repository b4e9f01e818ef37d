//! Divides the window into panes for the panel and the docked views, with splitters between
//! them. In a wide window the panel is in the left column, in a high one below the views.

use egui::{Pos2, Rect, pos2};

use super::{Proportions, Scales, panel_share};
use crate::placement::panel_placement;
use crate::view::ViewId;
use gsk_panel::faceplate::SIZE;

/// Width of a splitter, points.
pub(super) const SPLITTER_WIDTH: f32 = 6.0;
/// Minimum width and height of a pane, points.
const MIN_PANE_SIDE: f32 = 90.0;
/// Least width of a strip below a view: text and buttons of the time line, points.
const STRIP_WIDTH: f32 = 480.0;
/// Height that each of several views keeps above a square panel, points.
const ROOMY_VIEW: f32 = 360.0;
/// Height of a pane with the picture of the lathe among three and more stacked panes, divided by
/// that of another one.
const PICTURE_WEIGHT: f32 = 1.15;
/// Number of the splitter between the columns; the settings store the numbers. The constants
/// after it number the splitters in the left column, in the right column, and in the single
/// column of a high window.
const COLUMN_SPLIT: u8 = 0;
const LEFT_SPLIT: u8 = 1;
const RIGHT_SPLIT: u8 = 10;
const SINGLE_SPLIT: u8 = 20;

/// What a pane shows: the panel or a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WindowPane {
    Panel,
    /// The pane shows this docked view.
    View(ViewId),
}

/// A movable bar between two sides that share a rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splitter {
    /// Number of the splitter, under which the settings store its position.
    pub split: u8,
    pub bar: Rect,
    /// The rectangle that both sides of the splitter fill, points.
    pub bounds: Rect,
    /// True if the sides are beside each other, false if one is above the other.
    pub is_side_by_side: bool,
}

impl Splitter {
    /// The share of the first side, 0–1, with the bar at `position`.
    pub fn share_at(&self, position: Pos2) -> f32 {
        let share = match self.is_side_by_side {
            true => (position.x - self.bounds.left()) / self.bounds.width(),
            false => (position.y - self.bounds.top()) / self.bounds.height(),
        };
        share.clamp(0.0, 1.0)
    }

    /// Returns the current share of the first side, 0 to 1.
    pub fn current_share(&self) -> f32 {
        self.share_at(self.bar.center())
    }
}

/// Share of the first of `count` stacked panes whose splitter was not dragged. Among three and more
/// the picture of the lathe is higher than the others, which can be scrolled.
fn share_of_first(first: WindowPane, count: usize) -> f32 {
    let is_picture = matches!(first, WindowPane::View(ViewId::Machine | ViewId::Lathe));
    let weight = if is_picture && count > 2 {
        PICTURE_WEIGHT
    } else {
        1.0
    };
    weight / (weight + count.saturating_sub(1) as f32)
}

/// The rectangles of panes and splitters in the window.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrangement {
    /// Each pane with its rectangle, the panel first.
    pub panes: Vec<(WindowPane, Rect)>,
    pub splitters: Vec<Splitter>,
    /// The tab bar; `None` if all panes fit together.
    pub tabs: Option<PaneTabs>,
}

/// The tab bar with which the operator switches between panes, of which one is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct PaneTabs {
    /// The rectangle of the tab bar, points.
    pub bar: Rect,
    /// All panes that the tab bar offers, the panel first.
    pub all: Vec<WindowPane>,
    /// The arrangement that shows all panes together.
    pub all_together: Box<Arrangement>,
}

/// Arranges the panel and the docked views in `bounds`. `dragged_share` returns the share of
/// the first side of a splitter, 0–1, or `None` if it was not dragged.
pub fn arrange_panes(
    bounds: Rect,
    docked: &[ViewId],
    proportions: Proportions,
    scales: Scales,
    dragged_share: &dyn Fn(u8) -> Option<f32>,
) -> Arrangement {
    let mut arranged = Arrangement::default();
    let views: Vec<WindowPane> = docked.iter().map(|view| WindowPane::View(*view)).collect();
    if views.is_empty() {
        arranged.panes.push((WindowPane::Panel, bounds));
        return arranged;
    }
    if bounds.height() > bounds.width() {
        // The panel has a square, for an LCD above its keys, if the views have room above it.
        let rest = bounds.height() - bounds.width();
        let panel_height = match views.len() == 1 || rest >= ROOMY_VIEW * views.len() as f32 {
            true => bounds.width(),
            false => bounds.width() * SIZE.1 / SIZE.0,
        };
        let panel_height_share = panel_height / bounds.height();
        let panel_height_share = panel_height_share.clamp(0.3, 0.7);
        let split = dragged_share(SINGLE_SPLIT).unwrap_or(1.0 - panel_height_share);
        let (above, below) = arranged.split(bounds, SINGLE_SPLIT, false, split);
        arranged.panes.push((WindowPane::Panel, below));
        arranged.stack_panes(above, &views, SINGLE_SPLIT + 1, dragged_share);
        return arranged;
    }
    let panel_share = panel_share(bounds, proportions.max_panel_share, scales);
    let column = proportions.column_share.unwrap_or(panel_share);
    let column = match scales.min_key_size > 0.0 {
        true => column.max(panel_share),
        false => column,
    };
    let columns = dragged_share(COLUMN_SPLIT).unwrap_or(column);
    let (left, right) = arranged.split(bounds, COLUMN_SPLIT, true, columns);
    // Where the legends would be too small above a view, or the LCD could have larger dots, the
    // panel has the column alone.
    let is_readable_above_view = || {
        let height =
            (left.width() * SIZE.1 / SIZE.0).clamp(left.height() * 0.3, left.height() * 0.7);
        let above = Rect::from_min_size(left.min, egui::vec2(left.width(), height));
        let legend = |room| panel_placement::legend_height(room, scales.pixels_per_point);
        let zoom = |room| panel_placement::lcd_zoom(room, scales.pixels_per_point);
        let is_readable = legend(above) >= scales.min_legend_height;
        // Three views in the other column would be too low.
        let has_large_dots = zoom(above) >= zoom(left).min(2.0) || views.len() > 2;
        (is_readable || legend(left) <= legend(above)) && has_large_dots
    };
    let index_below = proportions.view_below_panel;
    let has_view_below = views.len() > index_below
        && (dragged_share(LEFT_SPLIT).is_some() || is_readable_above_view());
    let mut beside = views;
    let below: Vec<WindowPane> = match has_view_below {
        true => vec![beside.remove(index_below)],
        false => Vec::new(),
    };
    let panel = if below.is_empty() {
        left
    } else {
        // In a wider column the panel keeps its largest width.
        let panel = match proportions.column_share {
            Some(_) => left.width().min(panel_share * bounds.width()),
            None => left.width(),
        };
        let panel_height_share = (panel * SIZE.1 / SIZE.0 + SPLITTER_WIDTH / 2.0) / left.height();
        let split = dragged_share(LEFT_SPLIT).unwrap_or(panel_height_share.clamp(0.3, 0.7));
        let (above, rest) = arranged.split(left, LEFT_SPLIT, false, split);
        arranged.stack_panes(rest, &below, LEFT_SPLIT + 1, dragged_share);
        above
    };
    arranged.panes.insert(0, (WindowPane::Panel, panel));
    arranged.stack_panes(right, &beside, RIGHT_SPLIT, dragged_share);
    arranged
}

impl Arrangement {
    /// Takes a strip of this height from the lower end of the last view beside or above the panel,
    /// so that no key of the panel changes its place. `None` without a view that is large enough.
    pub fn take_strip(&mut self, height: f32) -> Option<Rect> {
        if self.tabs.is_some() {
            return None;
        }
        let views = self.panes.iter_mut().filter_map(|(pane, bounds)| {
            let is_large =
                bounds.width() >= STRIP_WIDTH && bounds.height() >= height + MIN_PANE_SIDE;
            (*pane != WindowPane::Panel && is_large).then_some(bounds)
        });
        let end = |bounds: &Rect| (bounds.left(), bounds.bottom());
        let view = views.max_by(|one, other| {
            let (one, other) = (end(one), end(other));
            one.0.total_cmp(&other.0).then(one.1.total_cmp(&other.1))
        })?;
        let (rest, strip) = view.split_top_bottom_at_y(view.bottom() - height);
        *view = rest;
        Some(strip)
    }

    /// Stacks `panes` in `room`, one above the other, with splitters between them. `split` is
    /// the number of the first splitter.
    fn stack_panes(
        &mut self,
        room: Rect,
        panes: &[WindowPane],
        split: u8,
        share: &dyn Fn(u8) -> Option<f32>,
    ) {
        match panes {
            [] => {}
            [only] => self.panes.push((*only, room)),
            [first, rest @ ..] => {
                let at = share(split).unwrap_or_else(|| share_of_first(*first, panes.len()));
                let (above, below) = self.split(room, split, false, at);
                self.panes.push((*first, above));
                self.stack_panes(below, rest, split + 1, share);
            }
        }
    }

    /// Divides `room` in two with a splitter between, and returns both sides. No side becomes
    /// smaller than [`MIN_PANE_SIDE`].
    fn split(&mut self, room: Rect, split: u8, is_side_by_side: bool, share: f32) -> (Rect, Rect) {
        let length = if is_side_by_side {
            room.width()
        } else {
            room.height()
        };
        let min_side = MIN_PANE_SIDE.min(length / 2.0);
        let at = (length * share).clamp(min_side, (length - min_side).max(min_side));
        let (end, begin) = (at - SPLITTER_WIDTH / 2.0, at + SPLITTER_WIDTH / 2.0);
        let corner = |along: f32, last: bool| match (is_side_by_side, last) {
            (true, false) => pos2(room.left() + along, room.top()),
            (true, true) => pos2(room.left() + along, room.bottom()),
            (false, false) => pos2(room.left(), room.top() + along),
            (false, true) => pos2(room.right(), room.top() + along),
        };
        self.splitters.push(Splitter {
            split,
            bar: Rect::from_min_max(corner(end, false), corner(begin, true)),
            bounds: room,
            is_side_by_side,
        });
        (
            Rect::from_min_max(room.min, corner(end, true)),
            Rect::from_min_max(corner(begin, false), room.max),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::vec2;

    use super::super::LARGE_PANEL;

    const TEST_SCALES: Scales = Scales::new(1.0);
    const VIEWS: [ViewId; 4] = [ViewId::Bench, ViewId::Ladder, ViewId::Scope, ViewId::Link];

    #[test]
    fn panes_fill_the_room_without_overlapping_whatever_is_dragged() {
        for size in [
            vec2(1366.0, 718.0),
            vec2(800.0, 1230.0),
            vec2(3840.0, 2110.0),
            vec2(480.0, 280.0),
        ] {
            let room = Rect::from_min_size(pos2(0.0, 28.0), size);
            for count in 0..=VIEWS.len() {
                for share in [None, Some(0.0), Some(0.3), Some(1.0)] {
                    let arranged =
                        arrange_panes(room, &VIEWS[..count], LARGE_PANEL, TEST_SCALES, &|_| share);
                    let panes = &arranged.panes;
                    assert_eq!(panes.len(), count + 1);
                    assert_eq!(panes[0].0, WindowPane::Panel);
                    for (index, (pane, place)) in panes.iter().enumerate() {
                        assert!(room.expand(0.01).contains_rect(*place), "{pane:?} {place}");
                        let is_separate =
                            |other: &(WindowPane, Rect)| !other.1.shrink(0.1).intersects(*place);
                        assert!(
                            panes[index + 1..].iter().all(is_separate),
                            "{pane:?} {size}"
                        );
                    }
                    let bars = arranged.splitters.iter().map(|it| it.bar.area());
                    let area = panes.iter().map(|(_, place)| place.area()).sum::<f32>();
                    let all = area + bars.sum::<f32>();
                    assert!((all - room.area()).abs() < 10.0, "{all} {size}");
                }
            }
        }
    }

    #[test]
    fn beside_a_view_the_lcd_has_whole_pixels() {
        for (width, height, pixels) in [
            (1366.0, 718.0, 1.0),
            (1920.0, 1030.0, 2.0),
            (3840.0, 2110.0, 3.0),
        ] {
            let room = Rect::from_min_size(Pos2::ZERO, vec2(width, height));
            let arranged = arrange_panes(room, &VIEWS[..1], LARGE_PANEL, TEST_SCALES, &|_| None);
            let zoom = panel_placement::lcd_zoom(arranged.panes[0].1, 1.0);
            assert!((zoom - pixels).abs() < 0.01, "{zoom} of {width}");
        }
    }

    #[test]
    fn a_splitter_stays_where_it_is_dragged_to() {
        let room = Rect::from_min_size(pos2(0.0, 28.0), vec2(1000.0, 700.0));
        let arranged = arrange_panes(room, &VIEWS[..1], LARGE_PANEL, TEST_SCALES, &|_| None);
        let share = arranged.splitters[0].share_at(pos2(412.0, 300.0));
        let dragged = arrange_panes(room, &VIEWS[..1], LARGE_PANEL, TEST_SCALES, &|_| {
            Some(share)
        });
        assert!((dragged.splitters[0].bar.center().x - 412.0).abs() < 0.01);
    }
}
