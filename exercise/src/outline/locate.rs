//! Where a dimension is on the outline of a part.

use gsk_core::units::{Diameter, Point};

use super::{OutlinePiece, PieceForm, TaskOutline};
use crate::criterion::{PartDimension, PartSurface};

/// The place of a dimension on the outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DimensionPlace {
    /// Across the cylinder between both z.
    Across {
        /// Radius of the cylinder, mm.
        radius: f64,
        /// Z of its ends, the front first.
        z: (f64, f64),
        /// The surface.
        surface: PartSurface,
    },
    /// From the front of the part to a corner.
    FromFront(Point),
    /// Along a cylinder, from the front end to the back.
    Along(Point, Point),
    /// At a point of the surface, with a leader.
    At(Point),
}

/// Finds a dimension on the outline: its place, and its size if the outline tells it.
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
