//! The start of a block: skip mark, program name, sequence number.

use super::lexer::Lexer;

/// What stands at the start of a block: `/`, O and N, in any order of the two.
#[derive(Default)]
pub(super) struct Head {
    pub(super) o: Option<u16>,
    pub(super) n: Option<u32>,
    /// Whether it begins with `/`.
    pub(super) skip: bool,
    /// Byte range of the O word.
    pub(super) o_span: Option<(usize, usize)>,
    /// Whether a `:` stands for O, as on other controls.
    pub(super) colon: bool,
}

impl Head {
    /// Whether a block names a program. The first byte of most says that they do not: a
    /// number of the block stands before no name.
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
                    head.o = number(&mut lexer, 9999).and_then(|it| u16::try_from(it).ok());
                    head.o_span = head.o.map(|_| (start, lexer.at));
                    if head.o.is_none() {
                        return head;
                    }
                }
                b'N' | b'n' if head.n.is_none() => {
                    head.n = number(&mut lexer, LAST_SEQUENCE);
                    return head;
                }
                _ => return head,
            }
        }
    }
}

/// The greatest number of a block of any model.
const LAST_SEQUENCE: u32 = 99_999;

/// An unsigned number up to the greatest one.
fn number(lexer: &mut Lexer<'_>, most: u32) -> Option<u32> {
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
