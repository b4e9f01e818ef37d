//! The part in its clamping, and tools that move about it.

use gsk_units::Point;

use crate::collision::{Collision, Obstacle, Toucher};
use crate::convex::{shrunk, sweep, sweep_along};
use crate::grid::{Contour, GridPoint, from_grid, to_grid};
use crate::motion::{Kind, Motion};
use crate::part::{Part, Removed, both_sides};
use crate::region::{Bounds, Region};
use crate::stock::Stock;
use crate::tool::Shape;

/// Nearer than that is no collision, grid units: 5 µm. Surfaces slide along each other
/// and the corners of a circle are chords.
const CLEARANCE: i32 = 50;

/// Part, chuck, jaws and tailstock.
#[derive(Clone, Debug)]
pub struct Scene {
    stock: Stock,
    part: Part,
    obstacles: Vec<(Obstacle, Region, Bounds)>,
    /// Where a thread ended: the tool stands in its own groove there, though the drawn
    /// plane may show that groove elsewhere.
    groove: Option<Point>,
}

/// What came of a motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// What was cut away.
    pub removed: Removed,
    /// The first collision of the motion.
    pub collision: Option<Collision>,
}

/// Stock that a motion went through without cutting it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Intrusion {
    /// By the insert in a rapid.
    pub insert: Region,
    /// By what must touch nothing.
    pub body: Region,
}

/// A tool ready to be moved about.
#[derive(Clone, Debug)]
pub struct Cutter {
    shape: Shape,
    /// The cutting part, nearer than which is no collision.
    clear: Contour,
    /// The same of the rest.
    body: Vec<(Toucher, Contour)>,
}

impl Cutter {
    /// With a shape.
    pub fn new(shape: Shape) -> Self {
        let clear = shrunk(&shape.cutting, CLEARANCE);
        let body = shape
            .body
            .iter()
            .map(|(part, contour)| (Toucher::Body(*part), shrunk(contour, CLEARANCE)))
            .collect();
        Self { shape, clear, body }
    }

    /// Its shape.
    pub const fn shape(&self) -> &Shape {
        &self.shape
    }
}

impl Scene {
    /// With fresh stock.
    pub fn new(stock: &Stock) -> Self {
        let (body, jaws) = stock.chuck_section();
        let obstacles = [
            (Obstacle::Jaws, jaws),
            (Obstacle::Chuck, body),
            (Obstacle::Tailstock, stock.tailstock_section()),
        ];
        Self {
            stock: stock.clone(),
            part: Part::new(&stock.section()),
            obstacles: obstacles
                .into_iter()
                .filter_map(|(obstacle, region)| {
                    let bounds = region.bounds()?;
                    Some((obstacle, region, bounds))
                })
                .collect(),
            groove: None,
        }
    }

    /// The stock it began with.
    pub const fn stock(&self) -> &Stock {
        &self.stock
    }

    /// The part as it is now.
    pub const fn part(&self) -> &Part {
        &self.part
    }

    /// What was parted off falls.
    pub fn drop_loose(&mut self) -> Vec<Region> {
        self.part.drop_loose(self.stock.clamped())
    }

    /// Moves a tool: what its insert meets is cut away; the first collision is reported.
    pub fn carry_out(&mut self, cutter: &Cutter, motion: &Motion) -> Outcome {
        let path = motion.path();
        let mut outcome = Outcome {
            collision: self.insert_hit(cutter, motion, &path),
            removed: Removed::default(),
        };
        if let Kind::Thread(imprints) = &motion.kind {
            for position in imprints {
                let removed = self
                    .part
                    .cut_along(&cutter.shape.cutting, &[to_grid(*position)]);
                outcome.removed.add(removed);
            }
            self.groove = Some(motion.to);
        } else {
            outcome.removed = self.part.cut_along(&cutter.shape.cutting, &path);
            self.groove = None;
        }
        let by_body = || {
            let mut body = cutter.body.iter();
            body.find_map(|(toucher, contour)| self.hit(*toucher, contour, &path, Some(&[])))
        };
        outcome.collision = outcome.collision.or_else(by_body);
        outcome
    }

