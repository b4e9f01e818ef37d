//! macOS is not asked what is held: the pictures of the window count alone.

use std::io;

use winit::raw_window_handle::HasDisplayHandle;

use crate::input_watch::InputWatch;

/// There is one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DisplayServer;

/// The display server of a window.
pub fn display_server(_window: &impl HasDisplayHandle) -> DisplayServer {
    DisplayServer
}

/// It is not watched.
///
/// # Errors
/// None here.
pub fn watch_display(
    _server: DisplayServer,
    watch: InputWatch,
    _gone: impl FnOnce() + Send + 'static,
) -> io::Result<()> {
    watch.trust_window();
    Ok(())
}
