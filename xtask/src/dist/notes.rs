//! Reads a version's section of the changelog: release notes, and the date that all files
//! in archives get.

use std::fs;
use std::path::Path;

use super::{VERSION, dist_folder, with_path};
use crate::error::TaskError;

/// A version's section in the changelog.
#[derive(Debug, PartialEq, Eq)]
pub struct Section<'a> {
    /// Date of the version: year, month, day.
    pub date: (i64, i64, i64),
    /// The text of the section without its heading.
    pub text: &'a str,
}

/// Writes `RELEASE-NOTES.md` into `target/dist`.
///
/// # Errors
/// The changelog has no heading for the version.
pub fn make(root: &Path) -> Result<(), TaskError> {
    let changelog = read(root)?;
    let section = section(&changelog, VERSION)?;
    let path = dist_folder(root)?.join("RELEASE-NOTES.md");
    let text = format!("# gsk980td {VERSION}\n\n{}\n", section.text);
    with_path(&path, fs::write(&path, text))?;
    println!("{}", path.display());
    Ok(())
}

/// Reads the text of CHANGELOG.md.
pub fn read(root: &Path) -> Result<String, TaskError> {
    let path = root.join("CHANGELOG.md");
    with_path(&path, fs::read_to_string(&path))
}

/// Finds the section of a version.
///
/// # Errors
/// The changelog has no heading with this version and a date.
pub fn section<'a>(changelog: &'a str, version: &str) -> Result<Section<'a>, TaskError> {
    let missing = || TaskError::NoHeading(version.to_owned());
    let start = format!("## [{version}]");
    let at = changelog
        .match_indices(&start)
        .map(|(at, _)| at)
        .find(|&at| at == 0 || changelog[..at].ends_with('\n'))
        .ok_or_else(missing)?;
    let (heading, below) = changelog[at..].split_once('\n').ok_or_else(missing)?;
    let date = heading[start.len()..].trim_matches([' ', '–', '-']);
    let date = date
        .split('-')
        .map(|part| part.parse().ok())
        .collect::<Option<Vec<i64>>>()
        .ok_or_else(missing)?;
    let &[year, month @ 1..=12, day @ 1..=31] = date.as_slice() else {
        return Err(missing());
    };
    let end = below.find("\n## ").unwrap_or(below.len());
    Ok(Section {
        date: (year, month, day),
        text: below[..end].trim(),
    })
}

impl Section<'_> {
    /// Number of days from 1970-01-01 to the version's date.
    fn days(&self) -> i64 {
        let (year, month, day) = self.date;
        // Years begin in March here, so that the leap day is the last day of a year.
        let year = if month <= 2 { year - 1 } else { year };
        let month = (month + 9) % 12;
        let leap_days = year / 4 - year / 100 + year / 400;
        year * 365 + leap_days + (month * 153 + 2) / 5 + day - 1 - 719_468
    }

    /// Midnight of the version's date, in seconds since 1970.
    pub fn seconds(&self) -> u64 {
        u64::try_from(self.days() * 86_400).unwrap_or(0)
    }

    /// The version's date in the format of RFC 5322, which Debian's changelogs use.
    pub fn to_rfc_5322(&self) -> String {
        const DAYS: [&str; 7] = ["Thu", "Fri", "Sat", "Sun", "Mon", "Tue", "Wed"];
        const MONTHS: [&str; 12] = [
            "Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec",
        ];
        let index = |number: i64| usize::try_from(number).unwrap_or(0);
        let (year, month, day) = self.date;
        format!(
            "{}, {day:02} {} {year} 00:00:00 +0000",
            DAYS[index(self.days().rem_euclid(7))],
            MONTHS[index(month - 1) % 12],
        )
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use super::*;

    const TEXT: &str = "# Changelog\n\n## [Unreleased]\n\n- later\n\n\
                        ## [1.2.0] – 2024-02-29\n\n### Added\n\n- this\n\n## [1.1.0] – 2023-01-01\n";

    #[test]
    fn a_section_ends_at_the_next_version() {
        let found = section(TEXT, "1.2.0").unwrap();
        assert_eq!(found.date, (2024, 2, 29));
        assert_eq!(found.text, "### Added\n\n- this");
        assert_eq!(section(TEXT, "1.1.0").unwrap().text, "");
    }

    #[test]
    fn a_missing_heading_is_named() {
        let error = section(TEXT, "2.0.0").unwrap_err().to_string();
        assert!(error.contains("## [2.0.0]"), "{error}");
        assert!(section(TEXT, "Unreleased").is_err(), "it has no date");
    }

    #[test]
    fn dates_are_counted_and_written() {
        let at = |date| Section { date, text: "" };
        assert_eq!(at((1970, 1, 1)).seconds(), 0);
        assert_eq!(at((2024, 2, 29)).seconds(), 1_709_164_800);
        assert_eq!(at((2026, 11, 22)).seconds(), 1_795_305_600);
        assert_eq!(
            at((2024, 2, 29)).to_rfc_5322(),
            "Thu, 29 Feb 2024 00:00:00 +0000"
        );
        assert_eq!(
            at((2026, 11, 22)).to_rfc_5322(),
            "Sun, 22 Nov 2026 00:00:00 +0000"
        );
    }

    #[test]
    fn the_changelog_knows_the_version() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        section(&read(root).unwrap(), VERSION).unwrap();
    }
}
