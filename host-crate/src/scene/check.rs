//! Whether the parts of a scene fit together.

use super::bounds::{self, MAX_COORDINATE, MAX_TEXELS, MAX_TEXTURE_SIDE};
use super::camera::NamedCamera;
use super::description::Scene;
use super::film::FilmSize;
use super::instance::Instance;
use super::material::{Attenuation, Maps, Material, Opacity, Principled, Reflectance};
use super::mesh::Mesh;
use super::metal::Conductor;
use super::texture::{Texels, Texture, TextureId, Wrap};
use glam::{DVec3, Vec3, Vec4};
use raystream_shaders::scene::media::MOST_BODIES;

/// What is wrong with a scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {what}")]
#[non_exhaustive]
pub struct InvalidScene {
    /// The field, as in `meshes[2].triangles[7]`.
    pub place: String,
    /// What is wrong with it.
    pub what: String,
}

/// How far the length of a unit normal may be from 1: one that was rounded a few times is nearer.
const UNIT_TOLERANCE: f32 = 1e-3;

impl Scene {
    /// Whether it can be rendered: every index is in range, every number finite and within the
    /// range that its field names. Triangles without area are fine, and are left out of renders.
    ///
    /// # Errors
    ///
    /// The first field that is wrong, and why.
    pub fn check(&self) -> Result<(), InvalidScene> {
        let FilmSize { width, height } = self.film;
        FilmSize::new(width.into(), height.into()).map_err(at("film"))?;
        self.camera.check().map_err(at("camera"))?;
        for (index, NamedCamera { camera, film, .. }) in self.cameras.iter().enumerate() {
            let place = format!("cameras[{index}]");
            camera.check().map_err(at(&place))?;
            FilmSize::new(film.width.into(), film.height.into()).map_err(at(&place))?;
        }
        bounds::depth(self.limits.max_depth.into()).map_err(at("limits.max_depth"))?;
        bounds::depth(self.limits.roulette_depth.into()).map_err(at("limits.roulette_depth"))?;
        radiance(self.background).map_err(at("background"))?;
        if let Some(environment) = &self.environment {
            environment.check().map_err(at("environment"))?;
        }
        self.check_textures()?;
        for (index, material) in self.materials.iter().enumerate() {
            self.check_material(material).map_err(at(&format!("materials[{index}]")))?;
        }
        let bodies = self.bodies().len();
        if self.has_media() && bodies > MOST_BODIES as usize {
            let what = format!(
                "bound {bodies} kinds of bodies, of glass or water, but where one of them absorbs \
                 light or has a priority there are at most {MOST_BODIES}"
            );
            return Err(at("materials")(what));
        }
        for (index, mesh) in self.meshes.iter().enumerate() {
            self.check_mesh(mesh).map_err(|InvalidScene { place, what }| InvalidScene {
                place: format!("meshes[{index}].{place}"),
                what,
            })?;
        }
        self.check_instances()?;
        self.check_quad_lights()?;
        self.check_punctual_lights()
    }

    fn check_textures(&self) -> Result<(), InvalidScene> {
        // They share a buffer.
        let mut texels = self.environment.as_ref().map_or(0, |e| e.texels.len());
        for (index, texture) in self.textures.iter().enumerate() {
            check_texture(texture).map_err(at(&format!("textures[{index}]")))?;
            texels += texture.texels.words();
        }
        // Each becomes a map of normals.
        let bumps = self.materials.iter().filter_map(|m| m.principled()?.maps.bump);
        let sizes = bumps.filter_map(|map| self.textures.get(map.texture.0 as usize));
        texels += sizes.map(|texture| 2 * texture.texels.len()).sum::<usize>();
        if texels > MAX_TEXELS {
            let what = format!(
                "have {texels} texels of 4 bytes together, but a scene has at most {MAX_TEXELS}"
            );
            return Err(at("textures")(what));
        }
        Ok(())
    }

