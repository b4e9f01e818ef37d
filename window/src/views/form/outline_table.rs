//! The points of an outline as a table: line or arc, diameter, Z, length, angle, radius of the
//! arc, tangent, corner.

use egui::{ComboBox, Grid, RichText, TextEdit, Ui};
use gsk_forms::{CornerShape, TurnedOutline, TurnedPoint};
use gsk_messages::{Language, Message, say};

use super::keypad;
use crate::theme;

/// Width of a cell, points.
const CELL_WIDTH: f32 = 46.0;
/// Width of the choice of line or arc, points.
const WAY_WIDTH: f32 = 30.0;
/// Width of the choice of the corner, points.
const CORNER_WIDTH: f32 = 20.0;
/// Line and arcs as the table shows them.
const WAYS: [&str; 3] = ["G01", "G02", "G03"];
/// Corners as the table shows them.
const CORNERS: [&str; 3] = ["–", "R", "C"];
/// The letters of the cells.
const LETTERS: [char; 4] = ['X', 'Z', 'L', 'A'];

/// A point as it is typed.
#[derive(Clone, Debug, Default)]
struct PointDraft {
    cells: [String; 4],
    /// An index of [`WAYS`].
    way: usize,
    arc_radius: String,
    is_tangent: bool,
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
        let arc_radius = point.arc.and_then(|arc| arc.radius);
        Self {
            cells: values.map(|it| it.map(|it| it.to_string()).unwrap_or_default()),
            way: match point.arc {
                None => 0,
                Some(arc) if arc.is_clockwise => 1,
                Some(_) => 2,
            },
            arc_radius: arc_radius.map(|it| it.to_string()).unwrap_or_default(),
            is_tangent: point.is_tangent,
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
        match self.way {
            1 => text.push_str(&format!("CW{}", self.arc_radius.trim())),
            2 => text.push_str(&format!("CCW{}", self.arc_radius.trim())),
            _ => {}
        }
        if self.is_tangent {
            text.push('T');
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

    /// Draws the table, with the number of a point that cannot be computed in another colour.
    /// Returns the text of all points if one was changed.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        broken: Option<usize>,
        language: Language,
    ) -> Option<String> {
        let mut is_changed = false;
        let mut removed = None;
        let columns = TableColumns::new();
        Grid::new("outline points")
            .num_columns(11)
            .spacing([3.0, 3.0])
            .show(ui, |ui| {
                columns.show_head(ui, language);
                for (index, point) in self.points.iter_mut().enumerate() {
                    let number = RichText::new((index + 1).to_string());
                    ui.label(match broken == Some(index + 1) {
                        true => number.color(theme::ERROR_TEXT).strong(),
                        false => number,
                    });
                    let mut row = TableRow {
                        index,
                        columns: &columns,
                        language,
                        is_changed: false,
                    };
                    row.show(ui, point);
                    is_changed |= row.is_changed;
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

/// The names of the columns.
struct TableColumns {
    way: Message,
    cells: [Message; 4],
    arc_radius: Message,
    tangent: Message,
    corner: Message,
}

impl TableColumns {
    fn new() -> Self {
        Self {
            way: say::form_column_way(),
            cells: [
                say::form_column_x(),
                say::form_column_z(),
                say::form_column_l(),
                say::form_column_a(),
            ],
            arc_radius: say::form_column_radius(),
            tangent: say::form_column_tangent(),
            corner: say::form_column_corner(),
        }
    }

    fn show_head(&self, ui: &mut Ui, language: Language) {
        ui.label("");
        let first = [&self.way].into_iter().chain(&self.cells);
        for column in first.chain([&self.arc_radius, &self.tangent, &self.corner]) {
            ui.small(column.text(language));
        }
        ui.end_row();
    }
}

/// A row that is being drawn.
struct TableRow<'a> {
    index: usize,
    columns: &'a TableColumns,
    language: Language,
    is_changed: bool,
}

impl TableRow<'_> {
    fn show(&mut self, ui: &mut Ui, point: &mut PointDraft) {
        let columns = self.columns;
        if self.index == 0 {
            ui.label("");
        } else {
            let names = [
                say::form_segment_line(),
                say::form_segment_cw(),
                say::form_segment_ccw(),
            ];
            self.show_choice(ui, ("way", WAY_WIDTH), &mut point.way, WAYS, &names);
        }
        for (text, name) in point.cells.iter_mut().zip(&columns.cells) {
            self.show_cell(ui, text, name);
        }
        match point.way {
            0 => {
                ui.label("");
            }
            _ => self.show_cell(ui, &mut point.arc_radius, &columns.arc_radius),
        }
        if self.index == 0 {
            ui.label("");
        } else {
            let tip = say::form_tangent_tip().text(self.language);
            let tangent = ui.checkbox(&mut point.is_tangent, "");
            let name = self.cell_name(&columns.tangent);
            tangent.widget_info(|| {
                egui::WidgetInfo::selected(egui::Role::CheckBox, true, point.is_tangent, &name)
            });
            self.is_changed |= tangent.on_hover_text(tip).changed();
        }
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            let names = [
                say::form_option_sharp(),
                say::form_option_radius(),
                say::form_option_chamfer(),
            ];
            self.show_choice(
                ui,
                ("corner", CORNER_WIDTH),
                &mut point.corner,
                CORNERS,
                &names,
            );
            if point.corner > 0 {
                if point.size.is_empty() {
                    point.size = "1".to_owned();
                }
                self.show_cell(ui, &mut point.size, &columns.corner);
            }
        });
    }

    fn cell_name(&self, column: &Message) -> String {
        say::form_cell_name(self.index + 1, column.clone()).text(self.language)
    }

    fn show_cell(&mut self, ui: &mut Ui, text: &mut String, column: &Message) {
        let edit = TextEdit::singleline(text).desired_width(CELL_WIDTH);
        let response = ui.add(edit.align(egui::Align2::LEFT_CENTER));
        keypad::register_field(ui, &response);
        let name = self.cell_name(column);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, &name));
        self.is_changed |= response.on_hover_text(name).changed();
    }

    /// Draws a choice that is short when closed.
    fn show_choice(
        &mut self,
        ui: &mut Ui,
        (id, width): (&str, f32),
        chosen: &mut usize,
        short: [&str; 3],
        names: &[Message; 3],
    ) {
        let name = |index: usize| {
            let names = names.get(index).map(|name| name.text(self.language));
            names.unwrap_or_default()
        };
        let shown = short.get(*chosen).copied().unwrap_or_default();
        let combo = ComboBox::from_id_salt((id, self.index))
            .width(width)
            .selected_text(shown)
            .show_ui(ui, |ui| {
                let mut is_changed = false;
                for value in 0..short.len() {
                    is_changed |= ui.selectable_value(chosen, value, name(value)).changed();
                }
                is_changed
            });
        let shown = name(*chosen);
        combo.response.on_hover_text(shown);
        self.is_changed |= combo.inner.unwrap_or(false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_keep_the_words_of_their_points() {
        let text = "X20Z0C2/L20/X30A45R1/X50Z-50CW20/X60CCWT/Z-80A-5CCW3T";
        let outline = TurnedOutline::parse(text).unwrap();
        let table = OutlineTable::new(&outline);
        let rows: Vec<String> = table.points.iter().map(PointDraft::text).collect();
        assert_eq!(rows.join("/"), text);
    }
}
