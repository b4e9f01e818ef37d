//! The framebuffers of a scene: the picture, the layer of what stands still, the shadow maps.

use crate::opengl::device::{Device, DrawTarget, SceneError};

/// Width and height of a shadow map, pixels.
const SHADOW_SIDE: i32 = 1024;

/// All framebuffers into which a scene is drawn.
#[derive(Debug)]
pub struct SceneTargets {
    /// Framebuffer of the finished picture.
    pub picture: DrawTarget,
    /// Framebuffer of the picture with smoothed edges, if it is smaller than the viewport.
    pub smooth: DrawTarget,
    /// Framebuffer of the stationary parts, which is copied into each picture.
    pub fixed: DrawTarget,
    /// Shadow map of the stationary parts.
    pub fixed_shadow: DrawTarget,
    /// Shadow map of all parts.
    pub shadow: DrawTarget,
}

impl SceneTargets {
    /// Creates framebuffers for a picture of `size` pixels.
    pub fn create(device: Device<'_>, size: [i32; 2]) -> Result<Self, SceneError> {
        Ok(Self {
            picture: device.create_target(size)?,
            smooth: device.create_target(size)?,
            fixed: device.create_target(size)?,
            fixed_shadow: device.create_shadow_map(SHADOW_SIDE)?,
            shadow: device.create_shadow_map(SHADOW_SIDE)?,
        })
    }

    /// Recreates the framebuffers of the picture if their size differs. Returns true if it did.
    pub fn resize(&mut self, device: Device<'_>, size: [i32; 2]) -> Result<bool, SceneError> {
        if self.picture.size == size {
            return Ok(false);
        }
        for target in [&mut self.picture, &mut self.smooth, &mut self.fixed] {
            let resized = device.create_target(size)?;
            device.delete_target(&core::mem::replace(target, resized));
        }
        Ok(true)
    }

    /// Deletes all framebuffers.
    pub fn release(&self, device: Device<'_>) {
        let Self {
            picture,
            smooth,
            fixed,
            fixed_shadow,
            shadow,
        } = self;
        for target in [picture, smooth, fixed, fixed_shadow, shadow] {
            device.delete_target(target);
        }
    }
}
