//! Facing, turning, boring and contours: G94, and G71 with G70; G73 for undercuts.

use gsk_messages::{Message, say};
use gsk_outline::{ProfilePiece, cover_pockets};
use gsk_units::Point;

use super::{BlockText, CLEARANCE_MM, FRONT_MM, RETRACT_MM, side};
use crate::contour::{CornerShape, OutlineSolution, TurnedOutline, TurnedPoint};
use crate::error::FormError;
use crate::kind::FormKind;
use crate::thousandths::Thousandths;
use crate::tool_path::{ContourCut, CutSide, finished_outline};
use crate::values::{FormValue, FormValues};

/// Greatest number of facing cuts.
const MOST_FACING_CUTS: i64 = 200;
/// Greatest number of blocks between the sequence numbers of a cycle.
const MOST_PROFILE_BLOCKS: usize = 100;
/// Greatest number of passes of G73.
const MOST_PASSES: f64 = 100.0;
/// Tolerance of coordinates that the form computes, mm.
const ROUNDING_MM: f64 = 0.000_5;

/// Facing cuts with G94; the last one finishes the face at Z 0.
pub(super) fn face(text: &mut BlockText, values: &FormValues) -> Result<(), FormError> {
    let (stock, core) = (values.number("STOCK"), values.number("BORE"));
    if core.0 >= stock.0 {
        return Err(FormError::new("BORE", say::form_below_stock(stock)));
    }
    let nose = values.number("NOSE");
    // The flat of the insert must pass the axis, or the edge of the bore.
    let inner = match core.0 {
        0 => Thousandths(-2 * nose.0),
        _ => Thousandths(core.0 - 2 * nose.0) - Thousandths::round(2.0 * CLEARANCE_MM),
    };
    let (allowance, finish) = (values.number("ALLOW").0, values.number("FIN").0);
    let depth = values.number("DEPTH").0.max(1);
    if (allowance - finish) / depth > MOST_FACING_CUTS {
        return Err(FormError::new(
            "DEPTH",
            say::form_too_many_cuts(MOST_FACING_CUTS),
        ));
    }
    let start_z = Thousandths::round(FRONT_MM) + values.number("ALLOW");
    let start_x = stock + Thousandths::round(2.0 * CLEARANCE_MM);
    text.rapid(Some(start_x), Some(start_z));
    let mut levels = Vec::new();
    let mut level = allowance - depth;
    while level > finish {
        levels.push(level);
        level -= depth;
    }
    if finish > 0 && finish < allowance {
        levels.push(finish);
    }
    let mut word = format!("G94 X{} ", inner.with_point());
    let mut feed = format!(" F{}", values.number("F").with_point());
    for level in levels {
        text.add(format!("{word}Z{}{feed}", Thousandths(level).with_point()));
        word.clear();
        feed.clear();
    }
    text.add(format!("{word}Z0. F{}", values.number("FF").with_point()));
    Ok(())
}

/// Z in front of the face where the cut along a profile begins, mm.
pub(super) fn front_z(values: &FormValues) -> f64 {
    FRONT_MM + 2.0 * values.value("NOSE")
}

/// The points of turning, boring or a contour.
fn points(values: &FormValues) -> Result<TurnedOutline, FormError> {
    let sign = side(values).sign();
    if values.form() == FormKind::Contour {
        let field = values.field("POINTS")?;
        return Ok(match values.get(field) {
            FormValue::Outline(outline) => outline,
            _ => TurnedOutline::default(),
        });
    }
    let (end, front) = (values.value("D") / 2.0, values.value("DF") / 2.0);
    if (end - front) * sign < 0.0 {
        let rule: fn(Thousandths) -> Message = |d| say::form_front_taper(d);
        return Err(FormError::new("DF", rule(values.number("D"))));
    }
    let edge = match values.number("C") {
        _ if values.has("EDGE", "SHARP") => CornerShape::Sharp,
        size if values.has("EDGE", "RADIUS") => CornerShape::Radius(size),
        size => CornerShape::Chamfer(size),
    };
    let shoulder = match values.number("R") {
        Thousandths(0) => CornerShape::Sharp,
        radius => CornerShape::Radius(radius),
    };
    let at = |diameter, z, corner| TurnedPoint {
        diameter: Some(diameter),
        z: Some(z),
        corner,
        ..TurnedPoint::default()
    };
    Ok(TurnedOutline {
        points: vec![
            at(values.number("DF"), Thousandths(0), edge),
            at(
                values.number("D"),
                Thousandths(0) - values.number("L"),
                shoulder,
            ),
        ],
    })
}

