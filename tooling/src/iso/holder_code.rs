//! Holder designations of ISO 5608 (`PCLNR 2020K12`) and of boring bars, ISO 6261
//! (`S16R-SCLCR 09`).

use gsk_messages::say;
use gsk_workpiece::tool::{Holder, InsertLetter};

use super::code_reader::{CodeReader, IsoCodeError, one_of};
use super::insert_code::{InsertCode, read_shape};

/// Symbols of the length of a holder and their length, mm.
const LENGTHS: [(char, f64); 23] = [
    ('A', 32.0),
    ('B', 40.0),
    ('C', 50.0),
    ('D', 60.0),
    ('E', 70.0),
    ('F', 80.0),
    ('G', 90.0),
    ('H', 100.0),
    ('J', 110.0),
    ('K', 125.0),
    ('L', 140.0),
    ('M', 150.0),
    ('N', 160.0),
    ('P', 170.0),
    ('Q', 180.0),
    ('R', 200.0),
    ('S', 250.0),
    ('T', 300.0),
    ('U', 350.0),
    ('V', 400.0),
    ('W', 450.0),
    ('Y', 500.0),
    // Another length: that of the usual size is taken.
    ('X', 125.0),
];
/// Styles and their entering angles, degrees: those whose main edge turns.
const TURNING_STYLES: [(char, f64); 16] = [
    ('A', 90.0),
    ('B', 75.0),
    ('D', 45.0),
    ('E', 60.0),
    ('G', 90.0),
    ('H', 107.5),
    ('J', 93.0),
    ('L', 95.0),
    ('M', 50.0),
    ('N', 62.5),
    ('P', 117.5),
    ('Q', 107.5),
    ('R', 75.0),
    ('S', 45.0),
    ('T', 60.0),
    ('V', 72.5),
];
/// Styles and their entering angles, degrees: those whose main edge faces.
const FACING_STYLES: [(char, f64); 6] = [
    ('C', 90.0),
    ('F', 90.0),
    ('K', 75.0),
    ('U', 93.0),
    ('W', 60.0),
    ('Y', 85.0),
];
/// A shank protrudes from the tool post by this multiple of its height.
const SHANK_OVERHANG: f64 = 3.0;
/// A boring bar protrudes from its clamp by this multiple of its diameter, the usual limit of
/// a bar of steel.
const BAR_OVERHANG: f64 = 4.0;
/// Least angle between the second edge of an insert and the surface, degrees.
const LEAST_CLEARANCE_DEGREES: f64 = 2.0;

/// The hand of a holder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HolderHand {
    /// Cuts towards the chuck.
    Right,
    /// Cuts away from the chuck.
    Left,
    /// Cuts in both directions.
    Neutral,
}

/// A holder by its designation.
#[derive(Clone, Debug, PartialEq)]
pub struct HolderCode {
    /// Entering angle in the direction along the spindle axis, degrees.
    pub entering: f64,
    /// The hand.
    pub hand: HolderHand,
    /// The holder with the length by which it protrudes.
    pub holder: Holder,
    /// Length of the whole holder, mm.
    pub length_mm: f64,
}

impl HolderCode {
    /// Parses the designation of a holder for an insert.
    ///
    /// # Errors
    /// The position and the rule that the designation breaks; positions of a boring bar count
    /// from its shank.
    pub fn parse(text: &str, insert: &InsertCode) -> Result<Self, IsoCodeError> {
        let code: String = text
            .chars()
            .filter(|it| !it.is_whitespace())
            .map(|it| it.to_ascii_uppercase())
            .collect();
        let mut reader = CodeReader::new(&code);
        let is_bar = code.chars().nth(1).is_some_and(|it| it.is_ascii_digit());
        match is_bar {
            true => parse_bar(&mut reader, insert),
            false => parse_shank(&mut reader, insert),
        }
    }

    /// Number of the imaginary tip, as on the offset page with a rear tool post.
    pub const fn tip(&self) -> u8 {
        match (&self.holder, self.hand) {
            (Holder::Bar { .. }, HolderHand::Right) => 2,
            (Holder::Bar { .. }, HolderHand::Left) => 1,
            (Holder::Bar { .. }, HolderHand::Neutral) => 6,
            (_, HolderHand::Right) => 3,
            (_, HolderHand::Left) => 4,
            (_, HolderHand::Neutral) => 8,
        }
    }
}

