//! Writes the glyphs that the program can show, from GNU Unifont. Rare Chinese characters (CJK
//! extension A) and scripts that no lathe is programmed in are left out, a twentieth of the
//! browser page (decision WINDOW-13). The crate's own table is then unused and not linked.

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

use unifont::Glyph;

/// First and last character of each range: letters, signs and kana; Chinese; Korean;
/// compatibility and full-width forms.
const KEPT: [(u32, u32); 4] = [
    (0x0000, 0x33ff),
    (0x4e00, 0x9fff),
    (0xac00, 0xd7af),
    (0xf900, 0xffff),
];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let kept = |character: u32| {
        let mut ranges = KEPT.iter();
        ranges.any(|(first, last)| (*first..=*last).contains(&character))
    };
    let mut runs: Vec<(u32, u32)> = Vec::new();
    let mut table = String::new();
    let mut count = 0;
    for (character, glyph) in unifont::enumerate_glyphs() {
        let character = u32::from(character);
        if !kept(character) {
            continue;
        }
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