    fn check_material(&self, material: &Material) -> Result<(), String> {
        let share = |name: &str, colour: Vec3| match bounds::reflectance(&values(colour)) {
            Ok(_) => Ok(()),
            Err(what) => Err(format!("{name} {what}")),
        };
        match *material {
            Material::Diffuse { reflectance: Reflectance::Colour(colour) }
            | Material::Mirror { reflectance: colour } => share("reflectance", colour),
            Material::Diffuse { reflectance: Reflectance::Texture(texture) } => {
                in_range("texture", texture.0, self.textures.len(), "textures")
            }
            Material::Dielectric { ior, transmittance, reflectance, attenuation, priority } => {
                check_body(attenuation, priority, true)?;
                bounds::ior(ior.into()).map_err(|what| format!("ior {what}"))?;
                share("transmittance", transmittance)?;
                share("reflectance", reflectance)
            }
            Material::Emissive { radiance: emitted, reflectance } => {
                radiance(emitted).map_err(|what| format!("radiance {what}"))?;
                share("reflectance", reflectance)
            }
            Material::Principled(ref principled) => self.check_principled(principled),
        }
    }

    fn check_principled(&self, material: &Principled) -> Result<(), String> {
        let named = |name: &str, checked: Result<(), String>| {
            checked.map_err(|what| format!("{name} {what}"))
        };
        self.check_maps(material)?;
        let rotation = bounds::rotation(material.anisotropy.rotation.into());
        named("anisotropy.rotation", rotation.map(drop))?;
        named("base_colour", bounds::reflectance(&values(material.base_colour)).map(drop))?;
        let shares = [
            ("anisotropy.strength", material.anisotropy.strength),
            ("metallic", material.metallic),
            ("roughness", material.roughness),
            ("transmission", material.transmission),
            ("coat", material.coat),
            ("coat_roughness", material.coat_roughness),
            ("sheen_roughness", material.sheen_roughness),
        ];
        for (name, value) in shares {
            named(name, bounds::share(value.into()).map(drop))?;
        }
        named("ior", bounds::ior(material.ior.into()).map(drop))?;
        named("specular", bounds::factor(&values(material.specular)).map(drop))?;
        named("sheen", bounds::reflectance(&values(material.sheen)).map(drop))?;
        if let Some(Conductor { eta, k }) = material.conductor {
            named("conductor.eta", bounds::eta(&values(eta)).map(drop))?;
            named("conductor.k", bounds::extinction(&values(k)).map(drop))?;
            let Maps { base_colour, metallic, .. } = material.maps;
            if material.metallic != 1.0 || base_colour.is_some() || metallic.is_some() {
                let what = "conductor must be metal alone, without maps of colour and of metal";
                return Err(what.to_owned());
            }
        }
        let has_body = Material::Principled(*material).body().is_some();
        check_body(material.attenuation, material.priority, has_body)?;
        let (alpha, cutoff) = match material.opacity {
            Opacity::Opaque => (1.0, 0.0),
            Opacity::Mask { alpha, cutoff } => (alpha, cutoff),
            Opacity::Blend { alpha } => (alpha, 0.0),
        };
        named("opacity.alpha", bounds::share(alpha.into()).map(drop))?;
        named("opacity.cutoff", bounds::share(cutoff.into()).map(drop))?;
        if material.opacity != Opacity::Opaque && material.emission != Vec3::ZERO {
            return Err("opacity must be that of an opaque surface, since it emits".to_owned());
        }
        named("emission", radiance(material.emission).map(drop))
    }

