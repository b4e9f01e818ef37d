//! Frames per second of the scene in a window, uncapped: `cargo bench -p gsk980td-scene`. It
//! needs a display. `LIBGL_ALWAYS_SOFTWARE=1` draws with the processor. The stock is that of
//! the sample 04; in each frame the tool cuts, and the outline is made anew.
#![allow(missing_docs, clippy::expect_used)]

use std::sync::{Arc, Mutex};

use eframe::egui;
use gsk_scene::camera::CameraPreset;
use gsk_scene::description::{
    LatheDescription, LatheDimensions, LatheKind, MountedTool, MountedToolForm, TipPosition,
};
use gsk_scene::level::SceneLevel;
use gsk_scene::opengl::renderer::{SceneFigures, SceneRenderer, SceneViewport};
use gsk_scene::part::outline::PartOutline;
use gsk_scene::tool_path::{ToolPath, ToolPathBuilder, ToolPathPiece};
use gsk_units::{Diameter, Point};
use gsk_workpiece::grid::from_grid;
use gsk_workpiece::motion::{MotionKind, ToolMotion};
use gsk_workpiece::scene::{LatheScene, SceneTool};
use gsk_workpiece::stock::{Chuck, Stock};
use gsk_workpiece::tool::{Tool, ToolShape};

/// Size of the picture, points.
const SIZE: [f32; 2] = [1366.0, 768.0];
/// Time of a measurement after the warm-up, s.
const MEASURED_S: f64 = 4.0;
/// Ticks of the processor time that Linux reports, per second.
const CPU_TICKS_PER_S: f64 = 100.0;
/// Points of the long outline, and pieces of the long path.
const OUTLINE_POINTS: u32 = 100_000;
const PATH_PIECES: u32 = 1_000_000;

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Trial {
    /// Half the size, while the tool cuts.
    Cutting,
    /// The full size, while the tool cuts.
    FullSize,
    /// Half the size, while the camera turns, too.
    Orbit,
    /// Half the size; each frame has a new outline of many points, and a long path.
    LongOutline,
    /// No frame is requested.
    Idle,
}

const TRIALS: [Trial; 5] = [
    Trial::Cutting,
    Trial::FullSize,
    Trial::Orbit,
    Trial::LongOutline,
    Trial::Idle,
];

/// The part of the sample 04 in passes along the axis.
struct BenchPart {
    scene: LatheScene,
    tool: SceneTool,
    tip: Point,
    zero: f64,
}

impl BenchPart {
    fn new() -> Self {
        let stock = Stock {
            length: 218.0,
            chuck: Chuck {
                diameter: Diameter(250.0),
                length: 90.0,
                jaws: 30.0,
                jaw_height: 30.0,
            },
            ..Stock::bar(135.0, 178.0, 188.0)
        };
        Self {
            zero: stock.jaw_front() - stock.chuck.jaws,
            scene: LatheScene::new(&stock),
            tool: SceneTool::new(ToolShape::from_tool(&Tool::turning())),
            tip: Point::new(66.0, 180.0),
        }
    }

    /// Cuts for one frame, and returns the outline.
    fn cut(&mut self) -> PartOutline {
        let to = Point::new(self.tip.x + 0.05, self.tip.z - 0.9);
        let motion = ToolMotion {
            from: self.tip,
            to,
            kind: MotionKind::Line,
            turning: true,
            by_hand: false,
        };
        self.scene.move_tool(&self.tool, &motion);
        self.tip = to;
        // The next pass is shorter and deeper.
        if self.tip.z < 20.0 + (66.0 - self.tip.x) {
            self.tip = Point::new(self.tip.x - 12.0, 180.0);
        }
        if self.tip.x < 12.0 {
            *self = Self::new();
        }
        let section = self.scene.part().section();
        let polygons: Vec<Vec<[f32; 2]>> = section
            .contours()
            .iter()
            .map(|contour| {
                let points = contour.iter().map(|point| from_grid(*point));
                points
                    .map(|it| [(it.z - self.zero) as f32, it.x as f32])
                    .collect()
            })
            .collect();
        PartOutline::from_polygons(&polygons, 67.5)
    }
}

struct Bench {
    renderer: Arc<Mutex<(SceneRenderer, SceneFigures)>>,
    kinds: Vec<LatheKind>,
    part: BenchPart,
    path: Arc<ToolPath>,
    trial: usize,
    since: f64,
    cpu_since: f64,
    times: Vec<f64>,
    started: bool,
}

