//! Which files a scene is of, and whether they have changed.

use notify::{Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Programs write a file in several steps: it is at rest so long after the last one.
const REST: Duration = Duration::from_millis(200);

/// Files that are watched. Their folders are: most programs write a new file and rename it.
pub struct Watch {
    watcher: RecommendedWatcher,
    folders: BTreeSet<PathBuf>,
    state: Arc<Mutex<State>>,
}

#[derive(Default)]
struct State {
    files: BTreeSet<PathBuf>,
    changed: Option<Instant>,
}

impl Watch {
    /// Watches nothing yet; `wake` is called when a file changes.
    ///
    /// # Errors
    /// If the system cannot watch files.
    pub fn new(wake: impl Fn() + Send + 'static) -> notify::Result<Self> {
        let state = Arc::new(Mutex::new(State::default()));
        let kept = Arc::clone(&state);
        let watcher = notify::recommended_watcher(move |event: notify::Result<Event>| {
            let mut state = lock(&kept);
            if event.is_ok_and(|event| concerns(&event, &state.files)) {
                state.changed = Some(Instant::now());
                drop(state);
                wake();
            }
        })?;
        Ok(Self { watcher, folders: BTreeSet::new(), state })
    }

    /// Watches these files as well.
    ///
    /// # Errors
    /// If the system cannot watch one of their folders.
    pub fn add<'p>(&mut self, files: impl Iterator<Item = &'p Path>) -> notify::Result<()> {
        for file in files {
            let Some((folder, file)) = place(file) else { continue };
            lock(&self.state).files.insert(file);
            if !self.folders.contains(&folder) {
                self.watcher.watch(&folder, RecursiveMode::NonRecursive)?;
                self.folders.insert(folder);
            }
        }
        Ok(())
    }

    /// Whether a file has changed and is at rest; once for each change. Otherwise, where one has
    /// changed, when it will be.
    ///
    /// # Errors
    /// The time until then.
    pub fn take_change(&mut self, now: Instant) -> Result<bool, Duration> {
        let mut state = lock(&self.state);
        let Some(changed) = state.changed else { return Ok(false) };
        let rest = REST.saturating_sub(now.saturating_duration_since(changed));
        if rest > Duration::ZERO {
            return Err(rest);
        }
        state.changed = None;
        Ok(true)
    }
}

/// The folder of a file, and the file in it, by the paths that events have.
fn place(file: &Path) -> Option<(PathBuf, PathBuf)> {
    let parent = file.parent().filter(|parent| !parent.as_os_str().is_empty());
    let folder = parent.unwrap_or(Path::new(".")).canonicalize().ok()?;
    let file = folder.join(file.file_name()?);
    Some((folder, file))
}

/// Whether an event may have changed what is in one of the files.
fn concerns(event: &Event, files: &BTreeSet<PathBuf>) -> bool {
    let is_change = !matches!(event.kind, EventKind::Access(_));
    is_change && event.paths.iter().any(|path| files.contains(path))
}

fn lock(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether there is a change within a few seconds.
    fn changes(watch: &mut Watch, within: Duration) -> bool {
        let start = Instant::now();
        while start.elapsed() < within {
            if watch.take_change(Instant::now()) == Ok(true) {
                return true;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        false
    }

    const LONG: Duration = Duration::from_secs(20);
    const SHORT: Duration = Duration::from_millis(500);

    #[test]
    fn written_and_replaced_files_are_seen_once_and_others_never() {
        let folder = tempfile::tempdir().unwrap();
        let (file, other) = (folder.path().join("a.json"), folder.path().join("b.json"));
        std::fs::write(&file, "1").unwrap();
        let mut watch = Watch::new(|| ()).unwrap();
        watch.add([file.as_path()].into_iter()).unwrap();
        std::fs::write(&other, "1").unwrap();
        std::fs::read(&file).unwrap();
        assert!(!changes(&mut watch, SHORT), "another file, and one that is read");
        std::fs::write(&file, "2").unwrap();
        assert!(changes(&mut watch, LONG));
        assert!(!changes(&mut watch, SHORT), "it is one change");
        std::fs::rename(&other, &file).unwrap();
        assert!(changes(&mut watch, LONG), "a file in its place");
        std::fs::remove_file(&file).unwrap();
        assert!(changes(&mut watch, LONG));
    }

    #[test]
    fn a_change_counts_when_it_is_at_rest() {
        let mut watch = Watch::new(|| ()).unwrap();
        let now = Instant::now();
        assert_eq!(watch.take_change(now), Ok(false));
        lock(&watch.state).changed = Some(now);
        assert!(watch.take_change(now + REST / 2).is_err());
        assert_eq!(watch.take_change(now + REST), Ok(true));
        assert_eq!(watch.take_change(now + REST), Ok(false));
    }
}
