//! Generates the alarm-number constants of `gsk_units::alarm` from the alarm table.

#[path = "../assets/tables/constants.rs"]
mod constants;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    constants::write("../assets/tables/alarms.tsv", "alarm_numbers.rs")
}
