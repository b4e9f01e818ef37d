//! Stock and tool of a form, for its preview and for the file beside the program.

use gsk_outline::ENTERING_DEGREES;
use gsk_units::Diameter;
use gsk_workpiece::job::Job;
use gsk_workpiece::stock::{Stock, StockForm};
use gsk_workpiece::tool::{Holder, Insert, InsertLetter, Tool};

use crate::blocks::{
    chosen_thread, deepest_z, drill_end_z, is_compensated, outside_diameter, side, undercut_insert,
};
use crate::kind::FormKind;
use crate::section::find_sections;
use crate::tool_path::CutSide;
use crate::values::FormValues;

/// Length between the deepest cut and the jaws, mm.
const JAW_CLEARANCE_MM: f64 = 50.0;
/// Length of the stock within the jaws, mm.
const CLAMPED_MM: f64 = 40.0;
/// Ratio of the diameter of a boring bar to the free diameter of the hole.
const BAR_TO_HOLE: f64 = 0.7;
/// Greatest diameter of a boring bar, mm.
const GREATEST_BAR_MM: f64 = 16.0;

/// The stock that the form expects, and a tool that can cut it.
pub fn form_job(values: &FormValues) -> Job {
    let deepest = match values.form() {
        FormKind::Face => 0.0,
        FormKind::Turn | FormKind::Bore | FormKind::Contour => deepest_z(values),
        FormKind::Groove => {
            let further = (values.value("COUNT") - 1.0) * values.value("STEP");
            -(values.value("POS") + values.value("W") + further)
        }
        FormKind::PartOff => -(values.value("L") + values.value("TW")),
        FormKind::Thread => -values.value("L"),
        FormKind::Drill | FormKind::Center => drill_end_z(values),
    };
    let face = match values.form() {
        FormKind::Face => values.value("ALLOW"),
        _ => 0.0,
    };
    let overhang = JAW_CLEARANCE_MM - deepest;
    let outside = outside_diameter(values);
    let mut stock = Stock::bar(outside, face, overhang);
    stock.length = overhang + face + CLAMPED_MM;
    stock.chuck.diameter.0 = stock.chuck.diameter.0.max(outside * 2.5);
    if let Some(form) = hollow_form(values, outside, stock.length) {
        stock.form = form;
    }
    let mut job = Job::new(stock);
    let number = (values.number("TOOL").0 / 1000).clamp(1, 99) as u8;
    job.tools.insert(number, tool(values, -deepest));
    job
}

/// What the offset table must have for G41 or G42.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoseOffset {
    /// The number of the offset.
    pub number: u8,
    /// R, the nose radius, mm.
    pub radius: f64,
    /// T, the number of the imaginary tip.
    pub tip: u8,
}

/// What the offset table must have; `None` if the blocks allow for the nose radius.
pub fn nose_offset(values: &FormValues) -> Option<NoseOffset> {
    if !is_compensated(values) {
        return None;
    }
    let job = form_job(values);
    let (number, tool) = job.tools.iter().next()?;
    Some(NoseOffset {
        number: *number,
        radius: values.value("NOSE"),
        tip: tool.tip,
    })
}

/// The stock and the tools of the forms in a program; `None` without a form that can be read.
/// The first form gives the shape of the stock. The stock is long enough for all forms.
pub fn program_job(text: &str) -> Option<Job> {
    let sections = find_sections(text).into_iter();
    let jobs = sections.filter_map(|section| section.values.ok());
    jobs.map(|values| form_job(&values))
        .reduce(|mut job, next| {
            let overhang = job.stock.overhang.max(next.stock.overhang);
            let face = job.stock.face.max(next.stock.face);
            job.stock.length = overhang + face + CLAMPED_MM;
            job.stock.overhang = overhang;
            job.stock.face = face;
            for (number, tool) in next.tools {
                job.tools.entry(number).or_insert(tool);
            }
            job
        })
}

/// The form of a stock that is not a bar.
fn hollow_form(values: &FormValues, outside: f64, length: f64) -> Option<StockForm> {
    let tube = |bore: f64| {
        (bore > 0.0 && bore < outside).then_some(StockForm::Tube {
            diameter: Diameter(outside),
            bore: Diameter(bore),
        })
    };
    match (values.form(), side(values)) {
        (FormKind::Face | FormKind::PartOff, _) => tube(values.value("BORE")),
        (FormKind::Bore, _) | (FormKind::Contour, CutSide::Inside) => tube(values.value("HOLE")),
        (FormKind::Groove, CutSide::Inside) => tube(values.value("D")),
        (FormKind::Thread, CutSide::Inside) => {
            let thread = chosen_thread(values).profile(true);
            tube(thread.blank + thread.taper * values.value("L"))
        }
        (FormKind::Thread, CutSide::Outside) => {
            let thread = chosen_thread(values).profile(false);
            let end = thread.blank + thread.taper * values.value("L");
            (thread.taper > 0.0).then(|| StockForm::Contour {
                corners: vec![
                    (Diameter(thread.blank), 0.0),
                    (Diameter(end), -values.value("L")),
                    (Diameter(end), -length),
                ],
                bore: Diameter(0.0),
            })
        }
        _ => None,
    }
}

