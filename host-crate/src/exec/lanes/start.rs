//! Paths at the camera, `N` at once.

use super::numbers::{Floats, Words, floats};
use super::random::Sequences;
use super::scene::Scene;
use super::vectors::Vectors;
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::{NO_PIXEL, Slot};
use raystream_shaders::film::tiles::pixel_of_rank;
use raystream_shaders::math::random::PIXEL;

/// Paths that have not begun: those of the next slots of a stretch, of which some are made ready at
/// once.
pub struct Starts<'a, const N: usize> {
    slots: &'a [Slot],
    next: usize,
    ready: usize,
    /// Of those that are ready: their slots,
    numbers: [usize; N],
    /// the directions of their camera rays,
    directions: Vectors<N>,
    /// and their random numbers.
    sequences: Sequences<N>,
}

/// A path that begins.
pub struct Start {
    /// The number of its slot.
    pub slot: usize,
    /// The direction of its camera ray.
    pub direction: glam::Vec3,
    /// Its random numbers: what [`Sequences`] has of it.
    pub sequence: [u32; 2],
}

impl<'a, const N: usize> Starts<'a, N> {
    /// Those of all `slots`.
    #[inline(always)]
    pub fn new(slots: &'a [Slot]) -> Self {
        let zero = Words::splat(0);
        Self {
            slots,
            next: 0,
            ready: 0,
            numbers: [0; N],
            directions: Vectors::splat(glam::Vec3::ZERO),
            sequences: Sequences { seeds: zero, reversed_indices: zero },
        }
    }

    /// The next one, if there is any. Contributions of empty slots before it become nothing.
    #[inline(always)]
    pub fn next(&mut self, scene: &Scene<'_>, contributions: &mut [Contribution]) -> Option<Start> {
        if self.ready == 0 {
            self.make_ready(scene, contributions);
        }
        let lane = self.ready.checked_sub(1)?;
        self.ready = lane;
        let Sequences { seeds, reversed_indices } = &self.sequences;
        Some(Start {
            slot: self.numbers[lane],
            direction: self.directions.get(lane),
            sequence: [seeds.0[lane], reversed_indices.0[lane]],
        })
    }

    #[inline(always)]
    fn make_ready(&mut self, scene: &Scene<'_>, contributions: &mut [Contribution]) {
        let camera = &scene.params.camera;
        let [mut columns, mut rows, mut samples] = [[0; N]; 3];
        while self.ready < N && self.next < self.slots.len() {
            let Slot { rank, sample } = self.slots[self.next];
            if rank == NO_PIXEL {
                contributions[self.next] = Contribution::NOTHING;
            } else {
                let lane = self.ready;
                (columns[lane], rows[lane]) = pixel_of_rank(rank, camera.width, camera.height);
                (self.numbers[lane], samples[lane]) = (self.next, sample);
                self.ready += 1;
            }
            self.next += 1;
        }
        let (columns, rows) = (Words(columns), Words(rows));
        let pixels = rows.times(Words::splat(camera.width)).plus(columns);
        self.sequences = Sequences::new(scene.params.seed, pixels, Words(samples));
        let [u, v] = self.sequences.pair(Words::splat(PIXEL));
        let place = |pixels: Words<N>, within: Floats<N>| {
            floats(|lane| pixels.0[lane] as i32 as f32) + within
        };
        let splat = Vectors::splat;
        let on_plane = splat(camera.top_left)
            + splat(camera.right) * place(columns, u)
            + splat(camera.down) * place(rows, v);
        self.directions = on_plane.normalize();
    }
}
