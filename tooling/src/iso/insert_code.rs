//! Insert designations of ISO 1832: `CNMG 120408`.

use gsk_messages::{Message, say};
use gsk_workpiece::tool::InsertLetter;

use super::code_reader::{CodeReader, IsoCodeError, one_of};

/// Inscribed circles of the standard series, mm.
const CIRCLES_MM: [f64; 11] = [
    3.97, 4.76, 5.56, 6.35, 7.94, 9.525, 12.7, 15.875, 19.05, 25.4, 31.75,
];
/// Diameters of round inserts in the metric series, mm.
const ROUND_MM: [f64; 10] = [5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 16.0, 20.0, 25.0, 32.0];
/// The edge length in a designation is the nominal one without its decimals; 10.998 counts as 11.
const ROUNDING_MM: f64 = 0.01;
/// Symbols of the thickness and their thickness, mm.
const THICKNESSES: [(&str, f64); 15] = [
    ("01", 1.59),
    ("T0", 1.79),
    ("T1", 1.98),
    ("02", 2.38),
    ("T2", 2.78),
    ("03", 3.18),
    ("T3", 3.97),
    ("04", 4.76),
    ("T4", 4.96),
    ("05", 5.56),
    ("T5", 5.95),
    ("06", 6.35),
    ("07", 7.94),
    ("09", 9.525),
    ("12", 12.7),
];
/// Symbols of the clearance and their angles, degrees; O is another angle.
const CLEARANCES: [(char, f64); 9] = [
    ('N', 0.0),
    ('A', 3.0),
    ('B', 5.0),
    ('C', 7.0),
    ('P', 11.0),
    ('D', 15.0),
    ('E', 20.0),
    ('F', 25.0),
    ('G', 30.0),
];

/// An insert by its designation.
#[derive(Clone, Debug, PartialEq)]
pub struct InsertCode {
    /// Shape of the insert.
    pub letter: InsertLetter,
    /// Symbol of the normal clearance.
    pub clearance: char,
    /// Symbol of the edge length, two digits.
    pub size_symbol: u8,
    /// Diameter of the inscribed circle, mm.
    pub circle_mm: f64,
    /// Thickness of the insert, mm.
    pub thickness_mm: f64,
    /// Nose radius, mm; half the diameter of a round insert.
    pub nose_mm: f64,
}

impl InsertCode {
    /// Parses a designation. Spaces are ignored; symbols after the nose radius are the maker's.
    ///
    /// # Errors
    /// The position and the rule that the designation breaks.
    pub fn parse(text: &str) -> Result<Self, IsoCodeError> {
        let code: String = text
            .chars()
            .filter(|it| !it.is_whitespace())
            .map(|it| it.to_ascii_uppercase())
            .collect();
        let mut reader = CodeReader::new(&code);
        let letter = read_shape(&mut reader, 1)?;
        let clearance = reader.letter((2, say::tool_part_clearance()), "NABCPDEFGO")?;
        reader.letter((3, say::tool_part_tolerance()), "AFCHEGJKLMNU")?;
        reader.letter((4, say::tool_part_fastening()), "NRFAMGWTQUBHCJX")?;
        let place = (5, say::tool_part_edge());
        let size_symbol = reader.two_digits(place.clone())?;
        let Some(circle_mm) = circle_mm(letter, size_symbol) else {
            let sizes = size_symbols(letter).map(|it| format!("{it:02}"));
            return Err(reader.error(place, &format!("{size_symbol:02}"), one_of(sizes)));
        };
        let symbol = reader.take(2);
        let known = THICKNESSES.iter().find(|it| it.0 == symbol);
        let (_, thickness_mm) = *known.ok_or_else(|| {
            let place = (6, say::tool_part_thickness());
            reader.error(place, symbol, one_of(THICKNESSES.iter().map(|it| it.0)))
        })?;
        let nose_mm = read_nose(&mut reader, letter, circle_mm)?;
        Ok(Self {
            letter,
            clearance,
            size_symbol,
            circle_mm,
            thickness_mm,
            nose_mm,
        })
    }

    /// Normal clearance, degrees; `None` for the symbol of other angles.
    pub fn clearance_degrees(&self) -> Option<f64> {
        let known = CLEARANCES.iter().find(|it| it.0 == self.clearance);
        known.map(|it| it.1)
    }

    /// Length of the cutting edge, mm.
    pub fn edge_mm(&self) -> f64 {
        self.letter.edge_length_mm(self.circle_mm)
    }
}

/// Reads the shape, which is a symbol of holders as well.
pub(super) fn read_shape(
    reader: &mut CodeReader<'_>,
    position: u8,
) -> Result<InsertLetter, IsoCodeError> {
    let place = (position, say::tool_part_shape());
    let letter = reader.letter(place, "CDVWTSR")?;
    let known = InsertLetter::ALL.into_iter();
    let mut known = known.filter(|it| format!("{it:?}").starts_with(letter));
    Ok(known.next().unwrap_or(InsertLetter::C))
}

