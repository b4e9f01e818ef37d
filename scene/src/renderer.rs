//! Draws a description of a lathe into a viewport of egui.

pub use crate::device::SceneError;
pub use crate::viewport::{SceneFigures, SceneViewport};

use crate::camera::OrbitCamera;
use crate::description::LatheDescription;
use crate::device::Device;
use crate::objects::SceneObjects;

/// Draws lathes with one OpenGL context; survives its loss.
#[derive(Debug, Default)]
pub struct SceneRenderer {
    objects: Option<SceneObjects>,
    /// Address of the context that has created the objects.
    context: usize,
}

impl SceneRenderer {
    /// Draws a lathe into a viewport. `gl` must be current, as in a paint callback of egui.
    ///
    /// # Errors
    /// The context is too old, or refuses an object. It is then as egui expects it, and the
    /// next call tries again.
    pub fn paint(
        &mut self,
        gl: &glow::Context,
        lathe: &LatheDescription,
        camera: &OrbitCamera,
        viewport: SceneViewport,
    ) -> Result<SceneFigures, SceneError> {
        let device = Device::new(gl);
        let context = core::ptr::from_ref(gl).addr();
        let is_lost = |objects: &SceneObjects| context != self.context || !objects.is_alive(device);
        if self.objects.as_ref().is_some_and(is_lost) {
            // The objects went with their context: their names mean nothing.
            self.objects = None;
        }
        self.context = context;
        let drawn = self.paint_objects(device, lathe, camera, viewport);
        device.restore_output(viewport.output, viewport.pixels);
        if drawn.is_err() {
            self.release(gl);
        }
        drawn
    }

    fn paint_objects(
        &mut self,
        device: Device<'_>,
        lathe: &LatheDescription,
        camera: &OrbitCamera,
        viewport: SceneViewport,
    ) -> Result<SceneFigures, SceneError> {
        let objects = match self.objects.take() {
            Some(objects) => self.objects.insert(objects),
            None => self.objects.insert(SceneObjects::create(device, lathe)?),
        };
        objects.paint(device, lathe, camera, viewport)
    }

    /// Deletes all objects. `gl` must be the current context.
    pub fn release(&mut self, gl: &glow::Context) {
        if let Some(objects) = self.objects.take() {
            objects.release(Device::new(gl));
        }
    }
}
