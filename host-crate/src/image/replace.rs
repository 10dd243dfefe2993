//! Files that appear whole or not at all.

use super::{Format, ImageError};
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Fails now if writing a picture to `path` would: its extension is not `.exr` or `.png`, its
/// folder does not exist or is not writable, or it names a folder, a device or a write-protected
/// file. Leaves nothing behind and does not touch an existing file.
///
/// # Errors
/// The [`ImageError`] that writing would give.
pub fn check_writable(path: &Path) -> Result<(), ImageError> {
    Format::of(path)?;
    check_replaceable(path)
}

/// As [`check_writable`], for files of any kind.
pub(crate) fn check_replaceable(path: &Path) -> Result<(), ImageError> {
    let target = Target::of(path)?;
    // What permissions mean (owners, access lists, read-only mounts) only the system knows: ask it.
    tempfile::tempfile_in(&target.folder)
        .map_err(|e| ImageError::from_write(path, &target.folder, e))?;
    Ok(())
}

/// Makes `bytes` the contents of `path`. On any error an existing file keeps its contents, and no
/// other file is left behind.
pub fn replace_file(path: &Path, bytes: &[u8]) -> Result<(), ImageError> {
    replace_file_with(path, |file| file.write_all(bytes))
}

/// As [`replace_file`], with the contents that `write` puts into the file.
pub(crate) fn replace_file_with(
    path: &Path,
    write: impl FnOnce(&mut File) -> io::Result<()>,
) -> Result<(), ImageError> {
    let target = Target::of(path)?;
    target.replace(write).map_err(|e| ImageError::from_write(path, &target.folder, e))
}

/// Temporary files that are being written.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files of pictures that other threads are writing; for a signal handler
/// that then ends the process. From now on no picture can be written: a thread that tries waits for
/// the end of the process.
pub fn discard_unfinished() {
    let unfinished = unfinished();
    for path in unfinished.iter() {
        // One that has just been renamed is finished.
        let _ = fs::remove_file(path);
    }
    std::mem::forget(unfinished);
}

/// A path in [`UNFINISHED`]; taken out when dropped.
struct Listed(PathBuf);

impl Drop for Listed {
    fn drop(&mut self) {
        unfinished().remove(&self.0);
    }
}

/// Where a picture goes.
struct Target {
    /// The file to replace or to create, symbolic links followed.
    file: PathBuf,
    /// Its folder, which exists.
    folder: PathBuf,
    /// The permissions of the file to replace.
    permissions: Option<fs::Permissions>,
}

impl Target {
    fn of(path: &Path) -> Result<Target, ImageError> {
        let existing = match fs::metadata(path) {
            Ok(metadata) => Some(metadata),
            Err(e) if e.kind() == io::ErrorKind::NotFound => None,
            Err(e) => return Err(ImageError::from_write(path, parent(path), e)),
        };
        let file = match &existing {
            Some(m) if m.is_dir() => return Err(ImageError::IsFolder { path: path.to_owned() }),
            Some(m) if !m.is_file() => return Err(ImageError::NotAFile { path: path.to_owned() }),
            Some(m) if m.permissions().readonly() => {
                return Err(ImageError::WriteProtected { path: path.to_owned() });
            }
            Some(_) => {
                path.canonicalize().map_err(|e| ImageError::from_write(path, parent(path), e))?
            }
            None => followed(path),
        };
        let folder = parent(&file).to_owned();
        if !folder.is_dir() {
            return Err(ImageError::NoFolder { path: path.to_owned(), folder });
        }
        Ok(Target { file, folder, permissions: existing.map(|m| m.permissions()) })
    }

    /// Puts what `write` writes in the place of the file. Where the system can, what is being
    /// written has no name before it is whole, so that nothing is left of it even where the process
    /// is killed.
    fn replace(&self, write: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
        let Some(mut nameless) = nameless_file(&self.folder) else {
            return self.rename(&mut self.named_file(tempfile_at)?, write);
        };
        self.fill(&mut nameless, write)?;
        match self.named_file(|path| name_file(&nameless, path)) {
            Ok(mut named) => self.rename(&mut named, |_| Ok(())),
            // A file system that cannot give names later.
            Err(_) => self.rename(&mut self.named_file(tempfile_at)?, |file| {
                nameless.seek(io::SeekFrom::Start(0))?;
                io::copy(&mut nameless, file).map(|_| ())
            }),
        }
    }

