//! Handles mouse and fingers on the panel: the keys that they hold, and the handwheel.

use std::collections::BTreeSet;

use egui::{Event, MouseWheelUnit, PointerButton, Pos2, TouchPhase, Vec2};
use gsk_core::model::ModelId;
use gsk_panel::faceplate::{self, PartKind};
use gsk_panel::keys::Key;

use super::held_keys::{HeldKeys, KeyHolder, PanelKeyChange, can_be_latched};
use crate::placement::panel_placement::{self, PlacedArea};

/// Scroll distance that turns the handwheel by one detent, points.
const POINTS_PER_DETENT: f32 = 24.0;
/// Number of detents in one turn of the handwheel.
const DETENTS_PER_TURN: f32 = 100.0;

/// The effects on the panel of the mouse and touch events of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointerResult {
    /// Keys that went down or came up, in order.
    pub changes: Vec<PanelKeyChange<Key>>,
    /// Turn of the handwheel, detents, clockwise positive.
    pub detents: i32,
    /// A key that was right-clicked but cannot be latched; `None` without one.
    pub not_latched: Option<Key>,
}

/// The panel of a control model as it is placed in the window.
#[derive(Clone, Copy, Debug)]
pub struct PlacedPanel<'a> {
    /// The areas of the panel that are placed in the window.
    pub areas: &'a [PlacedArea],
    /// The control model to which the panel belongs.
    pub model: ModelId,
}

/// The state of mouse and fingers on the panel between two frames.
#[derive(Clone, Debug, Default)]
pub struct PanelPointer {
    fingers: BTreeSet<(u64, u64)>,
    /// Angle of the pointer that drags the handwheel, rad; `None` without a drag.
    drag_angle: Option<f32>,
    /// Remaining turn of the handwheel that is less than one detent, detents.
    detent_fraction: f32,
    mouse_position: Option<Pos2>,
}

impl PanelPointer {
    /// Handles the pointer events of one frame and returns their effects. `is_panel` returns
    /// whether a position belongs to the panel and is not covered.
    pub fn handle_events(
        &mut self,
        events: &[Event],
        placed: PlacedPanel<'_>,
        held: &mut HeldKeys<Key>,
        is_panel: &dyn Fn(Pos2) -> bool,
    ) -> PointerResult {
        let mut result = PointerResult::default();
        let is_touched = events
            .iter()
            .any(|event| matches!(event, Event::Touch { .. }));
        let by_finger = is_touched || !self.fingers.is_empty();
        for event in events {
            match event {
                Event::Touch {
                    device_id,
                    id,
                    phase,
                    pos,
                    ..
                } => {
                    let finger = (device_id.0, id.0);
                    self.handle_finger(finger, *phase, *pos, placed, held, is_panel, &mut result);
                }
                // A finger's events also arrive as mouse events: these are skipped.
                Event::PointerButton { .. } | Event::PointerMoved(_) | Event::PointerGone
                    if by_finger => {}
                Event::PointerButton {
                    pos,
                    button: PointerButton::Primary,
                    pressed,
                    ..
                } => {
                    self.mouse_position = Some(*pos);
                    let key = if *pressed && is_panel(*pos) {
                        key_at(*pos, placed)
                    } else {
                        None
                    };
                    result
                        .changes
                        .extend(set_key(KeyHolder::Pointer, key, held));
                    self.drag_angle = (*pressed && is_panel(*pos))
                        .then(|| wheel_angle(*pos, placed))
                        .flatten();
                }
                Event::PointerButton {
                    pos,
                    button: PointerButton::Secondary,
                    pressed: true,
                    ..
                } if is_panel(*pos) => latch(key_at(*pos, placed), held, &mut result),
                Event::PointerMoved(pos) => {
                    self.mouse_position = Some(*pos);
                    release_if_left(KeyHolder::Pointer, *pos, placed, held, &mut result);
                    self.drag_wheel_to(*pos, placed, &mut result);
                }
                Event::PointerGone => {
                    self.mouse_position = None;
                    self.drag_angle = None;
                    result.changes.extend(held.set(KeyHolder::Pointer, None));
                }
                Event::MouseWheel {
                    unit,
                    delta,
                    modifiers,
                    ..
                } if self
                    .mouse_position
                    .is_some_and(|at| is_panel(at) && wheel_angle(at, placed).is_some()) =>
                {
                    self.scroll_wheel(*unit, *delta, modifiers.shift, &mut result);
                }
                _ => {}
            }
        }
        result
    }

