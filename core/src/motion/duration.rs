//! How long a move takes, without ticks: the same laws in closed form.

use super::limits::MotionLimits;
use super::path::Path;
use crate::command::MoveKind;
use crate::units::{Axis, Point};

/// Length of the path of a move, mm (radius); a rapid counts as its chord.
pub fn path_length(kind: MoveKind, from: Point, to: Point, center: Option<Point>) -> f64 {
    match (kind, center) {
        (MoveKind::Clockwise, Some(center)) => Path::arc(from, to, center, true).length(),
        (MoveKind::CounterClockwise, Some(center)) => Path::arc(from, to, center, false).length(),
        _ => (to - from).length(),
    }
}

/// Seconds that a move takes from rest to rest at overrides of 100 %. `feed` in
/// mm/min is used by cuts only; a dwell takes no time here, and a cut without
/// feed never ends.
pub fn duration(
    kind: MoveKind,
    from: Point,
    to: Point,
    center: Option<Point>,
    feed: f64,
    limits: &MotionLimits,
) -> f64 {
    match kind {
        MoveKind::Dwell => 0.0,
        MoveKind::Rapid => {
            let way = to - from;
            let time = |axis| {
                limits
                    .rapid_law(axis)
                    .duration(way.get(axis).abs(), limits.rapid(axis))
            };
            time(Axis::X).max(time(Axis::Z))
        }
        _ => {
            let rate = (feed / 60.0).min(limits.cutting());
            limits
                .cutting_law()
                .duration(path_length(kind, from, to, center), rate)
        }
    }
}
