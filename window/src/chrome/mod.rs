//! What surrounds panel and views: the bar at the top, the line of messages, the first start.

pub mod class_offer;
pub mod exam_limits;
pub mod first_start;
pub mod incoming;
pub mod key_dispatch;
pub mod message_history;
pub mod message_line;
pub mod network_pane;
pub mod pane_area;
pub mod program_opener;
pub mod startup_error;
pub mod timeline;
pub mod top_bar;
pub mod top_bar_requests;
pub mod way_back;
pub mod why_pane;
pub mod zoom;
