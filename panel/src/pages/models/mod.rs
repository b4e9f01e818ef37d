//! Draws the pages that only other models than the GSK980TD have.

mod contacts;
mod coordinates;
mod parameters;
mod reset;
mod teaching;
mod udisk;

pub use contacts::{inputs, outputs};
pub use coordinates::draw as coordinates;
pub use parameters::{draw as parameters, numbers as model_parameter_numbers};
pub use reset::draw as reset;
pub use teaching::{draw as teaching, teaches};
pub use udisk::draw as udisk;
