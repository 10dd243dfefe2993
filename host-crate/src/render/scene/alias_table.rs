//! The alias table, which chooses by weight.

/// Columns (threshold out of 2^24, alias) that choose in proportion to `weights`: Vose, "A Linear
/// Algorithm for Generating Random Numbers with a Given Distribution", IEEE TSE 17(9), 1991.
pub fn alias_table(weights: &[f64]) -> Vec<(u32, u32)> {
    const ONE: f64 = 16_777_216.0;
    let total: f64 = weights.iter().sum();
    let mut share: Vec<f64> = weights.iter().map(|w| w / total * weights.len() as f64).collect();
    let mut columns: Vec<(u32, u32)> =
        (0..weights.len() as u32).map(|own| (ONE as u32, own)).collect();
    let (mut small, mut large): (Vec<usize>, Vec<usize>) =
        (0..share.len()).partition(|&i| share[i] < 1.0);
    while let (Some(poor), Some(&rich)) = (small.pop(), large.last()) {
        columns[poor] = ((share[poor] * ONE).round() as u32, rich as u32);
        share[rich] -= 1.0 - share[poor];
        if share[rich] < 1.0 {
            large.pop();
            small.push(rich);
        }
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream_shaders::scene::abilities::Fixed;
    use raystream_shaders::scene::environment::{EnvironmentView, NO_ENVIRONMENT};
    use raystream_shaders::scene::light::tree::{LightTree, NO_TREE};
    use raystream_shaders::scene::light::{Light, LightView};
    use raystream_shaders::scene::texture::TextureView;

    #[test]
    fn lights_are_chosen_in_proportion_to_their_weights() {
        let weights = [1.0, 0.0, 5.0, 0.25, 3.0, 3.0, 1e-3];
        let lights: Vec<Light> = alias_table(&weights)
            .into_iter()
            .map(|(threshold, alias)| Light { threshold, alias, ..Default::default() })
            .collect();
        let rows: Vec<glam::UVec4> = bytemuck::pod_collect_to_vec(&lights);
        let view = LightView {
            rows: &rows,
            first: 0,
            count: lights.len() as u32,
            first_map: 0,
            tree: LightTree { rows: &rows, first: NO_TREE, lights: 0 },
            total_importance: 0.0,
            offset_roundings: 0.0,
            environment: EnvironmentView::new(&[], NO_ENVIRONMENT),
            textures: TextureView::new(&[], Fixed),
            abilities: Fixed::<0>,
        };
        // A regular grid of 2^20 numbers, so that the counts are within the number of column ends
        // of the exact ones.
        let mut counts = [0_u32; 7];
        for k in 0..1_u32 << 20 {
            counts[view.choose(k << 12 | 0x800) as usize] += 1;
        }
        let total: f64 = weights.iter().sum();
        for (&count, weight) in counts.iter().zip(weights) {
            let expected = weight / total * f64::from(1 << 20);
            assert!((f64::from(count) - expected).abs() <= 14.0, "{counts:?} for {weights:?}");
        }
    }
}
