//! Reads the parameters in the page's address: `?lang=en&open=part.CNC&open=part.job.ron`.

use std::panic;
use std::path::PathBuf;

use gsk_exercise::course::COURSE_FILE;
use gsk_messages::{Message, say};
use js_sys::Uint8Array;
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{Response, UrlSearchParams, Window};

use super::view::{show_message, show_text};
use super::{course, disk};

/// The parameters in the address of the page, after `?`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PageParameters {
    /// Word for the language of the window; `None` if the address has none.
    pub language: Option<String>,
    /// Whether the first start shows its questions: `on` or `off`; `None` if the address does
    /// not say so.
    pub first_start: Option<String>,
    /// The class that the page joins, CODE@BROKER; `None` if the address names none.
    pub class: Option<String>,
    /// Path of the fetched program to open; `None` if the address names none.
    pub program: Option<PathBuf>,
}

/// Fetches the files that the address names and opens the window with them; shows an error
/// in place of the window.
pub fn open_page(open: impl FnOnce(PageParameters) -> Result<(), Message> + 'static) {
    panic::set_hook(Box::new(|panic| {
        let panic = panic.to_string();
        web_sys::console::error_1(&panic.as_str().into());
        show_text(&panic);
    }));
    spawn_local(async move {
        let opened = match read_parameters().await {
            Ok(parameters) => open(parameters),
            Err(message) => Err(message),
        };
        if let Err(message) = opened {
            show_message(&message);
        }
    });
}

async fn read_parameters() -> Result<PageParameters, Message> {
    let Some(window) = web_sys::window() else {
        return Ok(PageParameters::default());
    };
    if course::is_packed() {
        let bytes = fetch_file(&window, COURSE_FILE).await;
        course::set_course(bytes.map_err(|error| say::page_no_file(COURSE_FILE, error))?);
    }
    let words = window.location().search().unwrap_or_default();
    let words = UrlSearchParams::new_with_str(&words).ok();
    let all = words.as_ref().map(|words| words.get_all("open"));
    let mut files = Vec::new();
    for address in all.iter().flat_map(js_sys::Array::iter) {
        let address = address.as_string().unwrap_or_default();
        let bytes = fetch_file(&window, &address).await;
        let name = address.rsplit('/').next().unwrap_or(&address).to_owned();
        files.push((
            name,
            bytes.map_err(|error| say::page_no_file(&address, error))?,
        ));
    }
    let word = |name: &str| words.as_ref().and_then(|words| words.get(name));
    Ok(PageParameters {
        language: word("lang"),
        first_start: word("first-start"),
        class: word("class"),
        program: disk::add_user_files(files),
    })
}

/// Fetches a file from the server of the page, or from another one that permits it. Returns
/// its bytes, or the reason as text.
async fn fetch_file(window: &Window, address: &str) -> Result<Vec<u8>, String> {
    let wrong = |error: JsValue| format!("{error:?}");
    let wait_for_answer = JsFuture::from(window.fetch_with_str(address)).await;
    let wait_for_answer: Response = wait_for_answer.map_err(wrong)?.unchecked_into();
    if !wait_for_answer.ok() {
        return Err(format!(
            "{} {}",
            wait_for_answer.status(),
            wait_for_answer.status_text()
        ));
    }
    let bytes = JsFuture::from(wait_for_answer.array_buffer().map_err(wrong)?).await;
    Ok(Uint8Array::new(&bytes.map_err(wrong)?).to_vec())
}
