//! Frames per second of the scene in a window, uncapped: `cargo bench -p gsk980td-scene`. It
//! needs a display. `LIBGL_ALWAYS_SOFTWARE=1` draws with the processor.
#![allow(missing_docs, clippy::expect_used)]

use std::sync::{Arc, Mutex};

use eframe::egui;
use gsk_scene::camera::CameraPreset;
use gsk_scene::description::{
    LatheDescription, LatheKind, MountedTool, MountedToolForm, TipPosition,
};
use gsk_scene::part_outline::PartOutline;
use gsk_scene::renderer::{SceneFigures, SceneRenderer, SceneViewport};

/// Size of the picture, points.
const SIZE: [f32; 2] = [1366.0, 768.0];
/// Time of a measurement after the warm-up, s.
const MEASURED_S: f64 = 4.0;

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Trial {
    /// Half the size, while the tool cuts.
    Cutting,
    /// The full size, while the tool cuts.
    FullSize,
    /// Half the size, while the camera turns, too.
    Orbit,
}

const TRIALS: [Trial; 3] = [Trial::Cutting, Trial::FullSize, Trial::Orbit];

struct Bench {
    renderer: Arc<Mutex<(SceneRenderer, SceneFigures)>>,
    kinds: Vec<LatheKind>,
    trial: usize,
    since: f64,
    times: Vec<f64>,
    started: bool,
}

fn describe(kind: LatheKind, time: f32) -> LatheDescription {
    let at = (time * 0.35).sin() * 40.0 + 90.0;
    let steps = [
        (-30.0, 0.0),
        (150.0, 0.0),
        (150.0, 18.0),
        (at, 22.0),
        (at, 30.0),
        (-30.0, 30.0),
    ];
    let polygon: Vec<[f32; 2]> = steps.iter().map(|&(x, r)| [x, r]).collect();
    let shank = MountedTool {
        form: MountedToolForm::Shank,
        insert: vec![vec![[0.0, 0.0], [12.5, 1.5], [14.0, 13.0], [1.0, 11.5]]],
        holder: vec![vec![[1.0, 5.0], [21.0, 9.0], [21.0, 60.0], [1.0, 60.0]]],
    };
    let drill = MountedTool {
        form: MountedToolForm::Drill {
            diameter: 12.0,
            point: 118.0,
            reach: 80.0,
        },
        insert: vec![],
        holder: vec![],
    };
    LatheDescription {
        kind,
        spindle_angle: time * 8.0,
        jaw_radius: 30.0,
        tip: TipPosition {
            x: at,
            radius: 22.0,
        },
        tools: vec![Some(shank.clone()), None, Some(drill), Some(shank)],
        has_coolant: true,
        part: Arc::new(PartOutline::from_polygons(&[polygon], 30.0)),
        ..LatheDescription::default()
    }
}

impl eframe::App for Bench {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        let now = ui.input(|input| input.time);
        let Some(&kind) = self.kinds.first() else {
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
            return;
        };
        let trial = TRIALS[self.trial];
        let lathe = describe(kind, now as f32);
        let mut camera = CameraPreset::Operator.camera(&lathe);
        if trial == Trial::Orbit {
            camera.orbit([(now as f32 * 0.8).sin() * 60.0, 0.0].into());
        }
        let shared = Arc::clone(&self.renderer);
        let rect = ui.max_rect();
        let callback = eframe::egui_glow::CallbackFn::new(move |info, painter| {
            let place = info.viewport_in_pixels();
            let viewport = SceneViewport {
                pixels: [
                    place.left_px,
                    place.from_bottom_px,
                    place.width_px,
                    place.height_px,
                ],
                output: painter.intermediate_fbo(),
                is_moving: trial != Trial::FullSize,
                level: None,
            };
            let mut shared = shared.lock().expect("the lock");
            let (renderer, figures) = &mut *shared;
            *figures = renderer
                .paint(painter.gl(), &lathe, &camera, viewport)
                .expect("a picture");
        });
        ui.painter().add(egui::PaintCallback {
            rect,
            callback: Arc::new(callback),
        });
        ui.ctx().request_repaint();
        let figures = self.renderer.lock().expect("the lock").1;
        let is_warm = figures.triangles > 0 && !figures.is_refining;
        if !self.started {
            self.started = is_warm;
            self.since = now;
            self.times.clear();
            return;
        }
        self.times.push(now);
        if now - self.since > MEASURED_S {
            self.report(kind, trial, figures);
            self.times.clear();
            self.since = now;
            self.trial += 1;
            if self.trial == TRIALS.len() {
                (self.trial, self.started) = (0, false);
                self.kinds.remove(0);
            }
        }
    }
}

impl Bench {
    fn report(&self, kind: LatheKind, trial: Trial, figures: SceneFigures) {
        let mut waits: Vec<f64> = self
            .times
            .windows(2)
            .map(|it| (it[1] - it[0]) * 1e3)
            .collect();
        waits.sort_by(f64::total_cmp);
        let at = |share: f64| {
            waits
                .get((waits.len() as f64 * share) as usize)
                .copied()
                .unwrap_or(0.0)
        };
        let [width, height] = figures.size;
        println!(
            "{kind:?} {trial:?}: {:.1} frames/s, p50 {:.1} ms, p95 {:.1} ms, {width}x{height}, {} triangles, software {}",
            waits.len() as f64 / MEASURED_S,
            at(0.5),
            at(0.95),
            figures.triangles,
            figures.is_software,
        );
    }
}

fn main() {
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_inner_size(SIZE)
            .with_position([0.0, 0.0]),
        glow_options: eframe::egui_glow::GlowConfiguration {
            vsync: false,
            ..Default::default()
        },
        ..Default::default()
    };
    let bench = Bench {
        renderer: Arc::default(),
        kinds: vec![LatheKind::FlatBed, LatheKind::SlantBed, LatheKind::Bench],
        trial: 0,
        since: 0.0,
        times: Vec::new(),
        started: false,
    };
    let run = eframe::run_native("scene", options, Box::new(|_| Ok(Box::new(bench))));
    if let Err(error) = run {
        println!("no window: {error}");
    }
}
