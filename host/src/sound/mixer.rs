//! Mixes the sound of the machine from its states: no clock, no device. The same states at
//! the same samples give the same sound, bit by bit.

use gsk_panel::keys::Key;

/// Sample rate of the sound, Hz.
pub const RATE: u32 = 22_050;
/// Number of bytes of the Y memory that switch the lathe: Y0 to Y3; the bytes above are lamps.
pub const OUTPUTS: usize = 4;

/// A slide counts as at rest when no state has arrived for this time, s.
const REST_AFTER_S: f32 = 0.15;
/// Slide speed above which the pitch of its tone does not rise, mm/s.
const MAX_SLIDE_MM_PER_S: f32 = 300.0;
/// Fraction of the remaining difference by which a tone changes at each sample.
const GLIDE: f32 = 1.0 / 1500.0;
/// Number of tones of an alarm. The constant after it is the length of one tone with its
/// pause, s.
const BEEPS: u32 = 3;
const BEEP_S: f32 = 0.3;

/// The state of the machine from which its sound is made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SoundState {
    /// Keys of the panel that are down.
    pub keys: Vec<Key>,
    /// PLC outputs Y0 to Y3, which switch relays and valves.
    pub outputs: [u8; OUTPUTS],
    /// Speed of the spindle without its sign, r/min.
    pub spindle_rpm: f32,
    /// Position of the slides, mm: `[0]` X as a radius, `[1]` Z.
    pub slides: [f32; 2],
    /// Number of the active alarm; `None` without one.
    pub alarm: Option<u16>,
    /// Whether a crash has stopped the lathe.
    pub is_crashed: bool,
}

/// A tone whose pitch and loudness change gradually.
#[derive(Clone, Debug, Default, PartialEq)]
struct Tone {
    phase: f32,
    pitch: f32,
    level: f32,
    to_pitch: f32,
    to_level: f32,
}

/// A short sound that fades out.
#[derive(Clone, Debug, PartialEq)]
struct Strike {
    /// Pitch of the sound, Hz.
    pitch: f32,
    /// Fraction of noise in the sound, 0 to 1.
    noise: f32,
    level: f32,
    /// Factor by which the level changes at each sample.
    decay: f32,
    phase: f32,
}

/// Mixes the sound of the machine, sample by sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mixer {
    /// The last state of the machine; `None` before the first one.
    last_state: Option<SoundState>,
    spindle: Tone,
    slides: [Tone; 2],
    strikes: Vec<Strike>,
    /// Number of samples since the last state of the machine.
    samples_since_state: u32,
    /// Number of samples for which the alarm tones still sound.
    beeps: u32,
    /// State of the random number generator for noise.
    noise: u32,
}

impl Tone {
    fn next_sample(&mut self) -> f32 {
        self.pitch += (self.to_pitch - self.pitch) * GLIDE;
        self.level += (self.to_level - self.level) * GLIDE;
        self.phase = (self.phase + self.pitch / RATE as f32).fract();
        // Two harmonics: a motor, not a whistle.
        let wave = wave(self.phase) + 0.5 * wave((2.0 * self.phase).fract());
        wave * self.level
    }

    /// Sets the pitch, Hz, and level, to which the tone glides; at level 0 it keeps its pitch
    /// while it fades out.
    const fn set_target(&mut self, pitch: f32, level: f32) {
        self.to_level = level;
        if level > 0.0 {
            self.to_pitch = pitch;
        }
    }
}

