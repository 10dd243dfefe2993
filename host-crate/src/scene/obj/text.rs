//! OBJ text, checked line by line and put into a plain form.
//!
//! tobj reads OBJ, but says no line number, fills in missing normals and texture coordinates, takes
//! polylines for faces and can panic on indices out of range. What it gets here has none of these:
//! only vertices, and then the faces of one material after the other, with absolute indices that
//! are in range.

use crate::scene::bounds::MAX_COORDINATE;
use std::collections::HashMap;
use std::fmt::Write as _;

/// The material of faces that come before any `usemtl`.
pub(super) const NO_MATERIAL: &str = "(none)";

/// An OBJ file in plain form.
pub(super) struct ObjText {
    /// The lines v, vt and vn.
    pub vertices: String,
    /// The faces by material, in the order of the first `usemtl`; only those with faces.
    pub groups: Vec<FaceGroup>,
    /// What `mtllib` names, in order.
    pub libraries: Vec<String>,
}

/// All faces of one material.
pub(super) struct FaceGroup {
    /// The name in `usemtl`, or [`NO_MATERIAL`].
    pub material: String,
    /// The lines f.
    pub faces: String,
    /// Whether every corner has a texture coordinate.
    pub has_texture_coordinates: bool,
    /// Whether every corner has a normal.
    pub has_normals: bool,
}

/// What is wrong, and with which line (from 1).
#[derive(Debug)]
pub(super) struct BadLine {
    pub line: usize,
    pub what: String,
}

/// What a vertex list is called in messages, and its keyword.
const LISTS: [(&str, &str); 3] = [("vertex", "v"), ("texture coordinate", "vt"), ("normal", "vn")];

/// Reads the text of an OBJ file.
pub(super) fn parse(text: &str) -> Result<ObjText, BadLine> {
    let mut reader = Reader::default();
    for (index, line) in text.lines().enumerate() {
        reader.line(line.trim()).map_err(|what| BadLine { line: index + 1, what })?;
        reader.note_references(index + 1);
    }
    reader.finish()
}

#[derive(Default)]
struct Reader {
    vertices: String,
    /// How many v, vt and vn there are.
    counts: [usize; 3],
    groups: Vec<FaceGroup>,
    group_of: HashMap<String, usize>,
    current: Option<usize>,
    libraries: Vec<String>,
    /// The largest index of v, vt and vn in the line being read.
    largest: [usize; 3],
    /// The largest index of v, vt and vn so far, and its line: a face may refer to vertices that
    /// follow it.
    references: [(usize, usize); 3],
}

impl Reader {
    fn line(&mut self, line: &str) -> Result<(), String> {
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match keyword {
            "v" => self.vertex(0, 3, rest),
            "vt" => self.vertex(1, 2, rest),
            "vn" => self.vertex(2, 3, rest),
            "f" => self.face(rest),
            "usemtl" => {
                let name = rest.trim();
                self.current = Some(self.group(if name.is_empty() { NO_MATERIAL } else { name }));
                Ok(())
            }
            "mtllib" => {
                self.libraries.push(rest.trim().to_owned());
                Ok(())
            }
            // Groups, smoothing groups, points, lines, curves.
            _ => Ok(()),
        }
    }

    /// Keeps the first `wanted` numbers of a v, vt or vn line; a weight or a colour may follow.
    fn vertex(&mut self, list: usize, wanted: usize, rest: &str) -> Result<(), String> {
        self.vertices.push_str(LISTS[list].1);
        let mut found = 0;
        for word in without_comment(rest).split_ascii_whitespace().take(wanted) {
            let number: f32 = word.parse().map_err(|_| format!("`{word}` is not a number"))?;
            if !number.is_finite() || f64::from(number).abs() > MAX_COORDINATE {
                return Err(format!(
                    "`{word}` is not a number from -{MAX_COORDINATE} to {MAX_COORDINATE}"
                ));
            }
            self.vertices.push(' ');
            self.vertices.push_str(word);
            found += 1;
        }
        self.vertices.push('\n');
        self.counts[list] += 1;
        if found == wanted {
            Ok(())
        } else {
            Err(format!("a {} needs {wanted} numbers, this has {found}", LISTS[list].0))
        }
    }

