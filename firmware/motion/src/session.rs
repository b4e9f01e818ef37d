//! The protocol between bytes and the engine: blocks, acknowledgements, dictionary.

use crate::block::{self, BlockBytes, BlockReader, Content, MAX_CONTENT, Received};
use crate::engine::{Event, Request};
use crate::messages::{
    COMMANDS, Command, Reason, Response, command_id, parameter_count, response_id,
};

/// The dictionary, compressed with zlib.
pub const DICTIONARY: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/dictionary.bin"));

/// The protocol's state: what is received incompletely, and the sequence number.
#[derive(Clone, Debug)]
pub struct Session {
    reader: BlockReader,
    dictionary: &'static [u8],
}

impl Default for Session {
    fn default() -> Self {
        Self::with_dictionary(DICTIONARY)
    }
}

impl Session {
    /// Creates a session that announces a dictionary, compressed with zlib: for tests of a host
    /// with older firmware.
    pub fn with_dictionary(dictionary: &'static [u8]) -> Self {
        Self {
            reader: BlockReader::default(),
            dictionary,
        }
    }

    /// Takes a byte. Calls `execute` with each request for the engine, and `reply` with each
    /// block that answers the byte.
    pub fn push(
        &mut self,
        byte: u8,
        mut reply: impl FnMut(BlockBytes),
        mut execute: impl FnMut(Request),
    ) {
        match self.reader.push(byte) {
            None => return,
            Some(Received::Rejected) => {}
            Some(Received::Content(content)) => self.split(&content, &mut reply, &mut execute),
        }
        reply(block::encode_block(self.reader.expected, &[]));
    }

    /// Encodes an event of the engine as a block.
    pub fn encode(&self, event: &Event) -> BlockBytes {
        let mut content = Content::new();
        block::encode_vlq(&mut content, response_id(event.response).into());
        for value in event.values() {
            block::encode_vlq(&mut content, *value);
        }
        block::encode_block(self.reader.expected, &content)
    }

    fn split(
        &self,
        mut content: &[u8],
        reply: &mut impl FnMut(BlockBytes),
        execute: &mut impl FnMut(Request),
    ) {
        while !content.is_empty() {
            let id = block::decode_vlq(&mut content);
            let index = id.and_then(|id| id.checked_sub(command_id(Command::Identify) as u32));
            let known = index.and_then(|index| COMMANDS.get(index as usize));
            let Some((command, format)) = known else {
                execute(Request::fault(Reason::InvalidCommand));
                return;
            };
            let mut request = Request::new(*command);
            for value in request.values.iter_mut().take(parameter_count(format)) {
                let Some(argument) = block::decode_vlq(&mut content) else {
                    execute(Request::fault(Reason::ParserError));
                    return;
                };
                *value = argument;
            }
            if *command == Command::Identify {
                reply(self.identify(request.values[0], request.values[1]));
            } else {
                execute(request);
            }
        }
    }

    /// Returns the block with a part of the dictionary.
    fn identify(&self, offset: u32, count: u32) -> BlockBytes {
        /// Greatest length of the part: the content without ids and numbers.
        const MOST: usize = MAX_CONTENT - 8;
        let dictionary = self.dictionary;
        let from = (offset as usize).min(dictionary.len());
        let to = (from + (count as usize).min(MOST)).min(dictionary.len());
        let mut content = Content::new();
        block::encode_vlq(&mut content, response_id(Response::Identify).into());
        block::encode_vlq(&mut content, offset.into());
        content.extend([(to - from) as u8]);
        content.extend(dictionary[from..to].iter().copied());
        block::encode_block(self.reader.expected, &content)
    }
}
