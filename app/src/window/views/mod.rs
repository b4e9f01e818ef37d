//! Views beside the panel, each in a window of its own: scope, fault bench, ladder,
//! link page. They are closed at the start, and closed they cost nothing.

mod aside;
mod bench;
mod ladder;
mod link;
mod scope;

use egui::{Color32, Context, Event, Frame, Key, Margin, Ui, ViewportBuilder, ViewportId};

use std::sync::Arc;

use gsk_link::LinkState;

use super::badge;
use crate::kernel::monitor::MachineView;
use crate::kernel::{Command, Console};
use bench::Bench;
use gsk_messages::{Language, Message, say};
use ladder::LadderView;
use link::LinkPage;
use scope::Scope;

/// A view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// The scope.
    Scope,
    /// The fault bench.
    Bench,
    /// The ladder.
    Ladder,
    /// The link page.
    Link,
}

impl View {
    /// Whether it shows the machine and the PLC as they are.
    const fn monitors(self) -> bool {
        matches!(self, Self::Bench | Self::Ladder)
    }
}

/// A row of the table of views.
pub struct ViewRow {
    /// The view.
    pub view: View,
    /// Its name.
    pub name: fn() -> Message,
    /// The key that opens and closes it, with Shift.
    pub key: Key,
    /// Size of its window, points.
    size: [f32; 2],
    /// Least size of its window, points.
    least: [f32; 2],
}

/// The views in the order of the menu.
pub static VIEWS: [ViewRow; 4] = [
    ViewRow {
        view: View::Scope,
        name: say::window_view_scope,
        key: Key::F2,
        size: [1120.0, 720.0],
        least: [760.0, 360.0],
    },
    ViewRow {
        view: View::Bench,
        name: say::window_view_bench,
        key: Key::F3,
        size: [1000.0, 640.0],
        least: [760.0, 320.0],
    },
    ViewRow {
        view: View::Ladder,
        name: say::window_view_ladder,
        key: Key::F4,
        size: [1240.0, 780.0],
        least: [820.0, 360.0],
    },
    ViewRow {
        view: View::Link,
        name: say::window_view_link,
        key: Key::F5,
        size: [1040.0, 740.0],
        least: [760.0, 320.0],
    },
];

/// The views and which of them are open.
pub struct Views {
    open: [bool; VIEWS.len()],
    scope: Scope,
    bench: Bench,
    ladder: LadderView,
    link: LinkPage,
    console: Console,
    machine: Option<Arc<MachineView>>,
}

impl Views {
    /// All closed.
    pub fn new(console: &Console) -> Self {
        Self {
            open: [false; VIEWS.len()],
            scope: Scope::new(console.clone()),
            bench: Bench::new(console.clone()),
            ladder: LadderView::new(console.clone()),
            link: LinkPage::new(console.clone()),
            console: console.clone(),
            machine: None,
        }
    }

    /// Whether a view is open.
    pub fn is_open(&self, view: View) -> bool {
        VIEWS
            .iter()
            .zip(self.open)
            .any(|(row, open)| open && row.view == view)
    }

    /// Opens a view, or closes it.
    pub fn toggle(&mut self, view: View) {
        let Some(index) = VIEWS.iter().position(|row| row.view == view) else {
            return;
        };
        let was = self.monitors();
        self.open[index] = !self.open[index];
        match (view, self.open[index]) {
            (View::Scope, true) => self.scope.open(),
            (View::Scope, false) => self.scope.close(),
            (View::Ladder, false) => self.ladder.close(),
            (View::Link, true) => self.link.open(),
            (View::Link, false) => self.link.close(),
            (View::Bench | View::Ladder, _) => {}
        }
        if self.monitors() != was {
            self.machine = None;
            self.console.send(Command::Monitor(!was));
        }
    }

    /// Whether an open view shows the machine and the PLC.
    fn monitors(&self) -> bool {
        let shown = |(row, open): (&ViewRow, bool)| open && row.view.monitors();
        VIEWS.iter().zip(self.open).any(shown)
    }

    /// Draws the open views. What their windows leave to the panel of the keyboard
    /// comes back, and whether one of them has the focus.
    pub fn show(
        &mut self,
        context: &Context,
        language: Language,
        board: Option<LinkState>,
    ) -> Typed {
        let mut typed = Typed::default();
        if let Some(machine) = self.console.machine.pop() {
            self.machine = Some(Arc::new(machine));
        }
        for (index, row) in VIEWS.iter().enumerate() {
            if !self.open[index] {
                continue;
            }
            let stays = window(
                context,
                row,
                language,
                board,
                &mut typed,
                |ui, native| match row.view {
                    View::Scope => self.scope.show(ui, language, native),
                    View::Link => self.link.show(ui, language),
                    View::Bench => self.bench.show(ui, language, self.machine.as_ref()),
                    View::Ladder => {
                        let machine = self.machine.as_ref();
                        self.ladder.show(ui, language, machine, native);
                    }
                },
            );
            if !stays {
                self.toggle(row.view);
            }
        }
        if let Some(view) = typed.toggled {
            self.toggle(view);
        }
        typed
    }
}

