//! G76 of every dialect becomes the two-block G76 of this control.

use gsk_messages::say;

use crate::block::{ForeignBlock, ForeignWord};
use crate::dialect::CodeSet;
use crate::motion::length_word;
use crate::number::{Number, UNIT, divide_rounded, write_number};
use crate::porter::{Porter, Refusal};

/// The data of a G76 thread of several passes. Lengths are in millionths of a millimetre.
#[derive(Clone, Copy, Debug, Default)]
struct ThreadData {
    /// Number of finishing passes.
    finishing: i64,
    /// Length of the run-out, in tenths of the lead.
    run_out: i64,
    /// Angle between the thread flanks, degrees.
    angle: i64,
    /// Least depth of cut of a pass, millionths of a millimetre.
    least: i64,
    /// Difference of the radius between start and end of the thread, millionths of a millimetre.
    taper: i64,
    /// Height of the thread as a radius, millionths of a millimetre.
    height: i64,
    /// Depth of the first pass as a radius, millionths of a millimetre.
    first: i64,
    lead: i64,
}

impl ThreadData {
    fn first_line(&self) -> String {
        format!(
            "G76 P{:02}{:02}{:02} Q{} R0",
            self.finishing.clamp(1, 99),
            self.run_out.clamp(0, 99),
            self.angle.clamp(0, 99),
            divide_rounded(self.least, 1_000)
        )
    }

    /// Returns the words for the second G76 block, apart from the end point.
    fn words(&self) -> String {
        let taper = match self.taper {
            0 => String::new(),
            taper => format!("{} ", length_word(b'R', taper)),
        };
        format!(
            "{taper}P{} Q{} F{}",
            divide_rounded(self.height, 1_000),
            divide_rounded(self.first, 1_000),
            write_number(self.lead, 5)
        )
    }
}

