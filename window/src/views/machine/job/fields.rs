//! Input fields for the lengths and angles of stock and tools.

use std::collections::BTreeMap;

use egui::{ComboBox, DragValue, Grid, Ui};
use gsk_core::units::{Diameter, tip_direction};
use gsk_messages::{Language, Message, say};
use gsk_workpiece::cutting::CuttingMaterial;
use gsk_workpiece::job::DiameterPoint;
use gsk_workpiece::stock::{Stock, StockForm, StockMaterial, Tailstock};
use gsk_workpiece::tool::{Holder, Insert, InsertLetter, Tool};

/// Limit of the values in all fields, mm. The rules of the job have narrower limits.
const LIMIT_MM: f64 = 5000.0;
/// Width of the column of values, points: the names of all groups stand in one column.
const VALUE_WIDTH: f32 = 52.0;

/// Draws a number field with a name before it.
fn show_value(ui: &mut Ui, name: &Message, value: &mut f64, language: Language) {
    let drag = DragValue::new(value)
        .range(-LIMIT_MM..=LIMIT_MM)
        .speed(0.1)
        .max_decimals(3);
    let drag = ui.add(drag);
    let name = ui.label(name.text(language));
    drag.labelled_by(name.id);
    ui.end_row();
}

fn show_grid(ui: &mut Ui, id: &str, add: impl FnOnce(&mut Ui)) {
    Grid::new(id)
        .num_columns(2)
        .min_col_width(VALUE_WIDTH)
        .spacing([8.0, 3.0])
        .show(ui, add);
}

/// Draws the fields of the stock and its clamping.
pub fn show_stock(ui: &mut Ui, stock: &mut Stock, language: Language) {
    show_form(ui, &mut stock.form, language);
    show_grid(ui, "stock", |ui| {
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
            show_value(ui, &name, field, language);
        }
    });
    show_material(ui, stock, language);
    let mut has_tailstock = stock.tailstock.is_some();
    let words = say::stock_tailstock().text(language);
    if ui.checkbox(&mut has_tailstock, words).changed() {
        stock.tailstock = has_tailstock.then_some(Tailstock {
            quill: Diameter(40.0),
            center: Diameter(6.0),
        });
    }
    if let Some(tailstock) = &mut stock.tailstock {
        show_grid(ui, "tailstock", |ui| {
            show_value(
                ui,
                &say::stock_word_quill(),
                &mut tailstock.quill.0,
                language,
            );
            show_value(
                ui,
                &say::stock_word_center(),
                &mut tailstock.center.0,
                language,
            );
        });
    }
}

/// Draws the choice of the material, which changes the pictures, and that of its grade, which
/// changes the load.
fn show_material(ui: &mut Ui, stock: &mut Stock, language: Language) {
    let material = &mut stock.material;
    ComboBox::from_label(say::stock_material().text(language))
        .selected_text(material.name().text(language))
        .show_ui(ui, |ui| {
            for choice in StockMaterial::ALL {
                ui.selectable_value(material, choice, choice.name().text(language));
            }
        });
    let usual = say::stock_grade_usual().text(language);
    let grade = &mut stock.grade;
    ComboBox::from_label(say::stock_grade().text(language))
        .selected_text(grade.clone().unwrap_or_else(|| usual.clone()))
        .show_ui(ui, |ui| {
            ui.selectable_value(grade, None, usual);
            for choice in CuttingMaterial::all() {
                ui.selectable_value(grade, Some(choice.name.to_owned()), choice.name);
            }
        });
}

/// Draws the choice of the form of the stock (bar, tube or contour), with the fields of the
/// chosen form.
fn show_form(ui: &mut Ui, form: &mut StockForm, language: Language) {
    let (outside, inside) = match form {
        StockForm::Bar { diameter } => (*diameter, None),
        StockForm::Tube { diameter, bore } => (*diameter, Some(*bore)),
        StockForm::Contour { corners, bore } => {
            let greatest = corners.iter().map(|corner| corner.0.0).fold(0.0, f64::max);
            (Diameter(greatest), Some(*bore))
        }
    };
    ui.horizontal_wrapped(|ui| {
        let is_bar = matches!(form, StockForm::Bar { .. });
        if ui.radio(is_bar, say::stock_bar().text(language)).clicked() {
            *form = StockForm::Bar { diameter: outside };
        }
        let is_tube = matches!(form, StockForm::Tube { .. });
        if ui
            .radio(is_tube, say::stock_tube().text(language))
            .clicked()
        {
            *form = StockForm::Tube {
                diameter: outside,
                bore: inside.unwrap_or(Diameter(outside.0 / 2.0)),
            };
        }
        let is_contour = matches!(form, StockForm::Contour { .. });
        let contour = ui.radio(is_contour, say::stock_contour().text(language));
        if contour.clicked() && !is_contour {
            *form = StockForm::Contour {
                corners: vec![(outside, 0.0), (outside, -50.0)],
                bore: inside.unwrap_or_default(),
            };
        }
    });
    show_grid(ui, "form", |ui| match form {
        StockForm::Bar { diameter } => {
            show_value(ui, &say::stock_word_diameter(), &mut diameter.0, language);
        }
        StockForm::Tube { diameter, bore } => {
            show_value(ui, &say::stock_word_diameter(), &mut diameter.0, language);
            show_value(ui, &say::stock_word_bore(), &mut bore.0, language);
        }
        StockForm::Contour { corners, bore } => {
            show_corners(ui, corners, language);
            show_value(ui, &say::stock_word_bore(), &mut bore.0, language);
        }
    });
}

