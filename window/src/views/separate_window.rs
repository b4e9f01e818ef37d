//! The separate windows of views: title, place, the key of the view, and which keys reach the
//! panel.

use egui::{
    Context, Event, Frame, Id, Label, Margin, Panel, Pos2, Rect, ScrollArea, Ui, Vec2,
    ViewportBuilder, ViewportCommand, ViewportId,
};
use gsk_core::model::ModelId;
use gsk_help::Topic;
use gsk_link::LinkState;
use gsk_messages::{Language, say};

use super::header;
use crate::fonts;
use crate::help;
use crate::input::keyboard::{self, PcAction};
use crate::layout::{self, Layouts, WindowGeometry, WindowLayout, floating};
use crate::theme;
use crate::view::{ViewId, ViewRow, view_of_pressed_key};
use crate::widgets::real_machine_bar;
use crate::widgets::severity::MessageSeverity;

/// Height of the message line in a separate window, points.
pub(super) const MESSAGE_HEIGHT: f32 = 26.0;
/// Size of the help in a separate window, points.
const HELP_SIZE: [f32; 2] = [360.0, 320.0];

/// What all separate windows of views show besides their view.
#[derive(Clone, Debug)]
pub struct SeparateWindows {
    /// Language of titles and messages.
    pub language: Language,
    /// State of the board that moves the slides; `None` for a simulated lathe.
    pub board: Option<LinkState>,
    /// Position of the LCD in the main window, which new windows leave free, points.
    pub lcd: Option<Rect>,
    /// The messages of the message line, the most dangerous first.
    pub messages: Vec<(MessageSeverity, String)>,
    /// The topic of the current alarm, which F1 shows first; `None` without an alarm.
    pub alarm_topic: Option<&'static Topic>,
}

/// Draws the message line at the bottom of a separate window: its operator does not see the one of
/// the main window.
fn show_messages(
    ui: &mut Ui,
    id: &str,
    messages: &[(MessageSeverity, String)],
    language: Language,
) {
    let frame = Frame::new()
        .fill(theme::BAR_GROUND)
        .inner_margin(Margin::symmetric(8, 0));
    let line = Panel::bottom(format!("messages {id}"))
        .exact_size(MESSAGE_HEIGHT)
        .frame(frame);
    line.show(ui, |ui| {
        ui.horizontal_centered(|ui| {
            let width = ui.available_width() / messages.len().max(1) as f32;
            for (severity, text) in messages {
                ui.scope(|ui| {
                    ui.set_max_width(width);
                    severity.show_sign(ui, severity.name().text(language));
                    let font = egui::TextStyle::Body.resolve(ui.style());
                    let words = fonts::layout_text(text, font, severity.color());
                    ui.add(Label::new(words).truncate()).on_hover_text(text);
                });
            }
        });
    });
}

/// Handles the key of a view that was pressed elsewhere: opens the view or closes its pane. A
/// separate window, which may be covered, comes to the front; its own key closes it there.
pub fn show_or_close(context: &Context, layouts: &mut Layouts, view: ViewId) {
    if layouts.floating().contains(&view) {
        context.send_viewport_cmd_to(viewport_of(view), ViewportCommand::Focus);
    } else {
        layouts.toggle(view);
    }
}

/// The separate window of a view.
fn viewport_of(view: ViewId) -> ViewportId {
    ViewportId::from_hash_of(format!("{view:?}"))
}

/// Keyboard input in the separate windows of views, and its requests to the main window.
#[derive(Debug, Default)]
pub struct PanelInput {
    /// Whether a separate window of a view has the focus.
    pub has_focus: bool,
    pub events: Vec<Event>,
    /// Whether a jog key was suppressed because a list uses the cursor keys.
    pub jogs_in_list: bool,
    /// The view whose key was pressed in the window of another view, if any.
    pub(super) toggled_view: Option<ViewId>,
    /// The layout whose key was pressed in the window of a view, if any.
    pub(super) chosen_layout: Option<WindowLayout>,
}

/// The separate window of one view, while it is drawn.
pub(super) struct ViewWindow<'a> {
    pub(super) row: &'static ViewRow,
    pub(super) model: ModelId,
    pub(super) shared: &'a SeparateWindows,
    /// Initial upper left corner, points; `None` if the window manager places the window.
    pub(super) corner: Option<Pos2>,
    pub(super) size: Vec2,
}

/// The events in a view's separate window during a frame.
#[derive(Debug, Default)]
pub(super) struct ViewWindowReport {
    pub(super) header_action: Option<header::HeaderAction>,
    /// The current position and size of the window; `None` if they must not be stored.
    pub(super) geometry: Option<WindowGeometry>,
}

