//! The outline of a drawing as points of a contour form.

use gsk_messages::Message;
use gsk_outline::{ArcFormat, BlockShape, GridEnd, TurnedProfile};

use super::points::{TurnedArc, TurnedOutline, TurnedPoint};
use crate::thousandths::Thousandths;

/// The points of an outline that was found in a drawing: lines and arcs with their ends,
/// rounded to 0.001 mm, and their radii.
///
/// # Errors
/// An arc cannot be written within 0.001 mm, or the outline has too many points.
pub fn outline_of_profile(profile: &TurnedProfile) -> Result<TurnedOutline, Message> {
    let blocks = profile.write_blocks(ArcFormat::RadiusOnly, false)?;
    let point = |end: GridEnd, arc: Option<TurnedArc>| TurnedPoint {
        diameter: Some(Thousandths(end.x)),
        z: Some(Thousandths(end.z)),
        arc,
        ..TurnedPoint::default()
    };
    let first = point(blocks.start, None);
    let rest = blocks.blocks.iter().map(|block| {
        let arc = match block.shape {
            BlockShape::Radius { clockwise, r } => Some(TurnedArc {
                is_clockwise: clockwise,
                radius: Some(Thousandths(r)),
            }),
            // Centres are not written with the words chosen above.
            BlockShape::Line | BlockShape::Center { .. } => None,
        };
        point(block.end, arc)
    });
    TurnedOutline::from_points([first].into_iter().chain(rest).collect())
}
