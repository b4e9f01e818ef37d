//! The room of the window shared out: the panel and the docked views in panes, with
//! splitters between them. In a wide window the panel stands in the left column, in a
//! high one below the views.

use egui::{Pos2, Rect, pos2};

use super::{Proportions, Scales, panel_share};
use crate::window::view::View;
use gsk_panel::faceplate::SIZE;

/// Width of a splitter, points.
pub(super) const BAR: f32 = 6.0;
/// Least side of a pane, points.
const LEAST: f32 = 90.0;
/// Numbers of splitters: between the columns, in the left, in the right column, and in
/// the single column of a high window.
const COLUMNS: u8 = 0;
const LEFT: u8 = 1;
const RIGHT: u8 = 10;
const SINGLE: u8 = 20;

/// What a pane shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pane {
    /// The panel.
    Panel,
    /// A docked view.
    View(View),
}

/// A bar between two sides that share a room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splitter {
    /// Its number.
    pub split: u8,
    /// Where it is.
    pub bar: Rect,
    /// The room of both sides.
    pub room: Rect,
    /// The sides are beside each other, not one above the other.
    pub beside: bool,
}

impl Splitter {
    /// The share of the first side when the bar lies at a place.
    pub fn share(&self, at: Pos2) -> f32 {
        let share = match self.beside {
            true => (at.x - self.room.left()) / self.room.width(),
            false => (at.y - self.room.top()) / self.room.height(),
        };
        share.clamp(0.0, 1.0)
    }

    /// The share of the first side as it is.
    pub fn at(&self) -> f32 {
        self.share(self.bar.center())
    }
}

/// The room shared out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arranged {
    /// The panes, the panel first.
    pub panes: Vec<(Pane, Rect)>,
    /// The bars between them.
    pub splitters: Vec<Splitter>,
    /// What else there is, if one pane is all that is shown.
    pub turns: Option<InTurn>,
}

/// What there is beside the one pane that is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct InTurn {
    /// The bar to change from one to another.
    pub bar: Rect,
    /// All panes, the panel first.
    pub all: Vec<Pane>,
    /// How they would stand together.
    pub together: Box<Arranged>,
}

/// Shares out a room. `share` is where a splitter was dragged to.
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
        // In a column of its own width the panel is as large as it wants to be.
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
    /// Panes one above the other.
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

    /// Cuts a room in two with a bar between, no side smaller than can be used.
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
