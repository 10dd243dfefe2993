//! What a reference picture is a picture of, so that a stored one is taken for no other.

use raystream::exec::kernels::SPIRV;
use raystream::film_file::hexadecimal;
use raystream::image::LayeredImage;
use raystream::render::{IntegratorKind, Settings, Techniques};
use raystream::scene::{
    Anisotropy, Attenuation, BumpMap, Camera, Channel, Conductor, CoordinateSet, Instance, Lens,
    Maps, Material, Opacity, Placement, Principled, Projection, PunctualLight, Reflectance, Scene,
    Texels, Texture, TextureFilter, TextureId,
};
use sha2::{Digest, Sha256};

/// Everything that a reference's pixels depend on, as pairs of name and value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity(pub Vec<(String, String)>);

impl Identity {
    /// The identity of a render of `scene` with `settings` and `samples` per pixel, uniformly.
    pub fn new(scene: &Scene, settings: &Settings, samples: u32) -> Self {
        let pair = |name: &str, value: String| (name.to_owned(), value);
        let techniques = match settings.techniques {
            Techniques::Both => "both",
            Techniques::LightSampling => "light",
            Techniques::BsdfSampling => "bsdf",
        };
        let mut pairs = vec![
            pair("scene", scene_digest(scene)),
            pair("kernels", hexadecimal(&Sha256::digest(SPIRV))),
            pair("size", format!("{}x{}", settings.size.width, settings.size.height)),
            pair("samples", samples.to_string()),
            pair("seed", settings.seed.to_string()),
            pair(
                "sampler",
                if settings.independent_sampler { "independent" } else { "sobol" }.into(),
            ),
            pair("max_depth", settings.max_depth.to_string()),
            pair("rr_depth", settings.roulette_depth.to_string()),
            pair("techniques", techniques.into()),
            pair("background", scene.background.to_string()),
            pair("ray_offset", settings.ray_offset.to_string()),
            pair("integrator", settings.integrator.to_string()),
        ];
        if settings.integrator == IntegratorKind::Lvc {
            pairs.push(pair("light_cache", format!("{:?}", settings.light_cache)));
        }
        if !settings.pixel_filter.is_pixel() {
            pairs.push(pair("pixel_filter", format!("{:?}", settings.pixel_filter)));
        }
        Self(pairs)
    }

    /// The names of the values that differ in `stored`.
    pub fn differences(&self, stored: &std::collections::BTreeMap<String, String>) -> Vec<&str> {
        let differing = self.0.iter().filter(|(name, value)| stored.get(name) != Some(value));
        differing.map(|(name, _)| name.as_str()).collect()
    }

    /// Twelve digits that tell pictures apart, in file names; renders by other kernels share them,
    /// and replace each other.
    pub fn short(&self) -> String {
        let mut hasher = Sha256::new();
        for (name, value) in self.0.iter().filter(|(name, _)| name != "kernels") {
            hasher.update(format!("{name}={value}\n"));
        }
        hexadecimal(&hasher.finalize())[..12].to_owned()
    }
}

