//! Sound: samples go through a pipe to a player program of the system. Linking ALSA would
//! need its development package at every build, and its library at every start.

use std::io::Write;
use std::process::{Child, ChildStdin, Command, Stdio};

use gsk_messages::{Message, say};

/// Programs that play samples of 16 bits, one channel, from standard input: name, options and
/// the option for the sample rate, for PulseAudio, PipeWire and ALSA.
const PLAYERS: [(&str, &[&str], &str); 3] = [
    (
        "pacat",
        &[
            "--playback",
            "--raw",
            "--format=s16le",
            "--channels=1",
            "--latency-msec=60",
            "--client-name=GSK980TD",
        ],
        "--rate=",
    ),
    (
        "pw-cat",
        &["--playback", "--raw", "--format=s16", "--channels=1", "-"],
        "--rate=",
    ),
    (
        "aplay",
        &[
            "-q",
            "-t",
            "raw",
            "-f",
            "S16_LE",
            "-c",
            "1",
            "--buffer-time=120000",
        ],
        "--rate=",
    ),
];

/// Returns true: on this system a player for sound may be installed.
pub const fn has_sound() -> bool {
    true
}

/// A running external program that plays sound samples.
pub struct Player {
    child: Child,
    input: ChildStdin,
    rate: u32,
    /// Index in `PLAYERS` of the first one that was not tried yet.
    next_player: usize,
}

impl Player {
    /// Starts the first player that is installed, at this sample rate, Hz.
    ///
    /// # Errors
    /// No player is installed.
    pub fn open(rate: u32) -> Result<Self, Message> {
        Self::open_from(0, rate)
    }

    fn open_from(first: usize, rate: u32) -> Result<Self, Message> {
        for (index, (name, options, rate_option)) in PLAYERS.iter().enumerate().skip(first) {
            let started = Command::new(name)
                .args([format!("{rate_option}{rate}")])
                .args(*options)
                .stdin(Stdio::piped())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn();
            let Ok(mut child) = started else { continue };
            if let Some(input) = child.stdin.take() {
                return Ok(Self {
                    child,
                    input,
                    rate,
                    next_player: index + 1,
                });
            }
        }
        let names = PLAYERS.map(|(name, ..)| name).join(", ");
        Err(say::sound_no_player(names))
    }

    /// Plays samples; if the player has ended, starts the next one.
    ///
    /// # Errors
    /// No player is left.
    pub fn play(&mut self, samples: &[i16]) -> Result<(), Message> {
        let bytes: Vec<u8> = samples.iter().flat_map(|it| it.to_le_bytes()).collect();
        if self.input.write_all(&bytes).is_err() {
            *self = Self::open_from(self.next_player, self.rate)?;
        }
        Ok(())
    }
}

impl Drop for Player {
    fn drop(&mut self) {
        // A player that has already ended is fine.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_messages::Language;

    #[test]
    fn without_a_player_the_sentence_names_them() {
        let refused = Player::open_from(PLAYERS.len(), 22_050).err().unwrap();
        let text = refused.text(Language::En);
        assert!(text.contains("pacat, pw-cat, aplay"), "{text}");
    }
}
