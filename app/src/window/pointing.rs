//! Handles mouse and fingers on the panel: the keys that they hold, and the handwheel.

use std::collections::BTreeSet;

use egui::{Event, MouseWheelUnit, PointerButton, Pos2, TouchPhase, Vec2};
use gsk_panel::faceplate::{self, PartKind};
use gsk_panel::keys::Key;

use super::held::{Change, Held, Holder, may_be_kept};
use super::placing::{self, View};

/// Points of scrolling per detent of the handwheel.
const POINTS_A_DETENT: f32 = 24.0;
/// Detents per turn of the handwheel.
const DETENTS: f32 = 100.0;

/// The result of the events of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Done {
    /// Keys that went down or came up, in order.
    pub changes: Vec<Change<Key>>,
    /// Turn of the handwheel, detents, clockwise positive.
    pub detents: i32,
    /// A key that was right-clicked and cannot be latched.
    pub not_kept: Option<Key>,
}

/// The state of mouse and fingers between frames.
#[derive(Clone, Debug, Default)]
pub struct Pointing {
    fingers: BTreeSet<(u64, u64)>,
    /// Angle of the pointer that drags the handwheel, rad.
    drag: Option<f32>,
    /// Turn of less than one detent that is left over, detents.
    rest: f32,
    last: Option<Pos2>,
}

impl Pointing {
    /// Handles the events of one frame. `free` reports whether a position belongs to the panel
    /// and is not covered.
    pub fn follow(
        &mut self,
        events: &[Event],
        views: &[View],
        held: &mut Held<Key>,
        free: &dyn Fn(Pos2) -> bool,
    ) -> Done {
        let mut done = Done::default();
        let touched = events
            .iter()
            .any(|event| matches!(event, Event::Touch { .. }));
        let by_finger = touched || !self.fingers.is_empty();
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
                    self.finger(finger, *phase, *pos, views, held, free, &mut done);
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
                    self.last = Some(*pos);
                    let key = if *pressed && free(*pos) {
                        key_at(*pos, views)
                    } else {
                        None
                    };
                    done.changes.extend(hold(Holder::Pointer, key, held));
                    self.drag = (*pressed && free(*pos))
                        .then(|| wheel_angle(*pos, views))
                        .flatten();
                }
                Event::PointerButton {
                    pos,
                    button: PointerButton::Secondary,
                    pressed: true,
                    ..
                } if free(*pos) => keep(key_at(*pos, views), held, &mut done),
                Event::PointerMoved(pos) => {
                    self.last = Some(*pos);
                    slide(Holder::Pointer, *pos, views, held, &mut done);
                    self.turn_to(*pos, views, &mut done);
                }
                Event::PointerGone => {
                    self.last = None;
                    self.drag = None;
                    done.changes.extend(held.set(Holder::Pointer, None));
                }
                Event::MouseWheel { unit, delta, .. }
                    if self
                        .last
                        .is_some_and(|at| free(at) && wheel_angle(at, views).is_some()) =>
                {
                    self.scroll(*unit, *delta, &mut done);
                }
                _ => {}
            }
        }
        done
    }

    /// Drops the fingers and the drag of the handwheel.
    pub fn forget(&mut self) {
        self.fingers.clear();
        self.drag = None;
    }

    #[allow(clippy::too_many_arguments)] // One event and everything that it can change.
    fn finger(
        &mut self,
        finger: (u64, u64),
        phase: TouchPhase,
        at: Pos2,
        views: &[View],
        held: &mut Held<Key>,
        free: &dyn Fn(Pos2) -> bool,
        done: &mut Done,
    ) {
        let holder = Holder::Finger(finger.0, finger.1);
        match phase {
            TouchPhase::Start => {
                self.fingers.insert(finger);
                let key = if free(at) { key_at(at, views) } else { None };
                done.changes.extend(hold(holder, key, held));
                // A browser first reports the finger as the mouse, in an earlier frame. The
                // finger takes over and the mouse releases its key.
                done.changes.extend(held.set(Holder::Pointer, None));
                if key.is_none() && free(at) {
                    self.drag = wheel_angle(at, views);
                }
            }
            TouchPhase::Move => {
                slide(holder, at, views, held, done);
                if held.of(holder).is_none() {
                    self.turn_to(at, views, done);
                }
            }
            TouchPhase::End | TouchPhase::Cancel => {
                self.fingers.remove(&finger);
                self.drag = None;
                done.changes.extend(held.set(holder, None));
            }
        }
    }

    fn turn_to(&mut self, at: Pos2, views: &[View], done: &mut Done) {
        let (Some(before), Some(now)) = (self.drag, angle(at, views)) else {
            return;
        };
        let half = std::f32::consts::PI;
        let way = (now - before + half).rem_euclid(2.0 * half) - half;
        self.drag = Some(now);
        self.turn_by(way / (2.0 * half) * DETENTS, done);
    }

    fn scroll(&mut self, unit: MouseWheelUnit, delta: Vec2, done: &mut Done) {
        // Scrolling up or right turns the wheel clockwise.
        let amount = if delta.y == 0.0 { delta.x } else { delta.y };
        self.turn_by(
            match unit {
                MouseWheelUnit::Point => amount / POINTS_A_DETENT,
                MouseWheelUnit::Line => amount,
                MouseWheelUnit::Page => amount * 10.0,
            },
            done,
        );
    }

    fn turn_by(&mut self, detents: f32, done: &mut Done) {
        self.rest += detents.clamp(-DETENTS, DETENTS);
        let whole = self.rest.trunc();
        self.rest -= whole;
        done.detents += whole as i32;
    }
}

