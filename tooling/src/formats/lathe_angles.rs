//! Tip numbers and edge angles of this control and of LinuxCNC.
//!
//! LinuxCNC measures front and back angle of an insert from Z+ towards X+.

use gsk_workpiece::tool::{Insert, InsertLetter, Tool};

/// LinuxCNC's orientation by the tip number of this control, from tip 0.
const ORIENTATIONS: [u8; 10] = [9, 4, 3, 2, 1, 5, 8, 7, 6, 9];
/// Greatest difference from the corner angle of a shape that counts as this shape, degrees.
const CORNER_TOLERANCE_DEGREES: f64 = 4.0;

/// LinuxCNC's orientation of a tip number.
pub(super) fn orientation(tip: u8) -> u8 {
    ORIENTATIONS.get(usize::from(tip)).copied().unwrap_or(9)
}

/// The tip number of an orientation of LinuxCNC; 0 for 0 and 9.
pub(super) fn tip_number(orientation: u8) -> u8 {
    let known = ORIENTATIONS.iter().position(|it| *it == orientation);
    known.map_or(0, |tip| tip as u8)
}

/// Front and back angle of a tool, degrees.
pub(super) fn edge_angles(tool: &Tool) -> (f64, f64) {
    let (entering, corner) = match tool.insert {
        Insert::Turning {
            letter, entering, ..
        } => (entering, letter.corner()),
        Insert::Grooving { .. } => (90.0, 90.0),
        Insert::Threading { angle, .. } => ((180.0 - angle) / 2.0, angle),
        Insert::Drill { point, .. } => (90.0, point),
    };
    let half = corner / 2.0;
    match tool.tip {
        1..=4 => {
            let (front, back) = (180.0 - entering, 180.0 - entering - corner);
            let mirror = |angle: f64| {
                let turned = match tool.tip {
                    1 | 4 => 180.0 - angle,
                    _ => angle,
                };
                match tool.tip {
                    1 | 2 => 360.0 - turned,
                    _ => turned,
                }
            };
            (mirror(front), mirror(back))
        }
        5 => (180.0 + half, 180.0 - half),
        6 => (270.0 - half, 270.0 + half),
        8 => (90.0 + half, 90.0 - half),
        _ => (-half, half),
    }
}

/// The shape and the entering angle that front and back angle show at a tip number; `None` if no
/// shape has this corner.
pub(super) fn insert_shape(tip: u8, front: f64, back: f64) -> Option<(InsertLetter, f64)> {
    let corner = libm::fabs(front - back);
    let shapes = [
        InsertLetter::C,
        InsertLetter::D,
        InsertLetter::V,
        InsertLetter::T,
        InsertLetter::S,
    ];
    let difference = |letter: &InsertLetter| libm::fabs(letter.corner() - corner);
    let nearest = shapes
        .into_iter()
        .min_by(|a, b| difference(a).total_cmp(&difference(b)))?;
    if difference(&nearest) > CORNER_TOLERANCE_DEGREES {
        return None;
    }
    let in_first = |angle: f64| {
        let turned = match tip {
            1 | 2 => 360.0 - angle,
            _ => angle,
        };
        match tip {
            1 | 4 => 180.0 - turned,
            _ => turned,
        }
    };
    let entering = match tip {
        1..=4 => 180.0 - in_first(front),
        _ => 90.0,
    };
    Some((nearest, entering.clamp(30.0, 178.0 - nearest.corner())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_units::tip_direction;

    /// Direction of the nose centre from the controlled point by LinuxCNC's orientation, from 1:
    /// X, Z.
    const LINUXCNC_CENTRES: [(f64, f64); 9] = [
        (1.0, -1.0),
        (1.0, 1.0),
        (-1.0, 1.0),
        (-1.0, -1.0),
        (0.0, -1.0),
        (1.0, 0.0),
        (0.0, 1.0),
        (-1.0, 0.0),
        (0.0, 0.0),
    ];

    #[test]
    fn orientations_name_the_same_direction() {
        for tip in 0..=9 {
            let number = orientation(tip);
            let (x, z) = LINUXCNC_CENTRES[usize::from(number) - 1];
            let centre = -tip_direction(tip);
            assert_eq!((centre.x + 0.0, centre.z + 0.0), (x, z), "tip {tip}");
            if tip < 9 {
                assert_eq!(tip_number(number), tip);
            }
        }
    }

    #[test]
    fn angles_are_those_of_the_sample_table_of_linuxcnc() {
        let mut tool = Tool::turning();
        tool.insert = Insert::Turning {
            letter: InsertLetter::T,
            entering: 95.0,
            size: 9.525,
            nose: 0.05,
        };
        for (tip, angles) in [
            (4, (95.0, 155.0)),
            (3, (85.0, 25.0)),
            (2, (275.0, 335.0)),
            (1, (265.0, 205.0)),
            (5, (210.0, 150.0)),
            (8, (120.0, 60.0)),
            (7, (-30.0, 30.0)),
            (6, (240.0, 300.0)),
        ] {
            tool.tip = tip;
            assert_eq!(edge_angles(&tool), angles, "tip {tip}");
            let (letter, entering) = insert_shape(tip, angles.0, angles.1).unwrap();
            let expected = if tip <= 4 { 95.0 } else { 90.0 };
            assert_eq!((letter, entering), (InsertLetter::T, expected), "tip {tip}");
        }
        assert_eq!(insert_shape(3, 90.0, 45.0), None);
    }
}
