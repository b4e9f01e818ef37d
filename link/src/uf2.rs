//! Checks firmware files for boards with a boot drive (UF2), and the description of such a drive.

use gsk_messages::{Message, say};
use thiserror::Error;

/// Length of a block, bytes.
const BLOCK: usize = 512;
/// The first, second and last word of each block.
const MAGIC: [u32; 3] = [0x0A32_4655, 0x9E5D_5157, 0x0AB1_6F30];
/// Flag: the file names its processor.
const HAS_FAMILY: u32 = 0x2000;
/// Greatest number of bytes in a block.
const MOST_BYTES: u32 = 476;
/// Number of the family of the RP2040.
const RP2040: u32 = 0xE48B_FF56;
/// The flash memory of an RP2040: at most 16 MB.
const FLASH: core::ops::Range<u32> = 0x1000_0000..0x1100_0000;
/// The file that describes the drive of a board in boot mode.
pub const INFO_FILE: &str = "INFO_UF2.TXT";
/// The board id of a Raspberry Pi Pico in boot mode.
pub const PICO_BOARD_ID: &str = "RPI-RP2";

/// Why a file is not a firmware for the Pico. Numbers of blocks begin with 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{}", self.message())]
pub enum Uf2Error {
    /// The length is not that of whole blocks.
    Length,
    /// This block is damaged.
    Block(usize),
    /// This block is missing or at another position.
    Order(usize),
    /// The file is for another processor.
    Family(u32),
    /// This block is for another memory.
    Address(usize),
}

impl Uf2Error {
    /// Returns the message that describes the error.
    pub fn message(&self) -> Message {
        match self {
            Self::Length => say::uf2_length(),
            Self::Block(number) => say::uf2_block(number),
            Self::Order(number) => say::uf2_order(number),
            Self::Family(family) => say::uf2_family(format!("{family:08X}")),
            Self::Address(number) => say::uf2_address(number),
        }
    }
}

/// Checks a firmware file for the Pico and returns the number of its blocks.
///
/// # Errors
/// The first fault.
pub fn check_firmware(file: &[u8]) -> Result<usize, Uf2Error> {
    if file.is_empty() || !file.len().is_multiple_of(BLOCK) {
        return Err(Uf2Error::Length);
    }
    let count = file.len() / BLOCK;
    let mut next = None;
    for (index, block) in file.chunks_exact(BLOCK).enumerate() {
        let number = index + 1;
        let word = |at: usize| {
            let bytes = block
                .get(at..at + 4)
                .and_then(|bytes| bytes.try_into().ok());
            bytes.map_or(0, u32::from_le_bytes)
        };
        if [word(0), word(4), word(BLOCK - 4)] != MAGIC {
            return Err(Uf2Error::Block(number));
        }
        let (flags, address, bytes) = (word(8), word(12), word(16));
        if flags & HAS_FAMILY == 0 || word(28) != RP2040 {
            return Err(Uf2Error::Family(word(28)));
        }
        if word(20) as usize != index || word(24) as usize != count {
            return Err(Uf2Error::Order(number));
        }
        let end = address.saturating_add(bytes);
        if bytes == 0 || bytes > MOST_BYTES || address < FLASH.start || end > FLASH.end {
            return Err(Uf2Error::Address(number));
        }
        if next.is_some_and(|next| next != address) {
            return Err(Uf2Error::Order(number));
        }
        next = Some(end);
    }
    Ok(count)
}

/// Returns the board id in the text of [`INFO_FILE`]; `None` without one.
pub fn board_id(info: &str) -> Option<&str> {
    let id = info
        .lines()
        .find_map(|line| line.trim().strip_prefix("Board-ID:"))?;
    Some(id.trim()).filter(|id| !id.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn firmware(blocks: usize) -> Vec<u8> {
        let mut file = Vec::new();
        for index in 0..blocks as u32 {
            let words = [
                MAGIC[0],
                MAGIC[1],
                HAS_FAMILY,
                FLASH.start + 256 * index,
                256,
                index,
                blocks as u32,
                RP2040,
            ];
            file.extend(words.iter().flat_map(|word| word.to_le_bytes()));
            file.resize(file.len() + BLOCK - 36, 7);
            file.extend(MAGIC[2].to_le_bytes());
        }
        file
    }

    #[test]
    fn faulty_files_are_refused() {
        assert_eq!(check_firmware(&firmware(3)), Ok(3));
        assert_eq!(check_firmware(&[]), Err(Uf2Error::Length));
        assert_eq!(check_firmware(&firmware(3)[..1000]), Err(Uf2Error::Length));
        assert_eq!(
            check_firmware(&firmware(3)[512..]),
            Err(Uf2Error::Order(1)),
            "the first is missing"
        );
        let faults = [
            (3, Uf2Error::Block(1)),
            (512 + 508, Uf2Error::Block(2)),
            (8 + 1, Uf2Error::Family(RP2040)),
            (512 + 15, Uf2Error::Address(2)),
            (512 + 13, Uf2Error::Order(2)),
            (24, Uf2Error::Order(1)),
        ];
        for (at, fault) in faults {
            let mut file = firmware(3);
            file[at] ^= 0x20;
            assert_eq!(check_firmware(&file), Err(fault), "{at}");
        }
        let mut other = firmware(1);
        other[28..32].copy_from_slice(&0xE48B_FF59_u32.to_le_bytes());
        assert_eq!(check_firmware(&other), Err(Uf2Error::Family(0xE48B_FF59)));
    }

    #[test]
    fn the_board_id_is_read() {
        let info = "UF2 Bootloader v3.0\r\nModel: Raspberry Pi RP2\r\nBoard-ID: RPI-RP2\r\n";
        assert_eq!(board_id(info), Some(PICO_BOARD_ID));
        assert_eq!(board_id("Board-ID:\n"), None);
        assert_eq!(board_id(""), None);
    }

    proptest! {
        #[test]
        fn any_file_is_checked(file in prop::collection::vec(any::<u8>(), 0..1200)) {
            prop_assert!(check_firmware(&file).is_err());
        }
    }
}