    /// Discards the pressed fingers and the drag of the handwheel.
    pub fn reset(&mut self) {
        self.fingers.clear();
        self.drag_angle = None;
    }

    #[allow(clippy::too_many_arguments)] // One event and everything that it can change.
    fn handle_finger(
        &mut self,
        finger: (u64, u64),
        phase: TouchPhase,
        position: Pos2,
        placed: PlacedPanel<'_>,
        held: &mut HeldKeys<Key>,
        is_panel: &dyn Fn(Pos2) -> bool,
        result: &mut PointerResult,
    ) {
        let holder = KeyHolder::Finger(finger.0, finger.1);
        match phase {
            TouchPhase::Start => {
                self.fingers.insert(finger);
                let key = if is_panel(position) {
                    key_at(position, placed)
                } else {
                    None
                };
                result.changes.extend(set_key(holder, key, held));
                // A browser first reports the finger as the mouse, in an earlier frame. The
                // finger takes over and the mouse releases its key.
                result.changes.extend(held.set(KeyHolder::Pointer, None));
                if key.is_none() && is_panel(position) {
                    self.drag_angle = wheel_angle(position, placed);
                }
            }
            TouchPhase::Move => {
                release_if_left(holder, position, placed, held, result);
                if held.key_of(holder).is_none() {
                    self.drag_wheel_to(position, placed, result);
                }
            }
            TouchPhase::End | TouchPhase::Cancel => {
                self.fingers.remove(&finger);
                self.drag_angle = None;
                result.changes.extend(held.set(holder, None));
            }
        }
    }

    fn drag_wheel_to(&mut self, at: Pos2, placed: PlacedPanel<'_>, result: &mut PointerResult) {
        let (Some(previous), Some(current)) = (self.drag_angle, angle_around_wheel(at, placed))
        else {
            return;
        };
        let half_turn = std::f32::consts::PI;
        let turned_angle = (current - previous + half_turn).rem_euclid(2.0 * half_turn) - half_turn;
        self.drag_angle = Some(current);
        self.turn_wheel(turned_angle / (2.0 * half_turn) * DETENTS_PER_TURN, result);
    }

    fn scroll_wheel(
        &mut self,
        unit: MouseWheelUnit,
        delta: Vec2,
        is_tenfold: bool,
        result: &mut PointerResult,
    ) {
        // Scrolling up or right turns the wheel clockwise.
        let amount = if delta.y == 0.0 { delta.x } else { delta.y };
        let amount = if is_tenfold { 10.0 * amount } else { amount };
        self.turn_wheel(
            match unit {
                MouseWheelUnit::Point => amount / POINTS_PER_DETENT,
                MouseWheelUnit::Line => amount,
                MouseWheelUnit::Page => amount * 10.0,
            },
            result,
        );
    }

    fn turn_wheel(&mut self, detents: f32, result: &mut PointerResult) {
        self.detent_fraction += detents.clamp(-DETENTS_PER_TURN, DETENTS_PER_TURN);
        let whole = self.detent_fraction.trunc();
        self.detent_fraction -= whole;
        result.detents += whole as i32;
    }
}

/// Latches a key for a right click until the next key is pressed, so that one mouse can press
/// two keys.
fn latch(key: Option<Key>, held: &mut HeldKeys<Key>, result: &mut PointerResult) {
    let latched = key.filter(|key| can_be_latched(*key));
    if latched != key {
        result.not_latched = key;
    }
    result.changes.extend(held.latch_key(latched));
}

/// Sets the key that a holder presses, and returns the changes; `None` releases its key.
fn set_key(
    holder: KeyHolder,
    key: Option<Key>,
    held: &mut HeldKeys<Key>,
) -> Vec<PanelKeyChange<Key>> {
    match key {
        Some(key) => held.press(holder, key),
        None => held.set(holder, None),
    }
}

/// Releases the key of a holder whose position `at` is outside the key. The key under the new
/// position is not pressed.
fn release_if_left(
    holder: KeyHolder,
    at: Pos2,
    placed: PlacedPanel<'_>,
    held: &mut HeldKeys<Key>,
    result: &mut PointerResult,
) {
    if let Some(key) = held.key_of(holder)
        && key_at(at, placed) != Some(key)
    {
        result.changes.extend(held.set(holder, None));
    }
}

fn key_at(at: Pos2, placed: PlacedPanel<'_>) -> Option<Key> {
    panel_placement::part_at(placed.areas, placed.model, at)?.key()
}

