//! Light on a surface, by the formulas of the fragment shader.

use glam::{Mat4, Vec2, Vec3, Vec4, vec3};

use super::visibility::SurfaceCorner;
use crate::frame::{FrameInputs, LIGHT};

/// Width and height of a shadow map, pixels.
const SHADOW_SIDE: usize = 1024;
/// Distance along the surface normal by which the shadow is read, pixels of the shadow map, so that
/// a surface does not shade itself.
const SHADOW_SHIFT_PIXELS: f32 = 2.5;
/// Depth towards the light within which a surface is not in the shadow, 0 to 1.
const SHADOW_BIAS: f32 = 0.0016;

/// A shadow map: depths of the scene as the main light sees them.
#[derive(Clone, Debug)]
pub struct ShadowMap {
    depths: Vec<f32>,
    projection: Mat4,
    mm_per_pixel: f32,
}

impl ShadowMap {
    /// Size of the depth picture from which a shadow map is made, pixels.
    pub const SIZE: [usize; 2] = [SHADOW_SIDE; 2];

    /// Creates a shadow map from the depths of a picture drawn with `projection`.
    pub fn new(depths: &[f32], projection: Mat4) -> Self {
        let across = projection.row(0).truncate().length();
        Self {
            depths: depths.to_vec(),
            projection,
            mm_per_pixel: 2.0 / (across.max(1e-9) * SHADOW_SIDE as f32),
        }
    }

    /// Returns the share of the main light that reaches a surface, 0 to 1.
    fn light_at(&self, position: Vec3, normal: Vec3) -> f32 {
        let shifted = position + normal * (self.mm_per_pixel * SHADOW_SHIFT_PIXELS);
        let at = self.projection.project_point3(shifted);
        let side = SHADOW_SIDE as f32;
        let place = Vec2::new(at.x * 0.5 + 0.5, 0.5 - at.y * 0.5) * side - Vec2::splat(0.5);
        let low = place.floor();
        let share = place - low;
        let lit = |column: f32, row: f32| {
            let is_inside = column >= 0.0 && row >= 0.0 && column < side && row < side;
            let index = row.max(0.0) as usize * SHADOW_SIDE + column.max(0.0) as usize;
            let depth = self.depths.get(index).filter(|_| is_inside);
            depth.is_none_or(|depth| at.z - SHADOW_BIAS <= *depth)
        };
        let weight = |is_lit: bool| f32::from(u8::from(is_lit));
        let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
        let above = mix(
            weight(lit(low.x, low.y)),
            weight(lit(low.x + 1.0, low.y)),
            share.x,
        );
        let below = mix(
            weight(lit(low.x, low.y + 1.0)),
            weight(lit(low.x + 1.0, low.y + 1.0)),
            share.x,
        );
        mix(above, below, share.y)
    }
}

/// Returns the background colour at a height in the picture, 0 (below) to 1.
pub fn ground(scene: &FrameInputs, height: f32) -> Vec3 {
    scene.ground[0].lerp(scene.ground[1], height)
}

fn smoothstep(from: f32, to: f32, value: f32) -> f32 {
    let share = ((value - from) / (to - from)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// Returns the light of the studio's bright strips in the direction of a reflected ray.
fn studio(ray: Vec3, rough: f32, sky: f32) -> Vec3 {
    let walls = vec3(0.08, 0.08, 0.09).lerp(vec3(0.66, 0.71, 0.78), smoothstep(-0.35, 0.8, ray.y));
    let ceiling = 1.6
        * smoothstep(0.70 - rough * 0.25, 0.80 + rough * 0.25, ray.y)
        * (1.0 - smoothstep(0.10, 0.55 + rough, (ray.z + 0.25).abs()));
    let front = 0.5
        * (1.0 - smoothstep(0.0, 0.25 + rough * 0.4, (ray.y - 0.18).abs()))
        * smoothstep(0.2, 0.8, ray.z);
    let side = 0.55 + 0.45 * smoothstep(-0.9, 0.4, ray.z + ray.x * 0.4);
    (walls + Vec3::splat(ceiling + front)) * (side * sky)
}

/// Computes the colour of a surface, multiplied by its opacity. `height` is that of the pixel in
/// the picture, 0 (below) to 1.
pub fn shade(
    surface: &SurfaceCorner,
    scene: &FrameInputs,
    shadow: Option<&ShadowMap>,
    height: f32,
    alpha: f32,
) -> Vec4 {
    let light = LIGHT.normalize();
    let view = (scene.eye - surface.position).normalize_or(Vec3::Z);
    let mut normal = surface.normal.normalize_or(Vec3::Y);
    if normal.dot(view) < 0.0 {
        normal = -normal;
    }
    let color = surface.color.truncate();
    let exposure = surface.color.w;
    let metal = surface.finish.y;
    let position = surface.position;
    let rings = match surface.finish.z > 0.0 {
        true => {
            let across = Vec2::new(position.y, position.z).length();
            surface.finish.z * 0.10 * (position.x * 4.6).sin() * (across * 5.2 + position.x).sin()
        }
        false => 0.0,
    };
    let rough = surface.finish.x + rings * 0.5;
    let base = color * color * (1.0 + rings);
    let facing = normal.dot(light).max(0.0);
    let key = match shadow {
        Some(map) if facing > 0.0 => facing * map.light_at(position, normal),
        Some(_) | None => facing,
    };
    let sky = vec3(0.22, 0.215, 0.21).lerp(vec3(0.60, 0.64, 0.70), normal.y * 0.5 + 0.5)
        * (exposure * scene.sky);
    let ray = 2.0 * normal.dot(view) * normal - view;
    let power = (10.0 * (1.0 - rough)).exp2();
    let half = (view + light).normalize_or(normal);
    let gloss = normal.dot(half).max(0.0).powf(power) * (power + 2.0) * 0.06;
    let rim = (1.0 - normal.dot(view).max(0.0)).powi(4);
    let mirror = Vec3::splat(0.04).lerp(base, metal);
    let mirror = mirror + (Vec3::ONE - mirror) * (rim * (1.0 - rough) * 0.6);
    let fill = normal.dot(vec3(-0.5, 0.25, 0.82)).max(0.0) * 0.26 * scene.sky;
    let open = 1.0 + (exposure - 1.0) * 0.85;
    let reflected = studio(ray, rough, scene.sky) * (open * (1.0 - 0.35 * rough))
        + Vec3::splat(gloss * key * 1.3);
    let lit = sky + vec3(1.05, 1.0, 0.94) * (key * 1.45 + fill * exposure);
    let sum =
        base * (1.0 - metal * 0.82) * lit + mirror * reflected + base * (surface.finish.w * 1.3);
    let curve = sum * (2.51 * sum + Vec3::splat(0.03))
        / (sum * (2.43 * sum + Vec3::splat(0.59)) + Vec3::splat(0.14));
    let shown = curve.clamp(Vec3::ZERO, Vec3::ONE).map(f32::sqrt);
    let away = Vec2::new(position.x - scene.centre.x, position.z - scene.centre.z).length();
    let faded = shown.lerp(
        ground(scene, height),
        smoothstep(scene.fade[0], scene.fade[1], away),
    );
    let alpha = match alpha < 1.0 {
        true => alpha + 0.35 * (1.0 - normal.dot(view).abs()).max(0.0).powi(3),
        false => 1.0,
    };
    (faded * alpha).extend(alpha)
}
