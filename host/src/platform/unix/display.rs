//! Queries the display server on a separate connection for the keys and buttons that are
//! down. A hung server blocks only this thread, not the window or the kernel.

use std::io;
use std::thread;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use wayland_client::EventQueue;
use winit::raw_window_handle::{HasDisplayHandle, RawDisplayHandle};
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt, KeyButMask, Window};
use x11rb::rust_connection::RustConnection;

use super::clock::time_with_sleep;
use crate::input_watch::{DisplayReply, InputWatch, QUERY_INTERVAL};

/// Length of the key map of X11, bytes: one bit per key.
const KEY_MAP: usize = 32;

/// The kind of display server that shows the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DisplayServer {
    /// The window is shown by an X server.
    X11,
    /// The window is shown by a Wayland compositor.
    Wayland,
}

/// Returns the kind of display server that shows a window.
pub fn display_server(window: &impl HasDisplayHandle) -> DisplayServer {
    match window.display_handle().map(|handle| handle.as_raw()) {
        Ok(RawDisplayHandle::Wayland(_)) => DisplayServer::Wayland,
        _ => DisplayServer::X11,
    }
}

/// Starts the thread that queries a display. It calls `gone` when the display has closed
/// the connection and refuses another one.
///
/// # Errors
/// The system starts no thread.
pub fn watch_display(
    server: DisplayServer,
    watch: InputWatch,
    gone: impl FnOnce() + Send + 'static,
) -> io::Result<()> {
    let query_loop = move || {
        let mut display = None;
        while !watch.has_ended() {
            let queried = time_with_sleep();
            if watch.needs_query() {
                match query(&mut display, server) {
                    Some(reply) => watch.record_reply(queried, time_with_sleep(), reply),
                    None => {
                        tracing::error!("the display is gone");
                        return gone();
                    }
                }
            }
            let spent = time_with_sleep().saturating_sub(queried);
            let rest = QUERY_INTERVAL.saturating_sub(spent);
            match &display {
                Some(display) => display.wait(rest),
                None => thread::sleep(rest),
            }
        }
    };
    let name = "display".to_owned();
    thread::Builder::new()
        .name(name)
        .spawn(query_loop)
        .map(drop)
}

/// Queries the display; reconnects once if the connection is broken. Returns `None` if the
/// display is gone.
fn query(display: &mut Option<Display>, server: DisplayServer) -> Option<DisplayReply> {
    let reply = display.as_mut().and_then(Display::query);
    reply.or_else(|| {
        *display = Display::connect(server);
        display.as_mut().and_then(Display::query)
    })
}

enum Display {
    X11(Box<X11>),
    Wayland(EventQueue<IgnoredEvents>),
}

/// Receives the events of Wayland and ignores them.
struct IgnoredEvents;

impl Display {
    fn connect(server: DisplayServer) -> Option<Self> {
        match server {
            DisplayServer::X11 => X11::connect().map(Box::new).map(Self::X11),
            DisplayServer::Wayland => {
                let connection = wayland_client::Connection::connect_to_env().ok()?;
                Some(Self::Wayland(connection.new_event_queue()))
            }
        }
    }

    /// Sends a query and blocks until the reply arrives; `None` if the connection is broken.
    fn query(&mut self) -> Option<DisplayReply> {
        match self {
            Self::X11(x11) => x11.query(),
            // A compositor reports keys only to the window that has the focus.
            Self::Wayland(queue) => queue
                .roundtrip(&mut IgnoredEvents)
                .ok()
                .map(|_| DisplayReply::Alive),
        }
    }

    /// Waits for this time, or until the display closes the connection.
    fn wait(&self, time: Duration) {
        match self {
            Self::X11(x11) => x11.wait(time),
            Self::Wayland(_) => thread::sleep(time),
        }
    }
}

struct X11 {
    connection: RustConnection,
    root: Window,
    /// The bits of the key map that belong to Shift, Ctrl and the other modifier keys.
    modifiers: [u8; KEY_MAP],
}

impl X11 {
    fn connect() -> Option<Self> {
        let (connection, screen) = x11rb::connect(None).ok()?;
        let root = connection.setup().roots.get(screen)?.root;
        let mapping = connection.get_modifier_mapping().ok()?.reply().ok()?;
        let mut modifiers = [0; KEY_MAP];
        for code in mapping.keycodes.iter().filter(|code| **code > 0) {
            modifiers[usize::from(code / 8)] |= 1 << (code % 8);
        }
        Some(Self {
            connection,
            root,
            modifiers,
        })
    }

    fn query(&self) -> Option<DisplayReply> {
        let keys = self.connection.query_keymap().ok()?;
        let pointer = self.connection.query_pointer(self.root).ok()?;
        let keys = keys.reply().ok()?.keys;
        let mask = pointer.reply().ok()?.mask;
        let down = keys.iter().zip(self.modifiers);
        let down = down.map(|(keys, modifiers)| (keys & !modifiers).count_ones());
        let buttons = KeyButMask::BUTTON1 | KeyButMask::BUTTON2 | KeyButMask::BUTTON3;
        Some(DisplayReply::Down {
            keys: down.sum::<u32>() as usize,
            pointer: mask.intersects(buttons),
        })
    }

    fn wait(&self, time: Duration) {
        // The server sends keyboard mapping changes to all clients; they are not used here.
        while matches!(self.connection.poll_for_event(), Ok(Some(_))) {}
        let Ok(time) = Timespec::try_from(time) else {
            return;
        };
        let mut look = [PollFd::new(self.connection.stream(), PollFlags::IN)];
        // A closed connection shows in the next query.
        if let Err(error) = poll(&mut look, Some(&time))
            && error != Errno::INTR
        {
            thread::sleep(QUERY_INTERVAL);
        }
    }
}
