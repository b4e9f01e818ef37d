//! The pane of the selected seat: its LCD, and what the instructor requests.

use std::borrow::Cow;

use egui::{ColorImage, Image, RichText, TextureHandle, TextureOptions, Ui, Vec2};
use gsk_core::machine::LatheFault;
use gsk_exercise::task::ExerciseTask;
use gsk_host::network::class::class_roster::{ClassSeat, SeatUrgency};
use gsk_host::network::class::class_table::{program_text, task_text};
use gsk_host::network::class::lcd_picture::{LCD_WIDTH, LcdPicture};
use gsk_host::network::class::seat_request::{SeatRefusal, SeatRequest, SeatRights};
use gsk_messages::{Language, say};

use super::tiles::urgency_color;
use crate::theme;

/// Size of the LCD, points.
const LCD_SIZE: Vec2 = Vec2::new(320.0, 240.0);
/// Time for which a request keeps the LCD live, s.
const LCD_S: u16 = 10;
/// Time after which the pane renews that request, ms.
const LCD_RENEWAL_MS: u64 = 6000;

/// The state of the pane.
#[derive(Default)]
pub struct SeatPane {
    /// Whether the instructor watches the LCD.
    watches_lcd: bool,
    /// Time of the newest request for the LCD of the seat, ms; `None` before the first one.
    requested_ms: Option<u64>,
    picture: Option<LcdPicture>,
    texture: Option<TextureHandle>,
}

impl SeatPane {
    /// Takes a new picture of the LCD.
    pub fn set_lcd(&mut self, picture: LcdPicture) {
        self.picture = Some(picture);
    }

    /// Draws the pane; returns a request for the seat.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        language: Language,
        seat: &ClassSeat,
        tasks: &[ExerciseTask],
        now_ms: u64,
    ) -> Option<SeatRequest> {
        let report = &seat.report;
        ui.heading(&report.name);
        let state = seat.state_message().text(language);
        ui.label(RichText::new(state).color(urgency_color(seat.urgency)));
        if let Some(trouble) = &report.trouble {
            ui.label(trouble.text.text(language));
        }
        for text in [
            report.mode.text(language).to_owned(),
            program_text(seat),
            task_text(seat, language),
        ] {
            if !text.is_empty() {
                ui.label(text);
            }
        }
        ui.separator();
        let mut request = self.show_lcd(ui, language, seat, now_ms);
        ui.separator();
        request = show_help(ui, language, seat).or(request);
        request = show_tasks(ui, language, seat, tasks).or(request);
        request = show_faults(ui, language, seat).or(request);
        request
    }

    /// Draws the LCD while it is watched; returns the request that keeps it live.
    fn show_lcd(
        &mut self,
        ui: &mut Ui,
        language: Language,
        seat: &ClassSeat,
        now_ms: u64,
    ) -> Option<SeatRequest> {
        if !self.watches_lcd {
            let name = say::class_show_lcd().text(language);
            let is_online = seat.urgency != SeatUrgency::Offline;
            self.watches_lcd = ui.add_enabled(is_online, egui::Button::new(name)).clicked();
            return None;
        }
        if let Some(picture) = self.picture.take() {
            let image = lcd_image(&picture);
            let texture = ui
                .ctx()
                .load_texture("class lcd", image, TextureOptions::LINEAR);
            self.texture = Some(texture);
        }
        match &self.texture {
            Some(texture) => {
                let image = Image::new((texture.id(), LCD_SIZE));
                ui.add(image.alt_text(say::class_show_lcd().text(language)));
            }
            None => {
                ui.label(say::class_lcd_waiting(&seat.report.name).text(language));
            }
        }
        if ui.button(say::class_close_lcd().text(language)).clicked() {
            *self = Self::default();
            return None;
        }
        let is_due = (self.requested_ms).is_none_or(|last| now_ms >= last + LCD_RENEWAL_MS);
        if !is_due {
            return None;
        }
        self.requested_ms = Some(now_ms);
        Some(SeatRequest::Lcd { seconds: LCD_S })
    }
}

/// The picture in its colours.
fn lcd_image(picture: &LcdPicture) -> ColorImage {
    let dots = picture.dots.iter();
    let bytes: Vec<u8> = dots
        .flat_map(|dot| match dot {
            true => picture.text,
            false => picture.background,
        })
        .collect();
    ColorImage::from_rgb([LCD_WIDTH, picture.dots.len() / LCD_WIDTH], &bytes)
}

/// Draws the button that ends a request for help.
fn show_help(ui: &mut Ui, language: Language, seat: &ClassSeat) -> Option<SeatRequest> {
    let coming = say::class_helped().text(language);
    let is_requested = seat.report.asks_help;
    (is_requested && ui.button(coming).clicked()).then_some(SeatRequest::Coming)
}

/// Draws the menu of the exercises.
fn show_tasks(
    ui: &mut Ui,
    language: Language,
    seat: &ClassSeat,
    tasks: &[ExerciseTask],
) -> Option<SeatRequest> {
    let mut request = None;
    let refusal = refusal(seat, |rights| {
        let exercise = String::new();
        SeatRequest::Task { exercise }.refusal(rights)
    });
    let name = say::class_send_task().text(language);
    show_menu(ui, &name, refusal, language, |ui| {
        for task in tasks {
            let title: Cow<'_, str> = task.title.in_language(language);
            if ui.button(title).clicked() {
                request = Some(SeatRequest::Task {
                    exercise: task.id.clone(),
                });
                ui.close();
            }
        }
    });
    request
}

/// Draws the menu of the faults, and the button that clears them.
fn show_faults(ui: &mut Ui, language: Language, seat: &ClassSeat) -> Option<SeatRequest> {
    let mut request = None;
    let refusal = refusal(seat, |rights| SeatRequest::ClearFaults.refusal(rights));
    let name = say::class_send_fault().text(language);
    show_menu(ui, &name, refusal, language, |ui| {
        for (_, fault) in LatheFault::ALL {
            if ui.button(fault.row().label().text(language)).clicked() {
                request = Some(SeatRequest::Fault { fault });
                ui.close();
            }
        }
    });
    let clear = egui::Button::new(say::class_clear_faults().text(language));
    if ui.add_enabled(refusal.is_none(), clear).clicked() {
        request = Some(SeatRequest::ClearFaults);
    }
    request
}

/// Why the seat would refuse a request, as its report says. The seat itself decides.
pub fn refusal(
    seat: &ClassSeat,
    check: impl Fn(SeatRights) -> Option<SeatRefusal>,
) -> Option<SeatRefusal> {
    let task = seat.report.task.as_ref();
    check(SeatRights {
        has_board: seat.report.has_board,
        allows_faults: seat.report.allows_faults,
        is_in_exam: task.is_some_and(|task| task.is_exam && !task.is_handed_in),
    })
}

/// Draws a menu; a refusal disables it and is its tip.
fn show_menu(
    ui: &mut Ui,
    name: &str,
    refusal: Option<SeatRefusal>,
    language: Language,
    entries: impl FnOnce(&mut Ui),
) {
    let menu = ui.add_enabled_ui(refusal.is_none(), |ui| {
        ui.menu_button(name, |ui| {
            egui::ScrollArea::vertical().show(ui, entries);
        })
        .response
    });
    if let Some(refusal) = refusal {
        let reason = refusal.message().text(language);
        menu.inner.on_disabled_hover_text(&reason);
        ui.label(RichText::new(reason).color(theme::HINT_TEXT));
    }
}
