//! Draws a description of a lathe into a viewport of egui.

pub use crate::opengl::device::SceneError;
pub use crate::viewport::{SceneFigures, SceneViewport};

use crate::camera::OrbitCamera;
use crate::description::LatheDescription;
use crate::opengl::device::Device;
use crate::opengl::objects::SceneObjects;
use crate::opengl::tally::ObjectTally;

/// Draws lathes with one OpenGL context; creates its objects again after a loss of the context.
#[derive(Debug, Default)]
pub struct SceneRenderer {
    objects: Option<SceneObjects>,
    /// Address of the OpenGL context that owns the objects.
    context: usize,
    tally: ObjectTally,
}

impl SceneRenderer {
    /// Draws a lathe into a viewport. `gl` must be current, as in a paint callback of egui.
    ///
    /// # Errors
    ///
    /// Returns an error if the context is too old, or refuses an object. The context then has the
    /// state that egui expects, and the next call tries again.
    pub fn paint(
        &mut self,
        gl: &glow::Context,
        lathe: &LatheDescription,
        camera: &OrbitCamera,
        viewport: SceneViewport,
    ) -> Result<SceneFigures, SceneError> {
        let device = Device::new(gl, &self.tally);
        let context = core::ptr::from_ref(gl).addr();
        let known_context = core::mem::replace(&mut self.context, context);
        let is_lost =
            |objects: &SceneObjects| context != known_context || !objects.is_alive(device);
        if self.objects.as_ref().is_some_and(is_lost) {
            // The objects went with their context: their names mean nothing.
            self.objects = None;
            self.tally.clear();
        }
        let drawn = paint_objects(&mut self.objects, device, lathe, camera, viewport);
        device.restore_output(viewport.output, viewport.pixels);
        if drawn.is_err() {
            self.release(gl);
        }
        drawn
    }

    /// Deletes all OpenGL objects. `gl` must be the current context.
    pub fn release(&mut self, gl: &glow::Context) {
        if let Some(objects) = self.objects.take() {
            objects.release(Device::new(gl, &self.tally));
        }
    }
}

fn paint_objects(
    known: &mut Option<SceneObjects>,
    device: Device<'_>,
    lathe: &LatheDescription,
    camera: &OrbitCamera,
    viewport: SceneViewport,
) -> Result<SceneFigures, SceneError> {
    let objects = match known.take() {
        Some(objects) => known.insert(objects),
        None => known.insert(SceneObjects::create(device, lathe)?),
    };
    objects.paint(device, lathe, camera, viewport)
}