/// Latches a key for the next one, for a right click: one mouse can press two keys.
fn keep(key: Option<Key>, held: &mut Held<Key>, done: &mut Done) {
    let kept = key.filter(|key| may_be_kept(*key));
    if kept != key {
        done.not_kept = key;
    }
    done.changes.extend(held.keep(kept));
}

/// Sets the key that a holder presses; `None` releases it.
fn hold(holder: Holder, key: Option<Key>, held: &mut Held<Key>) -> Vec<Change<Key>> {
    match key {
        Some(key) => held.press(holder, key),
        None => held.set(holder, None),
    }
}

/// Releases the key of a holder that has left it. The key under the new position is not
/// pressed.
fn slide(holder: Holder, at: Pos2, views: &[View], held: &mut Held<Key>, done: &mut Done) {
    if let Some(key) = held.of(holder)
        && key_at(at, views) != Some(key)
    {
        done.changes.extend(held.set(holder, None));
    }
}

fn key_at(at: Pos2, views: &[View]) -> Option<Key> {
    let (x, y) = placing::units(views, at)?;
    faceplate::part_at(x, y)?.key()
}

/// The angle of a position around the centre of the handwheel, rad; `None` outside the wheel.
fn wheel_angle(at: Pos2, views: &[View]) -> Option<f32> {
    let (x, y) = placing::units(views, at)?;
    let part = faceplate::part_at(x, y)?;
    if part.what != PartKind::Handwheel {
        return None;
    }
    angle(at, views)
}

