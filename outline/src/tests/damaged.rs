//! Damaged files never panic, and never give a number that is not finite.

use super::*;
use crate::{OutlineFormat, ProgramOptions, read_drawing};

/// Number of damaged copies of each file.
const ROUNDS: u64 = 2_000;

fn files() -> [Vec<u8>; 3] {
    let arc = "0\nARC\n8\n0\n10\n-5\n20\n5\n40\n5\n50\n0\n51\n90\n0\nLWPOLYLINE\n8\n0\n70\n1\n10\n\
               -5\n20\n10\n42\n0.4\n10\n-9\n20\n12\n0\nELLIPSE\n8\n0\n10\n-9\n20\n12\n11\n-4\n21\n0\n40\n\
               0.4\n0\nCIRCLE\n8\n0\n10\n-10\n20\n0\n40\n3\n0\nINSERT\n8\n1\n10\n0\n20\n0\n";
    let pin = lines(&[(0.0, 0.0), (0.0, 5.0), (-15.0, 5.0), (-40.0, 10.0)]);
    let svg = r#"<svg width="9mm" viewBox="0 0 9 9"><g transform="matrix(1 0 0 2 3 4)"><path
        d="M0 0 A5 4 30 0 0 -5 -5 q3 3 4 5 t3 3 s1 2 3 4 z m3 3 h4 v3"/><circle r="3" cx="4"/>
        <rect width="3" height="4" rx="1"/><polygon points="0 0 3 4 5 6"/></g></svg>"#;
    [
        dxf_file(4, arc).into_bytes(),
        dxf_of_pieces(&pin).into_bytes(),
        svg.as_bytes().to_vec(),
    ]
}

/// Reads a file as far as it can be read.
fn read_all(bytes: &[u8]) {
    let Ok(drawing) = read_drawing(bytes) else {
        return;
    };
    let Ok(profile) = drawing.find_profile(&ProfileOptions::default()) else {
        return;
    };
    for piece in profile.pieces() {
        let sum = piece.start + piece.end;
        assert!(sum.x.is_finite() && sum.z.is_finite() && piece.bulge.is_finite());
    }
    for format in [OutlineFormat::Contour, OutlineFormat::G71] {
        let options = ProgramOptions {
            format,
            ..ProgramOptions::default()
        };
        if let Ok(text) = profile.write_program(&options) {
            assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        }
    }
}

#[test]
fn damaged_files_are_refused_or_read() {
    for (index, file) in files().iter().enumerate() {
        read_all(file);
        for seed in 0..ROUNDS {
            let mut numbers = SeededNumbers::new(seed * 3 + index as u64);
            let mut bytes = file.clone();
            for _ in 0..=numbers.below(6) {
                let at = numbers.below(bytes.len() as u64) as usize;
                match numbers.below(5) {
                    0 => bytes[at] = numbers.next() as u8,
                    1 => bytes[at] = b"0123456789-.eE \n"[numbers.below(16) as usize],
                    2 => bytes.truncate(at.max(1)),
                    3 => {
                        bytes.insert(at, b"09.-e"[numbers.below(5) as usize]);
                    }
                    _ => {
                        let until = (at + numbers.below(30) as usize).min(bytes.len());
                        let copy = bytes[at..until].to_vec();
                        bytes.splice(at..at, copy);
                    }
                }
            }
            read_all(&bytes);
        }
    }
}

#[test]
fn random_bytes_are_refused() {
    for seed in 0..500 {
        let mut numbers = SeededNumbers::new(seed);
        let start: &[u8] = [&b"0\nSECTION\n"[..], b"<svg>", b""][(seed % 3) as usize];
        let mut bytes = start.to_vec();
        bytes.extend((0..numbers.below(400)).map(|_| numbers.next() as u8));
        read_all(&bytes);
    }
}
