//! Bump maps as maps of normals, which kernels know.

use super::geometry::Geometry;
use super::scene_triangle::SceneTriangle;
use crate::scene::{
    BumpMap, Material, NormalMap, Placement, Scene, Texels, Texture, TextureId, Wrap,
};
use glam::{DVec2, DVec3, Vec2, Vec3};

/// A material whose texture is so unevenly large on its surfaces, as a standard deviation over the
/// mean, is one to speak of.
const UNEVEN: f64 = 0.25;

/// The maps of normals of a scene.
#[derive(Default)]
pub struct NormalMaps {
    /// Textures beyond those of the scene.
    pub textures: Vec<Texture>,
    /// For each material its map of normals, its own or that which its bump map stands for.
    pub of_materials: Vec<Option<NormalMap>>,
    /// How many bump maps lie on surfaces in sizes that differ.
    pub uneven: usize,
}

/// How often a texture lies on each world unit of the surfaces of a material.
#[derive(Clone, Copy, Default)]
struct Density {
    area: f64,
    /// Sums of the gradients' lengths of the two texture coordinates, times areas.
    sum: DVec2,
    /// The same of their squares.
    squares: DVec2,
}

impl NormalMaps {
    /// Those of a scene that was checked.
    pub fn new(scene: &Scene, geometry: &Geometry) -> Self {
        let mut maps = Self::default();
        let bump = |material: &Material| material.principled().and_then(|p| p.maps.bump);
        let mut densities = Vec::new();
        if scene.materials.iter().any(|material| bump(material).is_some()) {
            densities = densities_of(scene, geometry);
        }
        for (index, material) in scene.materials.iter().enumerate() {
            let own = material.principled().and_then(|p| p.maps.normal);
            let of_bump = bump(material).map(|BumpMap { texture, height }| {
                let density = densities[index];
                maps.uneven += usize::from(density.is_uneven());
                let heights = &scene.textures[texture.0 as usize];
                maps.textures.push(normals(heights, density.mean() * f64::from(height)));
                let number = scene.textures.len() + maps.textures.len() - 1;
                NormalMap { texture: TextureId(number as u32), scale: 1.0 }
            });
            maps.of_materials.push(own.or(of_bump));
        }
        maps
    }
}

impl Density {
    fn mean(&self) -> DVec2 {
        if self.area > 0.0 { self.sum / self.area } else { DVec2::ZERO }
    }

    fn is_uneven(&self) -> bool {
        let mean = self.mean();
        let variance = self.squares / self.area.max(f64::MIN_POSITIVE) - mean * mean;
        (variance - mean * mean * (UNEVEN * UNEVEN)).max_element() > 0.0
    }
}

/// For each material the density of its texture. That of a shape with instances is as in its own
/// space, once.
fn densities_of(scene: &Scene, geometry: &Geometry) -> Vec<Density> {
    let place = |material: &Material| {
        let bump = material.principled().and_then(|principled| principled.maps.bump);
        bump.map(|map| scene.textures[map.texture.0 as usize].placement)
    };
    let places: Vec<Option<Placement>> = scene.materials.iter().map(place).collect();
    let mut densities = vec![Density::default(); places.len()];
    let shapes = geometry.shapes.iter().map(|shape| &shape.own);
    for triangle in shapes.chain([&geometry.world]).flat_map(|them| &them.triangles) {
        let material = triangle.material as usize;
        let Some(Some(place)) = places.get(material) else { continue };
        let corners = geometry.corners.coordinates(triangle.attributes, place.set);
        let Some(corners) = corners else { continue };
        let (area, gradients) = gradients(triangle, corners.map(|uv| place.of(uv.into())));
        let density = &mut densities[material];
        density.area += area;
        density.sum += gradients * area;
        density.squares += gradients * gradients * area;
    }
    densities
}

