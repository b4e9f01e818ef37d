//! Writes a .zip with deflated files. The crate `zip`, which builds the releases, would add its
//! readers and methods to the program; a package needs 70 lines.

use crc32fast::hash;
use gsk_messages::{Message, say};
use miniz_oxide::deflate::compress_to_vec;

/// Version of the .zip format that a reader needs: 2.0, for deflate.
const VERSION_NEEDED: u16 = 20;
/// Bit of the .zip flags: the file names are UTF-8.
const UTF8_NAMES: u16 = 1 << 11;
/// Number of the .zip compression method deflate.
const DEFLATED: u16 = 8;
/// Time and date of every file, 1980-01-01 00:00: packages are reproducible.
const TIME_AND_DATE: [u16; 2] = [0, (1 << 5) | 1];
/// Compression level, 0 (none) to 10 (smallest).
const PACK_LEVEL: u8 = 9;

/// Writes files, given with their names, as a .zip.
///
/// # Errors
/// A file, a name or the whole is too large for the format.
pub fn write_zip(files: &[(String, Vec<u8>)]) -> Result<Vec<u8>, Message> {
    let too_large = || say::course_too_large(files.len());
    let (mut archive, mut directory) = (Vec::new(), Vec::new());
    for (name, bytes) in files {
        let offset = u32::try_from(archive.len()).map_err(|_| too_large())?;
        let packed = compress_to_vec(bytes, PACK_LEVEL);
        let entry = entry_fields(name, bytes, packed.len()).ok_or_else(too_large)?;
        archive.extend(b"PK\x03\x04");
        archive.extend(&entry);
        archive.extend(name.as_bytes());
        archive.extend(packed);
        directory.extend(b"PK\x01\x02");
        put(&mut directory, &[VERSION_NEEDED]);
        directory.extend(&entry);
        // Length of the comment, disk, internal and external attributes.
        put(&mut directory, &[0, 0, 0, 0, 0]);
        directory.extend(offset.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let count = u16::try_from(files.len()).map_err(|_| too_large())?;
    let start = u32::try_from(archive.len()).map_err(|_| too_large())?;
    let length = u32::try_from(directory.len()).map_err(|_| too_large())?;
    archive.extend(directory);
    archive.extend(b"PK\x05\x06");
    put(&mut archive, &[0, 0, count, count]);
    archive.extend(length.to_le_bytes());
    archive.extend(start.to_le_bytes());
    put(&mut archive, &[0]);
    Ok(archive)
}

/// Returns the fields that are the same in a file's header and in the directory of the archive;
/// `None` if one is too large for the format.
fn entry_fields(name: &str, bytes: &[u8], packed: usize) -> Option<Vec<u8>> {
    let mut fields = Vec::new();
    put(&mut fields, &[VERSION_NEEDED, UTF8_NAMES, DEFLATED]);
    put(&mut fields, &TIME_AND_DATE);
    fields.extend(hash(bytes).to_le_bytes());
    fields.extend(u32::try_from(packed).ok()?.to_le_bytes());
    fields.extend(u32::try_from(bytes.len()).ok()?.to_le_bytes());
    // Length of the name, and of further fields.
    put(&mut fields, &[u16::try_from(name.len()).ok()?, 0]);
    Some(fields)
}

fn put(bytes: &mut Vec<u8>, values: &[u16]) {
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
}