impl Porter<'_> {
    /// Converts a G76 block, in the form of any dialect.
    pub fn convert_thread_cycle(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        match self.state.set {
            CodeSet::Mach3 => self.convert_mach_thread(block),
            CodeSet::LinuxCnc => self.convert_linuxcnc_thread(block),
            CodeSet::FanucA | CodeSet::FanucB | CodeSet::Haas => {
                if block.has(b'K') {
                    return self.convert_one_block_thread(block);
                }
                self.convert_two_block_thread(block);
                Ok(())
            }
        }
    }

    /// Converts the units of a G76 in the two-block form.
    fn convert_two_block_thread(&mut self, block: &mut ForeignBlock) {
        let is_data = !block.has_any(b"XUZW");
        let whole = |letter: u8, thousandths: i64| format!("{}{thousandths}", char::from(letter));
        if let Some(number) = block.number(b'Q') {
            block.replace(b'Q', &whole(b'Q', self.thousandths(number, 1)));
        }
        if is_data {
            if let Some(number) = block.number(b'R') {
                block.replace(b'R', &whole(b'R', self.thousandths(number, 1)));
            }
            return;
        }
        if let Some(number) = block.number(b'P') {
            block.replace(b'P', &whole(b'P', self.thousandths(number, 1)));
        }
        self.convert_length(block, b'R');
        self.convert_lead(block);
        self.convert_axis(block, 0, false);
        self.convert_axis(block, 1, false);
    }

    /// Converts the one-block G76 X Z I K D F A P of Fanuc 10T and of Haas.
    fn convert_one_block_thread(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let length = |letter| block.number(letter).map(|it| self.state.length(it));
        let missing = |letter: &str| Refusal::new(letter, say::ported_note_thread_cycle());
        if block.number(b'Q').is_some_and(|it| it.micro != 0) {
            return Err(Refusal::new("Q", say::ported_note_start_angle()));
        }
        let depth = block.number(b'D').ok_or_else(|| missing("D"))?;
        let lead = block.number(b'E').or(block.number(b'F'));
        let has_run_out = (self.state.machine.run_out).unwrap_or(self.state.set == CodeSet::Haas);
        let data = ThreadData {
            finishing: 1,
            run_out: if has_run_out { 10 } else { 0 },
            angle: block.number(b'A').map_or(0, nearest_whole),
            least: 0,
            taper: length(b'I').unwrap_or(0),
            height: length(b'K').ok_or_else(|| missing("K"))?,
            first: self.state.cycle_length(depth),
            lead: self.state.lead(lead.ok_or_else(|| missing("F"))?),
        };
        let method = block.number(b'P').map_or(1, nearest_whole);
        if method != 1 {
            self.note(block.line, format!("P{method}"), say::ported_note_infeed());
        }
        self.note(block.line, "G76", say::ported_note_thread_cycle());
        self.write_thread(block, data);
        Ok(())
    }

    /// Converts G76 P Z I J K Q H E L of LinuxCNC: the thread lies beside the drive line.
    fn convert_linuxcnc_thread(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let refuse = |letter: &str| Refusal::new(letter, say::ported_note_drive_line());
        let across = |letter| block.number(letter).map(|it| self.state.diameter(it));
        let drive = self.position()[0].ok_or_else(|| refuse("X"))?;
        let peak = across(b'I').ok_or_else(|| refuse("I"))?;
        let height = across(b'K').ok_or_else(|| refuse("K"))?.abs();
        let first = across(b'J').ok_or_else(|| refuse("J"))?.abs();
        let lead = block.number(b'P').ok_or_else(|| refuse("P"))?;
        let lead = self.state.to_metric(lead.micro);
        let end = drive + peak + if peak < 0 { -height } else { height };
        let tapered = block.number(b'L').map_or(0, nearest_whole);
        let run_out = match block.number(b'E') {
            Some(number) if tapered >= 2 && lead > 0 => {
                divide_rounded(self.state.length(number) * 10, lead)
            }
            _ => 0,
        };
        if block.number(b'R').is_some_and(|it| it.micro != 2 * UNIT) || tapered % 2 == 1 {
            self.note(block.line, "G76", say::ported_note_infeed());
        }
        let data = ThreadData {
            finishing: block.number(b'H').map_or(1, nearest_whole),
            run_out,
            angle: block.number(b'Q').map_or(0, |it| nearest_whole(twice(it))),
            least: 0,
            taper: 0,
            height: height / 2,
            first: first / 2,
            lead,
        };
        self.note(block.line, "G76", say::ported_note_drive_line());
        block.remove(b"X");
        block.replace_g(760, &format!("G76 {}", length_word(b'X', end)));
        self.write_thread(block, data);
        Ok(())
    }

    /// Converts G76 X Z Q P H I R K L C B T J of Mach3.
    fn convert_mach_thread(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let refuse = |letter: &str| Refusal::new(letter, say::ported_note_mach_thread());
        let need = |letter: u8, name: &str| block.number(letter).ok_or_else(|| refuse(name));
        if block.number(b'T').is_some_and(|it| it.micro != 0) {
            return Err(refuse("T"));
        }
        let end = self.state.diameter(need(b'X', "X")?);
        let start = self.state.diameter(need(b'R', "R")?);
        let first = self.state.length(need(b'H', "H")?).abs();
        let lead = self.state.to_metric(need(b'P', "P")?.micro);
        let least = block
            .number(b'J')
            .map_or(0, |it| self.state.length(it).abs());
        let data = ThreadData {
            finishing: block.number(b'Q').map_or(1, nearest_whole),
            run_out: 0,
            angle: block.number(b'I').map_or(0, |it| nearest_whole(twice(it))),
            least,
            taper: 0,
            height: (start - end).abs() / 2,
            first,
            lead,
        };
        if let Some(number) = block.number(b'K') {
            let level = self.state.length(number);
            let written = self.state.axes[1].move_to(level);
            block
                .before
                .push(format!("G00 {}", length_word(b'Z', written)));
        }
        self.note(block.line, "G76", say::ported_note_mach_thread());
        block.remove(b"T");
        self.write_thread(block, data);
        Ok(())
    }

    /// Writes the first G76 block in a line before the block, and the words of the second one into
    /// it.
    fn write_thread(&mut self, block: &mut ForeignBlock, data: ThreadData) {
        block.remove(b"IJKDAPQREFHLCBT");
        self.convert_axis(block, 0, false);
        self.convert_axis(block, 1, false);
        block.before.push(data.first_line());
        block.append(&data.words());
    }

    /// Whether the block calls a thread cycle in which T is a taper and not a tool.
    pub fn is_thread_taper(&self, block: &ForeignBlock) -> bool {
        self.state.set == CodeSet::Mach3 && block.has_g(760)
    }
}

fn nearest_whole(number: Number) -> i64 {
    divide_rounded(number.micro, UNIT)
}

const fn twice(number: Number) -> Number {
    Number {
        micro: number.micro * 2,
        has_point: true,
    }
}

/// Returns the word with this letter as messages show it; the letter alone if the block has none.
pub(crate) fn shown_word(block: &ForeignBlock, letter: u8) -> String {
    let word = block.word(letter).map(ForeignWord::shown);
    word.unwrap_or_else(|| char::from(letter).to_string())
}
