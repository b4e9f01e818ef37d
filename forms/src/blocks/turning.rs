//! Facing, turning, boring and contours: G94, and G71 with G70.

use gsk_messages::{Message, say};

use super::{BlockText, CLEARANCE_MM, FRONT_MM, RETRACT_MM, side};
use crate::error::FormError;
use crate::kind::FormKind;
use crate::nose_path::{CutSide, NoseCut};
use crate::outline::{CornerShape, OutlineVertex};
use crate::thousandths::Thousandths;
use crate::values::{FormValue, FormValues};

/// Greatest number of facing cuts.
const MOST_FACING_CUTS: i64 = 200;
/// Greatest number of blocks between the sequence numbers of a cycle.
const MOST_PROFILE_BLOCKS: usize = 100;

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

/// The outline of turning, boring or a contour.
pub(crate) fn outline(values: &FormValues) -> Result<Vec<OutlineVertex>, FormError> {
    let sign = side(values).sign();
    if values.form() == FormKind::Contour {
        let field = values.field("POINTS")?;
        let FormValue::Outline(outline) = values.get(field) else {
            return Ok(Vec::new());
        };
        let vertices = outline.vertices(sign);
        return vertices.map_err(|rule| FormError::new("POINTS", rule));
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
    Ok(vec![
        OutlineVertex {
            x: front,
            z: 0.0,
            corner: edge,
        },
        OutlineVertex {
            x: end,
            z: -values.value("L"),
            corner: shoulder,
        },
    ])
}

/// The greatest diameter of a contour, mm; 0 if its points are wrong.
pub(super) fn widest_diameter(values: &FormValues) -> f64 {
    let vertices = outline(values).unwrap_or_default();
    vertices.iter().map(|it| it.x * 2.0).fold(0.0, f64::max)
}

/// The least Z of a profile, mm; 0 if its points are wrong.
pub(crate) fn deepest_z(values: &FormValues) -> f64 {
    let vertices = outline(values).unwrap_or_default();
    vertices.iter().map(|it| it.z).fold(0.0, f64::min)
}

/// The diameter in front of the cut where the cycle starts and ends, mm.
fn start_diameter(values: &FormValues, outline: &[OutlineVertex]) -> Result<f64, FormError> {
    let diameters = || outline.iter().map(|it| it.x * 2.0);
    match side(values) {
        CutSide::Outside => {
            let stock = values.value("STOCK");
            let widest = diameters().fold(0.0, f64::max);
            if widest > stock {
                return Err(FormError::new(
                    "STOCK",
                    say::form_stock_too_thin(Thousandths::round(widest)),
                ));
            }
            Ok(stock + 2.0 * CLEARANCE_MM)
        }
        CutSide::Inside => {
            let hole = values.value("HOLE");
            let narrowest = diameters().fold(f64::INFINITY, f64::min);
            if narrowest < hole {
                let rule = say::form_hole_too_wide(Thousandths::round(narrowest));
                return Err(FormError::new("HOLE", rule));
            }
            Ok(hole - CLEARANCE_MM)
        }
    }
}

/// G71 and G70 along an outline.
pub(super) fn profile(text: &mut BlockText, values: &FormValues) -> Result<(), FormError> {
    let at_points = |rule| match values.form() {
        FormKind::Contour => FormError::new("POINTS", rule),
        _ => FormError::new("", rule),
    };
    let outline = outline(values)?;
    if outline.iter().any(|it| it.x < 0.0 || it.z > 0.0) {
        return Err(at_points(say::form_point_outside_part()));
    }
    let start_x = start_diameter(values, &outline)?;
    let cut = NoseCut {
        side: side(values),
        nose: values.value("NOSE"),
        start_z: front_z(values),
        end_diameter: start_x,
    };
    let blocks = cut.blocks(&outline).map_err(at_points)?;
    if blocks.len() > MOST_PROFILE_BLOCKS {
        return Err(at_points(say::form_too_many_blocks(MOST_PROFILE_BLOCKS)));
    }
    let sign = if cut.side == CutSide::Inside { -1 } else { 1 };
    let (first, last) = (values.number("N").0 / 1000, values.number("N").0 / 1000 + 1);
    text.rapid(
        Some(Thousandths::round(start_x)),
        Some(Thousandths::round(cut.start_z)),
    );
    let retract = Thousandths::round(RETRACT_MM).with_point();
    text.add(format!(
        "G71 U{} R{retract}",
        values.number("DEPTH").with_point()
    ));
    text.add(format!(
        "G71 P{first} Q{last} U{} W{} F{}",
        Thousandths(sign * values.number("FINX").0).with_point(),
        values.number("FINZ").with_point(),
        values.number("F").with_point(),
    ));
    let finish = format!(" F{}", values.number("FF").with_point());
    let count = blocks.len();
    for (index, block) in blocks.iter().enumerate() {
        let before = index.checked_sub(1).map(|at| blocks[at]);
        let number = match index {
            0 => format!("N{first} "),
            _ if index + 1 == count => format!("N{last} "),
            _ => String::new(),
        };
        let code = match (index, block.arc) {
            (0, _) => "G00",
            (_, Some((_, true))) => "G02",
            (_, Some((_, false))) => "G03",
            (_, None) => "G01",
        };
        let mut words = format!("{number}{code}");
        if before.is_none_or(|it| it.x != block.x) {
            words.push_str(&format!(" X{}", block.x.with_point()));
        }
        if before.is_some_and(|it| it.z != block.z) {
            words.push_str(&format!(" Z{}", block.z.with_point()));
        }
        if let Some((radius, _)) = block.arc {
            words.push_str(&format!(" R{}", radius.with_point()));
        }
        if index == 1 {
            words.push_str(&finish);
        }
        text.add(words);
    }
    text.add(format!("G70 P{first} Q{last}"));
    Ok(())
}