/// Draws the corners of a contour from the front to the back as diameter and Z, mm, with
/// buttons that add and remove corners.
fn show_corners(ui: &mut Ui, corners: &mut Vec<(Diameter, f64)>, language: Language) {
    let mut removed = None;
    let count = corners.len();
    for (index, (diameter, z)) in corners.iter_mut().enumerate() {
        ui.horizontal(|ui| {
            for (prefix, field) in [("⌀ ", &mut diameter.0), ("Z ", z)] {
                let drag = DragValue::new(field).prefix(prefix);
                ui.add(drag.range(-LIMIT_MM..=LIMIT_MM).speed(0.1).max_decimals(3));
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

/// Draws the fields of the insert, the imaginary tip and the holder of a tool.
pub fn show_tool(ui: &mut Ui, tool: &mut Tool, language: Language) {
    if let Insert::Turning { letter, .. } = &mut tool.insert {
        ui.horizontal_wrapped(|ui| {
            for each in InsertLetter::ALL {
                ui.selectable_value(letter, each, format!("{each:?}"));
            }
        });
    }
    show_grid(ui, "insert", |ui| {
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
            show_value(ui, &name, field, language);
        }
    });
    show_tip(ui, &mut tool.tip, language);
    show_holder(ui, &mut tool.holder, language);
}

/// Draws the choice of the imaginary tip number as a grid of directions from the nose centre.
fn show_tip(ui: &mut Ui, tip: &mut u8, language: Language) {
    ui.horizontal(|ui| {
        Grid::new("tip").spacing([2.0, 2.0]).show(ui, |ui| {
            // X increases upwards, Z to the right.
            for x in [1.0, 0.0, -1.0] {
                for z in [-1.0, 0.0, 1.0] {
                    let points_to_cell = |number: &u8| {
                        let direction = tip_direction(*number);
                        (direction.x, direction.z) == (x, z)
                    };
                    if let Some(number) = (0..=8).find(points_to_cell) {
                        ui.selectable_value(tip, number, format!(" {number} "));
                    }
                }
                ui.end_row();
            }
        });
        ui.label(say::tool_word_tip().text(language));
    });
}

fn show_holder(ui: &mut Ui, holder: &mut Holder, language: Language) {
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
    show_grid(ui, "holder", |ui| match holder {
        Holder::None => {}
        Holder::Shank { width, length } => {
            show_value(ui, &say::tool_word_holder_width(), width, language);
            show_value(ui, &say::tool_word_holder_length(), length, language);
        }
        Holder::Bar { diameter, length } => {
            show_value(ui, &say::tool_word_holder_diameter(), diameter, language);
            show_value(ui, &say::tool_word_holder_length(), length, language);
        }
    });
}

/// Draws the optional position of the work zero on the lathe, for jobs in which it differs
/// from the control's.
pub fn show_zero(ui: &mut Ui, zero: &mut Option<DiameterPoint>, language: Language) {
    let mut is_set = zero.is_some();
    let check = ui.checkbox(&mut is_set, say::job_zero().text(language));
    let hint = say::job_zero_hint().text(language);
    if check.on_hover_text(hint).changed() {
        *zero = is_set.then(DiameterPoint::default);
    }
    if let Some(point) = zero {
        show_point(ui, "zero", point, language);
    }
}

/// Draws the optional true length of the tool with this number.
pub fn show_length(
    ui: &mut Ui,
    lengths: &mut BTreeMap<u8, DiameterPoint>,
    number: u8,
    language: Language,
) {
    let mut is_set = lengths.contains_key(&number);
    let check = ui.checkbox(&mut is_set, say::job_length().text(language));
    let hint = say::job_length_hint().text(language);
    if check.on_hover_text(hint).changed() {
        if is_set {
            lengths.insert(number, DiameterPoint::default());
        } else {
            lengths.remove(&number);
        }
    }
    if let Some(point) = lengths.get_mut(&number) {
        show_point(ui, "length", point, language);
    }
}

fn show_point(ui: &mut Ui, id: &str, place: &mut DiameterPoint, language: Language) {
    show_grid(ui, id, |ui| {
        show_value(ui, &say::job_place_x(), &mut place.x.0, language);
        show_value(ui, &say::job_place_z(), &mut place.z, language);
    });
}