impl Mixer {
    /// Compares the new state of the machine with the last one, and starts and changes tones
    /// accordingly.
    pub fn update(&mut self, state: &SoundState) {
        let spindle = state.spindle_rpm.abs().min(10_000.0);
        // Six pulses of the motor a turn; louder with speed.
        let level = match spindle < 1.0 {
            true => 0.0,
            false => 0.05 + 0.1 * (spindle / 3000.0).min(1.0),
        };
        self.spindle.set_target(30.0 + spindle / 10.0, level);
        let Some(before) = self.last_state.replace(state.clone()) else {
            // The first state changes nothing audible.
            return;
        };
        let passed = self.samples_since_state.max(RATE / 200) as f32 / RATE as f32;
        for (slide, tone) in self.slides.iter_mut().enumerate() {
            let distance = state.slides.get(slide).zip(before.slides.get(slide));
            let distance = distance.map_or(0.0, |(now, before)| (now - before).abs());
            let speed = (distance / passed).min(MAX_SLIDE_MM_PER_S);
            let level = if distance > 0.0 { 0.06 } else { 0.0 };
            // The pitches of the two slides differ by a fifth.
            let base_hz = if slide == 0 { 90.0 } else { 60.0 };
            tone.set_target(base_hz + speed * 8.0, level);
        }
        for key in state.keys.iter().filter(|key| !before.keys.contains(key)) {
            let pitch = if *key == Key::EmergencyStop {
                700.0
            } else {
                2200.0
            };
            self.strike(pitch, 0.3, 0.25, 0.985);
        }
        let up = before.keys.iter().filter(|key| !state.keys.contains(key));
        for _ in up {
            self.strike(1500.0, 0.3, 0.12, 0.98);
        }
        let (now, then) = (state.outputs, before.outputs);
        for (now, then) in now.into_iter().zip(then) {
            for bit in (0..8).filter(|bit| ((now ^ then) >> bit) & 1 == 1) {
                let on = (now >> bit) & 1 == 1;
                self.strike(if on { 420.0 } else { 300.0 }, 0.7, 0.35, 0.994);
            }
        }
        if state.is_crashed && !before.is_crashed {
            // The blow, the ring of the bar, the fragments.
            self.strike(52.0, 0.35, 1.4, 0.999_7);
            self.strike(1730.0, 0.1, 0.5, 0.999_4);
            self.strike(0.0, 1.0, 0.9, 0.998_5);
        }
        if state.alarm.is_some() && state.alarm != before.alarm {
            self.beeps = (BEEP_S * RATE as f32) as u32 * BEEPS;
        } else if state.alarm.is_none() {
            self.beeps = 0;
        }
        self.samples_since_state = 0;
    }

    fn strike(&mut self, pitch: f32, noise: f32, level: f32, decay: f32) {
        // More strikes at once only crackle.
        if self.strikes.len() < 16 {
            self.strikes.push(Strike {
                pitch,
                noise,
                level,
                decay,
                phase: 0.0,
            });
        }
    }

    /// Computes the next samples. `volume` is in per cent.
    pub fn fill(&mut self, samples: &mut [i16], volume: u8) {
        let volume = f32::from(volume.min(100)) / 100.0;
        for sample in samples {
            let loud = self.next_sample() * volume;
            // No sum of sounds overflows.
            let soft = loud / (1.0 + loud.abs());
            *sample = (soft * f32::from(i16::MAX)) as i16;
        }
    }

    fn next_sample(&mut self) -> f32 {
        self.samples_since_state = self.samples_since_state.saturating_add(1);
        if self.samples_since_state as f32 > REST_AFTER_S * RATE as f32 {
            for tone in &mut self.slides {
                tone.set_target(0.0, 0.0);
            }
        }
        let mut sum = self.spindle.next_sample();
        for tone in &mut self.slides {
            sum += tone.next_sample();
        }
        // Xorshift: the same noise every time.
        self.noise = self.noise.max(1);
        self.noise ^= self.noise << 13;
        self.noise ^= self.noise >> 17;
        self.noise ^= self.noise << 5;
        let noise = self.noise as f32 / (u32::MAX as f32 / 2.0) - 1.0;
        for strike in &mut self.strikes {
            strike.phase = (strike.phase + strike.pitch / RATE as f32).fract();
            let tone = wave(strike.phase) * (1.0 - strike.noise);
            sum += (tone + noise * strike.noise) * strike.level;
            strike.level *= strike.decay;
        }
        self.strikes.retain(|strike| strike.level > 0.001);
        if self.beeps > 0 {
            let length = (BEEP_S * RATE as f32) as u32;
            let phase = (self.beeps as f32 * 880.0 / RATE as f32).fract();
            if self.beeps % length > length / 2 {
                sum += 0.2 * wave(phase);
            }
            self.beeps -= 1;
        }
        sum
    }
}

