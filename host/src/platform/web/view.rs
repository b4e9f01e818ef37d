//! The window of a page: the canvas, the timer for background work, files of the user.

use std::path::{Path, PathBuf};

use eframe::egui::{Context, DroppedFileHandle, ViewportBuilder};
use eframe::{AppCreator, WebOptions, WebRunner};
use gsk_messages::{Language, Message, say};
use js_sys::{Array, Object, Reflect, Uint8Array};
use wasm_bindgen::closure::Closure;
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::spawn_local;
use web_sys::{
    Blob, Document, File, HtmlCanvasElement, HtmlInputElement, MessageEvent, Url, Window, Worker,
};

use super::super::FileDialog;
use super::{course, disk, turns};

/// Id of the canvas element of the page. The constants after it are those of the text of the
/// LCD and of the text of an error.
const CANVAS: &str = "panel";
const LCD: &str = "lcd";
const MESSAGE: &str = "said";
/// Interval of the timer that runs the kernel, ms.
const TIMER_INTERVAL_MS: i32 = 8;

/// Opens the window on the canvas of the page and returns at once.
///
/// # Errors
/// The page has no canvas.
pub fn open_window(
    _name: &str,
    _viewport: ViewportBuilder,
    application: AppCreator<'static>,
) -> Result<(), Message> {
    let canvas = element(CANVAS).and_then(|it| it.dyn_into::<HtmlCanvasElement>().ok());
    let canvas = canvas.ok_or_else(|| say::page_not_opened(format!("no canvas `{CANVAS}`")))?;
    plain_context(&canvas);
    // Exact pixels: the panel has no gradients.
    let options = WebOptions {
        dithering: false,
        ..WebOptions::default()
    };
    let runner = WebRunner::new();
    spawn_local(async move {
        match runner.start(canvas, options, application).await {
            Ok(()) => {
                show_text("");
                start_clock(move || match runner.panic_summary() {
                    None => turns::run_due_tasks(),
                    Some(panic) => show_text(&panic.message()),
                });
                release_on_leave();
            }
            Err(error) => {
                let text = error.as_string().unwrap_or_else(|| format!("{error:?}"));
                show_message(&say::page_not_opened(text));
            }
        }
    });
    Ok(())
}

/// Creates the context of the canvas before the library does, without antialiasing and alpha:
/// painting smooths edges, and nothing is transparent. A computer without a graphics card then
/// draws twice as many frames.
fn plain_context(canvas: &HtmlCanvasElement) {
    let attributes = Object::new();
    for name in ["antialias", "alpha"] {
        let _ = Reflect::set(&attributes, &name.into(), &false.into());
    }
    // Without WebGL 2 the library requests less.
    let _ = canvas.get_context_with_context_options("webgl2", &attributes);
}

fn window() -> Option<Window> {
    web_sys::window()
}

fn document() -> Option<Document> {
    window()?.document()
}

fn element(id: &str) -> Option<web_sys::Element> {
    document()?.get_element_by_id(id)
}

/// Shows a message in place of the window, in both languages.
pub fn show_message(message: &Message) {
    let texts = [Language::Zh, Language::En].map(|language| message.text(language));
    show_text(&texts.join("\n"));
}

/// Shows a text in place of the window; an empty one when the window is open.
pub fn show_text(text: &str) {
    if let Some(element) = element(MESSAGE) {
        element.set_text_content(Some(text));
    }
}

/// Starts the timer that calls `run_due_tasks`. It runs in a worker, whose timer continues
/// while the page is hidden; the page's own stops.
fn start_clock(mut run_due_tasks: impl FnMut() + 'static) {
    let ringing = Closure::<dyn FnMut(MessageEvent)>::new(move |_| run_due_tasks());
    let listener = ringing.as_ref().unchecked_ref();
    match worker() {
        Ok(worker) => {
            worker.set_onmessage(Some(listener));
            // The worker exists as long as the page.
            core::mem::forget(worker);
        }
        Err(_) => {
            if let Some(window) = window() {
                let _ = window.set_interval_with_callback_and_timeout_and_arguments_0(
                    listener,
                    TIMER_INTERVAL_MS,
                );
            }
        }
    }
    ringing.forget();
}

fn worker() -> Result<Worker, JsValue> {
    let text = format!("setInterval(() => postMessage(0), {TIMER_INTERVAL_MS})");
    let blob = Blob::new_with_str_sequence(&Array::of1(&text.into()))?;
    let address = Url::create_object_url_with_blob(&blob)?;
    Worker::new(&address)
}

