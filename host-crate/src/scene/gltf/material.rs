//! Materials.

mod arrangement;
mod cover;
mod described;
mod left_out;

use self::arrangement::Arrangement;
use self::described::{Described, Slot, Sources};
use super::document::Document;
use super::layout::Layout;
use super::texture::Textures;
use crate::scene::description::Scene;
use crate::scene::error::SceneError;
use crate::scene::material::{Material, MaterialId, Opacity, Principled};
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
const ALPHA: u32 = 3;

const TWO_SETS: Fate = Fate::Becomes(
    "a material has two sets of texture coordinates here; these textures are laid by the first: ",
);
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
    /// See [`Arrangement::layouts`].
    pub layouts: [Option<Layout>; 2],
}

/// What tells materials of a scene apart that are one in the file: its number there, the colour of
/// vertices, whether their alpha counts, for which textures there are coordinates.
type Key = (Option<usize>, [u32; 3], bool, Vec<bool>);

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
            return Ok(Made { surface: Surface::Nothing, layouts: [None; 2] });
        }
        let has_alpha = !vertices.is_opaque && self.takes_alpha(&described, place);
        let is_shown: Vec<bool> =
            described.slots.iter().map(|slot| (corners.set)(slot.layout.set)).collect();
        let arrangement = self.arrangement(&described, &is_shown, &corners, place);
        let colour = vertices.colour.to_array().map(f32::to_bits);
        let key = (material, colour, has_alpha, is_shown);
        let id = match self.made.get(&key) {
            Some(&id) => id,
            None => {
                let mut made = self.make(&described, vertices.colour, &key.3, &arrangement);
                if has_alpha && made.opacity == Opacity::Opaque {
                    made.opacity = described.opacity;
                }
                let id = scene.add_material(Material::Principled(made));
                self.made.insert(key, id);
                id
            }
        };
        Ok(Made { surface: Surface::Of(id), layouts: arrangement.layouts })
    }

    /// Where the textures lie that are shown of a material; says which are not shown so.
    fn arrangement(
        &mut self,
        described: &Described,
        is_shown: &[bool],
        corners: &CornersHave<'_>,
        place: &str,
    ) -> Arrangement {
        let Sources { document, summary, .. } = &mut self.sources;
        let shown = described.slots.iter().zip(is_shown).filter(|(_, is_shown)| **is_shown);
        let shown: Vec<Slot> = shown.map(|(slot, _)| *slot).collect();
        let mut note = |fate, thing: &str| {
            summary.note(document.path, 0, fate, thing, &described.name);
        };
        if shown.len() < described.slots.len() {
            note(Fate::MeanOfTexture, place);
        }
        let mut arrangement = Arrangement::new(&shown);
        for slot in shown.iter().filter(|slot| !arrangement.has(slot)) {
            note(TWO_SETS, slot.name);
        }
        let has_grain = described.plain.anisotropy.strength > 0.0;
        if has_grain && shown.is_empty() && (corners.set)(Layout::FIRST.set) {
            arrangement = Arrangement::of(Layout::FIRST);
        }
        if has_grain && arrangement.layouts[0].is_none() && !corners.tangents {
            note(Fate::WithoutGrain, place);
        }
        arrangement
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

    /// The material with those of its textures that are shown, and with the means of the others.
    fn make(
        &mut self,
        described: &Described,
        colour: Vec3,
        is_shown: &[bool],
        arrangement: &Arrangement,
    ) -> Principled {
        let mut made = described.plain;
        made.base_colour *= colour;
        let pictures = &mut self.sources.textures.pictures;
        for (slot, is_shown) in described.slots.iter().zip(is_shown) {
            if *is_shown {
                slot.says.put(arrangement.texture(slot, pictures), &mut made.maps);
            } else {
                slot.says.multiply_by_mean(pictures.get(slot.texture), &mut made);
            }
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
