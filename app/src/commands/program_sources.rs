//! Finds out which programs of a control come from which file.

use std::path::{Path, PathBuf};

use gsk_core::command::ProgramId;
use gsk_core::model::ProgramNaming;
use gsk_core::program::{Program, ProgramMemory, split_programs};
use gsk_debugger::source_files::{ProgramSource, ProgramSources};
use gsk_host::files::{program_file, subprograms};

/// The files of the programs in a memory that [`gsk_host::loading::open_program`] has filled:
/// the main program's first, then those of the command line, then those of its folder.
pub fn find_sources(memory: &ProgramMemory, files: &[PathBuf]) -> ProgramSources {
    let mut sources = Vec::new();
    let mut remaining: Vec<u16> = memory.iter().map(|(number, _)| number).collect();
    for (index, path) in files.iter().enumerate() {
        let mut programs: Vec<ProgramId> = Vec::new();
        if index == 0 {
            programs.push(ProgramId::External);
        }
        for number in read_numbers(path) {
            if remaining.contains(&number) {
                remaining.retain(|other| *other != number);
                programs.push(ProgramId::Stored(number));
            }
        }
        sources.push(source_file(path, programs));
    }
    let in_folder = files.first().map(|main| subprograms::index_folder(main));
    for (number, path) in in_folder.into_iter().flatten() {
        if remaining.contains(&number) {
            sources.push(source_file(&path, vec![ProgramId::Stored(number)]));
        }
    }
    ProgramSources::new(sources)
}

fn source_file(path: &Path, programs: Vec<ProgramId>) -> ProgramSource {
    ProgramSource {
        path: path.display().to_string(),
        programs,
    }
}

/// The numbers of the programs in a file; a program without O word has the number in the name
/// of the file.
fn read_numbers(path: &Path) -> Vec<u16> {
    let Ok(file) = program_file::read(path) else {
        return Vec::new();
    };
    let programs = split_programs(file.text);
    let in_name = subprograms::parse_number_in_name(path);
    let numbers = programs.iter().map(Program::number);
    numbers.filter_map(|number| number.or(in_name)).collect()
}

/// The name of a program for people: as the control model writes it, or its file.
pub fn program_name(program: ProgramId, naming: ProgramNaming, sources: &ProgramSources) -> String {
    match program {
        ProgramId::Stored(number) => naming.name(number),
        ProgramId::Mdi => "MDI".to_owned(),
        ProgramId::Dnc => "DNC".to_owned(),
        ProgramId::External => {
            let file = sources.file_of(program);
            file.map_or_else(String::new, |file| file.path.clone())
        }
    }
}
