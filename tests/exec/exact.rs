//! Exact devices compute what the CPU does: every launch of whole renders, byte for byte.

use crate::integrator::tracing::cases;
use raystream::exec::arithmetic::Arithmetic;
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::gpu::GpuExecutor;
use raystream::exec::{Executor, Paired};
use raystream::render::{Estimator, FilterKind, IntegratorKind, Sampling, Settings};
use raystream::scene::FilmSize;
use raystream_tests::{prepare, render_on, scenes, settings, with_exact_gpu, with_gpu};

/// Runs a render on the CPU and on an exact device at once.
fn assert_same(
    gpu: &GpuExecutor,
    what: &str,
    run: impl FnOnce(&Paired<CpuExecutor, &GpuExecutor>),
) {
    let pair = Paired::new(CpuExecutor, gpu);
    run(&pair);
    assert!(pair.launches() > 0, "{what}");
    let partings: Vec<String> = pair.partings().iter().map(ToString::to_string).collect();
    assert!(partings.is_empty(), "{what}:\n{}", partings.join("\n"));
}

/// Software compiles a kernel in many seconds for each set of abilities, so there some must do.
fn is_software(gpu: &GpuExecutor) -> bool {
    gpu.name().contains("llvmpipe")
}

#[test]
fn contributions_are_the_cpus() {
    with_exact_gpu(|gpu| {
        let step = if is_software(gpu) { 9 } else { 1 };
        for case in cases(400).into_iter().step_by(step) {
            assert_same(gpu, &case.name, |pair| drop(case.megakernel(pair, case.all())));
        }
    });
}

/// Filters whose network parts in the last place: docs/EXACT.md has what is left.
const LEARNED: [FilterKind; 2] = [FilterKind::Auto, FilterKind::Learned];

#[test]
fn whole_renders_are_the_cpus() {
    let scene = scenes::room(scenes::mirror(0.9), 1.0);
    let prepared = prepare(&scene);
    let base = Settings { size: FilmSize { width: 16, height: 12 }, ..settings(&scene) };
    let adaptive = |estimator| Sampling { estimator, ..Sampling::ADAPTIVE };
    with_exact_gpu(|gpu| {
        let integrators = IntegratorKind::ALL.iter().map(|&integrator| {
            let sampling = adaptive(Estimator::Bilateral);
            (format!("{integrator:?}"), Settings { integrator, sampling, ..base })
        });
        let estimators = [Estimator::Halves, Estimator::Variance].map(|estimator| {
            (format!("{estimator:?}"), Settings { sampling: adaptive(estimator), ..base })
        });
        let kinds = FilterKind::ALL.iter().filter(|kind| !LEARNED.contains(kind));
        let filters =
            kinds.map(|&kind| (format!("{kind:?}"), Settings { denoise: Some(kind), ..base }));
        for (what, settings) in integrators.chain(estimators).chain(filters) {
            assert_same(gpu, &what, |pair| drop(render_on(pair, &prepared, &settings, 6)));
        }
    });
}

/// What the check of a device finds: the fast module, whose functions are the driver's.
#[test]
fn a_device_with_functions_of_its_own_is_noticed() {
    with_gpu(|gpu| {
        let arithmetic = Arithmetic::of(gpu).unwrap();
        assert!(arithmetic.check().unwrap_err().contains("does not compute what the CPU does"));
    });
    with_exact_gpu(|gpu| Arithmetic::of(gpu).unwrap().check().unwrap());
}

/// A pair that differs says where, and goes on from the same start.
#[test]
fn a_parting_names_the_kernel_and_the_lane() {
    with_gpu(|gpu| {
        let pair = Paired::new(CpuExecutor, gpu);
        let arithmetic = Arithmetic::of(&pair).unwrap();
        // The pair has what the CPU computed.
        arithmetic.check().unwrap();
        let [parting] = <[_; 1]>::try_from(pair.partings()).unwrap();
        assert_eq!((parting.kernel, parting.launch, parting.launches), ("calculate", 1, 1));
        let [difference] = <[_; 1]>::try_from(parting.differences.clone()).unwrap();
        assert!(difference.is_lane && difference.binding == "results");
        assert_ne!(difference.after[0], difference.after[1]);
        assert!(parting.read.iter().any(|(name, text)| *name == "operands" && text.contains('[')));
        assert!(parting.to_string().contains("part in kernel calculate, launch 1"));
        Arithmetic::of(&pair).unwrap();
        assert_eq!(pair.partings()[0].launches, 2);
    });
}
