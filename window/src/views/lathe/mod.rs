//! The lathe view: the machine with the part in space, drawn with OpenGL.

mod description;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use eframe::egui_glow::CallbackFn;
use eframe::glow;
use egui::{
    Label, PaintCallback, Panel, PointerButton, Rect, Response, RichText, Role, Sense, Ui,
    WidgetInfo,
};
use gsk_host::kernel::part::PartView;
use gsk_messages::{Language, Message, say};
use gsk_scene::camera::{CameraPreset, OrbitCamera};
use gsk_scene::description::{LatheDescription, SceneTheme};
use gsk_scene::renderer::{SceneError, SceneFigures, SceneRenderer, SceneViewport};

use super::interface::{View, ViewFrame, ViewStart};
use super::{bar_frame, plain_frame};
use crate::theme;
use description::SceneDescriber;

/// Time between two pictures while something moves, s.
const FRAME_INTERVAL_S: f64 = 1.0 / 30.0;
/// Time without a change after which the picture is drawn at full size, s.
const STILL_DELAY_S: f64 = 0.25;
/// Exponent of the zoom factor per point that the wheel scrolls.
const ZOOM_PER_POINT: f32 = 0.004;

/// The renderer, and the result of its last picture.
#[derive(Default)]
struct ScenePainter {
    renderer: SceneRenderer,
    last: Option<Result<SceneFigures, SceneError>>,
}

/// The view that shows the lathe in space.
#[derive(Default)]
pub struct LatheSceneView {
    painter: Arc<Mutex<ScenePainter>>,
    describer: SceneDescriber,
    camera: Option<OrbitCamera>,
    /// The chosen preset; `None` once the operator has moved the camera.
    preset: Option<CameraPreset>,
    /// What the last picture showed, and when it changed, s.
    shown: Option<(LatheDescription, OrbitCamera)>,
    changed_at_s: f64,
    /// Time of the last picture, s.
    drawn_at_s: f64,
}

/// A lock that a panic has poisoned is used all the same: the renderer checks its objects.
fn lock(painter: &Mutex<ScenePainter>) -> MutexGuard<'_, ScenePainter> {
    painter.lock().unwrap_or_else(PoisonError::into_inner)
}

impl View for LatheSceneView {
    fn create(_: ViewStart<'_>) -> Self {
        Self {
            preset: Some(CameraPreset::default()),
            ..Self::default()
        }
    }

    fn show(&mut self, ui: &mut Ui, frame: ViewFrame<'_>) {
        self.draw(ui, frame.language, frame.part.map(Arc::as_ref));
    }
}

impl LatheSceneView {
    /// Deletes all objects of OpenGL. `gl` must be the current context.
    pub fn release(&self, gl: &glow::Context) {
        lock(&self.painter).renderer.release(gl);
    }

    fn draw(&mut self, ui: &mut Ui, language: Language, part: Option<&PartView>) {
        let bar = Panel::top("scene bar").frame(bar_frame());
        bar.show(ui, |ui| self.show_presets(ui, language, part));
        egui::CentralPanel::default()
            .frame(plain_frame())
            .show(ui, |ui| {
                let failed = matches!(lock(&self.painter).last, Some(Err(_)));
                match part {
                    _ if failed => show_sentence(ui, &say::lathe_scene_unavailable(), language),
                    None => show_sentence(ui, &say::lathe_no_path(), language),
                    Some(part) => self.show_picture(ui, language, part),
                }
            });
    }

    fn show_presets(&mut self, ui: &mut Ui, language: Language, part: Option<&PartView>) {
        ui.horizontal_wrapped(|ui| {
            for preset in CameraPreset::ALL {
                let words = match preset {
                    CameraPreset::Operator => say::lathe_scene_operator(),
                    CameraPreset::Tool => say::lathe_scene_tool(),
                    CameraPreset::Chuck => say::lathe_scene_chuck(),
                    CameraPreset::Top => say::lathe_scene_top(),
                };
                let chosen = self.preset == Some(preset);
                let button = ui.selectable_label(chosen, words.text(language));
                let hint = say::lathe_scene_hint().text(language);
                if button.on_hover_text(hint).clicked() {
                    self.preset = Some(preset);
                    self.camera = None;
                }
            }
            ui.separator();
            if let Some(part) = part {
                let tool = say::lathe_tool(part.tool, part.spindle_rpm);
                let position = say::lathe_pointer(part.tip.x * 2.0, part.tip.z);
                for words in [tool, position] {
                    ui.label(RichText::new(words.text(language)).monospace());
                }
            }
        });
    }

