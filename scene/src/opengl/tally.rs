//! Counts the objects of OpenGL and their memory.

use core::cell::Cell;

/// Number of existing objects, and the bytes of their contents.
#[derive(Clone, Debug, Default)]
pub struct ObjectTally {
    objects: Cell<i64>,
    bytes: Cell<i64>,
}

impl ObjectTally {
    /// Adds created objects; negative: deleted ones.
    pub(crate) fn add(&self, objects: i64, bytes: i64) {
        self.objects.set(self.objects.get() + objects);
        self.bytes.set(self.bytes.get() + bytes);
    }

    /// Forgets all objects, which went with their context.
    pub(crate) fn clear(&self) {
        self.objects.set(0);
        self.bytes.set(0);
    }

    /// Number of existing objects.
    pub const fn objects(&self) -> i64 {
        self.objects.get()
    }

    /// Bytes of their contents.
    pub const fn bytes(&self) -> i64 {
        self.bytes.get()
    }
}
