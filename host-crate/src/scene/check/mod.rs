//! Whether the parts of a scene fit together.

mod materials;
mod meshes;
#[cfg(test)]
mod tests;
mod textures;

use super::bounds;
use super::camera::{Camera, NamedCamera};
use super::description::Scene;
use super::film::FilmSize;
use glam::Vec3;
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

impl Camera {
    /// What is wrong with it, as the field `camera` of a scene.
    pub(crate) fn check_as_field(&self) -> Result<(), InvalidScene> {
        self.check().map_err(at("camera"))
    }
}

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
        self.camera.check_as_field()?;
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
