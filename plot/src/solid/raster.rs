//! Draws triangles on pixels with a depth buffer: rows of pixels between two edges.

use glam::{Vec2, Vec3};

/// A pixel: red, green and blue, each multiplied by the opacity, then the opacity; 0 to 255.
pub type SolidPixel = [u8; 4];

/// Area below which a triangle covers no pixel, square pixels.
const MIN_TRIANGLE_AREA: f32 = 1e-5;

/// A picture that stores the depth of each pixel.
#[derive(Clone, Debug, Default)]
pub(super) struct Raster {
    width: usize,
    height: usize,
    pixels: Vec<SolidPixel>,
    /// Depth of each pixel; a greater value is nearer to the viewer.
    depths: Vec<f32>,
}

/// A corner of a triangle, with values that are interpolated between the corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct TriangleCorner<const N: usize> {
    /// Position in the picture, pixels: right, down, near.
    pub position: Vec3,
    pub values: [f32; N],
}

impl Raster {
    /// Clears the picture and sets its size, pixels.
    pub(super) fn clear(&mut self, width: usize, height: usize) {
        (self.width, self.height) = (width, height);
        self.pixels.clear();
        self.pixels.resize(width * height, [0; 4]);
        self.depths.clear();
        self.depths.resize(width * height, f32::NEG_INFINITY);
    }

    /// Draws a triangle. `paint` receives the change of each value per pixel to the right and
    /// down, and returns the function that converts the values of a pixel to its colour.
    pub(super) fn draw_triangle<const N: usize, P: Fn([f32; N]) -> SolidPixel>(
        &mut self,
        corners: [TriangleCorner<N>; 3],
        paint: impl FnOnce([Vec2; N]) -> P,
    ) {
        let [a, b, c] = corners;
        let (ab, ac) = (b.position - a.position, c.position - a.position);
        let area = ab.x * ac.y - ab.y * ac.x;
        if area.abs().partial_cmp(&MIN_TRIANGLE_AREA) != Some(core::cmp::Ordering::Greater) {
            return;
        }
        // For a value that is greater by p at b and by q at c.
        let gradient =
            |p: f32, q: f32| Vec2::new((p * ac.y - q * ab.y) / area, (q * ab.x - p * ac.x) / area);
        let nearer = gradient(ab.z, ac.z);
        let slopes: [Vec2; N] = core::array::from_fn(|index| {
            let [base, p, q] = [a, b, c].map(|corner| corner.values[index]);
            gradient(p - base, q - base)
        });
        let paint = paint(slopes);
        let mut by_row = [a.position, b.position, c.position];
        by_row.sort_unstable_by(|one, other| one.y.total_cmp(&other.y));
        let [top, middle, bottom] = by_row;
        let long = TriangleSide::new(top, bottom);
        for (short, from, to) in [
            (TriangleSide::new(top, middle), top.y, middle.y),
            (TriangleSide::new(middle, bottom), middle.y, bottom.y),
        ] {
            for row in covered_pixels(from, to, self.height) {
                let y = row as f32 + 0.5;
                let (one, other) = (long.at(y), short.at(y));
                let columns = covered_pixels(one.min(other), one.max(other), self.width);
                let begin = Vec2::new(columns.start as f32 + 0.5, y)
                    - Vec2::new(a.position.x, a.position.y);
                let mut depth = a.position.z + nearer.dot(begin);
                let mut values: [f32; N] =
                    core::array::from_fn(|index| a.values[index] + slopes[index].dot(begin));
                let start = row * self.width;
                let place = start + columns.start..start + columns.end;
                let (Some(pixels), Some(depths)) = (
                    self.pixels.get_mut(place.clone()),
                    self.depths.get_mut(place),
                ) else {
                    continue;
                };
                for (pixel, known) in pixels.iter_mut().zip(depths) {
                    if depth > *known {
                        *known = depth;
                        *pixel = paint(values);
                    }
                    depth += nearer.x;
                    for (value, slope) in values.iter_mut().zip(&slopes) {
                        *value += slope.x;
                    }
                }
            }
        }
    }

    /// Draws a line of `width` pixels between two positions.
    pub(super) fn draw_line(&mut self, from: Vec3, to: Vec3, width: f32, color: SolidPixel) {
        let along = Vec2::new(to.x - from.x, to.y - from.y).normalize_or(Vec2::X);
        // Square ends: no gaps where lines meet.
        let half = along * (width / 2.0);
        let (ahead, beside) = (half.extend(0.0), half.perp().extend(0.0));
        let corner = |at: Vec3| TriangleCorner {
            position: at,
            values: [],
        };
        let corners = [
            from - ahead - beside,
            from - ahead + beside,
            to + ahead - beside,
            to + ahead + beside,
        ]
        .map(corner);
        let [a, b, c, d] = corners;
        for triangle in [[a, b, c], [b, c, d]] {
            self.draw_triangle(triangle, |_| move |_| color);
        }
    }

