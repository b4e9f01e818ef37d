//! What each rung reads and writes: the rungs that a changed byte concerns.

use crate::code::{Code, Function, Op, Value};
use crate::instruction::Statement;
use crate::memory::{RESULT_FLAGS, SIZE};

/// Numbers of rungs or bytes, listed for each byte or rung.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Lists {
    /// Where the list of each begins in `members`, and where the last one ends.
    begins: Vec<u16>,
    members: Vec<u16>,
}

impl Lists {
    fn of(lists: impl IntoIterator<Item = Vec<u16>>) -> Option<Lists> {
        let mut all = Lists {
            begins: vec![0],
            members: Vec::new(),
        };
        for mut list in lists {
            list.sort_unstable();
            list.dedup();
            all.members.append(&mut list);
            all.begins.push(u16::try_from(all.members.len()).ok()?);
        }
        Some(all)
    }

    fn get(&self, of: usize) -> &[u16] {
        let bounds = (self.begins.get(of), self.begins.get(of + 1));
        let (Some(begin), Some(end)) = bounds else {
            return &[];
        };
        let range = usize::from(*begin)..usize::from(*end);
        self.members.get(range).unwrap_or_default()
    }
}

/// The rungs of a ladder that runs straight on, without jumps and subprograms: each is a
/// function of the bytes it reads or writes, and of nothing else.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Reach {
    /// First operation of each rung, and the end of the last one.
    begins: Vec<usize>,
    /// Bytes of flat memory that a rung may write.
    writes: Lists,
    /// Rungs that read or write a byte of flat memory.
    concerned: Lists,
    /// The first rung that begins at each operation or after it, and the number of rungs.
    rung_from: Vec<u16>,
    /// How many of the rungs before each have a comparison, and how many of all. Each
    /// comparison leaves its result bits in R900, which is none of their bytes: what it
    /// holds in the end is the last one's.
    comparisons_before: Vec<u16>,
}

impl Reach {
    /// `None` for a ladder with jumps or subprograms, or that uses R900 itself.
    pub fn of(code: &Code, statements: &[Statement]) -> Option<Reach> {
        let mut begins = Vec::new();
        let mut writes = Vec::new();
        let mut concerned = vec![Vec::new(); SIZE];
        let mut rung_from = vec![0];
        let (mut comparisons, mut comparisons_before) = (0, vec![0]);
        let mut first = 0;
        for (rung, rung_statements) in (0u16..).zip(statements.chunk_by(|a, b| a.rung == b.rung)) {
            let end = first + rung_statements.len();
            let mut bytes = Bytes::default();
            for op in code.ops.get(first..end)? {
                bytes.of(*op, &code.functions)?;
            }
            for at in bytes.reads.iter().chain(&bytes.writes) {
                concerned.get_mut(usize::from(*at))?.push(rung);
            }
            comparisons += u16::from(bytes.compares);
            comparisons_before.push(comparisons);
            rung_from.resize(end + 1, rung + 1);
            begins.push(first);
            writes.push(bytes.writes);
            first = end;
        }
        begins.push(first);
        if !concerned.get(RESULT_FLAGS)?.is_empty() {
            return None;
        }
        Some(Reach {
            begins,
            writes: Lists::of(writes)?,
            concerned: Lists::of(concerned)?,
            rung_from,
            comparisons_before,
        })
    }

    /// Number of rungs.
    pub fn rungs(&self) -> usize {
        self.begins.len().saturating_sub(1)
    }

    /// Operations of a rung.
    pub fn operations(&self, rung: usize) -> (usize, usize) {
        let at = |rung| self.begins.get(rung).copied().unwrap_or(0);
        (at(rung), at(rung + 1))
    }

    /// The first rung that begins at an operation or after it.
    pub fn rung_from(&self, operation: usize) -> usize {
        let rung = self.rung_from.get(operation).copied();
        rung.map_or(self.rungs(), usize::from)
    }

    /// How many of the rungs before one have a comparison.
    pub fn comparisons_before(&self, rung: usize) -> usize {
        let before = self.comparisons_before.get(rung);
        before.copied().map_or(self.comparisons(), usize::from)
    }

    /// Which of the rungs with a comparison it is, from 0; `None`: it has none.
    pub fn comparison(&self, rung: usize) -> Option<usize> {
        let number = self.comparisons_before(rung);
        (self.comparisons_before(rung + 1) > number).then_some(number)
    }

    /// How many rungs have a comparison.
    pub fn comparisons(&self) -> usize {
        self.comparisons_before
            .last()
            .copied()
            .map_or(0, usize::from)
    }

    /// Bytes of flat memory that a rung may write.
    pub fn writes(&self, rung: usize) -> &[u16] {
        self.writes.get(rung)
    }

    /// Rungs that read or write a byte of flat memory.
    pub fn concerned(&self, byte: usize) -> &[u16] {
        self.concerned.get(byte)
    }
}

/// Bytes that the operations of one rung read and write.
#[derive(Default)]
struct Bytes {
    reads: Vec<u16>,
    writes: Vec<u16>,
    compares: bool,
}

impl Bytes {
    /// `None`: the operation leads elsewhere.
    fn of(&mut self, op: Op, functions: &[Function]) -> Option<()> {
        match op {
            Op::Ld(bit)
            | Op::Ldi(bit)
            | Op::And(bit)
            | Op::Ani(bit)
            | Op::Or(bit)
            | Op::Ori(bit) => self.reads.push(bit.at),
            Op::Out(bit) | Op::Set(bit) | Op::Rst(bit) => self.writes.push(bit.at),
            Op::Function(index) => self.function(functions.get(usize::from(index))?),
            Op::Jump(_) | Op::Call(_) | Op::Return => return None,
            Op::Orb | Op::Anb | Op::Mark => {}
        }
        Some(())
    }

    fn read(&mut self, value: Value, length: u8) {
        if let Value::At(at) = value {
            self.reads.extend(wide(at, length));
        }
    }

    fn write(&mut self, at: u16, length: u8) {
        self.writes.extend(wide(at, length));
    }

    fn function(&mut self, function: &Function) {
        match function {
            Function::Compare {
                length, a, b, at, ..
            } => {
                self.read(*a, *length);
                self.read(*b, *length);
                self.writes.push(*at);
                self.compares = true;
            }
            Function::Timer {
                at,
                preset,
                output: bit,
                ..
            } => {
                self.read(*preset, 4);
                self.write(*at, 4);
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
                self.read(*preset, 4);
                self.write(*at, 4);
                self.writes.push(bit.at);
            }
            Function::Move { length, from, to } => {
                self.read(*from, *length);
                self.write(*to, *length);
            }
            Function::Decode {
                length, from, to, ..
            } => {
                self.read(*from, *length);
                self.writes.push(*to);
            }
            Function::Table {
                length, index, to, ..
            } => {
                self.reads.push(*index);
                self.write(*to, *length);
            }
            Function::Rotate {
                length,
                current,
                target,
                result,
                output: bit,
                ..
            } => {
                self.read(*current, *length);
                self.read(*target, *length);
                self.write(*result, *length);
                self.writes.push(bit.at);
            }
        }
    }
}

/// The bytes of a value of one, two or four bytes.
fn wide(at: u16, length: u8) -> core::ops::Range<u16> {
    let width = match length {
        1 | 2 => u16::from(length),
        _ => 4,
    };
    at..at.saturating_add(width)
}
