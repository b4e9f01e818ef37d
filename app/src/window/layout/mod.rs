//! Layouts of the window: which views are docked beside the panel, and how the window is
//! divided. The settings store all of it.

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

/// Panel units per dot of the LCD.
const UNITS_A_DOT: f32 = 2.0;

/// How a layout divides a wide window whose splitters were not dragged.
#[derive(Clone, Copy, Debug)]
pub struct Proportions {
    /// Greatest share of the window's width for the panel, 0–1.
    panel_at_most: f32,
    /// Share of the window's width for the column with the panel; `None`: the panel's width.
    column: Option<f32>,
    /// Index of the docked view below the panel, from 0.
    below: usize,
}

/// The panel is as large as possible.
const LARGE_PANEL: Proportions = Proportions {
    panel_at_most: 0.75,
    column: None,
    below: 2,
};

/// A predefined arrangement that the operator chooses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Layout {
    /// The panel alone.
    Panel,
    /// The panel and the machine.
    Machine,
    /// Program text, machine and a smaller panel: for programming.
    Programmer,
    /// Panel, machine, scope and fault bench: for teaching.
    Instructor,
    /// Panel and lessons beside the machine: for the operator in training.
    Learner,
}

pub struct LayoutRow {
    pub layout: Layout,
    pub name: fn() -> Message,
    /// The key that chooses the layout, pressed with Shift.
    pub key: Key,
    /// The docked views until the operator changes them.
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
    /// The layout of the first start: with the machine where the LCD keeps a pixel per dot.
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

/// The layout whose key is pressed in `events`, if any.
pub fn chosen(events: &[Event]) -> Option<Layout> {
    let row = LAYOUTS.iter().find(|row| shifted(events, row.key));
    row.map(|row| row.layout)
}

/// Position and size of a window on the screen, points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Place {
    /// Upper left corner including the frame; `None` where the system does not report it.
    pub corner: Option<(i32, i32)>,
    /// Width and height without the frame.
    pub size: (u32, u32),
}

/// The operator's changes to a layout.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
struct Changes {
    /// The docked views, if they differ from those of the table.
    docked: Option<Vec<View>>,
    /// Dragged splitters by number: share of the first side, thousandths.
    shares: BTreeMap<u8, u16>,
}

/// Where a view opens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
struct Home {
    /// Whether it opens docked. Otherwise it opens in a separate window.
    docks: bool,
    /// Position and size of its separate window when it was last open.
    place: Option<Place>,
}

/// The chosen layout and the operator's changes, as the settings store them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layouts {
    /// The layout in use; `None` before the first start has chosen one.
    chosen: Option<Layout>,
    changes: BTreeMap<Layout, Changes>,
    homes: BTreeMap<View, Home>,
    /// Position and size of the main window before it was maximized.
    pub window: Option<Place>,
    /// Views in separate windows; none is open at the start.
    #[serde(skip)]
    floating: Vec<View>,
    /// Whether the system has one window only, as a page in a browser: all views are docked.
    #[serde(skip)]
    only_docks: bool,
    /// The pane that is shown where panel and views do not fit together; `None`: the panel.
    front: Option<View>,
}

impl Layouts {
    /// The layouts with one chosen and no changes.
    pub fn of(layout: Layout) -> Self {
        Self {
            chosen: Some(layout),
            ..Self::default()
        }
    }

    pub fn current(&self) -> Layout {
        self.chosen.unwrap_or(Layout::Panel)
    }

    /// Chooses the layout for the first start by the available size, unless one is chosen.
    pub fn begin(&mut self, room: Rect, pixels_per_point: f32) {
        let first = || Layout::first(room, pixels_per_point);
        self.chosen.get_or_insert_with(first);
    }

    /// Uses another layout.
    pub const fn choose(&mut self, layout: Layout) {
        self.chosen = Some(layout);
        self.front = None;
    }

    pub fn docked(&self) -> Vec<View> {
        let layout = self.current();
        let changed = self.changes.get(&layout);
        let changed = changed.and_then(|changes| changes.docked.clone());
        changed.unwrap_or_else(|| layout.row().docked.to_vec())
    }

    /// The views in separate windows.
    pub fn floating(&self) -> Vec<View> {
        let docked = self.docked();
        let own = self.floating.iter().copied();
        own.filter(|view| !docked.contains(view)).collect()
    }

    /// Whether a view is docked or has a separate window.
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

    /// Docks a view in the main window.
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

    /// Sets whether the system has one window only. Views then open in panes, where they cover
    /// no key that stops the machine (WINDOW-25).
    pub const fn set_only_docks(&mut self, only_docks: bool) {
        self.only_docks = only_docks;
    }

    /// Brings a docked view, or with `None` the panel, to the front where they do not fit
    /// together.
    pub const fn bring(&mut self, front: Option<View>) {
        self.front = front;
    }

    /// Opens a view in a separate window.
    pub fn float(&mut self, view: View) {
        self.take_away(view);
        self.floating.push(view);
        self.home(view).docks = false;
    }

    /// Last position and size of a view's separate window.
    pub fn place(&self, view: View) -> Option<Place> {
        self.homes.get(&view).and_then(|home| home.place)
    }

    /// Stores the position and size of a view's separate window.
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

    /// Arranges the panes in `room`: all together, or one of them with a bar to switch to the
    /// others. Keys are at least `key` points large where they fit.
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
        // After the operator has dragged a splitter, the panes stay together.
        let dragged = shares.is_some_and(|changes| !changes.shares.is_empty());
        match !dragged && turns::is_crowded(&together, scales) {
            true => in_turn(room, together, self.front),
            false => together,
        }
    }

    /// Shows panel and views together from now on, whatever the available size.
    pub fn keep_together(&mut self, arranged: &Arranged) {
        if let Some(splitter) = arranged.splitters.first() {
            self.set_share(splitter.split, Some(splitter.at()));
        }
    }

    /// Moves a splitter; `None` restores its default position.
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

/// The scales that determine the size of the panel.
#[derive(Clone, Copy, Debug)]
pub struct Scales {
    /// Physical pixels per point.
    pixels_per_point: f32,
    /// Least side of a key, points; 0: no limit.
    key: f32,
}

/// Whole pixels per dot of the LCD when the panel takes at most the share `at_most` of the
/// width.
fn pixels_a_dot(room: Rect, at_most: f32, pixels_per_point: f32) -> f32 {
    let at_most = egui::vec2(room.width() * at_most, room.height());
    let scale = placing::whole_scale(at_most) * pixels_per_point;
    (scale * UNITS_A_DOT).floor()
}

/// The panel's share of the width beside views: the largest share up to `at_most` that shows
/// the dots of the LCD as whole pixels.
fn panel_share(room: Rect, at_most: f32, scales: Scales) -> f32 {
    // The panel's pane ends at the middle of the splitter.
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
