//! Where blocks begin, kept small: a program of ten million blocks has ten million places.
//!
//! Blocks stand in groups of 16. Of a group whose blocks stand one on a line, none longer
//! than 255 bytes, only its first place is kept and a byte for each step from one block to
//! the next; of any other group every place.
//!
//! ```text
//! first      steps
//! byte line  18  17  21  17 …      its third block: byte + 18 + 17, line + 2
//! ```

/// Where a block begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) byte: u32,
    pub(super) line: u32,
}

/// Blocks of a group.
const GROUP: usize = 16;

/// The places of blocks, in the order of the text.
#[derive(Default)]
pub(super) struct Places {
    groups: Vec<Group>,
    /// The places of groups that are not close.
    wide: Vec<Place>,
    last: Option<Place>,
    count: usize,
}

#[derive(Clone, Copy)]
struct Group {
    first: Place,
    rest: Rest,
}

/// The blocks of a group after its first one.
#[derive(Clone, Copy)]
enum Rest {
    /// Bytes from block to block, each on the next line.
    Close([u8; GROUP - 1]),
    /// All places of the group are kept, from this one on.
    Wide(u32),
}

impl Group {
    /// The place of one of its blocks.
    #[inline]
    fn place(&self, within: usize, wide: &[Place]) -> Option<Place> {
        match &self.rest {
            Rest::Close(steps) => {
                let steps = steps.get(..within)?;
                Some(Place {
                    byte: self.first.byte + steps.iter().map(|step| u32::from(*step)).sum::<u32>(),
                    line: self.first.line + within as u32,
                })
            }
            Rest::Wide(from) => wide.get(*from as usize + within).copied(),
        }
    }
}

impl Places {
    /// How many there are.
    pub(super) const fn len(&self) -> usize {
        self.count
    }

    /// Adds the next one.
    pub(super) fn push(&mut self, place: Place) {
        let last = self.last.replace(place);
        let within = self.count % GROUP;
        self.count += 1;
        let (Some(last), Some(group), 1..) = (last, self.groups.last_mut(), within) else {
            let rest = Rest::Close([0; GROUP - 1]);
            self.groups.push(Group { first: place, rest });
            return;
        };
        let step = u8::try_from(place.byte - last.byte);
        match (&mut group.rest, step) {
            (Rest::Close(steps), Ok(step)) if place.line == last.line + 1 => {
                steps[within - 1] = step;
            }
            (Rest::Close(_), _) => {
                // What was close so far is kept place by place from now on.
                let from = self.wide.len() as u32;
                let before = (0..within).filter_map(|index| group.place(index, &[]));
                self.wide.extend(before);
                self.wide.push(place);
                group.rest = Rest::Wide(from);
            }
            (Rest::Wide(_), _) => self.wide.push(place),
        }
    }

    /// Gives back what was taken for more places to come.
    pub(super) fn shrink_to_fit(&mut self) {
        self.groups.shrink_to_fit();
        self.wide.shrink_to_fit();
    }

    /// The place of a block.
    #[inline]
    pub(super) fn get(&self, index: usize) -> Option<Place> {
        if index >= self.count {
            return None;
        }
        let group = self.groups.get(index / GROUP)?;
        group.place(index % GROUP, &self.wide)
    }

    /// The line of a block.
    #[inline]
    pub(super) fn line(&self, index: usize) -> Option<u32> {
        if index >= self.count {
            return None;
        }
        let (group, within) = (self.groups.get(index / GROUP)?, index % GROUP);
        match group.rest {
            Rest::Close(_) => Some(group.first.line + within as u32),
            Rest::Wide(from) => self.wide.get(from as usize + within).map(|it| it.line),
        }
    }

    /// All of them in order.
    pub(super) fn iter(&self) -> impl Iterator<Item = Place> {
        let mut before = None;
        (0..self.count).filter_map(move |index| {
            let (group, within) = (self.groups.get(index / GROUP)?, index % GROUP);
            let place = match (&group.rest, before) {
                (Rest::Close(steps), Some(Place { byte, line })) if within > 0 => Place {
                    byte: byte + u32::from(*steps.get(within - 1)?),
                    line: line + 1,
                },
                _ => group.place(within, &self.wide)?,
            };
            before = Some(place);
            Some(place)
        })
    }

    /// The last place.
    pub(super) const fn last(&self) -> Option<Place> {
        self.last
    }

    /// The first block in this line or after it; how many there are, after the last one.
    pub(super) fn first_at(&self, line: u32) -> usize {
        let groups = self.groups.partition_point(|group| group.first.line < line);
        // It is in the group before the first one that begins late enough, or begins that.
        let from = groups.saturating_sub(1) * GROUP;
        let to = (groups * GROUP).min(self.count);
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

    /// Places as they are met in texts: mostly one a line, now and then several on one,
    /// long ones, and lines without.
    fn some(count: u32, seed: u32) -> Vec<Place> {
        let mut state = seed;
        let mut place = Place { byte: 3, line: 1 };
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
    fn places_come_back_as_they_were_put_in() {
        for (count, seed) in [(0, 1), (1, 1), (64, 2), (65, 3), (5000, 4), (777, 5)] {
            let expected = some(count, seed);
            let mut places = Places::default();
            expected.iter().for_each(|place| places.push(*place));
            places.shrink_to_fit();
            assert_eq!(places.len(), expected.len());
            assert_eq!(places.last(), expected.last().copied());
            assert_eq!(places.iter().collect::<Vec<_>>(), expected);
            for index in 0..expected.len() + 2 {
                let place = expected.get(index).copied();
                assert_eq!(places.get(index), place, "{index} of {count}");
                assert_eq!(places.line(index), place.map(|place| place.line));
            }
            let end = expected.last().map_or(2, |place| place.line + 2);
            for line in 0..=end {
                let first = expected.partition_point(|place| place.line < line);
                assert_eq!(places.first_at(line), first, "line {line} of {count}");
            }
        }
    }

    #[test]
    fn a_block_a_line_takes_a_byte_and_a_half() {
        let mut places = Places::default();
        for block in 0..6400 {
            let (byte, line) = (block * 20, block + 1);
            places.push(Place { byte, line });
        }
        assert!(places.wide.is_empty());
        assert_eq!(places.groups.len() * size_of::<Group>(), 9600);
    }
}
