//! Tool offsets 000–032 (manual I-3.5, III-2.1.6).

use gsk_messages::say;
use serde::{Deserialize, Serialize};

use super::ControlParameters;
use crate::alarm::{Alarm, number};
use crate::units::Point;

/// Number of rows on the offset page, 000 included.
pub const OFFSET_ROWS: usize = 33;

/// Greatest absolute value of X, Z or R, mm.
const LIMIT_MM: f64 = 9999.999;

/// One row of the offset page: X, Z, nose radius and tip number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ToolOffset {
    /// Offset in X, mm: a diameter, or a radius with 004.4 ORC = 1.
    pub x: f64,
    /// Z value of the tool offset, mm.
    pub z: f64,
    /// Nose radius of the tool, mm.
    pub r: f64,
    /// Number of the direction of the imaginary tool tip, 0 to 9.
    pub t: u8,
}

/// The table of tool offsets. Row 000 is zero, or the shift of the work coordinates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "Vec<ToolOffset>", try_from = "Vec<ToolOffset>")]
pub struct Offsets {
    rows: Vec<ToolOffset>,
}

impl Default for Offsets {
    fn default() -> Self {
        Self {
            rows: vec![ToolOffset::default(); OFFSET_ROWS],
        }
    }
}

impl Offsets {
    /// The row `number`; zero for numbers above 032.
    pub fn get(&self, number: u8) -> ToolOffset {
        self.rows
            .get(usize::from(number))
            .copied()
            .unwrap_or_default()
    }

    /// Writes the row `number`. Lengths are rounded to 0.001 mm.
    ///
    /// # Errors
    /// 030 for 000 and numbers above 032, 043 for a value out of range.
    pub fn set(&mut self, number: u8, offset: ToolOffset) -> Result<(), Alarm> {
        let row = match self.rows.get_mut(usize::from(number)) {
            Some(row) if number > 0 => row,
            _ => {
                let detail = say::offset_number_out_of_range(number);
                return Err(Alarm::new(number::BAD_OFFSET).with_detail(detail));
            }
        };
        *row = check_offset(offset)?;
        Ok(())
    }

    /// Writes row 000, the shift of the work coordinates (012.6 WSFT).
    ///
    /// # Errors
    /// 043 for a value out of range.
    pub(crate) fn set_work_shift(&mut self, shift: ToolOffset) -> Result<(), Alarm> {
        if let Some(row) = self.rows.first_mut() {
            *row = check_offset(shift)?;
        }
        Ok(())
    }

    /// The displacement of the slide (X as a radius) by the offset `number`, mm. With 012.6
    /// WSFT = 1 it includes the work shift.
    pub fn slide_displacement(&self, number: u8, parameters: &ControlParameters) -> Point {
        let own = self.row_displacement(number, parameters);
        if parameters.has_work_shift() && number > 0 {
            own + self.row_displacement(0, parameters)
        } else if parameters.has_work_shift() || number > 0 {
            own
        } else {
            Point::default()
        }
    }

    fn row_displacement(&self, number: u8, parameters: &ControlParameters) -> Point {
        let ToolOffset { x, z, .. } = self.get(number);
        Point::new(
            if parameters.is_offset_radius() {
                x
            } else {
                x / 2.0
            },
            z,
        )
    }

    /// Sets all nose radii to 0: nose radius compensation then has no effect.
    pub fn clear_noses(&mut self) {
        for row in &mut self.rows {
            row.r = 0.0;
        }
    }

    /// Returns all rows with their numbers, from 000.
    pub fn iter(&self) -> impl Iterator<Item = (u8, &ToolOffset)> {
        (0..).zip(&self.rows)
    }
}

