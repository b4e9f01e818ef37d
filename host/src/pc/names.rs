//! Free file names at the control.

use gsk_transfer::{DirectoryEntry, FileName};

/// Lowest program number that needs a higher operation level.
const PROTECTED_FROM: u16 = 9000;

/// Returns the next free program name for a program whose name is taken; `None` for data,
/// which have one name only.
pub fn free_name(name: &FileName, entries: &[DirectoryEntry]) -> Option<FileName> {
    let number = name.program_number()?;
    let taken: Vec<u16> = entries
        .iter()
        .filter_map(|entry| entry.name.program_number())
        .collect();
    let mut numbers = (number..PROTECTED_FROM).chain(1..number);
    let free = numbers.find(|number| !taken.contains(number))?;
    Some(FileName::from_program(free))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_number_is_free_and_data_have_none() {
        let name = |name: &str| FileName::new(name).expect("a name");
        let entries = ["O0007.CNC", "O0008.CNC", "ParaW.par"].map(|it| DirectoryEntry {
            name: name(it),
            size: 1,
        });
        assert_eq!(
            free_name(&name("O0007.CNC"), &entries),
            Some(name("O0009.CNC"))
        );
        assert_eq!(free_name(&name("ParaW.par"), &entries), None);
    }
}
