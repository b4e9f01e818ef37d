//! Computes the centre of a G02 or G03 arc from the words of its block.

use gsk_core::alarm::{Alarm, number};
use gsk_messages::say;

use crate::space::PlanePoint;

/// The words of a block that define an arc's circle, after scaling and rotation, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ArcDefinition {
    /// The arc is given by its radius (word R), mm; negative for an arc over half a turn.
    Radius(f64),
    /// The arc is given by the distance from its start to its centre (words I, J, K), mm.
    Center(PlanePoint),
}

/// Difference up to which two radii count as equal, mm: half an increment.
const RADIUS_TOLERANCE: f64 = 0.000_5;

/// Returns the centre of an arc from `from` to `to`. The end may be off the circle by up to
/// `tolerance`, mm. Errors: alarm 013 if no such arc exists.
pub(crate) fn arc_center(
    from: PlanePoint,
    to: PlanePoint,
    circle: ArcDefinition,
    clockwise: bool,
    tolerance: f64,
) -> Result<PlanePoint, Alarm> {
    let radius = match circle {
        ArcDefinition::Radius(radius) => radius,
        ArcDefinition::Center(to_center) => {
            let center = from + to_center;
            let (start, end) = (to_center.length(), (to - center).length());
            if start < RADIUS_TOLERANCE {
                return Err(arc_data_alarm(say::arc_center_at_start()));
            }
            if (start - end).abs() > tolerance + RADIUS_TOLERANCE {
                return Err(arc_data_alarm(say::mill_arc_off_circle(
                    start, end, tolerance,
                )));
            }
            return Ok(center);
        }
    };
    let chord = to - from;
    let half = chord.length() / 2.0;
    if half < RADIUS_TOLERANCE / 2.0 {
        return Err(arc_data_alarm(say::mill_circle_by_radius()));
    }
    let off = radius * radius - half * half;
    if half > radius.abs() + tolerance.min(RADIUS_TOLERANCE) {
        return Err(arc_data_alarm(say::mill_radius_too_small(
            radius.abs(),
            2.0 * half,
        )));
    }
    let across = libm::sqrt(off.max(0.0)) / (2.0 * half);
    // Left of the chord for the shorter counter-clockwise arc.
    let left = if clockwise == (radius > 0.0) {
        -across
    } else {
        across
    };
    let middle = from + chord.scaled(0.5);
    Ok(middle + PlanePoint::new(-chord.second, chord.first).scaled(left))
}

fn arc_data_alarm(detail: gsk_messages::Message) -> Alarm {
    Alarm::new(number::ARC_DATA).with_detail(detail)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn center_by_radius(radius: f64, clockwise: bool) -> PlanePoint {
        let (from, to) = (PlanePoint::new(0.0, 0.0), PlanePoint::new(10.0, 0.0));
        arc_center(from, to, ArcDefinition::Radius(radius), clockwise, 0.01).expect("centre")
    }

    #[test]
    fn the_lesser_arc_and_the_greater_one() {
        let root = libm::sqrt(75.0);
        for (radius, clockwise, second) in [
            (10.0, true, -root),
            (10.0, false, root),
            (-10.0, true, root),
            (-10.0, false, -root),
        ] {
            let found = center_by_radius(radius, clockwise);
            assert!((found.second - second).abs() < 1e-9, "{radius} {clockwise}");
            assert!((found.first - 5.0).abs() < 1e-9);
        }
        assert!(center_by_radius(5.0, true).second.abs() < 1e-9);
    }

    #[test]
    fn an_invalid_circle_is_refused() {
        let from = PlanePoint::default();
        let refused = |to, circle| arc_center(from, to, circle, true, 0.01).map_err(|it| it.number);
        let far = PlanePoint::new(10.0, 0.0);
        assert_eq!(refused(far, ArcDefinition::Radius(4.9)), Err(13));
        assert_eq!(refused(from, ArcDefinition::Radius(5.0)), Err(13));
        let off = ArcDefinition::Center(PlanePoint::new(4.9, 0.0));
        assert_eq!(refused(far, off), Err(13));
        assert_eq!(
            refused(far, ArcDefinition::Center(PlanePoint::default())),
            Err(13)
        );
        assert!(refused(from, ArcDefinition::Center(PlanePoint::new(5.0, 0.0))).is_ok());
    }
}
