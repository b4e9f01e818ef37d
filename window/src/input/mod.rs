//! Input of the window: keyboard, pointer and touch on the panel.

pub mod held_keys;
mod key_dispatch;
pub mod key_map;
pub mod keyboard;
pub mod long_press;
pub mod panel_pointer;
