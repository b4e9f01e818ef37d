//! Writes a live session down as a script that replays it tick by tick.

use core::fmt::Write as _;

use crate::emulator::{Emulator, PRESS_TICKS};
use crate::keys::Key;
use crate::pages::POWER_ON_TICKS;
use crate::panel::{KeyEvent, is_typable};

/// Something that happened to the emulator from outside.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Recorded {
    /// A key event.
    Key(KeyEvent),
    /// Any other action, as a script writes it: `power off`, `load part.CNC`.
    Action(String),
}

/// A session being recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recorder {
    /// The clock at tick 0 of the script.
    origin: u64,
    events: Vec<(u64, Recorded)>,
    held: Vec<Key>,
}

impl Recorder {
    /// Begins to record. During the self-test picture tick 0 is its end, where
    /// a script starts too.
    pub const fn new(emulator: &Emulator) -> Self {
        let now = emulator.ticks();
        let origin = if emulator.panel.in_self_test() && now < POWER_ON_TICKS {
            POWER_ON_TICKS
        } else {
            now
        };
        Self {
            origin,
            events: Vec::new(),
            held: Vec::new(),
        }
    }

    /// Takes down a key event, before the emulator is given it. What comes
    /// during the first self-test picture is left out.
    pub fn key(&mut self, emulator: &Emulator, event: KeyEvent) {
        match event {
            KeyEvent::Down(key) if self.held.contains(&key) => return,
            KeyEvent::Down(key) => self.held.push(key),
            KeyEvent::Up(key) => self.held.retain(|held| *held != key),
            KeyEvent::ReleaseAll => {
                for key in core::mem::take(&mut self.held) {
                    self.add(emulator, Recorded::Key(KeyEvent::Up(key)));
                }
                return;
            }
            KeyEvent::Type(character) if !is_typable(character) => return,
            KeyEvent::Type(_) | KeyEvent::Wheel(_) => {}
        }
        self.add(emulator, Recorded::Key(event));
    }

    /// Takes down another action, in the words of a script.
    pub fn action(&mut self, emulator: &Emulator, action: impl Into<String>) {
        self.add(emulator, Recorded::Action(action.into()));
    }

    fn add(&mut self, emulator: &Emulator, what: Recorded) {
        if let Some(tick) = emulator.ticks().checked_sub(self.origin) {
            self.events.push((tick, what));
        }
    }

    /// What was taken down: ticks of the script, and what happened.
    pub fn events(&self) -> &[(u64, Recorded)] {
        &self.events
    }

    /// The script.
    pub fn script(&self) -> String {
        let mut text = String::new();
        let mut events = self.events.iter().peekable();
        while let Some((tick, what)) = events.next() {
            let action = match what {
                Recorded::Action(action) => action.clone(),
                Recorded::Key(KeyEvent::Down(key)) => {
                    let up = Recorded::Key(KeyEvent::Up(*key));
                    match events.next_if(|(_, next)| *next == up) {
                        Some((end, _)) if end - tick == PRESS_TICKS => {
                            format!("press {}", key.id())
                        }
                        Some((end, _)) => format!("hold {} {}ms", key.id(), end - tick),
                        None => format!("down {}", key.id()),
                    }
                }
                Recorded::Key(KeyEvent::Up(key)) => format!("up {}", key.id()),
                Recorded::Key(KeyEvent::Type(character)) => format!("type \"{character}\""),
                Recorded::Key(KeyEvent::Wheel(graduations)) => format!("turn {graduations}"),
                Recorded::Key(KeyEvent::ReleaseAll) => continue,
            };
            let _ = writeln!(text, "@{tick} {action}");
        }
        text
    }
}
