//! Writes a constant for every alarm number that the sources name, from the alarm
//! table: link and control speak of the same numbers, and the table alone holds them.

#[path = "../assets/tables/constants.rs"]
mod constants;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    constants::write("../assets/tables/alarms.tsv", "alarm_numbers.rs")
}
