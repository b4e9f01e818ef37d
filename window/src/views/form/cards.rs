//! The forms as cards with a small picture of what each cuts.

use egui::{
    Align2, Color32, ComboBox, FontId, Painter, Pos2, Rect, Role, Shape, Stroke, StrokeKind, Ui,
    WidgetInfo, pos2, vec2,
};
use gsk_forms::FormKind;
use gsk_messages::{Language, say};

use crate::focus::{FocusList, ROW_SENSE};
use crate::theme;

/// Width and height of a card, points.
const CARD_SIZE: egui::Vec2 = vec2(70.0, 60.0);
/// Height of the name at the lower edge of a card, points.
const NAME_HEIGHT: f32 = 18.0;
const CORNER_RADIUS: f32 = 5.0;
/// Space between two cards, points.
const GAP: f32 = 4.0;

/// A line of a picture: points across (0 to 1) and down (0 to 1); the axis is at the lower edge.
type PictureLine = &'static [(f32, f32)];

/// Draws the cards and returns the form that was chosen; `None` without a choice.
pub fn show_cards(ui: &mut Ui, chosen: FormKind, language: Language) -> Option<FormKind> {
    let mut choice = None;
    let name = say::form_list_name().text(language);
    let count = FormKind::ALL.len();
    let row = FormKind::ALL.iter().position(|form| *form == chosen);
    let list = FocusList::begin(ui, "forms", &name, count, row);
    ui.spacing_mut().item_spacing = vec2(GAP, GAP);
    let columns = ((ui.available_width() + GAP) / (CARD_SIZE.x + GAP)).floor() as usize;
    for (line, forms) in FormKind::ALL.chunks(columns.max(1)).enumerate() {
        ui.horizontal(|ui| {
            for (column, form) in forms.iter().enumerate() {
                let row = line * columns.max(1) + column;
                let response = show_card(ui, *form, *form == chosen, language);
                let is_clicked = list.show_cursor(ui, row, &response);
                response.on_hover_text(form.purpose().text(language));
                if is_clicked || list.entered_row() == Some(row) || list.moved_row() == Some(row) {
                    choice = Some(*form);
                }
            }
        });
    }
    choice.filter(|form| *form != chosen)
}

/// Draws the forms as a list that opens, for a low pane. Returns the form that was chosen.
pub fn show_choice(ui: &mut Ui, chosen: FormKind, language: Language) -> Option<FormKind> {
    let mut choice = chosen;
    ComboBox::from_label(say::form_list_name().text(language))
        .selected_text(chosen.name().text(language))
        .show_ui(ui, |ui| {
            for form in FormKind::ALL {
                ui.selectable_value(&mut choice, form, form.name().text(language));
            }
        });
    (choice != chosen).then_some(choice)
}

fn show_card(ui: &mut Ui, form: FormKind, is_chosen: bool, language: Language) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(CARD_SIZE, ROW_SENSE);
    let name = form.name().text(language);
    response.widget_info(|| WidgetInfo::selected(Role::ListBoxOption, true, is_chosen, &name));
    let painter = ui.painter_at(rect);
    let ground = match is_chosen || response.hovered() {
        true => theme::CHOICE_SELECTED_GROUND,
        false => theme::CHOICE_GROUND,
    };
    painter.rect_filled(rect, CORNER_RADIUS, ground);
    if is_chosen {
        let stroke = Stroke::new(1.5, theme::ACCENT);
        painter.rect_stroke(rect, CORNER_RADIUS, stroke, StrokeKind::Inside);
    }
    let mut picture = rect.shrink(6.0);
    picture.max.y -= NAME_HEIGHT - 4.0;
    draw_picture(&painter, picture, form);
    let at = pos2(rect.center().x, rect.bottom() - NAME_HEIGHT / 2.0 - 1.0);
    let font = FontId::proportional(theme::LABEL_SIZE);
    painter.text(at, Align2::CENTER_CENTER, name, font, theme::TEXT);
    response
}

/// The part in grey, what the form cuts as a bright line, the axis below.
fn draw_picture(painter: &Painter, rect: Rect, form: FormKind) {
    let at = |point: &(f32, f32)| {
        pos2(
            rect.left() + point.0 * rect.width(),
            rect.top() + point.1 * rect.height(),
        )
    };
    let line = |points: PictureLine, width: f32, color: Color32| {
        let points: Vec<Pos2> = points.iter().map(at).collect();
        painter.add(Shape::line(points, Stroke::new(width, color)));
    };
    let (stock, cut) = outline(form);
    line(stock, 1.0, theme::PART_EDGE);
    line(cut, 2.5, theme::FEED_PATH);
    let axis = [at(&(0.0, 1.0)), at(&(1.0, 1.0))];
    let stroke = Stroke::new(1.0, theme::SPINDLE_AXIS);
    painter.extend(Shape::dashed_line(&axis, stroke, 6.0, 3.0));
}

/// The outline of the stock, and the line that the form cuts.
const fn outline(form: FormKind) -> (PictureLine, PictureLine) {
    match form {
        FormKind::Face => (
            &[(0.0, 0.2), (0.85, 0.2), (0.85, 1.0)],
            &[(0.75, 0.1), (0.75, 1.0)],
        ),
        FormKind::Turn => (
            &[(0.0, 0.1), (0.85, 0.1), (0.85, 1.0)],
            &[(0.3, 0.1), (0.3, 0.5), (0.75, 0.5), (0.85, 0.6)],
        ),
        FormKind::Bore => (
            &[(0.0, 0.1), (0.85, 0.1), (0.85, 0.5), (0.0, 0.8)],
            &[(0.85, 0.45), (0.8, 0.5), (0.3, 0.5), (0.3, 0.8), (0.0, 0.8)],
        ),
        FormKind::Contour => (
            &[(0.0, 0.05), (0.9, 0.05), (0.9, 1.0)],
            &[
                (0.0, 0.15),
                (0.2, 0.15),
                (0.25, 0.35),
                (0.45, 0.4),
                (0.65, 0.65),
                (0.85, 0.65),
                (0.9, 0.72),
            ],
        ),
        FormKind::Groove => (
            &[(0.0, 0.2), (0.9, 0.2), (0.9, 1.0)],
            &[
                (0.15, 0.2),
                (0.4, 0.2),
                (0.4, 0.6),
                (0.6, 0.6),
                (0.6, 0.2),
                (0.9, 0.2),
            ],
        ),
        FormKind::PartOff => (
            &[(0.0, 0.2), (0.9, 0.2), (0.9, 1.0)],
            &[(0.3, 0.1), (0.3, 0.98), (0.42, 0.98), (0.42, 0.1)],
        ),
        FormKind::Thread => (
            &[
                (0.0, 0.15),
                (0.4, 0.15),
                (0.4, 0.35),
                (0.9, 0.35),
                (0.9, 1.0),
            ],
            &[
                (0.4, 0.35),
                (0.45, 0.6),
                (0.5, 0.35),
                (0.55, 0.6),
                (0.6, 0.35),
                (0.65, 0.6),
                (0.7, 0.35),
                (0.75, 0.6),
                (0.8, 0.35),
                (0.85, 0.6),
                (0.9, 0.35),
            ],
        ),
        FormKind::Drill => (
            &[(0.0, 0.15), (0.9, 0.15), (0.9, 0.65)],
            &[(0.9, 0.65), (0.3, 0.65), (0.15, 1.0)],
        ),
        FormKind::Center => (
            &[(0.0, 0.15), (0.8, 0.15), (0.8, 0.6)],
            &[(0.8, 0.6), (0.45, 1.0)],
        ),
    }
}
