//! Computes the shape of moves: the bend of a rapid and the chords of an arc.

use gsk_core::battery::BatteryMemory;
use gsk_core::units::{Axis, Point};
use gsk_workpiece::curve::PlaneArc;

/// Rapid rates of the axes, from which [`rapid_bend`] computes the path of a rapid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RapidRates {
    /// Rate of X, mm/min of radius.
    pub x: f64,
    /// Rate of Z, mm/min.
    pub z: f64,
    /// Whether the model interpolates rapids: both axes then arrive together and the path has
    /// no bend.
    pub straight: bool,
}

impl RapidRates {
    /// Reads the rapid rates from the parameters of a control, and from its model whether
    /// rapids are straight.
    pub fn from_memory(memory: &BatteryMemory) -> Self {
        Self {
            x: memory.parameters.rapid_rate(Axis::X),
            z: memory.parameters.rapid_rate(Axis::Z),
            straight: memory.model.record().are_rapids_straight(),
        }
    }
}

/// The point where a rapid bends. Both axes move at their rates, at 45° if these are equal,
/// until the first arrives; the other then finishes alone. `None` if the path is straight.
pub fn rapid_bend(from: Point, to: Point, rates: RapidRates) -> Option<Point> {
    let distance = to - from;
    let time_x = distance.x.abs() / rates.x.max(1.0);
    let time_z = distance.z.abs() / rates.z.max(1.0);
    if rates.straight || time_x == 0.0 || time_z == 0.0 {
        return None;
    }
    let both = time_x.min(time_z);
    Some(Point::new(
        from.x + distance.x * (both / time_x),
        from.z + distance.z * (both / time_z),
    ))
}

/// The points of an arc after `from`, ending exactly at `to`. The chords between the points
/// deviate from the arc by at most half of `cell_mm`. X of all points is a radius.
pub fn arc_points(
    from: Point,
    to: Point,
    center: Point,
    clockwise: bool,
    cell_mm: f64,
) -> impl Iterator<Item = Point> {
    let arc = PlaneArc::between(from, to, center, clockwise);
    let steps = arc.chord_count(cell_mm / 2.0).max(2);
    (1..=steps).map(move |index| match index == steps {
        true => to,
        false => arc.point_at(f64::from(index) / f64::from(steps)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATES: RapidRates = RapidRates {
        x: 3800.0,
        z: 7600.0,
        straight: false,
    };

    #[test]
    fn arcs_stay_on_their_circle_and_go_the_right_way() {
        let (from, to) = (Point::new(10.0, 0.0), Point::new(0.0, 10.0));
        for (clockwise, sign) in [(true, 1.0), (false, -1.0)] {
            let points: Vec<_> = arc_points(from, to, Point::default(), clockwise, 0.01).collect();
            assert_eq!(points.last(), Some(&to));
            for (index, point) in points.iter().enumerate() {
                assert!((point.length() - 10.0).abs() < 1e-9);
                let before = if index == 0 { from } else { points[index - 1] };
                let chord_height = 10.0 - ((before + *point) * 0.5).length();
                assert!(chord_height <= 0.005 + 1e-9);
            }
            // From the top, clockwise goes to the right.
            assert!(points[0].z * sign > 0.0);
        }
    }

    #[test]
    fn a_rapid_bends_where_the_first_axis_arrives() {
        let bend = rapid_bend(Point::default(), Point::new(10.0, 100.0), RATES);
        assert_eq!(bend, Some(Point::new(10.0, 20.0)));
        assert_eq!(
            rapid_bend(Point::default(), Point::new(0.0, 5.0), RATES),
            None
        );
        let straight = RapidRates {
            straight: true,
            ..RATES
        };
        let to = Point::new(10.0, 100.0);
        assert_eq!(rapid_bend(Point::default(), to, straight), None);
    }
}
