//! Maps events of the PC keyboard to panel keys.

use egui::{Context, Event, Key as PcKey, Modifiers};
use gsk_panel::keys::Key;

use super::held_keys::KeyHolder;
use crate::focus;

/// The action of a PC key on the panel or the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PcAction {
    /// Press this panel key; the holder keeps it down.
    Press(KeyHolder, Key),
    /// Release the panel key that this holder keeps down.
    Release(KeyHolder),
    /// Enter this character, for which the panel has no key.
    Type(char),
    /// Turn the handwheel by this number of graduations, clockwise positive.
    Turn(i32),
    /// Open the help window.
    Help,
}

/// The action of a keyboard event; `None` if it has none. Repeats of a held key have none,
/// because the control repeats keys itself.
pub fn action_of(event: &Event) -> Option<PcAction> {
    if let Event::Text(text) = event {
        return type_action(text);
    }
    let Event::Key {
        key,
        pressed,
        repeat,
        modifiers,
        ..
    } = event
    else {
        return None;
    };
    if let Some(graduations) = handwheel_graduations(*key, *modifiers) {
        // A held key continues to turn the wheel.
        return pressed.then_some(PcAction::Turn(graduations));
    }
    let holder = KeyHolder::Keyboard(*key);
    if !pressed {
        return Some(PcAction::Release(holder));
    }
    if *repeat {
        return None;
    }
    // Shift+F1 opens a view, Ctrl+F1 is a soft key.
    if *key == PcKey::F1 && !modifiers.shift && !modifiers.ctrl {
        return Some(PcAction::Help);
    }
    panel_key(*key, *modifiers).map(|panel| PcAction::Press(holder, panel))
}

/// Returns those events that are meant for the panel while a button or a menu of the window
/// has the focus: Enter and Space press that button and no panel key. Any other character
/// removes the focus.
pub fn filter_for_focus(context: &Context, mut events: Vec<Event>) -> Vec<Event> {
    let Some(focused) = context.memory(egui::Memory::focused) else {
        return events;
    };
    events.retain(|event| !is_widget_press(event));
    let is_character = |event: &Event| match event {
        Event::Key {
            key, pressed: true, ..
        } => panel_key(*key, Modifiers::NONE).is_some() && key.name().chars().count() == 1,
        _ => false,
    };
    if events.iter().any(is_character) {
        context.memory_mut(|memory| memory.surrender_focus(focused));
    }
    events
}

/// Removes the cursor keys from the events while a list or a splitter uses them (WINDOW-27),
/// so that they jog no axis. An axis key removes the focus from the list; returns whether the
/// operator pressed one.
pub fn remove_axis_keys_in_list(context: &Context, events: &mut Vec<Event>) -> bool {
    let focused = context.memory(egui::Memory::focused);
    let Some(focused) = focused.filter(|_| focus::are_cursor_keys_reserved(context)) else {
        return false;
    };
    let count_before = events.len();
    events.retain(|event| !focus::is_axis_key(event));
    let pressed_axis_key = events.len() < count_before;
    if pressed_axis_key {
        context.memory_mut(|memory| memory.surrender_focus(focused));
    }
    pressed_axis_key
}

/// Returns those events that are meant for the panel in a frame in which a menu was open. The
/// Escape that closes the menu is also RESET only if `is_running` (WINDOW-26). The cursor keys
/// move in the menu.
pub fn filter_for_menu(mut events: Vec<Event>, is_running: bool) -> Vec<Event> {
    let in_menu = |event: &Event| match event {
        Event::Key {
            key: PcKey::Escape,
            pressed: true,
            ..
        } => !is_running,
        Event::Key {
            key,
            pressed: true,
            modifiers,
            ..
        } => focus::is_cursor(*key) && !modifiers.any(),
        _ => false,
    };
    events.retain(|event| !in_menu(event));
    events
}

/// Whether an event always reaches the panel, whatever has the focus: feed hold, emergency
/// stop, and every key release.
pub fn is_stop_or_release(event: &Event) -> bool {
    match event {
        Event::Key { pressed: false, .. } => true,
        Event::Key { key, .. } => matches!(key, PcKey::F10 | PcKey::F12),
        _ => false,
    }
}