/// A digest of what is in a scene: surfaces, lights, materials, textures, environment and camera.
/// Its name, its background and its limits are not.
fn scene_digest(scene: &Scene) -> String {
    let mut hasher = Sha256::new();
    for mesh in scene.meshes.iter().chain(&scene.shapes) {
        add(&mut hasher, &[mesh.material.0]);
        add(&mut hasher, &mesh.positions);
        add(&mut hasher, mesh.triangles.as_flattened());
        add(&mut hasher, mesh.normals.as_deref().unwrap_or_default().as_flattened());
        let coordinates = mesh.texture_coordinates.as_deref().unwrap_or_default();
        add(&mut hasher, coordinates.as_flattened());
        if let Some(second) = &mesh.second_coordinates {
            add(&mut hasher, second.as_flattened());
        }
        if let Some(colours) = &mesh.colours {
            add(&mut hasher, colours.as_flattened());
        }
    }
    for light in &scene.quad_lights {
        add(&mut hasher, &[light.corner, light.u, light.v]);
        add(&mut hasher, &[light.radiance]);
    }
    for material in &scene.materials {
        add_material(&mut hasher, material);
    }
    for texture in &scene.textures {
        add_texture(&mut hasher, texture);
    }
    if let Some(environment) = &scene.environment {
        add(&mut hasher, &[environment.width, environment.height]);
        add(&mut hasher, &environment.texels);
        add(&mut hasher, &[environment.rotation, environment.strength]);
    }
    let lengths =
        [scene.meshes.len(), scene.quad_lights.len(), scene.materials.len(), scene.textures.len()];
    add(&mut hasher, &lengths.map(|length| length as u64));
    let Camera { origin, target, up, projection } = scene.camera;
    add(&mut hasher, &[origin, target, up]);
    add_projection(&mut hasher, projection);
    for light in &scene.punctual_lights {
        add_punctual_light(&mut hasher, light);
    }
    // Of scenes without any, digests are as they were.
    if !scene.shapes.is_empty() {
        add(&mut hasher, &[scene.shapes.len() as u64]);
        for Instance { shape, transform } in &scene.instances {
            add(&mut hasher, &[shape.0]);
            add(&mut hasher, &transform.to_cols_array());
        }
    }
    hexadecimal(&hasher.finalize())
}

/// Adds values and how many there are.
fn add<T: bytemuck::NoUninit>(hasher: &mut Sha256, values: &[T]) {
    hasher.update((values.len() as u64).to_le_bytes());
    hasher.update(bytemuck::cast_slice::<T, u8>(values));
}

fn add_texture(hasher: &mut Sha256, texture: &Texture) {
    add(hasher, &[texture.width, texture.height]);
    match &*texture.texels {
        Texels::Bytes(texels) => add(hasher, texels),
        Texels::Shorts(texels) => add(hasher, texels),
        Texels::Floats(texels) => add(hasher, texels),
    }
    if texture.filter != TextureFilter::Linear {
        hasher.update([1]);
    }
    if texture.placement != Placement::default() {
        add(hasher, &texture.placement.numbers());
        hasher.update([u8::from(texture.placement.set == CoordinateSet::Second)]);
    }
}

fn add_material(hasher: &mut Sha256, material: &Material) {
    match *material {
        Material::Diffuse { reflectance: Reflectance::Colour(colour) } => {
            hasher.update([0]);
            add(hasher, &[colour]);
        }
        Material::Diffuse { reflectance: Reflectance::Texture(texture) } => {
            hasher.update([1]);
            add(hasher, &[texture.0]);
        }
        Material::Mirror { reflectance } => {
            hasher.update([2]);
            add(hasher, &[reflectance]);
        }
        Material::Dielectric { ior, transmittance, reflectance, attenuation, priority } => {
            hasher.update([3]);
            add(hasher, &[ior]);
            add(hasher, &[transmittance, reflectance]);
            add_body(hasher, attenuation, priority);
        }
        Material::Emissive { radiance, reflectance } => {
            hasher.update([4]);
            add(hasher, &[radiance, reflectance]);
        }
        Material::Principled(material) => {
            hasher.update([5]);
            let Principled { metallic, roughness, ior, transmission, .. } = material;
            add(hasher, &[metallic, roughness, ior, transmission]);
            add(hasher, &[material.base_colour, material.specular, material.emission]);
            add_layers(hasher, &material);
            add_body(hasher, material.attenuation, material.priority);
            add_maps(hasher, &material.maps);
        }
    }
}

