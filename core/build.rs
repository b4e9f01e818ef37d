//! Writes a constant for every parameter whose number the sources pass on, from the
//! parameter table.

#[path = "../assets/tables/constants.rs"]
mod constants;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    constants::write("../assets/tables/parameters.tsv", "parameter_numbers.rs")
}
