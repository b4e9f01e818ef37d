//! Shows the keys that lead the tool back to the start point of the program after a RESET in the
//! cut. The operator presses them: the window moves nothing.

use gsk_core::operation::RunState;
use gsk_core::units::{Axis, Point};
use gsk_host::kernel::PanelSnapshot;
use gsk_messages::{Language, Message, say};
use gsk_panel::keys::{Key, STRIP};

use crate::widgets::key_label::key_label;

/// Distance in mm below which an axis needs no motion.
const TOLERANCE_MM: f64 = 0.05;

/// The return to the start point of the program, which the operator has requested. Order of its
/// keys: the head of the program (edit mode, RESET), program zero mode, the axis keys one after the
/// other, automatic mode.
#[derive(Clone, Copy, Debug)]
pub struct WayBack {
    /// Distance of the start point when the return was requested, mm, X as a radius.
    distance: Point,
    /// The axis that leads out of the part and goes first.
    first_axis: Axis,
    /// Whether the program must be reset to its head first.
    rewinds: bool,
    has_left_auto: bool,
}

impl WayBack {
    pub fn new(snapshot: &PanelSnapshot) -> Self {
        let start = snapshot.start_distance.as_ref();
        Self {
            distance: start.map_or_else(Point::default, |start| start.distance),
            first_axis: start.map_or(Axis::X, |start| start.first_axis),
            rewinds: snapshot.resumes_at.is_some(),
            has_left_auto: false,
        }
    }

    /// Follows the control. Returns `None` once the operator is back in automatic mode, or has
    /// started the program where it is.
    pub fn follow(self, snapshot: &PanelSnapshot) -> Option<Self> {
        let is_auto = is_lit(Key::Auto, snapshot);
        let is_rewinding = is_lit(Key::Edit, snapshot) && snapshot.pressed.contains(&Key::Reset);
        let is_started = is_auto && snapshot.run_state == RunState::Run;
        let is_back = is_auto && self.has_left_auto;
        (!is_back && !is_started).then_some(Self {
            has_left_auto: self.has_left_auto || !is_auto,
            rewinds: self.rewinds && !is_rewinding,
            ..self
        })
    }

    /// The sentence about the key that the operator must press now; `None` if there is none.
    pub fn step_text(self, snapshot: &PanelSnapshot, language: Language) -> Option<Message> {
        let key = self.keys(snapshot).first().copied()?;
        let zero = match key {
            Key::XUp | Key::XDown => "XZERO",
            Key::ZLeft | Key::ZRight => "ZZERO",
            _ => return Some(say::window_way_back_press(key_label(key, language))),
        };
        let lamp = STRIP.iter().find(|lamp| lamp.id == zero)?;
        let key = key_label(key, language);
        Some(say::window_way_back_hold(key, lamp.label))
    }

    /// Returns the panel keys that the operator must press now.
    pub fn keys(self, snapshot: &PanelSnapshot) -> Vec<Key> {
        if self.rewinds {
            return vec![match is_lit(Key::Edit, snapshot) {
                true => Key::Reset,
                false => Key::Edit,
            }];
        }
        if !is_lit(Key::ProgramZero, snapshot) {
            return vec![
                match self.has_left_auto && is_at_start(self.distance, snapshot) {
                    true => Key::Auto,
                    false => Key::ProgramZero,
                },
            ];
        }
        let reversed = snapshot.keys_reversed;
        let x_key = match (self.distance.x > 0.0) == reversed.x {
            true => Key::XUp,
            false => Key::XDown,
        };
        let z_key = match (self.distance.z > 0.0) == reversed.z {
            true => Key::ZLeft,
            false => Key::ZRight,
        };
        let mut axes = [
            (self.distance.x, "XZERO", x_key),
            (self.distance.z, "ZZERO", z_key),
        ];
        if self.first_axis == Axis::Z {
            axes.reverse();
        }
        let mut missing = axes
            .into_iter()
            .filter(|(distance, zero, _)| needs_motion(*distance, zero, snapshot));
        vec![missing.next().map_or(Key::Auto, |(_, _, key)| key)]
    }
}

/// Whether the lamp of a key is lit.
pub fn is_lit(key: Key, snapshot: &PanelSnapshot) -> bool {
    let lamp = key.row().lamp;
    lamp.is_some_and(|lamp| lamp.is_set_in(&snapshot.y_memory))
}

/// Whether an axis must still move: its lamp `zero` shows that it has arrived.
fn needs_motion(distance: f64, zero: &str, snapshot: &PanelSnapshot) -> bool {
    let lamp = STRIP.iter().find(|lamp| lamp.id == zero);
    let is_at_zero = lamp.is_some_and(|it| it.lamp.is_set_in(&snapshot.y_memory));
    distance.abs() > TOLERANCE_MM && !is_at_zero
}

fn is_at_start(distance: Point, snapshot: &PanelSnapshot) -> bool {
    !needs_motion(distance.x, "XZERO", snapshot) && !needs_motion(distance.z, "ZZERO", snapshot)
}