impl ViewWindow<'_> {
    pub(super) fn show(
        &self,
        context: &Context,
        panel_input: &mut PanelInput,
        mut add: impl FnMut(&mut Ui) -> Option<header::HeaderAction>,
    ) -> ViewWindowReport {
        let row = self.row;
        let (language, board) = (self.shared.language, self.shared.board);
        let title = (row.name)().text(language);
        let model = self.model.name().text(language);
        let id = format!("{:?}", row.view);
        let mut report = ViewWindowReport::default();
        let mut builder = ViewportBuilder::default()
            .with_title(real_machine_bar::window_title(
                &format!("{title} - {model}"),
                board,
            ))
            .with_app_id("gsk980td")
            .with_inner_size(self.size)
            .with_min_inner_size(Vec2::from(row.min_size).min(self.size));
        if let Some(corner) = self.corner {
            builder = builder.with_position(corner);
        }
        let viewport = viewport_of(row.view);
        context.show_viewport_immediate(viewport, builder, |ui, _| {
            // The gaps between the panels.
            ui.painter()
                .rect_filled(ui.ctx().content_rect(), 0.0, theme::BAR_GROUND);
            real_machine_bar::show(ui, &id, board, language);
            show_messages(ui, &id, &self.shared.messages, language);
            report.header_action = add(ui);
            let typing = ui.ctx().egui_wants_keyboard_input();
            let mut events = ui.input(|input| input.events.clone());
            panel_input.jogs_in_list |= keyboard::remove_axis_keys_in_list(ui.ctx(), &mut events);
            ui.input(|input| {
                panel_input.has_focus |= input.focused;
                let toggled = view_of_pressed_key(&input.events);
                let closes_itself = toggled == Some(row.view);
                if closes_itself || input.viewport().close_requested() {
                    report.header_action = Some(header::HeaderAction::Close);
                }
                if !closes_itself {
                    panel_input.toggled_view = panel_input.toggled_view.or(toggled);
                }
                panel_input.chosen_layout = panel_input
                    .chosen_layout
                    .or(layout::layout_of_pressed_key(&input.events));
                report.geometry = floating::normal_geometry(input.viewport());
            });
            let is_help = |event: &Event| keyboard::action_of(event) == Some(PcAction::Help);
            let topic = help::take_pointed_topic(ui.ctx()).or_else(|| row.view.topic());
            if events.iter().any(is_help) {
                toggle_topic(ui, row.view, self.shared.alarm_topic.or(topic));
            }
            show_topic(ui, row.view, language);
            events.retain(|event| !is_help(event) && is_for_panel(event, row.view, typing));
            panel_input.events.extend(events);
        });
        report
    }
}

/// The id under which the window of a view keeps the topic that it shows.
fn topic_id(view: ViewId) -> Id {
    Id::unique(("topic", view))
}

/// Opens the help of a view's window at a topic, or closes it if it already shows that topic.
fn toggle_topic(ui: &Ui, view: ViewId, topic: Option<&'static Topic>) {
    ui.data_mut(|data| {
        let shown: &mut Option<&'static Topic> = data.get_temp_mut_or_default(topic_id(view));
        *shown = topic.filter(|topic| *shown != Some(*topic));
    });
}

/// Shows the help in the window of a view: this window may cover that of the main window.
fn show_topic(ui: &Ui, view: ViewId, language: Language) {
    let shown: Option<Option<&'static Topic>> = ui.data(|data| data.get_temp(topic_id(view)));
    let Some(topic) = shown.flatten() else {
        return;
    };
    let mut is_open = true;
    let area = ui.ctx().content_rect().shrink(8.0);
    let size = Vec2::from(HELP_SIZE).min(area.size());
    egui::Window::new(say::window_help_title().text(language))
        .id(topic_id(view))
        .collapsible(false)
        .default_size(size)
        .default_pos(area.right_top() - Vec2::new(size.x, 0.0))
        .constrain_to(area)
        .open(&mut is_open)
        .show(ui.ctx(), |ui| {
            ScrollArea::vertical().show(ui, |ui| help::show_article(ui, topic, language));
        });
    if !is_open {
        toggle_topic(ui, view, None);
    }
}

/// Whether a key pressed in a view's window is meant for the panel. Feed hold, emergency stop
/// and every release always are. Function keys and combinations with Ctrl or Alt are, unless
/// the view uses these keys itself or a text field is being filled.
fn is_for_panel(event: &Event, view: ViewId, typing: bool) -> bool {
    let Event::Key { key, modifiers, .. } = event else {
        return false;
    };
    if keyboard::is_stop_or_release(event) {
        return true;
    }
    let number = key.name().strip_prefix('F');
    let is_function_key = number.is_some_and(|number| !number.is_empty());
    let has_ctrl_or_alt = modifiers.ctrl || modifiers.alt;
    let view_uses_keys = view.row().uses_keys;
    !view_uses_keys && !typing && !modifiers.shift && (is_function_key || has_ctrl_or_alt)
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Key, Modifiers};

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
        for view in [ViewId::Scope, ViewId::Bench, ViewId::Ladder, ViewId::Link] {
            for typing in [false, true] {
                for key in [Key::F10, Key::F12] {
                    assert!(is_for_panel(&press(key, plain), view, typing));
                    assert!(is_for_panel(&press(key, Modifiers::SHIFT), view, typing));
                }
                assert!(!is_for_panel(&press(Key::X, plain), view, typing));
            }
            assert!(!is_for_panel(&press(Key::F9, plain), view, true));
        }
        // F9 saves in the ladder view, Ctrl+Z undoes.
        assert!(!is_for_panel(&press(Key::F9, plain), ViewId::Ladder, false));
        assert!(!is_for_panel(
            &press(Key::Z, Modifiers::CTRL),
            ViewId::Ladder,
            false
        ));
        assert!(is_for_panel(&press(Key::F9, plain), ViewId::Scope, false));
        assert!(is_for_panel(
            &press(Key::ArrowLeft, Modifiers::CTRL),
            ViewId::Scope,
            false
        ));
    }
}
