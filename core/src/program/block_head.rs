//! Reads the beginning of a block: skip mark, program name, sequence number.

use super::lexer::Lexer;

/// The words at the beginning of a block: `/`, O and N, the latter two in any order.
#[derive(Default)]
pub(super) struct BlockHead {
    pub(super) o: Option<u16>,
    pub(super) n: Option<u32>,
    /// Whether the block begins with `/`.
    pub(super) skip: bool,
    /// Byte range of the O word.
    pub(super) o_span: Option<(usize, usize)>,
    /// Whether the name begins with `:` instead of O, as on other controls.
    pub(super) colon: bool,
}

impl BlockHead {
    /// Whether a block names a program. For most blocks the first byte rules that out: an N
    /// word cannot be before a name.
    pub(super) fn names_program(text: &str) -> bool {
        let other_word = matches!(text.as_bytes().first(), Some(b'A'..=b'N' | b'P'..=b'Z'));
        !other_word && Self::read(text).o.is_some()
    }

    /// Reads the start of a block.
    pub(super) fn read(text: &str) -> Self {
        let mut head = Self::default();
        let mut lexer = Lexer::new(text);
        loop {
            if lexer.skip_blanks().is_err() {
                return head;
            }
            let start = lexer.at;
            let (byte, len) = lexer.peek();
            lexer.at += len;
            match byte {
                b'/' if head.o.is_none() && head.n.is_none() => head.skip = true,
                b'O' | b'o' | b':' if head.o.is_none() => {
                    head.colon = byte == b':';
                    head.o =
                        read_number_up_to(&mut lexer, 9999).and_then(|it| u16::try_from(it).ok());
                    head.o_span = head.o.map(|_| (start, lexer.at));
                    if head.o.is_none() {
                        return head;
                    }
                }
                b'N' | b'n' if head.n.is_none() => {
                    head.n = read_number_up_to(&mut lexer, LAST_SEQUENCE);
                    return head;
                }
                _ => return head,
            }
        }
    }
}

/// The greatest sequence number of any control model.
const LAST_SEQUENCE: u32 = 99_999;

/// Reads an unsigned number; `None` above `most`.
fn read_number_up_to(lexer: &mut Lexer<'_>, most: u32) -> Option<u32> {
    lexer.skip_blanks().ok()?;
    let mut value = None;
    while let (byte @ b'0'..=b'9', len) = lexer.peek() {
        lexer.at += len;
        let next = value.unwrap_or(0) * 10 + u32::from(byte - b'0');
        if next > most {
            return None;
        }
        value = Some(next);
    }
    value
}
