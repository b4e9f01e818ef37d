//! The greatest loads of each block, and what exceeds the limits of lathe and inserts.

use std::collections::BTreeMap;

use gsk_core::command::{ProgramId, SourcePosition};
use gsk_core::machine::LoadLimits;
use gsk_core::preview::Lint;
use gsk_messages::{Message, say};
use gsk_workpiece::job::Job;
use gsk_workpiece::stock::StockForm;
use gsk_workpiece::tool::{Holder, Tool};

use super::move_load::{CutLoad, MoveLoad};

/// The greatest load of a block with a tool.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockLoad {
    /// The block.
    pub source: SourcePosition,
    /// Number of the tool.
    pub tool: u8,
    /// The load with the greatest force.
    pub heaviest: CutLoad,
    /// Greatest power, kW.
    pub power_kw: f64,
    /// Greatest torque, N·m, and the spindle speed at it, r/min.
    pub torque: (f64, f64),
    /// Greatest force against the feed, N.
    pub feed_force_n: f64,
    /// Greatest change of the diameter because boring bar and stock give way, mm, with its sign,
    /// and the force across the axis at it, N.
    pub size_error: (f64, f64),
    /// Greatest length of the edge in the material, mm.
    pub edge_mm: f64,
    /// Greatest feed per revolution, mm; for a thread its lead.
    pub feed_mm: f64,
    /// Whether the block cuts a thread.
    pub is_thread: bool,
    /// Greatest roughness Ra, µm; `None` if no move leaves a turned surface.
    pub roughness_um: Option<f64>,
}

impl BlockLoad {
    /// Adds what exceeds the limits of spindle, slides and chuck.
    fn find_machine_limits(&self, limits: &LoadLimits, add: &mut impl FnMut(Lint, Message)) {
        if let Some(rated) = limits.power_kw.filter(|rated| self.power_kw > *rated) {
            let message = say::load_power_exceeded(
                format_args!("{:.2}", self.power_kw),
                format_args!("{rated:.2}"),
            );
            add(Lint::SpindlePower, message);
        }
        let (torque, rpm) = self.torque;
        if let Some(rated) = limits.rated_torque_nm().filter(|rated| torque > *rated)
            && limits.is_torque_limited(rpm)
        {
            let message = say::load_torque_exceeded(
                format_args!("{torque:.1}"),
                format_args!("{rpm:.0}"),
                format_args!("{rated:.1}"),
            );
            add(Lint::SpindleTorque, message);
        }
        let needed = self.feed_force_n;
        if let Some(limit) = limits.axis_force_n.filter(|limit| needed > *limit) {
            let needed = format_args!("{needed:.0}");
            let message = say::load_axis_force_exceeded(needed, format_args!("{limit:.0}"));
            add(Lint::AxisForce, message);
        }
        if let Some(limit) = limits.grip_nm.filter(|limit| torque > *limit) {
            let needed = format_args!("{torque:.1}");
            let message = say::load_grip_exceeded(needed, format_args!("{limit:.1}"));
            add(Lint::ChuckGrip, message);
        }
    }

    /// Adds what exceeds the limits of the insert.
    fn find_insert_limits(&self, tool: &Tool, add: &mut impl FnMut(Lint, Message)) {
        let longest = tool.insert.greatest_edge_mm();
        if let Some(longest) = longest.filter(|it| self.edge_mm > *it) {
            let message = say::load_edge_exceeded(
                format_args!("{:.2}", self.edge_mm),
                format_args!("{:02}", self.tool),
                format_args!("{longest:.2}"),
            );
            add(Lint::InsertEdge, message);
        }
        let fastest = tool.insert.greatest_feed_mm().filter(|_| !self.is_thread);
        if let Some(fastest) = fastest.filter(|it| self.feed_mm > *it + 1e-9) {
            let message = say::load_feed_exceeded(
                format_args!("{:.3}", self.feed_mm),
                format_args!("{:02}", self.tool),
                format_args!("{fastest:.3}"),
            );
            add(Lint::InsertFeed, message);
        }
    }

    /// Adds a diameter that is wrong because boring bar and stock give way.
    fn find_size_error(&self, limits: &LoadLimits, add: &mut impl FnMut(Lint, Message)) {
        let (error, force) = self.size_error;
        if error.abs() > limits.size_error_mm {
            let message = say::load_size_error(
                format_args!("{:.0}", force.abs()),
                format_args!("{error:+.2}"),
                format_args!("{:.2}", limits.size_error_mm),
            );
            add(Lint::SizeError, message);
        }
    }
}

/// A limit that a load exceeds.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadFinding {
    /// The kind of finding.
    pub lint: Lint,
    /// The first block that exceeds the limit.
    pub source: SourcePosition,
    /// What is exceeded, and by what.
    pub message: Message,
}