    /// The finished picture; each of its pixels is the mean of `samples` by `samples` drawn
    /// pixels.
    pub(super) fn downsample(&self, samples: usize) -> Vec<SolidPixel> {
        if samples <= 1 || self.width == 0 {
            return self.pixels.clone();
        }
        let count = (samples * samples) as u32;
        let (width, height) = (self.width / samples, self.height / samples);
        let mut picture = Vec::with_capacity(width * height);
        let mut sums = vec![[0_u32; 4]; width];
        for rows in self.pixels.chunks_exact(self.width * samples) {
            sums.fill([0; 4]);
            for row in rows.chunks_exact(self.width) {
                for (sum, pixels) in sums.iter_mut().zip(row.chunks_exact(samples)) {
                    for pixel in pixels {
                        for (sum, value) in sum.iter_mut().zip(pixel) {
                            *sum += u32::from(*value);
                        }
                    }
                }
            }
            let mean = |sum: u32| ((sum + count / 2) / count) as u8;
            picture.extend(sums.iter().map(|sum| sum.map(mean)));
        }
        picture
    }
}

/// A side of a triangle from its upper to its lower end. Two triangles that share the side
/// compute the same values.
struct TriangleSide {
    from: Vec3,
    slope: f32,
}

impl TriangleSide {
    fn new(from: Vec3, to: Vec3) -> Self {
        let high = to.y - from.y;
        let slope = if high > 0.0 {
            (to.x - from.x) / high
        } else {
            0.0
        };
        Self { from, slope }
    }

    fn at(&self, y: f32) -> f32 {
        self.from.x + (y - self.from.y) * self.slope
    }
}

/// The rows or columns, of `count`, whose middle is between two positions in pixels.
fn covered_pixels(from: f32, to: f32, count: usize) -> core::ops::Range<usize> {
    // NaN and negative numbers become 0, as in every cast.
    let first = ((from - 0.5).ceil() as usize).min(count);
    let end = ((to - 0.5).ceil() as usize).min(count);
    first..end.max(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raster(width: usize, height: usize) -> Raster {
        let mut raster = Raster::default();
        raster.clear(width, height);
        raster
    }

    fn filled(raster: &mut Raster, corners: [(f32, f32, f32); 3], shade: u8) {
        let corners = corners.map(|(x, y, z)| TriangleCorner {
            position: Vec3::new(x, y, z),
            values: [],
        });
        raster.draw_triangle(corners, |_| move |_| [shade, 0, 0, 255]);
    }

    #[test]
    fn triangles_side_by_side_cover_each_pixel_once() {
        let fan = [
            (3.3, 2.1),
            (17.2, 1.0),
            (18.9, 15.5),
            (9.4, 19.3),
            (1.7, 12.2),
        ];
        let mut counted = vec![0_u8; 400];
        let mut outline = raster(20, 20);
        for index in 1..fan.len() - 1 {
            let corners = [fan[0], fan[index], fan[index + 1]].map(|(x, y)| (x, y, 0.0));
            let mut one = raster(20, 20);
            filled(&mut one, corners, 200);
            filled(&mut outline, corners, 200);
            for (count, pixel) in counted.iter_mut().zip(&one.pixels) {
                *count += u8::from(pixel[3] > 0);
            }
        }
        assert!(counted.iter().all(|count| *count <= 1));
        let covered: usize = counted.iter().map(|count| usize::from(*count)).sum();
        // Half of Σ x₁y₂ − x₂y₁.
        assert!((covered as f32 - 243.0).abs() < 12.0, "{covered}");
        assert_eq!(
            outline.pixels.iter().filter(|it| it[3] > 0).count(),
            covered
        );
    }

    #[test]
    fn the_nearer_one_is_seen_whatever_comes_first() {
        let far = [(0.0, 0.0, 1.0), (40.0, 0.0, 1.0), (0.0, 40.0, 1.0)];
        let near = far.map(|(x, y, _)| (x, y, 2.0));
        for order in [[(far, 10), (near, 20)], [(near, 20), (far, 10)]] {
            let mut raster = raster(10, 10);
            for (corners, shade) in order {
                filled(&mut raster, corners, shade);
            }
            assert!(raster.pixels.iter().all(|pixel| pixel[0] == 20));
        }
    }

    #[test]
    fn no_triangle_is_too_large_or_too_thin() {
        let mut raster = raster(8, 8);
        let huge = 1e30;
        for corners in [
            [(-huge, -huge, 0.0), (huge, -huge, 0.0), (0.0, huge, huge)],
            [(f32::NAN, 0.0, 0.0), (3.0, 3.0, 0.0), (0.0, 5.0, 0.0)],
            [(1.0, 1.0, 0.0), (1.0, 1.0, 0.0), (1.0, 1.0, 0.0)],
            [(f32::INFINITY, 0.0, 0.0), (3.0, 3.0, 0.0), (0.0, 5.0, 0.0)],
        ] {
            filled(&mut raster, corners, 9);
        }
        raster.draw_line(Vec3::ZERO, Vec3::ZERO, 1.0, [1, 2, 3, 255]);
    }

    #[test]
    fn a_picture_is_the_mean_of_its_samples() {
        let mut raster = raster(4, 2);
        filled(
            &mut raster,
            [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 9.0, 0.0)],
            200,
        );
        let picture = raster.downsample(2);
        assert_eq!(picture.len(), 2);
        assert_eq!(picture[1], [0; 4]);
        assert_eq!(picture[0], [100, 0, 0, 128]);
    }
}
