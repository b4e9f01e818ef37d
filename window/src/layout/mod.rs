//! Layouts of the window: which views are docked beside the panel, and how the window is
//! divided. The settings store all of it.

pub mod floating;
#[cfg(test)]
mod legend_tests;
mod panes;
mod splitters;
mod table;
mod tabs;

use std::collections::BTreeMap;

use egui::Rect;
use serde::{Deserialize, Serialize};

use super::view::ViewId;
use crate::placement::panel_placement::{self, UNITS_PER_DOT};
use panes::SPLITTER_WIDTH;
pub use panes::{Arrangement, PaneTabs, WindowPane, arrange_panes};
pub use splitters::show;
use table::{LARGE_PANEL, Proportions};
pub use table::{LAYOUTS, WindowLayout, layout_of_pressed_key};
pub use tabs::MIN_SHARE;
use tabs::arrange_as_tabs;

impl WindowLayout {
    /// The layout of the first start: with the machine view if the LCD then keeps a pixel per
    /// dot, else the panel alone.
    fn choose_first(room: Rect, pixels_per_point: f32) -> Self {
        match pixels_per_dot(room, LARGE_PANEL.max_panel_share, pixels_per_point) < 1.0 {
            true => Self::Panel,
            false => Self::Machine,
        }
    }
}

/// Position and size of a window on the screen, points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct WindowGeometry {
    /// Upper left corner including the frame; `None` if the system does not report it.
    pub corner: Option<(i32, i32)>,
    /// Width and height of the window without its frame.
    pub size: (u32, u32),
}

/// The changes that the operator has made to a layout.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
struct LayoutChanges {
    /// The docked views; `None` if they are those of the table.
    docked: Option<Vec<ViewId>>,
    /// Dragged splitters by their number: share of the first side, thousandths.
    shares: BTreeMap<u8, u16>,
}

/// Whether a view opens docked or in a separate window, and where.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
struct ViewHome {
    /// True if the view opens docked, false if it opens in a separate window.
    docks: bool,
    /// Position and size of the view's separate window when it was last open; `None` before.
    place: Option<WindowGeometry>,
}

/// The chosen layout and the operator's changes, as the settings store them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layouts {
    /// The layout in use; `None` until the first start has chosen one.
    chosen: Option<WindowLayout>,
    changes: BTreeMap<WindowLayout, LayoutChanges>,
    homes: BTreeMap<ViewId, ViewHome>,
    /// Position and size of the main window before it was maximized.
    pub window: Option<WindowGeometry>,
    /// Whether the main window is maximized; `None` before the first start.
    pub is_maximized: Option<bool>,
    /// Views in separate windows; empty at the start of the program.
    #[serde(skip)]
    floating: Vec<ViewId>,
    /// Whether the system has one window only, as a page in a browser. All views are then
    /// docked.
    #[serde(skip)]
    is_single_window: bool,
    /// Whether panel and views do not fit together, and one of them covers the others.
    #[serde(skip)]
    is_tabbed: bool,
    /// The pane that is shown if panel and views do not fit together; `None`: the panel.
    front: Option<ViewId>,
}

impl Layouts {
    /// Creates layouts in which `layout` is selected and nothing is changed.
    pub fn with_layout(layout: WindowLayout) -> Self {
        Self {
            chosen: Some(layout),
            ..Self::default()
        }
    }

    pub fn current(&self) -> WindowLayout {
        self.chosen.unwrap_or(WindowLayout::Panel)
    }

    /// Chooses the layout for the first start by the available size, unless a layout is chosen
    /// already.
    pub fn choose_first_layout(&mut self, room: Rect, pixels_per_point: f32) {
        let first = || WindowLayout::choose_first(room, pixels_per_point);
        self.chosen.get_or_insert_with(first);
    }

    /// Chooses a layout. The one in use gets back the views that the operator has closed.
    pub fn choose(&mut self, layout: WindowLayout) {
        if let Some(changes) = self.changes.get_mut(&layout)
            && self.chosen == Some(layout)
        {
            changes.docked = None;
        }
        self.chosen = Some(layout);
        self.bring_first_to_front();
    }

    /// Brings the first pane of the layout to the front, where its views do not fit together.
    pub fn bring_first_to_front(&mut self) {
        self.front = self.current().row().first_in_front;
    }

    pub fn docked(&self) -> Vec<ViewId> {
        let layout = self.current();
        let changed = self.changes.get(&layout);
        let changed = changed.and_then(|changes| changes.docked.clone());
        changed.unwrap_or_else(|| layout.row().default_docked.to_vec())
    }

    /// Returns the views that are in separate windows.
    pub fn floating(&self) -> Vec<ViewId> {
        let docked = self.docked();
        let floating = self.floating.iter().copied();
        floating.filter(|view| !docked.contains(view)).collect()
    }

