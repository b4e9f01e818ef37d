//! Draws the lathe in space without a window, as one picture or as an animation.

use std::sync::Arc;

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::machine::LatheConfig;
use gsk_core::units::Point;
use gsk_host::kernel::part::{LatheFittings, PartView};
use gsk_plot::{PictureError, PictureSize, encode_animation};
use gsk_runner::curves::RapidRates;
use gsk_runner::machining::Machining;
use gsk_scene::camera::{CameraPreset, OrbitCamera};
use gsk_scene::description::{LatheDescription, SceneTheme};
use gsk_scene::software::{SoftwareQuality, SoftwareRenderer};
use gsk_workpiece::job::Job;
use gsk_workpiece::region::Region;

use super::SceneDescriber;

/// Time from one picture of an animation to the next, ms.
const INTERVAL_MS: u16 = 80;

/// Cuts a part move by move and describes the lathe at evenly spaced times.
pub struct SceneRecorder {
    describer: SceneDescriber,
    job: Arc<Job>,
    rear_tool_post: bool,
    fittings: LatheFittings,
    /// Version of the part and its half section at the last recorded picture.
    section: (Option<u64>, Arc<Region>),
    lathes: Vec<LatheDescription>,
    interval_s: f64,
    frames: usize,
    /// Tool, spindle speed and tip after the last move.
    last: (u8, f64, Point),
}

impl SceneRecorder {
    /// Creates a recorder of a number of pictures during a program of a duration, s.
    pub fn new(machining: &Machining, lathe: &LatheConfig, frames: usize, time_s: f64) -> Self {
        let stock = &machining.job().stock;
        // In front of the part, until the first move.
        let start = Point::new(stock.radius() + 20.0, stock.front() + 20.0);
        Self {
            describer: SceneDescriber::default(),
            job: Arc::new(machining.job().clone()),
            rear_tool_post: lathe.rear_tool_post,
            fittings: LatheFittings {
                construction: lathe.picture.construction,
                steady_rest: lathe.picture.steady_rest,
                // A program runs, without a ladder.
                lit_lamps: [true, false, false],
                wheel_detents: 0,
                broken_tool: None,
            },
            section: (None, Arc::default()),
            lathes: Vec::new(),
            interval_s: time_s / (frames as f64 - 1.0).max(1.0),
            frames,
            last: (1, 0.0, start),
        }
    }

    /// Cuts the part with a move, and describes the lathe at each moment within it.
    pub fn execute_move(
        &mut self,
        machining: &mut Machining,
        executed: &ExecutedMove,
        rates: RapidRates,
    ) {
        let end_s = executed.start_s + executed.duration_s;
        let mut rest = *executed;
        // The last picture shows the end of the program.
        while self.lathes.len() + 1 < self.frames {
            let moment_s = self.lathes.len() as f64 * self.interval_s;
            if moment_s >= end_s {
                break;
            }
            let share = (moment_s - rest.start_s) / (end_s - rest.start_s);
            let at = rest.from + (rest.to - rest.from) * share.clamp(0.0, 1.0);
            if rest.kind == MoveKind::Feed && share > 0.0 {
                let mut done = rest;
                done.to = at;
                done.duration_s = moment_s - rest.start_s;
                rest.from = at;
                rest.start_s = moment_s;
                rest.duration_s = end_s - moment_s;
                machining.execute_move(&done, rates);
            }
            self.last = self.state_at(machining, executed, at);
            self.describe(machining);
        }
        machining.execute_move(&rest, rates);
        self.last = self.state_at(machining, executed, executed.to);
    }

    /// Describes the lathe at the end of the program, and returns the descriptions of all recorded
    /// times.
    pub fn into_lathes(mut self, machining: &Machining) -> Vec<LatheDescription> {
        self.describe(machining);
        self.lathes
    }

    /// Tool, spindle speed and tip at a programmed position of a move.
    fn state_at(
        &self,
        machining: &Machining,
        executed: &ExecutedMove,
        at: Point,
    ) -> (u8, f64, Point) {
        let conditions = &executed.conditions;
        let (tool, frame) = (conditions.tool, conditions.frame);
        // On the way to a machine zero the position relative to the part is unknown.
        let tip = match conditions.unplaced.is_none() {
            true => {
                let slide = at + frame.zero + frame.offset;
                machining.mounting().tip_in_part(tool, slide, &frame)
            }
            false => self.last.2,
        };
        (tool, conditions.rpm, tip)
    }

    fn describe(&mut self, machining: &Machining) {
        let (tool, spindle_rpm, tip) = self.last;
        let part = machining.scene().part();
        if self.section.0 != Some(part.version()) {
            self.section = (Some(part.version()), Arc::new(part.section()));
        }
        let view = PartView {
            alarms: Vec::new(),
            job: Arc::clone(&self.job),
            job_name: None,
            empty_chuck: None,
            section: Arc::clone(&self.section.1),
            // Drawn as rings: the preview has no spindle angle.
            threads: Arc::default(),
            tool,
            tip,
            absolute: tip,
            spindle_rpm,
            coolant: false,
            clamped: true,
            chuck_open: false,
            tailstock_forward: self.job.stock.tailstock.is_some(),
            door_open: false,
            rear_tool_post: self.rear_tool_post,
            fittings: self.fittings,
            findings: machining.findings().to_vec(),
            crash: None,
            block: None,
        };
        let elapsed_s = f32::from(INTERVAL_MS) / 1000.0;
        let lathe = self.describer.describe(&view, SceneTheme::Day, elapsed_s);
        self.lathes.push(lathe);
    }
}

/// Draws the descriptions of the lathe as a picture file: as an animation if there are several.
///
/// # Errors
///
/// The picture cannot be encoded.
pub fn encode_scene(
    lathes: &[LatheDescription],
    preset: CameraPreset,
    size: PictureSize,
) -> Result<Vec<u8>, PictureError> {
    let mut renderer = SoftwareRenderer::default();
    let pixels = [size.width() as usize, size.height() as usize];
    // The camera stands still, unless it follows the tool: all pictures show the same section.
    let fixed: Option<OrbitCamera> = lathes.first().map(|first| preset.camera(first));
    let count = u32::try_from(lathes.len()).unwrap_or(u32::MAX);
    encode_animation(size, count, INTERVAL_MS, |at| {
        let Some((lathe, fixed)) = lathes.get(at as usize).zip(fixed) else {
            return Vec::new();
        };
        let camera = match preset.follows_tool() {
            true => preset.camera(lathe),
            false => fixed,
        };
        let picture = renderer.draw(lathe, &camera, pixels, SoftwareQuality::Thorough);
        picture.pixels
    })
}