/// Nose radius in tenths of a millimetre; round inserts have `00` or `M0`.
fn read_nose(
    reader: &mut CodeReader<'_>,
    letter: InsertLetter,
    circle_mm: f64,
) -> Result<f64, IsoCodeError> {
    let place = (7, say::tool_part_nose());
    if letter == InsertLetter::R {
        return match reader.take(2) {
            "00" | "M0" => Ok(circle_mm / 2.0),
            other => Err(reader.error(place, other, one_of(["00", "M0"].into_iter()))),
        };
    }
    let tenths = reader.two_digits(place.clone())?;
    let nose = f64::from(tenths) / 10.0;
    if nose > circle_mm / 4.0 {
        let rule: Message = say::tool_rule_nose(circle_mm / 4.0);
        return Err(reader.error(place, &format!("{tenths:02}"), rule));
    }
    Ok(nose)
}

/// The inscribed circle that has an edge length with this symbol.
fn circle_mm(letter: InsertLetter, symbol: u8) -> Option<f64> {
    let has_symbol = |circle: &f64| size_symbol(letter, *circle) == symbol;
    match letter {
        InsertLetter::R => {
            let metric = ROUND_MM
                .into_iter()
                .find(|it| size_symbol(letter, *it) == symbol);
            metric.or_else(|| CIRCLES_MM.into_iter().find(has_symbol))
        }
        // 3.97 mm and 4.76 mm have the same symbol; the second has the edge of 4.8 mm.
        _ => CIRCLES_MM.into_iter().rev().find(has_symbol),
    }
}

fn size_symbol(letter: InsertLetter, circle_mm: f64) -> u8 {
    (letter.edge_length_mm(circle_mm) + ROUNDING_MM) as u8
}

fn size_symbols(letter: InsertLetter) -> impl Iterator<Item = u8> {
    let circles: &[f64] = match letter {
        InsertLetter::R => &ROUND_MM,
        _ => &CIRCLES_MM,
    };
    let mut symbols: Vec<u8> = circles.iter().map(|it| size_symbol(letter, *it)).collect();
    symbols.dedup();
    symbols.into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_messages::Language;

    /// Designation, inscribed circle, edge length, nose radius: of makers' catalogues.
    const CATALOGUE: [(&str, f64, f64, f64); 16] = [
        ("CNMG 120408", 12.7, 12.9, 0.8),
        ("CCMT 060204", 6.35, 6.45, 0.4),
        ("CCMT 09T308-PM", 9.525, 9.67, 0.8),
        ("CNMM 190616", 19.05, 19.35, 1.6),
        ("DNMG 150608-MF 4325", 12.7, 15.5, 0.8),
        ("DCMT 070202", 6.35, 7.75, 0.2),
        ("DCMT11T304", 9.525, 11.63, 0.4),
        ("VNMG 160404", 9.525, 16.6, 0.4),
        ("VBMT 110302", 6.35, 11.07, 0.2),
        ("VCGT220530", 12.7, 22.14, 3.0),
        ("WNMG 080412", 12.7, 8.69, 1.2),
        ("WNMG 060408", 9.525, 6.52, 0.8),
        ("TNMG 160404", 9.525, 16.5, 0.4),
        ("TCMT 110204", 6.35, 11.0, 0.4),
        ("SNMG120412", 12.7, 12.7, 1.2),
        ("RCMT 1204M0", 12.0, 12.0, 6.0),
    ];

    #[test]
    fn designations_have_the_dimensions_of_the_catalogue() {
        for (text, circle, edge, nose) in CATALOGUE {
            let code = InsertCode::parse(text).unwrap();
            assert_eq!((code.circle_mm, code.nose_mm), (circle, nose), "{text}");
            assert!(
                (code.edge_mm() - edge).abs() < 0.02,
                "{text} {}",
                code.edge_mm()
            );
        }
        let code = InsertCode::parse("ccmt 09t308").unwrap();
        assert_eq!(code.clearance_degrees(), Some(7.0));
        assert_eq!(code.thickness_mm, 3.97);
    }

    #[test]
    fn a_fault_names_its_position_and_the_rule() {
        for (text, position, found) in [
            ("KNMG 120408", 1, "K"),
            ("CXMG 120408", 2, "X"),
            ("CNZG 120408", 3, "Z"),
            ("CNM1 120408", 4, "1"),
            ("CNMG 130408", 5, "13"),
            ("CNMG 12X408", 6, "X4"),
            ("CNMG 1204", 7, ""),
            ("CNMG 120499", 7, "99"),
            ("CNMG 1204É8", 7, "É8"),
            ("RCMT 120408", 7, "08"),
            ("", 1, ""),
        ] {
            let error = InsertCode::parse(text).unwrap_err();
            assert_eq!(
                (error.position, error.found.as_str()),
                (position, found),
                "{text}"
            );
            assert!(
                error
                    .message()
                    .text(Language::En)
                    .contains(&format!("position {position}"))
            );
        }
    }
}
