//! macOS has no display server to query: the frames of the window alone prove held keys.

use std::io;

use winit::raw_window_handle::HasDisplayHandle;

use crate::input_watch::InputWatch;

/// The display of macOS, which the program does not query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DisplayServer;

/// Returns the display server of macOS.
pub fn display_server(_window: &impl HasDisplayHandle) -> DisplayServer {
    DisplayServer
}

/// Accepts the frames of the window as proof that keys are held.
///
/// # Errors
/// Never; other platforms start a thread.
pub fn watch_display(
    _server: DisplayServer,
    watch: InputWatch,
    _gone: impl FnOnce() + Send + 'static,
) -> io::Result<()> {
    watch.trust_window();
    Ok(())
}