fn tool(values: &FormValues, depth: f64) -> Tool {
    match values.form() {
        FormKind::Face => turning_tool(values),
        FormKind::Turn | FormKind::Bore | FormKind::Contour => match side(values) {
            CutSide::Outside => turning_tool(values),
            CutSide::Inside => boring_tool(values, depth),
        },
        FormKind::Groove | FormKind::PartOff => grooving_tool(values, depth),
        FormKind::Thread => threading_tool(values, depth),
        FormKind::Drill | FormKind::Center => drill(values, depth),
    }
}

fn turning_tool(values: &FormValues) -> Tool {
    let mut tool = Tool::turning();
    if let Insert::Turning { nose, letter, .. } = &mut tool.insert {
        *nose = values.value("NOSE");
        if let Some(insert) = undercut_insert(values) {
            *letter = insert_letter(insert);
        }
    }
    tool
}

/// The sharpest insert whose corner has at least this angle, degrees.
fn insert_letter(angle: f64) -> InsertLetter {
    let letters = [InsertLetter::V, InsertLetter::D, InsertLetter::T];
    let mut fitting = letters.into_iter().filter(|it| it.corner() >= angle);
    fitting.next().unwrap_or(InsertLetter::C)
}

fn boring_tool(values: &FormValues, depth: f64) -> Tool {
    let hole = values.value("HOLE");
    let nose = values.value("NOSE");
    let size = (6.35 * hole / 15.0).clamp(2.0, 6.35).max(4.0 * nose);
    Tool {
        insert: Insert::Turning {
            letter: undercut_insert(values).map_or(InsertLetter::D, insert_letter),
            entering: ENTERING_DEGREES,
            size,
            nose,
        },
        tip: 2,
        holder: bar(hole, size / 2.0, depth),
    }
}

/// A bar for a hole into which an insert protrudes by `reach`, mm.
fn bar(hole: f64, reach: f64, depth: f64) -> Holder {
    Holder::Bar {
        diameter: ((hole - reach) * BAR_TO_HOLE).clamp(2.0, GREATEST_BAR_MM),
        length: (depth + 20.0).clamp(80.0, 500.0),
    }
}

fn grooving_tool(values: &FormValues, depth: f64) -> Tool {
    let width = values.value("TW");
    let bottom = match values.form() {
        FormKind::PartOff => 0.0,
        _ => values.value("DB"),
    };
    let groove = libm::fabs(values.value("D") - bottom) / 2.0;
    let mut tool = Tool::grooving(width);
    if let Insert::Grooving { nose, reach, .. } = &mut tool.insert {
        *nose = nose.min(width / 4.0);
        *reach = (groove + 2.0).clamp(1.0, 200.0);
        if side(values) == CutSide::Inside {
            tool.tip = 2;
            tool.holder = bar(values.value("D"), *reach, depth);
        }
    }
    tool
}

fn threading_tool(values: &FormValues, depth: f64) -> Tool {
    let is_inside = side(values) == CutSide::Inside;
    let thread = chosen_thread(values).profile(is_inside);
    let mut tool = Tool::threading(thread.flank_angle);
    if let Insert::Threading { height, nose, .. } = &mut tool.insert {
        *height = (thread.depth() * 1.3).clamp(0.2, 30.0);
        *nose = nose.min(*height / 8.0);
        if is_inside {
            // The bar is below the crests when the tip is at the root.
            *height = (thread.depth() * 3.0 + 1.0).clamp(0.2, 30.0);
            tool.tip = 6;
            tool.holder = bar(thread.blank, *height, depth);
        }
    }
    tool
}

fn drill(values: &FormValues, depth: f64) -> Tool {
    let mut tool = Tool::drill(values.value("D"));
    if let Insert::Drill { point, reach, .. } = &mut tool.insert {
        *point = values.value("POINT");
        *reach = (depth + 10.0).clamp(10.0, 1_000.0);
    }
    tool
}
