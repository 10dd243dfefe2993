//! Materials.

mod cover;
mod described;
mod left_out;

use self::described::{Described, Sources};
use super::document::Document;
use super::layout::Layout;
use super::texture::Textures;
use crate::scene::description::Scene;
use crate::scene::error::SceneError;
use crate::scene::material::{Channel, Maps, Material, MaterialId, NormalMap, Opacity, Principled};
use crate::scene::options::LoadOptions;
use crate::scene::source::Source;
use crate::scene::summary::{Fate, Summary};
use glam::Vec3;
use std::collections::HashMap;
use std::rc::Rc;

/// The channels of roughness and metal.
const ROUGHNESS: u32 = 1;
const METALLIC: u32 = 2;
/// That of opacity.
const ALPHA: usize = 3;

const ALPHA_OF_BODIES: Fate =
    Fate::Becomes("bodies have no holes, the alpha of their vertices does not count: ");

/// The colour of all vertices of a primitive.
#[derive(Clone, Copy)]
pub(super) struct VertexColour {
    /// Linear Rec.709, each component in [0, 1].
    pub colour: Vec3,
    pub is_opaque: bool,
}

impl VertexColour {
    pub(super) const WHITE: Self = Self { colour: Vec3::ONE, is_opaque: true };
}

/// What the corners of a primitive have.
pub(super) struct CornersHave<'a> {
    /// Whether there are the texture coordinates of a set.
    pub set: &'a dyn Fn(u32) -> bool,
    /// Whether there are tangents that count.
    pub tangents: bool,
}

/// What triangles are made of.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Surface {
    /// Nothing: they are not seen.
    Nothing,
    Of(MaterialId),
}

/// A material of the scene, and where its textures lie.
#[derive(Clone, Copy)]
pub(super) struct Made {
    pub surface: Surface,
    /// None if it has no texture.
    pub layout: Option<Layout>,
}

/// What tells materials of a scene apart that are one in the file: its number there, the colour of
/// vertices, whether their alpha counts, whether there are texture coordinates.
type Key = (Option<usize>, [u32; 3], bool, bool);

/// The materials of a file as they are made.
pub(super) struct Materials<'a> {
    sources: Sources<'a>,
    described: HashMap<Option<usize>, Rc<Described>>,
    made: HashMap<Key, MaterialId>,
}

impl<'a> Materials<'a> {
    pub(super) fn new(
        document: &'a Document<'a>,
        source: &'a dyn Source,
        options: &LoadOptions,
    ) -> Self {
        Self {
            sources: Sources {
                document,
                textures: Textures::new(document, source, options),
                summary: Summary::default(),
            },
            described: HashMap::new(),
            made: HashMap::new(),
        }
    }

    /// What the triangles of the primitive at `place` are made of, by the number of their material
    /// in the file, or by default.
    pub(super) fn surface(
        &mut self,
        material: Option<usize>,
        vertices: VertexColour,
        corners: CornersHave<'_>,
        place: &str,
        scene: &mut Scene,
    ) -> Result<Made, SceneError> {
        let described = match self.described.get(&material) {
            Some(described) => described.clone(),
            None => {
                let described = Rc::new(self.sources.describe(material, place)?);
                self.described.insert(material, described.clone());
                described
            }
        };
        if described.is_invisible {
            return Ok(Made { surface: Surface::Nothing, layout: None });
        }
        let has_alpha = !vertices.is_opaque && self.takes_alpha(&described, place);
        let layout = described.layout().filter(|layout| (corners.set)(layout.set));
        let path = self.sources.document.path;
        let mut note = |fate| self.sources.summary.note(path, 0, fate, place, &described.name);
        if layout.is_none() && described.layout_of_textures().is_some() {
            note(Fate::MeanOfTexture);
        }
        let has_grain = described.plain.anisotropy.strength > 0.0;
        if has_grain && layout.is_none() && !corners.tangents {
            note(Fate::WithoutGrain);
        }
        let colour = vertices.colour.to_array().map(f32::to_bits);
        let key = (material, colour, has_alpha, layout.is_some());
        let id = match self.made.get(&key) {
            Some(&id) => id,
            None => {
                let mut made = self.make(&described, vertices.colour, layout.is_some());
                if has_alpha && made.opacity == Opacity::Opaque {
                    made.opacity = described.opacity;
                }
                let id = scene.add_material(Material::Principled(made));
                self.made.insert(key, id);
                id
            }
        };
        Ok(Made { surface: Surface::Of(id), layout })
    }

    /// Whether the alpha of vertices counts for a material; says so if it should and does not.
    fn takes_alpha(&mut self, described: &Described, place: &str) -> bool {
        let Described { plain, opacity, .. } = described;
        if *opacity == Opacity::Opaque || plain.emission != Vec3::ZERO {
            return false;
        }
        let is_body = plain.transmission > 0.0 && !plain.thin_walled;
        if is_body && plain.opacity == Opacity::Opaque {
            let thing = format!("COLOR_0 of {place}");
            let Sources { document, summary, .. } = &mut self.sources;
            summary.note(document.path, 0, ALPHA_OF_BODIES, &thing, &described.name);
            return false;
        }
        true
    }

    /// The material with its textures, or else with their means.
    fn make(&self, described: &Described, colour: Vec3, is_textured: bool) -> Principled {
        let Described { base_colour, roughness, normal, emission, .. } = described;
        let mut made = described.plain;
        made.base_colour *= colour;
        if is_textured {
            let channel =
                |channel: u32| roughness.map(|slot| Channel { texture: slot.texture, channel });
            made.maps = Maps {
                base_colour: base_colour.map(|slot| slot.texture),
                roughness: channel(ROUGHNESS),
                metallic: channel(METALLIC),
                normal: normal.map(|(slot, scale)| NormalMap { texture: slot.texture, scale }),
                bump: None,
                emission: emission.map(|slot| slot.texture),
            };
            return made;
        }
        let pictures = &self.sources.textures.pictures;
        if let Some(slot) = base_colour {
            let texture = pictures.get(slot.texture);
            made.base_colour *= texture.mean();
            if let Opacity::Mask { alpha, .. } | Opacity::Blend { alpha } = &mut made.opacity {
                *alpha *= texture.mean_code(ALPHA);
            }
        }
        if let Some(slot) = emission {
            made.emission *= pictures.get(slot.texture).mean_emission();
        }
        if let Some(slot) = roughness {
            let texture = pictures.get(slot.texture);
            made.roughness *= texture.mean_code(ROUGHNESS as usize);
            made.metallic *= texture.mean_code(METALLIC as usize);
        }
        made
    }

    /// Hands over the textures, and says what is left out of materials.
    pub(super) fn finish(self, scene: &mut Scene) {
        self.sources.summary.finish(scene);
        let pictures = self.sources.textures.pictures;
        scene.textures = pictures.textures;
        scene.warnings.extend(pictures.warnings);
    }
}
