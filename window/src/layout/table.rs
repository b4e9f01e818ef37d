//! The predefined layouts: their views, keys and proportions.

use egui::{Event, Key};
use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::view::{ViewId, is_pressed_with_shift};

/// The proportions by which a layout divides a wide window whose splitters were not dragged.
#[derive(Clone, Copy, Debug)]
pub struct Proportions {
    /// Maximum share of the window's width for the panel, 0–1.
    pub(super) max_panel_share: f32,
    /// Share of the window's width for the column with the panel, 0–1; `None`: the panel's
    /// width.
    pub(super) column_share: Option<f32>,
    /// Index of the docked view below the panel, from 0.
    pub(super) view_below_panel: usize,
}

/// The proportions in which the panel is as large as possible.
pub(super) const LARGE_PANEL: Proportions = Proportions {
    max_panel_share: 0.64,
    column_share: None,
    view_below_panel: 2,
};

/// A predefined arrangement of panel and views that the operator chooses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum WindowLayout {
    /// Layout with the panel alone.
    Panel,
    /// Layout with the panel and the machine.
    Machine,
    /// Layout for programming: program text, machine and a smaller panel.
    Programmer,
    /// Layout for teaching: panel, machine, scope and fault bench.
    Instructor,
    /// Panel and lessons beside the machine: for the operator in training.
    Learner,
}

pub struct LayoutRow {
    pub layout: WindowLayout,
    pub name: fn() -> Message,
    /// The key that chooses the layout together with Shift; `None`: only the menu chooses it.
    pub key: Option<Key>,
    /// The views that are docked until the operator changes them.
    pub(super) default_docked: &'static [ViewId],
    /// The view that is shown first where they do not fit together; `None`: the panel.
    pub(super) first_in_front: Option<ViewId>,
    pub(super) proportions: Proportions,
}

/// All layouts in the order of the menu.
pub static LAYOUTS: [LayoutRow; 5] = [
    LayoutRow {
        layout: WindowLayout::Panel,
        name: say::window_layout_panel,
        key: Some(Key::F6),
        default_docked: &[],
        first_in_front: None,
        proportions: LARGE_PANEL,
    },
    LayoutRow {
        layout: WindowLayout::Machine,
        name: say::window_layout_machine,
        key: Some(Key::F7),
        default_docked: &[ViewId::Machine],
        first_in_front: None,
        proportions: LARGE_PANEL,
    },
    LayoutRow {
        layout: WindowLayout::Programmer,
        name: say::window_layout_programmer,
        key: Some(Key::F8),
        default_docked: &[ViewId::Program, ViewId::Machine],
        first_in_front: Some(ViewId::Program),
        proportions: Proportions {
            max_panel_share: 0.5,
            column_share: Some(0.5),
            view_below_panel: 1,
        },
    },
    LayoutRow {
        layout: WindowLayout::Instructor,
        name: say::window_layout_instructor,
        key: Some(Key::F9),
        default_docked: &[ViewId::Machine, ViewId::Scope, ViewId::Bench],
        first_in_front: None,
        proportions: Proportions {
            max_panel_share: 0.5,
            column_share: None,
            view_below_panel: 2,
        },
    },
    LayoutRow {
        layout: WindowLayout::Learner,
        name: say::window_layout_learner,
        key: None,
        default_docked: &[ViewId::Machine, ViewId::Lesson],
        first_in_front: Some(ViewId::Lesson),
        proportions: Proportions {
            max_panel_share: 0.64,
            column_share: None,
            view_below_panel: 1,
        },
    },
];

impl WindowLayout {
    pub(super) fn row(self) -> &'static LayoutRow {
        let row = LAYOUTS.iter().find(|row| row.layout == self);
        row.unwrap_or(&LAYOUTS[0])
    }
}

/// The layout whose key is pressed in `events`; `None` if there is none.
pub fn layout_of_pressed_key(events: &[Event]) -> Option<WindowLayout> {
    let row = LAYOUTS.iter().find(|row| {
        row.key
            .is_some_and(|key| is_pressed_with_shift(events, key))
    });
    row.map(|row| row.layout)
}
