//! Opens help for a finger that stays in one position, as F1 does for the mouse.

use egui::{Event, Pos2, TouchPhase};

/// Time for which the finger must stay, s.
const LONG: f64 = 0.8;
/// Greatest movement during this time, points.
const SLIP: f32 = 12.0;

/// The only finger on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Finger {
    id: (u64, u64),
    at: Pos2,
    since: f64,
}

/// Detects a long press.
#[derive(Clone, Debug, Default)]
pub struct LongPress {
    finger: Option<Finger>,
    /// Count of fingers that are down. Two at once are a combination of keys.
    down: usize,
}

impl LongPress {
    /// Handles the events of one frame, `now` in seconds. Returns the position of a finger
    /// that has stayed long enough, once per press.
    pub fn follow(&mut self, events: &[Event], now: f64) -> Option<Pos2> {
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
                    self.down += 1;
                    let finger = Finger {
                        id,
                        at: *pos,
                        since: now,
                    };
                    self.finger = (self.down == 1).then_some(finger);
                }
                TouchPhase::Move => {
                    let slipped = |it: &mut Finger| it.id == id && it.at.distance(*pos) > SLIP;
                    self.finger.take_if(slipped);
                }
                TouchPhase::End | TouchPhase::Cancel => {
                    self.down = self.down.saturating_sub(1);
                    self.finger = None;
                }
            }
        }
        let stayed = self.finger.take_if(|it| now - it.since >= LONG);
        stayed.map(|finger| finger.at)
    }

    /// Whether a finger is down that may become a long press: the window must draw frames
    /// until then.
    pub const fn watches(&self) -> bool {
        self.finger.is_some()
    }

    /// Drops all fingers: the window has lost the focus.
    pub fn forget(&mut self) {
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
    fn only_one_finger_that_stays_asks_and_it_asks_once() {
        let mut press = LongPress::default();
        assert_eq!(press.follow(&[touch(1, TouchPhase::Start, 5.0)], 0.0), None);
        assert_eq!(press.follow(&[touch(1, TouchPhase::Move, 7.0)], 0.5), None);
        assert_eq!(press.follow(&[], 0.9), Some(pos2(5.0, 0.0)));
        assert_eq!(press.follow(&[], 2.0), None);
        press.follow(&[touch(1, TouchPhase::End, 7.0)], 2.1);
        press.follow(&[touch(1, TouchPhase::Start, 5.0)], 3.0);
        press.follow(&[touch(1, TouchPhase::Move, 40.0)], 3.1);
        assert_eq!(press.follow(&[], 4.0), None, "it has turned the wheel");
        press.follow(&[touch(1, TouchPhase::End, 40.0)], 4.0);
        press.follow(&[touch(1, TouchPhase::Start, 5.0)], 5.0);
        press.follow(&[touch(2, TouchPhase::Start, 90.0)], 5.2);
        assert_eq!(press.follow(&[], 7.0), None, "two keys at once");
    }
}
