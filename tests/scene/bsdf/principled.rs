//! The principled material: what it samples, the energy that it keeps, and both directions alike.

use super::specular::reflectance;
use glam::{DVec3, Vec2, Vec3};
use raystream::render::BvhQuality;
use raystream::render::PreparedScene;
use raystream::scene::{Anisotropy, Camera, FilmSize, Material, Mesh, Metal, Principled, Scene};
use raystream_shaders::math::random::{BSDF, CHOICES, RandomNumbers, SOBOL, unit_float};
use raystream_shaders::scene::abilities::{ALL, Fixed};
use raystream_shaders::scene::bsdf::{Bsdf, BsdfSample};
use raystream_shaders::scene::media::{Media, Sides};
use raystream_shaders::scene::ray::Ray;
use raystream_shaders::scene::surface::Surface;
use raystream_tests::histogram::{SAMPLERS, cell, histogram};
use raystream_tests::statistics::{assert_chi_square, mean_and_error};
use std::f64::consts::TAU;

const COUNT: u32 = 1 << 16;
/// Cells along the cosine, over the whole sphere, and around the normal.
const COSINES: usize = 24;
const AZIMUTHS: usize = 24;
/// Points along a cell's sides where its probability is integrated.
const POINTS: usize = 40;
/// From nearly straight to grazing, in degrees.
pub const ANGLES: [f32; 4] = [2.0, 35.0, 60.0, 85.0];

/// A floor of one material, whose normal is +z.
pub fn floor(material: Principled) -> PreparedScene {
    let camera = Camera::new(Vec3::Z, Vec3::ZERO, 40.0);
    let mut scene = Scene::new(camera, FilmSize { width: 4, height: 3 });
    // A material that is none of its kind comes first, so that tables are not read at their start.
    scene.add_material(Material::diffuse(Vec3::splat(0.5)));
    let material = scene.add_material(Material::Principled(material));
    let corners = [(-9.0, -9.0), (9.0, -9.0), (0.0, 9.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
    let mut mesh = Mesh::new(material, corners.to_vec(), vec![[0, 1, 2]]);
    // The texture's `u` grows along (0.8, 0.6), for what has a grain.
    let (along, across) = (Vec3::new(0.8, 0.6, 0.0), Vec3::new(-0.6, 0.8, 0.0));
    let uv = |corner: Vec3| Vec2::new(corner.dot(along), corner.dot(across));
    mesh.texture_coordinates = Some(vec![corners.map(uv)]);
    scene.add_mesh(mesh);
    PreparedScene::new(&scene, BvhQuality::default()).expect("a floor")
}

/// The direction of a ray that arrives at so many `degrees` to +z, or to -z from below.
pub fn arriving(degrees: f32, is_above: bool) -> Vec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    Vec3::new(0.6 * sin, -0.8 * sin, if is_above { -cos } else { cos })
}

/// What a ray along `incoming` meets.
pub fn met<'a>(floor: &'a PreparedScene, incoming: Vec3) -> Bsdf<'a, Fixed<ALL>> {
    let view = floor.view();
    let ray = Ray::new(Vec3::new(0.1, 0.2, 0.0) - incoming, incoming);
    let hit = view.closest_hit(&ray);
    assert!(hit.is_some(), "along {incoming}");
    Surface::at(&view.surfaces, &ray, &hit, Sides::both(Media::NONE)).bsdf
}

/// Samples of the BSDF that `incoming` meets.
pub fn samples<'a>(
    bsdf: Bsdf<'a, Fixed<ALL>>,
    incoming: Vec3,
    kind: u32,
) -> impl Iterator<Item = BsdfSample> + use<'a> {
    (0..COUNT).map(move |index| {
        let numbers = RandomNumbers::new(kind, 7, 11, index);
        let [lobe, _] = numbers.bits(CHOICES);
        bsdf.sample(incoming, numbers.pair(BSDF), unit_float(lobe))
    })
}

/// Materials with every lobe of those that are the same in both directions, rough enough for cells
/// to see their shape.
fn rough_ones() -> Vec<(&'static str, Principled)> {
    let mut all = Vec::new();
    for roughness in [0.5, 0.75, 1.0] {
        let paint = Principled::paint(Vec3::new(0.7, 0.4, 0.2), roughness);
        all.push(("paint", paint));
        all.push(("dull paint", Principled { f90: 0.25, specular: Vec3::splat(0.5), ..paint }));
        all.push(("metal", Principled::metal(Vec3::new(1.0, 0.8, 0.3), roughness)));
        all.push(("gold", Principled::conductor(Metal::Gold.conductor(), roughness)));
        all.push(("glass", Principled::glass(1.5, roughness)));
        let glass = Principled::glass(1.5, roughness);
        all.push(("thin glass", Principled { thin_walled: true, ..glass }));
        all.push(("a mixture", Principled { metallic: 0.3, transmission: 0.6, ..paint }));
        let metal = Principled::metal(Vec3::new(1.0, 0.8, 0.3), roughness);
        all.push(("brushed metal", brushed(metal, 0.7, 20.0)));
        all.push(("brushed gold", brushed(all[all.len() - 5].1, 0.5, -70.0)));
        all.push(("brushed paint", brushed(paint, 0.9, 130.0)));
    }
    all
}

