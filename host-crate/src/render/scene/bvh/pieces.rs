//! What leaves are made of: boxes of triangles, several for a large one.

use super::super::scene_triangle::SceneTriangle;
use super::super::triangles::Functions;
use glam::Vec3A;
use obvhs::Boundable;
use obvhs::aabb::Aabb;
use obvhs::splits::split_aabbs_preset;
use obvhs::triangle::Triangle;

/// The pieces of triangles.
pub struct Pieces {
    /// A box of each: any hit that the test of its triangle finds is in one of them, with what
    /// [`BoxRay`](raystream_shaders::scene::bvh::node::BoxRay) asks for.
    pub boxes: Vec<Aabb>,
    /// Index of the triangle, or of what else, that each is of.
    pub triangles: Vec<u32>,
}

impl Pieces {
    /// One for each of `triangles`, or more of large ones if `split`.
    pub fn of(triangles: &[SceneTriangle], split: bool) -> Self {
        let exact: Vec<Triangle> = triangles
            .iter()
            .map(|triangle| {
                let [v0, v1, v2] = triangle.corners.map(Vec3A::from);
                Triangle { v0, v1, v2 }
            })
            .collect();
        let mut boxes: Vec<Aabb> = exact.iter().map(Boundable::aabb).collect();
        let mut indices: Vec<u32> = (0..triangles.len() as u32).collect();
        if split && !triangles.is_empty() {
            let areas = || boxes.iter().map(Aabb::half_area);
            let mean = areas().sum::<f32>() / boxes.len() as f32;
            let largest = areas().fold(0.0, f32::max);
            split_aabbs_preset(&mut boxes, &mut indices, &exact, mean, largest);
        }
        for (piece, &index) in boxes.iter_mut().zip(&indices) {
            let margin = Functions::of(triangles[index as usize].corners).margin();
            *piece = Aabb::new(piece.min - margin, piece.max + margin);
        }
        Self { boxes, triangles: indices }
    }
    /// Adds `boxes` that are wide enough already, numbered from `first` on.
    pub fn add(&mut self, boxes: &[Aabb], first: u32) {
        self.boxes.extend(boxes);
        self.triangles.extend((first..).take(boxes.len()));
    }
}
