//! The load of the cuts in a report.

use gsk_core::command::ProgramId;
use gsk_core::machine::LoadLimits;
use gsk_core::model::ProgramNaming;
use gsk_messages::{Language, say};
use gsk_workpiece::cutting::CuttingMaterial;
use gsk_workpiece::job::Job;
use serde::Serialize;

use super::{ProgramReport, WarningReport, message_text};
use crate::machining::{BlockLoad, LoadSummary};

/// Number of blocks that the text lists; more only if their forces are equal.
const MAX_LISTED_BLOCKS: usize = 50;
/// Least change of a diameter that the text names, mm.
const SHOWN_SIZE_ERROR_MM: f64 = 0.002;

/// The load of a program in a material.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoadReport {
    /// Designation of the material in the table of materials; `None` without constants.
    pub material: Option<&'static str>,
    /// Whether the job names no grade, so that the usual one of its material is taken.
    pub assumed: bool,
    /// Cutting force of a chip of 1 mm by 1 mm, N/mm²; `None` without a material.
    pub kc11: Option<f64>,
    /// Exponent of the chip thickness; `None` without a material.
    pub mc: Option<f64>,
    /// Publication of both constants; `None` without a material.
    pub source: Option<&'static str>,
    /// Greatest cutting force, N.
    pub force_n: f64,
    /// Greatest power, kW.
    pub power_kw: f64,
    /// Greatest torque, N·m.
    pub torque_nm: f64,
    /// The blocks that cut, in the order of their first cut.
    pub blocks: Vec<BlockLoadReport>,
}

/// The greatest load of a block.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BlockLoadReport {
    /// Line of the block in its program, from 1.
    pub line: u32,
    /// Number of the subprogram that contains the block; `None` for the main program.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub program: Option<u16>,
    /// Number of the tool.
    pub tool: u8,
    /// Greatest cutting force, N.
    pub force_n: f64,
    /// Greatest power, kW.
    pub power_kw: f64,
    /// Greatest torque, N·m.
    pub torque_nm: f64,
    /// Greatest force against the feed, N.
    pub feed_force_n: f64,
    /// Force across the spindle axis at the greatest cutting force, N; negative pushes the tool
    /// inwards.
    pub radial_force_n: f64,
    /// Greatest change of the diameter because boring bar and stock give way, mm.
    pub size_error_mm: f64,
    /// Length of the edge in the material at the greatest force, mm.
    pub edge_mm: f64,
    /// Mean chip thickness at the greatest force, mm.
    pub thickness_mm: f64,
    /// Area of the chip of one edge at the greatest force, mm².
    pub area_mm2: f64,
    /// Cutting speed at the greatest force, m/min.
    pub speed_m_per_min: f64,
    /// Greatest feed per revolution, mm; for a thread its lead.
    pub feed_mm: f64,
    /// Greatest theoretical roughness Ra, µm; `None` if no surface is turned.
    pub ra_um: Option<f64>,
}

