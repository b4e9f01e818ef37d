//! Renumbers a block and all references to it.

use gsk_core::model::{GCode, ModelId};
use gsk_messages::{Message, say};

use crate::reference_target::ReferenceTarget;
use crate::references::{CursorTarget, references_to, target_at};
use crate::structure::{NumberedBlock, Structure};
use crate::text::{Position, TextChange, TextDocument, TextRange};

/// Returns the range of the number that a rename at a position would change: the number of a
/// block, or a reference to a block. `None` if neither is there.
pub fn renamable(structure: &Structure, at: Position) -> Option<TextRange> {
    match target_at(structure, at)? {
        CursorTarget::Block(block) => Some(block.digits.clone()),
        CursorTarget::Reference(reference) => {
            let references = !structure.referenced_blocks(reference).is_empty();
            references.then(|| reference.digits.clone())
        }
        CursorTarget::Program(_) | CursorTarget::Loop(_) => None,
    }
}

/// Returns the edits that renumber the block at a position, or the block that the word there
/// refers to, with all references. `name` is the new number. `outside` lists block numbers
/// that P of M99 in programs of other files refers to.
///
/// # Errors
///
/// Returns a message if the change is impossible or could alter what the program does.
pub fn rename(
    text: &TextDocument,
    structure: &Structure,
    at: Position,
    name: &str,
    (outside, model): (&[u16], ModelId),
) -> Result<Vec<TextChange>, Message> {
    let block = block_at(structure, at)?;
    let number = new_number(name).ok_or_else(|| say::rename_no_number(name))?;
    if let Some(there) = structure.blocks_in_part(number, block.part).next()
        && there != block
    {
        return Err(say::rename_exists(number, there.digits.line + 1));
    }
    check_targets_known(structure, outside, model)?;
    if structure.blocks_in_part(block.number, block.part).count() > 1 {
        return Err(say::number_of_several_blocks(block.number));
    }
    let mut ranges = vec![&block.digits];
    for reference in references_to(structure, block) {
        if structure.referenced_blocks(reference).len() > 1 {
            let line = reference.digits.line + 1;
            return Err(say::lead_to_several(line));
        }
        ranges.push(&reference.digits);
    }
    let edits = ranges.into_iter();
    Ok(edits
        .map(|it| TextChange::replace(it, written(number, text, it)))
        .collect())
}

/// The block at a position, or the block that the word there refers to. Returns a message if
/// there is none or more than one.
fn block_at(structure: &Structure, at: Position) -> Result<&NumberedBlock, Message> {
    match target_at(structure, at) {
        Some(CursorTarget::Block(block)) => Ok(block),
        Some(CursorTarget::Reference(reference)) => {
            match structure.referenced_blocks(reference)[..] {
                [block] => Ok(block),
                [] => Err(say::lead_to_nothing(reference.digits.line + 1)),
                _ => Err(say::lead_to_several(reference.digits.line + 1)),
            }
        }
        _ => Err(say::rename_nothing()),
    }
}

/// Parses a new sequence number: `N100`, `n 100` or `100`; `None` if it is invalid.
fn new_number(name: &str) -> Option<u16> {
    let name = name.trim().trim_start_matches(['N', 'n']).trim();
    let digits = !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_digit());
    let number = digits.then(|| name.parse::<u16>().ok())?;
    number.filter(|number| *number <= 9999)
}

/// Formats a number with as many digits, by leading zeros, as the number at `range`.
pub(crate) fn written(number: u16, text: &TextDocument, range: &TextRange) -> String {
    let line = text.line(range.line);
    let before = line
        .get(range.from as usize..range.to as usize)
        .unwrap_or("");
    match before.starts_with('0') {
        true => format!("{number:0width$}", width = before.len()),
        false => number.to_string(),
    }
}

/// Checks that the text alone determines the target of every reference.
///
/// # Errors
///
/// Returns a message about the reference whose target is uncertain.
pub(crate) fn check_targets_known(
    structure: &Structure,
    outside: &[u16],
    model: ModelId,
) -> Result<(), Message> {
    // Huaxing: N after a code is a block, a subprogram or a repeat count.
    let counted = model.record().g.values();
    if counted
        .into_iter()
        .any(|it| *it == GCode::RepeatAndComeBack)
    {
        return Err(say::numbers_of_model(model.name()));
    }
    let computed = structure
        .references
        .iter()
        .find(|reference| reference.target == ReferenceTarget::Computed);
    if let Some(reference) = computed {
        return Err(say::lead_computed(reference.digits.line + 1));
    }
    if let Some(number) = outside.first() {
        return Err(say::lead_from_outside(number));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_messages::Id;

    const TEXT: &str = "O0001\nG71 P10 Q0020\nN0010 G00 X20\nN20 G01 Z-30\nG70 P10 Q20\nN30 M30\n";

    fn renamed(text: &str, line: u32, byte: u32, name: &str) -> Result<String, Id> {
        let mut text = TextDocument::new(text);
        let structure = Structure::read(&text);
        let at = Position { line, byte };
        let edits = rename(&text, &structure, at, name, (&[], ModelId::Gsk980td));
        text.apply_all(&edits.map_err(|message| message.id())?);
        Ok(text.as_str().to_owned())
    }

    #[test]
    fn a_number_changes_at_its_block_and_wherever_it_is_named() {
        let wanted = "O0001\nG71 P100 Q0020\nN0100 G00 X20\nN20 G01 Z-30\nG70 P100 Q20\nN30 M30\n";
        for (line, byte) in [(2, 2), (1, 5), (4, 6)] {
            assert_eq!(renamed(TEXT, line, byte, "N100").as_deref(), Ok(wanted));
        }
        let structure = Structure::read(&TextDocument::new(TEXT));
        let range = renamable(&structure, Position { line: 2, byte: 0 });
        assert_eq!(range.map(|it| (it.from, it.to)), Some((1, 5)));
        assert_eq!(renamable(&structure, Position { line: 2, byte: 8 }), None);
    }

    #[test]
    fn what_would_change_the_program_is_refused() {
        assert_eq!(renamed(TEXT, 2, 2, "20"), Err(Id::RenameExists));
        assert_eq!(renamed(TEXT, 2, 2, "N10000"), Err(Id::RenameNoNumber));
        assert_eq!(renamed(TEXT, 2, 8, "5"), Err(Id::RenameNothing));
        let twice = "N10 G0 X1\nN10 G0 X2\nM30\n";
        assert_eq!(renamed(twice, 0, 1, "5"), Err(Id::NumberOfSeveralBlocks));
        let computed = "N10 G0 X1\nGOTO #1\n";
        assert_eq!(renamed(computed, 0, 1, "5"), Err(Id::LeadComputed));
        assert_eq!(renamed("G71 P10 Q20\n", 0, 5, "5"), Err(Id::LeadToNothing));
        assert_eq!(
            renamed("N10 G0 X1\n", 0, 1, "10"),
            Ok("N10 G0 X1\n".to_owned())
        );
    }
}
