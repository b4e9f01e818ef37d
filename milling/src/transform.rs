//! Applies G51 and G68: scaling about a point, then rotation about another.

use crate::axes::Axes;
use crate::space::{AxisValues, Length, MillAxis, MillPosition, Plane, PlanePoint};

/// The scaling that is in force (G51): its centre and factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scaling {
    /// Centre of the scaling, which does not move, work coordinates.
    pub(crate) center: MillPosition,
    /// Factors of X, Y and Z. A negative one mirrors. The fourth and fifth axis have 1.
    pub(crate) factors: AxisValues<f64>,
}

/// The rotation that is in force (G68): its centre and angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rotation {
    pub(crate) plane: Plane,
    /// Centre of the rotation, which does not move, mm, after scaling.
    pub(crate) center: PlanePoint,
    /// Angle by which points are rotated, degrees counter-clockwise.
    pub(crate) degrees: f64,
    /// Angle of the rotation as programmed, degrees counter-clockwise.
    pub(crate) programmed: f64,
    /// Tool position at G68, until the first motion; then `None`. If that motion is
    /// incremental, the position is the centre.
    pub(crate) tool_at_start: Option<PlanePoint>,
}

/// The scaling and rotation in force; each is `None` if it is off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Transform {
    pub(crate) scaling: Option<Scaling>,
    pub(crate) rotation: Option<Rotation>,
}

impl Transform {
    /// Returns true if neither scaling nor rotation is in force.
    pub(crate) const fn is_none(&self) -> bool {
        self.scaling.is_none() && self.rotation.is_none()
    }

    /// Returns the factor by which an axis is scaled, 1 without scaling.
    pub(crate) fn factor(&self, axis: MillAxis) -> f64 {
        self.scaling.map_or(1.0, |it| it.factors.get(axis))
    }

    /// Returns whether scaling mirrors a plane, so that arcs change their direction.
    pub(crate) fn mirrors(&self, plane: Plane) -> bool {
        let [first, second, _] = plane.axes();
        self.factor(first) * self.factor(second) < 0.0
    }

    /// Scales a programmed point, without rotating it; returns X, Y and Z, mm.
    pub(crate) fn scaled(&self, point: MillPosition) -> [f64; 3] {
        let point = point.mm();
        let Some(Scaling { center, factors }) = self.scaling else {
            return point;
        };
        let center = center.mm();
        core::array::from_fn(|axis| center[axis] + factors.0[axis] * (point[axis] - center[axis]))
    }

    /// Scales and rotates a programmed point, and rounds it to the least increment of `axes`.
    pub(crate) fn apply(&self, point: MillPosition, axes: &Axes) -> MillPosition {
        if self.is_none() {
            return point;
        }
        let mut mm = self.scaled(point);
        if let Some(rotation) = self.rotation {
            let [first, second, _] = rotation.plane.axes().map(|axis| axis as usize);
            let from = PlanePoint::new(mm[first], mm[second]) - rotation.center;
            let turned = rotation.center + from.rotated(rotation.degrees);
            (mm[first], mm[second]) = (turned.first, turned.second);
        }
        // An axis that neither scaling nor rotation moves keeps its programmed position.
        let rounded = |axis: MillAxis| match Length::from_mm(mm[axis as usize]) {
            value if value == point.get(axis) => value,
            value => axes.rounded(axis, value),
        };
        point.with_basic(MillAxis::BASIC.map(rounded))
    }

    /// Returns the programmed point whose scaled and rotated point is `point`.
    pub(crate) fn undo(&self, point: MillPosition) -> MillPosition {
        if self.is_none() {
            return point;
        }
        let mut mm = point.mm();
        if let Some(rotation) = self.rotation {
            let [first, second, _] = rotation.plane.axes().map(|axis| axis as usize);
            let from = PlanePoint::new(mm[first], mm[second]) - rotation.center;
            let turned = rotation.center + from.rotated(-rotation.degrees);
            (mm[first], mm[second]) = (turned.first, turned.second);
        }
        if let Some(Scaling { center, factors }) = self.scaling {
            let center = center.mm();
            mm = core::array::from_fn(|axis| {
                center[axis] + (mm[axis] - center[axis]) / factors.0[axis]
            });
        }
        point.with_basic(mm.map(Length::from_mm))
    }

    /// Returns a distance in a plane after scaling and rotation, mm: that from the start of an
    /// arc to its centre.
    pub(crate) fn transform_distance(&self, plane: Plane, distance: PlanePoint) -> PlanePoint {
        let [first, second, _] = plane.axes();
        let distance = PlanePoint::new(
            distance.first * self.factor(first),
            distance.second * self.factor(second),
        );
        match self.rotation {
            Some(rotation) => distance.rotated(rotation.degrees),
            None => distance,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::MillMemory;
    use crate::options;

    #[test]
    fn undo_reverses_apply() {
        let position = |text: &str| options::parse_position(&MillMemory::default(), text);
        let scaling = Scaling {
            center: position("10,-20,5").expect("point"),
            factors: AxisValues::basic([2.0, -0.5, 1.0], 1.0),
        };
        let rotation = Rotation {
            plane: Plane::Xy,
            center: PlanePoint::new(3.0, 4.0),
            degrees: 33.0,
            programmed: 33.0,
            tool_at_start: None,
        };
        let both = Transform {
            scaling: Some(scaling),
            rotation: Some(rotation),
        };
        let point = position("12.345,-6.789,1").expect("point");
        let back = both.undo(both.apply(point, &Axes::default()));
        // One increment of rounding, halved by the scale of Y, and rotated.
        assert!(back.distance(&point) < 0.002, "{back:?}");
    }
}