    /// Moves a tool through stock of which it is not known where it is: returns what of
    /// it must be air, if the motion is right, and takes that and the cut away.
    pub fn intrude(&mut self, cutter: &Cutter, motion: &Motion) -> Intrusion {
        let path = motion.path();
        let swept = |contour: &[GridPoint]| both_sides(sweep_along(contour, &path));
        let mut intrusion = Intrusion::default();
        if matches!(motion.kind, Kind::Rapid) {
            let touched = self.part.touched(&swept(&cutter.clear));
            let groove = self.groove.filter(|end| *end == motion.from);
            intrusion.insert = match groove {
                Some(end) => {
                    let own = sweep(&cutter.shape.cutting, to_grid(end), to_grid(end));
                    touched.without(&[own])
                }
                None => touched,
            };
        }
        self.part.remove(intrusion.insert.contours());
        self.groove = None;
        match &motion.kind {
            Kind::Rapid => {}
            Kind::Thread(imprints) => {
                for position in imprints {
                    self.part
                        .cut_along(&cutter.shape.cutting, &[to_grid(*position)]);
                }
                self.groove = Some(motion.to);
            }
            Kind::Line | Kind::Arc { .. } => {
                self.part.cut_along(&cutter.shape.cutting, &path);
            }
        }
        for (_, contour) in &cutter.body {
            let touched = self.part.touched(&swept(contour));
            if !touched.is_empty() {
                self.part.remove(touched.contours());
                intrusion.body = intrusion.body.with(touched.contours());
            }
        }
        intrusion
    }

    /// What the insert hits on its path: the stock in a rapid or with a standing
    /// spindle, everything else always.
    fn insert_hit(
        &self,
        cutter: &Cutter,
        motion: &Motion,
        path: &[GridPoint],
    ) -> Option<Collision> {
        let (toucher, stock) = match motion.kind {
            Kind::Rapid => (Toucher::RapidInsert, true),
            _ if !motion.turning => (Toucher::StandingInsert, true),
            _ => (Toucher::Insert, false),
        };
        let groove = self.groove.filter(|end| *end == motion.from);
        let own: Vec<Contour> = groove
            .map(|end| sweep(&cutter.shape.cutting, to_grid(end), to_grid(end)))
            .into_iter()
            .collect();
        self.hit(toucher, &cutter.clear, path, stock.then_some(&own))
    }

    /// The first obstacle that a contour meets on a path; the stock only if it may not
    /// be met, but for where the tool stands in a groove of its own.
    fn hit(
        &self,
        toucher: Toucher,
        contour: &[GridPoint],
        path: &[GridPoint],
        stock: Option<&[Contour]>,
    ) -> Option<Collision> {
        let swept = both_sides(sweep_along(contour, path));
        let bounds = Bounds::of(swept.iter().flatten())?;
        let met = |common: &Region| !common.is_empty();
        let touched = |swept: &[Contour]| {
            let touched = self.part.touched(swept);
            match stock {
                Some(groove) if !groove.is_empty() => touched.without(groove),
                _ => touched,
            }
        };
        if stock.is_some() && met(&touched(&swept)) {
            return Some(first_touch(
                (toucher, Obstacle::Stock),
                contour,
                path,
                &touched,
            ));
        }
        self.obstacles
            .iter()
            .filter(|(_, _, own)| own.meets(&bounds))
            .find(|(_, region, _)| met(&region.common(&swept)))
            .map(|(obstacle, region, _)| {
                let touched = |swept: &[Contour]| region.common(swept);
                first_touch((toucher, *obstacle), contour, path, &touched)
            })
    }
}

