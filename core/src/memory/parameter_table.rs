//! The parameter table of the manual (appendix 1 and 2), read from
//! `assets/tables/parameters.tsv`.

use std::sync::LazyLock;

use gsk_messages::HelpColumns;
use serde::{Deserialize, Serialize};

const TABLE: &str = include_str!("../../../assets/tables/parameters.tsv");

/// The highest number of a parameter.
pub(crate) const LAST_PARAMETER: u16 = 185;

/// An electronic disk: a stored set of parameter values (manual III-2.1.10).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ElectronicDisk {
    /// Electronic disk N0: factory values of the manufacturer; read-only.
    N0,
    /// Values saved by the user; as delivered equal to N0.
    N1,
    /// Electronic disk N2: values for servo drives.
    N2,
    /// Electronic disk N3: values for stepper drives.
    N3,
    /// Electronic disk N4: values for both kinds of drives.
    N4,
}

impl ElectronicDisk {
    /// Index of the disk in the lists of factory values.
    pub(super) const fn factory_index(self) -> usize {
        match self {
            Self::N0 | Self::N1 => 0,
            Self::N2 => 1,
            Self::N3 => 2,
            Self::N4 => 3,
        }
    }
}

/// The moment at which a changed parameter takes effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EffectiveTime {
    /// The change takes effect at the next use of the value.
    AtOnce,
    /// The change takes effect at the next power-on.
    AtPowerOn {
        /// Whether the change raises alarm 000 (power must be switched off and on).
        alarm: bool,
    },
    /// Differs from bit to bit of a state parameter: see the rows of its bits.
    PerBit,
}

/// The permitted values of a parameter: a range or a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ParameterRange {
    /// All values from the least (first) to the greatest (second).
    Span(i32, i32),
    /// Only the values in this list are permitted.
    List(Vec<i32>),
}

impl ParameterRange {
    /// Returns whether a value is permitted.
    pub fn contains(&self, value: i32) -> bool {
        match self {
            Self::Span(low, high) => (*low..=*high).contains(&value),
            Self::List(values) => values.contains(&value),
        }
    }
}

impl core::fmt::Display for ParameterRange {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Span(low, high) => write!(f, "{low}..{high}"),
            Self::List(values) => {
                for (index, value) in values.iter().enumerate() {
                    let bar = if index == 0 { "" } else { "|" };
                    write!(f, "{bar}{value}")?;
                }
                Ok(())
            }
        }
    }
}

/// A row of the parameter table: a data parameter, a whole state parameter, or one of its
/// bits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParameterRow {
    /// Number of the parameter.
    pub number: u16,
    /// Bit number, 0 to 7, for a bit of a state parameter; `None` for a whole parameter.
    pub bit: Option<u8>,
    /// Whether the row is a whole state parameter, shown as eight binary digits.
    pub state: bool,
    /// Abbreviation on the parameter page; empty without one.
    pub symbol: &'static str,
    /// Unit of the value; empty without one.
    pub unit: &'static str,
    /// Permitted values of the parameter.
    pub range: ParameterRange,
    /// Factory values on the disks N0 (and N1), N2, N3, N4.
    pub factory: [i32; 4],
    /// The moment at which a change takes effect.
    pub effective: EffectiveTime,
    /// Meaning of the parameter, in English.
    pub meaning_en: &'static str,
    /// Meaning as shown on the parameter page, in Chinese.
    pub meaning_zh: &'static str,
    /// Meaning as shown on the parameter page, in English; empty if `meaning_en` fits there.
    pub lcd_en: &'static str,
    /// The function of the control that uses the parameter.
    pub used_by: &'static str,
    /// Help texts about the parameter in both languages.
    pub help: HelpColumns,
}

impl ParameterRow {
    /// The factory value of this parameter on an electronic disk.
    pub const fn factory_value(&self, disk: ElectronicDisk) -> i32 {
        self.factory[disk.factory_index()]
    }
}

/// All rows by parameter number. A whole state parameter is before its bits, which are in the
/// order 7 to 0.
pub fn parameter_rows() -> &'static [ParameterRow] {
    static ROWS: LazyLock<Vec<ParameterRow>> =
        LazyLock::new(|| TABLE.lines().skip(1).filter_map(parse_row).collect());
    &ROWS
}

/// The row of a whole parameter (`bit` is `None`) or of one of its bits; `None` if it does not
/// exist.
pub fn parameter_row(number: u16, bit: Option<u8>) -> Option<&'static ParameterRow> {
    let rows = parameter_rows();
    let first = rows.partition_point(|row| row.number < number);
    let same = rows
        .get(first..)?
        .iter()
        .take_while(|row| row.number == number);
    same.into_iter().find(|row| row.bit == bit)
}

