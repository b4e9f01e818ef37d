//! Layouts of the window: which views are docked beside the panel, and how the room is
//! shared. Everything here is remembered from one start to the next.

pub mod floating;
mod panes;
mod splitters;
mod turns;

use std::collections::BTreeMap;

use egui::{Event, Key, Rect};
use serde::{Deserialize, Serialize};

use super::placing;
use super::view::{View, shifted};
use gsk_messages::{Message, say};
use panes::BAR;
pub use panes::{Arranged, InTurn, Pane, arrange};
pub use splitters::drag;
use turns::in_turn;

/// Units a pixel of the LCD's dots: the panel is drawn with half a dot a unit.
const UNITS_A_DOT: f32 = 2.0;

/// How a layout shares out a wide window as long as nobody drags a splitter.
#[derive(Clone, Copy, Debug)]
pub struct Proportions {
    /// The most of the window's width that the panel takes.
    panel_at_most: f32,
    /// Share of the column that the panel stands in; None: as wide as the panel.
    column: Option<f32>,
    /// Which of the docked views stands below the panel, counted from 0.
    below: usize,
}

/// The panel as large as it goes.
const LARGE_PANEL: Proportions = Proportions {
    panel_at_most: 0.75,
    column: None,
    below: 2,
};

/// A layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Layout {
    /// The panel alone.
    Panel,
    /// Panel and machine.
    Machine,
    /// Program text, machine and a smaller panel: for whoever writes programs.
    Programmer,
    /// Panel, machine, scope and fault bench: for whoever teaches.
    Instructor,
    /// Panel and lessons beside the machine: for the operator in training.
    Learner,
}

/// A row of the table of layouts.
pub struct LayoutRow {
    /// The layout.
    pub layout: Layout,
    /// Its name.
    pub name: fn() -> Message,
    /// The key that chooses it, with Shift.
    pub key: Key,
    /// What is docked in it as long as nobody has changed it.
    docked: &'static [View],
    proportions: Proportions,
}

/// The layouts in the order of the menu.
pub static LAYOUTS: [LayoutRow; 5] = [
    LayoutRow {
        layout: Layout::Panel,
        name: say::window_layout_panel,
        key: Key::F6,
        docked: &[],
        proportions: LARGE_PANEL,
    },
    LayoutRow {
        layout: Layout::Machine,
        name: say::window_layout_machine,
        key: Key::F7,
        docked: &[View::Machine],
        proportions: LARGE_PANEL,
    },
    LayoutRow {
        layout: Layout::Programmer,
        name: say::window_layout_programmer,
        key: Key::F8,
        docked: &[View::Program, View::Machine],
        proportions: Proportions {
            panel_at_most: 0.5,
            column: Some(0.5),
            below: 1,
        },
    },
    LayoutRow {
        layout: Layout::Instructor,
        name: say::window_layout_instructor,
        key: Key::F9,
        docked: &[View::Machine, View::Scope, View::Bench],
        proportions: Proportions {
            panel_at_most: 0.5,
            column: None,
            below: 2,
        },
    },
    LayoutRow {
        layout: Layout::Learner,
        name: say::window_layout_learner,
        key: Key::F12,
        docked: &[View::Machine, View::Lesson],
        proportions: Proportions {
            panel_at_most: 0.58,
            column: None,
            below: 1,
        },
    },
];

impl Layout {
    /// The one of the first start: with the machine where the LCD keeps a pixel a dot.
    fn first(room: Rect, pixels_per_point: f32) -> Self {
        match pixels_a_dot(room, LARGE_PANEL.panel_at_most, pixels_per_point) < 1.0 {
            true => Self::Panel,
            false => Self::Machine,
        }
    }

    fn row(self) -> &'static LayoutRow {
        let row = LAYOUTS.iter().find(|row| row.layout == self);
        row.unwrap_or(&LAYOUTS[0])
    }
}

/// The layout that a key chooses.
pub fn chosen(events: &[Event]) -> Option<Layout> {
    let row = LAYOUTS.iter().find(|row| shifted(events, row.key));
    row.map(|row| row.layout)
}

/// Position and size of a window on the screen, points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Place {
    /// Upper left corner, frame and all; None where the system does not tell it.
    pub corner: Option<(i32, i32)>,
    /// Size without the frame.
    pub size: (u32, u32),
}

/// What somebody has made of a layout.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
struct Changes {
    /// The views that are docked, if they are others than those of the table.
    docked: Option<Vec<View>>,
    /// Where splitters were dragged to: share of the first side, thousandths.
    shares: BTreeMap<u8, u16>,
}

/// Where a view goes when it is opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
struct Home {
    /// Into the window, not into one of its own.
    docks: bool,
    /// Its own window, when it was open last.
    place: Option<Place>,
}

