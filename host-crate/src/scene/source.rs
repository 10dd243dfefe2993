//! Where a scene's files come from: the disk, or the program itself.

use super::error::SceneError;
use super::text::Name;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// A place that files are read from.
pub(super) trait Source {
    /// The file `name`, relative to `folder` unless absolute, whatever the case of its letters.
    fn find(&self, folder: &Path, name: &Path) -> Option<PathBuf>;

    /// All bytes of a file; an error if there are more than `limit`.
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, SceneError>;
}

/// The file system.
pub(super) struct Disk;

impl Source for Disk {
    fn find(&self, folder: &Path, name: &Path) -> Option<PathBuf> {
        let exact = folder.join(name);
        if is_readable(&exact) {
            return Some(exact);
        }
        let found = name.components().try_fold(folder.to_path_buf(), |parent, component| {
            let exact = parent.join(component);
            if exact.exists() { Some(exact) } else { entry_in_any_case(&parent, component) }
        })?;
        is_readable(&found).then_some(found)
    }

    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, SceneError> {
        let fail = |source| SceneError::Read { path: path.to_owned(), source };
        let mut file = File::open(path).map_err(fail)?;
        let data = file.metadata().map_err(fail)?;
        if data.is_file() && data.len() > limit {
            return Err(SceneError::TooLong { path: path.to_owned(), limit });
        }
        read_up_to(&mut file, path, limit)
    }
}

/// The file system, and what has been asked of it.
#[derive(Default)]
pub(super) struct Listed(Mutex<Vec<PathBuf>>);

impl Listed {
    /// The files that were read, or could not be.
    pub(super) fn into_files(self) -> Vec<PathBuf> {
        self.0.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Source for Listed {
    fn find(&self, folder: &Path, name: &Path) -> Option<PathBuf> {
        Disk.find(folder, name)
    }

    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, SceneError> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(path.to_owned());
        Disk.read(path, limit)
    }
}

/// Whether a path leads to something with content: a file, or a pipe, but no folder.
fn is_readable(path: &Path) -> bool {
    path.metadata().is_ok_and(|data| !data.is_dir())
}

/// A file that a scene is loaded from.
#[derive(Clone, Copy)]
pub(super) struct SceneBytes<'a> {
    /// What the file is called in messages.
    pub path: &'a Path,
    /// The folder that its paths start from.
    pub folder: &'a Path,
    /// What is in it.
    pub bytes: &'a [u8],
}