/// The area of a triangle, and how fast its texture coordinates grow where they grow fastest, by
/// world unit.
fn gradients(triangle: &SceneTriangle, coordinates: [Vec2; 3]) -> (f64, DVec2) {
    let [a, b, c] = triangle.corners.map(Vec3::as_dvec3);
    let (edge1, edge2): (DVec3, DVec3) = (b - a, c - a);
    let doubled = edge1.cross(edge2).length();
    let of = |[first, second, third]: [f32; 3]| {
        let [along1, along2] = [second, third].map(|value| f64::from(value) - f64::from(first));
        // The gradient of what grows so much along the two edges.
        (edge2 * along1 - edge1 * along2).length() / doubled
    };
    let (u, v) = (coordinates.map(|uv| uv.x), coordinates.map(|uv| uv.y));
    (0.5 * doubled, DVec2::new(of(u), of(v)))
}

/// The map of normals of a picture of heights, of its size: by differences of the texels on both
/// sides, where the texture lies `density` times on a unit of height.
fn normals(heights: &Texture, density: DVec2) -> Texture {
    let Texture { width, height, wrap, filter, placement, .. } = *heights;
    let values = values(&heights.texels);
    let neighbour = |place: u32, step: i64, size: u32, wrap: Wrap| match wrap {
        Wrap::Clamp => (i64::from(place) + step).clamp(0, i64::from(size) - 1) as usize,
        // One that runs back has no heights.
        Wrap::Repeat | Wrap::Mirror => (i64::from(place) + step).rem_euclid(size.into()) as usize,
    };
    let row = width as usize;
    let code = |component: f64| ((0.5 * component + 0.5) * 65_535.0).round() as u16;
    let texel = |x: u32, y: u32| {
        let (column, line) = (x as usize, y as usize);
        let [left, right] = [-1, 1].map(|step| neighbour(x, step, width, wrap[0]) + line * row);
        let [above, below] = [-1, 1].map(|step| neighbour(y, step, height, wrap[1]) * row + column);
        let rise = DVec2::new(
            f64::from(values[right] - values[left]) * f64::from(width),
            f64::from(values[above] - values[below]) * f64::from(height),
        );
        let normal = (-0.5 * rise * density).extend(1.0).normalize();
        let [x, y, z] = normal.to_array().map(code);
        [x, y, z, u16::MAX]
    };
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let texels = texels.map(|(x, y)| texel(x, y)).collect();
    Texture { wrap, filter, placement, ..Texture::of(width, height, Texels::Shorts(texels)) }
}

/// The heights of texels: the means of their three colours, linear.
fn values(texels: &Texels) -> Vec<f32> {
    match texels {
        Texels::Bytes(texels) => {
            texels.iter().map(|&[r, g, b, _]| mean([r, g, b].map(f32::from)) / 255.0).collect()
        }
        Texels::Shorts(texels) => {
            texels.iter().map(|&[r, g, b, _]| mean([r, g, b].map(f32::from)) / 65_535.0).collect()
        }
        Texels::Floats(texels) => texels.iter().map(|&texel| mean(texel)).collect(),
    }
}