fn parse_shank(
    reader: &mut CodeReader<'_>,
    insert: &InsertCode,
) -> Result<HolderCode, IsoCodeError> {
    let (entering, hand) = read_head(reader, insert, 1)?;
    let height = f64::from(reader.two_digits((6, say::tool_part_height()))?);
    let place = (7, say::tool_part_width());
    let width = f64::from(reader.two_digits(place.clone())?);
    if !(2.0..=100.0).contains(&width) {
        return Err(reader.error(place, &format!("{width:02}"), say::tool_rule_digits()));
    }
    let length_mm = read_length(reader, 8)?;
    read_size(reader, insert, 9)?;
    let length = (SHANK_OVERHANG * height).clamp(30.0, length_mm);
    Ok(HolderCode {
        entering,
        hand,
        holder: Holder::Shank { width, length },
        length_mm,
    })
}

fn parse_bar(reader: &mut CodeReader<'_>, insert: &InsertCode) -> Result<HolderCode, IsoCodeError> {
    reader.letter((1, say::tool_part_bar()), "SABCDEFGHJU")?;
    let place = (2, say::tool_part_diameter());
    let diameter = f64::from(reader.two_digits(place.clone())?);
    if diameter < 4.0 {
        return Err(reader.error(place, &format!("{diameter:02}"), say::tool_rule_digits()));
    }
    let length_mm = read_length(reader, 3)?;
    reader.skip('-');
    let (entering, hand) = read_head(reader, insert, 4)?;
    read_size(reader, insert, 9)?;
    let length = (BAR_OVERHANG * diameter).min(length_mm);
    Ok(HolderCode {
        entering,
        hand,
        holder: Holder::Bar { diameter, length },
        length_mm,
    })
}

/// Reads clamping, shape, style, clearance and hand; the first of them has the position `first`.
fn read_head(
    reader: &mut CodeReader<'_>,
    insert: &InsertCode,
    first: u8,
) -> Result<(f64, HolderHand), IsoCodeError> {
    reader.letter((first, say::tool_part_clamping()), "CDMPSW")?;
    let letter = read_shape(reader, first + 1)?;
    if letter != insert.letter {
        let place = (first + 1, say::tool_part_shape());
        let rule = say::tool_rule_same(format_args!("{:?}", insert.letter));
        return Err(reader.error(place, &format!("{letter:?}"), rule));
    }
    let entering = read_style(reader, insert.letter, first + 2)?;
    let place = (first + 3, say::tool_part_clearance());
    let clearance = reader.letter(place.clone(), "NABCPDEFGO")?;
    if clearance != insert.clearance {
        let rule = say::tool_rule_same(insert.clearance);
        return Err(reader.error(place, &clearance.to_string(), rule));
    }
    let hand = match reader.letter((first + 4, say::tool_part_hand()), "RLN")? {
        'R' => HolderHand::Right,
        'L' => HolderHand::Left,
        _ => HolderHand::Neutral,
    };
    Ok((entering, hand))
}

/// Reads the style and returns the entering angle along the spindle axis.
fn read_style(
    reader: &mut CodeReader<'_>,
    letter: InsertLetter,
    position: u8,
) -> Result<f64, IsoCodeError> {
    let place = (position, say::tool_part_style());
    let style = reader.letter(place.clone(), "ABCDEFGHJKLMNPQRSTUVWY")?;
    let angle = |styles: &[(char, f64)]| styles.iter().find(|it| it.0 == style).map(|it| it.1);
    if letter == InsertLetter::R {
        return Ok(90.0);
    }
    let greatest = 180.0 - LEAST_CLEARANCE_DEGREES - letter.corner();
    let entering = match angle(&FACING_STYLES) {
        // The facing edge is the second one along the axis.
        Some(facing) => (270.0 - letter.corner() - facing).min(greatest),
        None => angle(&TURNING_STYLES).unwrap_or(90.0),
    };
    let tolerated = greatest + LEAST_CLEARANCE_DEGREES;
    if !(30.0..=tolerated).contains(&entering) || angle(&FACING_STYLES).is_some_and(|it| it < 88.0)
    {
        let usable = usable_styles(letter);
        return Err(reader.error(place, &style.to_string(), one_of(usable.into_iter())));
    }
    Ok(entering.min(greatest))
}

