//! Derives what moves beside the axes from successive states of the part: chips, the turn of
//! the tool carrier, jaws, and the damage of a crash.

use std::sync::Arc;

use gsk_host::kernel::part::PartView;
use gsk_scene::chips::{ChipFlow, ChipSource};
use gsk_scene::description::{LatheDescription, SceneEffects};
use gsk_scene::effects::tray_y;
use gsk_scene::placement;
use gsk_workpiece::collision::{Obstacle, TouchingPart};
use gsk_workpiece::job::Job;
use gsk_workpiece::region::Region;

/// Speed at which the tool carrier turns, stations per second.
const STATIONS_PER_S: f32 = 2.5;
/// Time in which the jaws open or close, s.
const JAW_TIME_S: f32 = 0.6;
/// Time in which the quill extends or retracts, s.
const QUILL_TIME_S: f32 = 1.2;
/// Time without a change of the part after which a cut has ended, s.
const CUT_END_S: f32 = 0.15;
/// Speed of the spindle above which the eye cannot follow it, r/min: 20 turns per second.
const BLUR_RPM: f64 = 1200.0;
/// Bend of a struck bar per depth of the collision, radians per mm.
const BEND_PER_MM: f64 = 0.02;
/// Least and greatest angle by which a collision bends the bar, radians.
const BEND_RANGE: (f64, f64) = (0.05, 0.13);
/// Direction in which chips leave the cut: to the operator, and upwards.
const CHIP_DIRECTION: [f32; 3] = [-0.15, 0.25, 1.0];
/// Weight of the newest feed in the smoothed feed, 0 to 1.
const FEED_SHARE: f32 = 0.2;

/// Whether the spindle is so fast that its jaws are drawn blurred.
pub fn is_blurred(part: &PartView) -> bool {
    part.spindle_rpm.abs() > BLUR_RPM
}

/// Number of the tool whose insert is broken: by a fault, or in a crash of the tool in use that
/// still stops the lathe. `None` without one.
pub fn broken_tool(part: &PartView) -> Option<u8> {
    let by_insert = |touching: TouchingPart| !matches!(touching, TouchingPart::Body(_));
    let crash = part.crash.filter(|crash| crash.tool == part.tool);
    let crash = crash.filter(|crash| by_insert(crash.collision.touching_part));
    part.fittings.broken_tool.or(crash.map(|crash| crash.tool))
}

/// The bend of the bar by a crash that still stops the lathe, radians.
fn bar_bend(part: &PartView) -> f32 {
    let collision = part.crash.map(|crash| crash.collision);
    let struck = collision.filter(|it| it.obstacle == Obstacle::Stock);
    struck.map_or(0.0, |it| {
        (it.depth * BEND_PER_MM).clamp(BEND_RANGE.0, BEND_RANGE.1) as f32
    })
}

/// Moves a value from 0 to 1, or back, by at most a step.
fn move_to(value: &mut f32, is_on: bool, step: f32) {
    let target = if is_on { 1.0 } else { 0.0 };
    *value += (target - *value).clamp(-step, step);
}

/// State of the cut in the last picture, from which chips are computed.
#[derive(Default)]
struct CutTrack {
    section: Arc<Region>,
    tip: [f64; 2],
    /// Time since the part changed last, s.
    age_s: f32,
    /// Smoothed feed of the cut, mm per turn.
    feed: f32,
}

/// Animates tool carrier, jaws, quill and chips between states of the machine.
#[derive(Default)]
pub struct EffectsAnimation {
    chips: ChipFlow,
    cut: CutTrack,
    job: Option<Arc<Job>>,
    station: usize,
    /// Number of stations that the tool carrier still has to turn.
    stations_left: f32,
    /// Opening of the jaws, 0 (closed) to 1 (open).
    jaw_opening: f32,
    /// Whether the control has extended the quill; else it was set by hand.
    has_extended_quill: bool,
    /// Retraction of the quill, 0 (in the part) to 1.
    quill_retraction: f32,
}

