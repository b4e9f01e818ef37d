//! The controls above the picture of the lathe: cameras, section cuts, path. A narrow view has
//! menus instead.

use egui::{Ui, Vec2, ViewportCommand};
use gsk_messages::{Language, Message, say};
use gsk_scene::camera::CameraPreset;
use gsk_scene::description::SectionCut;
use gsk_scene::level::SceneLevel;

use super::super::interface::ViewFrame;
use super::LatheSceneView;
use crate::widgets::icons;

/// Width of a line between two groups of controls, points.
const SEPARATOR_WIDTH: f32 = 6.0;
/// Width and height below which a view is small, points.
const SMALL_SIZE: Vec2 = Vec2::new(420.0, 120.0);
/// Height below which a view has one row of labels, points.
const LOW_HEIGHT: f32 = 240.0;

/// The number of labels one below the other that leave the picture of a view visible.
pub fn label_rows(size: Vec2) -> usize {
    if size.x < SMALL_SIZE.x || size.y < SMALL_SIZE.y {
        0
    } else if size.y < LOW_HEIGHT {
        1
    } else {
        2
    }
}

impl LatheSceneView {
    /// Draws the controls of the lathe view in one row. Without room for all of them the cameras
    /// are in a menu, and without room for the others these are in a second one.
    pub(super) fn show_bar(&mut self, ui: &mut Ui, frame: ViewFrame<'_>) {
        let language = frame.language;
        let cameras = CameraPreset::ALL.map(|preset| preset_name(preset).text(language));
        let cameras = icons::word_buttons_width(ui, &cameras);
        let others = other_controls_width(ui, frame);
        let available = ui.available_width();
        if others + icons::word_buttons_width(ui, &[self.camera_name(language)]) > available {
            return self.show_small_bar(ui, frame);
        }
        ui.horizontal(|ui| {
            if cameras + others <= available {
                self.show_presets(ui, language);
            } else {
                self.show_camera_menu(ui, language);
            }
            ui.separator();
            self.show_follow(ui, language);
            // A docked view cannot fill the screen by itself: its separate window can.
            if frame.owns_keys {
                show_full_screen_button(ui, language);
            }
            ui.separator();
            self.show_section_cuts(ui, language);
        });
    }

    /// Shows a menu of the cameras, and one of all other controls.
    fn show_small_bar(&mut self, ui: &mut Ui, frame: ViewFrame<'_>) {
        let language = frame.language;
        ui.horizontal(|ui| {
            self.show_camera_menu(ui, language);
            let menu = ui.menu_button("…", |ui| {
                self.show_follow(ui, language);
                if frame.owns_keys {
                    show_full_screen_button(ui, language);
                }
                ui.separator();
                self.show_section_cuts(ui, language);
            });
            menu.response
                .on_hover_text(say::lathe_scene_menu_hint().text(language));
        });
    }

    fn show_camera_menu(&mut self, ui: &mut Ui, language: Language) {
        let menu = ui.menu_button(self.camera_name(language), |ui| {
            self.show_presets(ui, language);
        });
        menu.response
            .on_hover_text(say::lathe_scene_menu_hint().text(language));
    }

    /// The name of the chosen camera, or the word for a camera that was moved.
    fn camera_name(&self, language: Language) -> String {
        let preset = self.camera.preset();
        let words = preset.map_or_else(say::lathe_scene_camera, preset_name);
        words.text(language)
    }

    fn show_presets(&mut self, ui: &mut Ui, language: Language) {
        let mut hint = say::lathe_scene_hint().text(language);
        let more = [Some(say::lathe_scene_keys()), self.describe_level(language)];
        for words in more.into_iter().flatten() {
            hint.push_str("\n\n");
            hint.push_str(&words.text(language));
        }
        for preset in CameraPreset::ALL {
            let words = preset_name(preset);
            let is_chosen = self.camera.preset() == Some(preset);
            let button = ui.selectable_label(is_chosen, words.text(language));
            if button.on_hover_text(&hint).clicked() {
                self.camera.choose(preset);
            }
        }
    }

