//! Finds the next key of a step from the keys that the learner has pressed.

use gsk_panel::keys::{Key, KeyRole};
use gsk_panel::panel::Panel;
use gsk_panel::script::ScriptAction;

use crate::LessonStep;

/// An action of the learner that the cue waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CueAction {
    /// Press a key.
    Press(Key),
    /// Hold a key and release it when the step says so.
    Hold(Key),
    /// Release a key that is down.
    Release(Key),
    /// Turn the handwheel by this number of graduations.
    Turn(u32),
}

impl CueAction {
    /// The key to press or to release; `None` for the handwheel.
    const fn key(self) -> Option<Key> {
        match self {
            Self::Press(key) | Self::Hold(key) | Self::Release(key) => Some(key),
            Self::Turn(_) => None,
        }
    }

    /// Whether the learner may omit the action, because the machine can already be in the
    /// state that it leads to. Typed text is needed as a whole.
    fn is_optional(self) -> bool {
        match self {
            Self::Press(key) | Self::Hold(key) => !is_typed(key) && key.row().role != KeyRole::Edit,
            Self::Release(_) => false,
            Self::Turn(_) => true,
        }
    }
}

fn is_typed(key: Key) -> bool {
    matches!(key.row().role, KeyRole::Character(..))
}

/// Follows the keys of a step in the order of its solution.
#[derive(Clone, Debug, Default)]
pub(super) struct KeyCue {
    actions: Vec<CueAction>,
    /// Number of actions that are done.
    done: usize,
    /// Number of wrong characters in the input line since the last correct one.
    wrong_characters: usize,
    /// Number of graduations turned since the last action.
    turned: u32,
    /// Keys that were held at the last tick.
    held: Vec<Key>,
    /// Position of the handwheel at the last tick, graduations.
    wheel: i32,
}

impl KeyCue {
    /// Starts at the first key of a step, on a panel in its current state; `None` at the end of
    /// the lesson. Keys of the solution that the step neither marks nor types are left out.
    pub(super) fn begin(step: Option<&LessonStep>, panel: &Panel) -> Self {
        Self {
            actions: step.map(list_actions).unwrap_or_default(),
            held: panel.held().to_vec(),
            wheel: panel.wheel(),
            ..Self::default()
        }
    }

    /// The key to press now, or to release; `None` if the learner turns the handwheel or
    /// waits.
    pub(super) fn next_key(&self) -> Option<Key> {
        self.actions.get(self.done)?.key()
    }

    /// Compares the panel with its state at the last tick.
    pub(super) fn follow(&mut self, panel: &Panel) {
        if self.held != panel.held() {
            let before = core::mem::replace(&mut self.held, panel.held().to_vec());
            for key in before.iter().filter(|key| !panel.is_held(**key)) {
                self.take_release(*key);
            }
            for key in panel.held().iter().filter(|key| !before.contains(key)) {
                self.take_press(*key);
            }
        }
        let wheel = panel.wheel();
        if wheel != self.wheel {
            let graduations = wheel.abs_diff(self.wheel);
            self.wheel = wheel;
            self.take_turn(graduations);
        }
    }

    fn take_press(&mut self, key: Key) {
        let remaining = self.actions.get(self.done..).unwrap_or_default();
        let mut ahead = remaining.iter();
        let found = ahead.position(|action| match action {
            CueAction::Press(wanted) | CueAction::Hold(wanted) => *wanted == key,
            CueAction::Release(_) | CueAction::Turn(_) => false,
        });
        let reachable = found.filter(|at| remaining[..*at].iter().all(|it| it.is_optional()));
        match (key, reachable) {
            (Key::Cancel, None) => self.delete_character(),
            (Key::Reset, None) => self.done = 0,
            (Key::Input | Key::Eob, _) if self.wrong_characters > 0 => self.repeat_word(),
            (Key::Input | Key::Eob, None) => self.repeat_word(),
            (_, None) if is_typed(key) => self.wrong_characters += 1,
            (_, None) => {}
            (_, Some(_)) if is_typed(key) && self.wrong_characters > 0 => {
                self.wrong_characters += 1;
            }
            (_, Some(at)) => match remaining[at] {
                CueAction::Hold(_) => self.done += at,
                _ => self.complete(self.done + at),
            },
        }
    }

