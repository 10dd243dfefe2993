//! Builds the tree that chooses lights, see [`raystream_shaders::scene::light::tree`].

use glam::{DVec3, UVec4, Vec3};
use raystream_shaders::math::packed::Tangent;
use raystream_shaders::scene::light::tree::{Cluster, EVERYWHERE, LEAF, MAX_DEPTH};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The parts of an axis between which clusters are divided.
const BINS: usize = 12;
/// Packing an axis turns it by less, in radians.
const PACKING: f64 = 3e-4;
/// The least intensity, as a share of all: with less, numbers would be denormal.
const FAINTEST: f64 = 1e-25;

/// A light, or a cluster of some, as the tree sees it.
#[derive(Clone, Copy)]
pub struct Source {
    /// A box around it, in world units.
    pub low: DVec3,
    /// The other corner of the box.
    pub high: DVec3,
    /// Unit vector in the middle of what it faces.
    pub axis: DVec3,
    /// How far from `axis` it may face, in radians, up to pi.
    pub spread: f64,
    /// See [`Cluster::intensity`]; in any unit.
    pub intensity: f64,
}

/// The tree of the lights of a scene.
pub struct LightTree {
    /// The way to each light.
    trails: Vec<u32>,
    /// Pairs of clusters.
    clusters: Vec<Cluster>,
}

/// A light under way to its leaf.
#[derive(Clone, Copy)]
struct Item {
    source: Source,
    light: u32,
}

/// Where a cluster is to lie.
#[derive(Clone, Copy)]
struct Way {
    depth: u32,
    trail: u32,
}

impl LightTree {
    /// The tree of lights that are somewhere, `near`, and of those at infinity, `distant`: each
    /// with its number, the latter with their weights. `near_weight` is that of all that are near.
    /// None if there are fewer than two.
    pub fn new(near: &[(u32, Source)], near_weight: f64, distant: &[(u32, f64)]) -> Option<Self> {
        let lights = near.len() + distant.len();
        if lights < 2 {
            return None;
        }
        let mut tree = Self { trails: vec![0; lights], clusters: Vec::new() };
        let all: f64 = near.iter().map(|(_, source)| source.intensity).sum();
        let mut items: Vec<Item> = near
            .iter()
            .map(|&(light, source)| {
                let intensity = (source.intensity / all).max(FAINTEST);
                Item { source: Source { intensity, ..source }, light }
            })
            .collect();
        let whole = near_weight + distant.iter().map(|(_, weight)| weight).sum::<f64>();
        let distant: Vec<(u32, f64)> = distant
            .iter()
            .map(|&(light, weight)| (light, (weight / whole).max(FAINTEST)))
            .collect();
        let root = Way { depth: 0, trail: 0 };
        match (items.is_empty(), distant.is_empty()) {
            (false, true) => _ = tree.near(&mut items, root),
            (true, _) => _ = tree.distant(&distant, root),
            (false, false) => {
                let pair = tree.reserve();
                let intensity = near_weight / whole;
                let cluster = tree.near(&mut items, root.first());
                tree.clusters[pair] = everywhere(intensity, cluster.link);
                tree.clusters[pair + 1] = tree.distant(&distant, root.second());
            }
        }
        Some(tree)
    }

    /// The rows of the buffer.
    pub fn rows(&self) -> Vec<UVec4> {
        let mut rows = super::rows_of(&self.trails);
        rows.extend(bytemuck::pod_collect_to_vec::<Cluster, UVec4>(&self.clusters));
        rows
    }

    fn reserve(&mut self) -> usize {
        let pair = self.clusters.len();
        self.clusters.extend([Cluster::default(); 2]);
        pair
    }

    /// The cluster of `items`, of which there are some: at most 2 to the power of what is left of
    /// [`MAX_DEPTH`].
    fn near(&mut self, items: &mut [Item], way: Way) -> Cluster {
        let link = match items {
            [one] => {
                self.trails[one.light as usize] = way.trail;
                LEAF | one.light
            }
            _ => {
                let pair = self.reserve();
                let first = divide(items, MAX_DEPTH - way.depth);
                let (left, right) = items.split_at_mut(first);
                self.clusters[pair] = self.near(left, way.first());
                self.clusters[pair + 1] = self.near(right, way.second());
                pair as u32
            }
        };
        cluster(items, link)
    }

    /// The cluster of lights that are chosen by their weights alone.
    fn distant(&mut self, lights: &[(u32, f64)], way: Way) -> Cluster {
        let weight = lights.iter().map(|(_, weight)| weight).sum();
        if let [(light, _)] = *lights {
            self.trails[light as usize] = way.trail;
            return everywhere(weight, LEAF | light);
        }
        let pair = self.reserve();
        let (left, right) = lights.split_at(lights.len() / 2);
        self.clusters[pair] = self.distant(left, way.first());
        self.clusters[pair + 1] = self.distant(right, way.second());
        everywhere(weight, pair as u32)
    }
}

impl Way {
    fn first(self) -> Self {
        Self { depth: self.depth + 1, ..self }
    }

    fn second(self) -> Self {
        Self { trail: self.trail | 1 << self.depth, ..self.first() }
    }
}

impl Source {
    /// What nothing is.
    const NONE: Self =
        Self { low: DVec3::ZERO, high: DVec3::ZERO, axis: DVec3::Z, spread: 0.0, intensity: 0.0 };

    fn middle(&self) -> DVec3 {
        0.5 * (self.low + self.high)
    }

