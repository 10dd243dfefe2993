//! Streams that are traced by one integrator alone, without a renderer.

use bytemuck::Zeroable;
use glam::Vec3;
use raystream::exec::{Array, Executor};
use raystream::render::integrator::megakernel::Megakernel;
use raystream::render::integrator::regeneration::Regeneration;
use raystream::render::integrator::wavefront::Wavefront;
use raystream::render::integrator::{Integrator, StreamBuffers};
use raystream::render::{IntegratorKind, PreparedScene, Settings};
use raystream::scene::{FilmSize, Material, Opacity, Principled, Scene};
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::{NO_PIXEL, Slot};
use raystream_shaders::math::random::hash;
use raystream_shaders::scene::abilities::ALL;
use raystream_tests::{cameras, prepare, scenes, settings};
use std::ops::Range;

pub const OTHERS: [IntegratorKind; 3] =
    [IntegratorKind::Compaction, IntegratorKind::Regeneration, IntegratorKind::Streaming];

/// A scene and a stream of slots of its picture.
pub struct Case {
    pub name: String,
    pub scene: PreparedScene,
    pub settings: Settings,
    pub slots: Vec<Slot>,
}

impl Case {
    /// `count` slots: each pixel in runs of three samples, as an allocator makes them.
    pub fn new(name: &str, scene: Scene, count: u32) -> Self {
        let pixels = scene.film.width * scene.film.height;
        let slots = (0..count)
            .map(|k| Slot { rank: k / 3 % pixels, sample: k % 3 + k / 3 / pixels * 3 })
            .collect();
        Self { name: name.to_owned(), scene: prepare(&scene), settings: settings(&scene), slots }
    }

    /// Pixels in any order, and about a fifth of the slots empty, single ones as well as stretches.
    pub fn scrambled(mut self) -> Self {
        let pixels = self.settings.size.width * self.settings.size.height;
        for (k, slot) in (0..).zip(&mut self.slots) {
            let is_empty = hash(k).is_multiple_of(10) || hash(k / 100).is_multiple_of(8);
            *slot = Slot {
                rank: if is_empty { NO_PIXEL } else { hash(k ^ 77) % pixels },
                sample: hash(k) % 64,
            };
        }
        self.name += ", scrambled";
        self
    }

    pub fn with(mut self, change: impl FnOnce(&mut Settings)) -> Self {
        change(&mut self.settings);
        self.name += &format!(
            ", max_depth {}, roulette from {}",
            self.settings.max_depth, self.settings.roulette_depth
        );
        self
    }

    /// As kernels with these abilities see it.
    pub fn compiled_for(mut self, abilities: u32) -> Self {
        self.scene.abilities = abilities;
        self
    }

    /// The contributions of `part` as the integrator finds them, and the paths under way in its
    /// iterations.
    pub fn trace<E: Executor>(
        &self,
        executor: &E,
        integrator: &dyn Integrator<E>,
        part: Range<u32>,
    ) -> (Vec<Contribution>, Vec<u32>) {
        let scene = self.scene.buffers(executor).unwrap();
        let slots = Array::from_slice(executor, "slots", &self.slots).unwrap();
        // Old contributions are lying about.
        let old = Contribution { rays: 77, ..Contribution::zeroed() };
        let contributions =
            Array::from_slice(executor, "contributions", &vec![old; self.slots.len()]).unwrap();
        let parameters = self.scene.parameters(&self.settings);
        let stream = StreamBuffers {
            scene: &scene,
            parameters: &parameters,
            slots: &slots,
            contributions: &contributions,
        };
        executor.run(&integrator.begin_round(&stream, 0)).unwrap();
        executor.run(&integrator.trace(&stream, part.clone())).unwrap();
        let all = contributions.read(executor).unwrap();
        let (inside, outside): (Vec<_>, Vec<_>) =
            (0..).zip(all).partition(|(slot, _)| part.contains(slot));
        assert!(
            outside.iter().all(|(_, c)| *c == old),
            "{}: a slot beyond {part:?} was written",
            self.name
        );
        let active = integrator.active_paths(executor, &stream, part).unwrap();
        (inside.into_iter().map(|(_, contribution)| contribution).collect(), active)
    }

