//! Lists the bytes that each rung writes and the rungs that use each byte.

use crate::code::{Code, Function, Op, OperandValue};
use crate::instruction::Statement;
use crate::memory::{RESULT_FLAGS, SIZE};

/// Lists of indices, one for each byte or rung, stored in one vector.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct IndexLists {
    /// Start of each list in `members`, and the end of the last list.
    starts: Vec<u16>,
    members: Vec<u16>,
}

impl IndexLists {
    fn from_lists(lists: impl IntoIterator<Item = Vec<u16>>) -> Option<IndexLists> {
        let mut all = IndexLists {
            starts: vec![0],
            members: Vec::new(),
        };
        for mut list in lists {
            list.sort_unstable();
            list.dedup();
            all.members.append(&mut list);
            all.starts.push(u16::try_from(all.members.len()).ok()?);
        }
        Some(all)
    }

    fn get(&self, of: usize) -> &[u16] {
        let bounds = (self.starts.get(of), self.starts.get(of + 1));
        let (Some(start), Some(end)) = bounds else {
            return &[];
        };
        let range = usize::from(*start)..usize::from(*end);
        self.members.get(range).unwrap_or_default()
    }
}

/// The bytes that the rungs of a ladder without jumps and subprograms read and write. The
/// effect of such a rung depends only on these bytes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct RungDependencies {
    /// Index of the first operation of each rung, and the end of the last rung.
    starts: Vec<usize>,
    /// For each rung, the bytes of the memory array that it may write.
    writes: IndexLists,
    /// For each byte of the memory array, the rungs that read or write it.
    rungs_by_byte: IndexLists,
    /// For each operation index, the first rung that starts there or later; last the number
    /// of rungs.
    first_rung_from: Vec<u16>,
    /// For each rung, the number of rungs with a comparison before this rung; last the number
    /// of all.
    ///
    /// Comparisons also write R900. It is not part of the dependencies, because only the
    /// value of the last comparison remains.
    comparison_count_before: Vec<u16>,
}

impl RungDependencies {
    /// Creates the dependencies; `None` if the ladder has jumps or subprograms or uses
    /// R900.
    pub fn from_code(code: &Code, statements: &[Statement]) -> Option<RungDependencies> {
        let mut starts = Vec::new();
        let mut writes = Vec::new();
        let mut rungs_by_byte = vec![Vec::new(); SIZE];
        let mut first_rung_from = vec![0];
        let (mut comparisons, mut comparison_count_before) = (0, vec![0]);
        let mut first = 0;
        for (rung, rung_statements) in (0u16..).zip(statements.chunk_by(|a, b| a.rung == b.rung)) {
            let end = first + rung_statements.len();
            let mut bytes = RungBytes::default();
            for op in code.ops.get(first..end)? {
                bytes.add_operation(*op, &code.functions)?;
            }
            for at in bytes.reads.iter().chain(&bytes.writes) {
                rungs_by_byte.get_mut(usize::from(*at))?.push(rung);
            }
            comparisons += u16::from(bytes.compares);
            comparison_count_before.push(comparisons);
            first_rung_from.resize(end + 1, rung + 1);
            starts.push(first);
            writes.push(bytes.writes);
            first = end;
        }
        starts.push(first);
        if !rungs_by_byte.get(RESULT_FLAGS)?.is_empty() {
            return None;
        }
        Some(RungDependencies {
            starts,
            writes: IndexLists::from_lists(writes)?,
            rungs_by_byte: IndexLists::from_lists(rungs_by_byte)?,
            first_rung_from,
            comparison_count_before,
        })
    }

