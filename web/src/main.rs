//! The program as a page in a browser: the same window on a canvas. Differences between page
//! and computer are in `host/src/platform/web/`.

fn main() {
    #[cfg(target_arch = "wasm32")]
    page::open_page();
}

#[cfg(target_arch = "wasm32")]
mod page {
    use gsk_app::cli::{SeatArgs, WindowArgs};
    use gsk_app::commands::window;
    use gsk_host::network::class::class_address::ClassAddress;
    use gsk_host::platform;
    use gsk_messages::{Language, MessageTable};

    static TEXTS: MessageTable =
        MessageTable::new(include_str!("../../assets/tables/messages.tsv"));

    /// Opens the window on the page, with the options in its link.
    pub fn open_page() {
        gsk_messages::install_texts(&TEXTS);
        platform::open_page(|options| {
            let lang = match options.language.as_deref() {
                Some("en") => Some(Language::En),
                Some("zh") => Some(Language::Zh),
                _ => None,
            };
            let first_start = match options.first_start.as_deref() {
                Some("on") => Some(true),
                Some("off") => Some(false),
                _ => None,
            };
            let class = options.class.as_deref().map(ClassAddress::parse);
            let class = class.transpose().map_err(|error| error.message())?;
            let args = WindowArgs {
                seat: SeatArgs {
                    class,
                    class_name: None,
                },
                first_start,
                program: options.program,
                ..WindowArgs::default()
            };
            let opened = window::open(args, lang, None);
            opened.map(drop).map_err(|error| error.message())
        });
    }
}
