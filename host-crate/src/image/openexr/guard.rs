//! Panics of a decoder on damaged files, turned into errors.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

thread_local! {
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Runs `decode`; nothing if it panicked, which is then not reported on stderr either. It must work
/// on this thread alone. (The EXR crate panics on some damaged files, for one with B44
/// compression.)
pub(super) fn catch_panic<T>(decode: impl FnOnce() -> T) -> Option<T> {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| {
        let report = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !GUARDED.get() {
                report(info);
            }
        }));
    });
    let outer = GUARDED.replace(true);
    // What `decode` may have left half done is dropped by every caller.
    let result = panic::catch_unwind(AssertUnwindSafe(decode));
    GUARDED.set(outer);
    result.ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panics_are_caught_and_values_passed() {
        assert_eq!(catch_panic(|| 7), Some(7));
        let beyond = std::hint::black_box(3);
        assert_eq!(catch_panic(|| [1, 2, 3][beyond]), None);
        assert!(!GUARDED.get());
    }
}
