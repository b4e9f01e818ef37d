//! Reads the beginning of a block: skip mark, program name, sequence number.

use super::lexer::Lexer;

/// The start of a block: the skip mark `/`, the O word and the N word, in this order.
#[derive(Default)]
pub(super) struct BlockHead {
    pub(super) o: Option<u16>,
    pub(super) n: Option<u32>,
    /// Whether the block begins with the skip mark `/`.
    pub(super) skip: bool,
    /// Byte range of the O word in the text of the block; `None` without an O word.
    pub(super) o_span: Option<(usize, usize)>,
    /// Whether the program name begins with `:` instead of O, as on other controls.
    pub(super) colon: bool,
}

impl BlockHead {
    /// Whether a block has a program name (O word). For most blocks the first byte rules that
    /// out, since no other word can be before a name.
    #[inline]
    pub(super) fn names_program(text: &str) -> bool {
        let other_word = matches!(text.as_bytes().first(), Some(b'A'..=b'N' | b'P'..=b'Z'));
        !other_word && Self::read(text).o.is_some()
    }

    /// Reads `/`, O and N at the start of a block and stops at the first other word.
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

/// Reads an unsigned number; `None` without digits or if the number exceeds `most`.
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