fn check_offset(offset: ToolOffset) -> Result<ToolOffset, Alarm> {
    let length = |name: &str, value: f64| {
        let value = (value * 1000.0).round() / 1000.0;
        // Written as a negation so that NaN is refused.
        if !(-LIMIT_MM..=LIMIT_MM).contains(&value) {
            let detail = say::offset_out_of_range(name, value, LIMIT_MM);
            return Err(Alarm::new(number::OUT_OF_RANGE).with_detail(detail));
        }
        Ok(value + 0.0)
    };
    if offset.t > 9 {
        return Err(
            Alarm::new(number::OUT_OF_RANGE).with_detail(say::offset_nose_out_of_range(offset.t))
        );
    }
    Ok(ToolOffset {
        x: length("X", offset.x)?,
        z: length("Z", offset.z)?,
        r: length("R", offset.r)?,
        t: offset.t,
    })
}

impl From<Offsets> for Vec<ToolOffset> {
    fn from(offsets: Offsets) -> Self {
        offsets.rows
    }
}

impl TryFrom<Vec<ToolOffset>> for Offsets {
    type Error = Alarm;

    fn try_from(rows: Vec<ToolOffset>) -> Result<Self, Alarm> {
        let mut offsets = Self::default();
        for (number, row) in (0..=u8::MAX).zip(&rows) {
            match number {
                0 => offsets.set_work_shift(*row)?,
                _ => offsets.set(number, *row)?,
            }
        }
        Ok(offsets)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROW: ToolOffset = ToolOffset {
        x: 0.04,
        z: -1.2345,
        r: 0.8,
        t: 3,
    };

    #[test]
    fn rows_round_to_increments_and_keep_their_limits() {
        let mut offsets = Offsets::default();
        offsets.set(32, ROW).unwrap();
        assert_eq!(offsets.get(32).z, -1.235);
        assert_eq!(offsets.set(0, ROW).unwrap_err().number, 30);
        assert_eq!(offsets.set(33, ROW).unwrap_err().number, 30);
        for bad in [1e4, f64::NAN, f64::INFINITY, -9999.9996] {
            assert_eq!(
                offsets
                    .set(1, ToolOffset { x: bad, ..ROW })
                    .unwrap_err()
                    .number,
                43
            );
        }
        assert_eq!(
            offsets
                .set(1, ToolOffset { t: 10, ..ROW })
                .unwrap_err()
                .number,
            43
        );
        assert_eq!(offsets.get(1), ToolOffset::default());
    }

    #[test]
    fn the_vector_is_a_radius() {
        let mut offsets = Offsets::default();
        let mut parameters = ControlParameters::default();
        offsets.set(1, ROW).unwrap();
        assert_eq!(
            offsets.slide_displacement(1, &parameters),
            Point::new(0.02, -1.235)
        );
        parameters.set_bit(4, 4, true).unwrap();
        assert_eq!(
            offsets.slide_displacement(1, &parameters),
            Point::new(0.04, -1.235)
        );
        assert_eq!(offsets.slide_displacement(0, &parameters), Point::default());
    }

    #[test]
    fn stored_rows_are_checked() {
        let mut offsets = Offsets::default();
        offsets.set(7, ROW).unwrap();
        let text = ron::to_string(&offsets).unwrap();
        assert_eq!(ron::from_str::<Offsets>(&text).unwrap(), offsets);
        assert!(ron::from_str::<Offsets>("[(x:10000.0,z:0.0,r:0.0,t:0)]").is_err());
    }

    #[test]
    fn the_work_shift_is_part_of_every_offset_with_012_6() {
        let mut offsets = Offsets::default();
        let row = |x, z| ToolOffset { x, z, ..ROW };
        offsets.set(1, row(2.0, -1.5)).unwrap();
        offsets.set_work_shift(row(4.0, 1.0)).unwrap();
        let mut parameters = ControlParameters::default();
        assert_eq!(offsets.slide_displacement(0, &parameters), Point::default());
        assert_eq!(
            offsets.slide_displacement(1, &parameters),
            Point::new(1.0, -1.5)
        );
        parameters.set_bit(12, 6, true).unwrap();
        assert_eq!(
            offsets.slide_displacement(0, &parameters),
            Point::new(2.0, 1.0)
        );
        assert_eq!(
            offsets.slide_displacement(1, &parameters),
            Point::new(3.0, -0.5)
        );
    }
}
