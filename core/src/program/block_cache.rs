//! Caches parsed blocks: those of loops and subprograms are executed repeatedly, but parsed
//! once.

use super::block::ProgramBlock;
use super::program_text::{Program, TextIdentity};
use super::syntax::{BlockError, Syntax};

/// Number of cached blocks: more than a loop or a short subprogram has.
const CACHED_BLOCKS: u32 = 64;
/// Number of cache entries between the first blocks of two programs with consecutive numbers.
const PROGRAM_DISTANCE: u32 = 29;

/// Parsed blocks, each in an entry computed from its program number and its index. Cloning
/// yields an empty cache.
#[derive(Debug, Default)]
pub(crate) struct BlockCache {
    entries: Vec<CachedBlock>,
    work: u64,
}

/// Bytes of parsed text that count as the work of reading one block.
const BYTES_PER_BLOCK: usize = 64;

#[derive(Clone, Debug, Default)]
struct CachedBlock {
    program: TextIdentity,
    /// Index of the block in its program, from 0; `None` if the entry has no valid block.
    index: Option<u32>,
    syntax: Syntax,
    block: ProgramBlock,
}

impl BlockCache {
    /// Returns a block, from the cache or parsed now; its words may still refer to variables.
    ///
    /// # Errors
    /// As [`Program::parse_with_variables`].
    pub(crate) fn read(
        &mut self,
        program: &Program,
        index: u32,
        syntax: Syntax,
    ) -> Result<&ProgramBlock, BlockError> {
        if self.entries.is_empty() {
            self.entries
                .resize(CACHED_BLOCKS as usize, CachedBlock::default());
        }
        let begin = u32::from(program.number().unwrap_or(0)).wrapping_mul(PROGRAM_DISTANCE);
        let entry = index.wrapping_add(begin) % CACHED_BLOCKS;
        let kept = &mut self.entries[entry as usize];
        self.work += 1;
        let same = program.has_identity(&kept.program);
        if same && kept.index == Some(index) && kept.syntax == syntax {
            return Ok(&kept.block);
        }
        kept.index = None;
        self.work += (program.block_length(index) / BYTES_PER_BLOCK) as u64;
        program.read(index, syntax, &mut kept.block)?;
        if !same {
            kept.program = program.identity();
        }
        (kept.index, kept.syntax) = (Some(index), syntax);
        Ok(&kept.block)
    }

    /// Counts the work of a block whose words were read elsewhere, from the length of its text
    /// in bytes.
    pub(crate) const fn count_block(&mut self, length: usize) {
        self.work += 1 + (length / BYTES_PER_BLOCK) as u64;
    }

    /// Number of blocks requested so far, plus one for each 64 bytes of parsed text.
    pub(crate) const fn work(&self) -> u64 {
        self.work
    }
}

impl Clone for BlockCache {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// Two caches are always equal: their content does not change the result of a read.
impl PartialEq for BlockCache {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_those_of_their_program_and_syntax() {
        let first = Program::new("O1;\nG01 X1.2345 Z2;\nX;\n");
        let second = Program::new("O1;\nG01 X7.5;\nG01 XX;\n");
        let metric = Syntax::default();
        let inch = Syntax {
            inch: true,
            ..metric
        };
        let mut recent = BlockCache::default();
        for _ in 0..2 {
            for program in [&first, &second] {
                for syntax in [metric, inch] {
                    for index in 0..4 {
                        let expected = program.parse(index, syntax);
                        for _ in 0..2 {
                            let read = recent.read(program, index, syntax).cloned();
                            assert_eq!(read, expected, "{index}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn a_program_is_not_kept_alive() {
        let mut recent = BlockCache::default();
        let syntax = Syntax::default();
        for number in 0..300 {
            // A new text may have the address of the previous one.
            let program = Program::new(format!("G01 X{number};\n"));
            let read = recent.read(&program, 0, syntax).expect("a block");
            assert_eq!(read, &program.parse(0, syntax).expect("a block"));
            assert_eq!(program.text_references(), 1);
        }
    }
}
