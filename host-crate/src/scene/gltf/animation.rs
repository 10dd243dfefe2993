//! Animations: nodes as they stand at a time.

use super::document::Document;
use super::nodes::unit;
use crate::scene::error::SceneError;
use glam::DQuat;
use gltf::json::animation::{Channel, Interpolation, Property};
use gltf::json::scene::UnitQuaternion;
use gltf::json::validation::Checked::Valid;
use std::time::Duration;

/// What a channel makes of a node's property.
struct Change {
    node: usize,
    property: Property,
    value: Vec<f32>,
}

/// Where a time lies among the keys of a sampler.
#[derive(Clone, Copy)]
struct Between {
    /// The last key that is not later, or the first one.
    key: usize,
    /// How far it is from there to the next one, in [0, 1], and how far these are apart in seconds.
    share: f64,
    seconds: f64,
}

/// Changes the nodes of a file to what its first animation makes of them at this time from its
/// beginning. Before its first key and after its last one it stands still.
pub(super) fn pose(document: &mut Document<'_>, at: Duration) -> Result<(), SceneError> {
    let Some(animation) = document.root.animations.first() else { return Ok(()) };
    let mut changes = Vec::new();
    for (number, channel) in animation.channels.iter().enumerate() {
        let place = format!("animations[0].channels[{number}]");
        changes.extend(change(document, channel, at.as_secs_f64(), &place)?);
    }
    for Change { node, property, value } in changes {
        let node = &mut document.root.nodes[node];
        match (property, value.as_slice()) {
            (Property::Translation, &[x, y, z]) => node.translation = Some([x, y, z]),
            (Property::Scale, &[x, y, z]) => node.scale = Some([x, y, z]),
            (Property::Rotation, &[x, y, z, w]) => {
                node.rotation = Some(UnitQuaternion([x, y, z, w]));
            }
            _ => node.weights = Some(value),
        }
        if property != Property::MorphTargetWeights {
            // A node that moves has no matrix.
            node.matrix = None;
        }
    }
    Ok(())
}

/// What a channel changes; nothing if it is of no property that is known.
fn change(
    document: &Document<'_>,
    channel: &Channel,
    at: f64,
    place: &str,
) -> Result<Option<Change>, SceneError> {
    let Valid(property) = channel.target.path else { return Ok(None) };
    let node = channel.target.node.value();
    document.get(&document.root.nodes, node, "nodes", &format!("{place}.target"))?;
    let samplers = &document.root.animations[0].samplers;
    let number = channel.sampler.value();
    let sampler = document.get(samplers, number, "samplers", place)?;
    let here = format!("animations[0].samplers[{number}]");
    let times: Vec<f64> = document
        .numbers::<1>(sampler.input.value(), &format!("{here}.input"))?
        .into_iter()
        .map(|[time]| f64::from(time))
        .collect();
    let output = (sampler.output.value(), format!("{here}.output"));
    let values: Vec<f32> = match property {
        Property::Translation | Property::Scale => {
            document.numbers::<3>(output.0, &output.1)?.into_flattened()
        }
        Property::Rotation => document.numbers::<4>(output.0, &output.1)?.into_flattened(),
        Property::MorphTargetWeights => {
            document.numbers::<1>(output.0, &output.1)?.into_flattened()
        }
    };
    let Valid(interpolation) = sampler.interpolation else {
        return Err(document.wrong(&format!("{here}.interpolation"), "is none of glTF's"));
    };
    let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    let keys = times.len() * per_key;
    let size = values.len().checked_div(keys).unwrap_or(0);
    let is_whole = size > 0 && values.len() == size * keys;
    let fits = match property {
        Property::Translation | Property::Scale => size == 3,
        Property::Rotation => size == 4,
        Property::MorphTargetWeights => true,
    };
    if !is_whole || !fits {
        let what = format!("has {} numbers for {} keys", values.len(), times.len());
        return Err(document.wrong(&output.1, what));
    }
    let between = Between::of(&times, at);
    let mut value = interpolated(&values, size, between, interpolation);
    if property == Property::Rotation && interpolation == Interpolation::Linear {
        value = turned(&values, between);
    }
    Ok(Some(Change { node, property, value }))
}

impl Between {
    fn of(times: &[f64], at: f64) -> Self {
        let key = times.partition_point(|&time| time <= at).saturating_sub(1);
        let seconds = times.get(key + 1).map_or(0.0, |next| next - times[key]);
        let share = if seconds > 0.0 { ((at - times[key]) / seconds).clamp(0.0, 1.0) } else { 0.0 };
        Self { key, share, seconds }
    }
}

/// A property of `size` numbers between two keys (glTF 2.0, appendix C).
fn interpolated(
    values: &[f32],
    size: usize,
    Between { key, share, seconds }: Between,
    interpolation: Interpolation,
) -> Vec<f32> {
    let number = |place: usize, k: usize| f64::from(values[place * size + k]);
    let at = |k: usize| match interpolation {
        _ if share == 0.0 && interpolation != Interpolation::CubicSpline => number(key, k),
        Interpolation::Step => number(key, k),
        Interpolation::Linear => number(key, k) + (number(key + 1, k) - number(key, k)) * share,
        Interpolation::CubicSpline if share == 0.0 => number(3 * key + 1, k),
        Interpolation::CubicSpline => {
            // Each key has the tangent that arrives, the value and the tangent that leaves.
            let (from, leaves) = (number(3 * key + 1, k), number(3 * key + 2, k) * seconds);
            let (to, arrives) = (number(3 * key + 4, k), number(3 * key + 3, k) * seconds);
            let (t, t2, t3) = (share, share * share, share.powi(3));
            from * (2.0 * t3 - 3.0 * t2 + 1.0)
                + leaves * (t3 - 2.0 * t2 + t)
                + to * (3.0 * t2 - 2.0 * t3)
                + arrives * (t3 - t2)
        }
    };
    (0..size).map(|k| at(k) as f32).collect()
}

/// A rotation between two keys, along the shorter way.
fn turned(values: &[f32], Between { key, share, .. }: Between) -> Vec<f32> {
    let at = |key: usize| unit(std::array::from_fn(|k| f64::from(values[4 * key + k])));
    let from: DQuat = at(key);
    let turned = if share > 0.0 { from.slerp(at(key + 1), share) } else { from };
    turned.to_array().map(|number| number as f32).to_vec()
}
