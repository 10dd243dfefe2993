//! Slot for slot on the GPU.
//!
//! Each integrator is a kernel of its own (or several) to a driver's compiler, which may fuse a
//! product and a sum in one of them and not in another. So a ray may, about once in a thousand
//! times, hit something else (`scene/traversal.rs` has the same bound for GPU and CPU), and then
//! its path is another one of the same distribution.

use super::tracing::{OTHERS, cases, integrator};
use raystream::exec::Executor;
use raystream_shaders::film::Contribution;
use raystream_tests::statistics::normal_quantile;
use raystream_tests::with_gpu;
use std::io::Write;

/// Share of the rays that rounding may turn to something else.
const TURNED: f64 = 0.001;
/// Relative difference up to which radiance counts as the same but for rounding.
const ROUNDING: f32 = 1e-3;

fn is_the_same_path(a: &Contribution, b: &Contribution) -> bool {
    let largest = a.radiance.max_element().max(b.radiance.max_element());
    a.rays == b.rays && (a.radiance - b.radiance).abs().max_element() <= ROUNDING * largest
}

#[test]
fn contributions_are_the_megakernels_but_for_rounding() {
    with_gpu(|gpu| {
        let (mut identical, mut slots) = (0, 0);
        for case in cases(1500) {
            let expected = case.megakernel(gpu, case.all());
            let rays: u32 = expected.iter().map(|c| c.rays).sum();
            for (kind, pool) in OTHERS.into_iter().flat_map(|kind| [(kind, 100), (kind, 1500)]) {
                let what = format!("{kind:?}, pool of {pool}, {}", case.name);
                let integrator = integrator(gpu, kind, 1500, pool);
                let found = case.trace(gpu, integrator.as_ref(), case.all()).0;
                let pairs = || found.iter().zip(&expected);
                let same_bits = pairs()
                    .filter(|(a, b)| bytemuck::bytes_of(*a) == bytemuck::bytes_of(*b))
                    .count();
                identical += same_bits;
                slots += found.len();
                if gpu.name().contains("llvmpipe") {
                    // It fuses nothing, so every kernel rounds alike.
                    assert_eq!(same_bits, found.len(), "{what}");
                }
                let others = pairs().filter(|(a, b)| !is_the_same_path(a, b)).count();
                assert!(
                    others as f64 <= TURNED * f64::from(rays),
                    "{what}: {others} other paths, {rays} rays"
                );
                assert_no_bias(&found, &expected, &what);
            }
        }
        let share = 100.0 * identical as f64 / slots as f64;
        let _ = writeln!(
            std::io::stderr(),
            "{}: {share:.3} % of {slots} contributions identical",
            gpu.name()
        );
    });
}

/// The differences have mean 0: by a z-test of a component, with a false alarm in 1 of 10^6 cases.
fn assert_no_bias(found: &[Contribution], expected: &[Contribution], what: &str) {
    let limit = normal_quantile(1.0 - 0.5e-6);
    for channel in 0..3 {
        let pairs = || found.iter().zip(expected);
        let differences = || {
            pairs().map(|(a, b)| f64::from(a.radiance[channel]) - f64::from(b.radiance[channel]))
        };
        let sum: f64 = differences().sum();
        let error = differences().map(|d| d * d).sum::<f64>().sqrt();
        let total: f64 = expected.iter().map(|c| f64::from(c.radiance[channel])).sum();
        assert!(
            sum.abs() <= limit * error + 1e-5 * total,
            "{what}: channel {channel} differs by {sum} of {total}"
        );
    }
}

/// The test above can fail: paths of another seed are other paths, and a thousandth more light is a
/// bias.
#[test]
fn other_paths_are_noticed() {
    let case = cases(600).swap_remove(0);
    let expected = case.megakernel(&raystream::exec::cpu::CpuExecutor, case.all());
    let case = cases(600).swap_remove(0);
    let other = case.with(|settings| settings.seed = 2);
    let found = other.megakernel(&raystream::exec::cpu::CpuExecutor, other.all());
    let others = found.iter().zip(&expected).filter(|(a, b)| !is_the_same_path(a, b)).count();
    assert!(others > 500, "{others}");
    let brighter: Vec<_> =
        expected.iter().map(|c| Contribution { radiance: c.radiance * 1.001, ..*c }).collect();
    let noticed = std::panic::catch_unwind(|| assert_no_bias(&brighter, &expected, "brighter"));
    assert!(noticed.is_err());
}