/// Whether an event presses the widget that has the focus.
fn is_widget_press(event: &Event) -> bool {
    match event {
        Event::Key {
            key, pressed: true, ..
        } => matches!(key, PcKey::Enter | PcKey::Space),
        Event::Text(text) => text == " ",
        _ => false,
    }
}

/// Graduations by which a key turns the handwheel: `]` clockwise, `[` back; ten with Shift.
/// `None` for other keys.
fn handwheel_graduations(key: PcKey, modifiers: Modifiers) -> Option<i32> {
    let graduations = if modifiers.shift { 10 } else { 1 };
    match key {
        _ if modifiers.ctrl || modifiers.alt => None,
        PcKey::CloseBracket | PcKey::CloseCurlyBracket => Some(graduations),
        PcKey::OpenBracket | PcKey::OpenCurlyBracket => Some(-graduations),
        _ => None,
    }
}

/// The action of a typed character that has no panel key: `D`, `Q`, `#`, … `None` for the
/// others, which arrive as keys.
fn type_action(text: &str) -> Option<PcAction> {
    let mut characters = text.chars();
    let character = characters.next()?.to_ascii_uppercase();
    let printable = character.is_ascii_graphic() && characters.next().is_none();
    let turns_wheel = "[]{}".contains(character);
    let has_key = turns_wheel || Key::from_pc_key(character.encode_utf8(&mut [0; 4])).is_some();
    (printable && !has_key).then_some(PcAction::Type(character))
}

/// The panel key that a PC key with its modifiers presses; `None` if it presses none.
fn panel_key(key: PcKey, modifiers: Modifiers) -> Option<Key> {
    let name = plain_name(key);
    let mut combined = String::new();
    for (held, prefix) in [
        (modifiers.ctrl, "Ctrl+"),
        (modifiers.alt, "Alt+"),
        (modifiers.shift, "Shift+"),
    ] {
        if held {
            combined.push_str(prefix);
        }
    }
    combined.push_str(name);
    // Shift makes no difference for letters and signs: `x` and `X` are one key. Feed hold and
    // emergency stop work with every modifier.
    let only_shift = modifiers.shift && !modifiers.ctrl && !modifiers.alt;
    let is_stop_key = matches!(key, PcKey::F10 | PcKey::F12);
    Key::from_pc_key(&combined).or_else(|| {
        let character = name.chars().count() == 1;
        if is_stop_key || (only_shift && character) {
            Key::from_pc_key(name)
        } else {
            None
        }
    })
}