    /// What the megakernel makes of `part`.
    pub fn megakernel<E: Executor>(&self, executor: &E, part: Range<u32>) -> Vec<Contribution> {
        self.trace(executor, &Megakernel, part).0
    }

    pub fn all(&self) -> Range<u32> {
        0..self.slots.len() as u32
    }
}

/// An integrator whose pool, where it has one, holds `pool` paths.
pub fn integrator<E: Executor>(
    executor: &E,
    kind: IntegratorKind,
    stream: u32,
    pool: u32,
) -> Box<dyn Integrator<E>> {
    match kind {
        IntegratorKind::Lvc => unreachable!("it walks other paths"),
        IntegratorKind::Auto | IntegratorKind::Megakernel => Box::new(Megakernel),
        IntegratorKind::Regeneration => Box::new(Regeneration::new(executor).unwrap()),
        IntegratorKind::Compaction => {
            Box::new(Wavefront::of_capacity(executor, ALL, stream, pool, false).unwrap())
        }
        IntegratorKind::Streaming => {
            Box::new(Wavefront::of_capacity(executor, ALL, stream, pool, true).unwrap())
        }
    }
}

/// A room, open to a bright sky at one place, with a ball of glass, all of whose materials reflect
/// less than they are lit by.
pub fn cases(count: u32) -> Vec<Case> {
    let cameras = cameras::seen_by_others(&scenes::room(scenes::glass(1.5), 1.0));
    let by_cameras = cameras.into_iter().map(|(name, scene)| Case::new(name, small(scene), count));
    of_materials(count).into_iter().chain(of_lights(count)).chain(by_cameras).collect()
}

fn small(mut scene: Scene) -> Scene {
    scene.film = FilmSize { width: 19, height: 13 };
    scene
}

fn of_materials(count: u32) -> Vec<Case> {
    let room = |ball| small(scenes::room(ball, 1.0));
    let ghost = Principled {
        coat: 0.6,
        sheen: Vec3::splat(0.5),
        opacity: Opacity::Blend { alpha: 0.7 },
        ..Principled::paint(Vec3::splat(0.8), 0.4)
    };
    vec![
        Case::new("half a ball of coated velvet", room(Material::Principled(ghost)), count),
        Case::new("a ball of glass", room(scenes::glass(1.5)), count),
        Case::new("a ball of glass", room(scenes::glass(1.5)), count).scrambled(),
        Case::new("a mirror ball", room(scenes::mirror(0.9)), count).with(|s| s.roulette_depth = 1),
        Case::new("a mirror ball", room(scenes::mirror(1.0)), count)
            .with(|s| (s.max_depth, s.roulette_depth) = (40, 99)),
        Case::new(
            "a rough metal ball",
            room(Material::Principled(Principled::metal(Vec3::splat(0.9), 0.3))),
            count,
        ),
        Case::new(
            "a ball of rough glass",
            room(Material::Principled(Principled::glass(1.5, 0.3))),
            count,
        )
        .scrambled(),
        Case::new("a drink", small(scenes::drink()), count)
            .with(|s| (s.max_depth, s.roulette_depth) = (12, 5))
            .scrambled(),
        Case::new("instances of glass", small(scenes::instanced(scenes::glass(1.5))), count),
        Case::new("a painted ball", small(scenes::painted()), count).scrambled(),
        Case::new("a glowing ball", room(scenes::emissive(3.0, 0.5)), count)
            .with(|s| s.max_depth = 1),
        Case::new("a black ball", room(scenes::diffuse(0.0)), count).with(|s| s.max_depth = 2),
    ]
}

fn of_lights(count: u32) -> Vec<Case> {
    let mut open = scenes::empty(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO);
    let ball = open.add_material(scenes::diffuse(0.9));
    scenes::add_ball(&mut open, Vec3::ZERO, 1.0, 2, ball);
    open.background = Vec3::splat(0.7);
    let glass = || scenes::glass(1.5);
    vec![
        Case::new("a ball without a light", open, count).scrambled(),
        Case::new("a room under a sky", small(scenes::roofless(glass())), count).scrambled(),
        Case::new("lights without surfaces", small(scenes::punctual(glass())), count),
        Case::new("a lamp that is a picture", small(scenes::picture_lamp(glass())), count),
        Case::new("many lamps under a sky", small(scenes::many_lamps(glass(), 80)), count),
    ]
}
