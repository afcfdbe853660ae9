//! The order in which photos were taken: by their times, else by the numbers in their names.

use std::path::Path;
use std::time::Duration;

use crate::image_file::{TimeTaken, natural_key};

/// Files that a camera wrote lie further apart than this in the mean; files that were copied do not.
const MIN_MEAN_PACE: Duration = Duration::from_secs(1);

/// Cameras count to this number and begin again.
const LAST_COUNT: u64 = 9999;

/// Files in the order in which they were taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TakenOrder {
    /// Indices of the files, the first taken first.
    pub by_time: Option<Vec<usize>>,
    /// The same by the numbers in their names, across the end of a camera's count.
    pub by_name: Vec<usize>,
}

impl TakenOrder {
    /// The order in force: by time where times are known.
    pub fn order(&self) -> &[usize] {
        self.by_time.as_ref().unwrap_or(&self.by_name)
    }

    /// Whether names say another order than times.
    pub fn disagrees(&self) -> bool {
        self.by_time.as_ref().is_some_and(|by_time| *by_time != self.by_name)
    }
}

/// The order in which files were taken. Times count where `time_taken` has one for every file; times of files alone only
/// where they lie as far apart as photos do, for copying a folder gives all files the same minute.
pub fn order_taken<P: AsRef<Path>>(files: &[P], time_taken: impl Fn(&Path) -> Option<TimeTaken>) -> TakenOrder {
    let by_name = by_name(files);
    let times: Option<Vec<TimeTaken>> = files.iter().map(|file| time_taken(file.as_ref())).collect();
    let by_time = times.filter(|times| are_of_photos(times)).map(|times| {
        let mut order = by_name.clone();
        order.sort_by_key(|&index| times[index].time());
        order
    });
    TakenOrder { by_time, by_name }
}

fn are_of_photos(times: &[TimeTaken]) -> bool {
    if times.iter().all(|time| matches!(time, TimeTaken::Camera(_))) {
        return true;
    }
    let all = || times.iter().map(|time| time.time());
    let span = all().max().zip(all().min()).and_then(|(last, first)| last.duration_since(first).ok());
    span.is_some_and(|span| span >= MIN_MEAN_PACE * (times.len() as u32).saturating_sub(1).max(1))
}

fn by_name<P: AsRef<Path>>(files: &[P]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..files.len()).collect();
    order.sort_by_cached_key(|&index| natural_key(&files[index].as_ref().to_string_lossy()));
    let counts: Option<Vec<u64>> = order.iter().map(|&index| last_number(files[index].as_ref())).collect();
    // 0001, 0002, 9998, 9999: the gap is where the photos begin.
    if let Some(counts) = counts.filter(|counts| counts.first() <= Some(&1) && counts.last() == Some(&LAST_COUNT))
        && let Some(gap) = counts.windows(2).position(|pair| pair[1] > pair[0] + 1)
    {
        order.rotate_left(gap + 1);
    }
    order
}

/// The number at the end of a file's name.
fn last_number(file: &Path) -> Option<u64> {
    let stem = file.file_stem()?.to_string_lossy().into_owned();
    stem[stem.trim_end_matches(|c: char| c.is_ascii_digit()).len()..].parse().ok()
}

#[cfg(test)]
mod tests {
    use std::time::SystemTime;

    use super::*;

    const FILES: [&str; 4] = ["DSC_0000.tif", "DSC_0001.tif", "DSC_9998.tif", "DSC_9999.tif"];

    fn seconds_apart(seconds: f64, order: [usize; 4]) -> impl Fn(&Path) -> Option<TimeTaken> {
        move |file| {
            let index = FILES.iter().position(|name| Path::new(name) == file)?;
            Some(TimeTaken::File(SystemTime::UNIX_EPOCH + Duration::from_secs_f64(1e9 + seconds * order[index] as f64)))
        }
    }

    #[test]
    fn photos_are_ordered_by_the_time_they_were_taken_and_not_by_name() {
        let taken = order_taken(&FILES, seconds_apart(10.0, [3, 1, 0, 2]));
        assert_eq!(taken.order(), [2, 1, 3, 0]);
        assert!(taken.disagrees());
        let agreeing = order_taken(&FILES, seconds_apart(2.0, [2, 3, 0, 1]));
        assert!(agreeing.by_time.is_some() && !agreeing.disagrees());
    }

    #[test]
    fn a_count_that_began_again_is_followed_where_times_say_nothing() {
        for no_times in [order_taken(&FILES, |_| None), order_taken(&FILES, seconds_apart(0.01, [0, 2, 1, 3]))] {
            assert_eq!(no_times.by_time, None);
            assert_eq!(no_times.order(), [2, 3, 0, 1]);
        }
        assert_eq!(order_taken(&["b10.png", "b9.png"], |_| None).order(), [1, 0]);
        // What the camera itself wrote counts however fast the photos came.
        let at = |file: &Path| seconds_apart(0.01, [0, 2, 1, 3])(file).map(|taken| TimeTaken::Camera(taken.time()));
        assert_eq!(order_taken(&FILES, at).order(), [0, 2, 1, 3]);
    }
}
