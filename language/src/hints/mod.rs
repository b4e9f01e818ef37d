//! What an editor shows at the words of a text besides the text: kinds, signatures, modal
//! codes, meanings.

mod inlay;
mod signature;
mod tokens;
mod word_context;

pub use inlay::{ModalHint, modal_hints};
pub use signature::{CodeSignature, SignatureHelp, SignatureWord, signature_help};
pub use tokens::{SemanticToken, TokenKind, semantic_tokens};
pub(crate) use word_context::{WordContext, tool_parts, word_context};
