//! The sound of the machine (WINDOW-24): the window sends states of the machine to a
//! thread, which mixes the due samples and passes them to the system's player.

mod mixer;

use crossbeam::channel::{Receiver, RecvTimeoutError, Sender, bounded};
use gsk_messages::Message;
use web_time::{Duration, Instant};

use crate::platform::{self, Player};
use mixer::{Mixer, RATE};
pub use mixer::{OUTPUTS, SoundState};

/// Volumes that the operator can select, %.
pub const VOLUMES: [u8; 4] = [10, 25, 50, 100];
/// Time by which samples are passed to the player before they are due.
const LEAD_TIME: Duration = Duration::from_millis(60);
/// Time between two runs of the sound thread.
const TURN_INTERVAL: Duration = Duration::from_millis(10);
/// Sound that is later than this is dropped, because the computer was asleep.
const MAX_DELAY: Duration = Duration::from_millis(500);
/// Capacity of the command queue to the sound thread.
const QUEUE_CAPACITY: usize = 64;

/// A command to the sound thread.
enum SoundCommand {
    State(SoundState),
    Volume(u8),
}

/// The window's ends of the channels to the sound thread.
struct SoundChannels {
    commands: Sender<SoundCommand>,
    failures: Receiver<Message>,
}

/// Plays the sound of the machine; has no thread and no player while it is off.
#[derive(Default)]
pub struct MachineSound {
    volume: Option<u8>,
    channels: Option<SoundChannels>,
}

impl MachineSound {
    /// Sets the volume, %; `None` switches the sound off. Returns the message of a player that
    /// has failed, once.
    pub fn set_volume(&mut self, volume: Option<u8>) -> Option<Message> {
        if self.volume != volume {
            self.volume = volume;
            match (&self.channels, volume) {
                (_, None) => self.channels = None,
                (Some(line), Some(volume)) => {
                    let _ = line.commands.try_send(SoundCommand::Volume(volume));
                }
                (None, Some(volume)) => self.channels = start_thread(volume),
            }
        }
        let failed = self.channels.as_ref()?.failures.try_recv().ok()?;
        self.channels = None;
        Some(failed)
    }

    /// Whether the sound is on.
    pub const fn is_on(&self) -> bool {
        self.channels.is_some()
    }

    /// Sends the state of the machine whose sound is to be played.
    pub fn send_state(&self, state: SoundState) {
        if let Some(line) = &self.channels {
            // A player that hangs must not hold up the window.
            let _ = line.commands.try_send(SoundCommand::State(state));
        }
    }
}

fn start_thread(volume: u8) -> Option<SoundChannels> {
    let (orders, from_window) = bounded(QUEUE_CAPACITY);
    let (say, failed) = bounded(1);
    let mut player = None;
    let mut mixer = Mixer::default();
    let mut volume = volume;
    let mut clock = SampleClock::new();
    let turn = move || {
        match platform::receive(&from_window, Some(Instant::now() + TURN_INTERVAL)) {
            Ok(SoundCommand::State(state)) => mixer.update(&state),
            Ok(SoundCommand::Volume(changed)) => volume = changed,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return false,
        }
        let mut samples = vec![0; clock.due(Instant::now())];
        mixer.fill(&mut samples, volume);
        let played = match &mut player {
            Some(player) => Player::play(player, &samples),
            None => Player::open(RATE).map(|opened| {
                player = Some(opened);
                clock = SampleClock::new();
            }),
        };
        if let Err(why) = played {
            let _ = say.try_send(why);
            return false;
        }
        true
    };
    platform::start_task("sound", turn).ok()?;
    Some(SoundChannels {
        commands: orders,
        failures: failed,
    })
}

/// Counts the samples that must be played by the clock.
struct SampleClock {
    start: Instant,
    passed_samples: usize,
}

impl SampleClock {
    fn new() -> Self {
        Self {
            start: Instant::now(),
            passed_samples: 0,
        }
    }

    fn due(&mut self, now: Instant) -> usize {
        let until = now.saturating_duration_since(self.start) + LEAD_TIME;
        let all = (until.as_secs_f64() * f64::from(RATE)) as usize;
        let due = all.saturating_sub(self.passed_samples);
        self.passed_samples = all.max(self.passed_samples);
        match due as f64 > MAX_DELAY.as_secs_f64() * f64::from(RATE) {
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
        let mut clock = SampleClock::new();
        let begin = clock.start;
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