/// The outline of a form with its corners, as far as its points determine it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawnOutline {
    /// The lines and arcs, X as a radius.
    pub pieces: Vec<ProfilePiece>,
    /// The end of each point with its number, before its corner is rounded.
    pub points: Vec<(usize, Point)>,
}

/// The outline that turning, boring or a contour cuts; empty for other forms.
pub fn drawn_outline(values: &FormValues) -> DrawnOutline {
    let solution = match values.form() {
        FormKind::Turn | FormKind::Bore | FormKind::Contour => points(values),
        _ => return DrawnOutline::default(),
    };
    let Ok(solution) = solution.map(|points| points.solve(side(values).sign())) else {
        return DrawnOutline::default();
    };
    let plain = || solution.pieces.iter().map(|it| it.piece).collect();
    let pieces = match finished_outline(&solution, side(values), None) {
        Ok(pieces) if side(values) == CutSide::Inside => {
            pieces.iter().map(ProfilePiece::mirrored).collect()
        }
        Ok(pieces) => pieces,
        Err(_) => plain(),
    };
    let ends = solution.pieces.iter().map(|it| (it.number, it.piece.end));
    DrawnOutline {
        pieces,
        points: [(1, solution.start)].into_iter().chain(ends).collect(),
    }
}

/// The lines and arcs of turning, boring or a contour, before corners are rounded.
fn solution(values: &FormValues) -> Result<OutlineSolution, FormError> {
    let solution = points(values)?.solve(side(values).sign());
    match solution.fault {
        Some(rule) => Err(FormError::new("POINTS", rule)),
        None => Ok(solution),
    }
}

/// Least and greatest coordinates of a profile.
fn bounds(solution: &OutlineSolution) -> (Point, Point) {
    let bounds = solution.pieces.iter().map(|it| it.piece.bounds());
    bounds.fold(
        (solution.start, solution.start),
        |(low, high), (below, above)| {
            (
                Point::new(low.x.min(below.x), low.z.min(below.z)),
                Point::new(high.x.max(above.x), high.z.max(above.z)),
            )
        },
    )
}

/// The greatest diameter of a contour, mm; 0 if its points are wrong.
pub(super) fn widest_diameter(values: &FormValues) -> f64 {
    solution(values).map_or(0.0, |it| bounds(&it).1.x * 2.0)
}

/// The least Z of a profile, mm; 0 if its points are wrong.
pub(crate) fn deepest_z(values: &FormValues) -> f64 {
    solution(values).map_or(0.0, |it| bounds(&it).0.z)
}

/// The diameter in front of the cut where the cycle starts and ends, mm.
fn start_diameter(values: &FormValues, (low, high): (Point, Point)) -> Result<f64, FormError> {
    match side(values) {
        CutSide::Outside => {
            let stock = values.value("STOCK");
            let widest = high.x * 2.0;
            if widest > stock + ROUNDING_MM {
                return Err(FormError::new(
                    "STOCK",
                    say::form_stock_too_thin(Thousandths::round(widest)),
                ));
            }
            Ok(stock + 2.0 * CLEARANCE_MM)
        }
        CutSide::Inside => {
            let hole = values.value("HOLE");
            let narrowest = low.x * 2.0;
            if narrowest < hole - ROUNDING_MM {
                let rule = say::form_hole_too_wide(Thousandths::round(narrowest));
                return Err(FormError::new("HOLE", rule));
            }
            Ok(hole - CLEARANCE_MM)
        }
    }
}

/// The insert that cuts undercuts; `None` if they are refused.
pub(crate) fn undercut_insert(values: &FormValues) -> Option<f64> {
    values.has("UNDER", "YES").then(|| values.value("INSERT"))
}

/// Whether the control allows for the nose radius, with G41 or G42.
pub(crate) fn is_compensated(values: &FormValues) -> bool {
    values.value("NOSE") > 0.0 && values.has("COMP", "G41")
}