    fn check_maps(&self, material: &Principled) -> Result<(), String> {
        for texture in material.maps.textures() {
            in_range("texture", texture.0, self.textures.len(), "textures")?;
        }
        for map in [material.maps.roughness, material.maps.metallic].into_iter().flatten() {
            in_range("channel", map.channel, 4, "channels")?;
        }
        if let Some(TextureId(map)) = material.maps.emission {
            let brightest = f64::from(self.textures[map as usize].brightest());
            let most = f64::from(material.emission.max_element()) * brightest;
            if most > bounds::MAX_RADIANCE {
                let most_allowed = bounds::MAX_RADIANCE;
                return Err(format!(
                    "emission times that of its texture must be at most {most_allowed:e}, is {most:e}"
                ));
            }
        }
        if let Some(map) = material.maps.normal {
            bounds::scale(map.scale.into()).map_err(|what| format!("normal.scale {what}"))?;
        }
        if let Some(map) = material.maps.bump {
            bounds::scale(map.height.into()).map_err(|what| format!("bump.height {what}"))?;
            if material.maps.normal.is_some() {
                return Err("has maps of normals and of heights; it may have one of them".into());
            }
            if self.textures[map.texture.0 as usize].wrap.contains(&Wrap::Mirror) {
                return Err(
                    "bump.texture runs back beyond its edges; it may repeat or clamp".into()
                );
            }
        }
        Ok(())
    }

    fn check_mesh(&self, mesh: &Mesh) -> Result<(), InvalidScene> {
        in_range("material", mesh.material.0, self.materials.len(), "materials")
            .map_err(at("material"))?;
        for (index, position) in mesh.positions.iter().enumerate() {
            if let Err(what) = bounds::coordinates(&values(*position)) {
                return Err(at(&format!("positions[{index}]"))(what));
            }
        }
        for (index, corners) in mesh.triangles.iter().enumerate() {
            for &corner in corners {
                if let Err(what) = in_range("position", corner, mesh.positions.len(), "positions") {
                    return Err(at(&format!("triangles[{index}]"))(what));
                }
            }
        }
        check_normals(mesh)?;
        check_texture_coordinates(mesh)?;
        let material = &self.materials[mesh.material.0 as usize];
        if material.textures().next().is_some() && mesh.texture_coordinates.is_none() {
            let what = "are needed, since the material has a texture".to_owned();
            return Err(at("texture_coordinates")(what));
        }
        check_colours(mesh, material)
    }

    fn check_quad_lights(&self) -> Result<(), InvalidScene> {
        for (index, light) in self.quad_lights.iter().enumerate() {
            let place = format!("quad_lights[{index}]");
            for (name, vector) in [("corner", light.corner), ("u", light.u), ("v", light.v)] {
                bounds::coordinates(&vector.to_array()).map_err(at(&format!("{place}.{name}")))?;
            }
            radiance(light.radiance).map_err(at(&format!("{place}.radiance")))?;
            if !light.has_area() {
                return Err(at(&place)("u and v span no area".to_owned()));
            }
        }
        Ok(())
    }

    fn check_instances(&self) -> Result<(), InvalidScene> {
        for (index, shape) in self.shapes.iter().enumerate() {
            self.check_mesh(shape).map_err(|InvalidScene { place, what }| InvalidScene {
                place: format!("shapes[{index}].{place}"),
                what,
            })?;
        }
        let boxes: Vec<[DVec3; 2]> = self.shapes.iter().map(Mesh::bounds).collect();
        for (index, Instance { shape, transform }) in self.instances.iter().enumerate() {
            let place = format!("instances[{index}]");
            in_range("shape", shape.0, self.shapes.len(), "shapes").map_err(at(&place))?;
            let [low, high] = boxes[shape.0 as usize];
            // How far the farthest corner of the box goes, or farther.
            let reach = low.abs().max(high.abs());
            let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z]
                .map(|axis| transform.transform_vector3(axis * reach).abs());
            let farthest = (x + y + z + transform.translation.abs()).max_element();
            // Not a number is in no range.
            let is_near = farthest <= MAX_COORDINATE && transform.is_finite();
            if !is_near {
                let what = format!(
                    "places its shape farther than {MAX_COORDINATE:e} from the origin, or nowhere"
                );
                return Err(at(&format!("{place}.transform"))(what));
            }
        }
        let triangles = self.triangle_count();
        if triangles > u32::MAX as usize {
            let what = format!(
                "make {triangles} triangles, repeated ones counted, but a scene has at most {}",
                u32::MAX
            );
            return Err(at("instances")(what));
        }
        Ok(())
    }

    fn check_punctual_lights(&self) -> Result<(), InvalidScene> {
        for (index, light) in self.punctual_lights.iter().enumerate() {
            light
                .check()
                .map_err(|(field, what)| at(&format!("punctual_lights[{index}].{field}"))(what))?;
        }
        Ok(())
    }
}

