//! Draws the picture of the lathe: with OpenGL, or by the processor where it is missing.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use eframe::egui_glow::CallbackFn;
use eframe::glow;
use egui::{ColorImage, PaintCallback, Rect, TextureHandle, TextureOptions, Ui, pos2};
use gsk_scene::camera::OrbitCamera;
use gsk_scene::description::LatheDescription;
use gsk_scene::level::{LevelChooser, SceneLevel};
use gsk_scene::opengl::renderer::{SceneError, SceneFigures, SceneRenderer, SceneViewport};
use gsk_scene::software::{SoftwareQuality, SoftwareRenderer};

use crate::theme;

/// Greatest width and height of a picture that the processor draws, pixels.
const MAX_PROCESSOR_SIDE: f32 = 1000.0;

/// Pictures of the processor after which OpenGL is tried again: a lost context may be back.
const RETRY_PICTURES: u32 = 60;

/// The OpenGL renderer, with the result of its last picture.
#[derive(Default)]
struct GlPainter {
    renderer: SceneRenderer,
    last: Option<Result<SceneFigures, SceneError>>,
}

/// The last picture that the processor has drawn.
struct ProcessorPicture {
    texture: TextureHandle,
    lathe: LatheDescription,
    camera: OrbitCamera,
    size: [usize; 2],
    is_refining: bool,
}

/// Statistics of the last picture, for the tooltip and the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureFigures {
    pub level: SceneLevel,
    /// Size of the contents of the OpenGL objects, bytes.
    pub bytes: i64,
    /// Number of existing OpenGL objects.
    pub objects: i64,
}

/// Draws pictures of the lathe with OpenGL or the processor.
#[derive(Default)]
pub struct ScenePicture {
    gl: Arc<Mutex<GlPainter>>,
    levels: LevelChooser,
    processor: SoftwareRenderer,
    processor_picture: Option<ProcessorPicture>,
    /// Number of pictures that were drawn since OpenGL has failed.
    failed_pictures: u32,
    /// The statistics that were logged last; `None` before the first.
    logged: Option<PictureFigures>,
}

/// A lock that a panic has poisoned is used all the same: the renderer checks its objects.
fn lock(painter: &Mutex<GlPainter>) -> MutexGuard<'_, GlPainter> {
    painter.lock().unwrap_or_else(PoisonError::into_inner)
}

impl ScenePicture {
    /// Deletes all objects of OpenGL. `gl` must be the current context.
    pub fn release(&self, gl: &glow::Context) {
        lock(&self.gl).renderer.release(gl);
    }

    /// Returns the statistics of the last picture; `None` before the first picture.
    pub fn figures(&mut self) -> Option<PictureFigures> {
        match &lock(&self.gl).last {
            Some(Ok(figures)) => Some(PictureFigures {
                level: self.levels.level(figures.is_software),
                bytes: figures.bytes,
                objects: figures.objects,
            }),
            Some(Err(_)) => Some(PictureFigures {
                level: SceneLevel::Processor,
                bytes: 0,
                objects: 0,
            }),
            None => None,
        }
    }

    /// Whether the next picture will be better without any change of the description.
    pub fn is_refining(&self) -> bool {
        match &lock(&self.gl).last {
            Some(Ok(figures)) => figures.is_refining,
            Some(Err(_)) => self
                .processor_picture
                .as_ref()
                .is_none_or(|it| it.is_refining),
            None => false,
        }
    }

    /// Adds the time between two pictures, s, while anything moves.
    pub fn add_time(&mut self, time_s: f64) {
        self.levels.add_time(time_s);
    }

    /// Draws a picture of the lathe into a rectangle.
    pub fn show(
        &mut self,
        ui: &Ui,
        rect: Rect,
        lathe: LatheDescription,
        camera: OrbitCamera,
        is_moving: bool,
    ) {
        let figures = self.figures();
        if let Some(shown) = figures
            && self.logged.is_none_or(|it| it.level != shown.level)
        {
            let PictureFigures {
                level,
                bytes,
                objects,
            } = shown;
            tracing::info!(?level, objects, bytes, "lathe scene");
            self.logged = Some(shown);
        }
        let (has_failed, may_retry) = match &lock(&self.gl).last {
            Some(Err(error)) => (true, !matches!(error, SceneError::TooOld(_))),
            Some(Ok(_)) | None => (false, false),
        };
        if !has_failed {
            self.failed_pictures = 0;
            let level = figures.map(|it| it.level);
            self.add_callback(ui, rect, lathe, camera, (is_moving, level));
            return;
        }
        self.failed_pictures += 1;
        let retries = may_retry && self.failed_pictures.is_multiple_of(RETRY_PICTURES);
        if retries {
            self.add_callback(ui, rect, lathe, camera, (is_moving, None));
        } else {
            self.show_processor_picture(ui, rect, lathe, camera, is_moving);
        }
    }

    fn add_callback(
        &self,
        ui: &Ui,
        rect: Rect,
        lathe: LatheDescription,
        camera: OrbitCamera,
        (is_moving, level): (bool, Option<SceneLevel>),
    ) {
        let painter = Arc::clone(&self.gl);
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
                level,
            };
            let mut painter = lock(&painter);
            let had_figures = matches!(painter.last, Some(Ok(_)));
            let drawn = painter
                .renderer
                .paint(egui_painter.gl(), &lathe, &camera, viewport);
            if let Err(error) = &drawn {
                tracing::warn!(%error, "lathe scene");
            }
            let needs_repaint = !had_figures || drawn.is_err();
            painter.last = Some(drawn);
            if needs_repaint {
                context.request_repaint();
            }
        });
        ui.painter().add(PaintCallback {
            rect,
            callback: Arc::new(callback),
        });
    }

    /// Draws the picture with the processor: at a third of its size while anything moves.
    fn show_processor_picture(
        &mut self,
        ui: &Ui,
        rect: Rect,
        lathe: LatheDescription,
        camera: OrbitCamera,
        is_moving: bool,
    ) {
        let pixels = rect.size() * ui.ctx().pixels_per_point();
        let share = match is_moving {
            true => SceneLevel::Processor.moving_share() as f32,
            false => 1.0,
        };
        let share = share.max(pixels.max_elem() / MAX_PROCESSOR_SIDE);
        let size = [pixels.x, pixels.y].map(|it| (it / share).round().max(1.0) as usize);
        let known = self.processor_picture.as_ref();
        let is_same = known.is_some_and(|it| {
            !it.is_refining && it.size == size && it.camera == camera && it.lathe == lathe
        });
        if !is_same {
            let quality = SoftwareQuality::Quick;
            let picture = self.processor.draw(&lathe, &camera, size, quality);
            let image = ColorImage::from_rgba_unmultiplied(picture.size, &picture.pixels);
            let options = TextureOptions::LINEAR;
            let texture = match self.processor_picture.take() {
                Some(mut known) => {
                    known.texture.set(image, options);
                    known.texture
                }
                None => ui.ctx().load_texture("lathe scene", image, options),
            };
            self.processor_picture = Some(ProcessorPicture {
                texture,
                lathe,
                camera,
                size,
                is_refining: picture.is_refining,
            });
        }
        if let Some(picture) = &self.processor_picture {
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter()
                .image(picture.texture.id(), rect, whole, theme::NO_TINT);
        }
    }
}
