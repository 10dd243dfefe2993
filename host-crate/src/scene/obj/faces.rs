//! The faces of an OBJ, checked line by line and put into a plain form.
//!
//! tobj reads OBJ, but says no line number, fills in missing normals and texture coordinates, takes
//! polylines for faces and can panic on indices out of range. What it gets here has none of these:
//! the faces of one group after the other, with absolute indices that are in range.

use super::indices::Indices;
use super::problem::{BadLine, Cost};
use super::vertices::{V, VN, VT, Vertices, list_of};
use crate::scene::text::{Lines, Name, split_keyword, words};
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;

/// The material of faces that come before any `usemtl`.
pub(in crate::scene) const NO_MATERIAL: &[u8] = b"(none)";
/// Faces of lines longer than this are counted before they are read.
const LONG: usize = 1 << 16;
/// At most this many kinds of lines that are not read are told apart.
const MAX_KEYWORDS: usize = 32;

/// All faces of an OBJ.
#[derive(Default)]
pub(super) struct Faces {
    /// In the order of their first faces.
    pub groups: Vec<FaceGroup>,
    /// What each `mtllib` names, in order.
    pub libraries: Vec<Name>,
    /// The keywords of lines that are not read, with how many there are and the first.
    pub unread: BTreeMap<Name, (usize, usize)>,
}

/// The faces of one material that have the same of texture coordinates and normals.
pub(super) struct FaceGroup {
    /// The name in `usemtl`, or [`NO_MATERIAL`].
    pub material: Name,
    /// The lines f.
    pub text: String,
    /// How many faces there are.
    pub faces: usize,
    /// The line of the first one.
    pub first_line: usize,
    /// For each list whether every corner has an element of it; always for vertices.
    pub has: [bool; 3],
    /// For each list the line of an element that is unusable, if any corner has one.
    pub unusable: [Option<usize>; 3],
    /// For each list how many faces name an element that is not there, and the first such line.
    pub dangling: [(usize, usize); 3],
}

impl Faces {
    /// Reads the faces between these vertices. Without `normals` indices of normals are not
    /// followed.
    pub(super) fn parse(
        text: &[u8],
        vertices: &Vertices,
        normals: bool,
        cost: &mut Cost,
    ) -> Result<Self, BadLine> {
        let mut reader = Reader {
            indices: Indices::new(vertices, normals),
            faces: Self::default(),
            group_of: HashMap::new(),
            material: Name::new(NO_MATERIAL),
            current: [None; 4],
            corners: Vec::new(),
        };
        for (number, line) in Lines::new(text) {
            reader.line(number, &line, cost)?;
        }
        Ok(reader.faces)
    }
}

struct Reader<'a> {
    indices: Indices<'a>,
    faces: Faces,
    group_of: HashMap<(Name, usize), usize>,
    material: Name,
    /// The groups of the material, by what corners have.
    current: [Option<usize>; 4],
    /// Those of the face that is being read.
    corners: Vec<[Option<usize>; 3]>,
}

