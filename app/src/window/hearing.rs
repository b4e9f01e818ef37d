//! Plays the sound of the machine in the window.

use super::Window;
use crate::kernel::{Command, Motion, Snapshot};
use crate::sound::{Heard, OUTPUTS};

impl Window {
    /// Applies the sound setting, and reports why sound is not possible.
    pub(super) fn follow_sound(&mut self) {
        let listened = self.sounds.listens();
        if let Some(why) = self.sounds.follow(self.settings.sound) {
            self.say(why);
        }
        if self.sounds.listens() != listened {
            self.console.send(Command::Listen(self.sounds.listens()));
        }
    }

    /// Passes the state of the machine to the sound output.
    pub(super) fn hear(&self, picture: &Snapshot) {
        if let Some(motion) = picture.motion.filter(|_| self.sounds.listens()) {
            self.sounds.hear(heard(picture, motion));
        }
    }
}

fn heard(picture: &Snapshot, motion: Motion) -> Heard {
    let outputs = picture.y.first_chunk::<OUTPUTS>();
    Heard {
        keys: picture.pressed.clone(),
        outputs: outputs.copied().unwrap_or_default(),
        spindle: motion.spindle as f32,
        slides: [motion.slides.x as f32, motion.slides.z as f32],
        alarm: picture.alarm.as_ref().map(|alarm| alarm.number),
    }
}
