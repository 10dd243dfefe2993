//! The MTL files of an OBJ.

use crate::scene::error::SceneError;
use crate::scene::obj::mtl::{Ignored, Library};
use crate::scene::options::LoadOptions;
use crate::scene::source::{Found, Source, find_foreign};
use crate::scene::summary::{Fate, Summary};
use crate::scene::text::{Name, plain_text};
use std::collections::HashSet;
use std::path::Path;

/// Reads the MTL files that `statements`, what stands behind each `mtllib`, name.
pub(super) fn read(
    source: &dyn Source,
    obj_path: &Path,
    statements: &[Name],
    options: &LoadOptions,
    warnings: &mut Vec<String>,
    summary: &mut Summary,
) -> Result<Library, SceneError> {
    let mut library = Library::default();
    let mut read = HashSet::new();
    let obj = obj_path.display();
    for (name, found) in statements.iter().flat_map(|names| find(source, obj_path, names)) {
        let Some(Found { path, by_its_end }) = found else {
            warnings.push(format!("{obj}: the MTL file `{name}` that it names is not there."));
            continue;
        };
        if by_its_end {
            let used = path.display();
            warnings
                .push(format!("{obj}: the path `{name}` of an MTL leads nowhere; {used} is used."));
        }
        if !read.insert(path.clone()) {
            continue;
        }
        let bytes = source.read(&path, options.text_bytes())?;
        let text = plain_text(&bytes)
            .map_err(|what| SceneError::WrongKind { path: path.clone(), what })?;
        for Ignored { line, key, again } in library.add(&path, text) {
            let (fate, material) = match again {
                Some(name) => (Fate::DefinedAgain, name.to_string()),
                None => (Fate::WithoutEffect, "no material".to_owned()),
            };
            summary.note(&path, line, fate, &key, &material);
        }
    }
    Ok(library)
}

/// The files of one `mtllib`, with the names that lead to them: all of it, if there is such a file,
/// since names may hold spaces; else its words, as the specification has it.
fn find(source: &dyn Source, obj_path: &Path, statement: &Name) -> Vec<(Name, Option<Found>)> {
    let folder = obj_path.parent().unwrap_or(Path::new(""));
    let found = |name: &Name| find_foreign(source, &[folder], name);
    let whole = found(statement);
    if whole.as_ref().is_some_and(|found| !found.by_its_end) {
        return vec![(statement.clone(), whole)];
    }
    let words: Vec<_> =
        quoted_words(&statement.0).into_iter().map(|name| (found(&name), name)).collect();
    if whole.is_some() && words.iter().any(|(found, _)| found.is_none()) || words.is_empty() {
        return vec![(statement.clone(), whole)];
    }
    words.into_iter().map(|(found, name)| (name, found)).collect()
}

/// The words up to a comment; quotes hold several together.
fn quoted_words(text: &[u8]) -> Vec<Name> {
    let mut names = Vec::new();
    let mut rest = text.trim_ascii();
    while let Some(&first) = rest.first().filter(|&&first| first != b'#') {
        let quoted = (first == b'"').then(|| rest[1..].iter().position(|&byte| byte == b'"'));
        let (word, after) = match quoted.flatten() {
            Some(end) => (&rest[1..=end], &rest[end + 2..]),
            None => {
                rest.split_at(rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len()))
            }
        };
        names.push(Name::new(word));
        rest = after.trim_ascii_start();
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_may_be_quoted() {
        let words = |text: &str| {
            quoted_words(text.as_bytes()).iter().map(Name::to_string).collect::<Vec<_>>()
        };
        assert_eq!(words("a.mtl\tb.mtl # c.mtl"), ["a.mtl", "b.mtl"]);
        assert_eq!(words("\"my a.mtl\" \"b.mtl\"c"), ["my a.mtl", "b.mtl", "c"]);
        assert_eq!(words("\"open.mtl x"), ["\"open.mtl", "x"]);
        assert_eq!(words("a#1.mtl"), ["a#1.mtl"]);
        assert_eq!(words(""), [""; 0]);
    }
}
