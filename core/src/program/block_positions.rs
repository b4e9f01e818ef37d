//! Stores the positions of blocks compactly: a program may have ten million blocks.
//!
//! Blocks form groups of 16. A group is close if each of its blocks is on the next line and
//! none is longer than 255 bytes. A close group stores its first position and a byte for
//! each step to the next block. Other groups store all positions.
//!
//! ```text
//! first      steps
//! byte line  18  17  21  17 …      its third block: byte + 18 + 17, line + 2
//! ```

/// Position of the first byte of a block in the text: byte, and line of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct BlockPosition {
    pub(super) byte: u32,
    pub(super) line: u32,
}

/// Number of blocks in a group of stored positions.
const GROUP_SIZE: usize = 16;

/// The positions of blocks, in the order of the text.
#[derive(Default)]
pub(super) struct BlockPositions {
    groups: Vec<PositionGroup>,
    /// The positions of all blocks in groups that are not close (see the module).
    wide: Vec<BlockPosition>,
    last: Option<BlockPosition>,
    count: usize,
    /// Position of the byte after the last block.
    end: u32,
}

#[derive(Clone, Copy)]
struct PositionGroup {
    first: BlockPosition,
    tail: GroupTail,
}

/// The positions of the blocks of a group after the first one.
#[derive(Clone, Copy)]
enum GroupTail {
    /// The group is close: bytes from each block to the next one, which is on the next line.
    Close([u8; GROUP_SIZE - 1]),
    /// The group is not close: index in `wide` of the first position of the group.
    Wide(u32),
}

/// The sum of the first `count` steps of a group. All bytes of a word are added at once,
/// because each block that is read needs its position.
#[inline]
fn sum_of_first(steps: &[u8; GROUP_SIZE - 1], count: usize) -> u32 {
    let mut words = [0; GROUP_SIZE];
    words[..GROUP_SIZE - 1].copy_from_slice(steps);
    let ([first, second], _) = words.as_chunks::<8>() else {
        return 0;
    };
    match count.checked_sub(8) {
        None => sum_of_bytes(u64::from_le_bytes(*first), count),
        Some(rest) => {
            sum_of_bytes(u64::from_le_bytes(*first), 8)
                + sum_of_bytes(u64::from_le_bytes(*second), rest)
        }
    }
}

/// The sum of the lowest `count` bytes of `word`, at most 8.
#[inline]
fn sum_of_bytes(word: u64, count: usize) -> u32 {
    const EVEN_BYTES: u64 = 0x00FF_00FF_00FF_00FF;
    // Shifts by 64 bits are not defined: two shifts.
    let counted = word << (4 * (8 - count)) << (4 * (8 - count));
    let pairs = (counted & EVEN_BYTES) + (counted >> 8 & EVEN_BYTES);
    (pairs.wrapping_mul(0x0001_0001_0001_0001) >> 48) as u32
}

impl PositionGroup {
    /// The position of the block with the index `within` (from 0) in the group; `None` if the
    /// group has no such block.
    #[inline]
    fn position(&self, within: usize, wide: &[BlockPosition]) -> Option<BlockPosition> {
        match &self.tail {
            GroupTail::Close(steps) => Some(BlockPosition {
                byte: self.first.byte + sum_of_first(steps, within),
                line: self.first.line + within as u32,
            }),
            GroupTail::Wide(from) => wide.get(*from as usize + within).copied(),
        }
    }
}

impl BlockPositions {
    /// Number of stored positions, one for each block.
    pub(super) const fn len(&self) -> usize {
        self.count
    }

    /// Adds the position of the next block of the text.
    pub(super) fn push(&mut self, position: BlockPosition) {
        let last = self.last.replace(position);
        let within = self.count % GROUP_SIZE;
        self.count += 1;
        let (Some(last), Some(group), 1..) = (last, self.groups.last_mut(), within) else {
            let rest = GroupTail::Close([0; GROUP_SIZE - 1]);
            self.groups.push(PositionGroup {
                first: position,
                tail: rest,
            });
            return;
        };
        let step = u8::try_from(position.byte - last.byte);
        match (&mut group.tail, step) {
            (GroupTail::Close(steps), Ok(step)) if position.line == last.line + 1 => {
                steps[within - 1] = step;
            }
            (GroupTail::Close(_), _) => {
                // The positions of the group so far move to `wide`.
                let from = self.wide.len() as u32;
                let before = (0..within).filter_map(|index| group.position(index, &[]));
                self.wide.extend(before);
                self.wide.push(position);
                group.tail = GroupTail::Wide(from);
            }
            (GroupTail::Wide(_), _) => self.wide.push(position),
        }
    }

    /// Sets the position of the byte after the last block, and releases the memory reserved for
    /// more positions.
    pub(super) fn finish(&mut self, end: u32) {
        self.end = end;
        self.groups.shrink_to_fit();
        self.wide.shrink_to_fit();
    }

    /// Position of the byte after the last block.
    pub(super) const fn end(&self) -> u32 {
        self.end
    }

