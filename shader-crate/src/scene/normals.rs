//! Which way a surface faces at a point, and which way it has to face for whoever looks at it.
//!
//! A map of normals feigns bumps on a triangle that stays flat. What a bump mirrors may then lie
//! behind the triangle, where there is nothing: at grazing angles a smooth surface would be black.
//! So lobes that mirror have a normal of their own: the map's, bent towards the triangle's as far
//! as it takes for the mirror image to be above the triangle. Cycles does the same (there
//! `ensure_valid_specular_reflection`). What follows the cosine keeps the map's normal.
//!
//! Kernels know of that by the ability [`NORMAL_MAPS`].

use crate::glam::Vec3;
use crate::scene::abilities::{Abilities, NORMAL_MAPS};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Least cosine to the triangle's normal of what is mirrored, in general.
const LEAST_HEIGHT: f32 = 0.01;
/// The same as a factor of the viewer's own cosine, where that is small.
const LEAST_SHARE: f32 = 0.9;
/// Squared sine under which two normals are one.
const SAME: f32 = 1e-12;

/// Unit normals of one side of a surface, as its corners and maps have them. Aligned as WGSL has it:
/// a struct around it must leave it the 48 bytes that it has there.
#[derive(Clone, Copy)]
#[repr(align(16))]
pub struct Normals {
    /// That of shading.
    pub shading: Vec3,
    /// That of the triangle where a map bends one of the others, else the shading normal.
    pub geometric: Vec3,
    /// That of the coat.
    pub coat: Vec3,
}

impl Normals {
    /// One for all.
    pub fn all(normal: Vec3) -> Self {
        Self { shading: normal, geometric: normal, coat: normal }
    }

    /// Those of this side, if `sign` is 1, or of the other one, if it is -1.
    pub fn on_side(&self, sign: f32) -> Self {
        let Self { shading, geometric, coat } = *self;
        Self { shading: shading * sign, geometric: geometric * sign, coat: coat * sign }
    }

    /// The same for lobes that mirror what comes from `viewer`, a unit vector that points away from
    /// this side of the triangle; where no map bends anything, these. The scene uses no more than
    /// `abilities`.
    #[inline(always)]
    pub fn mirroring<A: Abilities>(&self, viewer: Vec3, abilities: A) -> Self {
        let Self { mut shading, geometric, mut coat } = *self;
        if abilities.has(NORMAL_MAPS) {
            shading = bent(shading, geometric, viewer);
            coat = bent(coat, geometric, viewer);
        }
        Self { shading, geometric, coat }
    }
}

/// The `normal`, bent towards the `geometric` one until `viewer` sees it and its mirror image is
/// above the triangle.
///
/// In the plane of both normals, let the normal stand at the angle `a` from the geometric one, and
/// the viewer's projection, of length `r`, at `b`. The mirror image then has the height
/// `r cos(2a - b)`. So twice the angle is a direction at hand: that of the least height, on the side
/// of the normal.
fn bent(normal: Vec3, geometric: Vec3, viewer: Vec3) -> Vec3 {
    let (cosine, height) = (normal.dot(viewer), geometric.dot(viewer).max(0.0));
    let upright = normal.dot(geometric);
    let least = (LEAST_SHARE * height).min(LEAST_HEIGHT);
    if cosine > 0.0 && 2.0 * cosine * upright - height >= least {
        return normal;
    }
    let along = normal - geometric * upright;
    let squared = along.length_squared();
    if squared <= SAME {
        return geometric;
    }
    let along = along / squared.sqrt();
    let beside = viewer.dot(along);
    let reach = (beside * beside + height * height).max(f32::MIN_POSITIVE);
    let across = (reach - least * least).max(0.0).sqrt();
    // Cosine of twice the angle.
    let twice = ((height * least - beside * across) / reach).clamp(-1.0, 1.0);
    let (sine, cosine) = ((0.5 - 0.5 * twice).sqrt(), (0.5 + 0.5 * twice).sqrt());
    (along * sine + geometric * cosine).normalize()
}
