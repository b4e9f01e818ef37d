//! The chip along a move through the part in its current state.

use gsk_units::Point;

use super::CuttingChip;
use super::edge_contact::EdgeContact;
use crate::convex::{shrink, sweep};
use crate::grid::{GridContour, GridPoint, to_grid};
use crate::motion::{MotionKind, ToolMotion};
use crate::part::{TurnedPart, with_mirror_image};
use crate::scene::{LatheScene, SceneTool};

/// Distance between two samples of a long move, mm.
const SAMPLE_DISTANCE_MM: f64 = 0.5;
/// Least distance between two samples, mm.
const LEAST_DISTANCE_MM: f64 = 0.1;
/// Number of samples that a move has at the least distance or more.
const SHORT_COUNT: f64 = 6.0;
/// Greatest number of samples of a move.
const MAX_COUNT: f64 = 64.0;
/// Share of the way to a sample of an arc up to which the part is cut before it.
const SHARE_BEFORE_TIP: f64 = 0.98;
/// Greatest number of passes of a thread's groove that are sampled.
const MAX_GROOVES: usize = 16;
/// Amount by which the edge of a thread is moved inwards, grid units, so that a flank that slides
/// along the groove of the last pass does not count.
const FLANK_CLEARANCE_UNITS: i32 = 10;

/// The chip at one position of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChipSample {
    /// Position on the move: 0 is its start, 1 its end.
    pub share: f64,
    /// The cross-section of the chip of one cutting edge.
    pub chip: CuttingChip,
    /// Greatest radius of the cut, mm.
    pub outer_radius_mm: f64,
    /// Least radius of the cut, mm.
    pub inner_radius_mm: f64,
    /// Mean radius of the cut, mm.
    pub mean_radius_mm: f64,
    /// Direction of the feed, of length 1.
    pub feed: Point,
    /// Mean direction from the edge into the material, of length 1 for a straight edge.
    pub into_material: Point,
    /// Z of the tip, mm.
    pub tip_z: f64,
}

impl ChipSample {
    fn new(contact: &EdgeContact, area_mm2: f64, (tip, feed): (Point, Point), share: f64) -> Self {
        Self {
            share,
            chip: CuttingChip {
                area_mm2,
                width_mm: contact.edge_mm,
            },
            outer_radius_mm: contact.outer_radius_mm,
            inner_radius_mm: contact.inner_radius_mm,
            mean_radius_mm: contact.mean_radius_mm,
            feed,
            into_material: contact.into_material,
            tip_z: tip.z,
        }
    }
}

impl LatheScene {
    /// The chips along a feed move or a thread, with a feed per revolution of each cutting edge,
    /// mm. The part is not changed. A rapid has none.
    pub fn chip_samples(
        &self,
        tool: &SceneTool,
        motion: &ToolMotion,
        feed_mm: f64,
    ) -> Vec<ChipSample> {
        let polygon = &tool.shape().cutting;
        match &motion.kind {
            MotionKind::Rapid => Vec::new(),
            MotionKind::Thread(grooves) => thread_samples(self.part(), polygon, motion, grooves),
            MotionKind::Line => {
                let points = sample_points(motion);
                let count = (points.len() - 1) as f64;
                let pieces = points.windows(2).enumerate();
                pieces
                    .filter_map(|(index, pair)| {
                        let share = (index as f64 + 0.5) / count;
                        let (tip, feed) = (motion.point_at(share), (pair[1] - pair[0]).unit()?);
                        sample_feed(self.part(), polygon, (tip, feed), feed_mm, share)
                    })
                    .collect()
            }
            MotionKind::Arc { .. } => self.arc_samples(polygon, motion, feed_mm),
        }
    }

    /// The chips along an arc, which may pass where an earlier piece of it has cut.
    fn arc_samples(
        &self,
        polygon: &[GridPoint],
        motion: &ToolMotion,
        feed_mm: f64,
    ) -> Vec<ChipSample> {
        let points = sample_points(motion);
        let count = (points.len() - 1) as f64;
        let mut part = self.part().clone();
        let mut samples = Vec::new();
        for (index, pair) in points.windows(2).enumerate() {
            let share = (index as f64 + 0.5) / count;
            let tip = motion.point_at(share);
            // The edge at the tip must not be the border of what is cut.
            let before = pair[0] + (tip - pair[0]) * SHARE_BEFORE_TIP;
            part.cut(polygon, pair[0], before);
            if let Some(feed) = (pair[1] - pair[0]).unit() {
                samples.extend(sample_feed(&part, polygon, (tip, feed), feed_mm, share));
            }
            part.cut(polygon, before, tip);
            part.cut(polygon, tip, pair[1]);
        }
        samples
    }
}

/// Points along a move at equal distances, mm.
fn sample_points(motion: &ToolMotion) -> Vec<Point> {
    let length = motion.length();
    let short = (length / LEAST_DISTANCE_MM).min(SHORT_COUNT);
    let count = libm::ceil((length / SAMPLE_DISTANCE_MM).max(short)).clamp(1.0, MAX_COUNT);
    (0..=count as u32)
        .map(|index| motion.point_at(f64::from(index) / count))
        .collect()
}

/// The chip with the tip of the tool at a position and a direction of the feed; `None` without
/// contact.
fn sample_feed(
    part: &TurnedPart,
    polygon: &[GridPoint],
    (tip, feed): (Point, Point),
    feed_mm: f64,
    share: f64,
) -> Option<ChipSample> {
    let contact = EdgeContact::measure(part, polygon, tip, Some(feed));
    let area_mm2 = contact.across_mm * feed_mm;
    (contact.across_mm > 0.0).then(|| ChipSample::new(&contact, area_mm2, (tip, feed), share))
}

/// The chips of a thread pass: what its grooves remove in the drawn plane.
fn thread_samples(
    part: &TurnedPart,
    polygon: &[GridPoint],
    motion: &ToolMotion,
    grooves: &[Point],
) -> Vec<ChipSample> {
    let edge: GridContour = shrink(polygon, FLANK_CLEARANCE_UNITS);
    let length = (motion.to - motion.from).length();
    let feed = (motion.to - motion.from).unit().unwrap_or_default();
    let step = grooves.len().div_ceil(MAX_GROOVES).max(1);
    let sample = |tip: &Point| {
        let at = to_grid(*tip);
        let removed = part.intersection(&with_mirror_image(sweep(polygon, at, at)));
        let contact = EdgeContact::measure(part, &edge, *tip, None);
        let is_cut = !removed.is_empty() && contact.edge_mm > 0.0;
        let share = match length > 0.0 {
            true => (*tip - motion.from).length() / length,
            false => 0.0,
        };
        is_cut.then(|| ChipSample::new(&contact, removed.area(), (*tip, feed), share))
    };
    grooves.iter().step_by(step).filter_map(sample).collect()
}
