//! The blocks of each form: approach, spindle and tool, cycle, way back.

mod drilling;
mod grooving;
mod threading;
mod turning;

use crate::error::FormError;
use crate::kind::FormKind;
use crate::thousandths::Thousandths;
use crate::tool_path::CutSide;
use crate::values::FormValues;
use gsk_messages::say;

pub(crate) use drilling::end_z as drill_end_z;
pub(crate) use threading::{chosen_thread, default_run_in};
pub use turning::{DrawnOutline, drawn_outline};
pub(crate) use turning::{deepest_z, is_compensated, undercut_insert};

/// Distance between the tool and the surface before a cut, mm; of diameters twice.
pub(crate) const CLEARANCE_MM: f64 = 1.0;
/// Z in front of the face at which a cut along Z begins, mm.
pub(crate) const FRONT_MM: f64 = 2.0;
/// Retract of roughing and pecking cycles, mm.
const RETRACT_MM: f64 = 0.5;
/// Thickness of the wall around a hole of which only the hole is given, mm.
const WALL_MM: f64 = 10.0;

/// The text of a section, block by block.
#[derive(Debug, Default)]
pub(crate) struct BlockText {
    lines: Vec<String>,
}

impl BlockText {
    /// Adds a block.
    pub(crate) fn add(&mut self, block: impl Into<String>) {
        self.lines.push(block.into());
    }

    /// Adds a rapid.
    fn rapid(&mut self, x: Option<Thousandths>, z: Option<Thousandths>) {
        let mut block = String::from("G00");
        for (letter, value) in [('X', x), ('Z', z)] {
            if let Some(value) = value {
                block.push_str(&format!(" {letter}{}", value.with_point()));
            }
        }
        self.add(block);
    }

    /// The blocks.
    pub(crate) fn into_lines(self) -> Vec<String> {
        self.lines
    }
}

/// The blocks of a form.
pub(crate) fn form_blocks(values: &FormValues) -> Result<BlockText, FormError> {
    check_safe_position(values)?;
    let mut text = BlockText::default();
    start(&mut text, values)?;
    match values.form() {
        FormKind::Face => turning::face(&mut text, values)?,
        FormKind::Turn | FormKind::Bore | FormKind::Contour => {
            turning::profile(&mut text, values)?;
        }
        FormKind::Groove => grooving::grooves(&mut text, values)?,
        FormKind::PartOff => grooving::part_off(&mut text, values)?,
        FormKind::Thread => threading::thread(&mut text, values)?,
        FormKind::Drill => drilling::drill(&mut text, values),
        FormKind::Center => drilling::center(&mut text, values),
    }
    end(&mut text, values);
    Ok(text)
}

/// The side that a form cuts.
pub(crate) fn side(values: &FormValues) -> CutSide {
    match values.form() == FormKind::Bore || values.has("SIDE", "IN") {
        true => CutSide::Inside,
        false => CutSide::Outside,
    }
}

/// The diameter of the stock around the cut, mm.
pub(crate) fn outside_diameter(values: &FormValues) -> f64 {
    let around = |hole: f64| libm::ceil(hole + 2.0 * WALL_MM);
    match (values.form(), side(values)) {
        (FormKind::Face | FormKind::Turn, _) | (FormKind::Contour, CutSide::Outside) => {
            values.value("STOCK")
        }
        (FormKind::Contour, CutSide::Inside) => around(turning::widest_diameter(values)),
        (FormKind::Bore, _) => around(values.value("D").max(values.value("DF"))),
        (FormKind::Groove, CutSide::Inside) => around(values.value("DB")),
        (FormKind::Groove | FormKind::PartOff, _) => values.value("D"),
        (FormKind::Thread, side) => {
            let thread = chosen_thread(values).profile(side == CutSide::Inside);
            match side {
                CutSide::Outside => thread.blank + thread.taper * values.value("L").max(0.0),
                CutSide::Inside => around(thread.root),
            }
        }
        (FormKind::Drill | FormKind::Center, _) => around(values.value("D")),
    }
}

