//! Where a scene's files come from: the disk, or the program itself.

use super::error::SceneError;
use std::path::{Component, Path, PathBuf};

/// A place that files are read from.
pub(super) trait Source {
    /// The file `name`, relative to `folder` unless absolute, whatever the case of its letters.
    fn find(&self, folder: &Path, name: &Path) -> Option<PathBuf>;

    /// All bytes of a file.
    fn read(&self, path: &Path) -> Result<Vec<u8>, SceneError>;
}

/// The file system.
pub(super) struct Disk;

impl Source for Disk {
    fn find(&self, folder: &Path, name: &Path) -> Option<PathBuf> {
        let exact = folder.join(name);
        if exact.is_file() {
            return Some(exact);
        }
        let found = name.components().try_fold(folder.to_path_buf(), |parent, component| {
            let exact = parent.join(component);
            if exact.exists() { Some(exact) } else { entry_in_any_case(&parent, component) }
        })?;
        found.is_file().then_some(found)
    }

    fn read(&self, path: &Path) -> Result<Vec<u8>, SceneError> {
        std::fs::read(path).map_err(|source| SceneError::Read { path: path.to_owned(), source })
    }
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
    }
}
