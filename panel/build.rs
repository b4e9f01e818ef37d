//! Writes the glyphs that the program can show, from GNU Unifont. Rare Chinese characters (CJK
//! extension A), Korean and scripts that no lathe is programmed in are left out; in the browser page,
//! which is loaded, also the Chinese characters outside GB 2312 (decision WINDOW-13).
//! The crate's own table is then unused and not linked.

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

use encoding_rs::GBK;
use unifont::Glyph;

/// First and last character of each range: letters, signs and kana; Chinese;
/// compatibility and full-width forms.
const KEPT: [(u32, u32); 3] = [(0x0000, 0x33ff), (0x4e00, 0x9fff), (0xf900, 0xffff)];
/// The ranges that the page has in full.
const KEPT_IN_PAGE: [(u32, u32); 2] = [(0x0000, 0x33ff), (0xff00, 0xffef)];

/// Whether a character is in GB 2312, the character set of the control: both bytes of its GBK code
/// are above A0, and the first one is a row of that standard.
fn is_gb2312(character: char) -> bool {
    let mut text = [0; 4];
    let (bytes, _, has_no_code) = GBK.encode(character.encode_utf8(&mut text));
    !has_no_code && matches!(*bytes, [0xa1..=0xf7, 0xa1..=0xfe])
}

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let is_page = env::var("CARGO_CFG_TARGET_ARCH").is_ok_and(|it| it == "wasm32");
    let is_kept = |character: char| {
        let ranges: &[(u32, u32)] = if is_page { &KEPT_IN_PAGE } else { &KEPT };
        let mut ranges = ranges.iter();
        ranges.any(|(first, last)| (*first..=*last).contains(&u32::from(character)))
            || is_page && is_gb2312(character)
    };
    let mut runs: Vec<(u32, u32)> = Vec::new();
    let mut table = String::new();
    let mut count = 0;
    for (character, glyph) in unifont::enumerate_glyphs() {
        if !is_kept(character) {
            continue;
        }
        let character = u32::from(character);
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == character => *last = character,
            _ => runs.push((character, character)),
        }
        // Writing to a string cannot fail.
        let _ = match glyph {
            Glyph::Halfwidth(rows) => writeln!(table, "Glyph::Halfwidth({rows:?}),"),
            Glyph::Fullwidth(rows) => writeln!(table, "Glyph::Fullwidth({rows:?}),"),
        };
        count += 1;
    }
    let code = format!(
        "static RUNS: [(u32, u32); {}] = {runs:?};\nstatic GLYPHS: [Glyph; {count}] = [\n{table}];\n",
        runs.len()
    );
    let folder = env::var_os("OUT_DIR").unwrap_or_default();
    let path = Path::new(&folder).join("glyphs.rs");
    if let Err(error) = fs::write(&path, code) {
        println!("cargo::error={}: {error}", path.display());
    }
}