/// What principled materials may have besides; nothing of one that has none of it.
fn add_layers(hasher: &mut Sha256, material: &Principled) {
    let Principled { coat, coat_roughness, sheen, sheen_roughness, .. } = *material;
    if material.has_cover() {
        add(hasher, &[sheen]);
        add(hasher, &[coat, coat_roughness, sheen_roughness]);
    }
    match material.opacity {
        Opacity::Opaque => {}
        Opacity::Mask { alpha, cutoff } => add(hasher, &[alpha, cutoff]),
        Opacity::Blend { alpha } => add(hasher, &[alpha]),
    }
    if let Some(Conductor { eta, k }) = material.conductor {
        add(hasher, &[eta, k]);
    }
    if material.thin_walled {
        hasher.update([1]);
    }
    if material.f90 != 1.0 {
        add(hasher, &[material.f90]);
    }
    let Anisotropy { strength, rotation } = material.anisotropy;
    if strength > 0.0 {
        add(hasher, &[strength, rotation]);
    }
}

/// What a body has besides; nothing of one that is clear and without a priority.
fn add_body(hasher: &mut Sha256, attenuation: Option<Attenuation>, priority: Option<i32>) {
    if let Some(Attenuation { colour, distance }) = attenuation {
        add(hasher, &[colour]);
        add(hasher, &[distance]);
    }
    if let Some(priority) = priority {
        add(hasher, &[priority]);
    }
}

fn add_projection(hasher: &mut Sha256, projection: Projection) {
    match projection {
        Projection::Perspective { fov_y, lens } => {
            add(hasher, &[fov_y]);
            if let Some(Lens { radius, focus_distance, blades }) = lens {
                add(hasher, &[radius, focus_distance]);
                add(hasher, &[blades]);
            }
        }
        Projection::Orthographic { width } => {
            hasher.update([1]);
            add(hasher, &[width]);
        }
        Projection::Panorama => hasher.update([2]),
    }
}

fn add_punctual_light(hasher: &mut Sha256, light: &PunctualLight) {
    match *light {
        PunctualLight::Point { position, intensity } => {
            hasher.update([0]);
            add(hasher, &[position, intensity]);
        }
        PunctualLight::Spot { position, direction, intensity, inner_angle, outer_angle } => {
            hasher.update([1]);
            add(hasher, &[position, direction, intensity]);
            add(hasher, &[inner_angle, outer_angle]);
        }
        PunctualLight::Directional { direction, irradiance, angle } => {
            hasher.update([2]);
            add(hasher, &[direction, irradiance]);
            add(hasher, &[angle]);
        }
    }
}

fn add_maps(hasher: &mut Sha256, maps: &Maps) {
    let texture = |map: Option<TextureId>| map.map_or(u32::MAX, |map| map.0);
    let channel =
        |map: Option<Channel>| map.map_or([u32::MAX; 2], |map| [map.texture.0, map.channel]);
    let layers = [
        maps.coat.map(|map| map.texture),
        maps.coat_roughness.map(|map| map.texture),
        maps.coat_normal.map(|map| map.texture),
        maps.sheen,
        maps.sheen_roughness.map(|map| map.texture),
        maps.transmission.map(|map| map.texture),
        maps.specular.map(|map| map.texture),
        maps.specular_colour,
        maps.anisotropy,
    ];
    if layers.iter().any(Option::is_some) {
        add(hasher, &layers.map(texture));
        let shares = [
            maps.coat,
            maps.coat_roughness,
            maps.sheen_roughness,
            maps.transmission,
            maps.specular,
        ];
        add(hasher, &shares.map(|map| map.map_or(0, |map| map.channel)));
        add(hasher, &[maps.coat_normal.map_or(1.0, |map| map.scale)]);
    }
    let [roughness, metallic] = [maps.roughness, maps.metallic].map(channel);
    add(hasher, &[texture(maps.base_colour), texture(maps.normal.map(|map| map.texture))]);
    add(hasher, &[roughness, metallic].concat());
    add(hasher, &[maps.normal.map_or(1.0, |map| map.scale)]);
    if let Some(emission) = maps.emission {
        add(hasher, &[emission.0]);
    }
    if let Some(BumpMap { texture, height }) = maps.bump {
        add(hasher, &[texture.0]);
        add(hasher, &[height]);
    }
}

