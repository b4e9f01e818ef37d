//! What the part consists of: colours of its surfaces, colour and shape of its chips.

use glam::{Vec3, vec3};

/// Feed of steel below which chips are ribbons, mm per turn.
const RIBBON_FEED: f32 = 0.08;
const NEEDLE_FEED: f32 = 0.32;
/// Feed of a tough material below which chips are ribbons, mm per turn.
const TOUGH_RIBBON_FEED: f32 = 0.16;

/// The shape of a chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChipShape {
    /// A short chip of a heavy cut.
    Needle,
    /// The chip is coiled.
    Curl,
    /// A long wavy chip of a fine cut.
    Ribbon,
    /// A glowing particle instead of a chip.
    Spark,
}

/// The material of the part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PartMaterial {
    /// The part is carbon steel.
    #[default]
    Steel,
    /// The part is stainless steel.
    Stainless,
    /// The part is grey cast iron.
    CastIron,
    /// The part is an aluminium alloy.
    Aluminium,
    /// The part is brass.
    Brass,
    /// The part is plastic.
    Plastic,
}

impl PartMaterial {
    /// All materials of a part.
    pub const ALL: [Self; 6] = [
        Self::Steel,
        Self::Stainless,
        Self::CastIron,
        Self::Aluminium,
        Self::Brass,
        Self::Plastic,
    ];

    /// Returns the colours of a cut surface and of the uncut bar surface as sRGB, 0 to 1.
    pub const fn colors(self) -> [Vec3; 2] {
        match self {
            Self::Steel => [vec3(0.80, 0.80, 0.815), vec3(0.40, 0.385, 0.38)],
            Self::Stainless => [vec3(0.86, 0.86, 0.865), vec3(0.62, 0.615, 0.61)],
            Self::CastIron => [vec3(0.58, 0.59, 0.61), vec3(0.33, 0.325, 0.33)],
            Self::Aluminium => [vec3(0.91, 0.915, 0.93), vec3(0.74, 0.745, 0.76)],
            Self::Brass => [vec3(0.92, 0.76, 0.40), vec3(0.64, 0.50, 0.27)],
            Self::Plastic => [vec3(0.94, 0.94, 0.91), vec3(0.84, 0.84, 0.80)],
        }
    }

    /// Returns how metallic the surface reflects, 0 to 1.
    pub const fn metal(self) -> f32 {
        match self {
            Self::Plastic => 0.0,
            Self::Steel | Self::Stainless | Self::CastIron | Self::Aluminium | Self::Brass => 1.0,
        }
    }

    /// Returns the shape of the chips at `feed`, mm per turn.
    pub fn chip_shape(self, feed: f32) -> ChipShape {
        match self {
            Self::Brass | Self::CastIron => ChipShape::Needle,
            Self::Plastic => ChipShape::Ribbon,
            Self::Steel if feed > NEEDLE_FEED => ChipShape::Needle,
            Self::Steel if feed < RIBBON_FEED => ChipShape::Ribbon,
            Self::Stainless | Self::Aluminium if feed < TOUGH_RIBBON_FEED => ChipShape::Ribbon,
            Self::Steel | Self::Stainless | Self::Aluminium => ChipShape::Curl,
        }
    }

    /// Returns the sRGB colour of the chips at a cutting speed, m/min: heat tempers steel bright,
    /// straw, brown, blue.
    pub fn chip_color(self, speed: f32) -> [u8; 3] {
        match (self, speed) {
            (Self::CastIron, _) => [96, 98, 104],
            (Self::Aluminium, _) => [222, 224, 230],
            (Self::Brass, _) => [220, 180, 88],
            (Self::Plastic, _) => [240, 240, 230],
            (Self::Steel | Self::Stainless, speed) if speed < 70.0 => [190, 194, 200],
            (Self::Steel | Self::Stainless, speed) if speed < 140.0 => [206, 178, 104],
            (Self::Steel | Self::Stainless, speed) if speed < 220.0 => [138, 88, 84],
            (Self::Steel | Self::Stainless, _) => [70, 92, 158],
        }
    }

    /// Returns the cutting speed above which a cut throws sparks, m/min; `None` if the material
    /// throws none.
    pub const fn spark_speed(self) -> Option<f32> {
        match self {
            Self::Steel => Some(450.0),
            Self::Stainless => Some(300.0),
            Self::CastIron => Some(350.0),
            Self::Aluminium | Self::Brass | Self::Plastic => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shape_and_colour_of_chips_follow_material_feed_and_speed() {
        let shapes = |material: PartMaterial| [0.02, 0.2, 0.5].map(|it| material.chip_shape(it));
        let [needle, curl, ribbon] = [ChipShape::Needle, ChipShape::Curl, ChipShape::Ribbon];
        assert_eq!(shapes(PartMaterial::Steel), [ribbon, curl, needle]);
        assert_eq!(shapes(PartMaterial::Stainless), [ribbon, curl, curl]);
        assert_eq!(shapes(PartMaterial::Brass), [needle; 3]);
        assert_eq!(shapes(PartMaterial::Plastic), [ribbon; 3]);
        let colors = [20.0, 100.0, 180.0, 300.0].map(|it| PartMaterial::Steel.chip_color(it));
        assert!(colors.windows(2).all(|pair| pair[0] != pair[1]));
        let at_rest = PartMaterial::ALL.map(|it| it.chip_color(300.0));
        assert_eq!(at_rest[0], at_rest[1]);
        assert!(at_rest[1..].windows(2).all(|pair| pair[0] != pair[1]));
    }

    #[test]
    fn a_cut_surface_is_brighter_than_the_skin() {
        for material in PartMaterial::ALL {
            let [cut, skin] = material.colors().map(Vec3::element_sum);
            assert!(cut > skin + 0.2, "{material:?}");
        }
    }
}
