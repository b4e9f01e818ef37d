//! Counts the objects of OpenGL and their memory.

use core::cell::Cell;

/// Counts the existing OpenGL objects and the bytes of their contents.
#[derive(Clone, Debug, Default)]
pub struct ObjectTally {
    objects: Cell<i64>,
    bytes: Cell<i64>,
}

impl ObjectTally {
    /// Adds a number of created objects and their bytes; negative for deleted ones.
    pub(crate) fn add(&self, objects: i64, bytes: i64) {
        self.objects.set(self.objects.get() + objects);
        self.bytes.set(self.bytes.get() + bytes);
    }

    /// Sets the counts to 0 after a loss of the OpenGL context.
    pub(crate) fn clear(&self) {
        self.objects.set(0);
        self.bytes.set(0);
    }

    /// Returns the number of existing OpenGL objects.
    pub const fn objects(&self) -> i64 {
        self.objects.get()
    }

    /// Returns the size of the contents of all existing OpenGL objects, bytes.
    pub const fn bytes(&self) -> i64 {
        self.bytes.get()
    }
}
