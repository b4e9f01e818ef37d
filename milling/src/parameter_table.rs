//! Reads the parameters of the GSK980MDi from `assets/tables/mill-parameters.tsv`, as its
//! manual lists them.

use std::sync::LazyLock;

use gsk_messages::{Message, say};

const TABLE: &str = include_str!("../../assets/tables/mill-parameters.tsv");

/// A row of the parameter table: a parameter, or one of its bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MillParameterRow {
    /// Number of the parameter. For an axis add 10000 (X) to 50000 (fifth).
    pub number: u16,
    /// Number of the bit (0 to 7) in a state parameter; `None` for a whole parameter.
    pub bit: Option<u8>,
    /// The symbol of the bit in the manual, such as `ZRN`.
    pub symbol: &'static str,
    /// The axes that have such a parameter each: 1 X, 2 Y, 3 Z, 4 and 5 the further ones.
    /// Empty if there is only one parameter.
    pub axes: &'static [u16],
    /// Unit of the value: `bit` for a bit, `-` if it has none.
    pub unit: &'static str,
    /// Least and greatest value as the manual writes them, `-` if it gives none.
    pub range: &'static str,
    /// Why the parameter has no effect on the commands `check` and `plot`; `None` if it has one.
    pub without_effect: Option<WithoutEffect>,
    /// The meaning of the parameter in English.
    pub en: &'static str,
    /// The meaning of the parameter in Chinese.
    pub zh: &'static str,
}

/// Why a parameter has no effect on a checked program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WithoutEffect {
    /// It belongs to jogging, steps and the handwheel.
    Hand,
    /// It belongs to the return to machine zero.
    Homing,
    /// It belongs to drives, gear ratio and the errors of the screw.
    Drive,
    /// It belongs to override, dry run and the stop buttons.
    Switch,
    /// It sets what power-on, reset or MDI leave.
    Start,
    /// It belongs to the display and the editor.
    Display,
    /// It belongs to a signal that comes at the programmed point here.
    Probe,
    /// It belongs to voltage, encoder and speed of a real spindle.
    Spindle,
    /// It belongs to the ladder.
    Ladder,
    /// It belongs to ports and supply voltage.
    Port,
    /// The manual gives no format for the codes that use it.
    Format,
}

impl WithoutEffect {
    /// Parses a word of the column `acts`; `None` if it is unknown.
    fn parse(word: &str) -> Option<Self> {
        Some(match word {
            "hand" => Self::Hand,
            "homing" => Self::Homing,
            "drive" => Self::Drive,
            "switch" => Self::Switch,
            "start" => Self::Start,
            "display" => Self::Display,
            "probe" => Self::Probe,
            "spindle" => Self::Spindle,
            "ladder" => Self::Ladder,
            "port" => Self::Port,
            "format" => Self::Format,
            _ => return None,
        })
    }

    /// Returns the reason as a text.
    pub fn message(self) -> Message {
        match self {
            Self::Hand => say::mill_idle_hand(),
            Self::Homing => say::mill_idle_homing(),
            Self::Drive => say::mill_idle_drive(),
            Self::Switch => say::mill_idle_switch(),
            Self::Start => say::mill_idle_start(),
            Self::Display => say::mill_idle_display(),
            Self::Probe => say::mill_idle_probe(),
            Self::Spindle => say::mill_idle_spindle(),
            Self::Ladder => say::mill_idle_ladder(),
            Self::Port => say::mill_idle_port(),
            Self::Format => say::mill_idle_format(),
        }
    }
}

/// Returns all rows of the parameter table, sorted by number and bit.
pub fn mill_parameter_rows() -> &'static [MillParameterRow] {
    static ROWS: LazyLock<Vec<MillParameterRow>> =
        LazyLock::new(|| TABLE.lines().skip(1).filter_map(row).collect());
    &ROWS
}

fn row(line: &'static str) -> Option<MillParameterRow> {
    let mut fields = line.split('\t');
    let mut next = || fields.next();
    Some(MillParameterRow {
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
        without_effect: match next()? {
            "yes" => None,
            reason => Some(WithoutEffect::parse(reason)?),
        },
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
        let rows = mill_parameter_rows();
        assert_eq!(rows.len(), TABLE.lines().count() - 1);
        let keys: Vec<_> = rows
            .iter()
            .map(|row| (row.number, row.bit.map(|bit| 7 - bit)))
            .collect();
        assert!(keys.is_sorted() && keys.windows(2).all(|pair| pair[0] != pair[1]));
    }

    /// The parameters in the model's record are those that act, with the units and ranges of
    /// the manual.
    #[test]
    fn what_acts_is_what_the_model_has() {
        let record = ModelId::Gsk980mdi.record();
        let of_axes = |row: &MillParameterRow| match row.axes {
            [] => vec![row.number],
            axes => axes.iter().map(|axis| row.number + axis * 10_000).collect(),
        };
        for row in mill_parameter_rows() {
            for number in of_axes(row) {
                let Some(there) = record.parameters().get(&number) else {
                    assert!(
                        row.without_effect.is_some(),
                        "{number} acts, and the model has none"
                    );
                    continue;
                };
                if row.bit.is_some() {
                    assert_eq!(there.unit, "bits", "{number}");
                    continue;
                }
                assert_eq!(row.without_effect, None, "{number} of the model acts");
                assert_eq!(there.unit, row.unit, "{number}");
                let (least, greatest) = there.range;
                assert_eq!(format!("{least}..{greatest}"), row.range, "{number}");
            }
        }
        let listed: Vec<u16> = mill_parameter_rows().iter().flat_map(of_axes).collect();
        for (number, parameter) in record.parameters() {
            let rows = mill_parameter_rows().iter();
            let acts = rows
                .clone()
                .any(|row| of_axes(row).contains(number) && row.without_effect.is_none());
            assert!(listed.contains(number) && acts, "{number} {parameter:?}");
        }
    }
}
