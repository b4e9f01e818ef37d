//! Moves the camera: presets, pointer, wheel, fingers and keys. Stores it for the next start.

use core::f32::consts::FRAC_PI_2;

use egui::{Key, PointerButton, Response, Ui};
use gsk_scene::camera::{CameraPreset, OrbitCamera};
use gsk_scene::description::LatheDescription;

use crate::focus;
use crate::settings::StoredSceneCamera;

/// Exponent of the zoom factor per point that the wheel scrolls.
const ZOOM_PER_POINT: f32 = 0.004;
/// Drag distance that corresponds to one press of a cursor key, points.
const KEY_DRAG: f32 = 24.0;
/// Zoom factor of one key press.
const KEY_ZOOM: f32 = 1.15;
/// Units of the stored numbers: a thousandth of a millimetre or of a radian.
const STORED_UNIT: f32 = 0.001;

/// The camera of the lathe view, and its preset.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraControl {
    /// The camera; `None` while it is that of the preset.
    camera: Option<OrbitCamera>,
    /// The chosen preset; `None` once the operator has moved the camera.
    preset: Option<CameraPreset>,
    /// Whether the camera moves with the tool, in any preset.
    follows_tool: bool,
    /// Whether the cursor keys move the picture instead of turning it.
    keys_move: bool,
}

impl CameraControl {
    /// Creates the camera from the stored settings.
    pub fn from_stored(stored: Option<StoredSceneCamera>) -> Self {
        let Some(stored) = stored else {
            return Self {
                preset: Some(CameraPreset::default()),
                ..Self::default()
            };
        };
        let preset = stored.preset.map(|at| {
            let preset = CameraPreset::ALL.get(usize::from(at));
            preset.copied().unwrap_or_default()
        });
        let camera = stored.position.map(|numbers| {
            let [x, y, z, yaw, pitch, distance] = numbers.map(|it| it as f32 * STORED_UNIT);
            OrbitCamera {
                target: [x, y, z].into(),
                yaw,
                pitch: pitch.min(FRAC_PI_2),
                distance,
                is_parallel: stored.is_parallel,
            }
        });
        Self {
            preset: preset.or(camera.is_none().then(CameraPreset::default)),
            camera,
            follows_tool: preset.is_some_and(CameraPreset::follows_tool),
            keys_move: false,
        }
    }

    /// The camera for the settings; `None`: the one of the first start.
    pub fn to_stored(self) -> Option<StoredSceneCamera> {
        let index = |wanted: CameraPreset| CameraPreset::ALL.iter().position(|it| *it == wanted);
        let preset = self.preset.and_then(index).map(|at| at as u8);
        let position = self.camera.map(|it| {
            let numbers = [
                it.target.x,
                it.target.y,
                it.target.z,
                it.yaw,
                it.pitch,
                it.distance,
            ];
            numbers.map(|it| (it / STORED_UNIT).round() as i32)
        });
        let stored = StoredSceneCamera {
            preset,
            position,
            is_parallel: self.camera.is_some_and(|it| it.is_parallel),
        };
        let is_first = self.preset == Some(CameraPreset::default()) && self.camera.is_none();
        (!is_first).then_some(stored)
    }

    /// The chosen preset; `None` once the operator has moved the camera.
    pub const fn preset(&self) -> Option<CameraPreset> {
        self.preset
    }

    /// Moves the camera to a preset.
    pub const fn choose(&mut self, preset: CameraPreset) {
        self.preset = Some(preset);
        self.camera = None;
        self.follows_tool = preset.follows_tool();
    }

    /// Whether the camera follows the tool.
    pub const fn follows_tool(&self) -> bool {
        self.follows_tool
    }

    /// Sets whether the camera follows the tool.
    pub const fn set_follows_tool(&mut self, follows: bool) {
        self.follows_tool = follows;
    }

    /// Chooses the preset after the current one; the first one once the operator has moved the
    /// camera.
    fn choose_next(&mut self) {
        let index = |wanted: CameraPreset| CameraPreset::ALL.iter().position(|it| *it == wanted);
        let next = self.preset.and_then(index).map_or(0, |at| at + 1);
        let next = CameraPreset::ALL.get(next).copied();
        self.choose(next.unwrap_or_default());
    }

    /// Moves the camera by the operator's input in the picture, and returns it. `has_digits`: the
    /// digit keys belong to the view, and not to the panel.
    pub fn update(
        &mut self,
        ui: &Ui,
        response: &Response,
        lathe: &LatheDescription,
        has_digits: bool,
    ) -> OrbitCamera {
        if response.double_clicked() {
            self.choose(CameraPreset::default());
        }
        if response.has_focus() || has_digits {
            self.handle_preset_keys(ui, response.has_focus(), has_digits);
        }
        let fitted = self.preset.unwrap_or_default().camera(lathe);
        let mut camera = self.camera.unwrap_or(fitted);
        if self.follows_tool {
            camera.target = CameraPreset::Tool.camera(lathe).target;
        }
        let before = camera;
        let mut is_panned = self.handle_pointer(ui, response, &mut camera);
        if response.has_focus() {
            focus::reserve_cursor_keys(ui, response.id);
            is_panned |= self.handle_keys(ui, &mut camera, response.rect.height());
        }
        if camera != before {
            self.camera = Some(camera);
            if is_panned {
                self.follows_tool = false;
            }
            if is_panned || !self.preset.is_some_and(CameraPreset::follows_tool) {
                self.preset = None;
            }
        }
        camera
    }

