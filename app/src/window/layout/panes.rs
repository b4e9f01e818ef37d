//! Divides the window into panes for the panel and the docked views, with splitters between
//! them. In a wide window the panel is in the left column, in a high one below the views.

use egui::{Pos2, Rect, pos2};

use super::{Proportions, Scales, panel_share};
use crate::window::view::View;
use gsk_panel::faceplate::SIZE;

/// Width of a splitter, points.
pub(super) const BAR: f32 = 6.0;
/// Least side of a pane, points.
const LEAST: f32 = 90.0;
/// Numbers of the splitters: between the columns, in the left column, in the right column, and
/// in the single column of a high window. The settings store them.
const COLUMNS: u8 = 0;
const LEFT: u8 = 1;
const RIGHT: u8 = 10;
const SINGLE: u8 = 20;

/// What a pane shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pane {
    Panel,
    /// A docked view.
    View(View),
}

/// The movable bar between two sides that share a rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splitter {
    /// Its number; the settings store its position under this number.
    pub split: u8,
    pub bar: Rect,
    /// The rectangle of both sides, points.
    pub room: Rect,
    /// Whether the sides are beside each other. Otherwise one is above the other.
    pub beside: bool,
}

impl Splitter {
    /// The share of the first side, 0–1, with the bar at `at`.
    pub fn share(&self, at: Pos2) -> f32 {
        let share = match self.beside {
            true => (at.x - self.room.left()) / self.room.width(),
            false => (at.y - self.room.top()) / self.room.height(),
        };
        share.clamp(0.0, 1.0)
    }

    /// The current share of the first side, 0–1.
    pub fn at(&self) -> f32 {
        self.share(self.bar.center())
    }
}

/// The panes and splitters of the window.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arranged {
    /// Each pane with its rectangle, the panel first.
    pub panes: Vec<(Pane, Rect)>,
    pub splitters: Vec<Splitter>,
    /// The tab bar, where only one pane fits.
    pub turns: Option<InTurn>,
}

/// The tab bar that switches between panes, of which one is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct InTurn {
    /// The rectangle of the tab bar.
    pub bar: Rect,
    /// All panes, the panel first.
    pub all: Vec<Pane>,
    /// The arrangement with all panes together.
    pub together: Box<Arranged>,
}

/// Arranges the panel and the docked views in `room`. `share` returns the position of a
/// dragged splitter.
pub fn arrange(
    room: Rect,
    docked: &[View],
    proportions: Proportions,
    scales: Scales,
    share: &dyn Fn(u8) -> Option<f32>,
) -> Arranged {
    let mut arranged = Arranged::default();
    let views: Vec<Pane> = docked.iter().map(|view| Pane::View(*view)).collect();
    if views.is_empty() {
        arranged.panes.push((Pane::Panel, room));
        return arranged;
    }
    if room.height() > room.width() {
        let panel = room.width() * SIZE.1 / SIZE.0 / room.height();
        let panel = panel.clamp(0.3, 0.7);
        let split = share(SINGLE).unwrap_or(1.0 - panel);
        let (above, below) = arranged.split(room, SINGLE, false, split);
        arranged.panes.push((Pane::Panel, below));
        arranged.column(above, &views, SINGLE + 1, share);
        return arranged;
    }
    let below: Vec<Pane> = (views.iter().skip(proportions.below).take(1))
        .copied()
        .collect();
    let beside = views.iter().enumerate();
    let beside: Vec<Pane> = beside
        .filter(|(index, _)| *index != proportions.below)
        .map(|(_, pane)| *pane)
        .collect();
    let panel_share = panel_share(room, proportions.panel_at_most, scales);
    let column = proportions.column.unwrap_or(panel_share);
    let column = match scales.key > 0.0 {
        true => column.max(panel_share),
        false => column,
    };
    let columns = share(COLUMNS).unwrap_or(column);
    let (left, right) = arranged.split(room, COLUMNS, true, columns);
    let panel = if below.is_empty() {
        left
    } else {
        // In a wider column the panel keeps its largest width.
        let panel = match proportions.column {
            Some(_) => left.width().min(panel_share * room.width()),
            None => left.width(),
        };
        let high = (panel * SIZE.1 / SIZE.0 + BAR / 2.0) / left.height();
        let split = share(LEFT).unwrap_or(high.clamp(0.3, 0.7));
        let (above, rest) = arranged.split(left, LEFT, false, split);
        arranged.column(rest, &below, LEFT + 1, share);
        above
    };
    arranged.panes.insert(0, (Pane::Panel, panel));
    arranged.column(right, &beside, RIGHT, share);
    arranged
}