/// The same angle for any position, also outside the wheel.
fn angle(at: Pos2, views: &[View]) -> Option<f32> {
    let wheel = faceplate::parts()
        .iter()
        .find(|part| part.what == PartKind::Handwheel)?;
    let (cx, cy) = wheel.rect.center();
    let (x, y) = placing::of_part(views, wheel)?.units(at);
    Some((y - cy).atan2(x - cx))
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Modifiers, TouchDeviceId, TouchId, pos2};

    const VIEW: &[View] = &[View {
        area: faceplate::PanelArea::WHOLE,
        origin: Pos2::ZERO,
        scale: 1.0,
        pixels_per_point: 1.0,
    }];

    fn at(key: Key) -> Pos2 {
        let (x, y) = faceplate::part_of(key).expect("part").rect.center();
        pos2(x, y)
    }

    fn button(pos: Pos2, pressed: bool) -> Event {
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

    fn keys(done: &Done) -> Vec<(Key, bool)> {
        done.changes
            .iter()
            .map(|change| (change.key, change.down))
            .collect()
    }

    #[test]
    fn a_click_within_one_picture_is_a_press_and_a_release() {
        let (mut pointing, mut held) = (Pointing::default(), Held::default());
        let events = [button(at(Key::Auto), true), button(at(Key::Auto), false)];
        let done = pointing.follow(&events, VIEW, &mut held, &|_| true);
        assert_eq!(keys(&done), [(Key::Auto, true), (Key::Auto, false)]);
    }

    #[test]
    fn sliding_off_lets_go_and_presses_nothing_else() {
        let (mut pointing, mut held) = (Pointing::default(), Held::default());
        pointing.follow(&[button(at(Key::ZLeft), true)], VIEW, &mut held, &|_| true);
        let events = [
            Event::PointerMoved(at(Key::Rapid)),
            Event::PointerMoved(at(Key::ZLeft)),
        ];
        let done = pointing.follow(&events, VIEW, &mut held, &|_| true);
        assert_eq!(keys(&done), [(Key::ZLeft, false)]);
        assert!(!held.is_down(Key::ZLeft));
    }

    #[test]
    fn two_fingers_hold_two_keys_and_the_mouse_they_emulate_holds_none() {
        let (mut pointing, mut held) = (Pointing::default(), Held::default());
        let events = [
            touch(1, TouchPhase::Start, at(Key::ZLeft)),
            Event::PointerMoved(at(Key::ZLeft)),
            button(at(Key::ZLeft), true),
            touch(2, TouchPhase::Start, at(Key::Rapid)),
        ];
        let done = pointing.follow(&events, VIEW, &mut held, &|_| true);
        assert_eq!(keys(&done), [(Key::ZLeft, true), (Key::Rapid, true)]);
        let events = [
            touch(1, TouchPhase::End, at(Key::ZLeft)),
            button(at(Key::ZLeft), false),
            Event::PointerGone,
        ];
        let done = pointing.follow(&events, VIEW, &mut held, &|_| true);
        assert_eq!(keys(&done), [(Key::ZLeft, false)]);
        assert!(held.is_down(Key::Rapid));
    }

    #[test]
    fn a_finger_that_a_browser_says_as_the_mouse_first_lets_go() {
        let (mut pointing, mut held) = (Pointing::default(), Held::default());
        let key = at(Key::CycleStart);
        let pictures = [
            vec![button(key, true)],
            vec![touch(1, TouchPhase::Start, key)],
            vec![button(key, false)],
            vec![touch(1, TouchPhase::End, key), Event::PointerGone],
        ];
        let done = pictures.map(|events| pointing.follow(&events, VIEW, &mut held, &|_| true));
        let changes: Vec<_> = done.iter().flat_map(keys).collect();
        assert_eq!(changes, [(Key::CycleStart, true), (Key::CycleStart, false)]);
        assert!(keys(&done[3]).len() == 1 && !held.any());
    }

    fn right(key: Key) -> Event {
        Event::PointerButton {
            pos: at(key),
            button: PointerButton::Secondary,
            pressed: true,
            modifiers: Modifiers::default(),
        }
    }

    #[test]
    fn the_right_button_keeps_a_key_for_the_next_one_and_no_longer() {
        let (mut pointing, mut held) = (Pointing::default(), Held::default());
        let events = [
            right(Key::Cancel),
            button(at(Key::Reset), true),
            button(at(Key::Reset), false),
            button(at(Key::Reset), true),
        ];
        let done = pointing.follow(&events, VIEW, &mut held, &|_| true);
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
        for kept in [Key::OvertravelRelease, Key::Rapid] {
            let (mut pointing, mut held) = (Pointing::default(), Held::default());
            let done = pointing.follow(&[right(kept)], VIEW, &mut held, &|_| true);
            assert_eq!(keys(&done), [], "nothing is held for nothing");
            assert_eq!(held.kept(), Some(kept));
            let place = at(Key::ZLeft);
            let done = pointing.follow(&[button(place, true)], VIEW, &mut held, &|_| true);
            assert_eq!(keys(&done), [(kept, true), (Key::ZLeft, true)]);
            let away = [Event::PointerMoved(at(Key::ZRight))];
            let done = pointing.follow(&away, VIEW, &mut held, &|_| true);
            assert_eq!(keys(&done), [(Key::ZLeft, false), (kept, false)]);
        }
    }

    #[test]
    fn what_moves_by_itself_is_not_kept() {
        for key in [
            Key::ZLeft,
            Key::XUp,
            Key::CycleStart,
            Key::Lubrication,
            Key::EmergencyStop,
        ] {
            let (mut pointing, mut held) = (Pointing::default(), Held::default());
            let done = pointing.follow(&[right(key)], VIEW, &mut held, &|_| true);
            assert_eq!((keys(&done), done.not_kept), (vec![], Some(key)));
            assert_eq!(held.kept(), None);
        }
    }

    #[test]
    fn what_lies_over_the_panel_keeps_it_from_the_mouse() {
        let (mut pointing, mut held) = (Pointing::default(), Held::default());
        let done = pointing.follow(&[button(at(Key::Auto), true)], VIEW, &mut held, &|_| false);
        assert_eq!(keys(&done), []);
    }

    #[test]
    fn a_quarter_turn_of_the_handwheel_is_25_detents() {
        let (mut pointing, mut held) = (Pointing::default(), Held::default());
        let wheel = faceplate::parts()
            .iter()
            .find(|part| part.what == PartKind::Handwheel)
            .expect("handwheel");
        let (x, y) = wheel.rect.center();
        let mut events = vec![button(pos2(x, y - 50.0), true)];
        events.extend((1..=90u8).map(|degree| {
            let angle = f32::from(degree).to_radians();
            Event::PointerMoved(pos2(x + 50.0 * angle.sin(), y - 50.0 * angle.cos()))
        }));
        let done = pointing.follow(&events, VIEW, &mut held, &|_| true);
        assert!((24..=25).contains(&done.detents), "{}", done.detents);
        assert_eq!(keys(&done), []);
    }
}
