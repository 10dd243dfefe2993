//! The light vertex cache: the same vertices, in the order of their paths, on every device, bit for
//! bit.

use bytemuck::Zeroable;
use glam::{UVec4, Vec3};
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::{Array, Executor, kernels};
use raystream::render::integrator::lvc::gather;
use raystream_shaders::integrator::lvc::LvcParams;
use raystream_shaders::integrator::lvc::cache::{HEADER_ROWS, LightCache};
use raystream_shaders::integrator::lvc::light_vertex::{LightVertex, ROWS_PER_VERTEX};
use raystream_shaders::math::random::hash;
use raystream_shaders::parallel::prefix::BlockParams;
use raystream_shaders::scene::media::Media;
use raystream_tests::{prepare, scenes, settings, with_gpu};

/// Light paths as they lie in scratch memory.
struct Paths {
    counts: Vec<u32>,
    vertices_per_path: u32,
    scratch: Vec<UVec4>,
}

impl Paths {
    /// Of random numbers, from none to all that fit in each path.
    fn random(paths: u32, vertices_per_path: u32, seed: u32) -> Self {
        let rows = paths * vertices_per_path * ROWS_PER_VERTEX;
        Self {
            counts: (0..paths).map(|path| hash(path ^ seed) % (vertices_per_path + 1)).collect(),
            vertices_per_path,
            scratch: (0..rows)
                .map(|row| UVec4::new(row, hash(row), hash(row ^ seed), !row))
                .collect(),
        }
    }

    /// The cache by a sequential copy.
    fn expected(&self) -> Vec<UVec4> {
        let total: u32 = self.counts.iter().sum();
        let mut cache = vec![UVec4::new(total, 0, 0, 0)];
        for (path, &count) in self.counts.iter().enumerate() {
            let first = path * (self.vertices_per_path * ROWS_PER_VERTEX) as usize;
            cache.extend(&self.scratch[first..][..(count * ROWS_PER_VERTEX) as usize]);
        }
        cache
    }

    /// The cache by the kernels.
    fn gathered<E: Executor>(&self, executor: &E) -> Vec<UVec4> {
        let paths = self.counts.len() as u32;
        let counts = Array::from_slice(executor, "counts", &self.counts).unwrap();
        let blocks = BlockParams::per_block(paths).blocks as usize;
        let offsets = Array::zeroed(executor, "offsets", blocks + 1).unwrap();
        let scratch = Array::from_slice(executor, "scratch", &self.scratch).unwrap();
        let cache =
            Array::zeroed(executor, "cache", HEADER_ROWS as usize + self.scratch.len()).unwrap();
        executor
            .run(&gather(paths, self.vertices_per_path, &counts, &offsets, &scratch, &cache))
            .unwrap();
        let mut rows: Vec<UVec4> = cache.read(executor).unwrap();
        rows.truncate((HEADER_ROWS + rows[0].x * ROWS_PER_VERTEX) as usize);
        rows
    }
}

#[test]
fn the_cache_is_a_sequential_copy_on_every_device() {
    for (paths, vertices) in
        [(1, 1), (3, 0), (5, 6), (255, 2), (1023, 6), (1024, 6), (1025, 1), (5000, 3), (300_000, 1)]
    {
        let paths = Paths::random(paths, vertices.max(1), paths ^ vertices);
        let expected = paths.expected();
        assert!(
            paths.gathered(&CpuExecutor) == expected,
            "{} paths on the CPU",
            paths.counts.len()
        );
        with_gpu(|gpu| {
            assert!(paths.gathered(gpu) == expected, "{} paths on the GPU", paths.counts.len());
        });
    }
}

/// Light paths that one device has traced make the same cache on the other.
#[test]
fn traced_paths_make_the_same_cache_on_every_device() {
    let scene = scenes::room(scenes::glass(1.5), 1.0);
    let prepared = prepare(&scene);
    let (paths, segments) = (3000, 6);
    let parameters = LvcParams {
        threads: paths,
        light_segments: segments,
        vertices_per_path: segments,
        emission_samples: 1.0,
        light_samples: 1.0,
        connection_samples: 0.5,
        path: prepared.parameters(&settings(&scene)),
        ..LvcParams::zeroed()
    };
    let buffers = prepared.buffers(&CpuExecutor).unwrap();
    let counts = Array::zeroed(&CpuExecutor, "counts", paths as usize).unwrap();
    let scratch =
        Array::zeroed(&CpuExecutor, "scratch", (paths * segments * ROWS_PER_VERTEX) as usize)
            .unwrap();
    CpuExecutor
        .run(&[kernels::trace_light_paths(&parameters, &buffers, counts.view(), scratch.view())])
        .unwrap();
    let traced = Paths {
        counts: counts.read(&CpuExecutor).unwrap(),
        vertices_per_path: segments,
        scratch: scratch.read(&CpuExecutor).unwrap(),
    };
    let cache = traced.gathered(&CpuExecutor);
    assert!(cache == traced.expected());
    with_gpu(|gpu| assert!(traced.gathered(gpu) == cache));

    let cache = LightCache::new(&cache);
    assert!(cache.len() > paths, "the room is closed: {} vertices", cache.len());
    for index in 0..cache.len() {
        let vertex = cache.get(index);
        assert!((1..=segments).contains(&vertex.segments));
        assert!(vertex.flux.is_finite() && vertex.flux.min_element() >= 0.0, "{vertex:?}");
        assert!(vertex.norm.is_finite() && vertex.norm > 0.0, "{vertex:?}");
        assert!(
            (vertex.normal.length() - 1.0).abs() < 1e-5
                && (vertex.geometric.length() - 1.0).abs() < 1e-5
        );
    }
    let mut drawn = vec![0_u32; cache.len() as usize];
    let places: Vec<[u32; 3]> =
        (0..cache.len()).map(|i| cache.get(i).position.to_array().map(f32::to_bits)).collect();
    // Equally spaced numbers draw every vertex, the first and the last too.
    for k in 0..cache.len() {
        let bits = ((u64::from(k) << 32) / u64::from(cache.len())) as u32 + 1;
        drawn[places
            .iter()
            .position(|p| *p == cache.draw(bits).position.to_array().map(f32::to_bits))
            .unwrap()] += 1;
    }
    assert!(drawn.iter().all(|&times| times == 1), "each vertex is drawn once");
}

#[test]
fn a_vertex_survives_its_rows() {
    let vertex = LightVertex {
        media: Media(0x0403),
        position: Vec3::new(1.0, -2.0, 3.5),
        geometric: Vec3::X,
        norm: 1e-30,
        normal: Vec3::NEG_Y,
        segments: 3,
        flux: Vec3::new(0.1, 0.0, 1e9),
        instance: 7,
    };
    assert_eq!(LightVertex::from_rows(vertex.to_rows()), vertex);
}
