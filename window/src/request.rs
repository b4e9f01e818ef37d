//! Plays the sound of the machine in the window.

use gsk_host::kernel::{Command, MachineMotion, PanelSnapshot};
use gsk_host::sound::{OUTPUTS, SoundState};

use super::Window;

impl Window {
    /// Applies the sound setting, and shows a message if sound is not possible.
    pub(super) fn update_sound(&mut self) {
        let was_on = self.sounds.is_on();
        if let Some(problem) = self.sounds.set_volume(self.settings.sound) {
            self.show_message(problem);
        }
        if self.sounds.is_on() != was_on {
            self.console
                .send(Command::PublishMotion(self.sounds.is_on()));
        }
    }

    /// Passes the state of the machine to the sound output.
    pub(super) fn play_machine(&self, snapshot: &PanelSnapshot) {
        if let Some(motion) = snapshot.motion.filter(|_| self.sounds.is_on()) {
            self.sounds.send_state(sound_state(snapshot, motion));
        }
    }
}

fn sound_state(snapshot: &PanelSnapshot, motion: MachineMotion) -> SoundState {
    let outputs = snapshot.y_memory.first_chunk::<OUTPUTS>();
    SoundState {
        keys: snapshot.pressed.clone(),
        outputs: outputs.copied().unwrap_or_default(),
        spindle_rpm: motion.spindle_rpm as f32,
        slides: [motion.slides.x as f32, motion.slides.z as f32],
        alarm: snapshot.alarm.as_ref().map(|alarm| alarm.number),
        is_crashed: snapshot.crash.is_some(),
    }
}
