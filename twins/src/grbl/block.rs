//! A block of G code as the board reads it: straight moves only.

/// What a block asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Asked {
    /// Where to, mm, machine axes X, Y, Z; None where the block does not move.
    pub(super) target: Option<[f64; 3]>,
    /// As a rapid.
    pub(super) rapid: bool,
    /// Speed of a cut, mm/s, or seconds for the whole move.
    pub(super) pace: Pace,
    /// Dwell, s.
    pub(super) dwell: Option<f64>,
    /// Waits until the queue is empty (spindle, coolant, program end).
    pub(super) drains: bool,
    /// M02 or M30.
    pub(super) ends: bool,
    /// G33: way along the path a turn of the spindle, mm.
    pub(super) lead: Option<f64>,
}

/// How fast a cut is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pace {
    /// mm/s.
    Speed(f64),
    /// The whole move in so many seconds.
    Time(f64),
}

impl Default for Pace {
    fn default() -> Self {
        Self::Speed(0.0)
    }
}

/// What stays in force from block to block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Modal {
    /// 0, 1 or 33; 80 for none.
    pub(super) motion: u8,
    /// G91.
    pub(super) incremental: bool,
    /// G93.
    pub(super) inverse_time: bool,
    /// G20.
    pub(super) inches: bool,
    /// F of G94, mm/min.
    pub(super) feed: f64,
    /// S.
    pub(super) speed: f64,
    /// 3, 4, 5.
    pub(super) spindle: u8,
    /// M08.
    pub(super) coolant: bool,
    /// 17, 18, 19.
    pub(super) plane: u8,
    /// G54 … G59.
    pub(super) system: u8,
    /// Where the last block ends, mm.
    pub(super) position: [f64; 3],
}

impl Default for Modal {
    fn default() -> Self {
        Self {
            motion: 0,
            incremental: false,
            inverse_time: false,
            inches: false,
            feed: 0.0,
            speed: 0.0,
            spindle: 5,
            coolant: false,
            plane: 17,
            system: 54,
            position: [0.0; 3],
        }
    }
}

impl Modal {
    /// As `$G` shows it, without brackets.
    pub(super) fn text(&self) -> String {
        format!(
            "GC:G{} G{} G{} G{} G{} G{} M{} M{} T0 F{:.0} S{:.0}",
            self.motion,
            self.system,
            self.plane,
            if self.inches { 20 } else { 21 },
            if self.incremental { 91 } else { 90 },
            if self.inverse_time { 93 } else { 94 },
            self.spindle,
            if self.coolant { 8 } else { 9 },
            if self.inverse_time { 0.0 } else { self.feed },
            self.speed,
        )
    }

