//! Panics of the libraries that read what someone else wrote: caught, and not reported on top of the error.
//!
//! Only the calling thread is covered, so no work for other threads is done inside; and no guard helps against an
//! allocation that fails, which ends the process.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe, catch_unwind};
use std::sync::Once;

thread_local! {
    static DEPTH: Cell<usize> = const { Cell::new(0) };
}

/// The work panicked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Panicked;

/// Does `work`, and catches its panic in silence.
///
/// # Errors
/// [`Panicked`].
pub fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, Panicked> {
    static SILENCED: Once = Once::new();
    SILENCED.call_once(|| {
        let report = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !is_guarded() {
                report(info);
            }
        }));
    });
    DEPTH.set(DEPTH.get() + 1);
    let outcome = catch_unwind(AssertUnwindSafe(work));
    DEPTH.set(DEPTH.get() - 1);
    outcome.map_err(|_| Panicked)
}

/// Whether a panic of this thread will be caught by [`guarded`]: a panic hook then has nothing to save or to say.
pub fn is_guarded() -> bool {
    DEPTH.get() > 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_inside_is_an_error_and_the_guard_ends_with_it() {
        assert_eq!(guarded(|| guarded(|| 7)), Ok(Ok(7)));
        assert_eq!(guarded(|| panic!("a decoder's own bug")), Err::<(), _>(Panicked));
        assert!(!is_guarded() && guarded(is_guarded) == Ok(true));
    }
}
