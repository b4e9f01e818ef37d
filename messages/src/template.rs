//! Splits a text with placeholders into pieces.
//!
//! ```text
//! {name}            a value in its own format
//! {name:04}         the same in a format of Rust; the Chinese text repeats the name alone
//! {name:message}    another message, in the same language
//! {name:messages}   several messages, joined with "; "
//! ```

/// Why a text cannot be split.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TemplateError {
    /// A placeholder has no closing brace.
    #[error("a {{ without its }} in `{0}`")]
    Open(String),
    /// The name of a placeholder is empty or invalid.
    #[error("`{{{0}}}` names no value")]
    Name(String),
}

/// What a placeholder accepts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PlaceholderKind {
    /// A value printed with this format specification; empty for the default.
    Plain(String),
    /// Another message.
    Message,
    /// A list of messages.
    Messages,
}

/// A piece of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TemplatePiece<'a> {
    /// Literal text between placeholders.
    Text(&'a str),
    /// A placeholder.
    Value {
        /// The name of the parameter.
        name: &'a str,
        /// What the parameter accepts.
        kind: PlaceholderKind,
    },
}

/// Splits a text into literal text and placeholders, in their order.
///
/// # Errors
/// A placeholder has no closing brace or an invalid name.
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