impl EffectsAnimation {
    /// Retraction of the quill, 0 (in the part) to 1.
    pub const fn quill_retraction(&self) -> f32 {
        self.quill_retraction
    }

    /// Returns the opening of the jaws, 0 (closed) to 1 (open).
    pub const fn jaw_opening(&self) -> f32 {
        self.jaw_opening
    }

    /// Moves on to the state of a description that has no effects yet. `face`: Z of the front
    /// of the chuck's body, mm.
    pub fn advance(
        &mut self,
        part: &PartView,
        lathe: &LatheDescription,
        face: f64,
        elapsed_s: f32,
    ) -> SceneEffects {
        let is_new = !self
            .job
            .as_ref()
            .is_some_and(|job| Arc::ptr_eq(job, &part.job));
        if is_new {
            *self = Self {
                job: Some(Arc::clone(&part.job)),
                station: lathe.station,
                jaw_opening: if part.chuck_open { 1.0 } else { 0.0 },
                ..Self::default()
            };
            self.cut.section = Arc::clone(&part.section);
            self.cut.age_s = CUT_END_S;
        }
        self.turn_carrier(lathe, elapsed_s);
        move_to(
            &mut self.jaw_opening,
            part.chuck_open,
            elapsed_s / JAW_TIME_S,
        );
        self.has_extended_quill |= part.tailstock_forward;
        let is_retracted = self.has_extended_quill && !part.tailstock_forward;
        move_to(
            &mut self.quill_retraction,
            is_retracted,
            elapsed_s / QUILL_TIME_S,
        );
        let source = self.track_cut(part, lathe, elapsed_s);
        self.chips.advance(elapsed_s, source.as_ref());
        let mark = |it: &gsk_runner::machining::CollisionFinding| {
            let contact = it.collision.contact;
            [(contact.z - face) as f32, contact.x.abs() as f32]
        };
        SceneEffects {
            chips: self.chips.states(),
            bar_bend: bar_bend(part),
            station_offset: self.stations_left,
            is_spindle_blurred: is_blurred(part),
            marks: part.findings.iter().map(mark).collect(),
            lit_lamps: part.fittings.lit_lamps,
            wheel_detents: part.fittings.wheel_detents,
        }
    }

    fn turn_carrier(&mut self, lathe: &LatheDescription, elapsed_s: f32) {
        let count = lathe.kind.station_count();
        if lathe.station != self.station {
            let turns = (lathe.station + count - self.station % count) % count;
            self.stations_left = (self.stations_left + turns as f32) % count as f32;
            self.station = lathe.station;
        }
        self.stations_left = (self.stations_left - STATIONS_PER_S * elapsed_s).max(0.0);
    }

    /// Returns the source of chips at the current cut; `None` while no tool cuts.
    fn track_cut(
        &mut self,
        part: &PartView,
        lathe: &LatheDescription,
        elapsed_s: f32,
    ) -> Option<ChipSource> {
        let cut = &mut self.cut;
        let has_cut = !Arc::ptr_eq(&cut.section, &part.section);
        cut.section = Arc::clone(&part.section);
        cut.age_s = if has_cut { 0.0 } else { cut.age_s + elapsed_s };
        let tip = [part.tip.x, part.tip.z];
        let distance = (tip[0] - cut.tip[0]).hypot(tip[1] - cut.tip[1]) as f32;
        cut.tip = tip;
        let turns = (part.spindle_rpm.abs() / 60.0) as f32 * elapsed_s;
        if turns <= 0.0 || cut.age_s >= CUT_END_S {
            return None;
        }
        cut.feed += (distance / turns - cut.feed) * FEED_SHARE;
        let radius = part.tip.x.abs();
        let speed = core::f64::consts::TAU * radius * part.spindle_rpm.abs() / 1000.0;
        Some(ChipSource {
            at: placement::tip(lathe),
            away: CHIP_DIRECTION.into(),
            feed: cut.feed,
            speed: speed as f32,
            material: lathe.part.material(),
            tray_y: tray_y(lathe.kind, &lathe.dimensions),
        })
    }
}
