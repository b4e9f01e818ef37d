//! The table of starting values: speed, feed and depth by group of materials and operation.

use gsk_messages::{Message, say};

use super::CuttingMaterial;

/// The table: groups, operation, ranges of speed, feed and depth, and their source.
const TABLE: &str = include_str!("../../../assets/tables/cutting-values.tsv");

/// An operation for which the table has values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CuttingOperation {
    /// Turning for a good surface.
    Finishing,
    /// Turning for a great volume.
    Roughing,
    /// Plunging with a grooving or parting insert.
    Grooving,
}

impl CuttingOperation {
    const WORDS: [(&'static str, Self); 3] = [
        ("finishing", Self::Finishing),
        ("roughing", Self::Roughing),
        ("grooving", Self::Grooving),
    ];

    /// The name of the operation for the user.
    pub fn name(self) -> Message {
        match self {
            Self::Finishing => say::cutting_finishing(),
            Self::Roughing => say::cutting_roughing(),
            Self::Grooving => say::cutting_grooving(),
        }
    }
}

/// Ranges of cutting values to start with. Carbide inserts, continuous cuts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartingValues {
    /// The operation.
    pub operation: CuttingOperation,
    /// Least and greatest cutting speed, m/min.
    pub speed_m_per_min: (f64, f64),
    /// Least and greatest feed per revolution, mm.
    pub feed_mm: (f64, f64),
    /// Least and greatest depth of cut, mm; `None` for grooves.
    pub depth_mm: Option<(f64, f64)>,
    /// The publication of the values.
    pub source: &'static str,
    groups: &'static str,
}

impl StartingValues {
    /// All rows of the table.
    pub fn all() -> impl Iterator<Item = Self> {
        TABLE.lines().skip(1).filter_map(Self::parse)
    }

    /// The rows for a material, in the order of the table.
    pub fn of_material(material: &CuttingMaterial) -> impl Iterator<Item = Self> {
        let group = material.group;
        Self::all().filter(move |it| contains_group(it.groups, group))
    }

    fn parse(line: &'static str) -> Option<Self> {
        let mut fields = line.split('\t');
        let groups = fields.next()?;
        let word = fields.next()?;
        let operation = CuttingOperation::WORDS.iter().find(|it| it.0 == word)?.1;
        let (speed, feed, depth) = (fields.next()?, fields.next()?, fields.next()?);
        Some(Self {
            operation,
            speed_m_per_min: parse_range(speed)?,
            feed_mm: parse_range(feed)?,
            depth_mm: parse_range(depth),
            source: fields.next()?,
            groups,
        })
    }
}

/// A range `least~greatest`; `None` for another text.
fn parse_range(text: &str) -> Option<(f64, f64)> {
    let (least, greatest) = text.split_once('~')?;
    Some((least.parse().ok()?, greatest.parse().ok()?))
}

/// Whether `N21-25` contains `N22`; a letter alone contains all of its groups.
fn contains_group(groups: &str, group: &str) -> bool {
    let (letter, numbers) = groups.split_at(1);
    let Some(number) = group.strip_prefix(letter) else {
        return false;
    };
    let Some((first, last)) = numbers.split_once('-') else {
        return true;
    };
    let parse = |text: &str| text.parse::<u8>().ok();
    match (parse(first), parse(last), parse(number)) {
        (Some(first), Some(last), Some(number)) => (first..=last).contains(&number),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_line_of_the_table_is_read() {
        assert_eq!(StartingValues::all().count(), TABLE.lines().count() - 1);
        for row in StartingValues::all() {
            let ranges = [Some(row.speed_m_per_min), Some(row.feed_mm), row.depth_mm];
            for (least, greatest) in ranges.into_iter().flatten() {
                assert!(least > 0.0 && least <= greatest, "{row:?}");
            }
            assert!(row.source.len() > 10, "{row:?}");
        }
    }

    #[test]
    fn a_material_has_the_rows_of_its_group() {
        let speeds = |name: &str| {
            let material = CuttingMaterial::from_name(name).expect("in the table");
            let rows = StartingValues::of_material(&material);
            rows.map(|it| it.speed_m_per_min.1).collect::<Vec<_>>()
        };
        assert_eq!(speeds("C45"), [420.0, 200.0, 200.0]);
        assert_eq!(speeds("EN AW-6082"), [200.0, 800.0, 500.0]);
        assert_eq!(speeds("CuZn39Pb3"), [200.0, 200.0]);
        assert_eq!(speeds("TiAl6V4"), [70.0]);
        assert_eq!(speeds("NiCr19NbMo"), [0.0; 0], "no row for nickel");
    }
}
