//! Moves tools through the part and its clamping: removes material, reports collisions.

use gsk_units::Point;

use crate::collision::{Collision, Obstacle, TouchingPart};
use crate::convex::{shrink, sweep, sweep_along};
use crate::grid::{GridContour, GridPoint, from_grid, to_grid};
use crate::motion::{MotionKind, ToolMotion};
use crate::part::{RemovedMaterial, TurnedPart, with_mirror_image};
use crate::region::{GridBounds, Region};
use crate::stock::Stock;
use crate::tool::ToolShape;

/// Depth up to which an overlap is no collision, grid units: 5 µm. Surfaces slide along each
/// other, and circles are approximated by chords.
const CLEARANCE_UNITS: i32 = 50;

/// The objects around the tool: part, chuck, jaws and tailstock, with the effect of tool motions on
/// them.
#[derive(Clone, Debug)]
pub struct LatheScene {
    stock: Stock,
    part: TurnedPart,
    obstacles: Vec<(Obstacle, Region, GridBounds)>,
    /// The end of the last thread pass. The tool is in the groove that it cut there, but the
    /// drawn half plane shows the groove at another Z. `None` after any other move.
    thread_end: Option<Point>,
}

/// The effect of one move: the material that it removes and its first collision.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MotionEffect {
    /// Amount of material that the motion removed.
    pub removed: RemovedMaterial,
    /// The first collision of the insert, or of the tool body if the insert has none; `None`
    /// without a collision.
    pub collision: Option<Collision>,
}

/// The stock that overlaps a tool at positions where the tool must not cut.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Intrusion {
    /// Stock that overlaps the insert during a rapid.
    pub insert: Region,
    /// Stock that overlaps the tool body: insert back, holder, turret.
    pub body: Region,
}

/// A tool shape with the contours that the collision check uses.
#[derive(Clone, Debug)]
pub struct SceneTool {
    shape: ToolShape,
    /// The polygon of the cutting part, reduced by the clearance.
    insert: GridContour,
    /// The polygons of the other parts of the tool, reduced by the clearance.
    body: Vec<(TouchingPart, GridContour)>,
}

impl SceneTool {
    /// Prepares a tool shape for the collision check.
    pub fn new(shape: ToolShape) -> Self {
        let insert = shrink(&shape.cutting, CLEARANCE_UNITS);
        let body = shape
            .body
            .iter()
            .map(|(part, contour)| (TouchingPart::Body(*part), shrink(contour, CLEARANCE_UNITS)))
            .collect();
        Self {
            shape,
            insert,
            body,
        }
    }

    /// Returns the full shape of the tool, without clearance.
    pub const fn shape(&self) -> &ToolShape {
        &self.shape
    }
}

impl LatheScene {
    /// Creates a scene with uncut stock in its chuck.
    pub fn new(stock: &Stock) -> Self {
        let (body, jaws) = stock.chuck_section();
        let obstacles = [
            (Obstacle::Jaws, jaws),
            (Obstacle::Chuck, body),
            (Obstacle::Tailstock, stock.tailstock_section()),
        ];
        Self {
            stock: stock.clone(),
            part: TurnedPart::new(&stock.section()),
            obstacles: obstacles
                .into_iter()
                .filter_map(|(obstacle, region)| {
                    let bounds = region.bounds()?;
                    Some((obstacle, region, bounds))
                })
                .collect(),
            thread_end: None,
        }
    }

    /// Returns the stock before the first cut.
    pub const fn stock(&self) -> &Stock {
        &self.stock
    }

    /// Returns the part in its current state.
    pub const fn part(&self) -> &TurnedPart {
        &self.part
    }

    /// Removes and returns the pieces of the part that are cut off, that is, not held by the
    /// jaws.
    pub fn drop_loose_pieces(&mut self) -> Vec<Region> {
        self.part.drop_loose_pieces(self.stock.jaw_front())
    }

    /// Moves a tool: removes the material that its insert sweeps and returns the amount with
    /// the first collision. A move with a collision removes material, too.
    pub fn move_tool(&mut self, tool: &SceneTool, motion: &ToolMotion) -> MotionEffect {
        let path = motion.path();
        let mut effect = MotionEffect {
            collision: self.find_insert_collision(tool, motion, &path),
            removed: RemovedMaterial::default(),
        };
        effect.removed = cut(&mut self.part, tool, motion, &path);
        self.thread_end = match motion.kind {
            MotionKind::Thread(_) => Some(motion.to),
            _ => None,
        };
        effect.collision = effect
            .collision
            .or_else(|| self.find_body_collision(tool, motion));
        effect
    }

