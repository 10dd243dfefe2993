//! The hierarchy of a scene and those of its shapes, one behind the other, and the instances
//! between them; see [`raystream_shaders::scene::bvh::instance`].

use super::bvh::wide::{Binary, Content};
use super::bvh::{self, Bvh, BvhQuality};
use super::geometry::{Geometry, Placed, Shape};
use super::{append, rows_of, triangles};
use crate::scene::InvalidScene;
use crate::scene::instance::norm;
use glam::{DAffine3, DVec3, UVec4, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use rayon::prelude::*;
use raystream_shaders::math::UNIT_ROUNDOFF;
use raystream_shaders::memory::rows::row;
use raystream_shaders::scene::SceneParams;
use raystream_shaders::scene::bvh::node::{BOX_ROUNDINGS, Node, RAY_WIDTH};
use raystream_shaders::scene::ray::NO_TRIANGLE;

/// The geometry in the layout of the kernels.
pub struct Hierarchies {
    /// The buffer `geometry`.
    pub geometry: Vec<UVec4>,
    /// The triangles for shading, with which `surfaces` begins.
    pub shading: Vec<UVec4>,
    /// How many numbers hits have.
    pub numbers: u32,
    /// How many instances there are.
    pub instances: u32,
    /// The box around the scene.
    pub bounds: Aabb,
    /// What the CPU's hierarchies are made from.
    pub source: WideSource,
}

/// What the CPU's hierarchies are made from, beside the triangles' planes.
pub struct WideSource {
    /// The scene's own, and those of shapes.
    pub hierarchies: Vec<Binary>,
    /// Of each instance the number of its shape's among them.
    pub shapes: Vec<u32>,
}

/// A hierarchy among the others.
struct Level {
    first_node: u32,
    first_entry: u32,
    entries: u32,
}

impl Hierarchies {
    /// Builds all hierarchies, and notes in `params` what lies where. `marks` are the lights of the
    /// world's triangles, see [`raystream_shaders::scene::triangle::Triangle::light`], or empty.
    ///
    /// # Errors
    ///
    /// When there are more triangles, those of all instances counted, than can be numbered.
    pub fn build(
        from: &Geometry,
        marks: &[u32],
        quality: BvhQuality,
        params: &mut SceneParams,
    ) -> Result<Self, InvalidScene> {
        let build_shape = |shape: &Shape| bvh::build(&shape.own.triangles, &[], quality);
        let shapes: Vec<Bvh> = from.shapes.par_iter().map(build_shape).collect();
        let placements: Vec<Placement> =
            from.placed.iter().map(|placed| Placement::of(placed, &shapes[placed.shape])).collect();
        let boxes: Vec<Aabb> = placements.iter().map(|placement| placement.bounds).collect();
        let world = &from.world.triangles;
        let bvh = bvh::build(world, &boxes, quality);
        let bounds = bvh.bounds;
        let mut source = WideSource { hierarchies: Vec::new(), shapes: Vec::new() };

        let mut planes = triangles::planes(world, &bvh.order);
        let mut shading = triangles::shading(world, marks, &bvh.order);
        let number = |&index: &u32| world.get(index as usize).map_or(0, |found| found.number);
        let mut order: Vec<u32> = bvh.order.iter().map(number).collect();
        let world_entries = order.len() as u32;
        source.hierarchies.push(binary(bvh.binary, &bvh.order, 0, world.len()));
        let mut geometry = bvh.nodes;
        let mut levels = Vec::with_capacity(shapes.len());
        for (shape, bvh) in from.shapes.iter().zip(shapes) {
            let own = &shape.own.triangles;
            let (first_node, first_entry) =
                (geometry.len() as u32 / Node::ROWS, order.len() as u32);
            geometry.extend(rebased(&bvh.nodes, first_node, first_entry));
            planes.extend(triangles::planes(own, &bvh.order));
            shading.extend(triangles::shading(own, &[], &bvh.order));
            order.extend(bvh.order.iter().map(|&index| own[index as usize].number));
            levels.push(Level { first_node, first_entry, entries: bvh.order.len() as u32 });
            source.hierarchies.push(binary(bvh.binary, &bvh.order, first_entry, own.len()));
        }
        source.shapes = from.placed.iter().map(|placed| placed.shape as u32 + 1).collect();
        params.first_planes = append(&mut geometry, &planes);
        params.first_order = append(&mut geometry, &rows_of(&order));
        let (table, numbers) = table(&from.placed, &placements, &levels, world_entries)?;
        params.first_instance = append(&mut geometry, &table);
        let instances = placements.len() as u32;
        Ok(Self { geometry, shading, numbers, instances, bounds, source })
    }
}

/// What the CPU's form of a hierarchy is made from: its tree, and the index of what each piece is
/// of, first that of one of its `triangles` and behind these that of an instance. Its leaf entries,
/// which have these indices, begin with number `first_entry`.
fn binary(
    (tree, pieces): (Bvh2, Vec<u32>),
    order: &[u32],
    first_entry: u32,
    triangles: usize,
) -> Binary {
    let mut entries = vec![0; triangles];
    for (place, &index) in order.iter().enumerate().rev() {
        if let Some(first) = entries.get_mut(index as usize) {
            *first = first_entry + place as u32;
        }
    }
    let content = |index: u32| match entries.get(index as usize) {
        Some(&entry) => Content::Triangle(entry),
        None => Content::Instance(index - triangles as u32),
    };
    Binary { tree, contents: pieces.into_iter().map(content).collect() }
}

/// The nodes of a hierarchy that begins at this node and this leaf entry.
fn rebased(nodes: &[UVec4], first_node: u32, first_entry: u32) -> impl Iterator<Item = UVec4> {
    nodes.iter().enumerate().map(move |(index, &row)| {
        let is_of_children = index as u32 % Node::ROWS == 1;
        if is_of_children { row + UVec4::new(first_node, first_entry, 0, 0) } else { row }
    })
}

/// The header and the rows of all instances, and how many numbers hits have.
fn table(
    placed: &[Placed],
    placements: &[Placement],
    levels: &[Level],
    world_entries: u32,
) -> Result<(Vec<UVec4>, u32), InvalidScene> {
    let width = placements.iter().map(|placement| placement.ray_width).fold(RAY_WIDTH, f32::max);
    let mut rows = vec![UVec4::new(placed.len() as u32, world_entries, width.to_bits(), 0)];
    let mut numbers = u64::from(world_entries);
    for (Placed { shape, first_in_scene, .. }, placement) in placed.iter().zip(placements) {
        let Level { first_node, first_entry, entries } = &levels[*shape];
        let span = UVec4::new(*first_node, numbers as u32, *first_entry, *first_in_scene);
        rows.extend(placement.inward);
        rows.push(span);
        rows.extend(placement.outward);
        rows.push(placement.measures);
        numbers += u64::from(*entries);
        if numbers >= u64::from(NO_TRIANGLE) {
            let what = format!(
                "have, with the parts that large triangles are split into, more than {NO_TRIANGLE} \
                 triangles, repeated ones counted: leave some out"
            );
            return Err(InvalidScene { place: "instances".to_owned(), what });
        }
    }
    Ok((rows, numbers as u32))
}

/// How an instance is placed.
struct Placement {
    /// From the world to the shape, and back.
    inward: [UVec4; 3],
    outward: [UVec4; 3],
    /// See [`raystream_shaders::scene::bvh::instance::Measures`].
    measures: UVec4,
    /// The box around all points of hits, with what
    /// [`BoxRay`](raystream_shaders::scene::bvh::node::BoxRay) asks for.
    bounds: Aabb,
    /// How wide, in roundings, a ray is outside.
    ray_width: f32,
}

/// The bound of roundings that rays start off surfaces by, see
/// [`raystream_shaders::scene::ray::SurfacePoint`].
const PLAIN_ROUNDINGS: f64 = 20.8;

impl Placement {
    /// Works out how far roundings of the transform move rays and hits.
    ///
    /// Let `W` be the map from the shape to the world, `M` that from the world, `m` its offset, `u`
    /// = 2^-24, `w` and `n` the maximum norms of the linear parts of `W` and `M`, `s` the largest
    /// factor by which `W` makes a vector longer, and `R` the shape's largest coordinate.
    ///
    /// **Boxes.** A ray from `o` along `d` starts at `M o + m` in the shape's space, with an error
    /// of at most `4 u (n |o| + |m|)`, and goes along `M d`, with `3 u n |d|`. What its hit at `t`
    /// is off that, by the proof of the node's test, is `32 u` of its origin there and what the
    /// shape's boxes have. With `t |d| <= |o| + |p|` the point `p` in the world is therefore within
    /// `u w (40 n |o| + 4 n |p| + 36 |m|)` of the box of the shape, brought to the world. What is
    /// relative to `o` is the ray's width, the rest is in the box.
    ///
    /// **Clearance.** A hit in the shape's space is at most 6.9 u R off its plane, which is 3.5 u R
    /// off the triangle. Brought to the world it is off by `4 u (w R + |W 0|)` more, and where a ray
    /// leaves, `M o + m` has `5 u (n |o| + |m|)` and the test 5.2 u R. Along the normal that is at
    /// most sqrt(3) times as much, and in the world `s` times; `|W 0| <= |p| + w R` and
    /// `|m| <= n |W 0|`. All of it is `u` times `(8.7 + 17.3 s n) |p|` and
    /// `(14 w + s (8.7 n w + 15.6)) R`, where a plane in the world has 20.8 |p|.
    fn of(placed: &Placed, bvh: &Bvh) -> Self {
        let outward = rounded(&placed.transform);
        let inward = rounded(&outward.inverse());
        let (w, n) = (norm(&outward.matrix3), norm(&inward.matrix3));
        let s = frobenius(&outward);
        let largest = |p: DVec3| p.abs().max_element();
        let [low, high] = [bvh.bounds.min, bvh.bounds.max].map(Vec3A::as_dvec3);
        let reach = largest(low).max(largest(high));

        let back = inward.inverse();
        let corners = (0..8_u32).map(|bits| {
            let side =
                |bit: u32, axis: usize| if bits >> bit & 1 == 1 { high[axis] } else { low[axis] };
            back.transform_point3(DVec3::new(side(0, 0), side(1, 1), side(2, 2)))
        });
        let (from, to) = corners
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(from, to), p| (from.min(p), to.max(p)));
        let rounding = f64::from(UNIT_ROUNDOFF);
        let farthest = largest(from).max(largest(to));
        let margin = rounding
            * ((f64::from(BOX_ROUNDINGS) + 4.0 * w * n) * farthest
                + 36.0 * w * largest(inward.translation));
        let factor = (8.7 + 17.3 * s * n) / PLAIN_ROUNDINGS;
        let spread = (14.0 * w + s * (8.7 * n * w + 15.6)) * reach / PLAIN_ROUNDINGS / factor;
        let is_mirrored = outward.matrix3.determinant() < 0.0;
        let [factor, spread, scale] =
            [factor, spread, frobenius(&inward)].map(|measure| (measure as f32).to_bits());
        let corner = |p: DVec3| Vec3A::from(p.as_vec3());
        Self {
            inward: rows_of_affine(&inward),
            outward: rows_of_affine(&outward),
            measures: UVec4::new(factor, spread, scale, is_mirrored.into()),
            // One more of the margin for the rounding of the corners themselves.
            bounds: Aabb::new(corner(from - 2.0 * margin), corner(to + 2.0 * margin)),
            ray_width: RAY_WIDTH + (40.0 * w * n) as f32,
        }
    }
}

/// A map as the kernels have it.
fn rounded(map: &DAffine3) -> DAffine3 {
    DAffine3::from_cols_array(&map.to_cols_array().map(|number| f64::from(number as f32)))
}

fn frobenius(map: &DAffine3) -> f64 {
    map.matrix3.to_cols_array().iter().map(|number| number * number).sum::<f64>().sqrt()
}

fn rows_of_affine(map: &DAffine3) -> [UVec4; 3] {
    [0, 1, 2].map(|axis| {
        let offset = (map.translation[axis] as f32).to_bits();
        row(map.matrix3.row(axis).as_vec3(), offset)
    })
}