/// G71 and G70 along an outline, with G73 for its undercuts.
pub(super) fn profile(text: &mut BlockText, values: &FormValues) -> Result<(), FormError> {
    let at_points = |rule| match values.form() {
        FormKind::Contour => FormError::new("POINTS", rule),
        _ => FormError::new("", rule),
    };
    let outline = solution(values)?;
    let (low, high) = bounds(&outline);
    if low.x < -ROUNDING_MM || high.z > ROUNDING_MM {
        return Err(at_points(say::form_point_outside_part()));
    }
    let start_x = start_diameter(values, (low, high))?;
    let cut = ContourCut {
        side: side(values),
        nose: values.value("NOSE"),
        start_z: front_z(values),
        end_diameter: start_x,
        insert: undercut_insert(values),
        is_compensated: is_compensated(values),
    };
    let finished = cut.finished(&outline).map_err(at_points)?;
    let path = cut.tip_path(&finished).map_err(at_points)?;
    text.rapid(
        Some(Thousandths::round(start_x)),
        Some(Thousandths::round(cut.start_z)),
    );
    let writer = CycleWriter { values, cut };
    let covered = cover_pockets(&path);
    let last = match cut.insert.is_some() && covered.depth > 0.0 {
        false => writer.roughing(text, &path, 0).map_err(at_points)?,
        true => {
            writer
                .roughing(text, &covered.pieces, 0)
                .map_err(at_points)?;
            writer
                .pockets(text, &path, covered.depth)
                .map_err(at_points)?
        }
    };
    text.add(format!("G70 P{} Q{}", last.0, last.1));
    Ok(())
}

/// Writes the cycles of a profile.
#[derive(Clone, Copy)]
struct CycleWriter<'a> {
    values: &'a FormValues,
    cut: ContourCut,
}

impl CycleWriter<'_> {
    /// G71 along a path. Returns its sequence numbers.
    fn roughing(
        self,
        text: &mut BlockText,
        path: &[ProfilePiece],
        offset: u16,
    ) -> Result<(u16, u16), Message> {
        let retract = Thousandths::round(RETRACT_MM).with_point();
        text.add(format!(
            "G71 U{} R{retract}",
            self.values.number("DEPTH").with_point()
        ));
        self.cycle(text, "G71", path, offset)
    }

    /// G73 along a path whose pockets are this deep. Returns its sequence numbers.
    fn pockets(
        self,
        text: &mut BlockText,
        path: &[ProfilePiece],
        depth: f64,
    ) -> Result<(u16, u16), Message> {
        let passes = libm::ceil(depth / self.values.value("DEPTH")).clamp(2.0, MOST_PASSES);
        // The first pass already cuts.
        let relief = Thousandths::round(depth * (passes - 1.0) / passes * self.cut.side.sign());
        text.add(format!("G73 U{} W0. R{passes}", relief.with_point()));
        self.cycle(text, "G73", path, 2)
    }

    /// The block of a cycle with its allowances, and the blocks of the path.
    fn cycle(
        self,
        text: &mut BlockText,
        code: &str,
        path: &[ProfilePiece],
        offset: u16,
    ) -> Result<(u16, u16), Message> {
        let values = self.values;
        let first = (values.number("N").0 / 1000) as u16 + offset;
        let numbers = (first, first + 1);
        let sign = if self.cut.side == CutSide::Inside {
            -1
        } else {
            1
        };
        text.add(format!(
            "{code} P{} Q{} U{} W{} F{}",
            numbers.0,
            numbers.1,
            Thousandths(sign * values.number("FINX").0).with_point(),
            values.number("FINZ").with_point(),
            values.number("F").with_point(),
        ));
        let blocks = self.cut.blocks(path)?;
        let mut lines = blocks.cycle_lines(numbers, &values.number("FF").with_point());
        if lines.len() > MOST_PROFILE_BLOCKS {
            return Err(say::form_too_many_blocks(MOST_PROFILE_BLOCKS));
        }
        if self.cut.is_compensated {
            let code = match self.cut.side {
                CutSide::Outside => "G42",
                CutSide::Inside => "G41",
            };
            let (begin, end) = (format!("N{} ", numbers.0), format!("N{} ", numbers.1));
            if let Some(line) = lines.first_mut() {
                *line = line.replacen(&begin, &format!("{begin}{code} "), 1);
            }
            if let Some(line) = lines.last_mut() {
                *line = line.replacen(&end, &format!("{end}G40 "), 1);
            }
        }
        for line in lines {
            text.add(line);
        }
        Ok(numbers)
    }
}