    /// Returns the part that a motion of a tool would leave.
    pub fn part_after(&self, tool: &SceneTool, motion: &ToolMotion) -> TurnedPart {
        let mut part = self.part.clone();
        cut(&mut part, tool, motion, &motion.path());
        part
    }

    /// Finds the first collision of a tool whose insert is broken: of its body. It cuts nothing.
    pub fn find_body_collision(&self, tool: &SceneTool, motion: &ToolMotion) -> Option<Collision> {
        let path = motion.path();
        let mut body = tool.body.iter();
        body.find_map(|(touching_part, contour)| {
            self.find_collision(*touching_part, contour, motion, &path, Some(&[]))
        })
    }

    /// Moves a tool through stock of unknown size. If the program is right, there is no stock
    /// where the tool must not cut. This function removes such stock and the cut, and returns
    /// the stock that overlapped.
    pub fn intrude(&mut self, tool: &SceneTool, motion: &ToolMotion) -> Intrusion {
        let path = motion.path();
        let swept = |contour: &[GridPoint]| with_mirror_image(sweep_along(contour, &path));
        let mut intrusion = Intrusion::default();
        if matches!(motion.kind, MotionKind::Rapid) {
            let overlap = self.part.intersection(&swept(&tool.insert));
            let thread_end = self.thread_end.filter(|end| *end == motion.from);
            intrusion.insert = match thread_end {
                Some(end) => {
                    let groove = sweep(&tool.shape.cutting, to_grid(end), to_grid(end));
                    overlap.difference(&[groove])
                }
                None => overlap,
            };
        }
        self.part.remove(intrusion.insert.contours());
        self.thread_end = None;
        match &motion.kind {
            MotionKind::Rapid => {}
            MotionKind::Thread(imprints) => {
                for position in imprints {
                    self.part
                        .cut_along(&tool.shape.cutting, &[to_grid(*position)]);
                }
                self.thread_end = Some(motion.to);
            }
            MotionKind::Line | MotionKind::Arc { .. } => {
                self.part.cut_along(&tool.shape.cutting, &path);
            }
        }
        for (_, contour) in &tool.body {
            let overlap = self.part.intersection(&swept(contour));
            if !overlap.is_empty() {
                self.part.remove(overlap.contours());
                intrusion.body = intrusion.body.union(overlap.contours());
            }
        }
        intrusion
    }

    /// Finds the first collision of the insert on a path; `None` if it hits nothing. Contact
    /// with the stock is a collision only in a rapid or with a stopped spindle.
    fn find_insert_collision(
        &self,
        tool: &SceneTool,
        motion: &ToolMotion,
        path: &[GridPoint],
    ) -> Option<Collision> {
        let (touching_part, checks_stock) = match motion.kind {
            MotionKind::Rapid => (TouchingPart::RapidInsert, true),
            _ if !motion.turning => (TouchingPart::StandingInsert, true),
            _ => (TouchingPart::Insert, false),
        };
        let thread_end = self.thread_end.filter(|end| *end == motion.from);
        let groove: Vec<GridContour> = thread_end
            .map(|end| sweep(&tool.shape.cutting, to_grid(end), to_grid(end)))
            .into_iter()
            .collect();
        let free = checks_stock.then_some(&groove[..]);
        self.find_collision(touching_part, &tool.insert, motion, path, free)
    }

    /// Finds the first obstacle that a contour meets on a path; `None` if it meets none. With
    /// `free` the stock is an obstacle, too, except within the contours of `free`: the groove
    /// in which the tool is. A move by hand out of an obstacle is none.
    fn find_collision(
        &self,
        touching_part: TouchingPart,
        contour: &[GridPoint],
        motion: &ToolMotion,
        path: &[GridPoint],
        free: Option<&[GridContour]>,
    ) -> Option<Collision> {
        let swept = with_mirror_image(sweep_along(contour, path));
        let bounds = GridBounds::from_points(swept.iter().flatten())?;
        let stock_overlap = |swept: &[GridContour]| {
            let overlap = self.part.intersection(swept);
            match free {
                Some(free) if !free.is_empty() => overlap.difference(free),
                _ => overlap,
            }
        };
        let leaves = |overlap: &dyn Fn(&[GridContour]) -> Region| {
            motion.by_hand && does_leave(contour, path, overlap)
        };
        if free.is_some() && !stock_overlap(&swept).is_empty() && !leaves(&stock_overlap) {
            return Some(locate_first_contact(
                (touching_part, Obstacle::Stock),
                contour,
                path,
                &stock_overlap,
            ));
        }
        self.obstacles
            .iter()
            .filter(|(_, _, obstacle)| obstacle.intersects(&bounds))
            .find(|(_, region, _)| {
                let overlap = |swept: &[GridContour]| region.intersection(swept);
                !overlap(&swept).is_empty() && !leaves(&overlap)
            })
            .map(|(obstacle, region, _)| {
                let overlap = |swept: &[GridContour]| region.intersection(swept);
                locate_first_contact((touching_part, *obstacle), contour, path, &overlap)
            })
    }
}

