//! Resizes the picture many times and compares the objects of OpenGL before and after:
//! `cargo bench -p gsk980td-scene --bench resizes -- 10000`. It needs a display.
//! `LIBGL_ALWAYS_SOFTWARE=1` draws with the processor.
#![allow(missing_docs, clippy::expect_used)]

use std::sync::{Arc, Mutex};

use eframe::egui;
use eframe::glow;
use gsk_scene::camera::CameraPreset;
use gsk_scene::description::LatheDescription;
use gsk_scene::opengl::renderer::{SceneRenderer, SceneViewport};

/// Resizes in one frame of the window.
const RESIZES_PER_FRAME: u32 = 25;

/// Figures of the first picture with complete light, and the number of resizes since then.
#[derive(Default)]
struct ResizeState {
    renderer: SceneRenderer,
    first: Option<(i64, i64)>,
    resizes: u32,
    is_done: bool,
}

struct ResizeBench {
    state: Arc<Mutex<ResizeState>>,
    wanted: u32,
}

fn viewport(size: [i32; 2], output: Option<glow::Framebuffer>) -> SceneViewport {
    SceneViewport {
        pixels: [0, 0, size[0], size[1]],
        output,
        is_moving: false,
        level: None,
    }
}

impl eframe::App for ResizeBench {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        let shared = Arc::clone(&self.state);
        let wanted = self.wanted;
        let callback = eframe::egui_glow::CallbackFn::new(move |_, painter| {
            let mut state = shared.lock().expect("the lock");
            let lathe = LatheDescription::default();
            let camera = CameraPreset::Operator.camera(&lathe);
            let paint = |renderer: &mut SceneRenderer, size| {
                let viewport = viewport(size, painter.intermediate_fbo());
                renderer
                    .paint(painter.gl(), &lathe, &camera, viewport)
                    .expect("a picture")
            };
            let figures = paint(&mut state.renderer, [64, 48]);
            let Some(first) = state.first else {
                let is_complete = !figures.is_refining;
                state.first = is_complete.then_some((figures.objects, figures.bytes));
                return;
            };
            assert_eq!((figures.objects, figures.bytes), first, "a leak");
            for _ in 0..RESIZES_PER_FRAME {
                let number = state.resizes as i32;
                let size = [16 + number * 7 % 61, 16 + number * 11 % 53];
                paint(&mut state.renderer, size);
                state.resizes += 1;
            }
            if state.resizes >= wanted && !state.is_done {
                let (objects, bytes) = first;
                println!("{wanted} resizes: {objects} objects, {bytes} bytes as before");
                state.renderer.release(painter.gl());
                state.is_done = true;
            }
        });
        ui.painter().add(egui::PaintCallback {
            rect: ui.max_rect(),
            callback: Arc::new(callback),
        });
        if self.state.lock().expect("the lock").is_done {
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
        }
        ui.ctx().request_repaint();
    }
}

fn main() {
    let mut numbers = std::env::args().filter_map(|it| it.parse().ok());
    let bench = ResizeBench {
        state: Arc::default(),
        wanted: numbers.next_back().unwrap_or(10_000),
    };
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default().with_inner_size([160.0, 120.0]),
        ..Default::default()
    };
    let run = eframe::run_native("resizes", options, Box::new(|_| Ok(Box::new(bench))));
    if let Err(error) = run {
        println!("no window: {error}");
    }
}