/// Releases the lock of the memory when the page is left, so that other pages can take it. A
/// page that the browser restores reloads.
fn release_on_leave() {
    let leave = Closure::<dyn FnMut()>::new(|| {
        turns::run_due_tasks();
        disk::release_lock();
    });
    let back = Closure::<dyn FnMut(web_sys::PageTransitionEvent)>::new(
        |event: web_sys::PageTransitionEvent| {
            if event.persisted() {
                reload();
            }
        },
    );
    if let Some(window) = window() {
        window.set_onpagehide(Some(leave.as_ref().unchecked_ref()));
        window.set_onpageshow(Some(back.as_ref().unchecked_ref()));
    }
    leave.forget();
    back.forget();
}

fn reload() {
    if let Some(window) = window() {
        let _ = window.location().reload();
    }
}

/// Returns the folder that is stored in the browser's storage.
pub fn data_folder(_name: &str) -> Option<PathBuf> {
    Some(PathBuf::from(disk::STORAGE_FOLDER))
}

/// Returns the message that another page uses the stored data.
pub fn data_folder_in_use(_path: &Path) -> Message {
    say::page_open_elsewhere()
}

/// Returns the message that the browser keeps no files, or that no learning platform has opened
/// the page of a course; `None` if all is kept.
pub fn startup_message() -> Option<Message> {
    if course::is_packed() {
        return (!course::is_connected()).then(say::course_not_connected);
    }
    (!disk::has_storage()).then(say::page_keeps_nothing)
}

/// Returns the folder in which the user's files are.
pub fn home_folder() -> Option<PathBuf> {
    Some(PathBuf::from(disk::USER_FOLDER))
}

/// Returns the folder whose files become downloads, for files that the control sends.
pub fn sent_folder(_data: &Path, _name: &str) -> PathBuf {
    PathBuf::from(disk::USER_FOLDER)
}

/// Shows the browser's file dialog. `then` gets the path of the first program; the other
/// chosen files are in the same folder. A file to write becomes a download under its suggested
/// name.
pub fn choose_file(dialog: FileDialog, then: impl FnOnce(PathBuf) + 'static) {
    match dialog {
        FileDialog::Save { name, .. } => then(Path::new(disk::USER_FOLDER).join(name)),
        // A page has no folders.
        FileDialog::Folder => {}
        FileDialog::Open { .. } => drop(pick(then)),
    }
}

fn pick(then: impl FnOnce(PathBuf) + 'static) -> Option<()> {
    let input = document()?.create_element("input").ok()?;
    let input = input.dyn_into::<HtmlInputElement>().ok()?;
    input.set_type("file");
    input.set_multiple(true);
    let chosen_path = input.clone();
    let mut then = Some(then);
    let update = Closure::<dyn FnMut()>::new(move || {
        let files = chosen_path.files();
        let files: Vec<File> = (0..files.as_ref().map_or(0, web_sys::FileList::length))
            .filter_map(|index| files.as_ref()?.get(index))
            .collect();
        if let Some(then) = then.take() {
            spawn_local(async move {
                let mut read = Vec::new();
                for file in files {
                    if let Ok(bytes) = file.array_buffer().await {
                        read.push((file.name(), Uint8Array::new(&bytes).to_vec()));
                    }
                }
                if let Some(path) = disk::add_user_files(read) {
                    then(path);
                }
            });
        }
    });
    input.set_onchange(Some(update.as_ref().unchecked_ref()));
    update.forget();
    input.click();
    Some(())
}

/// Reads the files dropped on the page; `then` gets the path of the first program.
pub fn take_dropped(files: &[DroppedFileHandle], then: impl FnOnce(PathBuf) + 'static) {
    let files = files.to_vec();
    spawn_local(async move {
        let mut read = Vec::new();
        for file in files {
            let name = file.path().to_string_lossy().into_owned();
            if let Ok(bytes) = file.bytes_async().await {
                read.push((name, bytes));
            }
        }
        if let Some(path) = disk::add_user_files(read) {
            then(path);
        }
    });
}

/// Reloads the page, whose error dialog the user has closed.
pub fn close_error_dialog(_context: &Context) {
    reload();
}

/// Writes the text of the LCD to an element of the page, for screen readers.
pub fn publish_screen_text(text: impl FnOnce() -> String) {
    if let Some(element) = element(LCD) {
        element.set_text_content(Some(&text()));
    }
}