/// Whether a contour is in an obstacle at the start of a path and no deeper at its end: the way
/// out after a crash. `overlap` intersects the obstacle with a swept area.
fn does_leave(
    contour: &[GridPoint],
    path: &[GridPoint],
    overlap: &dyn Fn(&[GridContour]) -> Region,
) -> bool {
    let area = |place: Option<&GridPoint>| {
        let contours = place.map(|place| sweep_along(contour, &[*place]));
        contours.map_or(0.0, |contours| overlap(&with_mirror_image(contours)).area())
    };
    let start = area(path.first());
    start > 0.0 && area(path.last()) <= start
}

/// Locates the first contact with an obstacle on a path that has one, to a thousandth of a
/// line of the path. `overlap` intersects the obstacle with a swept area.
fn locate_first_contact(
    (touching_part, obstacle): (TouchingPart, Obstacle),
    contour: &[GridPoint],
    path: &[GridPoint],
    overlap: &dyn Fn(&[GridContour]) -> Region,
) -> Collision {
    const HALVINGS: u32 = 10;
    let along = |path: &[GridPoint]| overlap(&with_mirror_image(sweep_along(contour, path)));
    // The first line of the path with a contact.
    let (mut clear, mut touching) = (0, path.len().saturating_sub(1));
    while touching > clear + 1 {
        let middle = usize::midpoint(clear, touching);
        if along(&path[..=middle]).is_empty() {
            clear = middle;
        } else {
            touching = middle;
        }
    }
    let (from, to) = (path[clear], path[touching]);
    let at = |share: f64| {
        let between = |from: i32, to: i32| {
            let distance = f64::from(to) - f64::from(from);
            from.saturating_add(libm::round(distance * share) as i32)
        };
        GridPoint::new(between(from.x, to.x), between(from.y, to.y))
    };
    let until = |share: f64| along(&[from, at(share)]);
    let (mut clear, mut touching) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = (clear + touching) / 2.0;
        if until(middle).is_empty() {
            clear = middle;
        } else {
            touching = middle;
        }
    }
    let (contact, whole) = (until(touching), along(path));
    Collision::new(
        touching_part,
        obstacle,
        from_grid(at(touching)),
        &contact,
        &whole,
    )
}