impl Arranged {
    /// Stacks `panes` in `room`, one above the other. `split` is the number of the first
    /// splitter.
    fn column(&mut self, room: Rect, panes: &[Pane], split: u8, share: &dyn Fn(u8) -> Option<f32>) {
        match panes {
            [] => {}
            [only] => self.panes.push((*only, room)),
            [first, rest @ ..] => {
                let even = 1.0 / panes.len() as f32;
                let at = share(split).unwrap_or(even);
                let (above, below) = self.split(room, split, false, at);
                self.panes.push((*first, above));
                self.column(below, rest, split + 1, share);
            }
        }
    }

    /// Divides `room` in two with a splitter between. No side becomes smaller than [`LEAST`].
    fn split(&mut self, room: Rect, split: u8, beside: bool, share: f32) -> (Rect, Rect) {
        let length = if beside { room.width() } else { room.height() };
        let least = LEAST.min(length / 2.0);
        let at = (length * share).clamp(least, (length - least).max(least));
        let (end, begin) = (at - BAR / 2.0, at + BAR / 2.0);
        let place = |along: f32, last: bool| match (beside, last) {
            (true, false) => pos2(room.left() + along, room.top()),
            (true, true) => pos2(room.left() + along, room.bottom()),
            (false, false) => pos2(room.left(), room.top() + along),
            (false, true) => pos2(room.right(), room.top() + along),
        };
        self.splitters.push(Splitter {
            split,
            bar: Rect::from_min_max(place(end, false), place(begin, true)),
            room,
            beside,
        });
        (
            Rect::from_min_max(room.min, place(end, true)),
            Rect::from_min_max(place(begin, false), room.max),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::vec2;

    use super::super::LARGE_PANEL;

    const PLAIN: Scales = Scales {
        pixels_per_point: 1.0,
        key: 0.0,
    };
    const VIEWS: [View; 4] = [View::Bench, View::Ladder, View::Scope, View::Link];

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
                    let arranged = arrange(room, &VIEWS[..count], LARGE_PANEL, PLAIN, &|_| share);
                    let panes = &arranged.panes;
                    assert_eq!(panes.len(), count + 1);
                    assert_eq!(panes[0].0, Pane::Panel);
                    for (index, (pane, place)) in panes.iter().enumerate() {
                        assert!(room.expand(0.01).contains_rect(*place), "{pane:?} {place}");
                        let apart = |other: &(Pane, Rect)| !other.1.shrink(0.1).intersects(*place);
                        assert!(panes[index + 1..].iter().all(apart), "{pane:?} {size}");
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
            (3840.0, 2110.0, 4.0),
        ] {
            let room = Rect::from_min_size(Pos2::ZERO, vec2(width, height));
            let arranged = arrange(room, &VIEWS[..1], LARGE_PANEL, PLAIN, &|_| None);
            let panel = arranged.panes[0].1.width();
            assert!((panel - 640.0 * pixels).abs() <= BAR, "{panel} of {width}");
        }
    }

    #[test]
    fn a_bar_stands_where_it_is_dragged_to() {
        let room = Rect::from_min_size(pos2(0.0, 28.0), vec2(1000.0, 700.0));
        let arranged = arrange(room, &VIEWS[..1], LARGE_PANEL, PLAIN, &|_| None);
        let share = arranged.splitters[0].share(pos2(412.0, 300.0));
        let dragged = arrange(room, &VIEWS[..1], LARGE_PANEL, PLAIN, &|_| Some(share));
        assert!((dragged.splitters[0].bar.center().x - 412.0).abs() < 0.01);
    }
}
