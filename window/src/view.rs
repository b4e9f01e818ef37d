//! The table of views: names, keys, sizes. `views/` draws the views; `layout/` decides where
//! they are.

use egui::{Event, Key};
use serde::{Deserialize, Serialize};

use gsk_help::{Subject, Topic, topic};
use gsk_host::platform;
use gsk_messages::{Message, say};

/// Declares the table of views: [`ViewId`] with a variant for each row, and [`VIEWS`].
macro_rules! views {
    ($($(#[$comment:meta])* $view:ident => $row:expr,)*) => {
        /// A view that can be docked beside the panel or have a separate window.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        pub enum ViewId {
            $($(#[$comment])* $view,)*
        }

        /// All views in the order of the menu.
        pub static VIEWS: [ViewRow; [$(ViewId::$view),*].len()] = [$($row),*];
    };
}

/// The properties of a view in the table of views: id, name, icon and sizes.
pub struct ViewRow {
    pub view: ViewId,
    pub name: fn() -> Message,
    /// The notion of the help that explains the view.
    pub notion: &'static str,
    /// The key that opens and closes the view together with Shift; `None`: only the menu does.
    pub key: Option<Key>,
    /// True if the view is docked when it opens for the first time, false if it opens in a
    /// separate window.
    pub opens_docked: bool,
    /// Initial size of the view's separate window, points.
    pub size: [f32; 2],
    /// Minimum size of the view's separate window, points.
    pub min_size: [f32; 2],
    /// Whether this platform has the view. A page in a browser has neither ports nor folders.
    pub is_available: fn() -> bool,
    /// Whether the view shows the live state of the machine and the PLC.
    pub is_monitor: bool,
    /// Whether the view shows the part and the lathe around it.
    pub shows_part: bool,
    /// Whether the view handles function keys and combinations with Ctrl or Alt itself.
    pub uses_keys: bool,
}

views! {
    Machine => ViewRow {
        view: ViewId::Machine,
        name: say::window_view_machine,
        notion: "machine view",
        key: Some(Key::F1),
        opens_docked: false,
        size: [900.0, 640.0],
        min_size: [300.0, 220.0],
        is_available: || true,
        is_monitor: false,
        shows_part: true,
        uses_keys: false,
    },
    Lathe => ViewRow {
        view: ViewId::Lathe,
        name: say::window_view_lathe,
        notion: "3D lathe view",
        key: None,
        opens_docked: true,
        size: [900.0, 640.0],
        min_size: [240.0, 180.0],
        is_available: || true,
        is_monitor: false,
        shows_part: true,
        uses_keys: false,
    },
    Scope => ViewRow {
        view: ViewId::Scope,
        name: say::window_view_scope,
        notion: "scope",
        key: Some(Key::F2),
        opens_docked: false,
        size: [1120.0, 720.0],
        min_size: [600.0, 360.0],
        is_available: || true,
        is_monitor: false,
        shows_part: false,
        uses_keys: false,
    },
    Bench => ViewRow {
        view: ViewId::Bench,
        name: say::window_view_bench,
        notion: "fault bench",
        key: Some(Key::F3),
        opens_docked: false,
        size: [1000.0, 640.0],
        min_size: [600.0, 320.0],
        is_available: || true,
        is_monitor: true,
        shows_part: false,
        uses_keys: false,
    },
    Ladder => ViewRow {
        view: ViewId::Ladder,
        name: say::window_view_ladder,
        notion: "ladder view",
        key: Some(Key::F4),
        opens_docked: false,
        size: [1240.0, 780.0],
        min_size: [640.0, 360.0],
        is_available: || true,
        is_monitor: true,
        shows_part: false,
        uses_keys: true,
    },
    Link => ViewRow {
        view: ViewId::Link,
        name: say::window_view_link,
        notion: "pulse board",
        key: Some(Key::F5),
        opens_docked: false,
        size: [1040.0, 740.0],
        min_size: [640.0, 320.0],
        is_available: || true,
        is_monitor: false,
        shows_part: false,
        uses_keys: false,
    },
    Program => ViewRow {
        view: ViewId::Program,
        name: say::window_view_program,
        notion: "program view",
        key: Some(Key::F11),
        opens_docked: false,
        size: [900.0, 760.0],
        min_size: [480.0, 320.0],
        is_available: || true,
        is_monitor: false,
        shows_part: false,
        uses_keys: true,
    },
    Lesson => ViewRow {
        view: ViewId::Lesson,
        name: say::window_view_lesson,
        notion: "lessons",
        key: Some(Key::Home),
        opens_docked: true,
        size: [420.0, 520.0],
        min_size: [220.0, 260.0],
        is_available: || true,
        is_monitor: false,
        shows_part: true,
        uses_keys: false,
    },
    Transfer => ViewRow {
        view: ViewId::Transfer,
        name: say::window_view_transfer,
        notion: "file transfer",
        key: None,
        opens_docked: false,
        size: [860.0, 560.0],
        min_size: [520.0, 360.0],
        is_available: platform::has_ports,
        is_monitor: false,
        shows_part: false,
        uses_keys: false,
    },
    Commission => ViewRow {
        view: ViewId::Commission,
        name: say::window_view_commission,
        notion: "commissioning",
        key: Some(Key::End),
        opens_docked: false,
        size: [860.0, 700.0],
        min_size: [520.0, 320.0],
        is_available: || true,
        is_monitor: true,
        shows_part: false,
        uses_keys: false,
    },
    Data => ViewRow {
        view: ViewId::Data,
        name: say::window_view_data,
        notion: "parameters and offsets",
        key: None,
        opens_docked: false,
        size: [1000.0, 700.0],
        min_size: [520.0, 400.0],
        is_available: || true,
        is_monitor: true,
        shows_part: false,
        uses_keys: false,
    },
    Project => ViewRow {
        view: ViewId::Project,
        name: say::window_view_project,
        notion: "project",
        key: None,
        opens_docked: false,
        size: [1000.0, 700.0],
        min_size: [280.0, 260.0],
        is_available: platform::has_folders,
        is_monitor: false,
        shows_part: false,
        uses_keys: false,
    },
}

impl ViewId {
    /// Whether the view exists on this platform.
    pub fn is_available(self) -> bool {
        (self.row().is_available)()
    }

    /// Returns the help topic about the view.
    pub fn topic(self) -> Option<&'static Topic> {
        topic(Subject::Notion(self.row().notion))
    }

    /// Returns the row of the view in [`VIEWS`].
    pub fn row(self) -> &'static ViewRow {
        let row = VIEWS.iter().find(|row| row.view == self);
        row.unwrap_or(&VIEWS[0])
    }
}

/// The view whose key is pressed in `events`; `None` if there is none.
pub fn view_of_pressed_key(events: &[Event]) -> Option<ViewId> {
    let mut rows = VIEWS.iter().filter(|row| row.view.is_available());
    let row = rows.find(|row| {
        row.key
            .is_some_and(|key| is_pressed_with_shift(events, key))
    });
    row.map(|row| row.view)
}

/// Whether `wanted` is pressed with Shift as the only modifier.
pub fn is_pressed_with_shift(events: &[Event], wanted: Key) -> bool {
    events.iter().any(|event| {
        matches!(
            event,
            Event::Key { key, pressed: true, repeat: false, modifiers, .. }
                if *key == wanted && modifiers.shift && !modifiers.ctrl && !modifiers.alt
        )
    })
}

/// Formats the key of a view or a layout: `Shift+F6`.
pub fn key_name(key: Key) -> String {
    format!("Shift+{}", key.name())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::LAYOUTS;
    use gsk_messages::Language;

    #[test]
    fn the_help_explains_every_view_and_names_its_key() {
        for row in &VIEWS {
            let topic = row.view.topic().expect(row.notion);
            for language in [Language::Zh, Language::En] {
                let rule = topic.rule(language);
                let name = (row.name)().text(language);
                assert!(rule.contains(&name), "{name} in: {rule}");
                if let Some(key) = row.key {
                    assert!(
                        rule.contains(&key_name(key)),
                        "{} in: {rule}",
                        key_name(key)
                    );
                }
            }
        }
    }

    #[test]
    fn every_view_key_is_unique() {
        let views = VIEWS.iter().filter_map(|row| row.key);
        let layouts = LAYOUTS.iter().filter_map(|row| row.key);
        let mut seen = Vec::new();
        for key in views.chain(layouts) {
            let name = key_name(key);
            assert!(!seen.contains(&key), "{name} opens two of them");
            assert_eq!(gsk_panel::keys::Key::from_pc_key(&name), None, "{name}");
            seen.push(key);
        }
    }
}
