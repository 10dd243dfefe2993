//! What the user should know of an OBJ.

use crate::scene::obj::Obj;
use crate::scene::text::Name;
use std::collections::HashMap;

/// Sentences about an OBJ, whose normals are to be smooth or not.
pub(super) fn of(obj: &Obj, is_smooth: bool) -> impl Iterator<Item = String> {
    let remarks = [
        is_smooth.then(|| normals(obj)).flatten(),
        texture_coordinates(obj),
        unusable(obj),
        unread(obj),
    ];
    remarks.into_iter().flatten()
}

/// The sum of numbers of faces, and the first of their lines; none if there are no faces.
fn faces(counts: impl Iterator<Item = (usize, usize)>) -> Option<(usize, usize)> {
    counts
        .filter(|(count, _)| *count > 0)
        .reduce(|(count, line), (more, other)| (count + more, line.min(other)))
}

/// Faces that are flat for want of normals, where others of the material are smooth or where they
/// name normals that are not there.
fn normals(obj: &Obj) -> Option<String> {
    let mut smooth: HashMap<&Name, bool> = HashMap::new();
    for part in &obj.parts {
        *smooth.entry(&part.material).or_default() |= part.has_normals;
    }
    let flat = obj.parts.iter().filter(|part| !part.has_normals);
    let lacking = flat.map(|part| {
        if smooth[&part.material] { (part.faces, part.first_line) } else { part.dangling[1] }
    });
    if let Some((count, line)) = faces(lacking) {
        return Some(format!(
            "faces without a usable normal (vn) at every corner are flat: {count}, the first in \
             line {line}"
        ));
    }
    smooth.values().all(|smooth| !smooth).then(|| {
        "normals are to be smooth, but no face has a vn at every corner: they are flat".to_owned()
    })
}

fn texture_coordinates(obj: &Obj) -> Option<String> {
    let (count, line) = faces(obj.parts.iter().map(|part| part.dangling[0]))?;
    Some(format!(
        "faces that name texture coordinates (vt) that are not there: {count}, the first in line \
         {line}"
    ))
}

fn unusable(obj: &Obj) -> Option<String> {
    let (count, line) = obj.unusable?;
    Some(format!(
        "lines v, vt or vn without usable numbers, which nothing uses: {count}, the first is line \
         {line}"
    ))
}

fn unread(obj: &Obj) -> Option<String> {
    let kinds = obj
        .unread
        .iter()
        .map(|(keyword, (count, line))| format!("`{keyword}` ({count}, the first is line {line})"));
    let kinds: Vec<_> = kinds.collect();
    (!kinds.is_empty()).then(|| format!("these lines are not read: {}", kinds.join(", ")))
}