    /// The position of the block with this index, from 0; `None` after the last block.
    #[inline]
    pub(super) fn get(&self, index: usize) -> Option<BlockPosition> {
        if index >= self.count {
            return None;
        }
        let group = self.groups.get(index / GROUP_SIZE)?;
        group.position(index % GROUP_SIZE, &self.wide)
    }

    /// The line of the block with this index, from 0; `None` after the last block.
    #[inline]
    pub(super) fn line(&self, index: usize) -> Option<u32> {
        if index >= self.count {
            return None;
        }
        let (group, within) = (self.groups.get(index / GROUP_SIZE)?, index % GROUP_SIZE);
        match group.tail {
            GroupTail::Close(_) => Some(group.first.line + within as u32),
            GroupTail::Wide(from) => self.wide.get(from as usize + within).map(|it| it.line),
        }
    }

    /// Number of bytes from the block with this index, from 0, to the next block, or to the end
    /// for the last one; 0 after the last block.
    #[inline]
    pub(super) fn length(&self, index: usize) -> u32 {
        if index + 1 < self.count
            && let Some(group) = self.groups.get(index / GROUP_SIZE)
            && let GroupTail::Close(steps) = &group.tail
            && let Some(step) = steps.get(index % GROUP_SIZE)
        {
            return u32::from(*step);
        }
        let end = self.get(index + 1).map_or(self.end, |next| next.byte);
        let begin = self.get(index).map_or(end, |place| place.byte);
        end.saturating_sub(begin)
    }

    /// Whether the block with this index, from 0, begins in the line of the block before it.
    #[inline]
    pub(super) fn continues_line(&self, index: usize) -> bool {
        let group = self.groups.get(index / GROUP_SIZE);
        let is_close = group.is_some_and(|it| matches!(it.tail, GroupTail::Close(_)));
        if is_close && !index.is_multiple_of(GROUP_SIZE) {
            return false;
        }
        let line = self.line(index);
        line.is_some() && index.checked_sub(1).and_then(|it| self.line(it)) == line
    }

    /// The position of the last block; `None` without blocks.
    pub(super) const fn last(&self) -> Option<BlockPosition> {
        self.last
    }

    /// Index of the first block in this line or after it; the number of blocks if there is
    /// none.
    pub(super) fn first_at(&self, line: u32) -> usize {
        let groups = self.groups.partition_point(|group| group.first.line < line);
        // It is in the group before the first group that begins late enough, or is the first
        // block of that group.
        let from = groups.saturating_sub(1) * GROUP_SIZE;
        let to = (groups * GROUP_SIZE).min(self.count);
        let (mut low, mut high) = (from, to);
        while low < high {
            let middle = low.midpoint(high);
            match self.line(middle).is_some_and(|at| at < line) {
                true => low = middle + 1,
                false => high = middle,
            }
        }
        low
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Positions as in usual texts: mostly one block per line, sometimes several, long
    /// blocks, and lines without blocks.
    fn sample_positions(count: u32, seed: u32) -> Vec<BlockPosition> {
        let mut state = seed;
        let mut place = BlockPosition { byte: 3, line: 1 };
        let mut places = Vec::new();
        for _ in 0..count {
            places.push(place);
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let (bytes, lines) = match state >> 24 {
                0 => (700, 1),
                1 => (9, 0),
                2 => (30, 3),
                draw => (1 + draw, 1),
            };
            place.byte += bytes;
            place.line += lines;
        }
        places
    }

    #[test]
    fn positions_are_stored_exactly() {
        for (count, seed) in [(0, 1), (1, 1), (64, 2), (65, 3), (5000, 4), (777, 5)] {
            let expected = sample_positions(count, seed);
            let mut places = BlockPositions::default();
            expected.iter().for_each(|place| places.push(*place));
            let end = expected.last().map_or(0, |place| place.byte + 9);
            places.finish(end);
            assert_eq!(places.len(), expected.len());
            assert_eq!(places.last(), expected.last().copied());
            for index in 0..expected.len() + 2 {
                let place = expected.get(index).copied();
                assert_eq!(places.get(index), place, "{index} of {count}");
                assert_eq!(places.line(index), place.map(|place| place.line));
                let next = expected.get(index + 1).map_or(end, |next| next.byte);
                let length = place.map_or(0, |place| next - place.byte);
                assert_eq!(places.length(index), length, "{index} of {count}");
                let before = index.checked_sub(1).and_then(|it| expected.get(it));
                let continues = place
                    .is_some_and(|place| before.is_some_and(|before| before.line == place.line));
                assert_eq!(
                    places.continues_line(index),
                    continues,
                    "{index} of {count}"
                );
            }
            let last_line = expected.last().map_or(2, |place| place.line + 2);
            for line in 0..=last_line {
                let first = expected.partition_point(|place| place.line < line);
                assert_eq!(places.first_at(line), first, "line {line} of {count}");
            }
        }
    }

    #[test]
    fn a_block_a_line_takes_a_byte_and_a_half() {
        let mut places = BlockPositions::default();
        for block in 0..6400 {
            let (byte, line) = (block * 20, block + 1);
            places.push(BlockPosition { byte, line });
        }
        assert!(places.wide.is_empty());
        assert_eq!(places.groups.len() * size_of::<PositionGroup>(), 9600);
    }
}