    fn show_picture(&mut self, ui: &mut Ui, language: Language, part: &PartView) {
        let rect = ui.available_rect_before_wrap();
        let sense = Sense::CLICK | Sense::DRAG;
        let response = ui.interact(rect, ui.scope_id().with("lathe scene"), sense);
        response.widget_info(|| {
            let name = say::lathe_scene_picture().text(language);
            WidgetInfo::labeled(Role::Canvas, true, name)
        });
        if rect.width() < 20.0 || rect.height() < 20.0 {
            return;
        }
        let now = ui.input(|input| input.time);
        let elapsed_s = (now - self.drawn_at_s).clamp(0.0, 0.1) as f32;
        self.drawn_at_s = now;
        let scene_theme = match theme::is_light(ui.ctx()) {
            true => SceneTheme::Day,
            false => SceneTheme::Night,
        };
        let lathe = self.describer.describe(part, scene_theme, elapsed_s);
        let camera = self.move_camera(ui, &response, &lathe);
        let is_same = self.shown.as_ref();
        if !is_same.is_some_and(|(shown, from)| *shown == lathe && *from == camera) {
            self.changed_at_s = now;
            self.shown = Some((lathe.clone(), camera));
        }
        let is_moving = now - self.changed_at_s < STILL_DELAY_S;
        let is_refining = match &lock(&self.painter).last {
            Some(Ok(figures)) => figures.is_refining,
            Some(Err(_)) | None => false,
        };
        if is_moving || is_refining {
            let pause = Duration::from_secs_f64(FRAME_INTERVAL_S);
            ui.ctx().request_repaint_after(pause);
        }
        self.add_callback(ui, rect, lathe, camera, is_moving);
    }

    fn add_callback(
        &self,
        ui: &Ui,
        rect: Rect,
        lathe: LatheDescription,
        camera: OrbitCamera,
        is_moving: bool,
    ) {
        let painter = Arc::clone(&self.painter);
        let context = ui.ctx().clone();
        let callback = CallbackFn::new(move |info, egui_painter| {
            let place = info.viewport_in_pixels();
            let viewport = SceneViewport {
                pixels: [
                    place.left_px,
                    place.from_bottom_px,
                    place.width_px,
                    place.height_px,
                ],
                output: egui_painter.intermediate_fbo(),
                is_moving,
            };
            let mut painter = lock(&painter);
            let is_first = painter.last.is_none();
            let drawn = painter
                .renderer
                .paint(egui_painter.gl(), &lathe, &camera, viewport);
            if let (true, Err(error)) = (is_first, &drawn) {
                tracing::warn!(%error, "lathe scene");
            }
            painter.last = Some(drawn);
            if is_first {
                context.request_repaint();
            }
        });
        ui.painter().add(PaintCallback {
            rect,
            callback: Arc::new(callback),
        });
    }

    /// Moves the camera by preset, pointer, wheel and fingers.
    fn move_camera(
        &mut self,
        ui: &Ui,
        response: &Response,
        lathe: &LatheDescription,
    ) -> OrbitCamera {
        let preset = self.preset.unwrap_or_default();
        let fitted = preset.camera(lathe);
        let mut camera = match (self.camera, self.preset) {
            (Some(camera), Some(preset)) if preset.follows_tool() => OrbitCamera {
                target: fitted.target,
                ..camera
            },
            (Some(camera), _) => camera,
            (None, _) => fitted,
        };
        let before = camera;
        let height = response.rect.height();
        let to_vector = |by: egui::Vec2| [by.x, by.y].into();
        if let Some(at) = response.hover_pos() {
            let (scrolled, pinched) =
                ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            let factor = (scrolled * ZOOM_PER_POINT).exp() * pinched;
            if factor != 1.0 {
                let offset = match preset.follows_tool() && self.preset.is_some() {
                    true => egui::Vec2::ZERO,
                    false => at - response.rect.center(),
                };
                camera.zoom(factor, to_vector(offset), height);
            }
        }
        let mut is_panned = false;
        if response.dragged() {
            let by = to_vector(response.drag_delta());
            let is_turn = response.dragged_by(PointerButton::Primary)
                && ui.input(|input| !input.modifiers.shift);
            match is_turn {
                true => camera.orbit(by),
                false => camera.pan(by, height),
            }
            is_panned = !is_turn;
        }
        if response.double_clicked() {
            self.preset = Some(CameraPreset::default());
            self.camera = None;
            return CameraPreset::default().camera(lathe);
        }
        if camera != before {
            self.camera = Some(camera);
            if is_panned || !preset.follows_tool() {
                self.preset = None;
            }
        }
        camera
    }
}

fn show_sentence(ui: &mut Ui, words: &Message, language: Language) {
    ui.centered_and_justified(|ui| {
        let words = RichText::new(words.text(language)).color(theme::NOTE_TEXT);
        ui.add(Label::new(words).wrap());
    });
}