    /// Whether a view is docked or has a separate window.
    pub fn is_open(&self, view: ViewId) -> bool {
        self.floating.contains(&view) || self.docked().contains(&view)
    }

    /// Opens a view where it was last, or closes it.
    pub fn toggle(&mut self, view: ViewId) {
        let docked = self.docked().contains(&view);
        if docked || self.floating.contains(&view) {
            self.close(view);
            self.home(view).docks = docked;
        } else if self.is_single_window || self.home(view).docks {
            self.dock(view);
        } else {
            self.float(view);
        }
    }

    /// Docks a view in the main window.
    pub fn dock(&mut self, view: ViewId) {
        self.close(view);
        let mut docked = self.docked();
        docked.push(view);
        self.set_docked(docked);
        self.home(view).docks = true;
        self.front = Some(view);
    }

    /// Docks a view in the main window without bringing it to the front.
    pub fn dock_beside(&mut self, view: ViewId) {
        let front = self.front;
        self.dock(view);
        self.front = front;
    }

    /// Sets whether the system has one window only. Views then open in panes, so that they
    /// cover no key that stops the machine (WINDOW-25).
    pub const fn set_single_window(&mut self, only_docks: bool) {
        self.is_single_window = only_docks;
    }

    /// Sets whether panel and views are shown in tabs because they do not fit together.
    pub const fn set_tabbed(&mut self, is_tabbed: bool) {
        self.is_tabbed = is_tabbed;
    }

    /// Whether a docked view is covered by the panel or another view.
    pub fn is_covered(&self, view: ViewId) -> bool {
        self.is_tabbed && self.front != Some(view) && self.docked().contains(&view)
    }

    /// Brings a docked view (`None`: the panel) to the front, for windows in which they do not
    /// fit together.
    pub const fn bring_to_front(&mut self, front: Option<ViewId>) {
        self.front = front;
    }

    /// Opens a view in a separate window.
    pub fn float(&mut self, view: ViewId) {
        self.close(view);
        self.floating.push(view);
        self.home(view).docks = false;
    }

    /// Last position and size of a view's separate window; `None` before it was open.
    pub fn stored_geometry(&self, view: ViewId) -> Option<WindowGeometry> {
        self.homes.get(&view).and_then(|home| home.place)
    }

    /// Stores the position and size of a view's separate window.
    pub fn store_geometry(&mut self, view: ViewId, geometry: WindowGeometry) {
        self.home(view).place = Some(geometry);
    }

    fn home(&mut self, view: ViewId) -> &mut ViewHome {
        let first = || ViewHome {
            docks: view.row().opens_docked,
            place: None,
        };
        self.homes.entry(view).or_insert_with(first)
    }

    fn close(&mut self, view: ViewId) {
        self.floating.retain(|open| *open != view);
        let mut docked = self.docked();
        if docked.contains(&view) {
            docked.retain(|open| *open != view);
            self.set_docked(docked);
        }
    }

    fn set_docked(&mut self, docked: Vec<ViewId>) {
        let layout = self.current();
        self.changes.entry(layout).or_default().docked = Some(docked);
    }

    /// Arranges the panes in `bounds`: all together, or if that is too crowded one of them
    /// with a bar to switch to the others.
    pub fn arrange(&self, bounds: Rect, scales: Scales) -> Arrangement {
        let shares = self.changes.get(&self.current());
        let share = |split: u8| {
            let share = shares.and_then(|changes| changes.shares.get(&split))?;
            Some(f32::from(*share) / 1000.0)
        };
        let proportions = self.current().row().proportions;
        let together = arrange_panes(bounds, &self.docked(), proportions, scales, &share);
        // After the operator has dragged a splitter, the panes stay together.
        let is_dragged = shares.is_some_and(|changes| !changes.shares.is_empty());
        match !is_dragged && tabs::is_crowded(&together, scales) {
            true => arrange_as_tabs(bounds, together, self.front),
            false => together,
        }
    }

    /// Shows panel and views together from now on, even if they are crowded.
    pub fn keep_together(&mut self, arranged: &Arrangement) {
        if let Some(splitter) = arranged.splitters.first() {
            self.set_share(splitter.split, Some(splitter.current_share()));
        }
    }

