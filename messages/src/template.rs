//! A text with placeholders, in pieces.
//!
//! ```text
//! {name}            a value as it prints itself
//! {name:04}         the same in a format of Rust; the Chinese text names it alone
//! {name:message}    another message, in the language of the whole
//! {name:messages}   several, with "; " between them
//! ```

/// What is wrong with a text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TemplateError {
    /// A placeholder does not end.
    #[error("a {{ without its }} in `{0}`")]
    Open(String),
    /// A placeholder whose name is none.
    #[error("`{{{0}}}` names no value")]
    Name(String),
}

/// What stands in a placeholder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A value, in this format.
    Plain(String),
    /// A message.
    Message,
    /// Messages.
    Messages,
}

/// A piece of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Piece<'a> {
    /// Words.
    Text(&'a str),
    /// A value.
    Value {
        /// Its name.
        name: &'a str,
        /// What it is.
        kind: Kind,
    },
}

/// The pieces of a text.
///
/// # Errors
/// A placeholder without end or with a name that is none.
pub fn pieces(text: &str) -> Result<Vec<Piece<'_>>, TemplateError> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('{') {
        let (inside, left) = after
            .split_once('}')
            .ok_or_else(|| TemplateError::Open(text.to_owned()))?;
        if !before.is_empty() {
            pieces.push(Piece::Text(before));
        }
        let (name, spec) = inside.split_once(':').unwrap_or((inside, ""));
        let letter = |letter: char| letter.is_ascii_lowercase() || letter == '_';
        if name.is_empty() || !name.chars().all(letter) {
            return Err(TemplateError::Name(inside.to_owned()));
        }
        let kind = match spec {
            "message" => Kind::Message,
            "messages" => Kind::Messages,
            spec => Kind::Plain(spec.to_owned()),
        };
        pieces.push(Piece::Value { name, kind });
        rest = left;
    }
    if !rest.is_empty() {
        pieces.push(Piece::Text(rest));
    }
    Ok(pieces)
}
