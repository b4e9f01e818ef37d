//! Where a dimension is on the outline of a part.

use gsk_core::units::{Diameter, Point};

use super::{OutlinePiece, PieceForm, TaskOutline};
use crate::criterion::{PartDimension, PartSurface};

/// The position of a dimension on the outline, which determines how it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DimensionPlace {
    /// A diameter, drawn across the cylinder between both z.
    Across {
        /// Radius of the cylinder, mm.
        radius: f64,
        /// Z of both ends of the cylinder, mm, the front end first.
        z: (f64, f64),
        /// Whether the outside or the bore is dimensioned.
        surface: PartSurface,
    },
    /// A length from the front of the part to a corner.
    FromFront(Point),
    /// A length along a cylinder, from its front end to its back end.
    Along(Point, Point),
    /// A dimension at a point of the surface, drawn with a leader.
    At(Point),
}

/// Finds the position of a dimension on the outline; `None` if the outline does not have it. Also
/// returns its size, if the outline determines it.
pub fn locate(
    outline: &TaskOutline,
    dimension: &PartDimension,
) -> Option<(DimensionPlace, Option<f64>)> {
    let at = |surface: PartSurface, z: f64| {
        let pieces = outline.pieces(surface).iter();
        pieces
            .filter(|piece| !piece.is_face())
            .find(|piece| (piece.to.z..=piece.from.z).contains(&z))
    };
    match *dimension {
        PartDimension::Diameter { z, surface } => {
            let piece = at(surface, z).filter(|piece| piece.is_cylinder())?;
            let place = DimensionPlace::Across {
                radius: piece.from.x,
                z: (piece.from.z, piece.to.z),
                surface,
            };
            Some((place, Some(piece.from.diameter().0)))
        }
        PartDimension::Width { z, surface } => {
            let piece = at(surface, z).filter(|piece| piece.is_cylinder())?;
            let place = DimensionPlace::Along(piece.from, piece.to);
            Some((place, Some(piece.from.z - piece.to.z)))
        }
        PartDimension::Length { diameter, surface } => {
            let radius = Diameter(diameter).radius();
            let crosses = |piece: &&OutlinePiece| {
                let (low, high) = (piece.from.x.min(piece.to.x), piece.from.x.max(piece.to.x));
                piece.is_face() && piece.from.z < 0.0 && (low..=high).contains(&radius)
            };
            let face = outline.pieces(surface).iter().find(crosses)?;
            let outer = match face.from.x > face.to.x {
                true => face.from,
                false => face.to,
            };
            Some((DimensionPlace::FromFront(outer), Some(-face.from.z)))
        }
        PartDimension::Angle { z, surface } => {
            let piece = at(surface, z).filter(|piece| piece.form == PieceForm::Line)?;
            let along = piece.to - piece.from;
            let angle = along.x.abs().atan2(along.z.abs()).to_degrees();
            Some((DimensionPlace::At(piece.middle(surface)), Some(angle)))
        }
        PartDimension::Radius { z, surface } => {
            let piece = at(surface, z)?;
            match piece.form {
                PieceForm::Arc(radius) => {
                    Some((DimensionPlace::At(piece.middle(surface)), Some(radius)))
                }
                _ => None,
            }
        }
        PartDimension::Pitch { z, surface } => {
            let piece = at(surface, z)?;
            match piece.form {
                PieceForm::Thread(pitch) => {
                    Some((DimensionPlace::At(piece.middle(surface)), Some(pitch)))
                }
                _ => None,
            }
        }
        PartDimension::ThreadDepth { z, surface } => {
            let piece = at(surface, z)?;
            let is_thread = matches!(piece.form, PieceForm::Thread(_));
            is_thread.then(|| (DimensionPlace::At(piece.middle(surface)), None))
        }
    }
}
