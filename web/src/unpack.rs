//! Unpacks the program of the page: a page loads this small program first, because browsers
//! have no decompression as strong as lzip's and many servers compress with gzip at most.

#![cfg_attr(target_arch = "wasm32", no_main)]

#[cfg(target_arch = "wasm32")]
mod page {
    use std::io::Read;

    use lzma_rust2::LzipReader;
    use wasm_bindgen::JsError;
    use wasm_bindgen::prelude::wasm_bindgen;

    /// Returns the bytes of a file in lzip's format.
    ///
    /// # Errors
    /// The file is damaged: its checksum or its length differs.
    #[wasm_bindgen]
    pub fn unpack(packed: &[u8]) -> Result<Vec<u8>, JsError> {
        let mut bytes = Vec::new();
        LzipReader::new(packed)
            .read_to_end(&mut bytes)
            .map_err(|error| JsError::new(&format!("gsk980td_bg.wasm.lz: {error}")))?;
        Ok(bytes)
    }
}

#[cfg(not(target_arch = "wasm32"))]
fn main() {}
