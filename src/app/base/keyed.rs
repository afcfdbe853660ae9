//! Work for a key: what it was asked for last, and what came of it, kept until the next outcome is there.

use std::sync::Arc;

use super::jobs::{Job, JobError, Task};

/// Results of type `T` that depend on a `K`. Work that was asked for runs to its end before the next begins.
pub struct Keyed<K, T> {
    running: Option<(K, Task<T>)>,
    last: Option<(K, Result<Arc<T>, JobError>)>,
}

impl<K, T> Default for Keyed<K, T> {
    fn default() -> Self {
        Self { running: None, last: None }
    }
}

impl<K: PartialEq, T> Keyed<K, T> {
    /// Takes what is finished. Once a frame; the outcome where it has just come.
    pub fn poll(&mut self) -> Option<&Result<Arc<T>, JobError>> {
        let outcome = self.running.as_ref()?.1.poll()?;
        let (key, _) = self.running.take()?;
        let (_, last) = self.last.insert((key, outcome.map(Arc::new)));
        Some(last)
    }

    /// Whether work for `key` should start: nothing runs, and the last outcome is that of another key.
    pub fn wants(&self, key: &K) -> bool {
        self.running.is_none() && self.last.as_ref().is_none_or(|(last, _)| last != key)
    }

    /// Takes work for `key` that was started, in place of any that runs.
    pub fn start(&mut self, key: K, task: Task<T>) {
        self.running = Some((key, task));
    }

    /// Keeps an outcome that was taken, under the key that it now has.
    pub fn keep(&mut self, key: K, outcome: Result<Arc<T>, JobError>) {
        self.last = Some((key, outcome));
    }

    /// The work that runs.
    pub fn running(&self) -> Option<&Job> {
        self.running.as_ref().map(|(_, task)| task.job())
    }

    /// Whether work for `key` runs.
    pub fn runs(&self, key: &K) -> bool {
        self.running.as_ref().is_some_and(|(running, _)| running == key)
    }

    /// The last outcome, and the key that it is of.
    pub fn last(&self) -> Option<(&K, &Result<Arc<T>, JobError>)> {
        self.last.as_ref().map(|(key, outcome)| (key, outcome))
    }

    /// The last outcome, if it is that of `key`.
    pub fn of(&self, key: &K) -> Option<&Result<Arc<T>, JobError>> {
        self.last().filter(|(last, _)| *last == key).map(|(_, outcome)| outcome)
    }

    /// The last outcome, if it is a result.
    pub fn ready(&self) -> Option<&Arc<T>> {
        self.last()?.1.as_ref().ok()
    }

    /// The last outcome, if it is an error.
    pub fn error(&self) -> Option<&JobError> {
        self.last()?.1.as_ref().err()
    }

    /// Takes what is finished off the hands of this: the outcome and its key, once. For work whose result is put elsewhere.
    pub fn take(&mut self) -> Option<(K, Result<Arc<T>, JobError>)> {
        self.poll()?;
        self.last.take()
    }
}

/// A shared value that is equal to itself alone: a key that costs nothing to compare.
pub struct Same<T>(pub Arc<T>);

impl<T> PartialEq for Same<T> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::jobs::Jobs;
    use super::*;

    fn finished(keyed: &mut Keyed<u32, u32>) -> Result<Arc<u32>, JobError> {
        loop {
            if let Some(outcome) = keyed.poll() {
                return outcome.clone();
            }
            std::thread::yield_now();
        }
    }

    #[test]
    fn an_outcome_is_kept_until_that_of_the_next_key_is_there() {
        let mut jobs = Jobs::new(Arc::new(|| ()));
        let mut keyed = Keyed::<u32, u32>::default();
        assert!(keyed.wants(&1));
        keyed.start(1, jobs.compute("one", |_| 10));
        assert!(!keyed.wants(&2), "one at a time");
        assert_eq!(finished(&mut keyed).ok(), Some(Arc::new(10)));
        assert!(!keyed.wants(&1) && keyed.wants(&2));
        keyed.start(2, jobs.start("two", |_| Err::<u32, _>(std::fmt::Error)));
        assert_eq!(keyed.ready().map(|ten| **ten), Some(10));
        assert!(finished(&mut keyed).is_err());
        assert_eq!((keyed.error().is_some(), keyed.ready()), (true, None));
        assert!(keyed.of(&1).is_none() && keyed.of(&2).is_some() && !keyed.wants(&2), "a failure is not tried again");
    }

    #[test]
    fn only_the_same_shared_value_is_the_same() {
        let (a, b) = (Arc::new(1), Arc::new(1));
        assert!(Same(a.clone()) == Same(a.clone()) && Same(a) != Same(b));
    }
}
