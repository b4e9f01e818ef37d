//! The points of an outline as a table: diameter, Z, length, angle, corner.

use egui::{ComboBox, Grid, TextEdit, Ui};
use gsk_forms::{CornerShape, TurnedOutline, TurnedPoint};
use gsk_messages::{Language, Message, say};

/// Width of a cell, points.
const CELL_WIDTH: f32 = 52.0;
/// Width of the choice of the corner, points.
const CORNER_WIDTH: f32 = 64.0;
/// The letters of the cells.
const LETTERS: [char; 4] = ['X', 'Z', 'L', 'A'];

/// A point as it is typed.
#[derive(Clone, Debug, Default)]
struct PointDraft {
    cells: [String; 4],
    /// 0 sharp, 1 radius, 2 chamfer.
    corner: usize,
    size: String,
}

impl PointDraft {
    fn new(point: &TurnedPoint) -> Self {
        let values = [point.diameter, point.z, point.length, point.angle];
        let (corner, size) = match point.corner {
            CornerShape::Sharp => (0, String::new()),
            CornerShape::Radius(size) => (1, size.to_string()),
            CornerShape::Chamfer(size) => (2, size.to_string()),
        };
        Self {
            cells: values.map(|it| it.map(|it| it.to_string()).unwrap_or_default()),
            corner,
            size,
        }
    }

    /// The point as text: `X20Z-5R2`.
    fn text(&self) -> String {
        let mut text = String::new();
        for (letter, cell) in LETTERS.into_iter().zip(&self.cells) {
            if !cell.trim().is_empty() {
                text.push_str(&format!("{letter}{}", cell.trim()));
            }
        }
        match self.corner {
            1 => text.push_str(&format!("R{}", self.size.trim())),
            2 => text.push_str(&format!("C{}", self.size.trim())),
            _ => {}
        }
        text
    }
}

/// The table, kept while points are typed that cannot be read yet.
#[derive(Debug, Default)]
pub struct OutlineTable {
    points: Vec<PointDraft>,
}

impl OutlineTable {
    /// The points of an outline.
    pub fn new(outline: &TurnedOutline) -> Self {
        Self {
            points: outline.points.iter().map(PointDraft::new).collect(),
        }
    }

    /// Draws the table. Returns the text of all points if one was changed.
    pub fn show(&mut self, ui: &mut Ui, language: Language) -> Option<String> {
        let mut is_changed = false;
        let mut removed = None;
        let columns = [
            say::form_column_x(),
            say::form_column_z(),
            say::form_column_l(),
            say::form_column_a(),
            say::form_column_corner(),
        ];
        Grid::new("outline points")
            .num_columns(8)
            .spacing([4.0, 3.0])
            .show(ui, |ui| {
                ui.label("");
                for column in &columns {
                    ui.small(column.text(language));
                }
                ui.end_row();
                for (index, point) in self.points.iter_mut().enumerate() {
                    ui.label((index + 1).to_string());
                    is_changed |= show_point(ui, index, point, &columns, language);
                    let remove = ui
                        .button("✖")
                        .on_hover_text(say::form_point_remove().text(language));
                    if remove.clicked() {
                        removed = Some(index);
                    }
                    ui.end_row();
                }
            });
        if let Some(index) = removed {
            self.points.remove(index);
            is_changed = true;
        }
        if ui.button(say::form_point_add().text(language)).clicked() {
            self.points.push(PointDraft::default());
        }
        // An empty row waits for its first value.
        let texts = self.points.iter().map(PointDraft::text);
        let texts: Vec<String> = texts.filter(|text| !text.is_empty()).collect();
        is_changed.then(|| texts.join("/"))
    }
}

/// Draws the cells of a point; returns whether one was changed.
fn show_point(
    ui: &mut Ui,
    index: usize,
    point: &mut PointDraft,
    columns: &[Message; 5],
    language: Language,
) -> bool {
    let mut is_changed = false;
    let cell = |ui: &mut Ui, text: &mut String, name: &Message| {
        let response = ui.add(TextEdit::singleline(text).desired_width(CELL_WIDTH));
        let name = say::form_cell_name(index + 1, name.clone()).text(language);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, &name));
        response.on_hover_text(name).changed()
    };
    for (text, name) in point.cells.iter_mut().zip(columns) {
        is_changed |= cell(ui, text, name);
    }
    let names = [
        say::form_option_sharp(),
        say::form_option_radius(),
        say::form_option_chamfer(),
    ];
    let chosen = names[point.corner.min(2)].text(language);
    ComboBox::from_id_salt(("corner", index))
        .width(CORNER_WIDTH)
        .selected_text(chosen)
        .show_ui(ui, |ui| {
            for (value, name) in names.iter().enumerate() {
                let choice = ui.selectable_value(&mut point.corner, value, name.text(language));
                is_changed |= choice.changed();
            }
        });
    if point.corner > 0 {
        if point.size.is_empty() {
            point.size = "1".to_owned();
        }
        is_changed |= cell(ui, &mut point.size, &columns[4]);
    } else {
        ui.label("");
    }
    is_changed
}
