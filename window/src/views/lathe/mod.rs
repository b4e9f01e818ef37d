//! The lathe view: the machine with the part in space.

mod animation;
mod bar;
mod camera_control;
mod description;
mod jolt;
mod path;
mod picture;
mod recorder;

use std::sync::Arc;
use std::time::Duration;

use eframe::glow;
use egui::text::{LayoutJob, TextWrapping};
use egui::{Align, Align2, Label, Panel, Rect, RichText, Role, Sense, StrokeKind, Ui, WidgetInfo};
use gsk_host::kernel::part::PartView;
use gsk_messages::{Language, Message, say};
use gsk_scene::camera::OrbitCamera;
use gsk_scene::description::{LatheDescription, SceneTheme};

use super::interface::{View, ViewFrame, ViewStart};
use super::machine::path::DrawnPath;
use super::{bar_frame, plain_frame};
use crate::fonts;
use crate::settings::StoredSceneCamera;
use crate::theme;
use crate::widgets::alarm_text;
use camera_control::CameraControl;
use description::SceneDescriber;
use jolt::PictureJolt;
use picture::ScenePicture;
pub use recorder::{SceneRecorder, encode_scene};

/// Time between two pictures while anything moves, s.
const FRAME_INTERVAL_S: f64 = 1.0 / 30.0;
/// Time without a change after which the picture is drawn at full size, s.
const STILL_DELAY_S: f64 = 0.25;
/// Greatest time between two pictures that counts as the time of one, s.
const LONGEST_PICTURE_S: f64 = 1.0;
/// Distance of labels from the edges of the picture, points.
const LABEL_MARGIN: f32 = 8.0;
/// Distance between the texts of two labels, one below the other, points.
const LABEL_GAP: f32 = 6.0;
/// Number of alarms that the picture shows, and of rows of each.
const MAX_ALARMS: usize = 3;
const MAX_ALARM_ROWS: usize = 2;

/// The view that shows the lathe in 3D.
pub struct LatheSceneView {
    picture: ScenePicture,
    describer: SceneDescriber,
    camera: CameraControl,
    /// The programmed path, taken from the machine view.
    path: Arc<DrawnPath>,
    /// Whether the programmed path is drawn.
    shows_path: bool,
    jolt: PictureJolt,
    /// Description and camera of the last picture; `None` before the first.
    shown: Option<(LatheDescription, OrbitCamera)>,
    changed_at_s: f64,
    /// Time at which the last picture was drawn, s.
    drawn_at_s: f64,
    /// Whether anything moved in the last picture.
    was_moving: bool,
}

impl View for LatheSceneView {
    fn create(start: ViewStart<'_>) -> Self {
        Self {
            picture: ScenePicture::default(),
            describer: SceneDescriber::default(),
            camera: CameraControl::from_stored(start.settings.scene_camera),
            path: Arc::default(),
            shows_path: true,
            jolt: PictureJolt::default(),
            shown: None,
            changed_at_s: 0.0,
            drawn_at_s: 0.0,
            was_moving: false,
        }
    }

    fn show(&mut self, ui: &mut Ui, frame: ViewFrame<'_>) {
        let part = frame.part.map(AsRef::as_ref);
        let bar = Panel::top("scene bar").frame(bar_frame());
        bar.show(ui, |ui| self.show_bar(ui, frame));
        egui::CentralPanel::default()
            .frame(plain_frame())
            .show(ui, |ui| match part {
                None => show_sentence(ui, &say::lathe_no_path(), frame.language),
                Some(part) => self.show_picture(ui, frame, part),
            });
    }
}

impl LatheSceneView {
    /// Deletes all objects of OpenGL. `gl` must be the current context.
    pub fn release(&self, gl: &glow::Context) {
        self.picture.release(gl);
    }

    /// The camera for the settings; `None`: the one of the first start.
    pub fn stored_camera(&self) -> Option<StoredSceneCamera> {
        self.camera.to_stored()
    }

    /// Sets the programmed path that the view draws.
    pub fn set_path(&mut self, path: &Arc<DrawnPath>) {
        self.path = Arc::clone(path);
    }

