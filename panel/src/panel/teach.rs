//! Handles teach-in: the operator moves the axes and stores their position in the program
//! (manual PLC-II 3.6).

use gsk_core::cnc::{Cnc, ControlRequest};
use gsk_core::program::ProgramEditor;
use gsk_core::units::Axis;

use super::Panel;
use crate::keys::Key;
use crate::pages::{PageId, TaughtPoint, teaches};

/// Millimetres in an inch.
const MM_PER_INCH: f64 = 25.4;

impl Panel {
    /// Handles 输入 in a teach-in mode: sets the axis word at the cursor to the absolute
    /// coordinate, unless an axis moves.
    pub(super) fn teach(&mut self, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        if self.view.editor.searching || !self.view.input.is_empty() || cnc.is_moving() {
            return;
        }
        let axis = self.view.editor.editing.as_ref();
        let Some(axis) = axis.and_then(ProgramEditor::axis_word) else {
            return;
        };
        let value = programmed(cnc, axis);
        self.edit(cnc, requests, |editing| editing.teach_axis(&value));
    }
}

/// Greatest number of digits of a feed and of a program number.
const DIGITS: usize = 5;

/// Teaches points by hand (NC-B08, key 示教).
impl Panel {
    /// Returns whether keys teach points: they do on the teaching page in a manual mode.
    pub(super) fn is_teaching(&self, cnc: &Cnc) -> bool {
        self.page == PageId::Teach && teaches(cnc)
    }

    /// Handles a key of the teaching page. Returns `false` if the key does not teach.
    pub(super) fn teaching_key(
        &mut self,
        key: Key,
        cnc: &Cnc,
        requests: &mut Vec<ControlRequest>,
    ) -> bool {
        match key {
            Key::Input if !self.view.input.is_empty() => self.take_teaching_word(),
            Key::Input if cnc.is_moving() => {}
            Key::Input => {
                let teaching = &mut self.view.teaching;
                let feed = (!teaching.rapid).then(|| teaching.feed.clone());
                teaching.points.push(TaughtPoint {
                    feed,
                    x: programmed(cnc, Axis::X),
                    z: programmed(cnc, Axis::Z),
                });
            }
            Key::Delete => {
                self.view.teaching.points.pop();
            }
            Key::Change => {
                let teaching = &mut self.view.teaching;
                teaching.from_first = !teaching.from_first;
            }
            Key::Cancel if self.view.input.is_empty() => {
                if !self.view.teaching.points.is_empty() {
                    requests.push(ControlRequest::StoreProgram(self.view.teaching.text()));
                }
                self.go_to(PageId::PosRel, cnc);
            }
            _ => return false,
        }
        true
    }

    /// Handles a character of the teaching page: G changes between G00 and G01; F and P begin
    /// a word.
    pub(super) fn teaching_character(&mut self, character: char) {
        let input = &mut self.view.input;
        match character {
            'G' if input.is_empty() => {
                let teaching = &mut self.view.teaching;
                teaching.rapid = !teaching.rapid;
            }
            'F' | 'P' if input.is_empty() => input.push(character),
            '0'..='9' if !input.is_empty() && input.len() <= DIGITS => input.push(character),
            _ => {}
        }
    }

    /// Enters the typed word: F sets the feed of cuts, P selects another program without
    /// points.
    fn take_teaching_word(&mut self) {
        let input = core::mem::take(&mut self.view.input);
        let teaching = &mut self.view.teaching;
        let Some(number) = input.get(1..).and_then(|it| it.parse::<u32>().ok()) else {
            return;
        };
        match input.as_bytes().first() {
            Some(b'F') if number > 0 => teaching.feed = number.to_string(),
            Some(b'P') => {
                let number = u16::try_from(number).ok();
                let Some(number) = number.filter(|it| (1..=9999).contains(it)) else {
                    return;
                };
                if number != teaching.program {
                    teaching.points.clear();
                }
                teaching.program = number;
            }
            _ => {}
        }
    }
}

/// Returns the position of an axis as a program word: diameter or radius, mm or inch.
fn programmed(cnc: &Cnc, axis: Axis) -> String {
    let at = cnc.position_absolute().get(axis);
    let radius = axis == Axis::Z || cnc.parameters().is_radius_programming();
    let at = if radius { at } else { at * 2.0 };
    if cnc.is_inch_input() {
        signed(at / MM_PER_INCH, 4)
    } else {
        signed(at, 3)
    }
}

/// Formats a number with `decimals` decimals; never as "-0.000".
fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|byte| matches!(byte, b'0' | b'.')) => digits.to_owned(),
        _ => text,
    }
}
