//! The page as the window's place: the canvas, the clock that rings for everything
//! beside it, files that come from the user and go to him.

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
use super::{disk, turns};

/// The canvas, the element with the text of the LCD, and the one that says what stands
/// against it all.
const CANVAS: &str = "panel";
const LCD: &str = "lcd";
const SAID: &str = "said";
/// Between two rings of the clock, ms.
const RING: i32 = 8;

/// Opens the window on the canvas of the page and returns at once.
///
/// # Errors
/// The page has none.
pub fn open_window(
    _name: &str,
    _viewport: ViewportBuilder,
    application: AppCreator<'static>,
) -> Result<(), Message> {
    let canvas = element(CANVAS).and_then(|it| it.dyn_into::<HtmlCanvasElement>().ok());
    let canvas = canvas.ok_or_else(|| say::page_not_opened(format!("no canvas `{CANVAS}`")))?;
    plain_context(&canvas);
    // Dots as they are: the panel is no gradient.
    let options = WebOptions {
        dithering: false,
        ..WebOptions::default()
    };
    let runner = WebRunner::new();
    spawn_local(async move {
        match runner.start(canvas, options, application).await {
            Ok(()) => {
                show("");
                start_clock(move || match runner.panic_summary() {
                    None => turns::ring(),
                    Some(panic) => show(&panic.message()),
                });
                leave_well();
            }
            Err(error) => {
                let text = error.as_string().unwrap_or_else(|| format!("{error:?}"));
                tell(&say::page_not_opened(text));
            }
        }
    });
    Ok(())
}

/// Gives the canvas its context before the library does, without what is not needed:
/// edges are smoothed when they are painted, and nothing shines through. A computer
/// without a graphics card draws twice as many frames then.
fn plain_context(canvas: &HtmlCanvasElement) {
    let wishes = Object::new();
    for name in ["antialias", "alpha"] {
        let _ = Reflect::set(&wishes, &name.into(), &false.into());
    }
    // Without WebGL 2 the library asks for less.
    let _ = canvas.get_context_with_context_options("webgl2", &wishes);
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

/// Says something in place of the window, in both languages.
pub fn tell(said: &Message) {
    let texts = [Language::Zh, Language::En].map(|language| said.text(language));
    show(&texts.join("\n"));
}

/// Shows a text in place of the window; none: the window is there.
pub fn show(text: &str) {
    if let Some(element) = element(SAID) {
        element.set_text_content(Some(text));
    }
}

/// Lets a clock ring. That of a worker goes on when the page is hidden, which the page's
/// own does not.
fn start_clock(mut ring: impl FnMut() + 'static) {
    let ringing = Closure::<dyn FnMut(MessageEvent)>::new(move |_| ring());
    let listener = ringing.as_ref().unchecked_ref();
    match worker() {
        Ok(worker) => {
            worker.set_onmessage(Some(listener));
            // The page has it as long as it is open.
            core::mem::forget(worker);
        }
        Err(_) => {
            if let Some(window) = window() {
                let _ =
                    window.set_interval_with_callback_and_timeout_and_arguments_0(listener, RING);
            }
        }
    }
    ringing.forget();
}

fn worker() -> Result<Worker, JsValue> {
    let text = format!("setInterval(() => postMessage(0), {RING})");
    let blob = Blob::new_with_str_sequence(&Array::of1(&text.into()))?;
    let address = Url::create_object_url_with_blob(&blob)?;
    Worker::new(&address)
}

/// What is done when the page is left: its memory is free for another one. A page that
/// the browser brings back has to begin anew.
fn leave_well() {
    let leave = Closure::<dyn FnMut()>::new(|| {
        turns::ring();
        disk::let_lock_go();
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

/// The folder that the browser keeps.
pub fn data_folder(_name: &str) -> Option<PathBuf> {
    Some(PathBuf::from(disk::KEPT))
}

/// What is said when another page has the folder of the data.
pub fn in_use(_path: &Path) -> Message {
    say::page_open_elsewhere()
}

/// What is to be said before all else: that nothing is kept, if it is so.
pub fn first_word() -> Option<Message> {
    (!disk::is_kept()).then(say::page_keeps_nothing)
}

/// The folder of the user's files.
pub fn home_folder() -> Option<PathBuf> {
    Some(PathBuf::from(disk::HANDED))
}

/// What the control sends is handed out as a download.
pub fn sent_folder(_data: &Path, _name: &str) -> PathBuf {
    PathBuf::from(disk::HANDED)
}

/// Lets the user choose files; the first program goes to `then`, what else he chose is
/// found beside it. What is to be written is handed out under the name that is proposed.
pub fn choose_file(dialog: FileDialog, then: impl FnOnce(PathBuf) + 'static) {
    match dialog {
        FileDialog::Save { name, .. } => then(Path::new(disk::HANDED).join(name)),
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
    let chosen = input.clone();
    let mut then = Some(then);
    let change = Closure::<dyn FnMut()>::new(move || {
        let files = chosen.files();
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
                if let Some(path) = disk::hand_in(read) {
                    then(path);
                }
            });
        }
    });
    input.set_onchange(Some(change.as_ref().unchecked_ref()));
    change.forget();
    input.click();
    Some(())
}

/// Reads the files that were dropped on the page; the first program goes to `then`.
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
        if let Some(path) = disk::hand_in(read) {
            then(path);
        }
    });
}

/// A dialog in place of the window is closed: the page tries again.
pub fn leave_refusal(_context: &Context) {
    reload();
}

/// What stands on the LCD, for those who do not see it: the text of an element.
pub fn tell_screen(text: impl FnOnce() -> String) {
    if let Some(element) = element(LCD) {
        element.set_text_content(Some(&text()));
    }
}