    fn face(&mut self, rest: &str) -> Result<(), String> {
        let corners: Vec<_> = without_comment(rest)
            .split_ascii_whitespace()
            .map(|word| self.corner(word))
            .collect::<Result<_, _>>()?;
        if corners.len() < 3 {
            return Ok(());
        }
        let group = self.current.unwrap_or_else(|| self.group(NO_MATERIAL));
        let group = &mut self.groups[group];
        group.faces.push('f');
        for Corner { v, vt, vn } in corners {
            group.has_texture_coordinates &= vt.is_some();
            group.has_normals &= vn.is_some();
            // Writing to a String cannot fail.
            let _ = match (vt, vn) {
                (Some(vt), Some(vn)) => write!(group.faces, " {v}/{vt}/{vn}"),
                (Some(vt), None) => write!(group.faces, " {v}/{vt}"),
                (None, Some(vn)) => write!(group.faces, " {v}//{vn}"),
                (None, None) => write!(group.faces, " {v}"),
            };
        }
        group.faces.push('\n');
        Ok(())
    }

    /// Reads `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&mut self, word: &str) -> Result<Corner, String> {
        let mut indices = [None; 3];
        let mut parts = word.split('/');
        for (list, (index, part)) in indices.iter_mut().zip(parts.by_ref()).enumerate() {
            if !part.is_empty() {
                *index = Some(self.index(list, part)?);
            }
        }
        match indices {
            [Some(v), vt, vn] if parts.next().is_none() => Ok(Corner { v, vt, vn }),
            _ => Err(format!(
                "`{word}` is not a corner of a face; it must look like 1, 1/2, 1//3 or 1/2/3"
            )),
        }
    }

    /// The absolute index, from 1, that `text` stands for; negative ones count from the end of the
    /// list so far.
    fn index(&mut self, list: usize, text: &str) -> Result<usize, String> {
        let (name, count) = (LISTS[list].0, self.counts[list]);
        let index: i64 =
            text.parse().map_err(|_| format!("`{text}` is not the index of a {name}"))?;
        let absolute = if index < 0 {
            usize::try_from(index.unsigned_abs())
                .ok()
                .and_then(|back| (count + 1).checked_sub(back))
        } else {
            usize::try_from(index).ok()
        };
        match absolute {
            Some(absolute) if absolute > 0 => {
                self.largest[list] = self.largest[list].max(absolute);
                Ok(absolute)
            }
            _ if index < 0 => {
                Err(format!("{name} {index} does not exist: there are {count} before this line"))
            }
            _ => Err(format!("{name} {index} does not exist: they are counted from 1")),
        }
    }

    fn group(&mut self, material: &str) -> usize {
        if let Some(&group) = self.group_of.get(material) {
            return group;
        }
        self.groups.push(FaceGroup {
            material: material.to_owned(),
            faces: String::new(),
            has_texture_coordinates: true,
            has_normals: true,
        });
        self.group_of.insert(material.to_owned(), self.groups.len() - 1);
        self.groups.len() - 1
    }

    /// Remembers the line that refers to the highest index of each list.
    fn note_references(&mut self, line: usize) {
        for (reference, largest) in self.references.iter_mut().zip(self.largest) {
            if largest > reference.0 {
                *reference = (largest, line);
            }
        }
    }

    fn finish(mut self) -> Result<ObjText, BadLine> {
        for ((&(index, line), count), (name, _)) in
            self.references.iter().zip(self.counts).zip(LISTS)
        {
            if index > count {
                return Err(BadLine {
                    line,
                    what: format!("{name} {index} does not exist: the file has {count}"),
                });
            }
        }
        self.groups.retain(|group| !group.faces.is_empty());
        Ok(ObjText { vertices: self.vertices, groups: self.groups, libraries: self.libraries })
    }
}

/// Indices of one corner of a face, from 1.
struct Corner {
    v: usize,
    vt: Option<usize>,
    vn: Option<usize>,
}

