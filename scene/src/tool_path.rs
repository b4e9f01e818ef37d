//! The programmed path as lines in the plane of the tool. Its cost is bounded: pieces that look
//! the same are kept once.

/// Greatest number of straight pieces of a drawn path.
pub const MAX_PIECES: usize = 20_000;
/// Number of steps over the longer side of the path: differences below one step are invisible.
const RESOLUTION: f32 = 2048.0;
/// Number of slots in the hash table of known pieces; few are used.
const SLOTS: usize = 1 << 16;
/// Value of a hash table slot without a piece.
const EMPTY: u64 = 0;
/// Size of a line end in a buffer, bytes: position as 3 floats, colour as 4 bytes.
pub const LINE_VERTEX_BYTES: usize = 16;

/// A straight piece of the drawn programmed path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolPathPiece {
    /// Both ends as (x, distance from the axis), mm.
    pub ends: [[f32; 2]; 2],
    /// Colour as sRGB bytes.
    pub color: [u8; 3],
}

/// The drawn programmed path, with a limited number of straight pieces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolPath {
    pieces: Vec<ToolPathPiece>,
}

/// Builds a path from pieces and leaves out those that look the same as earlier ones.
#[derive(Clone, Debug)]
pub struct ToolPathBuilder {
    pieces: Vec<ToolPathPiece>,
    slots: Vec<u64>,
    /// Steps per mm.
    scale: f32,
}

impl ToolPathBuilder {
    /// Begins a path whose longer side is `extent_mm`.
    pub fn new(extent_mm: f32) -> Self {
        let extent = match extent_mm.is_finite() {
            true => extent_mm.clamp(1.0, 20_000.0),
            false => 1000.0,
        };
        Self {
            pieces: Vec::new(),
            slots: vec![EMPTY; SLOTS],
            scale: RESOLUTION / extent,
        }
    }

    /// Adds a piece to the path. A short one extends the piece before it.
    pub fn add(&mut self, piece: ToolPathPiece) {
        if !piece.ends.iter().flatten().all(|it| it.is_finite()) {
            return;
        }
        let scale = self.scale;
        let step = |[x, r]: [f32; 2]| [x, r].map(|it| (it * scale).round() as i32);
        let [from, to] = piece.ends.map(step);
        if let Some(last) = self.pieces.last_mut() {
            let follows = last.color == piece.color && step(last.ends[1]) == from;
            let is_short = from == to || step(last.ends[0]) == step(last.ends[1]);
            if follows && is_short {
                last.ends[1] = piece.ends[1];
                return;
            }
        }
        let mut key = u64::from(piece.color[0]) << 8 | u64::from(piece.color[2]);
        for value in from.into_iter().chain(to) {
            key = (key ^ u64::from(value as u32)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            key ^= key >> 29;
        }
        // A piece that is shorter than a step and follows none would be a dot.
        if from == to || self.pieces.len() >= MAX_PIECES {
            return;
        }
        let key = key.max(EMPTY + 1);
        let mut slot = key as usize % SLOTS;
        while let Some(known) = self.slots.get_mut(slot) {
            if *known == key {
                return;
            }
            if *known == EMPTY {
                *known = key;
                break;
            }
            slot = (slot + 1) % SLOTS;
        }
        self.pieces.push(piece);
    }

    /// Returns the path of the added pieces.
    pub fn build(self) -> ToolPath {
        ToolPath {
            pieces: self.pieces,
        }
    }
}

impl ToolPath {
    /// Returns the straight pieces of the path.
    pub fn pieces(&self) -> &[ToolPathPiece] {
        &self.pieces
    }

    /// Returns the ends of all pieces, in the frame of the tools, and their indices, as bytes.
    pub(crate) fn bytes(&self) -> [Vec<u8>; 2] {
        let mut vertices = Vec::with_capacity(self.pieces.len() * 2 * LINE_VERTEX_BYTES);
        for piece in &self.pieces {
            for [x, radius] in piece.ends {
                for length in [x, 0.0, radius] {
                    vertices.extend_from_slice(&length.to_ne_bytes());
                }
                vertices.extend_from_slice(&piece.color);
                vertices.push(255);
            }
        }
        let indices = 0..self.pieces.len() as u32 * 2;
        [vertices, indices.flat_map(u32::to_ne_bytes).collect()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(from: [f32; 2], to: [f32; 2]) -> ToolPathPiece {
        ToolPathPiece {
            ends: [from, to],
            color: [90, 180, 255],
        }
    }

    #[test]
    fn a_million_blocks_on_one_contour_are_few_pieces() {
        let mut builder = ToolPathBuilder::new(100.0);
        let at = |step: u32| {
            let angle = (step % 10_000) as f32 * 1e-4 * core::f32::consts::TAU;
            [50.0 + 40.0 * angle.cos(), 40.0 + 20.0 * angle.sin()]
        };
        for step in 0..1_000_000 {
            builder.add(piece(at(step), at(step + 1)));
        }
        let path = builder.build();
        let count = path.pieces().len();
        assert!(count > 500 && count < 12_000, "{count}");
        let [vertices, indices] = path.bytes();
        assert_eq!(vertices.len(), count * 2 * LINE_VERTEX_BYTES);
        assert_eq!(indices.len(), count * 8);
    }

    #[test]
    fn the_number_of_pieces_is_bounded() {
        let mut builder = ToolPathBuilder::new(f32::NAN);
        for step in 0..100_000_u32 {
            let at = |step: u32| [(step % 317) as f32 * 3.0, (step / 317) as f32 * 3.0];
            builder.add(piece(at(step), at(step * 7 % 100_000)));
        }
        builder.add(piece([f32::NAN, 0.0], [1.0, 1.0]));
        let path = builder.build();
        assert_eq!(path.pieces().len(), MAX_PIECES);
    }

    #[test]
    fn short_pieces_join_and_repeated_ones_are_left_out() {
        let mut builder = ToolPathBuilder::new(100.0);
        for pass in 0..5 {
            for step in 0..200 {
                let at = |step: i32| [step as f32 * 0.001, 10.0];
                builder.add(piece(at(step), at(step + 1)));
            }
            let back = ToolPathPiece {
                color: [255, 150, 60],
                ..piece([0.2, 10.0], [0.0, 10.0])
            };
            builder.add(back);
            assert!(
                builder.pieces.len() < 12,
                "{pass}: {}",
                builder.pieces.len()
            );
        }
    }
}