/// The layouts as they are remembered.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layouts {
    /// The one in use; none was chosen yet.
    chosen: Option<Layout>,
    changes: BTreeMap<Layout, Changes>,
    homes: BTreeMap<View, Home>,
    /// The main window, when it was not maximized.
    pub window: Option<Place>,
    /// Views in windows of their own; at the start there is none.
    #[serde(skip)]
    floating: Vec<View>,
    /// The system has one window only, as a page in a browser: views are docked.
    #[serde(skip)]
    only_docks: bool,
    /// What is shown where there is no room for panel and views together; none: the panel.
    front: Option<View>,
}

impl Layouts {
    /// With a layout chosen.
    pub fn of(layout: Layout) -> Self {
        Self {
            chosen: Some(layout),
            ..Self::default()
        }
    }

    /// The layout in use.
    pub fn current(&self) -> Layout {
        self.chosen.unwrap_or(Layout::Panel)
    }

    /// At the first start: what the room is large enough for.
    pub fn begin(&mut self, room: Rect, pixels_per_point: f32) {
        let first = || Layout::first(room, pixels_per_point);
        self.chosen.get_or_insert_with(first);
    }

    /// Uses another layout.
    pub const fn choose(&mut self, layout: Layout) {
        self.chosen = Some(layout);
        self.front = None;
    }

    /// The docked views.
    pub fn docked(&self) -> Vec<View> {
        let layout = self.current();
        let changed = self.changes.get(&layout);
        let changed = changed.and_then(|changes| changes.docked.clone());
        changed.unwrap_or_else(|| layout.row().docked.to_vec())
    }

    /// The views in windows of their own.
    pub fn floating(&self) -> Vec<View> {
        let docked = self.docked();
        let own = self.floating.iter().copied();
        own.filter(|view| !docked.contains(view)).collect()
    }

    /// Whether a view is open.
    pub fn is_open(&self, view: View) -> bool {
        self.floating.contains(&view) || self.docked().contains(&view)
    }

    /// Opens a view where it was last, or closes it.
    pub fn toggle(&mut self, view: View) {
        let docked = self.docked().contains(&view);
        if docked || self.floating.contains(&view) {
            self.take_away(view);
            self.home(view).docks = docked;
        } else if self.only_docks || self.home(view).docks {
            self.dock(view);
        } else {
            self.float(view);
        }
    }

    /// Puts a view into the window.
    pub fn dock(&mut self, view: View) {
        self.take_away(view);
        let mut docked = self.docked();
        docked.push(view);
        self.set_docked(docked);
        self.home(view).docks = true;
        self.front = Some(view);
    }

    /// Docks a view without bringing it to the front.
    pub fn dock_beside(&mut self, view: View) {
        let front = self.front;
        self.dock(view);
        self.front = front;
    }

    /// Says whether the system has one window only: views then open in panes, where they
    /// cover no key that stops the machine (WINDOW-25).
    pub const fn set_only_docks(&mut self, only_docks: bool) {
        self.only_docks = only_docks;
    }

    /// Shows a docked view, none: the panel, where there is no room for all of them.
    pub const fn bring(&mut self, front: Option<View>) {
        self.front = front;
    }

    /// Gives a view a window of its own.
    pub fn float(&mut self, view: View) {
        self.take_away(view);
        self.floating.push(view);
        self.home(view).docks = false;
    }

    /// Where a view's own window was last.
    pub fn place(&self, view: View) -> Option<Place> {
        self.homes.get(&view).and_then(|home| home.place)
    }

    /// Remembers where a view's own window is.
    pub fn remember(&mut self, view: View, place: Place) {
        self.home(view).place = Some(place);
    }

    fn home(&mut self, view: View) -> &mut Home {
        let first = || Home {
            docks: view.row().docks,
            place: None,
        };
        self.homes.entry(view).or_insert_with(first)
    }

    fn take_away(&mut self, view: View) {
        self.floating.retain(|open| *open != view);
        let mut docked = self.docked();
        if docked.contains(&view) {
            docked.retain(|open| *open != view);
            self.set_docked(docked);
        }
    }

    fn set_docked(&mut self, docked: Vec<View>) {
        let layout = self.current();
        self.changes.entry(layout).or_default().docked = Some(docked);
    }

    /// The panes in a room: together, or one of them with a bar to change to the others.
    /// Keys are at least so large, points, where there is room for it.
    pub fn arrange(&self, room: Rect, pixels_per_point: f32, key: f32) -> Arranged {
        let shares = self.changes.get(&self.current());
        let share = |split: u8| {
            let share = shares.and_then(|changes| changes.shares.get(&split))?;
            Some(f32::from(*share) / 1000.0)
        };
        let proportions = self.current().row().proportions;
        let scales = Scales {
            pixels_per_point,
            key,
        };
        let together = arrange(room, &self.docked(), proportions, scales, &share);
        // Whoever has dragged a bar wants it so.
        let dragged = shares.is_some_and(|changes| !changes.shares.is_empty());
        match !dragged && turns::is_crowded(&together, scales) {
            true => in_turn(room, together, self.front),
            false => together,
        }
    }

