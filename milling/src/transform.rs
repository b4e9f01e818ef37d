//! G51 and G68: scaling about a point, then rotation about another.

use crate::space::{Axis, Each, Flat, Length, Plane, Position};

/// G51.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scaling {
    /// What stays in place, work coordinates.
    pub(crate) center: Position,
    /// Factors of X, Y and Z; a negative one mirrors. Further axes have none.
    pub(crate) factors: Each<f64>,
}

/// G68.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rotation {
    pub(crate) plane: Plane,
    /// What stays in place, after scaling.
    pub(crate) center: Flat,
    /// Counter-clockwise, as it acts.
    pub(crate) degrees: f64,
    /// The same as programmed.
    pub(crate) programmed: f64,
    /// Where the tool stood at G68, until the first motion: if that is an increment, it is
    /// the centre.
    pub(crate) stood: Option<Flat>,
}

/// Both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Transform {
    pub(crate) scaling: Option<Scaling>,
    pub(crate) rotation: Option<Rotation>,
}

impl Transform {
    /// Whether points stay where they are programmed.
    pub(crate) const fn is_none(&self) -> bool {
        self.scaling.is_none() && self.rotation.is_none()
    }

    /// The factor of an axis.
    pub(crate) fn factor(&self, axis: Axis) -> f64 {
        self.scaling.map_or(1.0, |it| it.factors.get(axis))
    }

    /// Whether a plane is seen in a mirror.
    pub(crate) fn mirrors(&self, plane: Plane) -> bool {
        let [first, second, _] = plane.axes();
        self.factor(first) * self.factor(second) < 0.0
    }

    /// A point after scaling, not yet rotated, mm.
    pub(crate) fn scaled(&self, point: Position) -> [f64; 3] {
        let point = point.mm();
        let Some(Scaling { center, factors }) = self.scaling else {
            return point;
        };
        let center = center.mm();
        core::array::from_fn(|axis| center[axis] + factors.0[axis] * (point[axis] - center[axis]))
    }

    /// A programmed point, where it comes to lie; to the least increment.
    pub(crate) fn apply(&self, point: Position) -> Position {
        if self.is_none() {
            return point;
        }
        let mut mm = self.scaled(point);
        if let Some(rotation) = self.rotation {
            let [first, second, _] = rotation.plane.axes().map(|axis| axis as usize);
            let from = Flat::new(mm[first], mm[second]) - rotation.center;
            let turned = rotation.center + from.turned(rotation.degrees);
            (mm[first], mm[second]) = (turned.first, turned.second);
        }
        point.with_basic(mm.map(|value| Length::from_mm(value).rounded()))
    }

    /// The point that comes to lie at another one.
    pub(crate) fn undo(&self, point: Position) -> Position {
        if self.is_none() {
            return point;
        }
        let mut mm = point.mm();
        if let Some(rotation) = self.rotation {
            let [first, second, _] = rotation.plane.axes().map(|axis| axis as usize);
            let from = Flat::new(mm[first], mm[second]) - rotation.center;
            let turned = rotation.center + from.turned(-rotation.degrees);
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

    /// A way in a plane: from the start of an arc to its centre.
    pub(crate) fn way(&self, plane: Plane, way: Flat) -> Flat {
        let [first, second, _] = plane.axes();
        let way = Flat::new(
            way.first * self.factor(first),
            way.second * self.factor(second),
        );
        match self.rotation {
            Some(rotation) => way.turned(rotation.degrees),
            None => way,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::MillMemory;
    use crate::options;

    #[test]
    fn what_is_undone_was_there() {
        let position = |text: &str| options::position(&MillMemory::default(), text);
        let scaling = Scaling {
            center: position("10,-20,5").expect("point"),
            factors: Each::basic([2.0, -0.5, 1.0], 1.0),
        };
        let rotation = Rotation {
            plane: Plane::Xy,
            center: Flat::new(3.0, 4.0),
            degrees: 33.0,
            programmed: 33.0,
            stood: None,
        };
        let both = Transform {
            scaling: Some(scaling),
            rotation: Some(rotation),
        };
        let point = position("12.345,-6.789,1").expect("point");
        let back = both.undo(both.apply(point));
        // One increment more or less, halved by the scale of Y, and turned.
        assert!(back.distance(&point) < 0.002, "{back:?}");
    }
}
