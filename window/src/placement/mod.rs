//! Where the panel is in the window, and which area its stop keys keep free.

pub mod lcd_placement;
pub mod panel_placement;
pub mod stop_key_clearance;