/// The folder of a file.
pub(super) fn parent(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// All bytes of `input`, which is called `path` in errors. It need not have an end.
pub(super) fn read_up_to(
    input: &mut dyn Read,
    path: &Path,
    limit: u64,
) -> Result<Vec<u8>, SceneError> {
    let mut bytes = Vec::new();
    let fail = |source: io::Error| SceneError::Read { path: path.to_owned(), source };
    input.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(fail)?;
    if bytes.len() as u64 > limit {
        return Err(SceneError::TooLong { path: path.to_owned(), limit });
    }
    Ok(bytes)
}

/// A file that another file names.
pub(super) struct Found {
    pub path: PathBuf,
    /// Whether only the end of the name led to it.
    pub by_its_end: bool,
}

/// The file that an OBJ or MTL calls `name`, in the first of the folders that has it. Where the
/// name leads nowhere, as paths of another machine do, its end may.
pub(super) fn find_foreign(source: &dyn Source, folders: &[&Path], name: &Name) -> Option<Found> {
    let spellings = spellings(unquoted(&name.0));
    let find = |name: &Path| folders.iter().find_map(|folder| source.find(folder, name));
    if let Some(path) = spellings.iter().find_map(|name| find(name)) {
        return Some(Found { path, by_its_end: false });
    }
    let path = spellings.iter().find_map(|name| {
        let parts: Vec<_> = name.components().collect();
        (1..parts.len()).find_map(|first| find(&parts[first..].iter().collect::<PathBuf>()))
    })?;
    Some(Found { path, by_its_end: true })
}

/// What stands between quotes, if all of it does.
pub(super) fn unquoted(name: &[u8]) -> &[u8] {
    let between = |quote: &[u8]| name.strip_prefix(quote)?.strip_suffix(quote);
    between(b"\"").or_else(|| between(b"'")).unwrap_or(name).trim_ascii()
}

/// The paths that a name may stand for. One that is not UTF-8 may be so on the disk, or else it was
/// written in Latin-1 and the disk's is UTF-8.
fn spellings(name: &[u8]) -> Vec<PathBuf> {
    if name.is_empty() {
        return Vec::new();
    }
    let slashed: Vec<u8> =
        name.iter().map(|&byte| if byte == b'\\' { b'/' } else { byte }).collect();
    match std::str::from_utf8(&slashed) {
        Ok(text) => vec![PathBuf::from(text)],
        Err(_) => {
            let latin: String = slashed.iter().copied().map(char::from).collect();
            let raw = [raw_path(&slashed), raw_path(name)];
            raw.into_iter().flatten().chain([PathBuf::from(latin)]).collect()
        }
    }
}

/// The path of these bytes, where paths are bytes.
#[cfg(unix)]
fn raw_path(name: &[u8]) -> Option<PathBuf> {
    use std::os::unix::ffi::OsStrExt;
    Some(PathBuf::from(std::ffi::OsStr::from_bytes(name)))
}

/// The path of these bytes, where paths are bytes.
#[cfg(not(unix))]
fn raw_path(_name: &[u8]) -> Option<PathBuf> {
    None
}

/// The first entry of `folder`, in alphabetical order, that differs from `name` in case only.
fn entry_in_any_case(folder: &Path, name: Component<'_>) -> Option<PathBuf> {
    let wanted = name.as_os_str().to_str()?.to_lowercase();
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let entries = std::fs::read_dir(here).ok()?.flatten();
    let alike = entries
        .filter(|entry| entry.file_name().to_str().is_some_and(|n| n.to_lowercase() == wanted));
    alike.map(|entry| folder.join(entry.file_name())).min()
}

/// A path as scene and material files spell it, on Windows or elsewhere.
pub(super) fn portable(name: &str) -> PathBuf {
    PathBuf::from(name.replace('\\', "/"))
}

/// Replaces `$NAME` and `${NAME}` by what `lookup` knows; the error is the first name that it does
/// not know.
pub(super) fn expand(
    text: &str,
    lookup: impl Fn(&str) -> Option<String>,
) -> Result<String, String> {
    let mut expanded = String::new();
    let mut rest = text;
    while let Some(dollar) = rest.find('$') {
        expanded.push_str(&rest[..dollar]);
        let after = &rest[dollar + 1..];
        let braced = after.strip_prefix('{').and_then(|inner| inner.split_once('}'));
        let (name, next) = braced.unwrap_or_else(|| {
            after.split_at(
                after.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(after.len()),
            )
        });
        if name.is_empty() {
            expanded.push('$');
            rest = after;
        } else {
            expanded.push_str(&lookup(name).ok_or(name)?);
            rest = next;
        }
    }
    expanded.push_str(rest);
    Ok(expanded)
}

/// An environment variable that is set to something.
pub(super) fn environment(name: &str) -> Option<String> {
    std::env::var(name).ok().filter(|value| !value.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_a(text: &str) -> Result<String, String> {
        expand(text, |name| (name == "A").then(|| "/data".to_owned()))
    }

    #[test]
    fn variables_are_expanded() {
        assert_eq!(with_a("$A/x.obj").unwrap(), "/data/x.obj");
        assert_eq!(with_a("${A}x/$A").unwrap(), "/datax//data");
        assert_eq!(with_a("plain").unwrap(), "plain");
        assert_eq!(with_a("5$/$").unwrap(), "5$/$");
    }

    #[test]
    fn an_unset_variable_is_named() {
        assert_eq!(with_a("$A/$MISSING/x").unwrap_err(), "MISSING");
        assert_eq!(with_a("${OTHER}").unwrap_err(), "OTHER");
    }

    #[test]
    fn names_match_in_any_case() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("Textures")).unwrap();
        let file = folder.path().join("Textures/Wood.PNG");
        std::fs::write(&file, b"x").unwrap();
        assert_eq!(Disk.find(folder.path(), &portable("textures\\wood.png")).unwrap(), file);
        assert_eq!(Disk.find(Path::new("/nowhere"), &file).unwrap(), file);
        assert_eq!(Disk.find(folder.path(), Path::new("textures/wool.png")), None);
        assert_eq!(Disk.find(folder.path(), Path::new("textures")), None, "a folder");
    }

    #[test]
    fn paths_of_other_machines_lead_to_what_lies_beside() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("maps")).unwrap();
        std::fs::create_dir(folder.path().join("b")).unwrap();
        for file in ["maps/wood.png", "wood.png", "caf\u{e9}.png", "b/only.png"] {
            std::fs::write(folder.path().join(file), b"x").unwrap();
        }
        let find = |name: &[u8]| {
            let folders = [folder.path(), &folder.path().join("b")];
            let found = find_foreign(&Disk, &folders, &Name::new(name))?;
            let path = found.path.strip_prefix(folder.path()).unwrap().to_owned();
            Some((path.to_str().unwrap().replace('\\', "/"), found.by_its_end))
        };
        let is = |path: &str, by_its_end| Some((path.to_owned(), by_its_end));
        assert_eq!(find(b"wood.png"), is("wood.png", false));
        assert_eq!(find(b"\"maps/wood.png\""), is("maps/wood.png", false));
        assert_eq!(find(b"C:\\scene\\maps\\wood.png"), is("maps/wood.png", true));
        assert_eq!(find(b"C:\\\\scene\\\\Wood.PNG"), is("wood.png", true));
        assert_eq!(find(b"\\\\server\\share\\wood.png"), is("wood.png", true));
        assert_eq!(find(b"/nowhere/maps/wood.png"), is("maps/wood.png", true));
        assert_eq!(find(b"../only.png"), is("b/only.png", true));
        assert_eq!(find(b"caf\xe9.png"), is("caf\u{e9}.png", false));
        assert_eq!(find(b"C:\\wool.png"), None);
        assert_eq!(find(b""), None);
        assert_eq!(find(b"\"\""), None);
    }

    #[test]
    fn reading_ends_at_the_limit() {
        let endless = read_up_to(&mut io::repeat(b'v'), Path::new("x"), 1000).unwrap_err();
        assert!(endless.to_string().contains("1000 bytes"), "{endless}");
        assert_eq!(read_up_to(&mut b"1234".as_slice(), Path::new("x"), 4).unwrap(), b"1234");
        let folder = tempfile::tempdir().unwrap();
        let sparse = folder.path().join("sparse");
        File::create(&sparse).unwrap().set_len(50 << 30).unwrap();
        assert!(matches!(Disk.read(&sparse, 1 << 20), Err(SceneError::TooLong { .. })));
    }
}
