//! Tables of the machine for the setup of a GSK980MDi, as its manual lists them: pins, diagnosis
//! numbers, steps of the spindle set-up and of the reference return.

use std::sync::LazyLock;

const SIGNALS: &str = include_str!("../../assets/tables/mill-signals.tsv");
const DIAGNOSIS: &str = include_str!("../../assets/tables/mill-diagnosis.tsv");
const STEPS: &str = include_str!("../../assets/tables/mill-steps.tsv");

/// One of the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MillTable {
    /// Connectors CN15 to CN78 (manual 2.3, 2.4, 2.8): connector, pin, address, symbol.
    Signals,
    /// Diagnosis numbers (manual 5.1): number with bit, symbol.
    Diagnosis,
    /// Set-up of the spindle (manual 3.1, 4.6): step, parameters.
    Spindle,
    /// Return to the reference point (manual 2.9, 3.2.9): step, parameters.
    ReferenceReturn,
}

/// A row of one of the tables.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MillTableRow {
    /// The cells before the meaning, such as connector, pin and address; `-` if empty.
    pub keys: Vec<&'static str>,
    /// The meaning in English.
    pub en: &'static str,
    /// The meaning in Chinese.
    pub zh: &'static str,
}

impl MillTable {
    /// Returns the rows of the table in the order of the manual.
    pub fn rows(self) -> &'static [MillTableRow] {
        static TABLES: LazyLock<[Vec<MillTableRow>; 4]> = LazyLock::new(|| {
            [
                read(SIGNALS, 0, None),
                read(DIAGNOSIS, 0, None),
                read(STEPS, 1, Some("spindle")),
                read(STEPS, 1, Some("return")),
            ]
        });
        TABLES.get(self as usize).map_or(&[], Vec::as_slice)
    }

    /// Returns the rows that contain every word of a text in one of their cells, in any case. An
    /// empty text finds all rows.
    pub fn search(self, text: &str) -> impl Iterator<Item = &'static MillTableRow> {
        let words: Vec<String> = text.split_whitespace().map(str::to_uppercase).collect();
        self.rows().iter().filter(move |row| {
            let cells = row.keys.iter().chain([&row.en, &row.zh]);
            let cells: Vec<String> = cells.map(|cell| cell.to_uppercase()).collect();
            let is_found = |word: &String| cells.iter().any(|cell| cell.contains(word));
            words.iter().all(is_found)
        })
    }
}

/// Reads the rows of a table. `skip` columns come before the keys; the first one must be `subject`
/// if it is given. The last column holds the lines of the manual, for the tests.
fn read(table: &'static str, skip: usize, subject: Option<&str>) -> Vec<MillTableRow> {
    let rows = table.lines().skip(1).map(|line| line.split('\t').collect());
    let rows = rows.filter(|cells: &Vec<&str>| {
        subject.is_none_or(|subject| cells.first().is_some_and(|first| *first == subject))
    });
    rows.filter_map(|cells| match cells.get(skip..)? {
        [keys @ .., en, zh, _lines] => Some(MillTableRow {
            keys: keys.to_vec(),
            en,
            zh,
        }),
        _ => None,
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(table: MillTable, text: &str) -> Vec<String> {
        table.search(text).map(|row| row.keys.join(" ")).collect()
    }

    #[test]
    fn every_line_is_a_row() {
        let lines = |text: &str| text.lines().count() - 1;
        assert_eq!(MillTable::Signals.rows().len(), lines(SIGNALS));
        assert_eq!(MillTable::Diagnosis.rows().len(), lines(DIAGNOSIS));
        let steps = MillTable::Spindle.rows().len() + MillTable::ReferenceReturn.rows().len();
        assert_eq!(steps, lines(STEPS));
        for table in [MillTable::Signals, MillTable::Diagnosis] {
            let width = table.rows()[0].keys.len();
            assert!(table.rows().iter().all(|row| row.keys.len() == width));
        }
    }

    #[test]
    fn the_pins_are_those_of_the_manual() {
        let signals = MillTable::Signals;
        // 002:354-385: all of X0.0 to X3.7 are on CN61; 002:392-423: Y0.0 to Y3.7 on CN62.
        for (letter, connector) in [('X', "CN61"), ('Y', "CN62")] {
            for bit in 0..32 {
                let address = format!("{letter}{}.{}", bit / 8, bit % 8);
                let rows = signals.rows().iter();
                let mut rows = rows.filter(|row| row.keys[2] == address);
                let row = rows.next().unwrap_or_else(|| panic!("{address}"));
                // Pins 1 to 16, then 29 to 44.
                let pin = if bit < 16 { bit + 1 } else { bit + 13 };
                assert_eq!(row.keys[..2], [connector, &pin.to_string()], "{address}");
            }
        }
        // 002:359, 383, 385, 434, 451, 460.
        assert_eq!(found(signals, "ESP CN61"), ["CN61 6 X0.5 ESP"]);
        assert_eq!(found(signals, "skip"), ["CN61 42 X3.5 SKIP"]);
        assert_eq!(found(signals, "XAEZ"), ["CN61 44 X3.7 LTZP/XAEZ"]);
        assert_eq!(found(signals, "cn78 Y9.1"), ["CN78 1 Y9.1 SPLAMP"]);
        assert_eq!(found(signals, "X29.6"), ["CN66 2 X29.6 BAUD1_B"]);
        assert_eq!(found(signals, "X29.1"), ["CN67 6 X29.1 BAUD2_F"]);
        // 002:224-232: addresses of the handwheel.
        assert_eq!(found(signals, "CN31 X7.1"), ["CN31 - X7.1 -"]);
        assert_eq!(found(signals, "no such signal"), [""; 0]);
    }

    #[test]
    fn the_diagnosis_numbers_are_those_of_the_manual() {
        let diagnosis = MillTable::Diagnosis;
        // 002:2645-2652.
        assert_eq!(found(diagnosis, "000. DECX"), ["000.0 DECX"]);
        assert_eq!(found(diagnosis, "X3.5"), ["001.0 SKIP"]);
        // 002:2676-2695: four numbers of each axis, two left out between the axes.
        for (axis, first) in [("X:", 48), ("Y:", 54), ("Z:", 60)] {
            let numbers = (first..first + 4).map(|number| format!("{number:03} -"));
            let rows: Vec<String> = numbers.collect();
            let of_axis = found(diagnosis, axis);
            assert_eq!(of_axis[..4], rows);
        }
        // 002:2712-2713.
        assert_eq!(found(diagnosis, "116"), ["116 -"]);
        assert_eq!(found(diagnosis, "运行总时间"), ["117 -"]);
    }

    #[test]
    fn steps_are_found_by_parameter_and_word() {
        // 002:2585-2587.
        assert_eq!(found(MillTable::Spindle, "3731"), ["7 3730 3731"]);
        // 002:541-552.
        let d = found(MillTable::ReferenceReturn, "method d 031");
        assert_eq!(d, ["6 031 032"]);
        assert_eq!(MillTable::Spindle.search("").count(), 10);
    }
}
