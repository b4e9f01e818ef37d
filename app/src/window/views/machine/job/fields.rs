//! The lengths and angles of stock and tools as fields.

use std::collections::BTreeMap;

use egui::{DragValue, Grid, Ui};
use gsk_core::units::{Diameter, tip_direction};
use gsk_messages::{Language, Message, say};
use gsk_workpiece::job::DiameterPoint;
use gsk_workpiece::stock::{Form, Stock, Tailstock};
use gsk_workpiece::tool::{Holder, Insert, InsertLetter, Tool};

/// Nothing is longer than that, mm; the rules of the job are narrower.
const MOST: f64 = 5000.0;

/// A field and its name.
fn value(ui: &mut Ui, name: &Message, value: &mut f64, language: Language) {
    let drag = DragValue::new(value)
        .range(-MOST..=MOST)
        .speed(0.1)
        .max_decimals(3);
    let drag = ui.add(drag);
    let name = ui.label(name.text(language));
    drag.labelled_by(name.id);
    ui.end_row();
}

fn grid(ui: &mut Ui, id: &str, add: impl FnOnce(&mut Ui)) {
    Grid::new(id)
        .num_columns(2)
        .spacing([8.0, 3.0])
        .show(ui, add);
}

/// The stock and its clamping.
pub fn stock(ui: &mut Ui, stock: &mut Stock, language: Language) {
    form(ui, &mut stock.form, language);
    grid(ui, "stock", |ui| {
        let chuck = &mut stock.chuck;
        for (name, field) in [
            (say::stock_word_face(), &mut stock.face),
            (say::stock_word_length(), &mut stock.length),
            (say::stock_word_overhang(), &mut stock.overhang),
            (say::stock_word_chuck(), &mut chuck.diameter.0),
            (say::stock_word_chuck_length(), &mut chuck.length),
            (say::stock_word_jaws(), &mut chuck.jaws),
            (say::stock_word_jaw_height(), &mut chuck.jaw_height),
        ] {
            value(ui, &name, field, language);
        }
    });
    let mut is_there = stock.tailstock.is_some();
    let words = say::stock_tailstock().text(language);
    if ui.checkbox(&mut is_there, words).changed() {
        stock.tailstock = is_there.then_some(Tailstock {
            quill: Diameter(40.0),
            center: Diameter(6.0),
        });
    }
    if let Some(tailstock) = &mut stock.tailstock {
        grid(ui, "tailstock", |ui| {
            value(
                ui,
                &say::stock_word_quill(),
                &mut tailstock.quill.0,
                language,
            );
            value(
                ui,
                &say::stock_word_center(),
                &mut tailstock.center.0,
                language,
            );
        });
    }
}

/// Bar, tube, or what was turned before.
fn form(ui: &mut Ui, form: &mut Form, language: Language) {
    let (outside, inside) = match form {
        Form::Bar { diameter } => (*diameter, None),
        Form::Tube { diameter, bore } => (*diameter, Some(*bore)),
        Form::Contour { corners, bore } => {
            let greatest = corners.iter().map(|corner| corner.0.0).fold(0.0, f64::max);
            (Diameter(greatest), Some(*bore))
        }
    };
    ui.horizontal_wrapped(|ui| {
        let is_bar = matches!(form, Form::Bar { .. });
        if ui.radio(is_bar, say::stock_bar().text(language)).clicked() {
            *form = Form::Bar { diameter: outside };
        }
        let is_tube = matches!(form, Form::Tube { .. });
        if ui
            .radio(is_tube, say::stock_tube().text(language))
            .clicked()
        {
            *form = Form::Tube {
                diameter: outside,
                bore: inside.unwrap_or(Diameter(outside.0 / 2.0)),
            };
        }
        let is_contour = matches!(form, Form::Contour { .. });
        let contour = ui.radio(is_contour, say::stock_contour().text(language));
        if contour.clicked() && !is_contour {
            *form = Form::Contour {
                corners: vec![(outside, 0.0), (outside, -50.0)],
                bore: inside.unwrap_or_default(),
            };
        }
    });
    grid(ui, "form", |ui| match form {
        Form::Bar { diameter } => {
            value(ui, &say::stock_word_diameter(), &mut diameter.0, language);
        }
        Form::Tube { diameter, bore } => {
            value(ui, &say::stock_word_diameter(), &mut diameter.0, language);
            value(ui, &say::stock_word_bore(), &mut bore.0, language);
        }
        Form::Contour { corners, bore } => {
            self::corners(ui, corners, language);
            value(ui, &say::stock_word_bore(), &mut bore.0, language);
        }
    });
}

/// The corners of a contour from the front to the back: diameter and Z.
fn corners(ui: &mut Ui, corners: &mut Vec<(Diameter, f64)>, language: Language) {
    let mut removed = None;
    let count = corners.len();
    for (index, (diameter, z)) in corners.iter_mut().enumerate() {
        ui.horizontal(|ui| {
            for (prefix, field) in [("⌀ ", &mut diameter.0), ("Z ", z)] {
                let drag = DragValue::new(field).prefix(prefix);
                ui.add(drag.range(-MOST..=MOST).speed(0.1).max_decimals(3));
            }
        });
        let less = ui.add_enabled(count > 2, egui::Button::new("−"));
        let hint = say::stock_corner_remove().text(language);
        if less.on_hover_text(hint).clicked() {
            removed = Some(index);
        }
        ui.end_row();
    }
    if let Some(index) = removed {
        corners.remove(index);
    }
    if ui.button(say::stock_corner_add().text(language)).clicked()
        && let Some(last) = corners.last().copied()
    {
        corners.push((last.0, last.1 - 10.0));
    }
    ui.end_row();
}

