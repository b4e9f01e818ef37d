//! Pieces that several views and bars draw: dialogs, messages, marks.

pub mod alarm_text;
pub mod card;
pub mod field_menu;
pub mod files;
pub mod icons;
pub mod key_label;
pub mod mark;
pub mod qr_code;
pub mod questions;
pub mod real_machine_bar;
pub mod right_aligned;
pub mod severity;
pub mod status_message;
