//! Which programs of the control come from which file.

use gsk_core::command::ProgramId;
use gsk_core::program::ProgramMemory;

/// A program file, and the programs of the control that come from it. The lines of a program
/// have the numbers that they have in the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramSource {
    /// The path of the file as the user wrote it.
    pub path: String,
    /// The programs that the control took from the file.
    pub programs: Vec<ProgramId>,
}

/// The files that the programs of a control come from, the main program's file first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ProgramSources(Vec<ProgramSource>);

impl ProgramSources {
    /// Uses these files; the first one contains the main program.
    pub const fn new(files: Vec<ProgramSource>) -> Self {
        Self(files)
    }

    /// All files, the main program's first.
    pub fn files(&self) -> &[ProgramSource] {
        &self.0
    }

    /// The file that contains a program; `None` for a program without a file.
    pub fn file_of(&self, program: ProgramId) -> Option<&ProgramSource> {
        self.0.iter().find(|file| file.programs.contains(&program))
    }

    /// Finds a file by its path or by the end of its path: `shaft.CNC` finds `a/shaft.CNC`.
    pub fn find(&self, name: &str) -> Option<&ProgramSource> {
        let exact = self.0.iter().find(|file| file.path == name);
        exact.or_else(|| {
            self.0.iter().find(|file| {
                let head = file.path.strip_suffix(name);
                head.is_some_and(|head| head.ends_with(['/', '\\']))
            })
        })
    }
}

/// The line of the first block at or after a line of one of `programs`, with its program;
/// `None` if no block follows.
pub fn find_block_line(
    memory: &ProgramMemory,
    programs: &[ProgramId],
    line: u32,
) -> Option<(ProgramId, u32)> {
    let candidates = programs.iter().filter_map(|id| {
        let text = memory.get(*id)?;
        let block = text.block_from_line(line);
        (block < text.block_count()).then(|| (*id, text.block_line(block)))
    });
    candidates.min_by_key(|(_, block_line)| *block_line)
}