impl Reader<'_> {
    fn line(&mut self, number: usize, line: &[u8], cost: &mut Cost) -> Result<(), BadLine> {
        let (keyword, rest) = split_keyword(line);
        if let Some(list) = list_of(keyword) {
            self.indices.seen[list] += 1;
            return Ok(());
        }
        match keyword {
            // `fo` is what `f` was called once.
            b"f" | b"fo" => self.face(number, rest, cost)?,
            b"usemtl" => {
                self.material = Name::new(if rest.is_empty() { NO_MATERIAL } else { rest });
                self.current = [None; 4];
            }
            b"mtllib" => {
                cost.name(number, rest.len())?;
                self.faces.libraries.push(Name::new(rest));
            }
            // Names of parts, smoothing groups and comments change no picture.
            b"" | b"g" | b"o" | b"s" => {}
            _ if keyword[0] == b'#' => {}
            _ => self.note_unread(number, keyword),
        }
        Ok(())
    }

    fn note_unread(&mut self, number: usize, keyword: &[u8]) {
        const LONGEST: usize = 32;
        let unread = &mut self.faces.unread;
        let mut name = Name::new(&keyword[..keyword.len().min(LONGEST)]);
        if unread.len() >= MAX_KEYWORDS && !unread.contains_key(&name) {
            name = Name::new(b"others");
        }
        unread.entry(name).or_insert((0, number)).0 += 1;
    }

    fn face(&mut self, number: usize, rest: &[u8], cost: &mut Cost) -> Result<(), BadLine> {
        if rest.len() > LONG {
            cost.check(number, words(rest).count())?;
        }
        self.corners.clear();
        self.indices.dangling = [false; 3];
        for word in words(rest) {
            let corner = self.indices.corner(word).map_err(|what| BadLine::new(number, what))?;
            self.corners.push(corner);
        }
        if self.corners.len() < 3 {
            self.note_unread(number, b"f of fewer than 3 corners");
            return Ok(());
        }
        cost.face(number, self.corners.len(), rest.len())?;
        let has = [V, VT, VN].map(|list| self.corners.iter().all(|corner| corner[list].is_some()));
        let group = self.group(number, has, cost)?;
        let group = &mut self.faces.groups[group];
        for ((count, line), _) in
            group.dangling.iter_mut().zip(self.indices.dangling).filter(|(_, d)| *d)
        {
            *count += 1;
            *line = if *count == 1 { number } else { *line };
        }
        group_face(group, &self.corners, self.indices.vertices);
        Ok(())
    }

    /// The group of a face whose corners have these lists.
    fn group(&mut self, line: usize, has: [bool; 3], cost: &mut Cost) -> Result<usize, BadLine> {
        let kind = usize::from(has[VT]) + 2 * usize::from(has[VN]);
        if let Some(group) = self.current[kind] {
            return Ok(group);
        }
        let key = (self.material.clone(), kind);
        let group = match self.group_of.get(&key) {
            Some(&group) => group,
            None => {
                cost.name(line, self.material.0.len())?;
                self.faces.groups.push(FaceGroup {
                    material: self.material.clone(),
                    text: String::new(),
                    faces: 0,
                    first_line: line,
                    has,
                    unusable: [None; 3],
                    dangling: [(0, 0); 3],
                });
                self.group_of.insert(key, self.faces.groups.len() - 1);
                self.faces.groups.len() - 1
            }
        };
        self.current[kind] = Some(group);
        Ok(group)
    }
}

