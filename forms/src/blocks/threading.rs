//! Threads with G76: one cycle for each start, begun one pitch farther from the part.

use gsk_messages::say;
use libm::ceil;

use super::{BlockText, CLEARANCE_MM, micrometres, side};
use crate::error::FormError;
use crate::thousandths::Thousandths;
use crate::thread_table::{ThreadPitch, ThreadRow, thread_rows};
use crate::tool_path::CutSide;
use crate::values::{FormValue, FormValues};

/// Lead-in for each mm/s of the feed, mm: table 3-11 of the manual, time constant 100 ms.
const LEAD_IN_S: f64 = 0.052;
/// Greatest feed in a thread, mm/min.
const GREATEST_FEED_MM_PER_MIN: f64 = 6_000.0;

/// The thread of the form: a row of the table, or the fields D and PITCH.
pub(crate) fn chosen_thread(values: &FormValues) -> ThreadRow {
    let row = match values.field("THREAD").map(|field| values.get(field)) {
        Ok(FormValue::Thread(Some(row))) => thread_rows().nth(row),
        _ => None,
    };
    row.unwrap_or_else(|| ThreadRow::free(values.value("D"), values.value("PITCH")))
}

/// Lead of the thread, mm.
fn lead(values: &FormValues) -> f64 {
    chosen_thread(values).pitch.mm() * values.value("STARTS")
}

/// The distance in front of the thread in which the carriage reaches its feed: twice the lead,
/// and at least that of the manual's table.
pub(crate) fn default_run_in(values: &FormValues) -> Thousandths {
    let lead = lead(values);
    let feed_mm_per_s = lead * values.value("S") / 60.0;
    let distance = (LEAD_IN_S * feed_mm_per_s).max(2.0 * lead);
    Thousandths::round((ceil(distance * 2.0) / 2.0).clamp(0.5, 100.0))
}

/// Z where the last start begins, mm.
pub(super) fn front_z(values: &FormValues) -> f64 {
    let pitch = chosen_thread(values).pitch.mm();
    values.value("RUNIN") + pitch * (values.value("STARTS") - 1.0)
}

pub(super) fn thread(text: &mut BlockText, values: &FormValues) -> Result<(), FormError> {
    let thread = chosen_thread(values);
    let side = side(values);
    let profile = thread.profile(side == CutSide::Inside);
    let (length, run_in) = (values.value("L"), values.value("RUNIN"));
    let starts = values.number("STARTS").0 / 1000;
    let depth = Thousandths::round(profile.depth());
    check(values, depth, profile.taper != 0.0)?;
    let root = profile.root + profile.taper * length;
    // The height of the cone between the start of the pass and its end, as a radius.
    let cone = Thousandths::round(-profile.taper * (length + run_in) / 2.0);
    let start_x = match side {
        CutSide::Outside => {
            profile.blank.max(profile.blank + profile.taper * length) + 2.0 * CLEARANCE_MM
        }
        CutSide::Inside => {
            profile.blank.min(profile.blank + profile.taper * length) - 2.0 * CLEARANCE_MM
        }
    };
    if start_x <= 0.0 {
        return Err(FormError::new("THREAD", say::form_thread_too_small()));
    }
    text.rapid(
        Some(Thousandths::round(start_x)),
        Some(Thousandths::round(run_in)),
    );
    text.add(format!(
        "G76 P{:02}{:02}{:02.0} Q{} R{}",
        values.number("PASSES").0 / 1000,
        values.number("RUNOUT").0 / 100,
        profile.flank_angle,
        micrometres(values.number("LEAST")),
        micrometres(values.number("LAST")),
    ));
    let pitch = match thread.pitch {
        ThreadPitch::PerInch(count) if starts == 1 => {
            format!("I{}", Thousandths::round(count).with_point())
        }
        _ => format!("F{}", Thousandths::round(lead(values)).with_point()),
    };
    let taper = match cone.0 {
        0 => String::new(),
        _ => format!(" R{}", cone.with_point()),
    };
    for start in 0..starts {
        if start > 0 {
            let z = run_in + thread.pitch.mm() * start as f64;
            text.rapid(None, Some(Thousandths::round(z)));
        }
        text.add(format!(
            "G76 X{} Z{}{taper} P{} Q{} {pitch}",
            Thousandths::round(root).with_point(),
            Thousandths::round(-length).with_point(),
            micrometres(depth),
            micrometres(values.number("FIRST")),
        ));
    }
    Ok(())
}

fn check(values: &FormValues, depth: Thousandths, is_tapered: bool) -> Result<(), FormError> {
    if is_tapered && values.number("STARTS").0 > 1_000 {
        return Err(FormError::new("STARTS", say::form_taper_one_start()));
    }
    if values.number("LAST").0 >= depth.0 {
        return Err(FormError::new("LAST", say::form_below_depth(depth)));
    }
    if values.number("FIRST").0 > depth.0 {
        return Err(FormError::new("FIRST", say::form_below_depth(depth)));
    }
    let feed = lead(values) * values.value("S");
    if feed > GREATEST_FEED_MM_PER_MIN {
        let most = GREATEST_FEED_MM_PER_MIN / lead(values);
        return Err(FormError::new("S", say::form_thread_too_fast(most)));
    }
    let run_out = values.value("RUNOUT") * lead(values);
    if run_out >= values.value("L") {
        return Err(FormError::new("RUNOUT", say::form_run_out_too_long()));
    }
    Ok(())
}
