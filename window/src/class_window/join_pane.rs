//! The pane with which seats are joined: the address of the class as text and as a QR code.

use egui::{RichText, Ui};
use gsk_host::network::class::class_address::ClassAddress;
use gsk_host::network::reachable_broker;
use gsk_messages::{Language, Message, say};

use crate::theme;
use crate::widgets::qr_code::QrPicture;

/// The page for browsers with which a seat joins.
#[derive(Clone, Debug)]
pub struct SeatPage {
    /// Address of the page.
    pub url: String,
    /// The class with the broker that the page reaches.
    pub class: ClassAddress,
}

/// The pane.
#[derive(Default)]
pub struct JoinPane {
    seat_code: QrPicture,
    page_code: QrPicture,
}

impl JoinPane {
    /// Draws the pane.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        language: Language,
        class: &ClassAddress,
        page: Option<&SeatPage>,
    ) {
        let reachable = |class: &ClassAddress| {
            let broker = reachable_broker(&class.broker)?;
            let code = class.code.clone();
            Some(ClassAddress { code, broker })
        };
        let Some(class) = reachable(class) else {
            let local = say::class_join_local().text(language);
            ui.label(RichText::new(local).color(theme::ERROR_TEXT));
            return;
        };
        let address = class.join_text();
        let name = say::class_join_seat(&address);
        show_address(ui, language, &mut self.seat_code, &address, &name);
        let hint = say::class_join_hint().text(language);
        ui.label(RichText::new(hint).color(theme::HINT_TEXT));
        if let Some(page) = page
            && let Some(class) = reachable(&page.class)
        {
            ui.separator();
            let link = class.join_link(&page.url);
            let name = say::class_join_browser(&link);
            show_address(ui, language, &mut self.page_code, &link, &name);
        }
    }
}

fn show_address(
    ui: &mut Ui,
    language: Language,
    code: &mut QrPicture,
    address: &str,
    name: &Message,
) {
    let name = name.text(language);
    ui.label(&name);
    code.show(ui, address, &name);
    if ui.button(say::class_copy().text(language)).clicked() {
        ui.ctx().copy_text(address.to_owned());
    }
}
