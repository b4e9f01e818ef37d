//! Parses blocks of G code with straight moves.

/// The contents of a parsed block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ParsedBlock {
    /// Target of X, Y, Z in machine coordinates, mm; `None` without a move.
    pub(super) target: Option<[f64; 3]>,
    /// Whether the move is a rapid.
    pub(super) rapid: bool,
    /// Feed of a cut.
    pub(super) feed: CutFeed,
    /// Dwell time, s.
    pub(super) dwell: Option<f64>,
    /// Whether the block waits until the queue is empty: spindle, coolant, program end,
    /// thread.
    pub(super) waits_for_empty_queue: bool,
    /// Whether the block is M02 or M30.
    pub(super) ends_program: bool,
    /// G33: distance along the path per spindle turn, mm.
    pub(super) lead: Option<f64>,
}

/// The feed of a cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CutFeed {
    /// Speed, mm/s.
    Speed(f64),
    /// Duration of the whole move, s.
    Duration(f64),
}

impl Default for CutFeed {
    fn default() -> Self {
        Self::Speed(0.0)
    }
}

/// The modal state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Modal {
    /// Motion mode: 0, 1, 33, or 80 for none.
    pub(super) motion: u8,
    /// G91: incremental distances.
    pub(super) incremental: bool,
    /// G93: inverse time feed.
    pub(super) inverse_time: bool,
    /// G20: inches.
    pub(super) inches: bool,
    /// Feed of G94, mm/min.
    pub(super) feed: f64,
    /// Spindle speed S, r/min.
    pub(super) speed: f64,
    /// Spindle code: 3, 4 or 5.
    pub(super) spindle_code: u8,
    /// M08: coolant on.
    pub(super) coolant: bool,
    /// Plane: 17, 18 or 19.
    pub(super) plane: u8,
    /// Work coordinate system, 54 to 59.
    pub(super) system: u8,
    /// End of the last block in machine coordinates, mm.
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
            spindle_code: 5,
            coolant: false,
            plane: 17,
            system: 54,
            position: [0.0; 3],
        }
    }
}

impl Modal {
    /// Returns the text of `$G`, without brackets.
    pub(super) fn gc_report(&self) -> String {
        format!(
            "GC:G{} G{} G{} G{} G{} G{} M{} M{} T0 F{:.0} S{:.0}",
            self.motion,
            self.system,
            self.plane,
            if self.inches { 20 } else { 21 },
            if self.incremental { 91 } else { 90 },
            if self.inverse_time { 93 } else { 94 },
            self.spindle_code,
            if self.coolant { 8 } else { 9 },
            if self.inverse_time { 0.0 } else { self.feed },
            self.speed,
        )
    }