/// The styles whose angles leave the second edge of a shape free.
fn usable_styles(letter: InsertLetter) -> Vec<char> {
    let greatest = 180.0 - letter.corner();
    let turning = TURNING_STYLES.iter().filter(|it| it.1 <= greatest);
    let facing = FACING_STYLES.iter().filter(|it| it.1 >= 88.0);
    turning.chain(facing).map(|it| it.0).collect()
}

fn read_length(reader: &mut CodeReader<'_>, position: u8) -> Result<f64, IsoCodeError> {
    let symbol = reader.take(1);
    let known = LENGTHS.iter().find(|it| symbol.starts_with(it.0));
    known.map(|it| it.1).ok_or_else(|| {
        let place = (position, say::tool_part_length());
        reader.error(place, symbol, one_of(LENGTHS.iter().map(|it| it.0)))
    })
}

fn read_size(
    reader: &mut CodeReader<'_>,
    insert: &InsertCode,
    position: u8,
) -> Result<(), IsoCodeError> {
    let place = (position, say::tool_part_edge());
    let size = reader.two_digits(place.clone())?;
    if size != insert.size_symbol {
        let rule = say::tool_rule_same(format_args!("{:02}", insert.size_symbol));
        return Err(reader.error(place, &format!("{size:02}"), rule));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(insert: &str, holder: &str) -> Result<HolderCode, IsoCodeError> {
        HolderCode::parse(holder, &InsertCode::parse(insert).unwrap())
    }

    #[test]
    fn holders_give_entering_angle_hand_and_size() {
        let shank = |width, length| Holder::Shank { width, length };
        for (insert, holder, entering, tip, size) in [
            ("CNMG120408", "PCLNR 2020K12", 95.0, 3, shank(20.0, 60.0)),
            ("CNMG120408", "PCLNL2525M12", 95.0, 4, shank(25.0, 75.0)),
            ("DCMT11T304", "SDJCR 1616H11", 93.0, 3, shank(16.0, 48.0)),
            ("DCMT11T304", "SDNCN 1212F11", 62.5, 8, shank(12.0, 36.0)),
            ("VBMT160404", "SVVBN 2020K16", 72.5, 8, shank(20.0, 60.0)),
            ("TNMG160404", "PTGNR 2020K16", 90.0, 3, shank(20.0, 60.0)),
            ("SNMG120408", "PSDNN 2525M12", 45.0, 8, shank(25.0, 75.0)),
            ("SNMG120408", "PSBNR 2525M12", 75.0, 3, shank(25.0, 75.0)),
            ("WNMG080408", "MWLNR2525M08", 95.0, 3, shank(25.0, 75.0)),
            // A facing edge at 90° leaves the least angle to the second one.
            ("TNMG160404", "PTFNR2020K16", 118.0, 3, shank(20.0, 60.0)),
        ] {
            let code = parse(insert, holder).unwrap();
            assert_eq!(
                (code.entering, code.tip(), code.holder),
                (entering, tip, size),
                "{holder}"
            );
        }
        let bar = parse("CCMT 09T304", "S16R-SCLCR 09").unwrap();
        let holder = Holder::Bar {
            diameter: 16.0,
            length: 64.0,
        };
        assert_eq!((bar.tip(), bar.holder, bar.length_mm), (2, holder, 200.0));
        assert_eq!(parse("CCMT 09T304", "A12M SCLCL09").unwrap().tip(), 1);
    }

    #[test]
    fn a_fault_names_its_position() {
        for (holder, position, found) in [
            ("XCLNR 2020K12", 1, "X"),
            ("PDLNR 2020K12", 2, "D"),
            ("PCINR 2020K12", 3, "I"),
            ("PCKNR 2020K12", 3, "K"),
            ("PCLCR 2020K12", 4, "C"),
            ("PCLNX 2020K12", 5, "X"),
            ("PCLNR Q020K12", 6, "Q0"),
            ("PCLNR 20", 7, ""),
            ("PCLNR 2020Z12", 8, "Z"),
            ("PCLNR 2020K09", 9, "09"),
            ("S16R-PCLNR 09", 9, "09"),
            ("S1", 2, "1"),
        ] {
            let error = parse("CNMG 120408", holder).unwrap_err();
            assert_eq!(
                (error.position, error.found.as_str()),
                (position, found),
                "{holder}"
            );
        }
    }
}