/// Looks for the first touch on a path that meets something, to a thousandth of a piece
/// of it.
fn first_touch(
    (toucher, obstacle): (Toucher, Obstacle),
    contour: &[GridPoint],
    path: &[GridPoint],
    touched: &dyn Fn(&[Contour]) -> Region,
) -> Collision {
    const HALVINGS: u32 = 10;
    let along = |path: &[GridPoint]| touched(&both_sides(sweep_along(contour, path)));
    // The first piece that meets it.
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
    let at = |part: f64| {
        let between = |from: i32, to: i32| {
            let way = f64::from(to) - f64::from(from);
            from.saturating_add(libm::round(way * part) as i32)
        };
        GridPoint::new(between(from.x, to.x), between(from.y, to.y))
    };
    let until = |part: f64| along(&[from, at(part)]);
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
    Collision::new(toucher, obstacle, from_grid(at(touching)), &contact, &whole)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tool::{BodyPart, Tool};

    fn scene() -> Scene {
        Scene::new(&Stock::bar(50.0, 0.0, 60.0))
    }

    fn motion(kind: Kind, from: (f64, f64), to: (f64, f64)) -> Motion {
        Motion {
            from: Point::new(from.0, from.1),
            to: Point::new(to.0, to.1),
            kind,
            turning: true,
        }
    }

    fn turning() -> Cutter {
        Cutter::new(Shape::of(&Tool::turning()))
    }

    #[test]
    fn a_rapid_through_the_stock_is_a_collision_where_it_begins() {
        let mut scene = scene();
        let rapid = motion(Kind::Rapid, (20.0, 5.0), (20.0, -10.0));
        let collision = scene.carry_out(&turning(), &rapid).collision.unwrap();
        assert_eq!(
            (collision.toucher, collision.obstacle),
            (Toucher::RapidInsert, Obstacle::Stock)
        );
        assert!(collision.tip.z.abs() < 0.05, "{collision:?}");
        assert!((collision.depth - 5.0).abs() < 0.02, "{collision:?}");
    }

    #[test]
    fn a_rapid_along_the_surface_touches_nothing() {
        let mut scene = scene();
        for (from, to) in [
            ((25.0, 5.0), (25.0, -40.0)),
            ((25.0, -40.0), (60.0, 60.0)),
            ((60.0, 60.0), (25.0, 0.0)),
            ((25.0, 0.0), (0.0, 0.0)),
        ] {
            let outcome = scene.carry_out(&turning(), &motion(Kind::Rapid, from, to));
            assert_eq!(outcome, Outcome::default(), "{from:?} {to:?}");
        }
    }

    #[test]
    fn a_standing_spindle_does_not_cut() {
        let mut scene = scene();
        let mut cut = motion(Kind::Line, (20.0, 1.0), (20.0, -5.0));
        cut.turning = false;
        let collision = scene.carry_out(&turning(), &cut).collision.unwrap();
        assert_eq!(collision.toucher, Toucher::StandingInsert);
    }

    #[test]
    fn a_cut_into_the_jaws_is_a_collision() {
        let mut scene = scene();
        let cut = motion(Kind::Line, (24.0, 1.0), (24.0, -70.0));
        let collision = scene.carry_out(&turning(), &cut).collision.unwrap();
        assert_eq!(
            (collision.toucher, collision.obstacle),
            (Toucher::Insert, Obstacle::Jaws)
        );
        assert!((collision.tip.z + 60.0).abs() < 0.1, "{collision:?}");
    }

    #[test]
    fn a_deep_plunge_brings_the_holder_into_the_stock() {
        let mut scene = scene();
        let plunge = motion(Kind::Line, (26.0, -30.0), (10.0, -30.0));
        let collision = scene.carry_out(&turning(), &plunge).collision.unwrap();
        assert!(
            matches!(
                collision.toucher,
                Toucher::Body(BodyPart::InsertBack | BodyPart::Holder)
            ),
            "{collision:?}"
        );
    }

    #[test]
    fn a_thick_boring_bar_touches_the_other_wall() {
        let stock = Stock {
            form: crate::stock::Form::Tube {
                diameter: gsk_units::Diameter(50.0),
                bore: gsk_units::Diameter(14.0),
            },
            ..Stock::bar(50.0, 0.0, 60.0)
        };
        let thick = Cutter::new(Shape::of(&Tool {
            holder: crate::tool::Holder::Bar {
                diameter: 16.0,
                length: 80.0,
            },
            ..Tool::boring()
        }));
        let cut = motion(Kind::Line, (7.5, 1.0), (7.5, -30.0));
        let mut scene = Scene::new(&stock);
        let collision = scene.carry_out(&thick, &cut).collision.unwrap();
        assert_eq!(collision.toucher, Toucher::Body(BodyPart::Holder));
        let thin = Cutter::new(Shape::of(&Tool {
            holder: crate::tool::Holder::Bar {
                diameter: 10.0,
                length: 80.0,
            },
            ..Tool::boring()
        }));
        assert_eq!(Scene::new(&stock).carry_out(&thin, &cut).collision, None);
    }
}
