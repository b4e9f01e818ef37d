//! Cards: large buttons with a picture, a title, a line of details and a mark of progress.

use egui::{
    Align2, Color32, FontId, Galley, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke,
    StrokeKind, TextStyle, Ui, Vec2, WidgetInfo, pos2, text::LayoutJob, vec2,
};
use std::sync::Arc;

use super::icons::Icon;
use crate::theme;

/// Height of a card whose texts fit into three lines, points. Longer texts make it higher.
const HEIGHT: f32 = 60.0;
/// Greatest number of lines of a title, and of the details under it.
const MAX_LINES: (usize, usize) = (3, 2);
/// Minimum width of a card beside another one, points.
const MIN_WIDTH: f32 = 190.0;
/// Maximum width of a card, points.
const MAX_WIDTH: f32 = 420.0;
/// Width and height of the picture on a card, points.
const PICTURE_SIZE: Vec2 = vec2(56.0, 44.0);
/// Space between the edge of the card, its picture and its texts, points.
const MARGIN: f32 = 8.0;
const CORNER_RADIUS: f32 = 6.0;

/// The outline of a turned part from the face to the chuck: Z and radius of each corner, mm.
pub type SampleOutline = &'static [(f32, f32)];

/// The picture that a card shows at its left edge.
#[derive(Clone, Copy, Debug)]
pub enum CardPicture {
    Icon(Icon),
    Part(SampleOutline),
}

/// The texts and the picture of a card.
#[derive(Clone, Debug)]
pub struct Card {
    pub picture: CardPicture,
    pub title: String,
    /// A line under the title: time, number of steps, file name. May be empty.
    pub detail: String,
    /// Whether the card has a mark, as chosen or done.
    pub is_marked: bool,
}

/// The texts of a card as they are broken into lines.
struct CardTexts {
    title: Arc<Galley>,
    detail: Arc<Galley>,
}

impl CardTexts {
    fn height(&self) -> f32 {
        self.title.size().y + self.detail.size().y
    }

    /// The height of a card that shows these texts.
    fn card_height(&self) -> f32 {
        HEIGHT.max(self.height() + MARGIN)
    }
}

impl Card {
    /// Draws the card; its accessible name is its title.
    pub fn show(&self, ui: &mut Ui, width: f32) -> Response {
        let texts = self.layout_texts(ui, width);
        let height = texts.card_height();
        self.show_with(ui, texts, vec2(width, height))
    }

    fn layout_texts(&self, ui: &Ui, width: f32) -> CardTexts {
        let mark = match self.is_marked {
            true => theme::ICON_SIZE + MARGIN,
            false => 0.0,
        };
        let text_width = (width - PICTURE_SIZE.x - 3.0 * MARGIN - mark).max(20.0);
        let title_font = TextStyle::Body.resolve(ui.style());
        let detail_font = TextStyle::Small.resolve(ui.style());
        let (title, detail) = (&self.title, &self.detail);
        CardTexts {
            title: layout(
                ui,
                title,
                title_font,
                theme::TEXT,
                (text_width, MAX_LINES.0),
            ),
            detail: layout(
                ui,
                detail,
                detail_font,
                theme::NOTE_TEXT,
                (text_width, MAX_LINES.1),
            ),
        }
    }

    fn show_with(&self, ui: &mut Ui, texts: CardTexts, size: Vec2) -> Response {
        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
        response.widget_info(|| {
            WidgetInfo::selected(Role::Button, ui.is_enabled(), self.is_marked, &self.title)
        });
        let painter = ui.painter_at(rect);
        let ground = match response.hovered() || response.has_focus() {
            true => theme::CHOICE_SELECTED_GROUND,
            false => theme::CHOICE_GROUND,
        };
        painter.rect_filled(rect, CORNER_RADIUS, ground);
        if response.has_focus() || self.is_marked {
            let color = match response.has_focus() {
                true => theme::ACCENT,
                false => theme::SUCCESS,
            };
            let stroke = Stroke::new(1.5, color);
            painter.rect_stroke(rect, CORNER_RADIUS, stroke, StrokeKind::Inside);
        }
        let corner = rect.left_center() + vec2(MARGIN, -PICTURE_SIZE.y / 2.0);
        let picture = Rect::from_min_size(corner, PICTURE_SIZE);
        painter.rect_filled(picture, CORNER_RADIUS / 2.0, theme::DRAWING_GROUND);
        match self.picture {
            CardPicture::Icon(icon) => icon.paint(
                &painter,
                picture.center(),
                theme::PICTURE_ICON_SIZE,
                theme::ACCENT,
            ),
            CardPicture::Part(outline) => paint_part(&painter, picture.shrink(5.0), outline),
        }
        let left = picture.right() + MARGIN;
        let top = rect.center().y - texts.height() / 2.0;
        let under = top + texts.title.size().y;
        painter.galley(pos2(left, top), texts.title, theme::TEXT);
        painter.galley(pos2(left, under), texts.detail, theme::NOTE_TEXT);
        if self.is_marked {
            let at = rect.right_center() - vec2(MARGIN + theme::ICON_SIZE / 2.0, 0.0);
            Icon::DONE.paint(&painter, at, theme::ICON_SIZE, theme::SUCCESS);
        }
        response
    }
}