    fn show_picture(&mut self, ui: &Ui, frame: ViewFrame<'_>, part: &PartView) {
        let language = frame.language;
        let rect = ui.available_rect_before_wrap();
        let sense = Sense::CLICK | Sense::DRAG | Sense::focusable_noninteractive();
        let response = ui.interact(rect, ui.scope_id().with("lathe scene"), sense);
        let camera = self.camera.preset();
        response.widget_info(|| {
            let camera = camera.map_or_else(say::lathe_scene_moved, bar::preset_name);
            let name = say::lathe_scene_name(camera, say::lathe_scene_keys());
            WidgetInfo::labeled(Role::Canvas, true, name.text(language))
        });
        if rect.width() < 20.0 || rect.height() < 20.0 {
            return;
        }
        let now = ui.input(|input| input.time);
        let passed_s = now - self.drawn_at_s;
        self.drawn_at_s = now;
        if self.was_moving && passed_s < LONGEST_PICTURE_S {
            self.picture.add_time(passed_s);
        }
        let scene_theme = match theme::is_light(ui.ctx()) {
            true => SceneTheme::Day,
            false => SceneTheme::Night,
        };
        let elapsed_s = passed_s.clamp(0.0, 0.3) as f32;
        let path = self.shows_path.then_some(&self.path);
        self.describer.set_path(path, now);
        let lathe = self.describer.describe(part, scene_theme, elapsed_s);
        let mut camera = self.camera.update(ui, &response, &lathe, frame.owns_keys);
        let [x, y] = self.jolt.deflection(part.crash, now);
        camera.target.x += x;
        camera.target.y += y;
        let is_same = self.shown.as_ref();
        if !is_same.is_some_and(|(shown, from)| *shown == lathe && *from == camera) {
            self.changed_at_s = now;
            self.shown = Some((lathe.clone(), camera));
        }
        let is_moving = now - self.changed_at_s < STILL_DELAY_S;
        self.was_moving = is_moving;
        if is_moving || self.picture.is_refining() {
            let pause = Duration::from_secs_f64(FRAME_INTERVAL_S);
            ui.ctx().request_repaint_after(pause);
        }
        self.picture.show(ui, rect, lathe, camera, is_moving);
        let mut free = rect.shrink2(egui::vec2(2.0 * LABEL_MARGIN, LABEL_MARGIN));
        let rows = bar::label_rows(rect.size());
        if rows > 0 {
            free.max.x = show_state(ui, free, part, language, rows) - 3.0 * LABEL_MARGIN;
        }
        show_alarms(ui, free, frame);
        if response.has_focus() {
            draw_focus(ui, rect);
        }
    }
}

/// Writes tool, speed and position, as the LCD has it, into the upper right corner of `space`, in
/// one or two rows. Returns the left edge of the texts.
fn show_state(ui: &Ui, space: Rect, part: &PartView, language: Language, rows: usize) -> f32 {
    let tool = say::lathe_tool(part.tool, part.spindle_rpm).text(language);
    let position = say::lathe_pointer(part.absolute.x * 2.0, part.absolute.z).text(language);
    let font = egui::TextStyle::Monospace.resolve(ui.style());
    let (mut space, mut left) = (space, space.right());
    let texts = match rows {
        1 => vec![format!("{tool}  {position}")],
        _ => vec![tool, position],
    };
    for text in texts {
        let text = fonts::layout_text(&text, font.clone(), theme::MESSAGE_TEXT);
        let label = show_label(ui, space, (Align::Max, 1), text);
        left = left.min(label.left());
        space.min.y = label.bottom() + LABEL_GAP;
    }
    left
}

/// Writes the active alarms into the upper left corner of `space`: why the lathe stands.
fn show_alarms(ui: &Ui, space: Rect, frame: ViewFrame<'_>) {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let mut space = space;
    let alarms = frame.part.map_or(&[][..], |part| &part.alarms);
    for alarm in alarms.iter().take(MAX_ALARMS) {
        let text = alarm_text::one_line(alarm, frame.language);
        let text = fonts::layout_text(&text, font.clone(), theme::ALARM_TEXT);
        let label = show_label(ui, space, (Align::Min, MAX_ALARM_ROWS), text);
        space.min.y = label.bottom() + LABEL_GAP;
    }
}

/// Draws a text on a ground at the top of `space`, at its left or right edge, in at most `max_rows`
/// rows. Returns the rectangle of the text.
fn show_label(ui: &Ui, space: Rect, (edge, max_rows): (Align, usize), text: LayoutJob) -> Rect {
    let text = ui.painter().layout_job(LayoutJob {
        wrap: TextWrapping {
            max_rows,
            break_anywhere: max_rows == 1,
            ..TextWrapping::truncate_at_width(space.width().max(0.0))
        },
        ..text
    });
    let place = Align2([edge, Align::Min]).align_size_within_rect(text.size(), space);
    let ground = place.expand2(egui::vec2(LABEL_MARGIN, LABEL_MARGIN / 4.0));
    ui.painter().rect_filled(ground, 3.0, theme::BAR_GROUND);
    ui.painter().galley(place.min, text, theme::MESSAGE_TEXT);
    place
}

fn draw_focus(ui: &Ui, rect: Rect) {
    let line = ui.visuals().widgets.hovered.bg_stroke;
    ui.painter()
        .rect_stroke(rect.shrink(1.0), 2.0, line, StrokeKind::Inside);
}

fn show_sentence(ui: &mut Ui, words: &Message, language: Language) {
    ui.centered_and_justified(|ui| {
        let words = RichText::new(words.text(language)).color(theme::NOTE_TEXT);
        ui.add(Label::new(words).wrap());
    });
}