/// A digest of a picture's channels, their names aside.
pub fn pixels_digest(image: &LayeredImage) -> String {
    let mut hasher = Sha256::new();
    let mut channels: Vec<_> = image.channels.iter().collect();
    channels.sort_by(|a, b| a.name.cmp(&b.name));
    for channel in channels {
        hasher.update(bytemuck::cast_slice(&channel.values));
    }
    hexadecimal(&hasher.finalize())
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream::render::{LightCacheSettings, PixelFilter};
    use raystream::scene::{Environment, FilmSize, embedded};

    fn settings() -> Settings {
        Settings {
            size: FilmSize { width: 4, height: 3 },
            seed: 1,
            max_depth: 8,
            ray_offset: 4.0,
            integrator: IntegratorKind::Megakernel,
            ..Settings::for_scene(&embedded().unwrap())
        }
    }

    #[test]
    fn every_part_of_a_scene_and_every_setting_counts() {
        let scene = embedded().unwrap();
        let one = Identity::new(&scene, &settings(), 64);
        assert_eq!(one, Identity::new(&scene, &settings(), 64));
        let changed_scenes = [
            {
                let mut scene = scene.clone();
                scene.meshes[0].positions[3].x += 0.01;
                scene
            },
            {
                let mut scene = scene.clone();
                scene.materials.swap(0, 1);
                scene
            },
            {
                let mut scene = scene.clone();
                scene.camera.projection = Projection::Panorama;
                scene
            },
            {
                let mut scene = scene.clone();
                scene.add_punctual_light(PunctualLight::point(glam::Vec3::Y, glam::Vec3::ONE));
                scene
            },
            {
                let mut scene = scene.clone();
                scene.background = glam::Vec3::ONE;
                scene
            },
            {
                let mut scene = scene.clone();
                scene.set_environment(Environment::new(1, 1, vec![glam::Vec3::ONE]));
                scene
            },
        ];
        for changed in &changed_scenes {
            assert_ne!(one.short(), Identity::new(changed, &settings(), 64).short());
        }
        let changed_settings = [
            Settings { seed: 2, ..settings() },
            Settings {
                pixel_filter: PixelFilter { width: 2.0, ..PixelFilter::default() },
                ..settings()
            },
            Settings { max_depth: 7, ..settings() },
            Settings { size: FilmSize { width: 3, height: 4 }, ..settings() },
            Settings { ray_offset: 5.0, ..settings() },
            Settings { integrator: IntegratorKind::Lvc, ..settings() },
        ];
        for changed in &changed_settings {
            assert_ne!(one.short(), Identity::new(&scene, changed, 64).short());
        }
        assert_ne!(one.short(), Identity::new(&scene, &settings(), 65).short());
    }

    #[test]
    fn the_light_cache_counts_for_its_integrator_alone() {
        let scene = embedded().unwrap();
        let light_cache =
            LightCacheSettings { connections: Some(3), ..LightCacheSettings::default() };
        for integrator in
            [IntegratorKind::Megakernel, IntegratorKind::Streaming, IntegratorKind::Lvc]
        {
            let plain = Identity::new(&scene, &Settings { integrator, ..settings() }, 64);
            let other =
                Identity::new(&scene, &Settings { integrator, light_cache, ..settings() }, 64);
            assert_eq!(plain != other, integrator == IntegratorKind::Lvc, "{integrator:?}");
        }
    }

    #[test]
    fn other_kernels_are_a_difference_under_the_same_name() {
        let scene = embedded().unwrap();
        let identity = Identity::new(&scene, &settings(), 64);
        let mut stored: std::collections::BTreeMap<_, _> = identity.0.iter().cloned().collect();
        assert_eq!(identity.differences(&stored), [""; 0]);
        stored.insert("kernels".into(), "others".into());
        assert_eq!(identity.differences(&stored), ["kernels"]);
        let others = Identity(stored.into_iter().collect());
        let mut sorted = identity.clone();
        sorted.0.sort();
        assert_eq!(sorted.short(), others.short());
    }
}
