//! The parameters of the GSK980MDi as its manual lists them, from
//! `assets/tables/mill-parameters.tsv`: those that act here and those that do not.

use std::sync::LazyLock;

const TABLE: &str = include_str!("../../assets/tables/mill-parameters.tsv");

/// A bit, or a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParameterRow {
    /// Its number; those of an axis have 10000 for X to 50000 for the fifth more.
    pub number: u16,
    /// Of a state parameter.
    pub bit: Option<u8>,
    /// The name of the bit.
    pub symbol: &'static str,
    /// Axes that have one each: 1 X, 2 Y, 3 Z, 4 and 5 the further ones; none: there is one.
    pub axes: &'static [u16],
    /// Its unit; `bit` of a bit, `-` without one.
    pub unit: &'static str,
    /// Least and greatest value, as they are written; `-` where the manual has none.
    pub range: &'static str,
    /// Whether it changes what `check` and `plot` do.
    pub acts: bool,
    /// What it is, in English.
    pub en: &'static str,
    /// The same in Chinese.
    pub zh: &'static str,
}

/// The table, by number and bit.
pub fn parameter_rows() -> &'static [ParameterRow] {
    static ROWS: LazyLock<Vec<ParameterRow>> =
        LazyLock::new(|| TABLE.lines().skip(1).filter_map(row).collect());
    &ROWS
}

fn row(line: &'static str) -> Option<ParameterRow> {
    let mut fields = line.split('\t');
    let mut next = || fields.next();
    Some(ParameterRow {
        number: next()?.parse().ok()?,
        bit: next()?.parse().ok(),
        symbol: next()?,
        axes: match next()? {
            "each" => &[1, 2, 3, 4, 5],
            "xyz" => &[1, 2, 3],
            "further" => &[4, 5],
            _ => &[],
        },
        unit: next()?,
        range: next()?,
        acts: next()? == "yes",
        en: next()?,
        zh: next()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::model::ModelId;

    #[test]
    fn every_line_is_a_row() {
        let rows = parameter_rows();
        assert_eq!(rows.len(), TABLE.lines().count() - 1);
        let keys: Vec<_> = rows
            .iter()
            .map(|row| (row.number, row.bit.map(|bit| 7 - bit)))
            .collect();
        assert!(keys.is_sorted() && keys.windows(2).all(|pair| pair[0] != pair[1]));
    }

    /// The parameters that the record of the model has are those that act, with the units
    /// and ranges of the manual.
    #[test]
    fn what_acts_is_what_the_model_has() {
        let record = ModelId::Gsk980mdi.record();
        let of_axes = |row: &ParameterRow| match row.axes {
            [] => vec![row.number],
            axes => axes.iter().map(|axis| row.number + axis * 10_000).collect(),
        };
        for row in parameter_rows() {
            for number in of_axes(row) {
                let Some(there) = record.parameters.get(&number) else {
                    assert!(!row.acts, "{number} acts, and the model has none");
                    continue;
                };
                if row.bit.is_some() {
                    assert_eq!(there.unit, "bits", "{number}");
                    continue;
                }
                // 036 is a time of flexible taps in this manual, bits in the appendix that it
                // refers to; the bits act (MODEL-47).
                if there.unit == "bits" {
                    assert!(!row.acts, "{number}: its bits act");
                    continue;
                }
                assert!(row.acts, "{number} of the model acts");
                assert_eq!(there.unit, row.unit, "{number}");
                let (least, greatest) = there.range;
                assert_eq!(format!("{least}..{greatest}"), row.range, "{number}");
            }
        }
        let listed: Vec<u16> = parameter_rows().iter().flat_map(of_axes).collect();
        for (number, parameter) in &record.parameters {
            let rows = parameter_rows().iter();
            let acts = rows
                .clone()
                .any(|row| of_axes(row).contains(number) && row.acts);
            assert!(listed.contains(number) && acts, "{number} {parameter:?}");
        }
    }
}