fn mean(colours: [f32; 3]) -> f32 {
    colours.iter().sum::<f32>() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::scene::geometry::gather;
    use crate::scene::{Camera, FilmSize, Maps, Mesh, Principled};
    use glam::Vec2;

    /// A scene of a floor with a bump map of this height that lies `times` on each unit.
    fn floor(texture: Texture, height: f32, times: Vec2) -> Scene {
        let mut scene =
            Scene::new(Camera::new(Vec3::Z, Vec3::ZERO, 40.0), FilmSize { width: 4, height: 3 });
        let bump = Some(BumpMap { texture: scene.add_texture(texture), height });
        let maps = Maps { bump, ..Maps::default() };
        let paint = Principled { maps, ..Principled::paint(Vec3::ONE, 0.5) };
        let material = scene.add_material(Material::Principled(paint));
        let corners = [Vec2::new(-3.0, -2.0), Vec2::new(3.0, -2.0), Vec2::new(1.0, 4.0)];
        let positions = corners.map(|corner| corner.extend(0.0)).to_vec();
        let mut mesh = Mesh::new(material, positions, vec![[0, 1, 2]]);
        mesh.texture_coordinates = Some(vec![corners.map(|corner| corner * times)]);
        scene.add_mesh(mesh);
        scene
    }

    fn decoded(texture: &Texture, x: u32, y: u32) -> Vec3 {
        let Texels::Shorts(texels) = &*texture.texels else { panic!("normals have 16 bits") };
        let [r, g, b, _] = texels[(y * texture.width + x) as usize];
        Vec3::from([r, g, b].map(|code| f32::from(code) / 32_767.5 - 1.0))
    }

    #[test]
    fn a_slope_is_that_of_the_surface() {
        // Rises by 1 along a texture of 64 texels, then falls back; and by half of that upwards.
        let size = 64;
        let place = |k: i32| (k % size) as f32 / size as f32;
        let heights =
            (0..size * size).map(|k| [place(k) + 0.5 * place(size - 1 - k / size); 3]).collect();
        let texture = Texture::of(size as u32, size as u32, Texels::Floats(heights));
        let (height, times) = (0.25, Vec2::new(0.5, 2.0));
        let scene = floor(texture, height, times);
        let maps = NormalMaps::new(&scene, &gather(&scene));
        assert_eq!((maps.textures.len(), maps.uneven), (1, 0));
        let map = maps.of_materials[0].unwrap();
        assert_eq!((map.texture, map.scale), (TextureId(1), 1.0));
        // By world unit: a rise of height times how often the texture lies there.
        let expected = Vec3::new(-height * times.x, -0.5 * height * times.y, 1.0).normalize();
        for (x, y) in [(1, 1), (20, 30), (62, 62)] {
            let found = decoded(&maps.textures[0], x, y);
            assert!((found - expected).length() < 1e-4, "{x} {y}: {found} {expected}");
        }
        // At its edge, where it repeats, there is a step of 1 - 1/64 over two texels.
        let step = 0.5 * (1.0 - 2.0 / 64.0) * 64.0 * height * times.x;
        let edge = decoded(&maps.textures[0], 0, 30);
        assert!((edge.x / edge.z - step).abs() < 0.01 * step, "{edge} {step}");
    }

    #[test]
    fn a_clamped_picture_goes_on_level() {
        let heights = Texels::Bytes(vec![[0; 4], [51; 4], [255; 4]]);
        let texture = Texture { wrap: [Wrap::Clamp; 2], ..Texture::of(3, 1, heights) };
        let scene = floor(texture, 1.0, Vec2::ONE);
        let maps = NormalMaps::new(&scene, &gather(&scene));
        let slopes = [0, 1, 2].map(|x| decoded(&maps.textures[0], x, 0)).map(|n| -n.x / n.z);
        let expected = [0.5 * 3.0 * 0.2, 0.5 * 3.0, 0.5 * 3.0 * 0.8];
        for (found, expected) in slopes.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-3, "{slopes:?}");
        }
        assert!(maps.textures[0].wrap == [Wrap::Clamp; 2]);
    }

    #[test]
    fn uneven_sizes_are_noticed_and_count_by_area() {
        let mut scene = floor(Texture::new(2, 1, vec![[0; 4], [255; 4]]), 1.0, Vec2::ONE);
        let mut other = scene.meshes[0].clone();
        for uv in other.texture_coordinates.iter_mut().flatten().flatten() {
            *uv *= 3.0;
        }
        scene.add_mesh(other);
        let geometry = gather(&scene);
        // The second floor has the corners of the first, and so is no copy of nothing.
        assert_eq!(geometry.copies(), 1);
        assert_eq!(NormalMaps::new(&scene, &geometry).uneven, 0);
        for position in &mut scene.meshes[1].positions {
            position.z = 1.0;
        }
        let maps = NormalMaps::new(&scene, &gather(&scene));
        let density = densities_of(&scene, &gather(&scene))[0];
        assert!((density.mean() - DVec2::splat(2.0)).length() < 1e-6, "{}", density.mean());
        assert_eq!(maps.uneven, 1);
    }
}
