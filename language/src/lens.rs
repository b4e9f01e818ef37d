//! Summarises programs, tools and cycles in lines above them: time, extents, finishing
//! allowance.

use gsk_messages::{Language, say};
use gsk_milling::MillAxis;
use gsk_runner::move_output::{diameter_z, round_to_millionth};
use gsk_runner::text_format::format_whole_seconds;

use crate::diagnose::{Analysis, Extents};
use crate::structure::{ProfileCycle, Structure};
use crate::text::TextRange;

/// A one-line summary that an editor shows above a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lens {
    /// Range of the word to which the summary belongs.
    pub range: TextRange,
    /// The text of the summary, one line.
    pub text: String,
}

/// Returns the summaries of an analysed program: of the whole program, its tools and its
/// cycles.
pub fn lenses(structure: &Structure, analysis: &Analysis, language: Language) -> Vec<Lens> {
    let mut lenses = Vec::new();
    if let Some(part) = structure.parts.first() {
        let first = TextRange {
            line: structure.block_lines.0,
            from: 0,
            to: 0,
        };
        lenses.push(Lens {
            range: part.name.clone().unwrap_or(first),
            text: program_summary(analysis, language),
        });
    }
    let times = analysis.line_times.by_tool(structure);
    for (tool, seconds) in structure.tools.iter().zip(times) {
        // A tool without machining time, or a word of a program that does not run.
        if seconds > 0.0 {
            lenses.push(Lens {
                range: tool.range.clone(),
                text: say::lens_tool(format_whole_seconds(seconds)).text(language),
            });
        }
    }
    let cycles = structure.cycles.iter();
    lenses.extend(cycles.filter_map(|it| cycle_lens(it, structure, language)));
    lenses
}

/// Returns the summary of the whole program: time, extents and tools.
fn program_summary(analysis: &Analysis, language: Language) -> String {
    let time = format_whole_seconds(analysis.time_s);
    let cutting = format_whole_seconds(analysis.cutting_s);
    let mut parts = vec![say::lens_time(time, cutting).text(language)];
    match analysis.extents {
        Some(Extents::Lathe(bounds)) => {
            let (least, greatest) = (diameter_z(bounds.least), diameter_z(bounds.greatest));
            let extents = say::lens_extents(least.0, greatest.0, least.1, greatest.1);
            parts.push(extents.text(language));
        }
        Some(Extents::Mill(bounds, axes)) => {
            let [least, greatest] =
                [bounds.least, bounds.greatest].map(|it| it.map(round_to_millionth));
            let x = (least[0], greatest[0]);
            let (y, z) = ((least[1], greatest[1]), (least[2], greatest[2]));
            let extents = say::lens_extents_mill(x.0, x.1, y.0, y.1, z.0, z.1);
            parts.push(extents.text(language));
            for (axis, further) in axes.all_further() {
                let (least, greatest) = bounds.further[usize::from(axis == MillAxis::Fifth)];
                let (least, greatest) = (round_to_millionth(least), round_to_millionth(greatest));
                let unit = if further.rotary { "°" } else { "" };
                parts.push(format!("{} {least} … {greatest}{unit}", further.letter));
            }
        }
        None => {}
    }
    if !analysis.tools.is_empty() {
        parts.push(analysis.tools.join(" "));
    }
    parts.join(" | ")
}

/// The summary of a cycle: its profile and its finishing allowance. `None` if the profile is
/// not found.
fn cycle_lens(cycle: &ProfileCycle, structure: &Structure, language: Language) -> Option<Lens> {
    let (p, q) = cycle.profile;
    let line = |number| {
        let found = structure.blocks_in_part(number, cycle.part).next();
        found.map(|block| block.digits.line)
    };
    let lines = line(q)?.checked_sub(line(p)?)? + 1;
    let mut text = say::lens_profile(p, q, lines).text(language);
    let (u, w) = &cycle.allowances;
    if cycle.code != 70 && (u.is_some() || w.is_some()) {
        let left = |value: &Option<String>| value.clone().unwrap_or_else(|| "0".to_owned());
        text.push_str(" | ");
        text.push_str(&say::lens_leaves(left(u), left(w)).text(language));
    }
    Some(Lens {
        range: cycle.range.clone(),
        text,
    })
}
