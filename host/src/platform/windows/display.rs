//! Queries Windows for the keys and buttons that are down. The frames of the window prove
//! that its message loop runs.

use std::io;
use std::thread;

use winit::raw_window_handle::HasDisplayHandle;
use winsafe::{GetAsyncKeyState, co::VK};

use super::clock::time_with_sleep;
use crate::input_watch::{DisplayReply, InputWatch, QUERY_INTERVAL};

/// Keys of the PC keyboard that can hold a panel key: all but the modifiers.
const KEYS: [VK; 92] = [
    VK::BACK,
    VK::TAB,
    VK::CLEAR,
    VK::RETURN,
    VK::PAUSE,
    VK::ESCAPE,
    VK::SPACE,
    VK::PRIOR,
    VK::NEXT,
    VK::END,
    VK::HOME,
    VK::LEFT,
    VK::UP,
    VK::RIGHT,
    VK::DOWN,
    VK::INSERT,
    VK::DELETE,
    VK::CHAR_0,
    VK::CHAR_1,
    VK::CHAR_2,
    VK::CHAR_3,
    VK::CHAR_4,
    VK::CHAR_5,
    VK::CHAR_6,
    VK::CHAR_7,
    VK::CHAR_8,
    VK::CHAR_9,
    VK::CHAR_A,
    VK::CHAR_B,
    VK::CHAR_C,
    VK::CHAR_D,
    VK::CHAR_E,
    VK::CHAR_F,
    VK::CHAR_G,
    VK::CHAR_H,
    VK::CHAR_I,
    VK::CHAR_J,
    VK::CHAR_K,
    VK::CHAR_L,
    VK::CHAR_M,
    VK::CHAR_N,
    VK::CHAR_O,
    VK::CHAR_P,
    VK::CHAR_Q,
    VK::CHAR_R,
    VK::CHAR_S,
    VK::CHAR_T,
    VK::CHAR_U,
    VK::CHAR_V,
    VK::CHAR_W,
    VK::CHAR_X,
    VK::CHAR_Y,
    VK::CHAR_Z,
    VK::NUMPAD0,
    VK::NUMPAD1,
    VK::NUMPAD2,
    VK::NUMPAD3,
    VK::NUMPAD4,
    VK::NUMPAD5,
    VK::NUMPAD6,
    VK::NUMPAD7,
    VK::NUMPAD8,
    VK::NUMPAD9,
    VK::MULTIPLY,
    VK::ADD,
    VK::SUBTRACT,
    VK::DECIMAL,
    VK::DIVIDE,
    VK::F1,
    VK::F2,
    VK::F3,
    VK::F4,
    VK::F5,
    VK::F6,
    VK::F7,
    VK::F8,
    VK::F9,
    VK::F10,
    VK::F11,
    VK::F12,
    VK::OEM_1,
    VK::OEM_PLUS,
    VK::OEM_COMMA,
    VK::OEM_MINUS,
    VK::OEM_PERIOD,
    VK::OEM_2,
    VK::OEM_3,
    VK::OEM_4,
    VK::OEM_5,
    VK::OEM_6,
    VK::OEM_7,
    VK::OEM_102,
];
const BUTTONS: [VK; 3] = [VK::LBUTTON, VK::RBUTTON, VK::MBUTTON];

/// The display of Windows, whose keys and buttons can be queried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DisplayServer;

/// Returns the display server of Windows.
pub fn display_server(_window: &impl HasDisplayHandle) -> DisplayServer {
    DisplayServer
}

/// Starts the thread that queries the state of keys and mouse buttons.
///
/// # Errors
/// The system starts no thread.
pub fn watch_display(
    _server: DisplayServer,
    watch: InputWatch,
    _gone: impl FnOnce() + Send + 'static,
) -> io::Result<()> {
    let query_loop = move || {
        while !watch.has_ended() {
            if watch.needs_query() {
                let now = time_with_sleep();
                watch.record_reply(now, now, query());
            }
            thread::sleep(QUERY_INTERVAL);
        }
    };
    let name = "display".to_owned();
    thread::Builder::new()
        .name(name)
        .spawn(query_loop)
        .map(drop)
}

fn query() -> DisplayReply {
    let down = |keys: &[VK]| keys.iter().filter(|key| GetAsyncKeyState(**key)).count();
    DisplayReply::Down {
        keys: down(&KEYS),
        pointer: down(&BUTTONS) > 0,
    }
}
