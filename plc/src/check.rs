//! Checks the rules that concern more than one line: rungs, levels, labels, subprograms and
//! program length.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use gsk_messages::{Message, say};

use crate::address::BitAddress;
use crate::diagnostic::{CompileError, Rule};
use crate::instruction::{InstructionRole, Mnemonic, Operand, Statement};

/// Capacity of the program memory, steps.
pub const MAX_STEPS: u32 = 5000;
/// Steps that the PLC can run in its 1 ms of each 8 ms slot.
pub(crate) const MAX_SLOT_STEPS: u32 = 500;
/// Length of level 1, steps, above which the compiler warns that level 2 gets little time.
const LEVEL1_WARNING_STEPS: u32 = 400;
/// Capacity of the accumulator stack: the number of open branches.
const MAX_STACK_DEPTH: u32 = 16;
/// Maximum nesting depth of subprogram calls.
pub(crate) const MAX_CALL_DEPTH: usize = 8;

/// The program section that contains a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ProgramSection {
    Level1,
    Level2,
    /// After END2 and not within a subprogram.
    Outside,
    /// Within the subprogram whose SP instruction has this statement index.
    Subprogram(usize),
}

/// Statement indices of the levels, labels and subprograms of a program, and its length.
#[derive(Clone, Debug, Default)]
pub(crate) struct LadderStructure {
    pub end1: usize,
    pub end2: usize,
    pub labels: BTreeMap<u16, usize>,
    pub subprograms: BTreeMap<u16, usize>,
    pub level1_steps: u32,
    pub steps: u32,
}

struct Checker<'a> {
    statements: &'a [Statement],
    structure: LadderStructure,
    sections: Vec<ProgramSection>,
    errors: Vec<CompileError>,
    warnings: Vec<CompileError>,
}

/// Checks a whole program and returns its structure, the errors and the warnings.
pub(crate) fn check(
    statements: &[Statement],
) -> (LadderStructure, Vec<CompileError>, Vec<CompileError>) {
    let mut checker = Checker {
        statements,
        structure: LadderStructure::default(),
        sections: Vec::with_capacity(statements.len()),
        errors: Vec::new(),
        warnings: Vec::new(),
    };
    checker.check_levels();
    checker.check_rungs();
    checker.check_duplicate_numbers();
    checker.check_jumps();
    checker.check_calls();
    checker.check_lengths();
    (checker.structure, checker.errors, checker.warnings)
}