    /// Returns the number of rungs of the ladder.
    pub fn rung_count(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Returns the indices of the first operation of a rung and of the first operation after
    /// the rung.
    pub fn operation_range(&self, rung: usize) -> (usize, usize) {
        let at = |rung| self.starts.get(rung).copied().unwrap_or(0);
        (at(rung), at(rung + 1))
    }

    /// Returns the index of the first rung that starts at or after an operation index.
    pub fn first_rung_from(&self, operation: usize) -> usize {
        let rung = self.first_rung_from.get(operation).copied();
        rung.map_or(self.rung_count(), usize::from)
    }

    /// Returns the number of rungs with a comparison before the rung with this index.
    pub fn comparison_count_before(&self, rung: usize) -> usize {
        let before = self.comparison_count_before.get(rung);
        before.copied().map_or(self.comparison_count(), usize::from)
    }

    /// Returns the index of a rung among the rungs with a comparison; `None` if the rung has
    /// no comparison.
    pub fn comparison_index(&self, rung: usize) -> Option<usize> {
        let number = self.comparison_count_before(rung);
        (self.comparison_count_before(rung + 1) > number).then_some(number)
    }

    /// Returns the number of rungs with a comparison.
    pub fn comparison_count(&self) -> usize {
        self.comparison_count_before
            .last()
            .copied()
            .map_or(0, usize::from)
    }

    /// Returns the bytes of the memory array that a rung may write.
    pub fn written_bytes(&self, rung: usize) -> &[u16] {
        self.writes.get(rung)
    }

    /// Returns the rungs that read or write a byte of the memory array.
    pub fn rungs_using(&self, byte: usize) -> &[u16] {
        self.rungs_by_byte.get(byte)
    }
}

/// The bytes of memory that the operations of one rung read and write.
#[derive(Default)]
struct RungBytes {
    reads: Vec<u16>,
    writes: Vec<u16>,
    compares: bool,
}

impl RungBytes {
    /// Adds the bytes that an operation reads and writes; `None` for a jump, call or return.
    fn add_operation(&mut self, op: Op, functions: &[Function]) -> Option<()> {
        match op {
            Op::Ld(bit)
            | Op::Ldi(bit)
            | Op::And(bit)
            | Op::Ani(bit)
            | Op::Or(bit)
            | Op::Ori(bit) => self.reads.push(bit.at),
            Op::Out(bit) | Op::Set(bit) | Op::Rst(bit) => self.writes.push(bit.at),
            Op::Function(index) => self.add_function(functions.get(usize::from(index))?),
            Op::Jump(_) | Op::Call(_) | Op::Return => return None,
            Op::Orb | Op::Anb | Op::Nop => {}
        }
        Some(())
    }

    fn add_read(&mut self, value: OperandValue, length: u8) {
        if let OperandValue::Address(at) = value {
            self.reads.extend(byte_range(at, length));
        }
    }

    fn add_write(&mut self, at: u16, length: u8) {
        self.writes.extend(byte_range(at, length));
    }

    fn add_function(&mut self, function: &Function) {
        match function {
            Function::Compare {
                length, a, b, at, ..
            } => {
                self.add_read(*a, *length);
                self.add_read(*b, *length);
                self.writes.push(*at);
                self.compares = true;
            }
            Function::Timer {
                at,
                preset,
                output: bit,
                ..
            } => {
                self.add_read(*preset, 4);
                self.add_write(*at, 4);
                self.writes.push(bit.at);
            }
            Function::Counter {
                reset,
                at,
                preset,
                output: bit,
                ..
            } => {
                self.reads.push(reset.at);
                self.add_read(*preset, 4);
                self.add_write(*at, 4);
                self.writes.push(bit.at);
            }
            Function::Move { length, from, to } => {
                self.add_read(*from, *length);
                self.add_write(*to, *length);
            }
            Function::Decode {
                length, from, to, ..
            } => {
                self.add_read(*from, *length);
                self.writes.push(*to);
            }
            Function::Table {
                length, index, to, ..
            } => {
                self.reads.push(*index);
                self.add_write(*to, *length);
            }
            Function::Rotate {
                length,
                current,
                target,
                result,
                output: bit,
                ..
            } => {
                self.add_read(*current, *length);
                self.add_read(*target, *length);
                self.add_write(*result, *length);
                self.writes.push(bit.at);
            }
        }
    }
}

/// Returns the indices of the bytes of a value with `length` bytes (1, 2 or 4) at index `at`.
fn byte_range(at: u16, length: u8) -> core::ops::Range<u16> {
    let width = match length {
        1 | 2 => u16::from(length),
        _ => 4,
    };
    at..at.saturating_add(width)
}