    /// Reads a block (blanks and comments are gone, letters are capital) and
    /// takes its modal words over; the number of the error otherwise. Places count from
    /// the offset of G54, mm, while that is in force.
    pub(super) fn read(
        &mut self,
        text: &str,
        spindle_sync: bool,
        offset: [f64; 3],
    ) -> Result<Asked, u8> {
        let mut next = *self;
        let mut asked = Asked::default();
        let mut axes: [Option<f64>; 3] = [None; 3];
        let (mut feed, mut wait, mut dwells, mut machine) = (None, None, false, false);
        let (mut lead, mut told) = (None, false);
        let mut rest = text;
        let mut seen = 0_u32;
        while let Some(letter) = rest.chars().next() {
            if !letter.is_ascii_uppercase() {
                return Err(1);
            }
            let (value, behind) = number(&rest[1..]).ok_or(2_u8)?;
            rest = behind;
            // One word of a letter in a block, G and M excepted.
            let bit = 1_u32 << (letter as u8 - b'A');
            if seen & bit != 0 && !matches!(letter, 'G' | 'M') {
                return Err(25);
            }
            seen |= bit;
            match letter {
                'G' => match (value * 10.0).round() as i32 {
                    motion @ (0 | 10 | 330) if motion < 330 || spindle_sync => {
                        next.motion = (motion / 10) as u8;
                        told = true;
                    }
                    40 => dwells = true,
                    170 => next.plane = 17,
                    180 => next.plane = 18,
                    190 => next.plane = 19,
                    200 => next.inches = true,
                    210 => next.inches = false,
                    400 | 490 | 610 | 911 => {}
                    530 => machine = true,
                    540 | 550 | 560 | 570 | 580 | 590 => next.system = value as u8,
                    800 => next.motion = 80,
                    900 => next.incremental = false,
                    910 => next.incremental = true,
                    930 => next.inverse_time = true,
                    940 => next.inverse_time = false,
                    _ => return Err(20),
                },
                'M' => match value as i32 {
                    0 | 1 => asked.drains = true,
                    2 | 30 => {
                        asked.drains = true;
                        asked.ends = true;
                    }
                    3..=5 => {
                        next.spindle = value as u8;
                        asked.drains = true;
                    }
                    7..=9 => {
                        next.coolant = value < 9.0;
                        asked.drains = true;
                    }
                    _ => return Err(20),
                },
                'X' => axes[0] = Some(value),
                'Y' => axes[1] = Some(value),
                'Z' => axes[2] = Some(value),
                'F' | 'S' if value < 0.0 => return Err(4),
                'F' => feed = Some(value),
                'S' => {
                    asked.drains |= next.speed.to_bits() != value.to_bits();
                    next.speed = value;
                }
                'P' => wait = Some(value),
                'K' => lead = Some(value),
                'N' | 'T' => {}
                _ => return Err(36),
            }
        }
        let scale = if next.inches { 25.4 } else { 1.0 };
        if let (Some(feed), false) = (feed, next.inverse_time) {
            next.feed = feed * scale;
        }
        if dwells {
            asked.dwell = Some(wait.ok_or(28_u8)?);
        }
        let moves = axes.iter().any(Option::is_some);
        if lead.is_some() && next.motion != 33 {
            return Err(36);
        }
        // A code of motion counts as motion here, with or without a way.
        if (told || moves) && next.inverse_time && next.motion == 1 && feed.is_none() {
            return Err(22);
        }
        if moves {
            if next.motion == 80 {
                return Err(31);
            }
            if machine && next.motion > 1 {
                return Err(30);
            }
            let mut target = next.position;
            for axis in 0..3 {
                if let Some(value) = axes[axis] {
                    let way = value * scale;
                    target[axis] = if machine {
                        way
                    } else if next.incremental {
                        target[axis] + way
                    } else if next.system == 54 {
                        way + offset[axis]
                    } else {
                        way
                    };
                }
            }
            asked.rapid = next.motion == 0;
            if next.motion == 33 {
                // A thread waits for the end of all motion before it.
                asked.drains = true;
                asked.lead = Some(lead.unwrap_or(0.0) * scale);
                if asked.lead == Some(0.0) {
                    return Err(39);
                }
            }
            asked.pace = match (next.inverse_time, feed) {
                _ if next.motion == 33 => Pace::default(),
                (true, Some(minutes)) if minutes > 0.0 => Pace::Time(60.0 / minutes),
                (false, _) if next.feed > 0.0 => Pace::Speed(next.feed / 60.0),
                _ if asked.rapid => Pace::Speed(0.0),
                _ => return Err(22),
            };
            asked.target = Some(target);
            next.position = target;
        }
        if asked.ends {
            let Modal {
                position, inches, ..
            } = next;
            next = Self {
                motion: 1,
                position,
                inches,
                ..Self::default()
            };
        }
        *self = next;
        Ok(asked)
    }
}

/// A number at the start of the text, and what stands behind it.
fn number(text: &str) -> Option<(f64, &str)> {
    let end = text
        .find(|character: char| !matches!(character, '0'..='9' | '.' | '-' | '+'))
        .unwrap_or(text.len());
    Some((text[..end].parse().ok()?, &text[end..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: [f64; 3] = [0.0; 3];

    #[test]
    fn inverse_time_needs_its_word_in_every_block() {
        let mut modal = Modal::default();
        let asked = modal.read("G93G1X1.5Z-2F6000", false, HERE).unwrap();
        assert_eq!(asked.target, Some([1.5, 0.0, -2.0]));
        assert_eq!(asked.pace, Pace::Time(0.01));
        assert_eq!(modal.read("X2", false, HERE), Err(22));
        assert_eq!(
            modal.position,
            [1.5, 0.0, -2.0],
            "a refused block changes nothing"
        );
    }

    #[test]
    fn machine_coordinates_know_no_offset() {
        let mut modal = Modal::default();
        let mut target = |text: &str| {
            let asked = modal.read(text, true, [10.0, 0.0, -30.0]);
            asked.map(|asked| asked.target)
        };
        assert_eq!(target("G1X1Z2F60"), Ok(Some([11.0, 0.0, -28.0])));
        assert_eq!(target("G53X1F60"), Ok(Some([1.0, 0.0, -28.0])));
        assert_eq!(target("G55Z3"), Ok(Some([1.0, 0.0, 3.0])));
        assert_eq!(target("G53G33Z-1K1"), Err(30));
    }

    #[test]
    fn errors_have_the_numbers_of_the_firmware() {
        let mut modal = Modal::default();
        assert_eq!(modal.read("1X", false, HERE), Err(1));
        assert_eq!(modal.read("GX", false, HERE), Err(2));
        assert_eq!(modal.read("G2X1", false, HERE), Err(20));
        assert_eq!(modal.read("G1X1", false, HERE), Err(22));
        assert_eq!(modal.read("G4", false, HERE), Err(28));
        assert_eq!(modal.read("G33Z-1K1", false, HERE), Err(20));
        assert_eq!(modal.read("G33Z-1", true, HERE), Err(39));
        assert_eq!(
            modal.read("G1G93", false, HERE),
            Err(22),
            "no way, but a motion"
        );
        assert_eq!(
            modal
                .read("G1G93F60", false, HERE)
                .map(|asked| asked.target),
            Ok(None)
        );
        assert_eq!(
            modal.read("G94X1F100X2", false, HERE),
            Err(25),
            "two lines that ran together"
        );
    }
}