/// Collects the loads of a program, block by block.
#[derive(Clone, Debug, Default)]
pub struct LoadSummary {
    blocks: Vec<BlockLoad>,
    /// Position in the list by program, line and tool.
    positions: BTreeMap<(i32, u32, u8), usize>,
}

impl LoadSummary {
    /// Adds the load of a move.
    pub fn add_move(&mut self, load: &MoveLoad) {
        let program = match load.source.program {
            ProgramId::Stored(number) => i32::from(number),
            ProgramId::External => -1,
            ProgramId::Mdi => -2,
            ProgramId::Dnc => -3,
        };
        let key = (program, load.source.line, load.tool);
        let index = *self.positions.entry(key).or_insert(self.blocks.len());
        if index == self.blocks.len() {
            self.blocks.push(BlockLoad {
                source: load.source,
                tool: load.tool,
                heaviest: CutLoad::default(),
                power_kw: 0.0,
                torque: (0.0, 0.0),
                feed_force_n: 0.0,
                size_error: (0.0, 0.0),
                edge_mm: 0.0,
                feed_mm: 0.0,
                is_thread: load.is_thread,
                roughness_um: None,
            });
        }
        let block = &mut self.blocks[index];
        for cut in &load.loads {
            if cut.force_n > block.heaviest.force_n {
                block.heaviest = *cut;
            }
            if cut.torque_nm > block.torque.0 {
                block.torque = (cut.torque_nm, cut.rpm);
            }
            if cut.size_error_mm.abs() > block.size_error.0.abs() {
                block.size_error = (cut.size_error_mm, cut.radial_force_n);
            }
            block.power_kw = block.power_kw.max(cut.power_kw);
            block.feed_force_n = block.feed_force_n.max(cut.feed_force_n);
            block.edge_mm = block.edge_mm.max(cut.chip.width_mm);
        }
        block.feed_mm = block.feed_mm.max(load.feed_mm);
        block.roughness_um = match (block.roughness_um, load.roughness_um) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (a, b) => a.or(b),
        };
    }

    /// The blocks that cut, in the order of their first cut.
    pub fn blocks(&self) -> &[BlockLoad] {
        &self.blocks
    }

    /// What exceeds a limit: each kind once for a block, a bar once for its tool, the stock once.
    /// `is_guessed`: the job is a guess, which says nothing about the overhang of bars and stock.
    pub fn findings(&self, limits: &LoadLimits, job: &Job, is_guessed: bool) -> Vec<LoadFinding> {
        let mut findings = Vec::new();
        for block in &self.blocks {
            let mut add = |lint, message| {
                findings.push(LoadFinding {
                    lint,
                    source: block.source,
                    message,
                });
            };
            block.find_machine_limits(limits, &mut add);
            if let Some(tool) = job.tools.get(&block.tool) {
                block.find_insert_limits(tool, &mut add);
            }
            if !is_guessed {
                block.find_size_error(limits, &mut add);
            }
        }
        if !is_guessed {
            self.add_bars(&mut findings, limits, job);
        }
        self.add_stock(&mut findings, limits, job);
        findings
    }

    /// Adds the boring bars that protrude too far, at their first cut.
    fn add_bars(&self, findings: &mut Vec<LoadFinding>, limits: &LoadLimits, job: &Job) {
        for (number, tool) in &job.tools {
            let Holder::Bar { diameter, length } = tool.holder else {
                continue;
            };
            let ratio = length / diameter;
            let first = self.blocks.iter().find(|block| block.tool == *number);
            if let Some(block) = first.filter(|_| ratio > limits.bar_overhang) {
                findings.push(LoadFinding {
                    lint: Lint::LongOverhang,
                    source: block.source,
                    message: say::load_bar_overhang(
                        format_args!("{number:02}"),
                        format_args!("{ratio:.1}"),
                        format_args!("{:.1}", limits.bar_overhang),
                    ),
                });
            }
        }
    }

    /// Adds the stock without a tailstock that protrudes too far, at the first cut.
    fn add_stock(&self, findings: &mut Vec<LoadFinding>, limits: &LoadLimits, job: &Job) {
        let stock = &job.stock;
        let is_bar = matches!(stock.form, StockForm::Bar { .. } | StockForm::Tube { .. });
        let ratio = stock.overhang / (2.0 * stock.radius()).max(1e-3);
        if let (Some(limit), Some(first)) = (limits.stock_overhang, self.blocks.first())
            && is_bar
            && stock.tailstock.is_none()
            && ratio > limit
        {
            findings.push(LoadFinding {
                lint: Lint::LongOverhang,
                source: first.source,
                message: say::load_stock_overhang(
                    format_args!("{ratio:.1}"),
                    format_args!("{limit:.1}"),
                ),
            });
        }
    }
}
