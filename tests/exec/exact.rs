//! Exact devices compute what the CPU does: every launch of whole renders, byte for byte.

use raystream::exec::arithmetic::Arithmetic;
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::devices::OpenOptions;
use raystream::exec::gpu::GpuExecutor;
use raystream::exec::{Device, Paired};
use raystream::render::{Estimator, FilterKind, IntegratorKind, Sampling, Settings};
use raystream::scene::{FilmSize, load_named};
use raystream_shaders::math::exact::Operands;
use raystream_shaders::math::random::hash;
use raystream_tests::{prepare, render_on, with_exact_gpu, with_gpu};

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

#[test]
fn whole_renders_are_the_cpus() {
    let scene = load_named("cornell_ball").unwrap();
    let prepared = prepare(&scene);
    let size = FilmSize { width: 24, height: 18 };
    let base = Settings { size, ..Settings::for_scene(&scene) };
    with_exact_gpu(|gpu| {
        let integrators = IntegratorKind::ALL.iter();
        let integrators = integrators
            .map(|&integrator| (format!("{integrator:?}"), Settings { integrator, ..base }));
        // Other filters as estimators launch what they launch as filters, below, and then the same.
        let estimators =
            [Estimator::AxisAligned, Estimator::Halves, Estimator::Learned, Estimator::Variance];
        let estimators = estimators.map(|estimator| {
            let sampling = Sampling { estimator, ..base.sampling };
            (format!("{estimator:?}"), Settings { sampling, ..base })
        });
        // Another project's filter does not run in kernels.
        let kinds = FilterKind::ALL.iter().filter(|&&kind| kind != FilterKind::Oidn);
        let filters =
            kinds.map(|&kind| (format!("{kind:?}"), Settings { denoise: Some(kind), ..base }));
        for (what, settings) in integrators.chain(estimators).chain(filters) {
            assert_same(gpu, &what, |pair| drop(render_on(pair, &prepared, &settings, 4)));
        }
    });
}

#[test]
fn what_naga_translates_is_refused() {
    with_gpu(|_| {
        let options = OpenOptions::default().with_exact(true).with_naga(true);
        let error = Device::open_with("gpu", options).err().expect("naga fuses as it likes");
        assert!(error.to_string().contains("naga"), "{error}");
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

/// Far more operands than the check of a device has time for.
#[test]
fn functions_of_a_million_operands_are_the_cpus() {
    with_exact_gpu(|gpu| {
        for turn in 0..16 {
            let operands: Vec<_> = (0..1 << 16).map(|k| drawn(turn << 16 | k)).collect();
            Arithmetic::over(gpu, &operands).unwrap().check().unwrap();
        }
    });
}

/// Operands of all sizes, or such as renders have: from 2^-32 to 2^32.
fn drawn(k: u32) -> Operands {
    let usual = |bits: u32| (bits & 0x9fff_ffff) + 0x3000_0000;
    let [a, b, c] = [0, 1, 2].map(|j| hash(3 * k + j));
    let [a, b, c] = if k.is_multiple_of(4) { [a, b, c] } else { [a, b, c].map(usual) };
    Operands { a, b, c, pad: 0 }
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