/// Returns nearly a sine of `phase`, composed of parabolas to give the same bits on every
/// system.
fn wave(phase: f32) -> f32 {
    let x = 2.0 * phase - 1.0;
    4.0 * x * (1.0 - x.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_panel::keys::KEYS;

    /// Returns the loudness of the samples of the next `seconds`, and their upward zero
    /// crossings per second.
    fn listen(mixer: &mut Mixer, seconds: f32) -> (f64, f64) {
        let mut samples = vec![0; (seconds * RATE as f32) as usize];
        mixer.fill(&mut samples, 100);
        let square: f64 = samples.iter().map(|it| f64::from(*it).powi(2)).sum();
        let crossings = samples.windows(2).filter(|it| it[0] < 0 && it[1] >= 0);
        let crossings = crossings.count() as f64 / f64::from(seconds);
        ((square / samples.len() as f64).sqrt(), crossings)
    }

    fn rest_state() -> SoundState {
        SoundState::default()
    }

    #[test]
    fn a_machine_at_rest_is_silent_whatever_its_first_state() {
        let mut mixer = Mixer::default();
        mixer.update(&SoundState {
            outputs: [0xff; OUTPUTS],
            alarm: Some(207),
            ..rest_state()
        });
        assert_eq!(listen(&mut mixer, 0.5).0, 0.0);
    }

    #[test]
    fn the_hum_of_the_spindle_follows_its_speed_and_ends_with_it() {
        let mut mixer = Mixer::default();
        let mut pitch = Vec::new();
        for rpm in [500.0, 1000.0, 3000.0] {
            mixer.update(&SoundState {
                spindle_rpm: rpm,
                ..rest_state()
            });
            listen(&mut mixer, 1.0);
            let (loud, crossings) = listen(&mut mixer, 1.0);
            assert!(loud > 500.0, "{rpm}: {loud}");
            let expected = f64::from(30.0 + rpm / 10.0);
            assert!(
                (crossings / expected - 1.0).abs() < 0.1,
                "{rpm}: {crossings}"
            );
            pitch.push(crossings);
        }
        assert!(pitch.is_sorted());
        mixer.update(&rest_state());
        listen(&mut mixer, 2.0);
        assert!(listen(&mut mixer, 0.2).0 < 1.0);
    }

    #[test]
    fn a_slide_sounds_while_it_moves_and_higher_the_faster_it_is() {
        let travel = |step: f32| {
            let mut mixer = Mixer::default();
            let mut last = (0.0, 0.0);
            for picture in 0..60 {
                mixer.update(&SoundState {
                    slides: [0.0, picture as f32 * step],
                    ..rest_state()
                });
                last = listen(&mut mixer, 1.0 / 60.0);
            }
            // No state arrives while nothing moves.
            listen(&mut mixer, 1.5);
            let after = listen(&mut mixer, 0.1).0;
            assert!(last.0 > 100.0 && after < 10.0, "{last:?}, then {after}");
            last.1
        };
        let (feed, rapid) = (travel(0.05), travel(2.0));
        assert!(rapid > 4.0 * feed, "{feed} Hz, {rapid} Hz");
    }

    #[test]
    fn keys_relays_an_alarm_and_a_crash_sound_once_each() {
        for changed in [
            SoundState {
                keys: vec![Key::Reset],
                ..rest_state()
            },
            SoundState {
                outputs: [0, 0b100, 0, 0],
                ..rest_state()
            },
            SoundState {
                alarm: Some(207),
                ..rest_state()
            },
            SoundState {
                is_crashed: true,
                ..rest_state()
            },
        ] {
            let mut mixer = Mixer::default();
            mixer.update(&rest_state());
            assert_eq!(listen(&mut mixer, 0.1).0, 0.0);
            mixer.update(&changed);
            let (loud, _) = listen(&mut mixer, 0.1);
            assert!(loud > 200.0, "{changed:?}: {loud}");
            listen(&mut mixer, 1.0);
            mixer.update(&changed);
            assert!(listen(&mut mixer, 0.5).0 < 1.0, "{changed:?}");
        }
    }

    #[test]
    fn a_crash_is_louder_than_everything_else_of_the_machine() {
        let loudest = |changed: SoundState| {
            let mut mixer = Mixer::default();
            mixer.update(&rest_state());
            mixer.update(&changed);
            listen(&mut mixer, 0.1).0
        };
        let crash = loudest(SoundState {
            is_crashed: true,
            ..rest_state()
        });
        let relay = loudest(SoundState {
            outputs: [0, 0b100, 0, 0],
            ..rest_state()
        });
        let alarm = loudest(SoundState {
            alarm: Some(221),
            ..rest_state()
        });
        assert!(
            crash > 2.0 * relay && crash > 2.0 * alarm,
            "{crash} {relay} {alarm}"
        );
    }

    #[test]
    fn everything_at_once_stays_in_range_and_comes_again_bit_by_bit() {
        let play = || {
            let mut mixer = Mixer::default();
            mixer.update(&rest_state());
            mixer.update(&SoundState {
                keys: KEYS.iter().map(|row| row.key).collect(),
                outputs: [0xff; OUTPUTS],
                spindle_rpm: f32::MAX,
                slides: [f32::MAX, -1e30],
                alarm: Some(207),
                is_crashed: true,
            });
            let mut samples = vec![0; RATE as usize];
            mixer.fill(&mut samples, 255);
            samples
        };
        let samples = play();
        let loudest = samples.iter().map(|it| i32::from(*it).abs()).max();
        assert!(loudest < Some(32_000), "{loudest:?}");
        assert_eq!(samples, play());
        let mut mixer = Mixer::default();
        mixer.update(&rest_state());
        mixer.update(&SoundState {
            spindle_rpm: 3000.0,
            ..rest_state()
        });
        let mut samples = vec![1; 1000];
        mixer.fill(&mut samples, 0);
        assert!(samples.iter().all(|it| *it == 0));
    }
}
