//! What a page knows of its input: whether it is seen and has the focus. Its pictures come
//! from the browser, which stops them when it hangs or hides the page.

use std::io;

use web_time::Instant;

use super::clock::time_with_sleep;
use super::turns;
use crate::input_watch::{ASK_EVERY, InputWatch, Shown};

/// There is one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DisplayServer;

/// The browser of the page.
pub const fn display_server<T>(_window: &T) -> DisplayServer {
    DisplayServer
}

/// Watches the page in turns of its own.
///
/// # Errors
/// None here.
pub fn watch_display(
    _server: DisplayServer,
    watch: InputWatch,
    _gone: impl FnOnce() + 'static,
) -> io::Result<()> {
    let mut next = Instant::now();
    turns::turn("display", move || {
        let now = Instant::now();
        if now >= next && watch.is_wanted() {
            next = now + ASK_EVERY;
            if has_input() {
                let now = time_with_sleep();
                watch.answer(now, now, Shown::Untold);
            }
        }
        !watch.is_over()
    })
    .map(drop)
}

/// Whether keys and fingers reach the page.
fn has_input() -> bool {
    let document = web_sys::window().and_then(|window| window.document());
    document.is_some_and(|document| !document.hidden() && document.has_focus().unwrap_or(false))
}
