//! The indices of a face's corners.

use super::vertices::{LISTS, V, VN, Vertices};
use crate::scene::text::shown;

/// Reads indices into the lists of an OBJ.
pub(super) struct Indices<'a> {
    pub vertices: &'a Vertices,
    /// Whether indices of normals are followed.
    normals: bool,
    /// How many elements of each list there are so far.
    pub seen: [usize; 3],
    /// For each list whether an element was named that is not there.
    pub dangling: [bool; 3],
}

impl<'a> Indices<'a> {
    pub(super) fn new(vertices: &'a Vertices, normals: bool) -> Self {
        Self { vertices, normals, seen: [0; 3], dangling: [false; 3] }
    }

    /// Reads `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    pub(super) fn corner(&mut self, word: &[u8]) -> Result<[Option<usize>; 3], String> {
        let mut indices = [None; 3];
        let mut parts = word.split(|&byte| byte == b'/');
        for (list, (index, part)) in indices.iter_mut().zip(parts.by_ref()).enumerate() {
            if !part.is_empty() {
                *index = self.index(list, part)?;
            }
        }
        if indices[V].is_some() && parts.next().is_none() {
            Ok(indices)
        } else {
            Err(format!(
                "`{}` is not a corner of a face; it must look like 1, 1/2, 1//3 or 1/2/3",
                shown(word)
            ))
        }
    }

    /// The absolute index, from 1, that `part` stands for; negative ones count from the end of the
    /// list so far. There may be no such texture coordinate or normal: then it is none.
    fn index(&mut self, list: usize, part: &[u8]) -> Result<Option<usize>, String> {
        let name = LISTS[list];
        let index: Option<i64> = std::str::from_utf8(part).ok().and_then(|part| part.parse().ok());
        let index =
            index.ok_or_else(|| format!("`{}` is not the index of a {name}", shown(part)))?;
        let (seen, count) = (self.seen[list], self.vertices.counts[list]);
        let absolute = if index < 0 { seen as i64 + 1 + index } else { index };
        match usize::try_from(absolute).ok().filter(|found| (1..=count).contains(found)) {
            Some(_) if list == VN && !self.normals => Ok(None),
            None if list != V => {
                self.dangling[list] |= list != VN || self.normals;
                Ok(None)
            }
            None if index < 0 => {
                Err(format!("{name} {index} does not exist: there are {seen} before this line"))
            }
            None if index == 0 => {
                Err(format!("{name} {index} does not exist: they are counted from 1"))
            }
            None => Err(format!("{name} {index} does not exist: the file has {count}")),
            found => Ok(found),
        }
    }
}