    fn take_release(&mut self, key: Key) {
        let current = self.actions.get(self.done).copied();
        if current == Some(CueAction::Hold(key)) || current == Some(CueAction::Release(key)) {
            self.complete(self.done);
        }
    }

    fn take_turn(&mut self, graduations: u32) {
        self.turned = self.turned.saturating_add(graduations);
        if let Some(CueAction::Turn(wanted)) = self.actions.get(self.done)
            && self.turned >= *wanted
        {
            self.complete(self.done);
        }
    }

    fn delete_character(&mut self) {
        if self.wrong_characters > 0 {
            self.wrong_characters -= 1;
        } else if let Some(before) = self.done.checked_sub(1)
            && self.actions[before].key().is_some_and(is_typed)
        {
            self.done = before;
        }
    }

    /// Goes back to the first character of the word that was entered with a mistake.
    fn repeat_word(&mut self) {
        self.wrong_characters = 0;
        let before = &self.actions[..self.done];
        let is_other = |action: &CueAction| !action.key().is_some_and(is_typed);
        self.done = before.iter().rposition(is_other).map_or(0, |at| at + 1);
    }

    /// Completes the action `at`. After the last one of a step that is not complete, its key
    /// remains the next one; after a release the keys begin again.
    fn complete(&mut self, at: usize) {
        self.wrong_characters = 0;
        self.turned = 0;
        let last = self.actions.len() - 1;
        self.done = match self.actions[at] {
            CueAction::Release(_) if at == last => 0,
            _ => last.min(at + 1),
        };
    }
}