fn check_safe_position(values: &FormValues) -> Result<(), FormError> {
    let least = Thousandths::round(outside_diameter(values) + 2.0 * CLEARANCE_MM);
    if values.number("SAFEX") < least {
        return Err(FormError::new("SAFEX", say::form_safe_too_low(least)));
    }
    let front = match values.form() {
        FormKind::Face => values.value("ALLOW") + FRONT_MM,
        FormKind::Thread => threading::front_z(values),
        FormKind::Turn | FormKind::Bore | FormKind::Contour => turning::front_z(values),
        _ => FRONT_MM,
    };
    let least = Thousandths::round(front);
    if values.number("SAFEZ") < least {
        return Err(FormError::new("SAFEZ", say::form_safe_too_low(least)));
    }
    Ok(())
}

/// The safe position, the tool, the spindle, the feed mode and the coolant.
fn start(text: &mut BlockText, values: &FormValues) -> Result<(), FormError> {
    let (safe_x, safe_z) = (values.number("SAFEX"), values.number("SAFEZ"));
    text.rapid(Some(safe_x), Some(safe_z));
    let tool = values.number("TOOL").0 / 1000;
    text.add(format!("T{tool:02}{tool:02}"));
    let speed = values.number("S").0 / 1000;
    let is_reverse = is_reverse(values);
    if is_reverse {
        // The spindle reverses only from a stop.
        text.add("M05");
    }
    let turn = if is_reverse { "M04" } else { "M03" };
    if values.has("SPIN", "CSS") {
        if speed > 2_000 {
            return Err(FormError::new("S", say::form_surface_speed_high(speed)));
        }
        text.add(format!("G50 S{}", values.number("SMAX").0 / 1000));
        text.add(format!("G96 S{speed} {turn}"));
    } else {
        text.add(format!("G97 S{speed} {turn}"));
    }
    if values.form() != FormKind::Thread {
        check_feeds(values)?;
        text.add(if values.has("FEED", "MIN") {
            "G98"
        } else {
            "G99"
        });
    }
    if values.has("COOL", "ON") {
        text.add("M08");
    }
    Ok(())
}

/// Whether the spindle turns with M04: in reverse, or forward for a left-hand thread.
fn is_reverse(values: &FormValues) -> bool {
    values.has("DIR", "REV") != values.has("HAND", "LEFT")
}

fn check_feeds(values: &FormValues) -> Result<(), FormError> {
    let (least, most) = match values.has("FEED", "MIN") {
        true => (Thousandths::whole(1), Thousandths::whole(8_000)),
        false => (Thousandths(1), Thousandths::whole(5)),
    };
    for id in ["F", "FF"] {
        let Ok(field) = values.field(id) else {
            continue;
        };
        if !(least..=most).contains(&values.number(id)) {
            let rule = say::form_out_of_range(values.number(id), least, most);
            return Err(FormError::new(field.id, rule));
        }
    }
    Ok(())
}

/// The way back to the safe position and the end of coolant and spindle.
fn end(text: &mut BlockText, values: &FormValues) {
    let (safe_x, safe_z) = (Some(values.number("SAFEX")), Some(values.number("SAFEZ")));
    let leaves_hole = side(values) == CutSide::Inside;
    match values.form() {
        FormKind::Groove | FormKind::PartOff if !leaves_hole => {
            text.rapid(safe_x, None);
            text.rapid(None, safe_z);
        }
        FormKind::Drill | FormKind::Center => {
            text.rapid(None, safe_z);
            text.rapid(safe_x, None);
        }
        _ if leaves_hole => {
            text.rapid(None, safe_z);
            text.rapid(safe_x, None);
        }
        _ => text.rapid(safe_x, safe_z),
    }
    if values.has("COOL", "ON") {
        text.add("M09");
    }
    if values.has("SPIN", "CSS") {
        text.add("G97");
    }
    if is_reverse(values) {
        text.add("M05");
    }
}

/// A length as a whole number of micrometres, for words without a decimal point.
const fn micrometres(value: Thousandths) -> i64 {
    value.0
}