impl Checker<'_> {
    fn add_error(&mut self, at: usize, code: Rule, message: Message) {
        let error = self.error_at(at, code, message);
        self.errors.push(error);
    }

    fn add_warning(&mut self, at: usize, code: Rule, message: Message) {
        let warning = self.error_at(at, code, message);
        self.warnings.push(warning);
    }

    fn error_at(&self, at: usize, code: Rule, message: Message) -> CompileError {
        let statement = self.statements.get(at).or(self.statements.last());
        CompileError {
            line: statement.map_or(1, |statement| statement.line),
            rung: statement.map_or(0, |statement| statement.rung),
            code,
            message,
        }
    }

    /// Checks the order of the sections: level 1, END1, level 2, END2, subprograms SP to
    /// SPE.
    fn check_levels(&mut self) {
        let mut section = ProgramSection::Level1;
        let mut end1 = None;
        let mut end2 = None;
        let mut strays = 0;
        let statements = self.statements;
        for (at, statement) in statements.iter().enumerate() {
            self.sections.push(section);
            match statement.mnemonic {
                Mnemonic::End1 if end1.is_some() => {
                    self.add_error(at, Rule::E01, say::ladder_end_one_twice());
                }
                Mnemonic::End1 if end2.is_some() => {
                    self.add_error(at, Rule::E01, say::ladder_end_one_late());
                }
                Mnemonic::End1 => {
                    end1 = Some(at);
                    section = ProgramSection::Level2;
                }
                Mnemonic::End2 if end2.is_some() => {
                    self.add_error(at, Rule::E01, say::ladder_end_two_twice());
                }
                Mnemonic::End2 => {
                    end2 = Some(at);
                    section = ProgramSection::Outside;
                }
                Mnemonic::Sp => section = self.enter_subprogram(at, section),
                Mnemonic::Spe => match section {
                    ProgramSection::Subprogram(_) => section = ProgramSection::Outside,
                    _ => self.add_error(at, Rule::E05, say::ladder_subprogram_not_open()),
                },
                _ if section == ProgramSection::Outside && strays == 0 => {
                    strays += 1;
                    let message = say::ladder_code_after_end_two();
                    self.add_error(at, Rule::E01, message);
                }
                _ => {}
            }
        }
        let last = self.statements.len();
        if let ProgramSection::Subprogram(start) = section {
            self.add_error(start, Rule::E05, say::ladder_subprogram_not_ended());
        }
        if end1.is_none() {
            let message = say::ladder_end_one_missing();
            self.add_error(last, Rule::E01, message);
        }
        if end2.is_none() {
            self.add_error(last, Rule::E01, say::ladder_end_two_missing());
        }
        self.structure.end1 = end1.unwrap_or(0);
        self.structure.end2 = end2.unwrap_or(last);
    }

    fn enter_subprogram(&mut self, at: usize, section: ProgramSection) -> ProgramSection {
        match section {
            ProgramSection::Outside => return ProgramSection::Subprogram(at),
            ProgramSection::Subprogram(_) => {
                self.add_error(at, Rule::E05, say::ladder_subprogram_in_subprogram());
                return ProgramSection::Subprogram(at);
            }
            ProgramSection::Level1 | ProgramSection::Level2 => {
                self.add_error(at, Rule::E05, say::ladder_subprogram_too_early());
            }
        }
        section
    }

    /// Checks that each rung has one result at its output and only outputs after it.
    fn check_rungs(&mut self) {
        let mut depth = 0;
        let mut output = false;
        let mut coils: BTreeMap<BitAddress, u32> = BTreeMap::new();
        let statements = self.statements;
        for (at, statement) in statements.iter().enumerate() {
            let name = statement.mnemonic.row().name;
            match statement.mnemonic.row().role {
                InstructionRole::Start if output => (depth, output) = (1, false),
                InstructionRole::Start if depth == MAX_STACK_DEPTH => {
                    let message = say::ladder_branches_too_many(MAX_STACK_DEPTH);
                    self.add_error(at, Rule::E02, message);
                }
                InstructionRole::Start => depth += 1,
                InstructionRole::Contact if output => {
                    let message = say::ladder_contact_after_output(name);
                    self.add_error(at, Rule::E02, message);
                }
                InstructionRole::Contact => depth = self.check_contact(at, depth),
                InstructionRole::Output => {
                    if !output && depth != 1 {
                        self.add_error(at, Rule::E02, no_single_result_message(name, depth));
                    }
                    output = true;
                    self.check_double_coil(at, &mut coils);
                }
                InstructionRole::Structure => {
                    self.warn_if_no_output(at, depth, output);
                    (depth, output) = (0, false);
                }
            }
        }
        self.warn_if_no_output(self.statements.len(), depth, output);
    }

    fn check_contact(&mut self, at: usize, depth: u32) -> u32 {
        let row = self.statements[at].mnemonic.row();
        let block = row.operands.is_empty();
        let wanted = if block { 2 } else { 1 };
        if depth < wanted {
            let message = if block {
                say::ladder_blocks_missing(row.name, depth)
            } else {
                say::ladder_contact_without_start(row.name)
            };
            self.add_error(at, Rule::E02, message);
            return 1;
        }
        if block { depth - 1 } else { depth }
    }

    fn warn_if_no_output(&mut self, at: usize, depth: u32, output: bool) {
        if depth > 0 && !output {
            let before = at.saturating_sub(1);
            self.add_warning(before, Rule::W03, say::ladder_rung_without_output());
        }
    }

    fn check_double_coil(&mut self, at: usize, coils: &mut BTreeMap<BitAddress, u32>) {
        let statement = &self.statements[at];
        let (Mnemonic::Out, [Operand::Bit(bit)]) = (statement.mnemonic, &statement.operands[..])
        else {
            return;
        };
        match coils.entry(*bit) {
            Entry::Vacant(entry) => {
                entry.insert(statement.line);
            }
            Entry::Occupied(entry) => {
                let message = say::ladder_coil_twice(bit, entry.get());
                self.add_warning(at, Rule::W01, message);
            }
        }
    }

    /// Checks that the number of each label, subprogram and timer is unique.
    fn check_duplicate_numbers(&mut self) {
        let mut timers: BTreeMap<u16, u32> = BTreeMap::new();
        let statements = self.statements;
        for (at, statement) in statements.iter().enumerate() {
            let (noun, first) = match (statement.mnemonic, statement.operands.first()) {
                (Mnemonic::Lbl, Some(Operand::Label(label))) => {
                    let first = *self.structure.labels.entry(*label).or_insert(at);
                    (say::ladder_label(label), statements[first].line)
                }
                (Mnemonic::Sp, Some(Operand::Subprogram(number))) => {
                    let first = *self.structure.subprograms.entry(*number).or_insert(at);
                    (say::ladder_subprogram(number), statements[first].line)
                }
                (Mnemonic::Tmrb, Some(Operand::Byte(timer))) => {
                    let first = *timers.entry(timer.byte).or_insert(statement.line);
                    (say::ladder_timer(timer.byte), first)
                }
                _ => continue,
            };
            if first != statement.line {
                let message = say::ladder_number_twice(noun, first);
                self.add_error(at, Rule::E04, message);
            }
        }
    }

    fn check_jumps(&mut self) {
        let mut unused = self.structure.labels.clone();
        let statements = self.statements;
        for (at, statement) in statements.iter().enumerate() {
            let (Mnemonic::Jmpb, Some(Operand::Label(label))) =
                (statement.mnemonic, statement.operands.first())
            else {
                continue;
            };
            unused.remove(label);
            let Some(target) = self.structure.labels.get(label).copied() else {
                self.add_error(at, Rule::E04, say::ladder_label_missing(label));
                continue;
            };
            if self.sections.get(at) != self.sections.get(target) {
                let message = say::ladder_jump_leaves_part(label);
                self.add_error(at, Rule::E05, message);
            }
        }
        for (label, at) in unused {
            self.add_warning(at, Rule::W02, say::ladder_label_unused(label));
        }
    }

    fn check_calls(&mut self) {
        // Calls between subprograms: start of the caller, start of the callee, index of the
        // call.
        let mut nested: Vec<(usize, usize, usize)> = Vec::new();
        let statements = self.statements;
        for (at, statement) in statements.iter().enumerate() {
            let (Mnemonic::Call, Some(Operand::Subprogram(number))) =
                (statement.mnemonic, statement.operands.first())
            else {
                continue;
            };
            let target = self.structure.subprograms.get(number).copied();
            if target.is_none() {
                self.add_error(at, Rule::E04, say::ladder_subprogram_missing(number));
            }
            match (self.sections.get(at), target) {
                (Some(ProgramSection::Level1), _) => {
                    self.add_error(at, Rule::E05, say::ladder_call_in_level_one());
                }
                (Some(ProgramSection::Subprogram(caller)), Some(callee)) => {
                    nested.push((*caller, callee, at));
                }
                _ => {}
            }
        }
        self.check_call_nesting(&nested);
    }

    /// Checks that no subprogram calls itself, directly or indirectly, and that calls are
    /// not nested deeper than [`MAX_CALL_DEPTH`].
    fn check_call_nesting(&mut self, nested: &[(usize, usize, usize)]) {
        // Topological sort: removes subprograms without callers until none is left. Any
        // remaining subprogram is part of a recursion.
        let mut callers: BTreeMap<usize, usize> = BTreeMap::new();
        let mut callees: BTreeMap<usize, Vec<(usize, usize)>> = BTreeMap::new();
        for (caller, callee, at) in nested {
            callers.entry(*caller).or_insert(0);
            *callers.entry(*callee).or_insert(0) += 1;
            callees.entry(*caller).or_default().push((*callee, *at));
        }
        let mut depth: BTreeMap<usize, usize> = BTreeMap::new();
        let mut free: Vec<usize> = callers
            .iter()
            .filter(|(_, count)| **count == 0)
            .map(|(node, _)| *node)
            .collect();
        while let Some(node) = free.pop() {
            callers.remove(&node);
            let level = depth.get(&node).copied().unwrap_or(1);
            for (callee, at) in callees.remove(&node).unwrap_or_default() {
                let deepest = depth.entry(callee).or_insert(1);
                if level + 1 > *deepest {
                    *deepest = level + 1;
                }
                if level + 1 == MAX_CALL_DEPTH + 1 {
                    let message = say::ladder_calls_too_deep(MAX_CALL_DEPTH);
                    self.add_error(at, Rule::E05, message);
                }
                if let Some(count) = callers.get_mut(&callee) {
                    *count -= 1;
                    if *count == 0 {
                        free.push(callee);
                    }
                }
            }
        }
        for (_, calls) in callees {
            for (_, at) in calls {
                self.add_error(at, Rule::E05, say::ladder_subprogram_calls_itself());
            }
        }
    }

    fn check_lengths(&mut self) {
        let steps = |statements: &[Statement]| -> u32 {
            statements
                .iter()
                .fold(0, |sum, statement| sum.saturating_add(statement.steps()))
        };
        let end1 = self.structure.end1;
        let level1 = self.statements.get(..=end1).map_or(0, steps);
        let total = steps(self.statements);
        self.structure.level1_steps = level1;
        self.structure.steps = total;
        if total > MAX_STEPS {
            let message = say::ladder_too_long(total, MAX_STEPS);
            self.add_error(self.statements.len(), Rule::E07, message);
        }
        if level1 > MAX_SLOT_STEPS {
            let message = say::ladder_level_one_too_long(level1, MAX_SLOT_STEPS);
            self.add_error(end1, Rule::E07, message);
        } else if level1 > LEVEL1_WARNING_STEPS {
            let message = say::ladder_level_one_long(level1, LEVEL1_WARNING_STEPS);
            self.add_warning(end1, Rule::W04, message);
        }
    }
}

fn no_single_result_message(name: &str, depth: u32) -> Message {
    if depth == 0 {
        return say::ladder_output_without_contact(name);
    }
    say::ladder_blocks_not_joined(depth, name)
}
