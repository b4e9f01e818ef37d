//! Shows an error dialog when the window cannot be opened: another one is open, or the data
//! directory cannot be written.

use eframe::egui::{self, Button};
use gsk_host::platform;

use crate::{TITLE, fonts, theme};
use gsk_messages::{Language, Message, say};

/// Size of the error dialog, points.
const DIALOG_SIZE: [f32; 2] = [560.0, 230.0];

/// Shows a message until the operator closes it: in `language`, or in both languages if that
/// is `None`. Without a display nothing is shown.
pub fn show(message: &Message, language: Option<Language>) {
    let texts = translate(message, language);
    let viewport = egui::ViewportBuilder::default()
        .with_title(TITLE)
        .with_app_id("gsk980td")
        .with_inner_size(DIALOG_SIZE)
        .with_resizable(false);
    // The caller has printed the message on standard error as well.
    let _ = platform::open_window(
        "gsk980td",
        viewport,
        Box::new(move |creation| {
            fonts::set_up(&creation.egui_ctx);
            Ok(Box::new(ErrorDialog { sentences: texts }))
        }),
    );
}

fn translate(message: &Message, language: Option<Language>) -> Vec<String> {
    let languages = match language {
        Some(language) => vec![language],
        None => vec![Language::Zh, Language::En],
    };
    let sentences = languages.into_iter();
    let mut sentences: Vec<String> = sentences.map(|language| message.text(language)).collect();
    sentences.dedup();
    sentences
}

/// Formats the message in English and in Chinese, one after the other.
fn in_both_languages(message: &Message) -> String {
    let texts = [Language::En, Language::Zh].map(|language| message.text(language));
    texts.join(" / ")
}

struct ErrorDialog {
    sentences: Vec<String>,
}

impl eframe::App for ErrorDialog {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        let frame = egui::Frame::new().inner_margin(18);
        egui::CentralPanel::default().frame(frame).show(ui, |ui| {
            ui.heading(TITLE);
            ui.add_space(6.0);
            for sentence in &self.sentences {
                let font = egui::FontId::proportional(theme::READING_SIZE);
                ui.label(fonts::layout_text(
                    sentence,
                    font,
                    ui.visuals().text_color(),
                ));
                ui.add_space(8.0);
            }
            let button = ui.add(Button::new(format!(
                "   {}   ",
                in_both_languages(&say::window_confirm())
            )));
            let keys = [egui::Key::Enter, egui::Key::Escape];
            let pressed = ui.input(|input| keys.iter().any(|key| input.key_pressed(*key)));
            if button.clicked() || pressed {
                platform::close_error_dialog(ui.ctx());
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use gsk_host::files::data_dir::DataDirError;

    #[test]
    fn startup_errors_are_shown_in_both_languages() {
        let path = PathBuf::from("/data");
        let source = std::io::Error::from(std::io::ErrorKind::PermissionDenied);
        for error in [
            DataDirError::InUse { path: path.clone() },
            DataDirError::Unusable { path, source },
            DataDirError::NoDefault,
        ] {
            let message = error.message();
            let both = translate(&message, None);
            assert_eq!(both.len(), 2, "no Chinese for: {message}");
            assert_eq!(translate(&message, Some(Language::En)), [error.to_string()]);
            assert_eq!(translate(&message, Some(Language::Zh)), both[..1]);
        }
    }
}
