//! What a tool hit, where, and how deep.

use gsk_messages::{Message, say};
use gsk_units::Point;

use crate::grid::{from_grid, mm};
use crate::region::Region;
use crate::tool::BodyPart;

/// What of the tool touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Toucher {
    /// The insert, in a rapid.
    RapidInsert,
    /// The insert, while the spindle stood.
    StandingInsert,
    /// The insert, in a cut.
    Insert,
    /// What must touch nothing.
    Body(BodyPart),
}

/// What was hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// The stock.
    Stock,
    /// The jaws.
    Jaws,
    /// The chuck.
    Chuck,
    /// The tailstock.
    Tailstock,
}

/// A collision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    /// What of the tool touched.
    pub toucher: Toucher,
    /// What was hit.
    pub obstacle: Obstacle,
    /// Where the tip was at the first touch, part coordinates.
    pub tip: Point,
    /// Where they touched.
    pub contact: Point,
    /// How deep it went in this motion, mm.
    pub depth: f64,
}

impl Collision {
    /// Of the regions that both have in common at the first touch and at the end.
    pub(crate) fn new(
        toucher: Toucher,
        obstacle: Obstacle,
        tip: Point,
        first: &Region,
        last: &Region,
    ) -> Self {
        let contact = first.bounds().map_or(tip, |bounds| {
            (from_grid(bounds.low) + from_grid(bounds.high)) * 0.5
        });
        let depth = last.bounds().map_or(0.0, |bounds| {
            mm((bounds.high.x - bounds.low.x).min(bounds.high.y - bounds.low.y))
        });
        Self {
            toucher,
            obstacle,
            tip,
            contact,
            depth,
        }
    }

    /// What touched what.
    pub fn message(&self) -> Message {
        let obstacle = match self.obstacle {
            Obstacle::Stock => say::collision_stock(),
            Obstacle::Jaws => say::collision_jaws(),
            Obstacle::Chuck => say::collision_chuck(),
            Obstacle::Tailstock => say::collision_tailstock(),
        };
        match self.toucher {
            Toucher::RapidInsert => say::collision_rapid(obstacle),
            Toucher::StandingInsert => say::collision_standing_spindle(),
            Toucher::Insert => say::collision_insert(obstacle),
            Toucher::Body(BodyPart::InsertBack) => say::collision_insert_back(obstacle),
            Toucher::Body(BodyPart::Holder) => say::collision_holder(obstacle),
            Toucher::Body(BodyPart::Turret) => say::collision_turret(obstacle),
        }
    }
}