/// The same with a grain.
fn brushed(material: Principled, strength: f32, rotation: f32) -> Principled {
    Principled { anisotropy: Anisotropy { strength, rotation }, ..material }
}

/// Materials under a cover.
fn covered_ones() -> Vec<(&'static str, Principled)> {
    let paint = Principled::paint(Vec3::new(0.7, 0.4, 0.2), 0.6);
    let coated = Principled { coat: 0.8, coat_roughness: 0.5, ..paint };
    let velvet = Principled { sheen: Vec3::new(0.3, 0.9, 0.6), sheen_roughness: 0.4, ..paint };
    let glass = Principled { coat: 1.0, coat_roughness: 0.7, ..Principled::glass(1.5, 0.5) };
    vec![
        ("coated paint", coated),
        ("velvet", velvet),
        ("coated velvet", Principled { coat: 0.5, coat_roughness: 0.6, ..velvet }),
        ("coated glass", glass),
    ]
}

/// The cell of a direction over the sphere.
fn sphere_cell(direction: Vec3) -> usize {
    let d = direction.as_dvec3();
    let azimuth = d.y.atan2(d.x).rem_euclid(TAU);
    cell(0.5 * (d.z + 1.0), COSINES) * AZIMUTHS + cell(azimuth / TAU, AZIMUTHS)
}

/// How probable each cell is by the density, and, last, that there is no light.
fn probabilities(bsdf: &Bsdf<'_, Fixed<ALL>>, incoming: Vec3) -> Vec<f64> {
    let mut all = vec![0.0; COSINES * AZIMUTHS + 1];
    let fine = AZIMUTHS * POINTS;
    let end = |cosines: usize| (1.0 - 2.0 * cosines as f64 / COSINES as f64).acos();
    for (band, place) in (0..COSINES).flat_map(|band| (0..POINTS).map(move |place| (band, place))) {
        // In the angle, not in its cosine, which is steep at the poles.
        let (from, to) = (end(band), end(band + 1));
        let step = (to - from) / POINTS as f64;
        let (sin_theta, cos_theta) = (from + (place as f64 + 0.5) * step).sin_cos();
        for b in 0..fine {
            let (sin, cos) = ((b as f64 + 0.5) / fine as f64 * TAU).sin_cos();
            let direction = DVec3::new(sin_theta * cos, sin_theta * sin, cos_theta).as_vec3();
            let pdf = f64::from(bsdf.pdf(incoming, direction));
            let solid_angle = sin_theta * step * TAU / fine as f64;
            all[(COSINES - 1 - band) * AZIMUTHS + b / POINTS] += pdf * solid_angle;
        }
    }
    let sum: f64 = all.iter().sum();
    assert!(sum < 1.0 + 1e-3, "the density has the integral {sum}");
    all[COSINES * AZIMUTHS] = (1.0 - sum).max(0.0);
    all
}

#[test]
fn directions_follow_the_density_and_eval_says_the_same() {
    for (name, material) in rough_ones().into_iter().chain(covered_ones()) {
        let name = format!("{name} of roughness {}", material.roughness);
        assert_directions_follow_the_density(&name, &floor(material));
    }
}

/// That samples of what is met on a floor are as the density says, and weigh as `eval` does.
pub fn assert_directions_follow_the_density(name: &str, floor: &PreparedScene) {
    for (degrees, is_above) in [(10.0, true), (60.0, true), (80.0, true), (40.0, false)] {
        let incoming = arriving(degrees, is_above);
        let bsdf = met(floor, incoming);
        let expected: Vec<f64> =
            probabilities(&bsdf, incoming).iter().map(|p| p * f64::from(COUNT)).collect();
        for (kind, sampler) in SAMPLERS {
            let cells = samples(bsdf, incoming, kind).map(|sample| {
                let said = bsdf.eval(incoming, sample.direction);
                if sample.weight == Vec3::ZERO {
                    return COSINES * AZIMUTHS;
                }
                let both = sample.pdf.max(said.pdf);
                assert!((sample.pdf - said.pdf).abs() <= 2e-3 * both, "{name}: density");
                let difference = (sample.weight - said.weight).abs().max_element();
                let largest = sample.weight.max_element().max(1.0);
                let is_close = difference <= 2e-3 * largest;
                assert!(is_close, "{name}: {} {}", sample.weight, said.weight);
                sphere_cell(sample.direction)
            });
            let counts = histogram(COSINES * AZIMUTHS + 1, cells);
            let what = format!("{name} at {degrees} degrees, {is_above}, {sampler}");
            assert_chi_square(&counts, &expected, &what);
        }
    }
}

