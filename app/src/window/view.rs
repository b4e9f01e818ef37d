//! The table of views: names, keys, sizes. `views/` draws the views; `layout/` decides where
//! they are.

use egui::{Event, Key};
use serde::{Deserialize, Serialize};

use crate::platform;
use gsk_messages::{Message, say};

/// A view that can be docked beside the panel or have a separate window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum View {
    Scope,
    Bench,
    Ladder,
    Link,
    Program,
    Machine,
    Lesson,
    Transfer,
    Commission,
    Data,
    /// Everything that a control stores, as a folder of text files.
    Project,
}

impl View {
    /// Whether the view shows the live state of the machine and the PLC.
    pub const fn monitors(self) -> bool {
        matches!(
            self,
            Self::Bench | Self::Ladder | Self::Commission | Self::Data
        )
    }

    /// Whether this platform has the view. A page in a browser has neither ports nor folders.
    pub const fn is_there(self) -> bool {
        match self {
            Self::Transfer => platform::has_ports(),
            Self::Project => platform::has_folders(),
            _ => true,
        }
    }

    pub fn row(self) -> &'static ViewRow {
        let row = VIEWS.iter().find(|row| row.view == self);
        row.unwrap_or(&VIEWS[0])
    }
}

pub struct ViewRow {
    pub view: View,
    pub name: fn() -> Message,
    /// The key that opens and closes the view, pressed with Shift; `None`: menu only.
    pub key: Option<Key>,
    /// Whether the view is docked when it opens for the first time. Otherwise it opens in a
    /// separate window.
    pub docks: bool,
    /// Initial size of its separate window, points.
    pub size: [f32; 2],
    /// Least size of its separate window, points.
    pub least: [f32; 2],
}

/// The views in the order of the menu.
pub static VIEWS: [ViewRow; 11] = [
    ViewRow {
        view: View::Machine,
        name: say::window_view_machine,
        key: Some(Key::F1),
        docks: false,
        size: [900.0, 640.0],
        least: [300.0, 220.0],
    },
    ViewRow {
        view: View::Scope,
        name: say::window_view_scope,
        key: Some(Key::F2),
        docks: false,
        size: [1120.0, 720.0],
        least: [600.0, 360.0],
    },
    ViewRow {
        view: View::Bench,
        name: say::window_view_bench,
        key: Some(Key::F3),
        docks: false,
        size: [1000.0, 640.0],
        least: [600.0, 320.0],
    },
    ViewRow {
        view: View::Ladder,
        name: say::window_view_ladder,
        key: Some(Key::F4),
        docks: false,
        size: [1240.0, 780.0],
        least: [640.0, 360.0],
    },
    ViewRow {
        view: View::Link,
        name: say::window_view_link,
        key: Some(Key::F5),
        docks: false,
        size: [1040.0, 740.0],
        least: [640.0, 320.0],
    },
    ViewRow {
        view: View::Program,
        name: say::window_view_program,
        key: Some(Key::F11),
        docks: false,
        size: [900.0, 760.0],
        least: [480.0, 320.0],
    },
    ViewRow {
        view: View::Lesson,
        name: say::window_view_lesson,
        key: Some(Key::Home),
        docks: true,
        size: [420.0, 520.0],
        least: [220.0, 260.0],
    },
    ViewRow {
        view: View::Transfer,
        name: say::window_view_transfer,
        key: None,
        docks: false,
        size: [860.0, 560.0],
        least: [520.0, 360.0],
    },
    ViewRow {
        view: View::Commission,
        name: say::window_view_commission,
        key: Some(Key::End),
        docks: false,
        size: [860.0, 700.0],
        least: [520.0, 320.0],
    },
    ViewRow {
        view: View::Data,
        name: say::window_view_data,
        key: None,
        docks: false,
        size: [1000.0, 700.0],
        least: [520.0, 400.0],
    },
    ViewRow {
        view: View::Project,
        name: say::window_view_project,
        key: None,
        docks: false,
        size: [1000.0, 700.0],
        least: [280.0, 260.0],
    },
];

/// The view whose key is pressed in `events`, if any.
pub fn toggled(events: &[Event]) -> Option<View> {
    let mut rows = VIEWS.iter().filter(|row| row.view.is_there());
    let row = rows.find(|row| row.key.is_some_and(|key| shifted(events, key)));
    row.map(|row| row.view)
}

/// Whether `wanted` is pressed with Shift as the only modifier.
pub fn shifted(events: &[Event], wanted: Key) -> bool {
    events.iter().any(|event| {
        matches!(
            event,
            Event::Key { key, pressed: true, repeat: false, modifiers, .. }
                if *key == wanted && modifiers.shift && !modifiers.ctrl && !modifiers.alt
        )
    })
}

/// The text of a view's or a layout's key: `Shift+F6`.
pub fn key_name(key: Key) -> String {
    format!("Shift+{}", key.name())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::layout::LAYOUTS;

    #[test]
    fn the_key_of_a_view_is_nobody_elses() {
        let views = VIEWS.iter().filter_map(|row| row.key);
        let layouts = LAYOUTS.iter().map(|row| row.key);
        let mut seen = Vec::new();
        for key in views.chain(layouts) {
            let name = key_name(key);
            assert!(!seen.contains(&key), "{name} opens two of them");
            assert_eq!(gsk_panel::keys::Key::from_pc_key(&name), None, "{name}");
            seen.push(key);
        }
    }
}
