//! Passes the keys of the PC keyboard to the kernel, to views and to layouts, and reports held
//! keys.

use egui::{Event, Popup, Ui};
use gsk_help::Topic;
use gsk_host::input_watch::QUERY_INTERVAL;
use gsk_host::kernel::Command;
use gsk_panel::keys::Key;

use crate::chrome::zoom;
use crate::input::held_keys::PanelKeyChange;
use crate::input::keyboard::{self, PcAction};
use crate::widgets::status_message::StatusMessage;
use crate::{Window, layout, view, views};

/// What has the keyboard at the begin of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum KeyReceiver {
    /// The panel, or a widget without text.
    Panel,
    /// An open menu.
    Menu,
    /// A field for text or a number.
    Field,
}

impl KeyReceiver {
    pub(crate) fn at_begin_of_frame(context: &egui::Context) -> Self {
        match (context.text_edit_focused(), Popup::is_any_open(context)) {
            (true, _) => Self::Field,
            (false, true) => Self::Menu,
            (false, false) => Self::Panel,
        }
    }
}

impl Window {
    /// Releases all held keys, because the window is hidden or has lost the focus.
    pub fn release_keys(&mut self) {
        self.pointing.reset();
        self.long_press.reset();
        let changes = self.held_keys.release_all();
        self.console
            .input_watch
            .set_holders(self.held_keys.holders());
        self.send(&changes);
    }

    /// Reports to the kernel that the window is alive while keys are held.
    pub(crate) fn renew_held_keys(&self, context: &egui::Context) {
        self.console
            .input_watch
            .set_holders(self.held_keys.holders());
        if self.held_keys.has_any() {
            // The kernel releases all keys when it receives no `Alive` command from the
            // window, or when the display does not show the keys as held.
            self.console.send(Command::Alive);
            context.request_repaint_after(QUERY_INTERVAL);
        }
    }

    /// Handles the keys of the PC keyboard. While a text field has the focus, only the stop
    /// keys reach the panel. `receiver`: what had the keyboard when the keys arrived.
    pub(crate) fn handle_keyboard(&mut self, ui: &Ui, receiver: KeyReceiver) {
        let events: Vec<Event> = ui.input(|input| input.events.clone());
        // Return ends the entry in a field, which has lost the focus by now.
        let is_typing = receiver == KeyReceiver::Field || ui.ctx().text_edit_focused();
        if is_typing || self.first_start.is_some() {
            let stops: Vec<Event> = events
                .into_iter()
                .filter(keyboard::is_stop_or_release)
                .collect();
            self.handle_keys(&stops);
            return;
        }
        zoom::handle_keys(ui.ctx(), &events, &mut self.settings);
        let mut events = keyboard::filter_for_focus(ui.ctx(), events);
        if keyboard::remove_axis_keys_in_list(ui.ctx(), &mut events) {
            self.explain_axis_key_in_list();
        }
        if receiver == KeyReceiver::Menu {
            events = keyboard::filter_for_menu(events, self.is_running_or_unknown());
        }
        if let Some(view) = view::view_of_pressed_key(&events) {
            views::show_or_close(ui.ctx(), &mut self.settings.layouts, view);
        }
        if let Some(layout) = layout::layout_of_pressed_key(&events) {
            self.settings.layouts.choose(layout);
        }
        self.handle_keys(&events);
    }

    /// Shows a message that an axis key has moved the cursor of a list, and no axis.
    pub(crate) fn explain_axis_key_in_list(&mut self) {
        self.message = Some(StatusMessage::KeyRefused(
            gsk_messages::say::window_axis_key_in_list(),
        ));
    }

    pub(crate) fn handle_keys(&mut self, events: &[Event]) {
        for event in events {
            match keyboard::action_of(event) {
                Some(PcAction::Help) => {
                    let about = self
                        .pointer_position
                        .and_then(|at| self.topic_at_position(at));
                    match about {
                        Some(about) => self.help.toggle(Some(about)),
                        None => self.toggle_help(self.pointed_topic),
                    }
                }
                Some(PcAction::Turn(graduations)) => self.console.send(Command::Turn(graduations)),
                Some(PcAction::Type(character)) => {
                    self.held_keys.drop_waiting_latch();
                    self.console.send(Command::Type(character));
                }
                Some(PcAction::Press(holder, key)) => {
                    if key == Key::Reset {
                        self.message =
                            Some(StatusMessage::Done(gsk_messages::say::window_reset_by_key()));
                    }
                    let changes = self.held_keys.press(holder, key);
                    self.send(&changes);
                }
                Some(PcAction::Release(holder)) => {
                    let changes = self.held_keys.set(holder, None);
                    self.send(&changes);
                }
                None => {}
            }
        }
    }

    /// Opens the help away from the panel: about the current alarm, else about the view there,
    /// else at the last topic. Closes the help if it shows that topic.
    pub(crate) fn toggle_help(&mut self, view: Option<&'static Topic>) {
        self.help.toggle(self.alarm_topic().or(view));
    }

    pub(crate) fn send(&self, changes: &[PanelKeyChange<Key>]) {
        for change in changes {
            self.console.send(Command::Key {
                key: change.key,
                down: change.is_down,
            });
        }
    }
}