/// The angle of a position around the centre of the handwheel, rad; `None` outside the wheel.
fn wheel_angle(at: Pos2, placed: PlacedPanel<'_>) -> Option<f32> {
    let part = panel_placement::part_at(placed.areas, placed.model, at)?;
    if part.what != PartKind::Handwheel {
        return None;
    }
    angle_around_wheel(at, placed)
}

/// The angle of a position around the centre of the handwheel, rad, also outside the wheel;
/// `None` if the wheel is not visible.
fn angle_around_wheel(at: Pos2, placed: PlacedPanel<'_>) -> Option<f32> {
    let wheel = faceplate::parts(placed.model)
        .iter()
        .find(|part| part.what == PartKind::Handwheel)?;
    let area = panel_placement::area_of_part(placed.areas, wheel)?;
    let (cx, cy) = area.area.stretched_rect(wheel).center();
    let (x, y) = area.to_area(at);
    Some((y - cy).atan2(x - cx))
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Modifiers, TouchDeviceId, TouchId, pos2};

    const WHOLE_PANEL: PlacedPanel<'_> = PlacedPanel {
        areas: &[PlacedArea {
            area: faceplate::PanelArea::WHOLE,
            origin: Pos2::ZERO,
            scale: 1.0,
            pixels_per_point: 1.0,
        }],
        model: ModelId::Gsk980td,
    };

    fn position_of(key: Key) -> Pos2 {
        let (x, y) = faceplate::part_of(ModelId::Gsk980td, key)
            .expect("part")
            .rect
            .center();
        pos2(x, y)
    }

    fn left_button(pos: Pos2, pressed: bool) -> Event {
        let modifiers = Modifiers::default();
        Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers,
        }
    }

    fn touch(finger: u64, phase: TouchPhase, pos: Pos2) -> Event {
        let (device_id, id) = (TouchDeviceId(0), TouchId(finger));
        Event::Touch {
            device_id,
            id,
            phase,
            pos,
            force: None,
        }
    }

    fn keys(done: &PointerResult) -> Vec<(Key, bool)> {
        done.changes
            .iter()
            .map(|change| (change.key, change.is_down))
            .collect()
    }

    #[test]
    fn a_click_within_one_frame_is_a_press_and_a_release() {
        let (mut pointing, mut held) = (PanelPointer::default(), HeldKeys::default());
        let events = [
            left_button(position_of(Key::Auto), true),
            left_button(position_of(Key::Auto), false),
        ];
        let done = pointing.handle_events(&events, WHOLE_PANEL, &mut held, &|_| true);
        assert_eq!(keys(&done), [(Key::Auto, true), (Key::Auto, false)]);
    }

    #[test]
    fn sliding_off_a_key_releases_it_and_presses_no_other() {
        let (mut pointing, mut held) = (PanelPointer::default(), HeldKeys::default());
        pointing.handle_events(
            &[left_button(position_of(Key::ZLeft), true)],
            WHOLE_PANEL,
            &mut held,
            &|_| true,
        );
        let events = [
            Event::PointerMoved(position_of(Key::Rapid)),
            Event::PointerMoved(position_of(Key::ZLeft)),
        ];
        let done = pointing.handle_events(&events, WHOLE_PANEL, &mut held, &|_| true);
        assert_eq!(keys(&done), [(Key::ZLeft, false)]);
        assert!(!held.is_down(Key::ZLeft));
    }

    #[test]
    fn two_fingers_hold_two_keys_and_their_emulated_mouse_none() {
        let (mut pointing, mut held) = (PanelPointer::default(), HeldKeys::default());
        let events = [
            touch(1, TouchPhase::Start, position_of(Key::ZLeft)),
            Event::PointerMoved(position_of(Key::ZLeft)),
            left_button(position_of(Key::ZLeft), true),
            touch(2, TouchPhase::Start, position_of(Key::Rapid)),
        ];
        let done = pointing.handle_events(&events, WHOLE_PANEL, &mut held, &|_| true);
        assert_eq!(keys(&done), [(Key::ZLeft, true), (Key::Rapid, true)]);
        let events = [
            touch(1, TouchPhase::End, position_of(Key::ZLeft)),
            left_button(position_of(Key::ZLeft), false),
            Event::PointerGone,
        ];
        let done = pointing.handle_events(&events, WHOLE_PANEL, &mut held, &|_| true);
        assert_eq!(keys(&done), [(Key::ZLeft, false)]);
        assert!(held.is_down(Key::Rapid));
    }

    #[test]
    fn a_finger_that_a_browser_first_reports_as_the_mouse_releases_its_key() {
        let (mut pointing, mut held) = (PanelPointer::default(), HeldKeys::default());
        let key = position_of(Key::CycleStart);
        let frames = [
            vec![left_button(key, true)],
            vec![touch(1, TouchPhase::Start, key)],
            vec![left_button(key, false)],
            vec![touch(1, TouchPhase::End, key), Event::PointerGone],
        ];
        let done =
            frames.map(|events| pointing.handle_events(&events, WHOLE_PANEL, &mut held, &|_| true));
        let changes: Vec<_> = done.iter().flat_map(keys).collect();
        assert_eq!(changes, [(Key::CycleStart, true), (Key::CycleStart, false)]);
        assert!(keys(&done[3]).len() == 1 && !held.has_any());
    }

    fn right_button(key: Key) -> Event {
        Event::PointerButton {
            pos: position_of(key),
            button: PointerButton::Secondary,
            pressed: true,
            modifiers: Modifiers::default(),
        }
    }

    #[test]
    fn the_right_button_latches_a_key_for_the_next_one_only() {
        let (mut pointing, mut held) = (PanelPointer::default(), HeldKeys::default());
        let events = [
            right_button(Key::Cancel),
            left_button(position_of(Key::Reset), true),
            left_button(position_of(Key::Reset), false),
            left_button(position_of(Key::Reset), true),
        ];
        let done = pointing.handle_events(&events, WHOLE_PANEL, &mut held, &|_| true);
        let expected = [
            (Key::Cancel, true),
            (Key::Reset, true),
            (Key::Reset, false),
            (Key::Cancel, false),
            (Key::Reset, true),
        ];
        assert_eq!(keys(&done), expected);
    }

    #[test]
    fn overtravel_release_and_rapid_are_down_for_one_axis_key() {
        for latched in [Key::OvertravelRelease, Key::Rapid] {
            let (mut pointing, mut held) = (PanelPointer::default(), HeldKeys::default());
            let done =
                pointing.handle_events(&[right_button(latched)], WHOLE_PANEL, &mut held, &|_| true);
            assert_eq!(keys(&done), [], "nothing is held for nothing");
            assert_eq!(held.latched_key(), Some(latched));
            let position = position_of(Key::ZLeft);
            let done = pointing.handle_events(
                &[left_button(position, true)],
                WHOLE_PANEL,
                &mut held,
                &|_| true,
            );
            assert_eq!(keys(&done), [(latched, true), (Key::ZLeft, true)]);
            let move_away = [Event::PointerMoved(position_of(Key::ZRight))];
            let done = pointing.handle_events(&move_away, WHOLE_PANEL, &mut held, &|_| true);
            assert_eq!(keys(&done), [(Key::ZLeft, false), (latched, false)]);
        }
    }

    #[test]
    fn keys_that_start_motion_are_not_latched() {
        for key in [
            Key::ZLeft,
            Key::XUp,
            Key::CycleStart,
            Key::Lubrication,
            Key::EmergencyStop,
        ] {
            let (mut pointing, mut held) = (PanelPointer::default(), HeldKeys::default());
            let done =
                pointing.handle_events(&[right_button(key)], WHOLE_PANEL, &mut held, &|_| true);
            assert_eq!((keys(&done), done.not_latched), (vec![], Some(key)));
            assert_eq!(held.latched_key(), None);
        }
    }

    #[test]
    fn a_covered_panel_ignores_the_mouse() {
        let (mut pointing, mut held) = (PanelPointer::default(), HeldKeys::default());
        let done = pointing.handle_events(
            &[left_button(position_of(Key::Auto), true)],
            WHOLE_PANEL,
            &mut held,
            &|_| false,
        );
        assert_eq!(keys(&done), []);
    }

    #[test]
    fn a_quarter_turn_of_the_handwheel_is_25_detents() {
        let (mut pointing, mut held) = (PanelPointer::default(), HeldKeys::default());
        let wheel = faceplate::parts(ModelId::Gsk980td)
            .iter()
            .find(|part| part.what == PartKind::Handwheel)
            .expect("handwheel");
        let (x, y) = wheel.rect.center();
        let mut events = vec![left_button(pos2(x, y - 50.0), true)];
        events.extend((1..=90u8).map(|degree| {
            let angle = f32::from(degree).to_radians();
            Event::PointerMoved(pos2(x + 50.0 * angle.sin(), y - 50.0 * angle.cos()))
        }));
        let done = pointing.handle_events(&events, WHOLE_PANEL, &mut held, &|_| true);
        assert!((24..=25).contains(&done.detents), "{}", done.detents);
        assert_eq!(keys(&done), []);
    }
}
