//! A class: seats report to the instructor, who sends requests.
//!
//! | Module | What |
//! |---|---|
//! | `class_address` | code, broker and topics of a class |
//! | `seat_report` | the state of a seat |
//! | `seat_request` | what the instructor may request, and why a seat refuses |
//! | `lcd_picture` | the LCD as bytes |
//! | `part_outline` | the half section of the part, coarse |
//! | `seat_publisher` | what a seat publishes, and when |
//! | `class_roster` | all seats, the one that needs help first |
//! | `class_page` | the seats as JSON for a page in a browser |
//! | `class_table` | the seats as a table of text |
//!
//! No request presses a key: there is none for it.

pub mod class_address;
pub mod class_page;
pub mod class_roster;
pub mod class_table;
pub mod lcd_picture;
pub mod part_outline;
pub mod seat_publisher;
pub mod seat_report;
pub mod seat_request;
