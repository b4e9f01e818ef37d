//! Parses blocks of G code with straight moves.

/// A parsed G code block: its motion, feed, dwell and effects.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ParsedBlock {
    /// Target of X, Y, Z in machine coordinates, mm; `None` if the block does not move.
    pub(super) target: Option<[f64; 3]>,
    /// Whether the move is a rapid.
    pub(super) rapid: bool,
    /// Feed of the move; used only if the move is a cut.
    pub(super) feed: CutFeed,
    /// Dwell time, s; `None` if the block does not dwell.
    pub(super) dwell: Option<f64>,
    /// Whether the block waits until all planned motion is made: spindle, coolant, program
    /// end, thread.
    pub(super) waits_for_empty_queue: bool,
    /// Whether the block is M02 or M30.
    pub(super) ends_program: bool,
    /// Distance along the path per spindle turn, mm, of a G33 block; `None` for any other
    /// block.
    pub(super) lead: Option<f64>,
}

/// How a block gives the feed of a cut: as speed or as duration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CutFeed {
    /// The move has this speed, mm/s.
    Speed(f64),
    /// The whole move takes this time, s.
    Duration(f64),
}

impl Default for CutFeed {
    fn default() -> Self {
        Self::Speed(0.0)
    }
}

/// The modal state of the G code parser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Modal {
    /// Motion code in force: 0, 1 or 33 for G00, G01 or G33; 80 for none.
    pub(super) motion: u8,
    /// Whether G91 (incremental distances) is in force.
    pub(super) incremental: bool,
    /// Whether G93 (inverse time feed) is in force.
    pub(super) inverse_time: bool,
    /// Whether G20 (inches) is in force.
    pub(super) inches: bool,
    /// F word in force with G94, mm/min.
    pub(super) feed: f64,
    /// Spindle speed S, r/min.
    pub(super) speed: f64,
    /// Spindle code in force: 3, 4 or 5 for M03 to M05.
    pub(super) spindle_code: u8,
    /// Whether M08 (coolant on) is in force.
    pub(super) coolant: bool,
    /// Plane in force: 17, 18 or 19 for G17 to G19.
    pub(super) plane: u8,
    /// Work coordinate system in force: 54 to 59 for G54 to G59.
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
    /// Returns the answer to `$G`, without its brackets.
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

    /// Parses a block in capitals without blanks and comments, and updates the words in force.
    /// `offset` is the work offset of G54, mm. Returns the error number of the firmware for a
    /// block that it rejects.
    pub(super) fn parse_block(
        &mut self,
        text: &str,
        spindle_sync: bool,
        offset: [f64; 3],
    ) -> Result<ParsedBlock, u8> {
        let (mut next, mut block) = (*self, ParsedBlock::default());
        let words = GrblWords::read(text, spindle_sync, &mut next, &mut block)?;
        let scale = if next.inches { 25.4 } else { 1.0 };
        if let (Some(feed), false) = (words.feed, next.inverse_time) {
            next.feed = feed * scale;
        }
        if words.dwells {
            block.dwell = Some(words.dwell_s.ok_or(28_u8)?);
        }
        if words.lead.is_some() && next.motion != 33 {
            return Err(36);
        }
        // A motion code needs F in inverse time mode even without a target.
        if (words.has_motion_code || words.has_axis_word())
            && next.inverse_time
            && next.motion == 1
            && words.feed.is_none()
        {
            return Err(22);
        }
        if words.has_axis_word() {
            next.move_axes(&words, scale, offset, &mut block)?;
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

    /// Executes a G code of a block. Returns the error number of the firmware if it rejects
    /// the code.
    fn execute_g_code(
        &mut self,
        value: f64,
        spindle_sync: bool,
        words: &mut GrblWords,
    ) -> Result<(), u8> {
        match (value * 10.0).round() as i32 {
            motion @ (0 | 10 | 330) if motion < 330 || spindle_sync => {
                self.motion = (motion / 10) as u8;
                words.has_motion_code = true;
            }
            40 => words.dwells = true,
            170 => self.plane = 17,
            180 => self.plane = 18,
            190 => self.plane = 19,
            200 => self.inches = true,
            210 => self.inches = false,
            400 | 490 | 610 | 911 => {}
            530 => words.in_machine_coordinates = true,
            540 | 550 | 560 | 570 | 580 | 590 => self.system = value as u8,
            800 => self.motion = 80,
            900 => self.incremental = false,
            910 => self.incremental = true,
            930 => self.inverse_time = true,
            940 => self.inverse_time = false,
            _ => return Err(20),
        }
        Ok(())
    }

    /// Executes an M code of a block. Returns the error number of the firmware if it rejects
    /// the code.
    fn execute_m_code(&mut self, value: f64, block: &mut ParsedBlock) -> Result<(), u8> {
        match value as i32 {
            0 | 1 => {}
            2 | 30 => block.ends_program = true,
            3..=5 => self.spindle_code = value as u8,
            7..=9 => self.coolant = value < 9.0,
            _ => return Err(20),
        }
        block.waits_for_empty_queue = true;
        Ok(())
    }

    /// Sets target and feed of a block with axis words, and moves the position in force there.
    /// `scale` is the number of mm per unit of the words. Returns the error number of the
    /// firmware if it rejects the words.
    fn move_axes(
        &mut self,
        words: &GrblWords,
        scale: f64,
        offset: [f64; 3],
        block: &mut ParsedBlock,
    ) -> Result<(), u8> {
        if self.motion == 80 {
            return Err(31);
        }
        if words.in_machine_coordinates && self.motion > 1 {
            return Err(30);
        }
        let mut target = self.position;
        for axis in 0..3 {
            if let Some(value) = words.axes[axis] {
                let distance = value * scale;
                target[axis] = if words.in_machine_coordinates {
                    distance
                } else if self.incremental {
                    target[axis] + distance
                } else if self.system == 54 {
                    distance + offset[axis]
                } else {
                    distance
                };
            }
        }
        block.rapid = self.motion == 0;
        if self.motion == 33 {
            // A thread waits for the end of all earlier motion.
            block.waits_for_empty_queue = true;
            block.lead = Some(words.lead.unwrap_or(0.0) * scale);
            if block.lead == Some(0.0) {
                return Err(39);
            }
        }
        block.feed = match (self.inverse_time, words.feed) {
            _ if self.motion == 33 => CutFeed::default(),
            (true, Some(minutes)) if minutes > 0.0 => CutFeed::Duration(60.0 / minutes),
            (false, _) if self.feed > 0.0 => CutFeed::Speed(self.feed / 60.0),
            _ if block.rapid => CutFeed::Speed(0.0),
            _ => return Err(22),
        };
        block.target = Some(target);
        self.position = target;
        Ok(())
    }
}

/// The words of a block, collected until its last word and then executed together.
#[derive(Default)]
struct GrblWords {
    axes: [Option<f64>; 3],
    /// Number of the F word as written; `None` without F.
    feed: Option<f64>,
    /// Dwell time by the P word, s; `None` without P.
    dwell_s: Option<f64>,
    /// Lead of a thread by the K word as written; `None` without K.
    lead: Option<f64>,
    /// Whether the block has G04 (dwell).
    dwells: bool,
    /// Whether the block has G53 (machine coordinates).
    in_machine_coordinates: bool,
    has_motion_code: bool,
}

impl GrblWords {
    /// Reads the words of a block. Modal codes and M codes act at once on `next` and `block`.
    /// Returns the error number of the firmware if it rejects a word.
    fn read(
        text: &str,
        spindle_sync: bool,
        next: &mut Modal,
        block: &mut ParsedBlock,
    ) -> Result<Self, u8> {
        let mut words = Self::default();
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
                'G' => next.execute_g_code(value, spindle_sync, &mut words)?,
                'M' => next.execute_m_code(value, block)?,
                'X' => words.axes[0] = Some(value),
                'Y' => words.axes[1] = Some(value),
                'Z' => words.axes[2] = Some(value),
                'F' | 'S' if value < 0.0 => return Err(4),
                'F' => words.feed = Some(value),
                'S' => {
                    block.waits_for_empty_queue |= next.speed.to_bits() != value.to_bits();
                    next.speed = value;
                }
                'P' => words.dwell_s = Some(value),
                'K' => words.lead = Some(value),
                'N' | 'T' => {}
                _ => return Err(36),
            }
        }
        Ok(words)
    }

    fn has_axis_word(&self) -> bool {
        self.axes.iter().any(Option::is_some)
    }
}

/// Splits a number from the start of a text. Returns the number and the rest, `None` if no
/// number is there.
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