/// Insert, tip and holder.
pub fn tool(ui: &mut Ui, tool: &mut Tool, language: Language) {
    if let Insert::Turning { letter, .. } = &mut tool.insert {
        ui.horizontal_wrapped(|ui| {
            for each in InsertLetter::ALL {
                ui.selectable_value(letter, each, format!("{each:?}"));
            }
        });
    }
    grid(ui, "insert", |ui| {
        let fields: Vec<(Message, &mut f64)> = match &mut tool.insert {
            Insert::Turning {
                letter: InsertLetter::R,
                size,
                ..
            } => vec![(say::tool_word_size(), size)],
            Insert::Turning {
                entering,
                size,
                nose,
                ..
            } => vec![
                (say::tool_word_nose(), nose),
                (say::tool_word_entering(), entering),
                (say::tool_word_size(), size),
            ],
            Insert::Grooving { width, nose, reach } => vec![
                (say::tool_word_width(), width),
                (say::tool_word_nose(), nose),
                (say::tool_word_reach(), reach),
            ],
            Insert::Threading {
                angle,
                nose,
                height,
            } => vec![
                (say::tool_word_flanks(), angle),
                (say::tool_word_nose(), nose),
                (say::tool_word_height(), height),
            ],
            Insert::Drill {
                diameter,
                point,
                reach,
            } => vec![
                (say::tool_word_diameter(), diameter),
                (say::tool_word_point(), point),
                (say::tool_word_reach(), reach),
            ],
        };
        for (name, field) in fields {
            value(ui, &name, field, language);
        }
    });
    tip(ui, &mut tool.tip, language);
    holder(ui, &mut tool.holder, language);
}

/// The imaginary tip, by where it lies from the nose.
fn tip(ui: &mut Ui, tip: &mut u8, language: Language) {
    ui.horizontal(|ui| {
        Grid::new("tip").spacing([2.0, 2.0]).show(ui, |ui| {
            // X grows upwards, Z to the right.
            for x in [1.0, 0.0, -1.0] {
                for z in [-1.0, 0.0, 1.0] {
                    let lies = |number: &u8| {
                        let direction = tip_direction(*number);
                        (direction.x, direction.z) == (x, z)
                    };
                    if let Some(number) = (0..=8).find(lies) {
                        ui.selectable_value(tip, number, format!(" {number} "));
                    }
                }
                ui.end_row();
            }
        });
        ui.label(say::tool_word_tip().text(language));
    });
}

fn holder(ui: &mut Ui, holder: &mut Holder, language: Language) {
    ui.horizontal_wrapped(|ui| {
        for (kind, words) in [
            (
                Holder::Shank {
                    width: 20.0,
                    length: 60.0,
                },
                say::tool_holder_shank(),
            ),
            (
                Holder::Bar {
                    diameter: 12.0,
                    length: 80.0,
                },
                say::tool_holder_bar(),
            ),
            (Holder::None, say::tool_holder_none()),
        ] {
            let same = core::mem::discriminant(&kind) == core::mem::discriminant(holder);
            if ui.radio(same, words.text(language)).clicked() && !same {
                *holder = kind;
            }
        }
    });
    grid(ui, "holder", |ui| match holder {
        Holder::None => {}
        Holder::Shank { width, length } => {
            value(ui, &say::tool_word_holder_width(), width, language);
            value(ui, &say::tool_word_holder_length(), length, language);
        }
        Holder::Bar { diameter, length } => {
            value(ui, &say::tool_word_holder_diameter(), diameter, language);
            value(ui, &say::tool_word_holder_length(), length, language);
        }
    });
}

/// Where the lathe has the zero of the part, if it knows better than the control.
pub fn zero(ui: &mut Ui, zero: &mut Option<DiameterPoint>, language: Language) {
    let mut known = zero.is_some();
    let check = ui.checkbox(&mut known, say::job_zero().text(language));
    let hint = say::job_zero_hint().text(language);
    if check.on_hover_text(hint).changed() {
        *zero = known.then(DiameterPoint::default);
    }
    if let Some(place) = zero {
        self::place(ui, "zero", place, language);
    }
}

/// How long a tool really is.
pub fn length(
    ui: &mut Ui,
    lengths: &mut BTreeMap<u8, DiameterPoint>,
    number: u8,
    language: Language,
) {
    let mut known = lengths.contains_key(&number);
    let check = ui.checkbox(&mut known, say::job_length().text(language));
    let hint = say::job_length_hint().text(language);
    if check.on_hover_text(hint).changed() {
        if known {
            lengths.insert(number, DiameterPoint::default());
        } else {
            lengths.remove(&number);
        }
    }
    if let Some(place) = lengths.get_mut(&number) {
        self::place(ui, "length", place, language);
    }
}

fn place(ui: &mut Ui, id: &str, place: &mut DiameterPoint, language: Language) {
    grid(ui, id, |ui| {
        value(ui, &say::job_place_x(), &mut place.x.0, language);
        value(ui, &say::job_place_z(), &mut place.z, language);
    });
}