    /// From now on panel and views are shown together, whatever room there is.
    pub fn keep_together(&mut self, arranged: &Arranged) {
        if let Some(splitter) = arranged.splitters.first() {
            self.set_share(splitter.split, Some(splitter.at()));
        }
    }

    /// Moves a splitter; `None`: back to where it stands by itself.
    pub fn set_share(&mut self, split: u8, share: Option<f32>) {
        let layout = self.current();
        let shares = &mut self.changes.entry(layout).or_default().shares;
        match share {
            Some(share) => {
                let thousandths = (share.clamp(0.0, 1.0) * 1000.0).round() as u16;
                shares.insert(split, thousandths);
            }
            None => {
                shares.remove(&split);
            }
        }
    }
}

/// What decides how large the panel is to be.
#[derive(Clone, Copy, Debug)]
pub struct Scales {
    /// Physical pixels a point.
    pixels_per_point: f32,
    /// Least side of a key, points; 0: any.
    key: f32,
}

/// Whole pixels that a dot of the LCD has beside views.
fn pixels_a_dot(room: Rect, at_most: f32, pixels_per_point: f32) -> f32 {
    let at_most = egui::vec2(room.width() * at_most, room.height());
    let scale = placing::whole_scale(at_most) * pixels_per_point;
    (scale * UNITS_A_DOT).floor()
}

/// The share of a room's width that the panel takes by itself beside views: the most
/// that shows the dots of the LCD as whole pixels.
fn panel_share(room: Rect, at_most: f32, scales: Scales) -> f32 {
    // Its pane ends at half a bar.
    let for_keys = (placing::width_for(scales.key) + BAR / 2.0) / room.width();
    dots_share(room, at_most, scales.pixels_per_point).max(for_keys.min(1.0))
}

fn dots_share(room: Rect, at_most: f32, pixels_per_point: f32) -> f32 {
    let pixels_a_dot = pixels_a_dot(room, at_most, pixels_per_point);
    if pixels_a_dot < 1.0 {
        return at_most.min(0.6);
    }
    let width = gsk_panel::faceplate::SIZE.0 * pixels_a_dot / UNITS_A_DOT;
    (width / pixels_per_point / room.width()).min(at_most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_opens_where_it_was_last() {
        let mut layouts = Layouts::of(Layout::Panel);
        layouts.toggle(View::Scope);
        assert_eq!(
            (layouts.floating(), layouts.docked()),
            (vec![View::Scope], vec![])
        );
        layouts.dock(View::Scope);
        assert_eq!(
            (layouts.floating(), layouts.docked()),
            (vec![], vec![View::Scope])
        );
        layouts.toggle(View::Scope);
        assert!(!layouts.is_open(View::Scope));
        layouts.toggle(View::Scope);
        assert_eq!(layouts.docked(), [View::Scope]);
        layouts.choose(Layout::Instructor);
        let docked = [View::Machine, View::Scope, View::Bench];
        assert_eq!(layouts.docked(), docked);
        layouts.float(View::Bench);
        layouts.choose(Layout::Panel);
        assert_eq!(
            (layouts.floating(), layouts.docked()),
            (vec![View::Bench], vec![View::Scope])
        );
    }

    #[test]
    fn where_there_is_one_window_views_are_docked() {
        let mut layouts = Layouts::of(Layout::Panel);
        layouts.float(View::Scope);
        layouts.toggle(View::Scope);
        layouts.set_only_docks(true);
        layouts.toggle(View::Scope);
        layouts.toggle(View::Bench);
        assert_eq!(layouts.docked(), [View::Scope, View::Bench]);
        assert_eq!(layouts.floating(), []);
    }

    #[test]
    fn the_first_start_shows_the_machine_where_there_is_room() {
        for (width, layout) in [(1366.0, Layout::Machine), (800.0, Layout::Panel)] {
            let room = Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(width, 718.0));
            let mut layouts = Layouts::default();
            layouts.begin(room, 1.0);
            assert_eq!(layouts.current(), layout);
        }
    }

    #[test]
    fn they_come_back_as_they_were() {
        let mut layouts = Layouts::of(Layout::Instructor);
        layouts.dock(View::Ladder);
        layouts.set_share(0, Some(0.4321));
        let place = Place {
            corner: Some((-5, 40)),
            size: (800, 600),
        };
        layouts.remember(View::Scope, place);
        let kept = ron::to_string(&layouts).unwrap();
        let back: Layouts = ron::from_str(&kept).unwrap();
        assert_eq!(back, layouts);
        assert_eq!(back.place(View::Scope), Some(place));
        let room = Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1000.0, 800.0));
        assert_eq!(back.arrange(room, 1.0, 0.0).panes[0].1.width(), 432.0 - 3.0);
    }
}