fn list_actions(step: &LessonStep) -> Vec<CueAction> {
    // Typed words are entered, whether the step names the key or not.
    let is_entry = |key: Key| is_typed(key) || matches!(key, Key::Input | Key::Eob);
    let is_shown = |key: Key| step.keys.contains(&key) || is_entry(key);
    let actions = step.solution.lines.iter().filter_map(|line| {
        let action = match line.action {
            // A key that stays down is released later by a separate action.
            ScriptAction::Press(key) | ScriptAction::Down(key) => CueAction::Press(key),
            ScriptAction::Hold(key, _) => CueAction::Hold(key),
            ScriptAction::Up(key) => CueAction::Release(key),
            ScriptAction::Turn(graduations, _) => CueAction::Turn(graduations.unsigned_abs()),
            _ => return None,
        };
        action.key().is_none_or(is_shown).then_some(action)
    });
    actions.collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use gsk_panel::emulator::Emulator;

    use super::*;
    use crate::{Lesson, Practice, built_in_lessons, demonstrations};

    fn lesson(name: &str) -> Arc<Lesson> {
        let all = built_in_lessons();
        let found = all.into_iter().find(|lesson| lesson.name == name);
        Arc::new(found.expect("a built-in lesson"))
    }

    /// Starts a lesson at a step, from 0.
    fn begin_at(name: &str, step: usize) -> (Practice, Emulator) {
        let (mut practice, mut machine) = Practice::begin(lesson(name)).expect("a machine");
        while practice.view().step < step {
            practice.show_me(&mut machine);
            while practice.view().showing {
                practice.tick(&mut machine);
            }
        }
        (practice, machine)
    }

    fn hold(practice: &mut Practice, machine: &mut Emulator, key: Key, ticks: usize) {
        machine.key_down(key);
        (0..ticks).for_each(|_| practice.tick(machine));
        machine.key_up(key);
        (0..50).for_each(|_| practice.tick(machine));
    }

    fn press(practice: &mut Practice, machine: &mut Emulator, keys: &[Key]) {
        for key in keys {
            hold(practice, machine, *key, 100);
        }
    }

    /// *Show me* presses the key that is marked, in every step of every lesson.
    #[test]
    fn the_marked_key_is_the_one_that_show_me_presses() {
        let shown = demonstrations().iter().map(|it| Arc::clone(&it.lesson));
        let lessons = built_in_lessons().into_iter().map(Arc::new);
        for lesson in lessons.chain(shown) {
            let (mut practice, mut machine) =
                Practice::begin(Arc::clone(&lesson)).expect("a machine");
            while practice.view().step < lesson.steps.len() {
                let step = practice.view().step;
                let shown = list_actions(&lesson.steps[step]);
                practice.show_me(&mut machine);
                while practice.view().showing && practice.view().step == step {
                    let marked = practice.view().next_key;
                    let before = machine.panel().held().to_vec();
                    practice.tick(&mut machine);
                    // Two keys can go down in the same tick, one after the other.
                    let is_listed = |key: &&Key| shown.iter().any(|it| it.key() == Some(**key));
                    let mut pressed = machine.panel().held().iter().filter(is_listed);
                    if let Some(key) = pressed.find(|key| !before.contains(key)) {
                        assert_eq!(marked, Some(*key), "{}, step {}", lesson.name, step + 1);
                    }
                }
                while practice.view().showing {
                    practice.tick(&mut machine);
                }
            }
        }
    }

    #[test]
    fn the_next_key_follows_typed_text_with_its_mistakes() {
        let (mut practice, mut machine) = begin_at("05-tool-setting", 4);
        let next = |practice: &Practice| practice.view().next_key;
        assert_eq!(next(&practice), Some(Key::Offset));
        press(&mut practice, &mut machine, &[Key::Offset, Key::P]);
        assert_eq!(next(&practice), Some(Key::Digit1));
        // A wrong digit, deleted again.
        press(&mut practice, &mut machine, &[Key::Digit2, Key::Cancel]);
        assert_eq!(next(&practice), Some(Key::Digit1));
        // A right one, deleted and typed again.
        press(&mut practice, &mut machine, &[Key::Digit1, Key::Cancel]);
        assert_eq!(next(&practice), Some(Key::Digit1));
        press(&mut practice, &mut machine, &[Key::Digit1, Key::Input]);
        assert_eq!(next(&practice), Some(Key::X));
        // Entered with a mistake, so the word is typed again.
        let wrong = [Key::X, Key::Digit4, Key::Digit9, Key::Input];
        press(&mut practice, &mut machine, &wrong);
        assert_eq!(next(&practice), Some(Key::X));
    }

    #[test]
    fn a_mode_that_is_active_can_be_skipped() {
        let (mut practice, mut machine) = begin_at("05-tool-setting", 8);
        let next = |practice: &Practice| practice.view().next_key;
        assert_eq!(next(&practice), Some(Key::WheelZ));
        press(&mut practice, &mut machine, &[Key::Increment100]);
        // No key is marked while the handwheel is turned.
        assert_eq!(next(&practice), None);
        machine.turn(50);
        practice.tick(&mut machine);
        assert_eq!(next(&practice), Some(Key::Mdi));
    }

    /// The axis key stays marked while the learner holds it on the switch, and a key that he has
    /// kept down is marked again to be released.
    #[test]
    fn overtravel_release_is_marked_again_at_the_end() {
        let (mut practice, mut machine) = begin_at("07-alarms", 4);
        let next = |practice: &Practice| practice.view().next_key;
        assert_eq!(next(&practice), Some(Key::OvertravelRelease));
        machine.key_down(Key::OvertravelRelease);
        (0..300).for_each(|_| practice.tick(&mut machine));
        assert_eq!(next(&practice), Some(Key::XUp));
        machine.key_down(Key::XUp);
        (0..300).for_each(|_| practice.tick(&mut machine));
        assert_eq!(next(&practice), Some(Key::XUp), "it is held");
        machine.key_up(Key::XUp);
        practice.tick(&mut machine);
        assert_eq!(next(&practice), Some(Key::OvertravelRelease));
    }
}