/// Cuts a part with a motion of a tool along `path`. A thread is cut at the positions at which the
/// spindle passes the drawn plane.
fn cut(
    part: &mut TurnedPart,
    tool: &SceneTool,
    motion: &ToolMotion,
    path: &[GridPoint],
) -> RemovedMaterial {
    let MotionKind::Thread(imprints) = &motion.kind else {
        return part.cut_along(&tool.shape.cutting, path);
    };
    let mut removed = RemovedMaterial::default();
    for position in imprints {
        removed.add(part.cut_along(&tool.shape.cutting, &[to_grid(*position)]));
    }
    removed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tool::{BodyPart, Tool};

    fn scene() -> LatheScene {
        LatheScene::new(&Stock::bar(50.0, 0.0, 60.0))
    }

    fn motion(kind: MotionKind, from: (f64, f64), to: (f64, f64)) -> ToolMotion {
        ToolMotion {
            from: Point::new(from.0, from.1),
            to: Point::new(to.0, to.1),
            kind,
            turning: true,
            by_hand: false,
        }
    }

    fn turning() -> SceneTool {
        SceneTool::new(ToolShape::from_tool(&Tool::turning()))
    }

    #[test]
    fn a_rapid_through_the_stock_is_a_collision_at_the_first_contact() {
        let mut scene = scene();
        let rapid = motion(MotionKind::Rapid, (20.0, 5.0), (20.0, -10.0));
        let collision = scene.move_tool(&turning(), &rapid).collision.unwrap();
        assert_eq!(
            (collision.touching_part, collision.obstacle),
            (TouchingPart::RapidInsert, Obstacle::Stock)
        );
        assert!(collision.tip.z.abs() < 0.05, "{collision:?}");
        assert!((collision.depth - 5.0).abs() < 0.02, "{collision:?}");
    }

    #[test]
    fn a_rapid_along_the_surface_is_no_collision() {
        let mut scene = scene();
        for (from, to) in [
            ((25.0, 5.0), (25.0, -40.0)),
            ((25.0, -40.0), (60.0, 60.0)),
            ((60.0, 60.0), (25.0, 0.0)),
            ((25.0, 0.0), (0.0, 0.0)),
        ] {
            let effect = scene.move_tool(&turning(), &motion(MotionKind::Rapid, from, to));
            assert_eq!(effect, MotionEffect::default(), "{from:?} {to:?}");
        }
    }

    #[test]
    fn a_feed_move_with_a_stopped_spindle_is_a_collision() {
        let mut scene = scene();
        let mut cut = motion(MotionKind::Line, (20.0, 1.0), (20.0, -5.0));
        cut.turning = false;
        let collision = scene.move_tool(&turning(), &cut).collision.unwrap();
        assert_eq!(collision.touching_part, TouchingPart::StandingInsert);
    }

    #[test]
    fn a_cut_into_the_jaws_is_a_collision() {
        let mut scene = scene();
        let cut = motion(MotionKind::Line, (24.0, 1.0), (24.0, -70.0));
        let collision = scene.move_tool(&turning(), &cut).collision.unwrap();
        assert_eq!(
            (collision.touching_part, collision.obstacle),
            (TouchingPart::Insert, Obstacle::Jaws)
        );
        assert!((collision.tip.z + 60.0).abs() < 0.1, "{collision:?}");
    }

    #[test]
    fn a_hand_leads_the_tool_out_of_the_jaws_and_no_deeper_in() {
        let mut scene = scene();
        let by_hand = |from, to, turning| ToolMotion {
            turning,
            by_hand: true,
            ..motion(MotionKind::Line, from, to)
        };
        let tool = turning();
        let mut moves = |from, to| scene.move_tool(&tool, &by_hand(from, to, false)).collision;
        let inside = (30.0, -62.0);
        assert!(moves((30.0, -55.0), inside).is_some(), "the crash");
        assert_eq!(moves(inside, (30.0, -61.9)), None, "away from the chuck");
        assert_eq!(moves((30.0, -61.9), (31.0, -61.9)), None, "along the jaws");
        assert!(moves((31.0, -61.9), (31.0, -62.1)).is_some(), "deeper");
        assert_eq!(moves((31.0, -61.9), (31.0, -55.0)), None, "out");
        assert!(moves((31.0, -55.0), (31.0, -61.0)).is_some(), "in again");
    }

    #[test]
    fn a_plunge_deeper_than_the_insert_collides_with_the_tool_body() {
        let mut scene = scene();
        let plunge = motion(MotionKind::Line, (26.0, -30.0), (10.0, -30.0));
        let collision = scene.move_tool(&turning(), &plunge).collision.unwrap();
        assert!(
            matches!(
                collision.touching_part,
                TouchingPart::Body(BodyPart::InsertBack | BodyPart::Holder)
            ),
            "{collision:?}"
        );
    }

    #[test]
    fn a_boring_bar_too_thick_for_the_bore_collides() {
        let stock = Stock {
            form: crate::stock::StockForm::Tube {
                diameter: gsk_units::Diameter(50.0),
                bore: gsk_units::Diameter(14.0),
            },
            ..Stock::bar(50.0, 0.0, 60.0)
        };
        let thick = SceneTool::new(ToolShape::from_tool(&Tool {
            holder: crate::tool::Holder::Bar {
                diameter: 16.0,
                length: 80.0,
            },
            ..Tool::boring()
        }));
        let cut = motion(MotionKind::Line, (7.5, 1.0), (7.5, -30.0));
        let mut scene = LatheScene::new(&stock);
        let collision = scene.move_tool(&thick, &cut).collision.unwrap();
        assert_eq!(
            collision.touching_part,
            TouchingPart::Body(BodyPart::Holder)
        );
        let thin = SceneTool::new(ToolShape::from_tool(&Tool {
            holder: crate::tool::Holder::Bar {
                diameter: 10.0,
                length: 80.0,
            },
            ..Tool::boring()
        }));
        assert_eq!(
            LatheScene::new(&stock).move_tool(&thin, &cut).collision,
            None
        );
    }
}
