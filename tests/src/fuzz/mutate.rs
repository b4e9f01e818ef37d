//! Mutates inputs: words and lines most of the time, bytes now and then.

/// A reproducible random number generator (splitmix64).
#[derive(Clone, Debug)]
pub struct SplitMix(u64);

impl SplitMix {
    /// Creates the generator for a seed. The same seed gives the same numbers.
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Returns the next 64 random bits.
    pub const fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// Returns a random number below `limit`; 0 if `limit` is 0.
    pub const fn below(&mut self, limit: usize) -> usize {
        if limit == 0 {
            return 0;
        }
        (self.next() % limit as u64) as usize
    }

    /// Returns a random element; `None` if there are no elements.
    pub fn pick<'a, T>(&mut self, elements: &'a [T]) -> Option<&'a T> {
        let index = self.below(elements.len());
        elements.get(index)
    }
}

/// Greatest length of a mutated input, bytes. Longer ones are cut.
const MAX_LENGTH: usize = 4096;

/// Numbers at the limits of the control's ranges, which mutations insert.
const EDGE_NUMBERS: [&str; 30] = [
    "0",
    "1",
    "-1",
    "2",
    "3",
    "10",
    "-0",
    "0.001",
    "-0.001",
    "0.0005",
    ".5",
    "5.",
    "99",
    "100",
    "255",
    "500",
    "999",
    "9999",
    "9999.999",
    "-9999.999",
    "10000",
    "65535",
    "99999",
    "32768",
    "2147483647",
    "-2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "99999999999999999999",
];

/// Makes new inputs by mutating those of a pool.
pub struct Mutator {
    words: Vec<&'static str>,
}

impl Mutator {
    /// Creates a mutator that inserts these words, one a line. A word may contain spaces.
    pub fn new(words: &'static str) -> Self {
        Self {
            words: words.lines().filter(|word| !word.is_empty()).collect(),
        }
    }

    /// Returns a new input: a mutated copy of one in the pool.
    pub fn next(&self, pool: &[Vec<u8>], random: &mut SplitMix) -> Vec<u8> {
        let mut input = random.pick(pool).cloned().unwrap_or_default();
        let changes = 1 + random.below(4) * random.below(3);
        for _ in 0..changes {
            input = match random.below(16) {
                0 => change_byte(input, random),
                1..=4 => change_lines(&input, pool, random),
                _ => self.change_words(&input, random),
            };
        }
        input.truncate(MAX_LENGTH);
        input
    }

    fn change_words(&self, input: &[u8], random: &mut SplitMix) -> Vec<u8> {
        let mut words = split_words(input);
        let at = random.below(words.len());
        match random.below(8) {
            0 if !words.is_empty() => {
                words.remove(at);
            }
            1 if !words.is_empty() => words.insert(at, words[at].clone()),
            2 if !words.is_empty() => {
                let other = random.below(words.len());
                words.swap(at, other);
            }
            3 | 4 => {
                let word = random.pick(&self.words).copied().unwrap_or(" ");
                words.insert(at, word.as_bytes().to_vec());
                words.insert(at, b" ".to_vec());
            }
            _ => {
                if let Some(word) = words.get_mut(at) {
                    change_number(word, random);
                }
            }
        }
        words.concat()
    }
}

/// Splits an input into words: a run of letters with the number after it. Every other
/// character is a separate word.
fn split_words(input: &[u8]) -> Vec<Vec<u8>> {
    let mut words: Vec<Vec<u8>> = Vec::new();
    let mut in_number = false;
    for &byte in input {
        let number = byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'#');
        let letter = byte.is_ascii_alphabetic() || byte >= 0x80;
        let continues = (number || (letter && !in_number)) && {
            let last = words.last().and_then(|word| word.last());
            last.is_some_and(|&last| !last.is_ascii_whitespace())
        };
        match words.last_mut() {
            Some(word) if continues => word.push(byte),
            _ => words.push(vec![byte]),
        }
        in_number = number;
    }
    words
}

fn change_number(word: &mut Vec<u8>, random: &mut SplitMix) {
    let digits = word
        .iter()
        .position(|byte| byte.is_ascii_digit() || matches!(byte, b'.' | b'-'));
    let Some(digits) = digits else {
        return;
    };
    let value: Option<f64> = std::str::from_utf8(&word[digits..])
        .ok()
        .and_then(|number| number.parse().ok());
    let number = match (random.below(6), value) {
        (0, Some(value)) => format!("{}", value + 1.0),
        (1, Some(value)) => format!("{}", value - 1.0),
        (2, Some(value)) => format!("{}", -value),
        (3, Some(value)) => format!("{:.3}", value / 10.0),
        (4, _) => random.below(100).to_string(),
        _ => (*random.pick(&EDGE_NUMBERS).unwrap_or(&"0")).to_owned(),
    };
    word.truncate(digits);
    word.extend_from_slice(number.as_bytes());
}

fn change_lines(input: &[u8], pool: &[Vec<u8>], random: &mut SplitMix) -> Vec<u8> {
    let mut lines: Vec<&[u8]> = input.split(|&byte| byte == b'\n').collect();
    let at = random.below(lines.len());
    match random.below(5) {
        0 => {
            lines.remove(at);
        }
        1 => lines.insert(at, lines[at]),
        2 => {
            let other = random.below(lines.len());
            lines.swap(at, other);
        }
        3 => lines.truncate(at + 1),
        _ => {
            let other: Vec<&[u8]> = random
                .pick(pool)
                .map(|other| other.split(|&byte| byte == b'\n').collect())
                .unwrap_or_default();
            let from = random.below(other.len());
            let count = 1 + random.below(6);
            let piece = other.iter().skip(from).take(count).copied();
            lines.splice(at..at, piece);
        }
    }
    lines.join(&b'\n')
}

fn change_byte(mut input: Vec<u8>, random: &mut SplitMix) -> Vec<u8> {
    let at = random.below(input.len() + 1);
    let byte = (random.next() >> 32) as u8;
    match (random.below(3), input.get_mut(at)) {
        (0, Some(place)) => *place ^= 1 << (byte & 7),
        (1, Some(_)) => {
            input.remove(at);
        }
        _ => input.insert(at, byte),
    }
    input
}
