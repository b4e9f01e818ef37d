//! Checks whether the page is visible and has the focus. The browser stops its frames when
//! it hangs or hides the page.

use std::io;

use web_time::Instant;

use super::clock::time_with_sleep;
use super::turns;
use crate::input_watch::{DisplayReply, InputWatch, QUERY_INTERVAL};

/// The display server of a page: the browser.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DisplayServer;

/// Returns the display server of a page: the browser.
pub const fn display_server<T>(_window: &T) -> DisplayServer {
    DisplayServer
}

/// Checks the page in a separate turn of its loop.
///
/// # Errors
/// Never; other platforms start a thread.
pub fn watch_display(
    _server: DisplayServer,
    watch: InputWatch,
    _gone: impl FnOnce() + 'static,
) -> io::Result<()> {
    let mut next = Instant::now();
    turns::start_task("display", move || {
        let now = Instant::now();
        if now >= next && watch.needs_query() {
            next = now + QUERY_INTERVAL;
            if has_input() {
                let now = time_with_sleep();
                watch.record_reply(now, now, DisplayReply::Alive);
            }
        }
        !watch.has_ended()
    })
    .map(drop)
}

/// Whether the page is visible and has the focus, so that it receives keys and touches.
fn has_input() -> bool {
    let document = web_sys::window().and_then(|window| window.document());
    document.is_some_and(|document| !document.hidden() && document.has_focus().unwrap_or(false))
}
