//! Where the textures of a material lie on a mesh.

use super::described::Slot;
use crate::scene::gltf::layout::Layout;
use crate::scene::picture::Pictures;
use crate::scene::texture::{CoordinateSet, TextureId};

/// Which texture coordinates a mesh has of those in the file, and where textures lie on them.
///
/// Where all textures lie alike, coordinates are what the file makes of its own. Else they are the
/// file's own, of two sets at most, and textures lie by themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::scene::gltf) struct Arrangement {
    /// Of the first texture coordinates of the mesh, and of the second ones.
    pub layouts: [Option<Layout>; 2],
    /// Whether textures lie by themselves.
    places_textures: bool,
}

impl Arrangement {
    /// That of textures, or of none.
    pub(super) fn new(slots: &[Slot]) -> Self {
        let Some(first) = slots.first().map(|slot| slot.layout) else { return Self::default() };
        if slots.iter().all(|slot| slot.layout == first) {
            return Self { layouts: [Some(first), None], places_textures: false };
        }
        let other = slots.iter().map(|slot| slot.layout.set).find(|&set| set != first.set);
        let layouts = [Some(first.set), other].map(|set| set.map(Layout::of_set));
        Self { layouts, places_textures: true }
    }

    /// That of one layout.
    pub(super) fn of(layout: Layout) -> Self {
        Self { layouts: [Some(layout), None], places_textures: false }
    }

    /// Whether a texture lies in one of the sets of the mesh, and not in a third one.
    pub(super) fn has(&self, slot: &Slot) -> bool {
        self.layouts.iter().flatten().any(|layout| layout.set == slot.layout.set)
    }

    /// The texture as it lies on the mesh: one of a third set is laid by the first.
    pub(super) fn texture(&self, slot: &Slot, pictures: &mut Pictures) -> TextureId {
        if !self.places_textures {
            return slot.texture;
        }
        let is_second = self.layouts[1].is_some_and(|second| second.set == slot.layout.set);
        let set = if is_second { CoordinateSet::Second } else { CoordinateSet::First };
        pictures.placed(slot.texture, slot.layout.placement(set))
    }
}
