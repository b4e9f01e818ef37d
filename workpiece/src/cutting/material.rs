//! The table of workpiece materials with their specific cutting force.

use crate::stock::StockMaterial;

/// The table: name, group, k_c1.1, m_c and the source of both values.
const TABLE: &str = include_str!("../../../assets/tables/materials.tsv");

/// A workpiece material with the constants of its cutting force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CuttingMaterial {
    /// The designation of the material, for instance `C45`.
    pub name: &'static str,
    /// The letter of ISO 513 and the number of VDI 3323, for instance `P2`.
    pub group: &'static str,
    /// Cutting force of a chip of 1 mm width and 1 mm thickness, N/mm².
    pub kc11: f64,
    /// Exponent with which the specific cutting force decreases with the chip thickness.
    pub mc: f64,
    /// The publication of both constants.
    pub source: &'static str,
}

impl CuttingMaterial {
    /// All materials in the order of the table.
    pub fn all() -> impl Iterator<Item = Self> {
        TABLE.lines().skip(1).filter_map(Self::parse)
    }

    /// The material with this designation, in upper or lower case.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::all().find(|it| it.name.eq_ignore_ascii_case(name.trim()))
    }

    /// The material that stands for stock whose job names no grade; `None` for plastic, for
    /// which the table has no constants.
    pub fn from_stock_material(material: StockMaterial) -> Option<Self> {
        let name = match material {
            StockMaterial::Steel => "C45",
            StockMaterial::Stainless => "X5CrNi18-10",
            StockMaterial::CastIron => "EN-GJL-250",
            StockMaterial::Aluminium => "EN AW-6082",
            StockMaterial::Brass => "CuZn39Pb3",
            StockMaterial::Plastic => return None,
        };
        Self::from_name(name)
    }

    fn parse(line: &'static str) -> Option<Self> {
        let mut fields = line.split('\t');
        Some(Self {
            name: fields.next()?,
            group: fields.next()?,
            kc11: fields.next()?.parse().ok()?,
            mc: fields.next()?.parse().ok()?,
            source: fields.next()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_line_of_the_table_is_a_material_with_a_source() {
        assert_eq!(CuttingMaterial::all().count(), TABLE.lines().count() - 1);
        for material in CuttingMaterial::all() {
            assert!((300.0..5000.0).contains(&material.kc11), "{material:?}");
            assert!((0.1..0.5).contains(&material.mc), "{material:?}");
            assert!(material.source.len() > 10, "{material:?}");
            let (letter, number) = material.group.split_at(1);
            assert!("PMKNSH".contains(letter), "{material:?}");
            assert!(number.parse::<u8>().is_ok(), "{material:?}");
            let lower = material.name.to_lowercase();
            assert_eq!(CuttingMaterial::from_name(&lower), Some(material));
        }
    }

    #[test]
    fn every_metal_has_a_default_grade() {
        for material in StockMaterial::ALL {
            let has_grade = CuttingMaterial::from_stock_material(material).is_some();
            assert_eq!(has_grade, material != StockMaterial::Plastic);
        }
    }
}
