//! Triangles of one material.

use super::material::MaterialId;
use glam::{DVec3, Vec2, Vec3, Vec4};

/// Triangles of one material. The front of a triangle is the side from which its corners run
/// counter-clockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// What it is made of.
    pub material: MaterialId,
    /// Positions in world units, each coordinate in [-1e9, 1e9].
    pub positions: Vec<Vec3>,
    /// The corners of each triangle: indices into `positions`.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle the shading normals at its corners, of unit length on the side of the
    /// front; zero at all three where the triangle is flat. `None`: the mesh is flat.
    pub normals: Option<Vec<[Vec3; 3]>>,
    /// For each triangle the texture coordinates at its corners; (0, 0) is the lower left corner of
    /// a texture, (1, 1) the upper right one. `None`: the mesh has no texture.
    pub texture_coordinates: Option<Vec<[Vec2; 3]>>,
    /// For each triangle other texture coordinates at its corners, for textures that
    /// [take them](super::CoordinateSet). `None`: there are no such textures.
    pub second_coordinates: Option<Vec<[Vec2; 3]>>,
    /// For each triangle the colours at its corners, linear Rec.709 and alpha, each component in
    /// [0, 1]: what multiplies the colour of the material, which
    /// [takes them](super::Material::takes_colours), and its opacity. `None`: white.
    pub colours: Option<Vec<[Vec4; 3]>>,
    /// For each triangle the tangents at its corners: the direction in which `u` grows in a map of
    /// normals and along which a surface may be rougher, of unit length, and -1 where such a map is
    /// mirrored, else 1; zero at all three where it is the direction in which the triangle's own
    /// texture coordinate `u` grows. `None`: that is so everywhere.
    pub tangents: Option<Vec<[Vec4; 3]>>,
}

impl Mesh {
    /// A flat mesh with nothing else at its corners; see the fields.
    pub fn new(material: MaterialId, positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Self {
        Self { material, positions, triangles, ..Self::default() }
    }

    /// The positions of a triangle's corners.
    ///
    /// # Panics
    ///
    /// When there is no such triangle or position.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|corner| self.positions[corner as usize])
    }

    /// The lowest and the highest corner of the box around its triangles; zero without any.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        let corners = (0..self.triangles.len()).flat_map(|triangle| self.corners(triangle));
        let both = corners.map(|p| (p.as_dvec3(), p.as_dvec3()));
        let found = both.reduce(|(low, high), (a, b)| (low.min(a), high.max(b)));
        found.map_or([DVec3::ZERO; 2], |(low, high)| [low, high])
    }

    /// Keeps the triangles with these corners only.
    pub(super) fn retain(&mut self, mut keep: impl FnMut([Vec3; 3]) -> bool) {
        let kept: Vec<bool> =
            (0..self.triangles.len()).map(|triangle| keep(self.corners(triangle))).collect();
        retain(&mut self.triangles, &kept);
        self.normals.iter_mut().for_each(|normals| retain(normals, &kept));
        self.texture_coordinates.iter_mut().for_each(|uvs| retain(uvs, &kept));
        self.second_coordinates.iter_mut().for_each(|uvs| retain(uvs, &kept));
        self.colours.iter_mut().for_each(|colours| retain(colours, &kept));
        self.tangents.iter_mut().for_each(|tangents| retain(tangents, &kept));
    }
}

fn retain<T>(elements: &mut Vec<T>, kept: &[bool]) {
    let mut kept = kept.iter();
    elements.retain(|_| kept.next().is_some_and(|&kept| kept));
}

/// Whether a triangle has an area, and therefore a normal and barycentric coordinates whose numbers
/// are finite. What has none is never rendered.
pub(crate) fn has_area(corners: [Vec3; 3]) -> bool {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let area = (b - a).cross(c - a).length();
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    let largest =
        [a, b, c].map(|corner| corner.abs().max_element()).into_iter().fold(1.0, f64::max);
    area > 0.0 && longest * largest / area < f64::from(f32::MAX) / 16.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_belongs_to_a_triangle_goes_with_it() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let mut mesh = Mesh::new(MaterialId(0), positions, vec![[0, 1, 2], [0, 1, 1], [0, 1, 3]]);
        mesh.normals = Some([Vec3::X, Vec3::Y, Vec3::Z].map(|n| [n; 3]).to_vec());
        mesh.second_coordinates = Some([0.1, 0.2, 0.3].map(|u| [Vec2::splat(u); 3]).to_vec());
        mesh.colours = Some([0.1, 0.2, 0.3].map(|grey| [Vec4::splat(grey); 3]).to_vec());
        mesh.tangents = Some([0.1, 0.2, 0.3].map(|x| [Vec4::splat(x); 3]).to_vec());
        mesh.retain(has_area);
        assert_eq!(mesh.tangents, Some([0.1, 0.3].map(|x| [Vec4::splat(x); 3]).to_vec()));
        assert_eq!(mesh.second_coordinates, Some([0.1, 0.3].map(|u| [Vec2::splat(u); 3]).to_vec()));
        assert_eq!(mesh.colours, Some([0.1, 0.3].map(|grey| [Vec4::splat(grey); 3]).to_vec()));
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 1, 3]]);
        assert_eq!(mesh.normals, Some(vec![[Vec3::X; 3], [Vec3::Z; 3]]));
        assert_eq!(mesh.texture_coordinates, None);
    }
}
