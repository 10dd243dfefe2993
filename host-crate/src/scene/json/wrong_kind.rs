//! Files of other kinds that are given as a scene.

use std::path::Path;

const REMEDY: &str =
    "a scene is a glTF, a PLY, an OBJ, or a JSON file that names some, see docs/GUIDE.md";

/// Kinds of files by the ends of their names.
const BY_ENDING: [(&[&str], &str); 5] = [
    (&["mtl"], "an MTL"),
    (&["fbx", "dae", "blend", "3ds", "max", "usd", "usda", "usdc", "usdz"], ""),
    (&["stl", "off", "pbrt", "xml", "abc", "x3d"], ""),
    (
        &["png", "jpg", "jpeg", "exr", "hdr", "bmp", "tga", "tif", "tiff", "gif", "webp"],
        "a picture",
    ),
    (&["zip", "gz", "7z", "tar", "rar"], "an archive"),
];

/// What a file of such a name is, and what a scene is; none if a scene may be called so.
pub(super) fn by_ending(path: &Path) -> Option<String> {
    let ending = path.extension()?.to_str()?;
    let is_known =
        |endings: &[&str]| endings.iter().any(|known| ending.eq_ignore_ascii_case(known));
    let (_, kind) = BY_ENDING.iter().find(|(endings, _)| is_known(endings))?;
    Some(match *kind {
        "" => format!("is a file of another format ({ending}), not a scene; {REMEDY}"),
        kind => format!("is {kind}, not a scene; {REMEDY}"),
    })
}

/// What a text is that is no scene, and what a scene is; none if it may be one.
pub(super) fn of(path: &Path, text: &[u8]) -> Option<String> {
    match text.trim_ascii_start().first() {
        None => Some(format!("is empty; {REMEDY}")),
        Some(b'[' | b'"') => None,
        Some(b'{') => by_ending(path),
        Some(_) => by_ending(path).or_else(|| Some(format!("is not JSON; {REMEDY}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_other_kinds_are_named() {
        let said = |path: &str, content: &str| of(Path::new(path), content.as_bytes());
        assert_eq!(said("a.json", "{}"), None);
        assert_eq!(said("scene", " \n{"), None);
        assert_eq!(said("a.json", "[1]"), None);
        assert!(said("a.json", "hello").unwrap().starts_with("is not JSON"));
        assert!(said("a.mtl", "newmtl x").unwrap().starts_with("is an MTL, not a scene"));
        assert!(said("a.fbx", "{}").unwrap().contains("another format (fbx)"));
        assert!(said("a.PNG", "\u{89}PNG").unwrap().starts_with("is a picture"));
        assert!(said("a.json", " ").unwrap().starts_with("is empty"));
    }
}