/// The name of a PC key in the key table: the character that the key types, else egui's name.
fn plain_name(key: PcKey) -> &'static str {
    match key {
        PcKey::Minus => "-",
        PcKey::Plus => "+",
        PcKey::Equals => "=",
        PcKey::Period => ".",
        PcKey::Comma => ",",
        PcKey::Slash => "/",
        PcKey::Semicolon | PcKey::Colon => ";",
        PcKey::ArrowUp => "ArrowUp",
        PcKey::ArrowDown => "ArrowDown",
        PcKey::ArrowLeft => "ArrowLeft",
        PcKey::ArrowRight => "ArrowRight",
        other => other.name(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_panel::keys::KEYS;

    fn event(key: PcKey, modifiers: Modifiers, pressed: bool, repeat: bool) -> Event {
        Event::Key {
            key,
            physical_key: None,
            pressed,
            repeat,
            modifiers,
        }
    }

    #[test]
    fn enter_presses_the_focused_button_and_no_panel_key() {
        let context = Context::default();
        let plain = Modifiers::default();
        let enter = || vec![event(PcKey::Enter, plain, true, false)];
        assert_eq!(filter_for_focus(&context, enter()), enter());
        let button = egui::Id::unique("button");
        context.memory_mut(|memory| memory.request_focus(button));
        assert_eq!(filter_for_focus(&context, enter()), []);
        let stop = vec![event(PcKey::F12, plain, true, false)];
        assert_eq!(filter_for_focus(&context, stop.clone()), stop);
        assert_eq!(context.memory(egui::Memory::focused), Some(button));
        let letter = vec![event(PcKey::X, plain, true, false)];
        assert_eq!(filter_for_focus(&context, letter.clone()), letter);
        assert_eq!(context.memory(egui::Memory::focused), None);
        assert_eq!(filter_for_focus(&context, enter()), enter());
    }

    #[test]
    fn brackets_turn_the_handwheel_and_repeat_while_held() {
        let plain = Modifiers::default();
        let shift = Modifiers::SHIFT;
        let turned = |key, modifiers, repeat| action_of(&event(key, modifiers, true, repeat));
        assert_eq!(
            turned(PcKey::CloseBracket, plain, false),
            Some(PcAction::Turn(1))
        );
        assert_eq!(
            turned(PcKey::OpenBracket, plain, true),
            Some(PcAction::Turn(-1))
        );
        assert_eq!(
            turned(PcKey::CloseCurlyBracket, shift, false),
            Some(PcAction::Turn(10))
        );
        assert_eq!(
            action_of(&event(PcKey::CloseBracket, plain, false, false)),
            None
        );
        assert_eq!(action_of(&Event::Text("]".to_owned())), None);
    }

    /// Checks that egui has every PC key of the table, with its modifiers.
    #[test]
    fn every_key_of_the_table_can_be_pressed() {
        for row in KEYS.iter().filter(|row| !row.pc.is_empty()) {
            let mut modifiers = Modifiers::default();
            let mut name = row.pc;
            while let Some((word, rest)) = name.split_once('+') {
                match word {
                    "Ctrl" => modifiers.ctrl = true,
                    "Alt" => modifiers.alt = true,
                    "Shift" => modifiers.shift = true,
                    _ => break,
                }
                name = rest;
            }
            let found = PcKey::ALL.iter().find(|key| {
                action_of(&event(**key, modifiers, true, false)).is_some_and(
                    |action| matches!(action, PcAction::Press(_, key) if key == row.key),
                )
            });
            assert!(
                found.is_some(),
                "{} cannot be pressed by {}",
                row.id,
                row.pc
            );
        }
    }

    #[test]
    fn repeats_are_ignored_and_shift_keeps_the_key() {
        let plain = Modifiers::default();
        assert_eq!(action_of(&event(PcKey::F12, plain, true, true)), None);
        let shift = Modifiers {
            shift: true,
            ..plain
        };
        assert!(matches!(
            action_of(&event(PcKey::X, shift, true, false)),
            Some(PcAction::Press(_, Key::X))
        ));
        assert_eq!(
            action_of(&event(PcKey::X, plain, false, false)),
            Some(PcAction::Release(KeyHolder::Keyboard(PcKey::X)))
        );
    }

    #[test]
    fn stops_stop_with_every_modifier() {
        for modifiers in [Modifiers::SHIFT, Modifiers::CTRL, Modifiers::ALT] {
            for (pc, panel) in [
                (PcKey::F12, Key::EmergencyStop),
                (PcKey::F10, Key::FeedHold),
            ] {
                let action = action_of(&event(pc, modifiers, true, false));
                assert!(
                    matches!(action, Some(PcAction::Press(_, key)) if key == panel),
                    "{modifiers:?} {pc:?}: {action:?}"
                );
            }
        }
    }

    /// Checks that no view or layout has a stop key as its key.
    #[test]
    fn views_and_layouts_use_no_stop_key() {
        use crate::layout::LAYOUTS;
        use crate::view::VIEWS;
        let keys = (VIEWS.iter().filter_map(|row| row.key))
            .chain(LAYOUTS.iter().filter_map(|row| row.key));
        for key in keys {
            assert!(
                !matches!(key, PcKey::F10 | PcKey::F12 | PcKey::Escape),
                "{key:?}"
            );
        }
    }

    #[test]
    fn characters_without_a_key_are_typed() {
        assert_eq!(
            action_of(&Event::Text("q".to_owned())),
            Some(PcAction::Type('Q'))
        );
        assert_eq!(
            action_of(&Event::Text("#".to_owned())),
            Some(PcAction::Type('#'))
        );
        assert_eq!(action_of(&Event::Text("x".to_owned())), None);
        assert_eq!(action_of(&Event::Text("车".to_owned())), None);
    }
}
