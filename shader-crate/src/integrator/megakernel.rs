//! The integrator `megakernel`: one thread walks one path to its end.

use crate::film::Contribution;
use crate::film::stream::{NO_PIXEL, Slot};
use crate::integrator::params::PathParams;
use crate::integrator::path::Path;
use crate::memory::access::at;
use crate::scene::SceneView;
use crate::scene::abilities::Abilities;

/// Kernel: traces the path of slot `lane` to its end.
pub fn trace_paths(
    lane: u32,
    params: &PathParams,
    scene: &SceneView<'_, impl Abilities>,
    slots: &[Slot],
    contribution: &mut Contribution,
) {
    *contribution = trace_slot(params, scene, at(slots, lane));
}

/// The contribution of one slot.
pub fn trace_slot(
    params: &PathParams,
    scene: &SceneView<'_, impl Abilities>,
    slot: Slot,
) -> Contribution {
    if slot.rank == NO_PIXEL {
        return Contribution::NOTHING;
    }
    let numbers = params.numbers(slot);
    let mut path = Path::begin(params, scene, slot, &numbers);
    while path.extend(params, scene, &numbers) {}
    path.contribution()
}