    fn show_follow(&mut self, ui: &mut Ui, language: Language) {
        let mut follows = self.camera.follows_tool();
        let words = say::lathe_scene_follow().text(language);
        if ui.checkbox(&mut follows, words).changed() {
            self.camera.set_follows_tool(follows);
        }
    }

    fn show_section_cuts(&mut self, ui: &mut Ui, language: Language) {
        for cut in SectionCut::ALL {
            let words = cut_name(cut);
            let chosen = self.describer.section_cut == cut;
            let button = ui.selectable_label(chosen, words.text(language));
            let hint = say::lathe_scene_cut_hint().text(language);
            if button.on_hover_text(hint).clicked() {
                self.describer.section_cut = cut;
            }
        }
        ui.separator();
        let words = say::lathe_path().text(language);
        let button = ui.selectable_label(self.shows_path, words);
        let hint = say::lathe_scene_path_hint().text(language);
        if button.on_hover_text(hint).clicked() {
            self.shows_path = !self.shows_path;
        }
    }

    /// The level in force and the memory of the objects of OpenGL.
    fn describe_level(&mut self, language: Language) -> Option<Message> {
        let figures = self.picture.figures()?;
        let level = match figures.level {
            SceneLevel::Processor => return Some(say::lathe_scene_processor()),
            SceneLevel::Coarse => say::lathe_scene_coarse(),
            SceneLevel::Half => say::lathe_scene_medium(),
            SceneLevel::Full => say::lathe_scene_full(),
        };
        let megabytes = figures.bytes as f64 / 1e6;
        Some(say::lathe_scene_level(level.text(language), megabytes))
    }
}

/// Shows the button that lets the window of the view fill the screen, or ends that.
fn show_full_screen_button(ui: &mut Ui, language: Language) {
    let is_full = ui.input(|input| input.viewport().fullscreen == Some(true));
    let words = say::lathe_scene_full_screen().text(language);
    if ui.selectable_label(is_full, words).clicked() {
        ui.ctx()
            .send_viewport_cmd(ViewportCommand::Fullscreen(!is_full));
    }
}

fn cut_name(cut: SectionCut) -> Message {
    match cut {
        SectionCut::Whole => say::lathe_scene_whole(),
        SectionCut::Quarter => say::lathe_scene_quarter(),
        SectionCut::Half => say::lathe_scene_half(),
    }
}

/// Width of the controls beside the cameras in the row, points.
fn other_controls_width(ui: &Ui, frame: ViewFrame<'_>) -> f32 {
    let cuts = SectionCut::ALL.map(cut_name);
    let full_screen = frame.owns_keys.then(say::lathe_scene_full_screen);
    let words = [say::lathe_scene_follow(), say::lathe_path()]
        .into_iter()
        .chain(cuts)
        .chain(full_screen);
    let words: Vec<String> = words.map(|it| it.text(frame.language)).collect();
    let space = ui.spacing().item_spacing.x;
    let separators = 3.0 * (SEPARATOR_WIDTH + space);
    let check_mark = ui.spacing().icon_width + ui.spacing().icon_spacing;
    icons::word_buttons_width(ui, &words) + check_mark + separators
}

/// Returns the name of a camera preset.
pub fn preset_name(preset: CameraPreset) -> Message {
    match preset {
        CameraPreset::Operator => say::lathe_scene_operator(),
        CameraPreset::Tool => say::lathe_scene_tool(),
        CameraPreset::Chuck => say::lathe_scene_chuck(),
        CameraPreset::Top => say::lathe_scene_top(),
        CameraPreset::Section => say::lathe_scene_section(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_beside_the_panel_has_no_labels_a_low_one_a_row_and_a_window_two() {
        let rows = |width, height| label_rows(Vec2::new(width, height));
        assert_eq!((rows(240.0, 180.0), rows(300.0, 600.0)), (0, 0));
        assert_eq!((rows(900.0, 100.0), rows(900.0, 180.0)), (0, 1));
        assert_eq!(rows(900.0, 640.0), 2);
    }
}
