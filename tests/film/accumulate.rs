//! What comes of the film on the GPU and on the CPU, bit for bit.

use bytemuck::Zeroable;
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::{Array, Executor, kernels};
use raystream_shaders::film::accumulate::CountParams;
use raystream_shaders::film::sums::PixelSums;
use raystream_shaders::math::random::hash;
use raystream_tests::with_gpu;

fn count_rays<E: Executor>(executor: &E, film: &[PixelSums]) -> Vec<u32> {
    let parameters =
        CountParams { threads: 64, pixels: film.len() as u32, ..CountParams::zeroed() };
    let film = Array::from_slice(executor, "film", film).unwrap();
    let counts = Array::zeroed(executor, "ray counts", 64).unwrap();
    executor.run(&[kernels::count_rays(&parameters, film.view(), counts.view())]).unwrap();
    counts.read(executor).unwrap()
}

#[test]
fn ray_counts_are_equal() {
    let film: Vec<PixelSums> =
        (0..500_u32).map(|k| PixelSums { rays: hash(k) >> 12, ..PixelSums::zeroed() }).collect();
    let cpu = count_rays(&CpuExecutor, &film);
    assert_eq!(cpu.iter().sum::<u32>(), film.iter().map(|p| p.rays).sum::<u32>());
    with_gpu(|gpu| assert_eq!(count_rays(gpu, &film), cpu));
}
