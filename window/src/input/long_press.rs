//! Opens help for a finger that stays in one position, as F1 does for the mouse.

use egui::{Event, Pos2, TouchPhase};

/// Time for which a finger must stay on the screen, s.
const HOLD_TIME_S: f64 = 0.8;
/// Maximum movement of the finger during a long press, points.
const MAX_MOVEMENT: f32 = 12.0;

/// The position and time of the only finger on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Finger {
    id: (u64, u64),
    position: Pos2,
    since_s: f64,
}

/// Detects that a single finger stays on the screen without moving.
#[derive(Clone, Debug, Default)]
pub struct LongPress {
    finger: Option<Finger>,
    /// Number of fingers that are down. Two at once are a combination of keys.
    fingers_down: usize,
}

impl LongPress {
    /// Handles the events of one frame, `now_s` in seconds. Returns the position of a finger
    /// that has stayed long enough, once per press.
    pub fn handle_events(&mut self, events: &[Event], now_s: f64) -> Option<Pos2> {
        for event in events {
            let Event::Touch {
                device_id,
                id,
                phase,
                pos,
                ..
            } = event
            else {
                continue;
            };
            let id = (device_id.0, id.0);
            match phase {
                TouchPhase::Start => {
                    self.fingers_down += 1;
                    let finger = Finger {
                        id,
                        position: *pos,
                        since_s: now_s,
                    };
                    self.finger = (self.fingers_down == 1).then_some(finger);
                }
                TouchPhase::Move => {
                    let has_moved =
                        |it: &mut Finger| it.id == id && it.position.distance(*pos) > MAX_MOVEMENT;
                    self.finger.take_if(has_moved);
                }
                TouchPhase::End | TouchPhase::Cancel => {
                    self.fingers_down = self.fingers_down.saturating_sub(1);
                    self.finger = None;
                }
            }
        }
        let long_pressed = self.finger.take_if(|it| now_s - it.since_s >= HOLD_TIME_S);
        long_pressed.map(|finger| finger.position)
    }

    /// Whether a finger is down that may become a long press, so that the window must draw
    /// frames.
    pub const fn is_waiting(&self) -> bool {
        self.finger.is_some()
    }

    /// Forgets all fingers, because the window has lost the focus.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{TouchDeviceId, TouchId, pos2};

    fn touch(finger: u64, phase: TouchPhase, x: f32) -> Event {
        Event::Touch {
            device_id: TouchDeviceId(0),
            id: TouchId(finger),
            phase,
            pos: pos2(x, 0.0),
            force: None,
        }
    }

    #[test]
    fn only_a_single_resting_finger_is_a_long_press_and_only_once() {
        let mut press = LongPress::default();
        assert_eq!(
            press.handle_events(&[touch(1, TouchPhase::Start, 5.0)], 0.0),
            None
        );
        assert_eq!(
            press.handle_events(&[touch(1, TouchPhase::Move, 7.0)], 0.5),
            None
        );
        assert_eq!(press.handle_events(&[], 0.9), Some(pos2(5.0, 0.0)));
        assert_eq!(press.handle_events(&[], 2.0), None);
        press.handle_events(&[touch(1, TouchPhase::End, 7.0)], 2.1);
        press.handle_events(&[touch(1, TouchPhase::Start, 5.0)], 3.0);
        press.handle_events(&[touch(1, TouchPhase::Move, 40.0)], 3.1);
        assert_eq!(
            press.handle_events(&[], 4.0),
            None,
            "it has turned the wheel"
        );
        press.handle_events(&[touch(1, TouchPhase::End, 40.0)], 4.0);
        press.handle_events(&[touch(1, TouchPhase::Start, 5.0)], 5.0);
        press.handle_events(&[touch(2, TouchPhase::Start, 90.0)], 5.2);
        assert_eq!(press.handle_events(&[], 7.0), None, "two keys at once");
    }
}
