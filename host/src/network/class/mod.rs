//! A class on the network: the seat that reports, and the view that shows all seats.
//!
//! No request of the network presses a key. The kernel itself checks each request for a fault.

mod class_link;
mod page_server;
mod result_store;
mod seat_feed;
mod seat_link;

pub use class_link::{ClassEvent, ClassLink};
pub use gsk_telemetry::class::*;
pub use page_server::{ClassPageServer, DEFAULT_PAGE_ADDRESS};
pub use seat_feed::SeatFeed;
pub use seat_link::{SeatOptions, start_seat};
