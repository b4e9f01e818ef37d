//! Runs an action before a panic of the window unwinds it.

use std::panic;
use std::thread;

/// Installs a panic hook that calls `then` first if this thread panics, because libraries of
/// the window may take long to unwind.
pub fn before_panic(then: impl Fn() + Send + Sync + 'static) {
    let own_thread = thread::current().id();
    let before = panic::take_hook();
    panic::set_hook(Box::new(move |panic| {
        if thread::current().id() == own_thread {
            then();
        }
        before(panic);
    }));
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU32, Ordering};

    use super::*;

    #[test]
    fn a_panic_of_this_thread_alone_calls_it() {
        let called = Arc::new(AtomicU32::new(0));
        let hook = Arc::clone(&called);
        before_panic(move || {
            hook.fetch_add(1, Ordering::Relaxed);
        });
        let other = thread::spawn(|| panic!("another thread, on purpose"));
        assert!(other.join().is_err());
        assert_eq!(called.load(Ordering::Relaxed), 0);
        assert!(panic::catch_unwind(|| panic!("this thread, on purpose")).is_err());
        assert_eq!(called.load(Ordering::Relaxed), 1);
    }
}