    /// Writes a file to its end, with the permissions that the target has or, if it is new, that it
    /// was made with.
    fn fill(
        &self,
        file: &mut File,
        write: impl FnOnce(&mut File) -> io::Result<()>,
    ) -> io::Result<()> {
        if let Some(permissions) = &self.permissions {
            file.set_permissions(permissions.clone())?;
        }
        write(file)?;
        // A disk may notice only now that it is full, and a rename must not outrun the contents.
        file.sync_all()
    }

    /// Fills a file beside the target and gives it the target's name.
    fn rename(
        &self,
        (_listed, temporary): &mut (Listed, tempfile::NamedTempFile),
        write: impl FnOnce(&mut File) -> io::Result<()>,
    ) -> io::Result<()> {
        self.fill(temporary.as_file_mut(), write)?;
        fs::rename(temporary.path(), &self.file)
    }

    /// A file with a name of its own in the target's folder, which `make` makes; removed when it is
    /// dropped.
    fn named_file(
        &self,
        make: impl FnMut(&Path) -> io::Result<File>,
    ) -> io::Result<(Listed, tempfile::NamedTempFile)> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".raystream-").suffix(".tmp");
        // Held, so that no file is made and not yet listed when the process ends.
        let mut unfinished = unfinished();
        let temporary = builder.make_in(&self.folder, make)?;
        unfinished.insert(temporary.path().to_owned());
        drop(unfinished);
        Ok((Listed(temporary.path().to_owned()), temporary))
    }
}

/// A new file, with the permissions that any program's would have.
fn tempfile_at(path: &Path) -> io::Result<File> {
    File::options().read(true).write(true).create_new(true).open(path)
}

/// A file in `folder` without a name, which is gone when it is closed; where the system has such.
#[cfg(target_os = "linux")]
fn nameless_file(folder: &Path) -> Option<File> {
    use rustix::fs::{Mode, OFlags};
    let flags = OFlags::TMPFILE | OFlags::RDWR | OFlags::CLOEXEC;
    // The system takes the umask off.
    rustix::fs::open(folder, flags, Mode::from_raw_mode(0o666)).ok().map(File::from)
}

/// Names a file that [`nameless_file`] made.
#[cfg(target_os = "linux")]
fn name_file(file: &File, path: &Path) -> io::Result<File> {
    use rustix::fs::{AtFlags, CWD, linkat};
    use std::os::fd::AsRawFd;
    let descriptor = format!("/proc/self/fd/{}", file.as_raw_fd());
    linkat(CWD, descriptor, CWD, path, AtFlags::SYMLINK_FOLLOW)?;
    file.try_clone()
}

/// None: every file has a name.
#[cfg(not(target_os = "linux"))]
fn nameless_file(_folder: &Path) -> Option<File> {
    None
}

/// Never called: every file has a name.
#[cfg(not(target_os = "linux"))]
fn name_file(_file: &File, _path: &Path) -> io::Result<File> {
    Err(io::ErrorKind::Unsupported.into())
}

/// The file that writing to `path` creates or replaces, symbolic links followed: two paths that
/// lead to one file have one answer. Nothing where its folder does not exist.
pub fn written_file(path: &Path) -> Option<PathBuf> {
    let file = followed(path);
    Some(parent(&file).canonicalize().ok()?.join(file.file_name()?))
}

/// Where a path leads by symbolic links, of which the last may lead to a file that is not there.
fn followed(path: &Path) -> PathBuf {
    /// As many as Linux follows; the system has already refused links in a circle.
    const MOST: usize = 40;
    let next = |path: &PathBuf| Some(parent(path).join(fs::read_link(path).ok()?));
    let links = std::iter::successors(Some(path.to_owned()), next).take(MOST);
    links.last().unwrap_or_else(|| path.to_owned())
}

