//! Leaves out triangles that nobody sees.

use super::mesh::{Mesh, has_area};
use glam::Vec3;
use std::collections::HashSet;

/// Drops triangles without area and, if wanted, those with the corners of another.
pub(super) struct Cleaner {
    /// How many triangles had no area.
    pub degenerate: usize,
    /// How many triangles had the corners of an earlier one.
    pub duplicates: usize,
    /// The corners of the triangles so far; `None` when duplicates are kept.
    seen: Option<HashSet<[[u32; 3]; 3]>>,
}

impl Cleaner {
    /// `dedupe` drops triangles with the same three corners as an earlier one of any mesh, in any
    /// order.
    pub(super) fn new(dedupe: bool) -> Self {
        Self { degenerate: 0, duplicates: 0, seen: dedupe.then(HashSet::new) }
    }

    /// Drops them from a mesh.
    pub(super) fn clean(&mut self, mesh: &mut Mesh) {
        mesh.retain(|corners| {
            if !has_area(corners) {
                self.degenerate += 1;
                return false;
            }
            let is_new = self.seen.as_mut().is_none_or(|seen| seen.insert(identity(corners)));
            self.duplicates += usize::from(!is_new);
            is_new
        });
    }
}

/// The same for every triangle with the same corners, in any order.
fn identity(corners: [Vec3; 3]) -> [[u32; 3]; 3] {
    // Adding zero makes a zero of -0.
    let mut bits = corners.map(|corner| (corner + Vec3::ZERO).to_array().map(f32::to_bits));
    bits.sort_unstable();
    bits
}