/// The mean of the weights is what a white surroundings would show: the share of light that is
/// kept.
pub fn energy(floor: &PreparedScene, incoming: Vec3) -> (f64, f64) {
    let bsdf = met(floor, incoming);
    let kept: Vec<f64> = samples(bsdf, incoming, SOBOL)
        .map(|sample| {
            // Radiance is squeezed where it crosses, energy is not.
            f64::from(sample.weight.y * sample.eta * sample.eta)
        })
        .collect();
    mean_and_error(&kept)
}

#[test]
fn white_furnaces_keep_all_light() {
    for roughness in [0.0, 0.05, 0.2, 0.5, 0.8, 1.0] {
        let paint = Principled::paint(Vec3::ONE, roughness);
        let materials = [
            ("white paint", paint),
            ("white metal", Principled::metal(Vec3::ONE, roughness)),
            ("half metal", Principled { metallic: 0.5, ..paint }),
            ("dull half metal", Principled { metallic: 0.5, f90: 0.3, ..paint }),
            ("dull paint", Principled { f90: 0.0, specular: Vec3::splat(0.5), ..paint }),
            ("paint of index 2.5", Principled { ior: 2.5, ..paint }),
            ("coated paint", Principled { coat: 1.0, coat_roughness: 0.3, ..paint }),
            ("coat", Principled { coat: 1.0, coat_roughness: roughness, ..paint }),
            ("velvet", Principled { sheen: Vec3::ONE, sheen_roughness: roughness, ..paint }),
            ("glass", Principled::glass(1.5, roughness)),
            ("diamond", Principled::glass(2.4, roughness)),
            ("what is all but air", Principled::glass(1.1, roughness)),
            ("a bubble in glass", Principled::glass(1.0 / 1.5, roughness)),
            ("a pane", Principled { thin_walled: true, ..Principled::glass(1.5, roughness) }),
            ("a mixture", Principled { metallic: 0.3, transmission: 0.6, coat: 0.5, ..paint }),
            ("brushed paint", brushed(paint, 0.4, 10.0)),
            ("brushed metal", brushed(Principled::metal(Vec3::ONE, roughness), 0.6, 50.0)),
            ("metal, all grain", brushed(Principled::metal(Vec3::ONE, roughness), 1.0, 90.0)),
        ];
        for (name, material) in materials {
            let floor = floor(material);
            for degrees in ANGLES {
                for is_above in [true, false] {
                    let (mean, error) = energy(&floor, arriving(degrees, is_above));
                    let what = format!(
                        "{name}, roughness {roughness}, {degrees} degrees, {is_above}: {mean}"
                    );
                    assert!((mean - 1.0).abs() < 0.005, "{what}");
                    assert!(mean < 1.0 + 3.0 * error + 0.002, "{what} +- {error}");
                }
            }
        }
    }
}

/// What reflects nothing straight on and nothing at grazing angles follows Lambert's law.
#[test]
fn paint_without_a_surface_is_lamberts() {
    let colour = Vec3::new(0.7, 0.4, 0.2);
    let matt = Principled { specular: Vec3::ZERO, f90: 0.0, ..Principled::paint(colour, 0.3) };
    let floor = floor(matt);
    for degrees in ANGLES {
        for k in 1..20 {
            let (sin, cos) = (k as f32 * 0.08).sin_cos();
            let direction = Vec3::new(0.6 * sin, 0.8 * sin, cos);
            let value = bsdf_value(&floor, -arriving(degrees, true), direction);
            let expected = colour.as_dvec3() * std::f64::consts::FRAC_1_PI;
            assert!((value - expected).length() < 1e-5, "{degrees} {k}: {value} {expected}");
        }
    }
}

/// At grazing angles a smooth surface reflects the share that `f90` says of what it does else.
#[test]
fn f90_is_what_is_reflected_at_grazing_angles() {
    let reflected = |f90: f32, metallic: f32| {
        let black = Principled { f90, metallic, ..Principled::paint(Vec3::ZERO, 0.0) };
        energy(&floor(black), arriving(89.99, true))
    };
    let (whole, _) = reflected(1.0, 0.0);
    for (f90, metallic, share) in [(0.4, 0.0, 0.4), (0.4, 0.5, 0.7)] {
        let (mean, error) = reflected(f90, metallic);
        let expected = share * whole;
        assert!((mean - expected).abs() < 0.005 + 4.0 * error, "{f90} {metallic}: {mean}");
    }
}