fn parent(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn creates_and_replaces() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        replace_file(&path, b"one").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"one");
        replace_file(&path, b"2").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"2");
        assert_eq!(names(folder.path()), ["a.png"]);
    }

    #[test]
    fn failed_write_keeps_the_old_file_and_leaves_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        fs::write(&path, b"old").unwrap();
        let half_then_full = |file: &mut File| {
            file.write_all(b"half of the new contents")?;
            Err(io::ErrorKind::StorageFull.into())
        };
        let error = replace_file_with(&path, half_then_full).unwrap_err();
        assert!(matches!(error, ImageError::DiskFull { .. }), "{error}");
        assert!(error.to_string().starts_with(path.to_str().unwrap()), "{error}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.png"]);

        let new = folder.path().join("b.png");
        replace_file_with(&new, half_then_full).unwrap_err();
        assert_eq!(names(folder.path()), ["a.png"]);
    }

    #[test]
    fn what_is_being_written_is_listed_until_it_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let listed = || unfinished().iter().filter(|path| path.starts_with(folder.path())).count();
        let path = folder.path().join("a.png");
        let target = Target::of(&path).unwrap();
        let named = target.named_file(tempfile_at).unwrap();
        assert_eq!((listed(), names(folder.path()).len()), (1, 1));
        drop(named);
        assert_eq!((listed(), names(folder.path()).len()), (0, 0));
        replace_file_with(&path, |_| Ok(())).unwrap();
        assert_eq!(listed(), 0);
        replace_file_with(&path, |_| Err(io::ErrorKind::StorageFull.into())).unwrap_err();
        assert_eq!(listed(), 0);
    }

    /// As on systems where every file has a name, or gets it only when it is made.
    #[test]
    fn files_with_names_are_replaced_too() {
        let folder = tempfile::tempdir().unwrap();
        let target = Target::of(&folder.path().join("a.png")).unwrap();
        let mut named = target.named_file(tempfile_at).unwrap();
        target.rename(&mut named, |file| file.write_all(b"one")).unwrap();
        drop(named);
        assert_eq!(fs::read(folder.path().join("a.png")).unwrap(), b"one");
        assert_eq!(names(folder.path()), ["a.png"]);
        let mut named = target.named_file(tempfile_at).unwrap();
        target.rename(&mut named, |_| Err(io::ErrorKind::StorageFull.into())).unwrap_err();
        drop(named);
        assert_eq!(fs::read(folder.path().join("a.png")).unwrap(), b"one");
        assert_eq!(names(folder.path()), ["a.png"]);
    }

    /// Nobody sees what is being written.
    #[cfg(target_os = "linux")]
    #[test]
    fn what_is_being_written_has_no_name() {
        let folder = tempfile::tempdir().unwrap();
        if nameless_file(folder.path()).is_none() {
            eprintln!("NOT TESTED: {} has no files without names", folder.path().display());
            return;
        }
        let seen = |file: &mut File| {
            file.write_all(b"half")?;
            assert_eq!(names(folder.path()), [""; 0]);
            Ok(())
        };
        replace_file_with(&folder.path().join("a.png"), seen).unwrap();
        assert_eq!(names(folder.path()), ["a.png"]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_the_system_says_of_a_full_disk_is_understood() {
        let mut full = File::options().write(true).open("/dev/full").expect("Linux has /dev/full");
        let error = full.write_all(b"x").unwrap_err();
        let error = ImageError::from_write(Path::new("a.png"), Path::new("."), error);
        assert!(matches!(error, ImageError::DiskFull { .. }), "{error}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_disk_that_fills_up() {
        use std::process::Command;
        struct Mounted(tempfile::TempDir);
        impl Drop for Mounted {
            fn drop(&mut self) {
                let _ = Command::new("umount").arg(self.0.path()).status();
            }
        }
        let folder = tempfile::tempdir().unwrap();
        let mount = Command::new("mount")
            .args(["-t", "tmpfs", "-o", "size=64k", "tmpfs"])
            .arg(folder.path())
            .output();
        if !mount.is_ok_and(|o| o.status.success()) {
            eprintln!(
                "SKIPPED: a_disk_that_fills_up needs the right to mount a tmpfs; run the tests as \
                 root"
            );
            return;
        }
        let disk = Mounted(folder);
        let path = disk.0.path().join("a.png");
        replace_file(&path, b"old").unwrap();
        let error = replace_file(&path, &vec![1; 1 << 20]).unwrap_err();
        assert!(matches!(error, ImageError::DiskFull { .. }), "{error}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(disk.0.path()), ["a.png"]);
        replace_file(&path, &vec![2; 1 << 12]).expect("the failed write gave its space back");
    }

    #[test]
    fn check_touches_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        check_writable(&path).unwrap();
        assert_eq!(names(folder.path()), [""; 0]);
        fs::write(&path, b"old").unwrap();
        let before = fs::metadata(&path).unwrap().modified().unwrap();
        check_writable(&path).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::metadata(&path).unwrap().modified().unwrap(), before);
        assert_eq!(names(folder.path()), ["a.png"]);
    }

    #[test]
    fn check_refuses_what_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("folder.png")).unwrap();
        fs::write(at("file"), b"").unwrap();
        fs::write(at("kept.png"), b"").unwrap();
        let mut read_only = fs::metadata(at("kept.png")).unwrap().permissions();
        read_only.set_readonly(true);
        fs::set_permissions(at("kept.png"), read_only).unwrap();

        let check = |name: &str| check_writable(&at(name)).unwrap_err();
        assert!(matches!(check("a.jpg"), ImageError::UnknownExtension { .. }));
        assert!(matches!(check("folder.png"), ImageError::IsFolder { .. }));
        assert!(matches!(check("kept.png"), ImageError::WriteProtected { .. }));
        assert!(matches!(
            check("file/a.png"),
            ImageError::Write { .. } | ImageError::NoFolder { .. }
        ));
        let missing = check("missing/a.png");
        assert!(matches!(missing, ImageError::NoFolder { .. }));
        let message = missing.to_string();
        assert!(
            message.contains(at("missing/a.png").to_str().unwrap())
                && message.contains("create it"),
            "{message}"
        );
        assert!(replace_file(&at("kept.png"), b"new").is_err());
        assert!(replace_file(&at("folder.png"), b"new").is_err());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_folder_that_takes_no_files() {
        // Even root cannot create a file here.
        let error = check_writable(Path::new("/proc/a.png")).unwrap_err();
        assert!(
            matches!(error, ImageError::Write { .. } | ImageError::FolderNotWritable { .. }),
            "{error}"
        );
        assert!(replace_file(Path::new("/proc/a.png"), b"").is_err());
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_an_ordinary_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        let (ordinary, path) = (folder.path().join("ordinary"), folder.path().join("a.png"));
        fs::write(&ordinary, b"").unwrap();
        replace_file(&path, b"").unwrap();
        assert_eq!(mode(&path), mode(&ordinary));
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        replace_file(&path, b"").unwrap();
        assert_eq!(mode(&path), 0o640, "a replaced file keeps its permissions");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_its_file_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let other = tempfile::tempdir().unwrap();
        let (link, file) = (folder.path().join("a.png"), other.path().join("b.png"));
        fs::write(&file, b"old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        replace_file(&link, b"new").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_a_file_that_is_not_there_creates_it() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("store")).unwrap();
        fs::create_dir(at("links")).unwrap();
        symlink("../store/new.png", at("links/second.png")).unwrap();
        symlink("links/second.png", at("first.png")).unwrap();
        symlink("nowhere/new.png", at("lost.png")).unwrap();
        symlink("circle.png", at("circle.png")).unwrap();
        assert_eq!(written_file(&at("first.png")), written_file(&at("store/./new.png")));
        check_writable(&at("first.png")).unwrap();
        assert_eq!(names(&at("store")), [""; 0]);
        for contents in [b"one", b"two"] {
            replace_file(&at("first.png"), contents).unwrap();
            assert_eq!(fs::read(at("store/new.png")).unwrap(), contents);
        }
        assert_eq!(written_file(&at("first.png")), written_file(&at("store/new.png")));
        for link in ["first.png", "links/second.png"] {
            assert!(fs::symlink_metadata(at(link)).unwrap().is_symlink(), "{link}");
        }
        assert_eq!(names(&at("store")), ["new.png"]);
        assert_eq!(names(&at("links")), ["second.png"]);

        let error = check_writable(&at("lost.png")).unwrap_err();
        let ImageError::NoFolder { folder: missing, .. } = &error else { panic!("{error}") };
        assert!(missing.ends_with("nowhere"), "{error}");
        assert!(replace_file(&at("lost.png"), b"").is_err());
        assert_eq!(written_file(&at("lost.png")), None);
        assert!(replace_file(&at("circle.png"), b"").is_err());
        assert!(fs::symlink_metadata(at("circle.png")).unwrap().is_symlink());
    }
}