/// Adds a face to its group.
fn group_face(group: &mut FaceGroup, corners: &[[Option<usize>; 3]], vertices: &Vertices) {
    group.faces += 1;
    group.text.push('f');
    for corner in corners {
        for (separator, list) in [(' ', V), ('/', VT), ('/', VN)] {
            if list != V && !group.has[list] {
                if list == VT && group.has[VN] {
                    group.text.push('/');
                }
                continue;
            }
            let Some(index) = corner[list] else { continue };
            // Writing to a String cannot fail.
            let _ = write!(group.text, "{separator}{index}");
            group.unusable[list] =
                group.unusable[list].or_else(|| vertices.unusable_line(list, index));
        }
    }
    group.text.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse_with(text: &str, normals: bool) -> Result<Faces, BadLine> {
        let mut cost = Cost::new(1 << 20);
        let vertices = Vertices::parse(text.as_bytes(), normals, &mut cost)?;
        Faces::parse(text.as_bytes(), &vertices, normals, &mut cost)
    }

    fn faces(text: &str) -> Vec<(String, String)> {
        let groups = parse_with(text, true).unwrap().groups;
        groups.into_iter().map(|group| (group.material.to_string(), group.text)).collect()
    }

    fn error(text: &str) -> (usize, String) {
        let Err(bad) = parse_with(text, true) else { panic!("{text:?} was accepted") };
        (bad.line, format!("{:?}", bad.what))
    }

    const V3: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

    #[test]
    fn faces_are_gathered_by_material_in_order_of_first_use() {
        let text = format!(
            "{V3}f 1 2 3\nusemtl none of it\nusemtl b\nf 1 2 3\nusemtl\ta b\nfo 2 1 3 \n\
             usemtl b\nf 3 2 1\nl 1 2 3\nf 1 2\n"
        );
        let expected = [("(none)", "f 1 2 3\n"), ("b", "f 1 2 3\nf 3 2 1\n"), ("a b", "f 2 1 3\n")];
        assert_eq!(faces(&text), expected.map(|(m, f)| (m.to_owned(), f.to_owned())));
    }

    #[test]
    fn relative_indices_count_from_the_line() {
        let text = format!("{V3}vn 0 0 1\nf -3//-1 -2//1 -1//-1\nv 5 5 5\nf -1 -2 -3\n");
        let texts: Vec<_> = faces(&text).into_iter().map(|(_, faces)| faces).collect();
        assert_eq!(texts, ["f 1//1 2//1 3//1\n", "f 4 3 2\n"]);
    }

    #[test]
    fn a_face_may_precede_its_vertices() {
        assert_eq!(faces(&format!("f 1 2 3\n{V3}"))[0].1, "f 1 2 3\n");
    }

    #[test]
    fn faces_are_told_apart_by_what_all_corners_have() {
        let text = format!(
            "{V3}vt 0 0\nvn 0 0 1\nusemtl a\nf 1/1/1 2/1/1 3/1/1\nf 1/1 2/1/1 3/1\n\
             f 1/7/1 2/1/0 3/1/1\nusemtl b\nf 1/-2/1 2/1/1 3/1/1\nf 1//2 2//1 3//-9\n"
        );
        let groups = parse_with(&text, true).unwrap().groups;
        let seen: Vec<_> = groups.iter().map(|group| (group.text.as_str(), group.has)).collect();
        assert_eq!(
            seen,
            [
                ("f 1/1/1 2/1/1 3/1/1\n", [true, true, true]),
                ("f 1/1 2/1 3/1\n", [true, true, false]),
                ("f 1 2 3\n", [true, false, false]),
                ("f 1//1 2//1 3//1\n", [true, false, true]),
                ("f 1 2 3\n", [true, false, false]),
            ]
        );
        let flat = parse_with(&text, false).unwrap().groups;
        assert_eq!(flat[0].text, "f 1/1 2/1 3/1\nf 1/1 2/1 3/1\n");
    }

    #[test]
    fn what_is_not_read_is_counted() {
        let text = format!("{V3}f 1 2 3\nl 1 2\nl 2 3\nf 1 2\ncstype bezier\ng a\ns 1\n# l 1 2\n");
        let unread = parse_with(&text, true).unwrap().unread;
        let unread: Vec<_> = unread
            .into_iter()
            .map(|(name, (count, line))| (name.to_string(), count, line))
            .collect();
        let expected = [("cstype", 1, 8), ("f of fewer than 3 corners", 1, 7), ("l", 2, 5)];
        assert_eq!(unread, expected.map(|(name, count, line)| (name.to_owned(), count, line)));
        let many: String = (0..100).map(|number| format!("keyword{number}\n")).collect();
        assert!(parse_with(&many, true).unwrap().unread.len() <= MAX_KEYWORDS + 1);
    }

    #[test]
    fn unusable_elements_are_named_by_their_lines() {
        let text = format!("{V3}v nan 0 0\nvt nan\nf 1/1 2/1 3/1\nusemtl a\nf 1 2 4\n");
        let groups = parse_with(&text, true).unwrap().groups;
        assert_eq!(groups[0].unusable, [None, Some(5), None]);
        assert_eq!(groups[1].unusable, [Some(4), None, None]);
    }

    #[test]
    fn indices_that_lead_nowhere_are_counted_where_someone_follows_them() {
        let text = format!("{V3}vn 0 0 1\nf 1/1/1 2/1/2 3/1/0\nf 1//1 2//1 3//2\nf 1 2 3\n");
        let of = |normals| parse_with(&text, normals).unwrap().groups.remove(0).dangling;
        assert_eq!(of(true), [(0, 0), (1, 5), (2, 5)]);
        assert_eq!(of(false), [(0, 0), (1, 5), (0, 0)]);
    }

    #[test]
    fn bad_lines_are_named() {
        let (line, what) = error(&format!("{V3}f 1 2 7\n"));
        assert!(line == 4 && what.contains("vertex 7 does not exist: the file has 3"), "{what}");
        let (line, what) = error(&format!("{V3}f 1 1 -4"));
        assert!(line == 4 && what.contains("vertex -4 does not exist: there are 3 before"));
        let (line, what) = error(&format!("{V3}f 1 0 1"));
        assert!(line == 4 && what.contains("vertex 0 does not exist: they are counted from 1"));
        let huge = "99999999999999999999";
        assert!(error(&format!("{V3}f 1 1 {huge}")).1.contains("is not the index"));
        assert!(error(&format!("{V3}f 1 1 1//{huge}")).1.contains("is not the index"));
        assert!(error(&format!("{V3}f 1 1 {}", i64::MIN)).1.contains("does not exist"));
        assert!(error(&format!("{V3}f 1 1 /1")).1.contains("not a corner"));
        assert!(error(&format!("{V3}f 1 1 1///")).1.contains("not a corner"));
    }

    #[test]
    fn an_obj_that_would_take_too_much_memory_is_refused_at_its_line() {
        let mut cost = Cost::new(5_000);
        let text = format!("{V3}{}", "f 1 2 3\n".repeat(100));
        let vertices = Vertices::parse(text.as_bytes(), false, &mut cost).unwrap();
        let Err(bad) = Faces::parse(text.as_bytes(), &vertices, false, &mut cost) else {
            panic!("accepted")
        };
        assert!(bad.line > 4 && bad.line < 20, "{bad:?}");
        assert!(Vertices::parse(text.as_bytes(), false, &mut Cost::new(100)).is_err());
    }
}
