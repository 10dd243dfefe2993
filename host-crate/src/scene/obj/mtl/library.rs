//! The MTL files of an OBJ, as keys and values.

use crate::scene::text::{Lines, Name, split_keyword};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The materials of all MTL files of an OBJ, by name.
#[derive(Debug, Default)]
pub(in crate::scene) struct Library {
    materials: HashMap<Name, Entry>,
}

/// One material.
#[derive(Debug)]
pub(super) struct Entry {
    /// The file that it is in.
    pub path: PathBuf,
    pub name: Name,
    /// By key, in lower case. Keys without a value are left out.
    pub keys: HashMap<String, Value>,
}

/// What stands behind a key.
#[derive(Debug)]
pub(super) struct Value {
    /// The line, from 1.
    pub line: usize,
    /// The key as it is spelt.
    pub key: String,
    pub text: Vec<u8>,
}

/// Something in an MTL that does not count.
#[derive(Debug, PartialEq)]
pub(in crate::scene) struct Ignored {
    /// The line, from 1.
    pub line: usize,
    pub key: String,
    /// The material that it would define again; none of a key before the first material.
    pub again: Option<Name>,
}

impl Library {
    /// Adds the materials of an MTL file, where no earlier one has them: the first definition
    /// counts. `path` is where textures are looked for.
    pub(in crate::scene) fn add(&mut self, path: &Path, text: &[u8]) -> Vec<Ignored> {
        let mut ignored = Vec::new();
        let mut current: Option<Entry> = None;
        let mut is_before_all = true;
        for (line, statement) in Lines::new(text) {
            let (key, rest) = split_keyword(&statement);
            if key.is_empty() || key[0] == b'#' {
                continue;
            }
            let shown = || Name::new(key).to_string();
            if key.eq_ignore_ascii_case(b"newmtl") {
                is_before_all = false;
                self.keep(current.take());
                let name = Name::new(rest);
                if self.materials.contains_key(&name) {
                    ignored.push(Ignored { line, key: shown(), again: Some(name) });
                } else {
                    current = Some(Entry { path: path.to_owned(), name, keys: HashMap::new() });
                }
            } else if let Some(entry) = &mut current {
                entry.add(line, key, rest);
            } else if is_before_all {
                ignored.push(Ignored { line, key: shown(), again: None });
            }
        }
        self.keep(current);
        ignored
    }

    fn keep(&mut self, entry: Option<Entry>) {
        if let Some(entry) = entry {
            self.materials.insert(entry.name.clone(), entry);
        }
    }

    /// The material that an OBJ calls `name`. A name goes to the end of its line; where none is
    /// found so, a comment may follow it, here or there.
    pub(super) fn get(&self, name: &Name) -> Option<&Entry> {
        let bare = without_comment(name);
        let commented =
            || self.materials.values().filter(|entry| without_comment(&entry.name) == bare);
        self.materials
            .get(name)
            .or_else(|| self.materials.get(&Name::new(bare)))
            .or_else(|| commented().min_by_key(|entry| &entry.name))
    }
}

impl Entry {
    fn add(&mut self, line: usize, key: &[u8], rest: &[u8]) {
        let is_name = key.len() > 4 && key[..4].eq_ignore_ascii_case(b"map_");
        let end = if is_name || !rest.starts_with(b"#") { rest.len() } else { 0 };
        let text = rest[..end].to_vec();
        let key = String::from_utf8_lossy(key).into_owned();
        if !text.is_empty() {
            self.keys.insert(key.to_lowercase(), Value { line, key, text });
        }
    }
}

/// A name up to ` # `.
fn without_comment(name: &Name) -> &[u8] {
    let bytes = &name.0;
    let is_space = |at: usize| bytes.get(at).is_none_or(u8::is_ascii_whitespace);
    let hash =
        (1..bytes.len()).find(|&at| bytes[at] == b'#' && is_space(at - 1) && is_space(at + 1));
    hash.map_or(bytes, |hash| bytes[..hash].trim_ascii_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kd<'a>(library: &'a Library, name: &[u8]) -> Option<&'a str> {
        let value = &library.get(&Name::new(name))?.keys.get("kd")?.text;
        std::str::from_utf8(value).ok()
    }

    #[test]
    fn the_first_definition_counts() {
        let mut library = Library::default();
        let text = b"Ns 5\n# a\nNewMtl x\nKd 1\nKd 2\nnewmtl x\nKd 3\nNs 1\n";
        let ignored = library.add(Path::new("a"), text);
        let ignored_at = |line, key: &str, again| Ignored { line, key: key.into(), again };
        let again = ignored_at(6, "newmtl", Some(Name::new(b"x")));
        assert_eq!(ignored, [ignored_at(1, "Ns", None), again]);
        assert_eq!(library.add(Path::new("b"), b"newmtl y\nKd 5\nnewmtl x\nKd 4").len(), 1);
        assert_eq!((kd(&library, b"x"), kd(&library, b"y")), (Some("2"), Some("5")));
        assert!(!library.materials[&Name::new(b"x")].keys.contains_key("ns"));
    }

    #[test]
    fn names_go_to_the_end_of_the_line() {
        let mut library = Library::default();
        let text = b"newmtl Material #25\nKd 25\nnewmtl Material #26\nKd 26\n\
                     newmtl red # the wall\nKd 1\nnewmtl green\nKd 2\n";
        library.add(Path::new("a"), text);
        assert_eq!(kd(&library, b"Material #25"), Some("25"));
        assert_eq!(kd(&library, b"Material #26"), Some("26"));
        assert_eq!(kd(&library, b"Material #27"), None);
        assert_eq!(kd(&library, b"Material"), None);
        assert_eq!(kd(&library, b"red"), Some("1"));
        assert_eq!(kd(&library, b"green # grass"), Some("2"));
    }

    #[test]
    fn keys_without_a_value_count_as_absent() {
        let mut library = Library::default();
        library.add(Path::new("a"), b"newmtl x\nKd\nillum # 7\nmap_Kd #1.png\n");
        let keys = &library.get(&Name::new(b"x")).unwrap().keys;
        assert_eq!(keys.keys().collect::<Vec<_>>(), ["map_kd"]);
    }
}