/// Rounds to four significant decimals of the unit, as measured values deserve.
fn round(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

impl From<&BlockLoad> for BlockLoadReport {
    fn from(block: &BlockLoad) -> Self {
        let heaviest = &block.heaviest;
        Self {
            line: block.source.line,
            program: match block.source.program {
                ProgramId::Stored(number) => Some(number),
                _ => None,
            },
            tool: block.tool,
            force_n: round(heaviest.force_n),
            power_kw: round(block.power_kw),
            torque_nm: round(block.torque.0),
            feed_force_n: round(block.feed_force_n),
            radial_force_n: round(heaviest.radial_force_n),
            size_error_mm: round(block.size_error.0),
            edge_mm: round(heaviest.chip.width_mm),
            thickness_mm: round(heaviest.chip.thickness_mm()),
            area_mm2: round(heaviest.chip.area_mm2),
            speed_m_per_min: round(heaviest.speed_m_per_min),
            feed_mm: round(block.feed_mm),
            ra_um: block.roughness_um.map(round),
        }
    }
}

impl LoadReport {
    /// Creates the report on the load of a job in `material`; `None` if the table has none for it.
    pub fn new(summary: &LoadSummary, job: &Job, material: Option<&CuttingMaterial>) -> Self {
        let blocks: Vec<BlockLoadReport> = summary.blocks().iter().map(Into::into).collect();
        let greatest =
            |value: fn(&BlockLoadReport) -> f64| blocks.iter().map(value).fold(0.0, f64::max);
        Self {
            material: material.map(|it| it.name),
            assumed: job.stock.grade.is_none(),
            kc11: material.map(|it| it.kc11),
            mc: material.map(|it| it.mc),
            source: material.map(|it| it.source),
            force_n: greatest(|it| it.force_n),
            power_kw: greatest(|it| it.power_kw),
            torque_nm: greatest(|it| it.torque_nm),
            blocks,
        }
    }

    /// Returns the report as lines of text for the user, in the language `words`, with the
    /// names of programs as `naming` writes them.
    pub(super) fn text_lines(&self, words: Language, naming: ProgramNaming) -> Vec<String> {
        let (Some(material), Some(kc11), Some(mc)) = (self.material, self.kc11, self.mc) else {
            return vec![say::report_load_no_material().text(words)];
        };
        let head = say::report_load(
            material,
            kc11,
            mc,
            format_args!("{:.0}", self.force_n),
            format_args!("{:.2}", self.power_kw),
            format_args!("{:.1}", self.torque_nm),
        );
        let mut lines = vec![head.text(words)];
        if self.assumed {
            lines.push(say::report_load_assumed(material).text(words));
        }
        let least = self.least_listed_force();
        let listed = self.blocks.iter().filter(|block| block.force_n >= least);
        let before = lines.len();
        lines.extend(listed.map(|block| block.text_line(words, naming)));
        let omitted = self.blocks.len() - (lines.len() - before);
        if omitted > 0 {
            lines.push(say::report_load_more(omitted).text(words));
        }
        lines
    }

    /// The least force of the blocks that the text lists, N.
    fn least_listed_force(&self) -> f64 {
        let mut forces: Vec<f64> = self.blocks.iter().map(|block| block.force_n).collect();
        forces.sort_unstable_by(|a, b| b.total_cmp(a));
        forces.get(MAX_LISTED_BLOCKS - 1).copied().unwrap_or(0.0)
    }
}

impl BlockLoadReport {
    fn text_line(&self, words: Language, naming: ProgramNaming) -> String {
        let program = self
            .program
            .map_or(String::new(), |it| naming.name(it) + ", ");
        let line = say::report_load_block(
            self.line,
            format_args!("{:02}", self.tool),
            format_args!("{:.0}", self.force_n),
            format_args!("{:.2}", self.power_kw),
            format_args!("{:.1}", self.torque_nm),
        );
        let chip = say::report_load_chip(
            format_args!("{:.2}", self.edge_mm),
            format_args!("{:.3}", self.thickness_mm),
            format_args!("{:.0}", self.speed_m_per_min),
        );
        let roughness = self.ra_um.map_or(String::new(), |it| {
            say::report_load_roughness(format_args!("{it:.2}")).text(words)
        });
        let push = say::report_load_push(
            format_args!("{:.0}", self.feed_force_n),
            format_args!("{:.0}", self.radial_force_n),
        );
        let error = match self.size_error_mm.abs() >= SHOWN_SIZE_ERROR_MM {
            true => {
                say::report_load_size_error(format_args!("{:+.3}", self.size_error_mm)).text(words)
            }
            false => String::new(),
        };
        program + &line.text(words) + &chip.text(words) + &push.text(words) + &error + &roughness
    }
}

impl ProgramReport {
    /// Adds the load of a job to the report, and a warning for each limit that it exceeds.
    /// `is_guessed`: the job was guessed from the program.
    pub fn add_load(
        &mut self,
        summary: &LoadSummary,
        limits: &LoadLimits,
        job: &Job,
        is_guessed: bool,
        language: Option<Language>,
    ) {
        let material = job.cutting_material();
        self.load = Some(LoadReport::new(summary, job, material.as_ref()));
        let findings = summary.findings(limits, job, is_guessed);
        self.warnings.extend(findings.into_iter().map(|it| {
            let sentence = say::in_line(it.source.line, it.message.clone());
            WarningReport {
                lint: it.lint,
                is_denied: false,
                program: it.source.program,
                line: it.source.line,
                columns: None,
                text: message_text(&it.message, language),
                sentence: message_text(&sentence, language),
            }
        }));
    }
}
