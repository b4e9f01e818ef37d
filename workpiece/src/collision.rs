//! Collisions of a tool: the tool part, the obstacle, the position and the depth.

use gsk_messages::{Message, say};
use gsk_units::Point;

use crate::grid::{from_grid, mm};
use crate::region::Region;
use crate::tool::BodyPart;

/// The part of the tool that collides: its insert or its body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TouchingPart {
    /// The insert touches during a rapid.
    RapidInsert,
    /// The insert touches during a feed move while the spindle stands still.
    StandingInsert,
    /// The insert touches jaws, chuck or tailstock during a feed move while the spindle turns.
    Insert,
    /// A part of the tool that must never touch anything collides: insert back, holder or turret.
    Body(BodyPart),
}

/// The object that the tool collides with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// The stock, or what cutting has left of it.
    Stock,
    /// The jaws of the chuck.
    Jaws,
    /// The body of the chuck.
    Chuck,
    /// The quill of the tailstock or its centre.
    Tailstock,
}

/// A collision of a tool with an obstacle. Points are in part coordinates, X as a radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    /// The part of the tool that collides.
    pub touching_part: TouchingPart,
    /// The object that the tool collides with.
    pub obstacle: Obstacle,
    /// Position of the imaginary tip at the first contact, mm.
    pub tip: Point,
    /// Centre of the area of first contact, mm.
    pub contact: Point,
    /// The greatest depth that the tool reaches in the obstacle during this motion, mm.
    pub depth: f64,
}

impl Collision {
    /// Creates a collision whose overlap is `first` at the first contact and `last` at the end
    /// of the motion, with the imaginary tip at `tip`.
    pub(crate) fn new(
        touching_part: TouchingPart,
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
            touching_part,
            obstacle,
            tip,
            contact,
            depth,
        }
    }

    /// The text for the operator: which part of the tool hits which obstacle.
    pub fn message(&self) -> Message {
        let obstacle = match self.obstacle {
            Obstacle::Stock => say::collision_stock(),
            Obstacle::Jaws => say::collision_jaws(),
            Obstacle::Chuck => say::collision_chuck(),
            Obstacle::Tailstock => say::collision_tailstock(),
        };
        match self.touching_part {
            TouchingPart::RapidInsert => say::collision_rapid(obstacle),
            TouchingPart::StandingInsert => say::collision_standing_spindle(),
            TouchingPart::Insert => say::collision_insert(obstacle),
            TouchingPart::Body(BodyPart::InsertBack) => say::collision_insert_back(obstacle),
            TouchingPart::Body(BodyPart::Holder) => say::collision_holder(obstacle),
            TouchingPart::Body(BodyPart::Turret) => say::collision_turret(obstacle),
        }
    }
}
