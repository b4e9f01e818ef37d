//! The sound of the machine (WINDOW-24): the window sends states of the machine to a
//! thread, which mixes the due samples and passes them to the system's player.

mod mixer;

use crossbeam::channel::{Receiver, RecvTimeoutError, Sender, bounded};
use gsk_messages::Message;
use web_time::{Duration, Instant};

use crate::platform::{self, Player};
pub use mixer::{Heard, OUTPUTS};
use mixer::{Mixer, RATE};

/// Volumes to choose from, %.
pub const VOLUMES: [u8; 4] = [10, 25, 50, 100];
/// How far ahead of their time samples go to the player.
const LEAD: Duration = Duration::from_millis(60);
/// Time between two turns of the thread.
const TURN: Duration = Duration::from_millis(10);
/// Sound that is later than this is dropped: the computer was asleep.
const LOST: Duration = Duration::from_millis(500);
/// Capacity of the queue to the thread.
const QUEUE: usize = 64;

/// A command for the thread.
enum Order {
    Hear(Heard),
    Volume(u8),
}

/// The window's end of the thread's channels.
struct Line {
    orders: Sender<Order>,
    failed: Receiver<Message>,
}

/// The sound of the machine; without a volume it needs no thread and no player.
#[derive(Default)]
pub struct Sounds {
    volume: Option<u8>,
    line: Option<Line>,
}

impl Sounds {
    /// Switches the sound on, off, or to another volume, %. Returns once the message of a
    /// failed player.
    pub fn follow(&mut self, volume: Option<u8>) -> Option<Message> {
        if self.volume != volume {
            self.volume = volume;
            match (&self.line, volume) {
                (_, None) => self.line = None,
                (Some(line), Some(volume)) => {
                    let _ = line.orders.try_send(Order::Volume(volume));
                }
                (None, Some(volume)) => self.line = begin(volume),
            }
        }
        let failed = self.line.as_ref()?.failed.try_recv().ok()?;
        self.line = None;
        Some(failed)
    }

    /// Whether the sound is on.
    pub const fn listens(&self) -> bool {
        self.line.is_some()
    }

    /// Sends the current state of the machine.
    pub fn hear(&self, heard: Heard) {
        if let Some(line) = &self.line {
            // A player that hangs must not hold up the window.
            let _ = line.orders.try_send(Order::Hear(heard));
        }
    }
}

fn begin(volume: u8) -> Option<Line> {
    let (orders, from_window) = bounded(QUEUE);
    let (say, failed) = bounded(1);
    let mut player = None;
    let mut mixer = Mixer::default();
    let mut volume = volume;
    let mut clock = Clock::new();
    let turn = move || {
        match platform::receive(&from_window, Some(Instant::now() + TURN)) {
            Ok(Order::Hear(heard)) => mixer.hear(&heard),
            Ok(Order::Volume(changed)) => volume = changed,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return false,
        }
        let mut samples = vec![0; clock.due(Instant::now())];
        mixer.fill(&mut samples, volume);
        let played = match &mut player {
            Some(player) => Player::play(player, &samples),
            None => Player::open(RATE).map(|opened| {
                player = Some(opened);
                clock = Clock::new();
            }),
        };
        if let Err(why) = played {
            let _ = say.try_send(why);
            return false;
        }
        true
    };
    platform::turn("sound", turn).ok()?;
    Some(Line { orders, failed })
}

/// Counts the samples that are due.
struct Clock {
    begin: Instant,
    handed: usize,
}

impl Clock {
    fn new() -> Self {
        Self {
            begin: Instant::now(),
            handed: 0,
        }
    }

    fn due(&mut self, now: Instant) -> usize {
        let until = now.saturating_duration_since(self.begin) + LEAD;
        let all = (until.as_secs_f64() * f64::from(RATE)) as usize;
        let due = all.saturating_sub(self.handed);
        self.handed = all.max(self.handed);
        match due as f64 > LOST.as_secs_f64() * f64::from(RATE) {
            true => 0,
            false => due,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_handed_over_as_time_passes_and_none_for_a_sleep() {
        let mut clock = Clock::new();
        let begin = clock.begin;
        let at = |ms: u64| begin + Duration::from_millis(ms);
        let lead = clock.due(at(0));
        assert_eq!(lead, 1323);
        let second: usize = (1..=100).map(|turn| clock.due(at(turn * 10))).sum();
        assert_eq!(second, RATE as usize);
        assert_eq!(clock.due(at(500)), 0, "a clock that goes back");
        assert_eq!(clock.due(at(60_000)), 0, "asleep");
        assert_eq!(clock.due(at(60_100)), 2205);
    }
}
