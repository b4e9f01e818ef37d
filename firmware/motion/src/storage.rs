//! Collections with a fixed capacity: in the board without an allocator, on a computer with the
//! standard library.

#[cfg(feature = "heapless")]
pub use heapless::{Deque, Vec};
#[cfg(not(feature = "heapless"))]
pub use hosted::{Deque, Vec};

#[cfg(not(feature = "heapless"))]
mod hosted {
    extern crate alloc;

    use alloc::collections::VecDeque;
    use core::ops::{Deref, DerefMut};

    /// A queue of at most `N` items.
    #[derive(Clone, Debug)]
    pub struct Deque<T, const N: usize>(VecDeque<T>);

    impl<T, const N: usize> Deque<T, N> {
        pub const fn new() -> Self {
            Self(VecDeque::new())
        }

        pub fn push_back(&mut self, item: T) -> Result<(), T> {
            if self.is_full() {
                return Err(item);
            }
            self.0.push_back(item);
            Ok(())
        }

        pub fn pop_front(&mut self) -> Option<T> {
            self.0.pop_front()
        }

        pub fn pop_back(&mut self) -> Option<T> {
            self.0.pop_back()
        }

        pub fn front(&self) -> Option<&T> {
            self.0.front()
        }

        pub fn len(&self) -> usize {
            self.0.len()
        }

        pub fn is_empty(&self) -> bool {
            self.0.is_empty()
        }

        pub fn is_full(&self) -> bool {
            self.0.len() >= N
        }

        pub fn clear(&mut self) {
            self.0.clear();
        }
    }

    impl<T, const N: usize> Default for Deque<T, N> {
        fn default() -> Self {
            Self::new()
        }
    }

    /// A vector of at most `N` items.
    #[derive(Clone, Debug, PartialEq, Eq)]
    pub struct Vec<T, const N: usize>(alloc::vec::Vec<T>);

    impl<T, const N: usize> Vec<T, N> {
        pub const fn new() -> Self {
            Self(alloc::vec::Vec::new())
        }

        pub fn from_slice(items: &[T]) -> Result<Self, ()>
        where
            T: Clone,
        {
            let fits = items.len() <= N;
            fits.then(|| Self(items.to_vec())).ok_or(())
        }

        pub fn push(&mut self, item: T) -> Result<(), T> {
            if self.0.len() >= N {
                return Err(item);
            }
            self.0.push(item);
            Ok(())
        }

        pub fn clear(&mut self) {
            self.0.clear();
        }
    }

    impl<T, const N: usize> Default for Vec<T, N> {
        fn default() -> Self {
            Self::new()
        }
    }

    impl<T, const N: usize> Extend<T> for Vec<T, N> {
        fn extend<I: IntoIterator<Item = T>>(&mut self, items: I) {
            let room = N - self.0.len();
            self.0.extend(items.into_iter().take(room));
        }
    }

    impl<T, const N: usize> Deref for Vec<T, N> {
        type Target = [T];

        fn deref(&self) -> &[T] {
            &self.0
        }
    }

    impl<T, const N: usize> DerefMut for Vec<T, N> {
        fn deref_mut(&mut self) -> &mut [T] {
            &mut self.0
        }
    }

    impl<'a, T, const N: usize> IntoIterator for &'a Vec<T, N> {
        type Item = &'a T;
        type IntoIter = core::slice::Iter<'a, T>;

        fn into_iter(self) -> Self::IntoIter {
            self.0.iter()
        }
    }

    impl<'a, T, const N: usize> IntoIterator for &'a mut Vec<T, N> {
        type Item = &'a mut T;
        type IntoIter = core::slice::IterMut<'a, T>;

        fn into_iter(self) -> Self::IntoIter {
            self.0.iter_mut()
        }
    }
}