    /// Parses a block in capitals without blanks and comments and updates the modal state.
    /// Returns the error number of the firmware for a wrong block. `offset` is the work
    /// offset of G54, mm.
    pub(super) fn parse_block(
        &mut self,
        text: &str,
        spindle_sync: bool,
        offset: [f64; 3],
    ) -> Result<ParsedBlock, u8> {
        let mut next = *self;
        let mut block = ParsedBlock::default();
        let mut axes: [Option<f64>; 3] = [None; 3];
        let (mut feed, mut dwell_s, mut dwells, mut machine) = (None, None, false, false);
        let (mut lead, mut has_motion_code) = (None, false);
        let mut rest = text;
        let mut seen = 0_u32;
        while let Some(letter) = rest.chars().next() {
            if !letter.is_ascii_uppercase() {
                return Err(1);
            }
            let (value, rest_after) = split_number(&rest[1..]).ok_or(2_u8)?;
            rest = rest_after;
            // A block has one word per letter, except G and M.
            let bit = 1_u32 << (letter as u8 - b'A');
            if seen & bit != 0 && !matches!(letter, 'G' | 'M') {
                return Err(25);
            }
            seen |= bit;
            match letter {
                'G' => match (value * 10.0).round() as i32 {
                    motion @ (0 | 10 | 330) if motion < 330 || spindle_sync => {
                        next.motion = (motion / 10) as u8;
                        has_motion_code = true;
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
                    0 | 1 => block.waits_for_empty_queue = true,
                    2 | 30 => {
                        block.waits_for_empty_queue = true;
                        block.ends_program = true;
                    }
                    3..=5 => {
                        next.spindle_code = value as u8;
                        block.waits_for_empty_queue = true;
                    }
                    7..=9 => {
                        next.coolant = value < 9.0;
                        block.waits_for_empty_queue = true;
                    }
                    _ => return Err(20),
                },
                'X' => axes[0] = Some(value),
                'Y' => axes[1] = Some(value),
                'Z' => axes[2] = Some(value),
                'F' | 'S' if value < 0.0 => return Err(4),
                'F' => feed = Some(value),
                'S' => {
                    block.waits_for_empty_queue |= next.speed.to_bits() != value.to_bits();
                    next.speed = value;
                }
                'P' => dwell_s = Some(value),
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
            block.dwell = Some(dwell_s.ok_or(28_u8)?);
        }
        let has_axis_word = axes.iter().any(Option::is_some);
        if lead.is_some() && next.motion != 33 {
            return Err(36);
        }
        // A motion code needs F in inverse time mode even without a target.
        if (has_motion_code || has_axis_word)
            && next.inverse_time
            && next.motion == 1
            && feed.is_none()
        {
            return Err(22);
        }
        if has_axis_word {
            if next.motion == 80 {
                return Err(31);
            }
            if machine && next.motion > 1 {
                return Err(30);
            }
            let mut target = next.position;
            for axis in 0..3 {
                if let Some(value) = axes[axis] {
                    let distance = value * scale;
                    target[axis] = if machine {
                        distance
                    } else if next.incremental {
                        target[axis] + distance
                    } else if next.system == 54 {
                        distance + offset[axis]
                    } else {
                        distance
                    };
                }
            }
            block.rapid = next.motion == 0;
            if next.motion == 33 {
                // A thread waits for the end of all earlier motion.
                block.waits_for_empty_queue = true;
                block.lead = Some(lead.unwrap_or(0.0) * scale);
                if block.lead == Some(0.0) {
                    return Err(39);
                }
            }
            block.feed = match (next.inverse_time, feed) {
                _ if next.motion == 33 => CutFeed::default(),
                (true, Some(minutes)) if minutes > 0.0 => CutFeed::Duration(60.0 / minutes),
                (false, _) if next.feed > 0.0 => CutFeed::Speed(next.feed / 60.0),
                _ if block.rapid => CutFeed::Speed(0.0),
                _ => return Err(22),
            };
            block.target = Some(target);
            next.position = target;
        }
        if block.ends_program {
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
        Ok(block)
    }
}

/// Splits a number from the start of a text; returns the number and the rest.
fn split_number(text: &str) -> Option<(f64, &str)> {
    let end = text
        .find(|character: char| !matches!(character, '0'..='9' | '.' | '-' | '+'))
        .unwrap_or(text.len());
    Some((text[..end].parse().ok()?, &text[end..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NO_OFFSET: [f64; 3] = [0.0; 3];

    #[test]
    fn inverse_time_needs_its_word_in_every_block() {
        let mut modal = Modal::default();
        let block = modal
            .parse_block("G93G1X1.5Z-2F6000", false, NO_OFFSET)
            .unwrap();
        assert_eq!(block.target, Some([1.5, 0.0, -2.0]));
        assert_eq!(block.feed, CutFeed::Duration(0.01));
        assert_eq!(modal.parse_block("X2", false, NO_OFFSET), Err(22));
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
            let block = modal.parse_block(text, true, [10.0, 0.0, -30.0]);
            block.map(|block| block.target)
        };
        assert_eq!(target("G1X1Z2F60"), Ok(Some([11.0, 0.0, -28.0])));
        assert_eq!(target("G53X1F60"), Ok(Some([1.0, 0.0, -28.0])));
        assert_eq!(target("G55Z3"), Ok(Some([1.0, 0.0, 3.0])));
        assert_eq!(target("G53G33Z-1K1"), Err(30));
    }

    #[test]
    fn errors_have_the_numbers_of_the_firmware() {
        let mut modal = Modal::default();
        assert_eq!(modal.parse_block("1X", false, NO_OFFSET), Err(1));
        assert_eq!(modal.parse_block("GX", false, NO_OFFSET), Err(2));
        assert_eq!(modal.parse_block("G2X1", false, NO_OFFSET), Err(20));
        assert_eq!(modal.parse_block("G1X1", false, NO_OFFSET), Err(22));
        assert_eq!(modal.parse_block("G4", false, NO_OFFSET), Err(28));
        assert_eq!(modal.parse_block("G33Z-1K1", false, NO_OFFSET), Err(20));
        assert_eq!(modal.parse_block("G33Z-1", true, NO_OFFSET), Err(39));
        assert_eq!(
            modal.parse_block("G1G93", false, NO_OFFSET),
            Err(22),
            "motion code without a target"
        );
        assert_eq!(
            modal
                .parse_block("G1G93F60", false, NO_OFFSET)
                .map(|block| block.target),
            Ok(None)
        );
        assert_eq!(
            modal.parse_block("G94X1F100X2", false, NO_OFFSET),
            Err(25),
            "two lines that ran together"
        );
    }
}