/// Names the place of what is wrong.
fn at(place: &str) -> impl Fn(String) -> InvalidScene {
    move |what| InvalidScene { place: place.to_owned(), what }
}

fn values(vector: Vec3) -> [f64; 3] {
    vector.as_dvec3().to_array()
}

fn radiance(radiance: Vec3) -> Result<(), String> {
    bounds::radiance(&values(radiance)).map(drop)
}

fn in_range(name: &str, index: u32, count: usize, of: &str) -> Result<(), String> {
    if (index as usize) < count {
        Ok(())
    } else {
        Err(format!("{name} {index} does not exist: there are {count} {of}"))
    }
}

fn check_body(
    attenuation: Option<Attenuation>,
    priority: Option<i32>,
    has_body: bool,
) -> Result<(), String> {
    if let Some(Attenuation { colour, distance }) = attenuation {
        bounds::reflectance(&values(colour)).map_err(|w| format!("attenuation.colour {w}"))?;
        bounds::attenuation_distance(distance.into())
            .map_err(|what| format!("attenuation.distance {what}"))?;
    }
    if let Some(priority) = priority {
        bounds::priority(priority.into()).map_err(|what| format!("priority {what}"))?;
        if !has_body {
            return Err("priority is that of a body: of what light enters and has no holes".into());
        }
    }
    Ok(())
}

fn check_texture(texture: &Texture) -> Result<(), String> {
    let Texture { width, height, texels, wrap: _, filter: _ } = texture;
    if [width, height].iter().any(|side| !(1..=MAX_TEXTURE_SIDE).contains(side)) {
        return Err(format!(
            "width and height must be from 1 to {MAX_TEXTURE_SIDE} texels, are {width} and {height}"
        ));
    }
    let wanted = *width as usize * *height as usize;
    if texels.len() != wanted {
        return Err(format!("{width}x{height} texels are {wanted}, not {}", texels.len()));
    }
    if let Texels::Floats(texels) = texels {
        for (index, texel) in texels.iter().enumerate() {
            radiance(Vec3::from(*texel)).map_err(|what| format!("texels[{index}] {what}"))?;
        }
    }
    Ok(())
}

/// Fails if a list with an element for each triangle has another number of them.
fn check_count(place: &str, count: usize, mesh: &Mesh) -> Result<(), InvalidScene> {
    let triangles = mesh.triangles.len();
    if count == triangles {
        Ok(())
    } else {
        Err(at(place)(format!("are of {count} triangles, but the mesh has {triangles}")))
    }
}

fn check_normals(mesh: &Mesh) -> Result<(), InvalidScene> {
    let Some(normals) = &mesh.normals else { return Ok(()) };
    check_count("normals", normals.len(), mesh)?;
    let is_fine =
        |normal: &Vec3| *normal == Vec3::ZERO || (normal.length() - 1.0).abs() <= UNIT_TOLERANCE;
    match normals.iter().position(|corners| !corners.iter().all(is_fine)) {
        Some(index) => {
            let what = "must have unit length, or be zero".to_owned();
            Err(at(&format!("normals[{index}]"))(what))
        }
        None => Ok(()),
    }
}

