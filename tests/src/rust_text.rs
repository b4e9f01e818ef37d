//! Splits Rust sources into identifiers and comments, for tests of names and comments.

/// An identifier or a comment of a Rust source, with its line.
#[derive(Debug, PartialEq, Eq)]
pub enum RustToken {
    /// A name or a keyword of the code.
    Identifier {
        /// The name as the source writes it, without `r#`.
        name: String,
        /// Line of the identifier, from 1.
        line: usize,
    },
    /// A comment or a doc comment of one line, without its slashes.
    Comment {
        /// The text of the comment as the source writes it.
        text: String,
        /// Line of the comment, from 1.
        line: usize,
    },
}

/// Returns all identifiers and line comments of a source, in their order. Strings, characters,
/// numbers and block comments are left out.
pub fn split_tokens(source: &str) -> Vec<RustToken> {
    let mut reader = TokenReader {
        rest: source,
        line: 1,
        tokens: Vec::new(),
    };
    while reader.read_token() {}
    reader.tokens
}

struct TokenReader<'a> {
    rest: &'a str,
    line: usize,
    tokens: Vec<RustToken>,
}

impl TokenReader<'_> {
    /// Reads one piece of the source, and stores its token if it has one. Returns `false` at
    /// the end of the source.
    fn read_token(&mut self) -> bool {
        let Some(first) = self.rest.chars().next() else {
            return false;
        };
        let literal = literal_prefix(self.rest);
        let length = match (first, literal) {
            ('/', _) if self.rest.starts_with("//") => self.read_comment(),
            ('/', _) if self.rest.starts_with("/*") => length_to(self.rest, 2, "*/"),
            (_, Some(at)) => literal_length(self.rest, at),
            ('\'', _) => character_length(self.rest),
            (letter, _) if letter == '_' || letter.is_alphabetic() => self.read_identifier(),
            (digit, _) if digit.is_ascii_digit() => word_length(self.rest),
            (other, _) => other.len_utf8(),
        };
        self.line += self.rest[..length].matches('\n').count();
        self.rest = &self.rest[length..];
        true
    }

    fn read_comment(&mut self) -> usize {
        let length = self.rest.find('\n').unwrap_or(self.rest.len());
        let text = self.rest[..length].trim_start_matches(['/', '!']);
        self.tokens.push(RustToken::Comment {
            text: text.to_owned(),
            line: self.line,
        });
        length
    }

    fn read_identifier(&mut self) -> usize {
        let length = word_length(self.rest);
        self.tokens.push(RustToken::Identifier {
            name: self.rest[..length].to_owned(),
            line: self.line,
        });
        length
    }
}

fn word_length(text: &str) -> usize {
    let ends = |letter: char| letter != '_' && !letter.is_alphanumeric();
    text.find(ends).unwrap_or(text.len())
}

/// Returns the length of the text in bytes up to and including the first `end` at or after
/// `from`.
fn length_to(text: &str, from: usize, end: &str) -> usize {
    let found = text[from..].find(end);
    found.map_or(text.len(), |at| from + at + end.len())
}

/// Returns the byte at which the quote or the number signs of a string begin: 0 in `"…"`, 1 in
/// `r#"…"#`. Returns `None` if the text does not begin with a string.
fn literal_prefix(text: &str) -> Option<usize> {
    let at = text.find(|letter| !matches!(letter, 'r' | 'b' | 'c'))?;
    let rest = text[at..].trim_start_matches('#');
    (at <= 2 && rest.starts_with('"')).then_some(at)
}

/// Returns the length in bytes of the literal whose quote or number signs begin at `at`.
fn literal_length(text: &str, at: usize) -> usize {
    let signs = text[at..].chars().take_while(|sign| *sign == '#').count();
    if text[..at].contains('r') {
        let end = format!("\"{}", "#".repeat(signs));
        return length_to(text, at + signs + 1, &end);
    }
    string_length(text, at)
}

/// Returns the length in bytes of a string with escapes whose first quote is at `at`.
fn string_length(text: &str, at: usize) -> usize {
    let mut escaped = false;
    for (offset, letter) in text[at + 1..].char_indices() {
        match letter {
            '"' if !escaped => return at + 1 + offset + 1,
            '\\' => escaped = !escaped,
            _ => escaped = false,
        }
    }
    text.len()
}

/// Returns the length in bytes of a character literal, or 1 at a lifetime.
fn character_length(text: &str) -> usize {
    let mut letters = text.chars().skip(1);
    match (letters.next(), letters.next()) {
        (Some('\\'), Some(escaped)) => length_to(text, 2 + escaped.len_utf8(), "'"),
        (Some(letter), Some('\'')) => 2 + letter.len_utf8(),
        _ => 1,
    }
}

/// Returns the words of an identifier in lower case: `FollowingError` and `following_error`
/// have the words `following` and `error`.
pub fn split_words(identifier: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut after_small = false;
    for letter in identifier.chars() {
        if letter == '_' || (letter.is_uppercase() && after_small) {
            words.push(String::new());
        }
        after_small = letter.is_lowercase() || letter.is_ascii_digit();
        if letter != '_'
            && let Some(word) = words.last_mut()
        {
            word.extend(letter.to_lowercase());
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(source: &str) -> Vec<(String, usize)> {
        let identifiers = split_tokens(source)
            .into_iter()
            .filter_map(|token| match token {
                RustToken::Identifier { name, line } => Some((name, line)),
                RustToken::Comment { .. } => None,
            });
        identifiers.collect()
    }

    #[test]
    fn literals_hold_no_identifiers() {
        let source = "let a = \"told \\\" \\\\\"; b r\"said\" r#\"as\"ked\"# b\"x\" '\\'' 'q' 'l: '\\u{41}' 12u8 z";
        let found: Vec<String> = names(source).into_iter().map(|(name, _)| name).collect();
        assert_eq!(found, ["let", "a", "b", "l", "z"]);
    }

    #[test]
    fn comments_and_lines_are_counted() {
        let source = "/// One.\n/* told\n */ fn two() {} // three\n\"\n\" four";
        let expected = [
            RustToken::Comment {
                text: " One.".to_owned(),
                line: 1,
            },
            RustToken::Identifier {
                name: "fn".to_owned(),
                line: 3,
            },
            RustToken::Identifier {
                name: "two".to_owned(),
                line: 3,
            },
            RustToken::Comment {
                text: " three".to_owned(),
                line: 3,
            },
            RustToken::Identifier {
                name: "four".to_owned(),
                line: 5,
            },
        ];
        assert_eq!(split_tokens(source), expected);
    }

    #[test]
    fn identifiers_split_into_words() {
        assert_eq!(split_words("FollowingError"), ["following", "error"]);
        assert_eq!(split_words("X2_TOLD"), ["x2", "told"]);
        assert_eq!(split_words("_goes_on"), ["goes", "on"]);
    }
}
