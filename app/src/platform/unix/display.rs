//! Asks the display server, on a connection of its own, whether it goes on to answer, and
//! which keys and buttons are down: what hangs hangs here, and neither window nor kernel.

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
use crate::input_watch::{ASK_EVERY, InputWatch, Shown};

/// Bytes of a map of keys.
const KEY_MAP: usize = 32;

/// Which display server a window is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DisplayServer {
    /// X.
    X11,
    /// A compositor.
    Wayland,
}

/// The display server of a window.
pub fn display_server(window: &impl HasDisplayHandle) -> DisplayServer {
    match window.display_handle().map(|handle| handle.as_raw()) {
        Ok(RawDisplayHandle::Wayland(_)) => DisplayServer::Wayland,
        _ => DisplayServer::X11,
    }
}

/// Watches a display in a thread of its own. `gone` is called when the display is no more.
///
/// # Errors
/// The system gives no thread.
pub fn watch_display(
    server: DisplayServer,
    watch: InputWatch,
    gone: impl FnOnce() + Send + 'static,
) -> io::Result<()> {
    let asks = move || {
        let mut display = None;
        while !watch.is_over() {
            let asked = time_with_sleep();
            if watch.is_wanted() {
                match ask(&mut display, server) {
                    Some(shown) => watch.answer(asked, time_with_sleep(), shown),
                    None => {
                        tracing::error!("the display is gone");
                        return gone();
                    }
                }
            }
            let spent = time_with_sleep().saturating_sub(asked);
            let rest = ASK_EVERY.saturating_sub(spent);
            match &display {
                Some(display) => display.wait(rest),
                None => thread::sleep(rest),
            }
        }
    };
    let name = "display".to_owned();
    thread::Builder::new().name(name).spawn(asks).map(drop)
}

/// The answer of the display; a connection that has broken is opened once more. None: there
/// is no display any more.
fn ask(display: &mut Option<Display>, server: DisplayServer) -> Option<Shown> {
    let answer = display.as_mut().and_then(Display::ask);
    answer.or_else(|| {
        *display = Display::connect(server);
        display.as_mut().and_then(Display::ask)
    })
}

/// A display server that is asked.
enum Display {
    X11(Box<X11>),
    Wayland(EventQueue<Nothing>),
}

/// Nothing is done with what Wayland reports.
struct Nothing;

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

    /// Asks and waits for the answer, however long that takes.
    fn ask(&mut self) -> Option<Shown> {
        match self {
            Self::X11(x11) => x11.ask(),
            // A compositor tells nobody but the window in front what is down.
            Self::Wayland(queue) => queue.roundtrip(&mut Nothing).ok().map(|_| Shown::Untold),
        }
    }

    /// Waits; no longer than until the display is gone.
    fn wait(&self, time: Duration) {
        match self {
            Self::X11(x11) => x11.wait(time),
            Self::Wayland(_) => thread::sleep(time),
        }
    }
}

/// An X server.
struct X11 {
    connection: RustConnection,
    root: Window,
    /// Keys that are Shift, Ctrl and the like.
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

    fn ask(&self) -> Option<Shown> {
        let keys = self.connection.query_keymap().ok()?;
        let pointer = self.connection.query_pointer(self.root).ok()?;
        let keys = keys.reply().ok()?.keys;
        let mask = pointer.reply().ok()?.mask;
        let down = keys.iter().zip(self.modifiers);
        let down = down.map(|(keys, modifiers)| (keys & !modifiers).count_ones());
        let buttons = KeyButMask::BUTTON1 | KeyButMask::BUTTON2 | KeyButMask::BUTTON3;
        Some(Shown::Down {
            keys: down.sum::<u32>() as usize,
            pointer: mask.intersects(buttons),
        })
    }

    fn wait(&self, time: Duration) {
        // A change of the keyboard is reported to all: it is of no use here.
        while matches!(self.connection.poll_for_event(), Ok(Some(_))) {}
        let Ok(time) = Timespec::try_from(time) else {
            return;
        };
        let mut look = [PollFd::new(self.connection.stream(), PollFlags::IN)];
        // When it is gone the next question says so.
        if let Err(error) = poll(&mut look, Some(&time))
            && error != Errno::INTR
        {
            thread::sleep(ASK_EVERY);
        }
    }
}