    /// What holds both.
    fn with(self, other: &Self) -> Self {
        let (axis, spread) = cone((self.axis, self.spread), (other.axis, other.spread));
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            axis,
            spread,
            intensity: self.intensity + other.intensity,
        }
    }

    /// What a cluster costs in the heuristic of Conty Estevez and Kulla: intensity, times the area
    /// of the box, times an integral over the directions in which it shines.
    fn cost(&self) -> f64 {
        let size = self.high - self.low;
        let area = size.x * size.y + size.y * size.z + size.z * size.x;
        let end = (self.spread + FRAC_PI_2).min(PI);
        let (sine, cosine) = self.spread.sin_cos();
        let around = 2.0 * end * sine - (self.spread - 2.0 * end).cos() - 2.0 * self.spread * sine;
        self.intensity * area * (TAU * (1.0 - cosine) + FRAC_PI_2 * (around + cosine))
    }
}

/// A cone, by its axis and half its angle, around two.
fn cone(a: (DVec3, f64), b: (DVec3, f64)) -> (DVec3, f64) {
    let (wide, narrow) = if a.1 >= b.1 { (a, b) } else { (b, a) };
    let between = wide.0.angle_between(narrow.0);
    if (between + narrow.1).min(PI) <= wide.1 {
        return wide;
    }
    let spread = 0.5 * (wide.1 + between + narrow.1);
    let across = wide.0.cross(narrow.0).try_normalize();
    match across {
        Some(across) if spread < PI => {
            let axis =
                DVec3::normalize(glam::DQuat::from_axis_angle(across, spread - wide.1) * wide.0);
            (axis, spread)
        }
        _ => (wide.0, PI),
    }
}

fn everywhere(intensity: f64, link: u32) -> Cluster {
    Cluster { radius: EVERYWHERE, intensity: intensity as f32, link, ..Cluster::default() }
}

/// The cluster of `items`, of which there are some.
fn cluster(items: &[Item], link: u32) -> Cluster {
    let whole = union(items);
    let centre = whole.middle().as_vec3();
    // Half the box at most, but less where a ball is enough for each of them.
    let reach = |item: &Item| {
        let from = (item.source.low - centre.as_dvec3()).abs();
        from.max((item.source.high - centre.as_dvec3()).abs()).length()
    };
    let radius = items.iter().map(reach).fold(0.0, f64::max);
    let spread = (whole.spread + PACKING).min(PI);
    Cluster {
        centre,
        radius: (radius as f32).next_up(),
        intensity: whole.intensity as f32,
        axis: Tangent { direction: whole.axis.as_vec3(), is_mirrored: false }.pack(),
        spread: spread.cos() as f32,
        link,
    }
}

fn union(items: &[Item]) -> Source {
    let sources = items.iter().map(|item| item.source);
    sources.reduce(|whole, source| whole.with(&source)).unwrap_or(Source::NONE)
}

/// Sorts `items`, of which there are two or more, into two parts; the number in the first.
/// Neither has more than a tree of `depth` less one has room for.
fn divide(items: &mut [Item], depth: u32) -> usize {
    let middles = items.iter().map(|item| item.source.middle());
    let (low, high) = middles
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), middle| {
            (low.min(middle), high.max(middle))
        });
    let extent = high - low;
    let is_deep = items.len() as u64 > 1 << (depth - 1);
    if extent.max_element() > 0.0 && !is_deep {
        let size = union(items);
        let size = size.high - size.low;
        let best = (0..3)
            .filter(|&axis| extent[axis] > 0.0)
            .map(|axis| {
                let (cost, bin) = best_bin(items, axis, low[axis], extent[axis]);
                // Long thin clusters are bad ones.
                (cost * size.max_element() / size[axis].max(f64::MIN_POSITIVE), bin, axis)
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, bin, axis)) = best {
            let is_first = |item: &Item| bin_of(item, axis, low[axis], extent[axis]) < bin;
            let (mut first, rest): (Vec<Item>, Vec<Item>) =
                items.iter().copied().partition(is_first);
            let count = first.len();
            first.extend(rest);
            items.copy_from_slice(&first);
            if count > 0 && count < items.len() {
                return count;
            }
        }
    }
    let axis = extent.max_position();
    let half = items.len() / 2;
    items.select_nth_unstable_by(half, |a, b| {
        let place = |item: &Item| item.source.middle()[axis];
        place(a).total_cmp(&place(b)).then(a.light.cmp(&b.light))
    });
    half
}

fn bin_of(item: &Item, axis: usize, low: f64, extent: f64) -> usize {
    (((item.source.middle()[axis] - low) / extent * BINS as f64) as usize).min(BINS - 1)
}

/// The least cost of the two parts before and from a bin on, and the number of that bin.
fn best_bin(items: &[Item], axis: usize, low: f64, extent: f64) -> (f64, usize) {
    let mut bins: [Option<Source>; BINS] = [None; BINS];
    let join = |whole: Option<Source>, part: Source| match whole {
        Some(whole) => Some(whole.with(&part)),
        None => Some(part),
    };
    for item in items {
        let bin = &mut bins[bin_of(item, axis, low, extent)];
        *bin = join(*bin, item.source);
    }
    let mut before = [0.0; BINS];
    let mut whole = None;
    for (bin, found) in bins.iter().enumerate() {
        before[bin] = whole.map_or(0.0, |whole: Source| whole.cost());
        whole = found.map_or(whole, |found| join(whole, found));
    }
    let mut best = (f64::INFINITY, BINS / 2);
    let mut whole = None;
    for bin in (1..BINS).rev() {
        whole = bins[bin].map_or(whole, |found| join(whole, found));
        let cost = before[bin] + whole.map_or(0.0, |whole: Source| whole.cost());
        if cost < best.0 {
            best = (cost, bin);
        }
    }
    best
}

/// The box of some points.
pub fn boxed(points: &[Vec3]) -> (DVec3, DVec3) {
    points
        .iter()
        .map(|point| point.as_dvec3())
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), point| {
            (low.min(point), high.max(point))
        })
}
