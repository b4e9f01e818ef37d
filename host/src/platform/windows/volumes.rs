//! The drives that are mounted.

use std::path::PathBuf;

/// Lists the roots of the drives that have a letter.
pub fn mounted_volumes() -> Vec<PathBuf> {
    let roots = ('D'..='Z').map(|letter| PathBuf::from(format!("{letter}:\\")));
    roots.filter(|root| root.exists()).collect()
}