fn check_colours(mesh: &Mesh, material: &Material) -> Result<(), InvalidScene> {
    let Some(colours) = &mesh.colours else { return Ok(()) };
    check_count("colours", colours.len(), mesh)?;
    if !material.takes_colours() {
        let what = "are there, but the material has no colour that they could multiply".to_owned();
        return Err(at("colours")(what));
    }
    let is_share = |colour: &Vec4| colour.cmpge(Vec4::ZERO).all() && colour.cmple(Vec4::ONE).all();
    if let Some(index) = colours.iter().position(|corners| !corners.iter().all(is_share)) {
        let what = format!("must be from 0 to 1, are {:?}", colours[index]);
        return Err(at(&format!("colours[{index}]"))(what));
    }
    let is_opaque = colours.as_flattened().iter().all(|colour| colour.w == 1.0);
    if material.has_holes() && material.body().is_some() && !is_opaque {
        let what = "have alpha, but the material bounds a body, which has no holes".to_owned();
        return Err(at("colours")(what));
    }
    Ok(())
}

fn check_texture_coordinates(mesh: &Mesh) -> Result<(), InvalidScene> {
    let Some(coordinates) = &mesh.texture_coordinates else { return Ok(()) };
    check_count("texture_coordinates", coordinates.len(), mesh)?;
    // Not a number is in no range.
    let is_fine = |c: &f32| f64::from(c.abs()) <= MAX_COORDINATE;
    let position = coordinates
        .iter()
        .position(|corners| !corners.iter().all(|uv| uv.to_array().iter().all(is_fine)));
    match position {
        Some(index) => Err(at(&format!("texture_coordinates[{index}]"))(format!(
            "must be from -{MAX_COORDINATE} to {MAX_COORDINATE}"
        ))),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::camera::Camera;
    use crate::scene::environment::Environment;
    use crate::scene::light::QuadLight;
    use crate::scene::material::{BumpMap, MaterialId, NormalMap};
    use crate::scene::metal::Metal;
    use glam::Vec2;

    /// A triangle under a lamp.
    fn scene() -> Scene {
        let camera = Camera::new(Vec3::Z, Vec3::ZERO, 40.0);
        let mut scene = Scene::new(camera, FilmSize { width: 4, height: 3 });
        let material = scene.add_material(Material::diffuse(Vec3::ONE));
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        scene.add_mesh(Mesh::new(material, positions, vec![[0, 1, 2]]));
        scene.add_quad_light(QuadLight::new(Vec3::Z, Vec3::X, Vec3::Y, Vec3::ONE));
        scene
    }

    #[test]
    fn good_scenes_pass() {
        assert_eq!(scene().check(), Ok(()));
        let mut flat = scene();
        flat.meshes[0].triangles.push([1, 1, 1]);
        assert_eq!(flat.check(), Ok(()), "a triangle without area is left out later");
        let mut limits = scene();
        limits.add_material(Material::glass(0.01));
        limits.add_material(Material::emissive(Vec3::splat(1e12)));
        limits.add_material(Material::Principled(Principled::glass(100.0, 1.0)));
        assert_eq!(limits.check(), Ok(()), "limits survive being rounded to an f32");
    }

    /// A place and what spoils a scene there.
    type Case<'a> = (&'a str, &'a dyn Fn(&mut Scene));

    /// Spoils scenes and asserts that the place is named.
    fn assert_named(cases: &[Case<'_>]) {
        for (place, spoil) in cases {
            let mut scene = scene();
            spoil(&mut scene);
            assert_eq!(scene.check().unwrap_err().place, *place);
        }
    }

    const NAN: Vec3 = Vec3::new(0.0, f32::NAN, 0.0);

    fn texture(width: u32, texels: usize) -> Texture {
        Texture::new(width, 1, vec![[0; 4]; texels])
    }

    fn number(texel: [f32; 3]) -> Texture {
        Texture::of(1, 1, Texels::Floats(vec![texel]))
    }

    /// Paint with something changed.
    fn paint(change: impl Fn(&mut Principled)) -> Material {
        let mut material = Principled::paint(Vec3::ONE, 0.5);
        change(&mut material);
        Material::Principled(material)
    }

    #[test]
    fn what_is_wrong_with_a_material_is_named() {
        assert_named(&[
            ("materials[0]", &|s| s.materials[0] = Material::textured(TextureId(0))),
            ("materials[0]", &|s| s.materials[0] = Material::mirror(Vec3::splat(1.1))),
            ("materials[0]", &|s| s.materials[0] = Material::glass(0.0)),
            ("materials[0]", &|s| s.materials[0] = Material::emissive(NAN)),
            ("materials[0]", &|s| s.materials[0] = paint(|m| m.roughness = 1.1)),
            ("materials[0]", &|s| {
                let texture = s.add_texture(texture(1, 1));
                s.materials[0] = paint(|m| m.maps.bump = Some(BumpMap { texture, height: 1e5 }));
            }),
            ("materials[0]", &|s| {
                let texture = s.add_texture(Texture { wrap: [Wrap::Mirror; 2], ..texture(1, 1) });
                s.materials[0] = paint(|m| m.maps.bump = Some(BumpMap { texture, height: 1.0 }));
            }),
            ("materials[0]", &|s| {
                let texture = s.add_texture(texture(1, 1));
                s.materials[0] = paint(|m| {
                    m.maps.bump = Some(BumpMap { texture, height: 1.0 });
                    m.maps.normal = Some(NormalMap { texture, scale: 1.0 });
                });
            }),
            ("materials[0]", &|s| s.materials[0] = paint(|m| m.coat = -0.1)),
            ("materials[0]", &|s| s.materials[0] = paint(|m| m.anisotropy.strength = 1.1)),
            ("materials[0]", &|s| s.materials[0] = paint(|m| m.anisotropy.rotation = f32::NAN)),
            ("materials[0]", &|s| s.materials[0] = paint(|m| m.sheen.x = 1.1)),
            ("materials[0]", &|s| {
                let map = Some(s.add_texture(number([1e7; 3])));
                s.materials[0] = paint(|m| (m.emission, m.maps.emission) = (Vec3::splat(1e6), map));
            }),
            ("materials[0]", &|s| {
                s.materials[0] = Material::Principled(Principled::metal(NAN, 0.1));
            }),
            ("materials[0]", &|s| {
                s.materials[0] = Material::Principled(Principled::glass(0.0, 0.1));
            }),
            ("materials[0]", &|s| {
                s.materials[0] = paint(|m| m.opacity = Opacity::Blend { alpha: f32::NAN });
            }),
            ("materials[0]", &|s| {
                s.materials[0] = paint(|m| {
                    m.opacity = Opacity::Mask { alpha: 1.0, cutoff: 0.5 };
                    m.emission = Vec3::ONE;
                });
            }),
            ("materials[0]", &|s| {
                let gold = Principled::conductor(Metal::Gold.conductor(), 0.1);
                s.materials[0] = Material::Principled(Principled { metallic: 0.5, ..gold });
            }),
            ("materials[0]", &|s| {
                let of_nothing = Conductor { eta: Vec3::ZERO, k: Vec3::ONE };
                let metal = Principled::conductor(of_nothing, 0.1);
                s.materials[0] = Material::Principled(metal);
            }),
        ]);
    }

    #[test]
    fn what_is_wrong_with_a_body_is_named() {
        assert_named(&[
            ("materials[0]", &|s| s.materials[0] = paint(|m| m.priority = Some(1))),
            ("materials[0]", &|s| {
                s.materials[0] = paint(|m| (m.transmission, m.priority) = (1.0, Some(1001)));
            }),
            ("materials[0]", &|s| {
                s.materials[0] = paint(|m| {
                    (m.transmission, m.thin_walled, m.priority) = (1.0, true, Some(1));
                });
            }),
            ("materials[0]", &|s| {
                s.materials[0] = paint(|m| {
                    m.attenuation = Some(Attenuation { colour: Vec3::ONE, distance: 0.0 });
                });
            }),
            ("materials", &|s| {
                let water = Principled { priority: Some(1), ..Principled::glass(1.3, 0.0) };
                let liquids = (0..256).map(|k| Principled { ior: 1.3 + k as f32 * 1e-3, ..water });
                s.materials.extend(liquids.map(Material::Principled));
            }),
        ]);
    }

    #[test]
    fn what_is_wrong_around_the_meshes_is_named() {
        let environment = |texel| Some(Environment::new(1, 1, vec![texel]));
        let bright = Environment { strength: 2e6, ..Environment::new(1, 1, vec![Vec3::ONE]) };
        assert_named(&[
            ("environment", &|s| s.environment = environment(NAN)),
            ("environment", &|s| s.environment = Some(Environment::new(2, 1, vec![Vec3::ONE]))),
            ("environment", &|s| s.environment = Some(bright.clone())),
            ("film", &|s| s.film.width = 0),
            ("camera", &|s| s.camera.target = s.camera.origin),
            ("camera", &|s| s.camera.up = Vec3::ZERO),
            ("camera", &|s| s.camera = Camera::new(Vec3::Z, Vec3::ZERO, f32::NAN)),
            ("limits.max_depth", &|s| s.limits.max_depth = 0),
            ("background", &|s| s.background = Vec3::NEG_X),
            ("textures[0]", &|s| s.textures.push(texture(0, 0))),
            ("textures[0]", &|s| s.textures.push(texture(2, 1))),
            ("textures[0]", &|s| s.textures.push(number([0.0, -1.0, 0.0]))),
            ("textures[0]", &|s| s.textures.push(number([f32::NAN; 3]))),
            ("quad_lights[0]", &|s| s.quad_lights[0].v = s.quad_lights[0].u),
            ("quad_lights[0].radiance", &|s| s.quad_lights[0].radiance = NAN),
        ]);
    }

    #[test]
    fn what_is_wrong_with_a_mesh_is_named() {
        assert_named(&[
            ("meshes[0].material", &|s| s.meshes[0].material = MaterialId(1)),
            ("meshes[0].positions[1]", &|s| s.meshes[0].positions[1] = NAN),
            ("meshes[0].triangles[0]", &|s| s.meshes[0].triangles[0][2] = 3),
            ("meshes[0].normals", &|s| s.meshes[0].normals = Some(Vec::new())),
            ("meshes[0].normals[0]", &|s| s.meshes[0].normals = Some(vec![[Vec3::ONE; 3]])),
            ("meshes[0].texture_coordinates[0]", &|s| {
                s.meshes[0].texture_coordinates = Some(vec![[Vec2::INFINITY; 3]]);
            }),
            ("meshes[0].colours", &|s| s.meshes[0].colours = Some(Vec::new())),
            ("meshes[0].colours[0]", &|s| {
                s.meshes[0].colours = Some(vec![[Vec4::ONE, Vec4::NAN, Vec4::ONE]]);
            }),
            ("meshes[0].colours", &|s| {
                s.materials[0] = Material::mirror(Vec3::ONE);
                s.meshes[0].colours = Some(vec![[Vec4::ONE; 3]]);
            }),
            ("meshes[0].colours", &|s| {
                s.materials[0] = paint(|m| {
                    (m.transmission, m.opacity) = (1.0, Opacity::Blend { alpha: 1.0 });
                });
                s.meshes[0].colours = Some(vec![[Vec4::splat(0.5); 3]]);
            }),
            ("meshes[0].texture_coordinates", &|s| {
                let texture = s.add_texture(texture(1, 1));
                s.materials[0] = Material::textured(texture);
            }),
        ]);
    }
}