fn without_comment(words: &str) -> &str {
    words.split_once('#').map_or(words, |(before, _)| before)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faces(text: &str) -> Vec<(String, String)> {
        parse(text).unwrap().groups.into_iter().map(|group| (group.material, group.faces)).collect()
    }

    fn error(text: &str) -> (usize, String) {
        let Err(bad) = parse(text) else { panic!("{text:?} was accepted") };
        (bad.line, bad.what)
    }

    #[test]
    fn faces_are_gathered_by_material_in_order_of_first_use() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl none of it\nusemtl b\nf 1 2 3\nusemtl\ta b\nf 2 1 3 \n\
                    usemtl b\nf 3 2 1\nl 1 2 3\nf 1 2\n";
        let expected =
            [(NO_MATERIAL, "f 1 2 3\n"), ("b", "f 1 2 3\nf 3 2 1\n"), ("a b", "f 2 1 3\n")];
        assert_eq!(faces(text), expected.map(|(m, f)| (m.to_owned(), f.to_owned())));
    }

    #[test]
    fn relative_indices_count_from_the_line() {
        let text =
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf -3//-1 -2//1 -1//-1\nv 5 5 5\nf -1 -2 -3\n";
        assert_eq!(faces(text)[0].1, "f 1//1 2//1 3//1\nf 4 3 2\n");
    }

    #[test]
    fn a_face_may_precede_its_vertices() {
        assert_eq!(faces("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n")[0].1, "f 1 2 3\n");
    }

    #[test]
    fn what_corners_have_is_known_by_material() {
        let text = "v 0 0 0\nvt 0 0\nvn 0 0 1\nusemtl a\nf 1/1/1 1/1/1 1/1/1\nf 1/1 1/1/1 1/1\nusemtl b\nf 1//1 1//1 1//1";
        let groups = parse(text).unwrap().groups;
        assert_eq!(
            groups.iter().map(|g| g.has_texture_coordinates).collect::<Vec<_>>(),
            [true, false]
        );
        assert_eq!(groups.iter().map(|g| g.has_normals).collect::<Vec<_>>(), [false, true]);
    }

    #[test]
    fn weights_colours_and_comments_are_left_out() {
        assert_eq!(
            parse("v 1 2 3 1 0 0 # red\r\nvt 1 2 0\n# f 9 9 9").unwrap().vertices,
            "v 1 2 3\nvt 1 2\n"
        );
    }

    #[test]
    fn bad_lines_are_named() {
        let v = "v 0 0 0\n";
        assert_eq!(error("v 0 0\n"), (1, "a vertex needs 3 numbers, this has 2".into()));
        assert_eq!(error(&format!("{v}vn 0 0 nan")).0, 2);
        assert!(error("v 0 inf 0").1.contains("`inf`"));
        assert!(error("v 0 1e20 0").1.contains("`1e20`"));
        assert!(error("v 0 x 0").1.contains("`x` is not a number"));
        assert_eq!(
            error(&format!("{v}f 1 1 2\n{v}f 1 1 7\n{v}")),
            (4, "vertex 7 does not exist: the file has 3".into())
        );
        assert_eq!(
            error(&format!("{v}f 1 1 -2")),
            (2, "vertex -2 does not exist: there are 1 before this line".into())
        );
        assert_eq!(
            error(&format!("{v}f 1 0 1")),
            (2, "vertex 0 does not exist: they are counted from 1".into())
        );
        assert!(
            error(&format!("{v}f 1/1 1/1 1/1"))
                .1
                .starts_with("texture coordinate 1 does not exist")
        );
        assert!(
            error(&format!("{v}f 1//6148914691236517206 1 1"))
                .1
                .starts_with("normal 6148914691236517206")
        );
        assert!(error(&format!("{v}f 1 1 99999999999999999999")).1.contains("is not the index"));
        assert!(error(&format!("{v}f 1 1 /1")).1.contains("not a corner"));
        assert!(error(&format!("{v}f 1 1 1///")).1.contains("not a corner"));
    }
}
