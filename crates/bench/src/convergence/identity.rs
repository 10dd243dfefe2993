//! What a reference picture is a picture of, so that a stored one is taken for no other.

use raystream::exec::kernels::SPIRV;
use raystream::image::LayeredImage;
use raystream::render::{IntegratorKind, Settings, Techniques};
use raystream::scene::Scene;
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
            pair("kernels", hex(&Sha256::digest(SPIRV))),
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
            pair("background", settings.background.to_string()),
            pair("ray_offset", settings.ray_offset.to_string()),
            pair("integrator", settings.integrator.to_string()),
        ];
        if settings.integrator == IntegratorKind::Lvc {
            pairs.push(pair("light_cache", format!("{:?}", settings.light_cache)));
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
        hex(&hasher.finalize())[..12].to_owned()
    }
}

/// A digest of what is in a scene: geometry, materials, textures and camera. Its name and its
/// limits are not.
fn scene_digest(scene: &Scene) -> String {
    let mut hasher = Sha256::new();
    for triangle in &scene.triangles {
        hasher.update(bytemuck::bytes_of(&triangle.to_rows()));
    }
    hasher.update(bytemuck::cast_slice(&scene.attributes));
    hasher.update(bytemuck::cast_slice(&scene.materials));
    hasher.update(bytemuck::cast_slice(&scene.texels));
    let lengths =
        [scene.triangles.len(), scene.attributes.len(), scene.materials.len(), scene.texels.len()];
    lengths.iter().for_each(|&length| hasher.update((length as u64).to_le_bytes()));
    let camera = &scene.camera;
    for vector in [camera.origin, camera.target, camera.up] {
        hasher.update(bytemuck::bytes_of(&vector));
    }
    hasher.update(camera.fov_y.to_le_bytes());
    hex(&hasher.finalize())
}

/// A digest of a picture's channels, their names aside.
pub fn pixels_digest(image: &LayeredImage) -> String {
    let mut hasher = Sha256::new();
    let mut channels: Vec<_> = image.channels.iter().collect();
    channels.sort_by(|a, b| a.name.cmp(&b.name));
    for channel in channels {
        hasher.update(bytemuck::cast_slice(&channel.values));
    }
    hex(&hasher.finalize())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream::render::LightCacheSettings;
    use raystream::scene::{FilmSize, embedded};

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
                scene.triangles[3].corner.x += 0.01;
                scene
            },
            {
                let mut scene = scene.clone();
                scene.materials.swap(0, 1);
                scene
            },
            {
                let mut scene = scene.clone();
                scene.camera.fov_y += 1.0;
                scene
            },
        ];
        for changed in &changed_scenes {
            assert_ne!(one.short(), Identity::new(changed, &settings(), 64).short());
        }
        let changed_settings = [
            Settings { seed: 2, ..settings() },
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