    /// Handles mouse and fingers. Returns whether the picture was moved.
    fn handle_pointer(&self, ui: &Ui, response: &Response, camera: &mut OrbitCamera) -> bool {
        let height = response.rect.height();
        let to_vector = |by: egui::Vec2| [by.x, by.y].into();
        let touches = ui.input(egui::InputState::multi_touch);
        if let Some(touch) = touches.filter(|it| response.rect.contains(it.center_pos)) {
            let offset = touch.center_pos - response.rect.center();
            camera.zoom(touch.zoom_delta, to_vector(offset), height);
            camera.orbit([touch.rotation_delta * 100.0, 0.0].into());
            camera.pan(to_vector(touch.translation_delta), height);
            return touch.translation_delta.length() > 0.5;
        }
        if let Some(at) = response.hover_pos() {
            let (scrolled, pinched) =
                ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            let factor = (scrolled * ZOOM_PER_POINT).exp() * pinched;
            if factor != 1.0 {
                let offset = match self.follows_tool {
                    true => egui::Vec2::ZERO,
                    false => at - response.rect.center(),
                };
                camera.zoom(factor, to_vector(offset), height);
            }
        }
        if !response.dragged() {
            return false;
        }
        let by = to_vector(response.drag_delta());
        let is_turn =
            response.dragged_by(PointerButton::Primary) && ui.input(|input| !input.modifiers.shift);
        match is_turn {
            true => camera.orbit(by),
            false => camera.pan(by, height),
        }
        !is_turn
    }

    /// Handles the keys without modifiers while the picture has the focus: an axis key needs
    /// one. Returns whether the picture was moved.
    fn handle_keys(&mut self, ui: &Ui, camera: &mut OrbitCamera, height: f32) -> bool {
        let mut is_panned = false;
        focus::take_keys(ui, |key| {
            let by = match key {
                Key::ArrowLeft => [-KEY_DRAG, 0.0],
                Key::ArrowRight => [KEY_DRAG, 0.0],
                Key::ArrowUp => [0.0, -KEY_DRAG],
                Key::ArrowDown => [0.0, KEY_DRAG],
                Key::PageUp | Key::PageDown => {
                    let factor = match key {
                        Key::PageUp => KEY_ZOOM,
                        _ => KEY_ZOOM.recip(),
                    };
                    camera.zoom(factor, [0.0; 2].into(), height);
                    return true;
                }
                Key::Space => {
                    self.keys_move = !self.keys_move;
                    return true;
                }
                _ => return false,
            };
            match self.keys_move {
                true => camera.pan(by.into(), height),
                false => camera.orbit(by.into()),
            }
            is_panned |= self.keys_move;
            true
        });
        is_panned
    }

    /// Handles the keys that choose a preset: Home and End while the picture has the focus, and
    /// digits.
    fn handle_preset_keys(&mut self, ui: &Ui, has_focus: bool, has_digits: bool) {
        const DIGITS: [Key; CameraPreset::ALL.len()] =
            [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5];
        focus::take_keys(ui, |key| {
            let digit = DIGITS.iter().position(|it| *it == key);
            match (key, digit.filter(|_| has_digits)) {
                (Key::Home, _) if has_focus => self.choose(CameraPreset::default()),
                (Key::End, _) if has_focus => self.choose_next(),
                (_, Some(at)) => self.choose(CameraPreset::ALL[at]),
                (_, None) => return false,
            }
            true
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stored_camera_is_the_same_after_the_next_start() {
        let mut control = CameraControl::from_stored(None);
        assert_eq!(control.to_stored(), None);
        control.choose(CameraPreset::Section);
        let stored = control.to_stored();
        assert_eq!(CameraControl::from_stored(stored), control);
        control.preset = None;
        control.camera = Some(OrbitCamera {
            target: [12.5, -40.0, 0.25].into(),
            yaw: 0.5,
            pitch: -0.125,
            distance: 640.0,
            is_parallel: true,
        });
        let again = CameraControl::from_stored(control.to_stored());
        assert_eq!(again.to_stored(), control.to_stored());
        let camera = again.camera.unwrap();
        assert!(camera.is_parallel && (camera.distance - 640.0).abs() < 0.001);
    }

    #[test]
    fn one_key_leads_through_all_presets() {
        let mut control = CameraControl::from_stored(None);
        let mut seen = vec![];
        for _ in CameraPreset::ALL {
            control.choose_next();
            seen.push(control.preset().unwrap());
        }
        assert_eq!(seen[..4], CameraPreset::ALL[1..]);
        assert_eq!(seen[4], CameraPreset::Operator);
        control.preset = None;
        control.choose_next();
        assert_eq!(control.preset(), Some(CameraPreset::Operator));
    }

    #[test]
    fn a_stored_preset_that_does_not_exist_is_the_first_one() {
        let stored = StoredSceneCamera {
            preset: Some(200),
            ..StoredSceneCamera::default()
        };
        let control = CameraControl::from_stored(Some(stored));
        assert_eq!(control.preset(), Some(CameraPreset::Operator));
        let empty = CameraControl::from_stored(Some(StoredSceneCamera::default()));
        assert_eq!(empty.preset(), Some(CameraPreset::Operator));
    }
}