fn layout(
    ui: &Ui,
    text: &str,
    font: FontId,
    color: Color32,
    (width, rows): (f32, usize),
) -> Arc<Galley> {
    let mut job = LayoutJob::simple(text.to_owned(), font, color, width);
    job.wrap.max_rows = rows;
    ui.ctx().fonts_mut(|fonts| fonts.layout_job(job))
}

/// Draws the half of the part above its axis shaded, the half below it as an outline.
fn paint_part(painter: &Painter, rect: Rect, outline: SampleOutline) {
    let length = outline.iter().fold(1.0, |most, (z, _)| f32::max(most, *z));
    let radius = outline.iter().fold(1.0, |most, (_, r)| f32::max(most, *r));
    let scale = (rect.width() / length).min(rect.height() / 2.0 / radius);
    let axis = rect.center().y;
    let right = rect.center().x + length * scale / 2.0;
    let at = |z: f32, r: f32| pos2(right - z * scale, axis - r * scale);
    for pair in outline.windows(2) {
        let &[(from, one), (to, other)] = pair else {
            continue;
        };
        if from != to {
            let corners = vec![at(from, 0.0), at(from, one), at(to, other), at(to, 0.0)];
            painter.add(Shape::convex_polygon(
                corners,
                theme::ACCENT_GROUND,
                Stroke::NONE,
            ));
        }
    }
    for sign in [1.0, -1.0] {
        let points: Vec<Pos2> = outline.iter().map(|(z, r)| at(*z, r * sign)).collect();
        painter.line(points, Stroke::new(1.5, theme::ACCENT));
    }
    let ends = [at(-2.0 / scale, 0.0), at(length + 2.0 / scale, 0.0)];
    let stroke = Stroke::new(1.0, theme::SPINDLE_AXIS);
    painter.extend(Shape::dashed_line(&ends, stroke, 6.0, 3.0));
}

/// Draws cards of equal width in rows, those of a row of equal height. Returns the responses in
/// the order of the cards.
pub fn show_cards(ui: &mut Ui, cards: &[Card]) -> Vec<Response> {
    let space = ui.spacing().item_spacing.x;
    let available = ui.available_width();
    let columns = ((available + space) / (MIN_WIDTH + space)).floor().max(1.0);
    let width = ((available - space * (columns - 1.0)) / columns).min(MAX_WIDTH);
    let mut responses = Vec::with_capacity(cards.len());
    for row in cards.chunks(columns as usize) {
        ui.horizontal(|ui| {
            let texts: Vec<CardTexts> = row.iter().map(|it| it.layout_texts(ui, width)).collect();
            let height = texts.iter().map(CardTexts::card_height).fold(0.0, f32::max);
            let cards = row.iter().zip(texts);
            let shown = cards.map(|(card, texts)| card.show_with(ui, texts, vec2(width, height)));
            responses.extend(shown);
        });
    }
    responses
}

/// Draws a heading with an icon above a group of cards.
pub fn show_heading(ui: &mut Ui, icon: Icon, text: &str) {
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(Vec2::splat(theme::ICON_SIZE), Sense::HOVER);
        icon.paint(ui.painter(), rect.center(), theme::ICON_SIZE, theme::ACCENT);
        ui.heading(text);
    });
}

/// Draws how many of all lessons are done, as a bar.
pub fn show_progress(ui: &mut Ui, done: usize, total: usize, text: &str) {
    let size = vec2(ui.available_width().min(MAX_WIDTH), 6.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::HOVER);
    response.widget_info(|| WidgetInfo::labeled(Role::ProgressIndicator, true, text));
    let share = done as f32 / total.max(1) as f32;
    let mut full = rect;
    full.set_width(rect.width() * share);
    ui.painter().rect_filled(rect, 3.0, theme::CHOICE_GROUND);
    ui.painter().rect_filled(full, 3.0, theme::SUCCESS);
    let font = TextStyle::Small.resolve(ui.style());
    let (rect, _) = ui.allocate_exact_size(vec2(size.x, font.size + 4.0), Sense::HOVER);
    ui.painter().text(
        rect.left_center(),
        Align2::LEFT_CENTER,
        text,
        font,
        theme::NOTE_TEXT,
    );
}