    /// Sets the share of the first side of a splitter, 0–1; `None` restores its default.
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

/// The scales from which the size of the panel is computed.
#[derive(Clone, Copy, Debug)]
pub struct Scales {
    /// Number of physical pixels per point.
    pub pixels_per_point: f32,
    /// Minimum side length of a panel key, points; 0 for no limit.
    pub min_key_size: f32,
    /// Height of a legend below which the panel is too small, physical pixels.
    pub min_legend_height: f32,
}

impl Scales {
    /// The scales for a mouse, without a time line.
    pub const fn new(pixels_per_point: f32) -> Self {
        Self {
            pixels_per_point,
            min_key_size: 0.0,
            min_legend_height: panel_placement::MIN_LEGEND_HEIGHT,
        }
    }
}

/// Whole number of physical pixels per dot of the LCD if the panel takes at most `max_share`
/// of the width.
fn pixels_per_dot(room: Rect, max_share: f32, pixels_per_point: f32) -> f32 {
    let max_size = egui::vec2(room.width() * max_share, room.height());
    let scale = panel_placement::scale_of_whole(max_size) * pixels_per_point;
    (scale * UNITS_PER_DOT).floor()
}

/// The panel's share of the width beside views, 0–1: the largest share up to `max_share` that
/// shows the dots of the LCD as whole pixels, or more if the keys need it.
fn panel_share(room: Rect, max_share: f32, scales: Scales) -> f32 {
    // The panel's pane ends at the middle of the splitter.
    let share_for_keys = (panel_placement::width_for_key_size(scales.min_key_size)
        + SPLITTER_WIDTH / 2.0)
        / room.width();
    share_for_whole_pixels(room, max_share, scales.pixels_per_point)
        .max(max_share.min(0.5))
        .max(share_for_keys.min(1.0))
}

fn share_for_whole_pixels(room: Rect, max_share: f32, pixels_per_point: f32) -> f32 {
    let pixels_per_dot = pixels_per_dot(room, max_share, pixels_per_point);
    if pixels_per_dot < 1.0 {
        return max_share.min(0.6);
    }
    let width = gsk_panel::faceplate::SIZE.0 * pixels_per_dot / UNITS_PER_DOT;
    (width / pixels_per_point / room.width()).min(max_share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_opens_where_it_was_last() {
        let mut layouts = Layouts::with_layout(WindowLayout::Panel);
        layouts.toggle(ViewId::Scope);
        assert_eq!(
            (layouts.floating(), layouts.docked()),
            (vec![ViewId::Scope], vec![])
        );
        layouts.dock(ViewId::Scope);
        assert_eq!(
            (layouts.floating(), layouts.docked()),
            (vec![], vec![ViewId::Scope])
        );
        layouts.toggle(ViewId::Scope);
        assert!(!layouts.is_open(ViewId::Scope));
        layouts.toggle(ViewId::Scope);
        assert_eq!(layouts.docked(), [ViewId::Scope]);
        layouts.choose(WindowLayout::Instructor);
        let docked = [ViewId::Machine, ViewId::Scope, ViewId::Bench];
        assert_eq!(layouts.docked(), docked);
        layouts.float(ViewId::Bench);
        layouts.choose(WindowLayout::Panel);
        assert_eq!(
            (layouts.floating(), layouts.docked()),
            (vec![ViewId::Bench], vec![ViewId::Scope])
        );
    }

    #[test]
    fn views_are_docked_in_a_single_window() {
        let mut layouts = Layouts::with_layout(WindowLayout::Panel);
        layouts.float(ViewId::Scope);
        layouts.toggle(ViewId::Scope);
        layouts.set_single_window(true);
        layouts.toggle(ViewId::Scope);
        layouts.toggle(ViewId::Bench);
        assert_eq!(layouts.docked(), [ViewId::Scope, ViewId::Bench]);
        assert_eq!(layouts.floating(), []);
    }

    #[test]
    fn the_first_start_shows_the_machine_where_there_is_room() {
        for (width, layout) in [
            (1366.0, WindowLayout::Machine),
            (800.0, WindowLayout::Panel),
        ] {
            let room = Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(width, 718.0));
            let mut layouts = Layouts::default();
            layouts.choose_first_layout(room, 1.0);
            assert_eq!(layouts.current(), layout);
        }
    }

    #[test]
    fn layouts_survive_a_restart() {
        let mut layouts = Layouts::with_layout(WindowLayout::Instructor);
        layouts.dock(ViewId::Ladder);
        layouts.set_share(0, Some(0.4321));
        let place = WindowGeometry {
            corner: Some((-5, 40)),
            size: (800, 600),
        };
        layouts.store_geometry(ViewId::Scope, place);
        let stored = ron::to_string(&layouts).unwrap();
        let restored: Layouts = ron::from_str(&stored).unwrap();
        assert_eq!(restored, layouts);
        assert_eq!(restored.stored_geometry(ViewId::Scope), Some(place));
        let room = Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1000.0, 800.0));
        assert_eq!(
            restored.arrange(room, Scales::new(1.0)).panes[0].1.width(),
            432.0 - 3.0
        );
    }
}
