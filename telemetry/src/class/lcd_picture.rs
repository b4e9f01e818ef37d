//! The LCD as bytes: two colours, and the lengths of alternating runs of dots.

/// First bytes of a picture.
const MAGIC: &[u8; 2] = b"L1";
/// Dots of a picture: 320 x 240.
pub const LCD_DOTS: usize = LCD_WIDTH * 240;
/// Dots in a row.
pub const LCD_WIDTH: usize = 320;

/// The LCD at one moment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LcdPicture {
    /// Colour of the background: red, green, blue.
    pub background: [u8; 3],
    /// Colour of text and lines.
    pub text: [u8; 3],
    /// Whether each dot is text, row by row.
    pub dots: Vec<bool>,
}

impl LcdPicture {
    /// Encodes the picture.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(self.background);
        bytes.extend(self.text);
        // The first run is background, and may be empty.
        let (mut is_text, mut length) = (false, 0_usize);
        for dot in &self.dots {
            if *dot != is_text {
                push_length(&mut bytes, length);
                (is_text, length) = (*dot, 0);
            }
            length += 1;
        }
        push_length(&mut bytes, length);
        bytes
    }

    /// Decodes a picture; `None` for malformed bytes.
    pub fn parse(bytes: &[u8]) -> Option<Self> {
        let (background, rest) = bytes.strip_prefix(MAGIC)?.split_first_chunk()?;
        let (text, mut rest) = rest.split_first_chunk()?;
        let mut dots = Vec::with_capacity(LCD_DOTS);
        let mut is_text = false;
        while !rest.is_empty() {
            let length = take_length(&mut rest)?;
            if length > LCD_DOTS - dots.len() {
                return None;
            }
            dots.resize(dots.len() + length, is_text);
            is_text = !is_text;
        }
        (dots.len() == LCD_DOTS).then_some(Self {
            background: *background,
            text: *text,
            dots,
        })
    }
}

/// Writes a number in groups of seven bits, the lowest first.
fn push_length(bytes: &mut Vec<u8>, mut length: usize) {
    while length >= 0x80 {
        bytes.push((length & 0x7f) as u8 | 0x80);
        length >>= 7;
    }
    bytes.push(length as u8);
}

fn take_length(bytes: &mut &[u8]) -> Option<usize> {
    let mut length = 0;
    for shift in [0, 7, 14] {
        let (first, rest) = bytes.split_first()?;
        *bytes = rest;
        length |= usize::from(first & 0x7f) << shift;
        if first & 0x80 == 0 {
            return Some(length);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(is_text: impl Fn(usize) -> bool) -> LcdPicture {
        LcdPicture {
            background: [1, 2, 3],
            text: [200, 210, 220],
            dots: (0..LCD_DOTS).map(is_text).collect(),
        }
    }

    #[test]
    fn pictures_survive_the_network() {
        for picture in [
            picture(|_| false),
            picture(|_| true),
            picture(|dot| dot % 3 == 0),
            picture(|dot| dot % 4001 > 3700),
        ] {
            let read = LcdPicture::parse(&picture.to_bytes());
            assert!(read.as_ref() == Some(&picture));
        }
        assert_eq!(picture(|_| false).to_bytes().len(), 11);
    }

    #[test]
    fn malformed_pictures_are_refused() {
        let bytes = picture(|dot| dot % 4001 > 3700).to_bytes();
        for end in 0..bytes.len() {
            assert_eq!(LcdPicture::parse(&bytes[..end]), None);
        }
        let mut long = bytes.clone();
        long.push(1);
        assert_eq!(LcdPicture::parse(&long), None);
        let mut seed = 5_u64;
        for _ in 0..10_000 {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let mut damaged = bytes.clone();
            let at = (seed >> 40) as usize % damaged.len();
            damaged[at] = (seed >> 33) as u8;
            let read = LcdPicture::parse(&damaged);
            assert!(read.is_none_or(|it| it.dots.len() == LCD_DOTS));
        }
    }
}