/// What was typed into the windows of views and is meant for the panel.
#[derive(Debug, Default)]
pub struct Typed {
    /// A window of a view has the focus.
    pub focused: bool,
    /// Keys of the PC.
    pub events: Vec<Event>,
    /// A key of another view.
    toggled: Option<View>,
}

/// Draws a view in a window of its own, or inside the window where the system has
/// one window only; tells whether it stays open.
fn window(
    context: &Context,
    row: &ViewRow,
    language: Language,
    board: Option<LinkState>,
    typed: &mut Typed,
    mut add: impl FnMut(&mut Ui, bool),
) -> bool {
    let title = (row.name)().text(language);
    let id = format!("{:?}", row.view);
    if context.embed_viewports() {
        let mut open = true;
        egui::Window::new(title)
            .id(egui::Id::unique(&id))
            .open(&mut open)
            .default_size(row.size)
            .min_size(row.least)
            .collapsible(false)
            .show(context, |ui| {
                badge::show(ui, &id, board, language);
                add(ui, false);
            });
        return open;
    }
    let builder = ViewportBuilder::default()
        .with_title(badge::title(&format!("{title} - GSK980TD"), board))
        .with_app_id("gsk980td")
        .with_inner_size(row.size)
        .with_min_inner_size(row.least);
    let viewport = ViewportId::from_hash_of(&id);
    context.show_viewport_immediate(viewport, builder, |ui, _| {
        badge::show(ui, &id, board, language);
        add(ui, true);
        let typing = ui.ctx().egui_wants_keyboard_input();
        ui.input(|input| {
            typed.focused |= input.focused;
            let events = input
                .events
                .iter()
                .filter(|event| for_panel(event, row.view, typing));
            typed.events.extend(events.cloned());
            let closing = input.viewport().close_requested();
            let toggled = toggled(&input.events);
            let again = toggled == Some(row.view);
            if !again {
                typed.toggled = typed.toggled.or(toggled);
            }
            !closing && !again
        })
    })
}

/// Whether a key typed into a view's window is meant for the panel. Feed hold and
/// emergency stop always are, and every release; of a view without keys of its own
/// for them the function keys and what is held with Ctrl or Alt, unless a field is
/// being filled.
fn for_panel(event: &Event, view: View, typing: bool) -> bool {
    let Event::Key {
        key,
        pressed,
        modifiers,
        ..
    } = event
    else {
        return false;
    };
    if !pressed {
        return true;
    }
    if matches!(key, Key::F10 | Key::F12) && !modifiers.any() {
        return true;
    }
    let number = key.name().strip_prefix('F');
    let function = number.is_some_and(|number| !number.is_empty());
    let combined = modifiers.ctrl || modifiers.alt;
    view != View::Ladder && !typing && !modifiers.shift && (function || combined)
}

/// The view that a key opens or closes.
pub fn toggled(events: &[Event]) -> Option<View> {
    let pressed = |wanted: Key| {
        events.iter().any(|event| {
            matches!(
                event,
                Event::Key { key, pressed: true, repeat: false, modifiers, .. }
                    if *key == wanted && modifiers.shift && !modifiers.ctrl && !modifiers.alt
            )
        })
    };
    VIEWS
        .iter()
        .find(|row| pressed(row.key))
        .map(|row| row.view)
}

fn bar_frame() -> Frame {
    Frame::new()
        .fill(Color32::from_gray(34))
        .inner_margin(Margin::symmetric(8, 5))
}

fn side_frame() -> Frame {
    Frame::new()
        .fill(Color32::from_gray(28))
        .inner_margin(Margin::symmetric(8, 6))
}

fn plain_frame() -> Frame {
    Frame::new().fill(Color32::from_gray(18))
}

/// The name of a view's key.
pub fn key_name(row: &ViewRow) -> String {
    format!("Shift+{}", row.key.name())
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::Modifiers;

    fn press(key: Key, modifiers: Modifiers) -> Event {
        Event::Key {
            key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers,
        }
    }

    #[test]
    fn stops_reach_the_panel_from_everywhere_and_a_start_never_by_mistake() {
        let plain = Modifiers::NONE;
        for view in [View::Scope, View::Bench, View::Ladder, View::Link] {
            for typing in [false, true] {
                for key in [Key::F10, Key::F12] {
                    assert!(for_panel(&press(key, plain), view, typing));
                }
                assert!(!for_panel(&press(Key::X, plain), view, typing));
            }
            assert!(!for_panel(&press(Key::F9, plain), view, true));
        }
        // F9 saves in the ladder view, Ctrl+Z takes back.
        assert!(!for_panel(&press(Key::F9, plain), View::Ladder, false));
        assert!(!for_panel(
            &press(Key::Z, Modifiers::CTRL),
            View::Ladder,
            false
        ));
        assert!(for_panel(&press(Key::F9, plain), View::Scope, false));
        assert!(for_panel(
            &press(Key::ArrowLeft, Modifiers::CTRL),
            View::Scope,
            false
        ));
    }
}