/// The BSDF, without the cosine.
fn bsdf_value(floor: &PreparedScene, o: Vec3, i: Vec3) -> DVec3 {
    let sample = met(floor, -o).eval(-o, i);
    (sample.weight * (sample.pdf / i.z.abs())).as_dvec3()
}

#[test]
fn both_directions_are_worth_the_same() {
    let directions: Vec<Vec3> = (0..12)
        .map(|k| {
            let (sin, cos) = (k as f32 * 2.4).sin_cos();
            let z = 0.05 + 0.078 * k as f32;
            Vec3::new(sin, cos, 0.0) * (1.0 - z * z).sqrt() + Vec3::Z * z
        })
        .collect();
    for (name, material) in rough_ones() {
        let floor = floor(material);
        for &a in &directions {
            for &b in &directions {
                let (there, back) = (bsdf_value(&floor, a, b), bsdf_value(&floor, b, a));
                let close = (there - back).length() <= 1e-4 * (there + back).length();
                assert!(close, "{name}, {a} and {b}: {there} {back}");
                // Where light crosses, radiance is squeezed by the squared ratio of the indices
                // (Veach 1997, equation 5.14).
                let (into, out) = (bsdf_value(&floor, a, -b), bsdf_value(&floor, -b, a));
                let ior = if material.thin_walled { 1.0 } else { material.ior };
                let squeezed = out / f64::from(ior * ior);
                let close = (into - squeezed).length() <= 1e-3 * (into + squeezed).length() + 1e-9;
                assert!(close, "{name}, through, {a} and {b}: {into} {squeezed}");
            }
        }
    }
}

#[test]
fn smooth_glass_reflects_by_fresnels_formulas() {
    for (ior, degrees) in [(1.5, 2.0), (1.5, 60.0), (2.4, 45.0), (1.33, 80.0)] {
        let floor = floor(Principled::glass(ior, 0.0));
        let incoming = arriving(degrees, true);
        let above = samples(met(&floor, incoming), incoming, SOBOL)
            .filter(|sample| sample.direction.z > 0.0)
            .count();
        let share = above as f64 / f64::from(COUNT);
        let reflected = reflectance(degrees.into(), ior.into());
        assert!((share - reflected).abs() < 2e-3, "{ior}, {degrees} degrees: {share} {reflected}");
    }
}

/// Of a grain along the x of the floor's texture: the highlight is wide along it, narrow across.
#[test]
fn a_highlight_is_wide_along_the_grain() {
    let metal = Principled::metal(Vec3::ONE, 0.2);
    for (rotation, is_turned) in [(0.0, false), (90.0, true), (-270.0, true)] {
        let floor = floor(brushed(metal, 0.8, rotation));
        let incoming = Vec3::NEG_Z;
        // The median slopes of microfacets, which are in proportion to those of GGX.
        let mut slopes = [Vec::new(), Vec::new()];
        for sample in samples(met(&floor, incoming), incoming, SOBOL) {
            let h = (sample.direction - incoming).normalize();
            slopes[0].push(h.dot(Vec3::new(0.8, 0.6, 0.0)).abs() / h.z);
            slopes[1].push(h.dot(Vec3::new(-0.6, 0.8, 0.0)).abs() / h.z);
        }
        let [along, across] = slopes.map(|mut slopes| {
            slopes.sort_by(f32::total_cmp);
            slopes[slopes.len() / 2]
        });
        let ratio = if is_turned { across / along } else { along / across };
        // Of one reflection it is that of the slopes, 0.04 + 0.96 * 0.64 over 0.04. A sum over
        // directions apart from this program has 0.724 for its share, and 9.24 for the whole with
        // the lobe that follows the cosine.
        assert!((ratio - 9.24).abs() < 0.25, "{rotation}: {ratio}");
    }
    // Without texture coordinates there is none, and without strength it is as it was.
    let plain = met(&floor(metal), arriving(30.0, true)).grain;
    assert_eq!(plain, Vec3::ZERO);
}

#[test]
fn smooth_metal_is_a_mirror() {
    let floor = floor(Principled::metal(Vec3::new(1.0, 0.5, 0.2), 0.0));
    let incoming = arriving(40.0, true);
    let mirrored = incoming.reflect(Vec3::Z);
    let far = samples(met(&floor, incoming), incoming, SOBOL)
        .filter(|sample| sample.direction.dot(mirrored) < 0.9999)
        .count();
    assert!(far < COUNT as usize / 50, "{far} of {COUNT} directions are a degree off");
}
