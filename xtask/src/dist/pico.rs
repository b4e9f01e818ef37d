//! Builds the firmware of the pulse board for the Raspberry Pi Pico as a UF2 file. Debian's
//! compiler builds the standard library with it, as for Windows.

use std::fs;
use std::path::Path;

use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Endianness, elf};

use super::debian::{self, CARGO, PATH, RUSTC};
use super::{FLAG_SEPARATOR, dist_folder, remap_flags, with_path, write_checksums};
use crate::error::TaskError;
use crate::run;

const TRIPLE: &str = "thumbv6m-none-eabi";
const SYSTEM: &str = "the Raspberry Pi Pico";
const LINKER: &str = "/usr/bin/arm-none-eabi-ld";
const CURE: &str =
    "on Debian: apt-get install rustc-web cargo-web rust-web-src binutils-arm-none-eabi";
/// Address of the flash, and its size on a Pico.
const FLASH: u32 = 0x1000_0000;
const FLASH_BYTES: u32 = 2 << 20;
/// Bytes of the image in a block of the UF2 file, and length of a block.
const PAYLOAD: usize = 256;
const BLOCK: usize = 512;
/// Numbers that begin and end a block.
const MAGIC: [u32; 3] = [0x0A32_4655, 0x9E5D_5157, 0x0AB1_6F30];
/// The block names the family of the processor.
const HAS_FAMILY: u32 = 0x2000;
const RP2040: u32 = 0xE48B_FF56;

/// Makes the UF2 file with a checksum in `target/dist`, and the image for the emulator.
///
/// # Errors
/// A tool is missing or fails, or the firmware is invalid.
pub fn make(root: &Path) -> Result<(), TaskError> {
    debian::require_tools(SYSTEM, CURE, &[LINKER])?;
    // The firmware has its own workspace and its own folder for what is built.
    let built = root.join("target/pico");
    build(root, &built)?;
    let program = built.join(TRIPLE).join("release/pico");
    let program_bytes = with_path(&program, fs::read(&program))?;
    let image = read_image(&program_bytes).map_err(|why| TaskError::Program {
        path: program.clone(),
        why,
    })?;
    let plain = built.join("pico.bin");
    with_path(&plain, fs::write(&plain, &image))?;
    let folder = dist_folder(root)?;
    let version = firmware_version(root)?;
    let name = format!("gsk980td-pico-{version}.uf2");
    let path = folder.join(&name);
    with_path(&path, fs::write(&path, pack_uf2(&image)))?;
    // The licences of what the firmware contains.
    let notices = folder.join(format!("gsk980td-pico-{version}-THIRD-PARTY.md"));
    with_path(
        &notices,
        fs::copy(root.join("firmware/THIRD-PARTY.md"), &notices),
    )?;
    let checksum = write_checksums(&folder, &format!("{name}.sha256"), &[name])?;
    println!("{}: {} bytes of flash", path.display(), image.len());
    print!("{checksum}");
    Ok(())
}

fn build(root: &Path, built: &Path) -> Result<(), TaskError> {
    let manifest = root.join("firmware/Cargo.toml");
    let (manifest, built) = (manifest.to_string_lossy(), built.to_string_lossy());
    let arguments = [
        "build",
        "--release",
        "--locked",
        "-Zbuild-std=core",
        "--target",
        TRIPLE,
        "--target-dir",
        &built,
        "--manifest-path",
        &manifest,
        "--package=gsk980td-firmware",
        "--bin=pico",
    ];
    let flags = [
        remap_flags(root),
        format!("-Clinker={LINKER}"),
        "-Clinker-flavor=ld".to_owned(),
    ];
    let environment = [
        ("PATH", PATH),
        ("RUSTC", RUSTC),
        ("RUSTC_BOOTSTRAP", "1"),
        ("CARGO_ENCODED_RUSTFLAGS", &flags.join(FLAG_SEPARATOR)),
    ];
    run(CARGO, &arguments, &environment)
}

/// Returns the version of the firmware, which its manifest states.
fn firmware_version(root: &Path) -> Result<String, TaskError> {
    let path = root.join("firmware/Cargo.toml");
    let text = with_path(&path, fs::read_to_string(&path))?;
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("version = "));
    let version = line.map(|version| version.trim_matches('"').to_owned());
    version.ok_or_else(|| TaskError::Program {
        path,
        why: "no version".to_owned(),
    })
}

/// Returns the contents of the flash from its beginning.
fn read_image(program: &[u8]) -> Result<Vec<u8>, String> {
    let file = ElfFile32::<Endianness>::parse(program).map_err(|error| error.to_string())?;
    let endian = Endianness::Little;
    let mut image = Vec::new();
    for header in file.elf_program_headers() {
        let data = header
            .data(endian, program)
            .map_err(|()| "a truncated segment")?;
        if header.p_type(endian) != elf::PT_LOAD || data.is_empty() {
            continue;
        }
        let address = header.p_paddr(endian);
        let from = address
            .checked_sub(FLASH)
            .filter(|from| *from < FLASH_BYTES);
        let from = from.ok_or_else(|| format!("a segment at {address:#X}"))? as usize;
        let end = from + data.len();
        if end > image.len() {
            image.resize(end, 0xFF);
        }
        image[from..end].copy_from_slice(data);
    }
    if image.len() <= PAYLOAD {
        return Err("no program in the flash".to_owned());
    }
    Ok(image)
}

/// Packs the contents of the flash into blocks.
fn pack_uf2(image: &[u8]) -> Vec<u8> {
    let pages = image.chunks(PAYLOAD);
    let count = pages.len() as u32;
    let mut file = Vec::with_capacity(pages.len() * BLOCK);
    for (index, page) in pages.enumerate() {
        let address = FLASH + (index * PAYLOAD) as u32;
        let numbers = [
            MAGIC[0],
            MAGIC[1],
            HAS_FAMILY,
            address,
            PAYLOAD as u32,
            index as u32,
            count,
            RP2040,
        ];
        let begun = file.len();
        file.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        file.extend_from_slice(page);
        file.resize(begun + BLOCK - MAGIC[2].to_le_bytes().len(), 0);
        file.extend_from_slice(&MAGIC[2].to_le_bytes());
    }
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_hold_the_image_in_order() {
        let image: Vec<u8> = (0..700_usize).map(|index| index as u8).collect();
        let file = pack_uf2(&image);
        assert_eq!(file.len(), 3 * BLOCK);
        let mut read = Vec::new();
        for (index, block) in file.chunks(BLOCK).enumerate() {
            let number = |at: usize| u32::from_le_bytes(block[at..at + 4].try_into().unwrap());
            assert_eq!([number(0), number(4), number(508)], MAGIC);
            assert_eq!(number(12), FLASH + 256 * index as u32);
            assert_eq!([number(16), number(20), number(24)], [256, index as u32, 3]);
            assert_eq!(number(28), RP2040);
            read.extend_from_slice(&block[32..288]);
        }
        assert_eq!(read[..700], image);
    }
}