fn parse_row(line: &'static str) -> Option<ParameterRow> {
    let mut fields = line
        .split('\t')
        .map(|field| if field == "-" { "" } else { field });
    let number = fields.next()?.parse().ok()?;
    let bit = fields.next()?;
    let bit = if bit.is_empty() {
        None
    } else {
        Some(bit.parse().ok()?)
    };
    let symbol = fields.next()?;
    let _id = fields.next()?;
    let unit = fields.next()?;
    let range = fields.next()?;
    let state = range == "00000000..11111111";
    let value = |text: &str| {
        if state {
            i32::from_str_radix(text, 2)
        } else {
            text.parse()
        }
    };
    let range = match range.split_once("..") {
        Some((low, high)) => ParameterRange::Span(value(low).ok()?, value(high).ok()?),
        None => ParameterRange::List(range.split('|').map(value).collect::<Result<_, _>>().ok()?),
    };
    let mut factory = [0; 4];
    for value_slot in &mut factory {
        *value_slot = value(fields.next()?).ok()?;
    }
    let effective = match fields.next()? {
        "at once" => EffectiveTime::AtOnce,
        "see bits" => EffectiveTime::PerBit,
        // These are read at power-on only; a change raises no alarm.
        "at power-on" => EffectiveTime::AtPowerOn {
            alarm: !matches!(number, 20 | 173 | 174),
        },
        _ => return None,
    };
    Some(ParameterRow {
        number,
        bit,
        state,
        symbol,
        unit,
        range,
        factory,
        effective,
        meaning_en: fields.next()?,
        meaning_zh: fields.next()?,
        lcd_en: fields.next()?,
        used_by: fields.next()?,
        help: HelpColumns::read(&mut fields)?,
    })
}

#[cfg(test)]
mod tests {
    use super::super::factory_values::FACTORY_VALUES;
    use super::*;

    #[test]
    fn every_line_of_the_table_is_a_row() {
        assert_eq!(parameter_rows().len(), TABLE.lines().count() - 1);
        let key = |row: &ParameterRow| (row.number, row.bit.map_or(0, |bit| 8 - bit));
        assert!(
            parameter_rows()
                .windows(2)
                .all(|pair| key(&pair[0]) < key(&pair[1]))
        );
        for row in parameter_rows() {
            assert!(row.number <= LAST_PARAMETER);
            assert_eq!(
                row.state || row.bit.is_some(),
                is_state(row.number),
                "{row:?}"
            );
            assert!(
                !row.meaning_en.is_empty() && !row.meaning_zh.is_empty(),
                "{row:?}"
            );
        }
        let whole = |number| parameter_row(number, None).is_some();
        for number in (1..=124).chain([164, 168]).chain(172..=185) {
            assert!(whole(number), "{number}");
        }
        assert!(!whole(0) && !whole(125) && !whole(186));
    }

    fn is_state(number: u16) -> bool {
        matches!(number, 1..=14 | 164 | 168 | 172..=185)
    }

    #[test]
    fn factory_values_are_those_of_the_table() {
        let whole = parameter_rows().iter().filter(|row| row.bit.is_none());
        let expected: Vec<_> = whole.map(|row| (row.number, row.factory)).collect();
        assert_eq!(FACTORY_VALUES, expected);
    }

    #[test]
    fn bits_agree_with_their_parameter() {
        for row in parameter_rows() {
            let Some(bit) = row.bit else { continue };
            let whole = parameter_row(row.number, None).unwrap();
            for (whole, value) in whole.factory.iter().zip(row.factory) {
                assert_eq!(whole >> bit & 1, value, "{row:?}");
            }
        }
    }

    #[test]
    fn known_rows() {
        assert_eq!(
            parameter_row(22, None).unwrap().factory,
            [3800, 4000, 2500, 3000]
        );
        assert_eq!(
            parameter_row(3, None).unwrap().factory[..2],
            [0b0011_0000, 0b0001_0000]
        );
        assert!(parameter_row(44, None).unwrap().range.contains(110));
        assert!(!parameter_row(44, None).unwrap().range.contains(111));
        assert_eq!(
            parameter_row(10, Some(0)).unwrap().effective,
            EffectiveTime::AtPowerOn { alarm: true }
        );
        assert_eq!(
            parameter_row(20, None).unwrap().effective,
            EffectiveTime::AtPowerOn { alarm: false }
        );
        assert_eq!(parameter_row(12, Some(1)).unwrap().symbol, "EBCL");
    }
}
