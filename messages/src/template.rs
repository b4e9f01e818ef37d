//! Splits a text with placeholders into pieces.
//!
//! ```text
//! {name}            a value in its own format
//! {name:04}         the same in a format of Rust; the Chinese text repeats the name alone
//! {name:message}    another message, in the same language
//! {name:messages}   several messages, joined with a semicolon
//! ```

/// The reason why the text of a message cannot be split at its placeholders.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TemplateError {
    /// A placeholder in this text has no closing brace.
    #[error("a {{ without its }} in `{0}`")]
    Open(String),
    /// This name of a placeholder is empty or invalid.
    #[error("`{{{0}}}` names no value")]
    Name(String),
}

/// The kind of value that fills a placeholder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PlaceholderKind {
    /// A value that is printed with this format specification; empty for the default.
    Plain(String),
    /// One message, in the same language.
    Message,
    /// A list of messages, in the same language.
    Messages,
}

/// A piece of a message's text: literal text or a placeholder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TemplatePiece<'a> {
    /// Literal text between placeholders.
    Text(&'a str),
    /// A placeholder, which is filled with a value.
    Value {
        /// The name that the placeholder has in the text.
        name: &'a str,
        /// The kind of value that fills the placeholder.
        kind: PlaceholderKind,
    },
}

/// Splits the text of a message into literal text and placeholders, in their order.
///
/// # Errors
/// Returns the fault if a placeholder has no closing brace or an invalid name.
pub fn split_template(text: &str) -> Result<Vec<TemplatePiece<'_>>, TemplateError> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('{') {
        let (inside, left) = after
            .split_once('}')
            .ok_or_else(|| TemplateError::Open(text.to_owned()))?;
        if !before.is_empty() {
            pieces.push(TemplatePiece::Text(before));
        }
        let (name, spec) = inside.split_once(':').unwrap_or((inside, ""));
        let letter = |letter: char| letter.is_ascii_lowercase() || letter == '_';
        if name.is_empty() || !name.chars().all(letter) {
            return Err(TemplateError::Name(inside.to_owned()));
        }
        let kind = match spec {
            "message" => PlaceholderKind::Message,
            "messages" => PlaceholderKind::Messages,
            spec => PlaceholderKind::Plain(spec.to_owned()),
        };
        pieces.push(TemplatePiece::Value { name, kind });
        rest = left;
    }
    if !rest.is_empty() {
        pieces.push(TemplatePiece::Text(rest));
    }
    Ok(pieces)
}