/// A half section whose surface is a fine wave that moves with the time.
fn long_outline(time: f32) -> PartOutline {
    let mut points: Vec<[f32; 2]> = (0..OUTLINE_POINTS)
        .map(|at| {
            let x = at as f32 / OUTLINE_POINTS as f32 * 218.0;
            [
                x,
                50.0 + (x * 0.4 + time).sin() * 6.0 + (x * 90.0).sin() * 0.02,
            ]
        })
        .collect();
    points.extend([[218.0, 0.0], [0.0, 0.0]]);
    points.reverse();
    PartOutline::from_polygons(&[points], 67.5)
}

fn long_path() -> ToolPath {
    let mut builder = ToolPathBuilder::new(300.0);
    let at = |step: u32| {
        let share = step as f32 * 0.001;
        [
            100.0 + share.cos() * 90.0 * (1.0 - step as f32 / PATH_PIECES as f32),
            60.0 + (share * 1.7).sin() * 40.0,
        ]
    };
    for step in 0..PATH_PIECES {
        builder.add(ToolPathPiece {
            ends: [at(step), at(step + 1)],
            color: [90, 180, 255],
        });
    }
    builder.build()
}

/// Time that the processor has spent on this program, s; 0 where it is unknown.
fn cpu_time_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    let fields = after_name.split_whitespace().skip(11).take(2);
    let ticks: f64 = fields.filter_map(|it| it.parse::<f64>().ok()).sum();
    ticks / CPU_TICKS_PER_S
}

impl Bench {
    fn describe(&mut self, kind: LatheKind, time: f32) -> LatheDescription {
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
        let is_long = TRIALS[self.trial] == Trial::LongOutline;
        let part = match TRIALS[self.trial] {
            Trial::LongOutline => long_outline(time),
            Trial::Cutting | Trial::FullSize | Trial::Orbit | Trial::Idle => self.part.cut(),
        };
        let mut lathe = LatheDescription {
            kind,
            dimensions: LatheDimensions {
                bed_length: 800.0,
                centre_height: 205.0,
                chuck_diameter: 250.0,
                chuck_length: 90.0,
                jaw_length: 30.0,
                jaw_height: 30.0,
                ..LatheDimensions::default()
            },
            spindle_angle: time * 8.0,
            jaw_radius: 67.5,
            tip: TipPosition {
                x: (self.part.tip.z - self.part.zero) as f32,
                radius: self.part.tip.x as f32,
            },
            tools: vec![Some(shank.clone()), None, Some(drill), Some(shank)],
            has_coolant: true,
            part: Arc::new(part),
            ..LatheDescription::default()
        };
        lathe.overlay.path = is_long.then(|| Arc::clone(&self.path));
        lathe
    }

    fn begin(&mut self, now: f64) {
        self.times.clear();
        self.since = now;
        self.cpu_since = cpu_time_s();
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
        let lathe = self.describe(kind, now as f32);
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
                is_moving: true,
                level: (trial == Trial::FullSize).then_some(SceneLevel::Full),
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
        let figures = self.renderer.lock().expect("the lock").1;
        let is_warm = figures.triangles > 0 && !figures.is_refining;
        if !self.started {
            ui.ctx().request_repaint();
            self.started = is_warm;
            self.begin(now);
            return;
        }
        self.times.push(now);
        let left_s = MEASURED_S - (now - self.since);
        match trial {
            Trial::Idle if left_s > 0.0 => {
                let wait = std::time::Duration::from_secs_f64(left_s + 0.05);
                ui.ctx().request_repaint_after(wait);
            }
            _ => ui.ctx().request_repaint(),
        }
        if left_s < 0.0 {
            self.report(kind, trial, figures, now);
            self.begin(now);
            self.trial += 1;
            if self.trial == TRIALS.len() {
                (self.trial, self.started) = (0, false);
                self.kinds.remove(0);
            }
        }
    }
}

impl Bench {
    fn report(&self, kind: LatheKind, trial: Trial, figures: SceneFigures, now: f64) {
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
        let measured_s = now - self.since;
        println!(
            "{kind:?} {trial:?}: {:.1} frames/s, p50 {:.1} ms, p95 {:.1} ms, processor {:.0} %, {width}x{height}, {} triangles, {} objects of {:.1} MB, software {}",
            waits.len() as f64 / measured_s,
            at(0.5),
            at(0.95),
            (cpu_time_s() - self.cpu_since) / measured_s * 100.0,
            figures.triangles,
            figures.objects,
            figures.bytes as f64 / 1e6,
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
        part: BenchPart::new(),
        path: Arc::new(long_path()),
        trial: 0,
        since: 0.0,
        cpu_since: 0.0,
        times: Vec::new(),
        started: false,
    };
    let run = eframe::run_native("scene", options, Box::new(|_| Ok(Box::new(bench))));
    if let Err(error) = run {
        println!("no window: {error}");
    }
}
