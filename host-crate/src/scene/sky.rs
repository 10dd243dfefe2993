//! A clear sky with its sun, as an environment.
//!
//! The sky is the model of Preetham, Shirley, Smits, "A Practical Analytic Model for Daylight",
//! SIGGRAPH 1999: closed formulas, without tables, good but for much haze and a low sun. The sun is
//! a black body of 5778 K through the model's atmosphere (its appendix A), without the few
//! hundredths that ozone and vapour take. Below the horizon is matt ground that the two light.
//!
//! The sun's disc is part of the picture, so that it is seen, mirrored, and sampled by importance
//! as all of the picture is.

use super::bounds;
use super::environment::Environment;
use glam::{DMat3, DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Texels of the picture: the sun is three of them wide.
const WIDTH: u32 = 2048;
const HEIGHT: u32 = WIDTH / 2;
/// Radius of the sun's disc, in radians: half of 0.533 degrees.
const SUN_RADIUS: f64 = 0.004_65;
/// Points along a texel's sides where it is looked for the sun.
const POINTS: u32 = 8;

/// A clear sky with its sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Height of the sun over the horizon, in degrees, from 0 to 90.
    pub elevation: f32,
    /// How much haze there is, from 2, for air as clear as on mountains, to 10.
    pub turbidity: f32,
    /// What the ground reflects, linear Rec.709, each component in [0, 1].
    pub ground: Vec3,
    /// Whether the sun is in it.
    pub has_sun: bool,
}

impl Sky {
    /// The sky of a sun so many degrees over the horizon, of a clear day above grey ground.
    pub fn new(elevation: f32) -> Self {
        Self { elevation, turbidity: 3.0, ground: Vec3::splat(0.2), has_sun: true }
    }

    /// What is wrong with it: the field, and why.
    pub(super) fn check(&self) -> Result<(), (&'static str, String)> {
        bounds::elevation(self.elevation.into()).map_err(|what| ("elevation", what))?;
        bounds::turbidity(self.turbidity.into()).map_err(|what| ("turbidity", what))?;
        bounds::reflectance(&self.ground.as_dvec3().to_array()).map_err(|w| ("ground", w))?;
        Ok(())
    }

    /// A picture of it, of 2048x1024 texels. Radiances are luminances in kcd/m2 and irradiances in
    /// klx, so that white surfaces in the sun have some 25. Without rotation the sun stands towards
    /// -z.
    ///
    /// # Panics
    ///
    /// When a field is not within its range.
    pub fn environment(&self) -> Environment {
        assert_eq!(self.check(), Ok(()), "a field is out of range");
        let air = Air::new(self.elevation.into(), self.turbidity.into());
        let sun = if self.has_sun { air.sun_irradiance() } else { DVec3::ZERO };
        let discs = Discs::new(air.sun);
        let mut irradiance = sun * air.sun.y;
        let mut texels = Vec::with_capacity((WIDTH * HEIGHT) as usize);
        for (y, x) in (0..HEIGHT / 2).flat_map(|y| (0..WIDTH).map(move |x| (y, x))) {
            let direction = direction(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let sky = air.sky_radiance(direction);
            irradiance += sky * (solid_angle(y) * direction.y);
            texels.push((sky + sun * discs.density(x, y)).as_vec3());
        }
        let ground = irradiance.as_vec3() * self.ground / std::f32::consts::PI;
        texels.resize((WIDTH * HEIGHT) as usize, ground);
        Environment::new(WIDTH, HEIGHT, texels)
    }
}

/// The direction at a place of the picture, in texels from its upper left corner.
fn direction(x: f64, y: f64) -> DVec3 {
    let (sin, cos) = (PI * y / f64::from(HEIGHT)).sin_cos();
    let (east, south) = (TAU * x / f64::from(WIDTH) - PI).sin_cos();
    DVec3::new(sin * east, cos, -sin * south)
}

/// The solid angle of a texel in this row.
fn solid_angle(y: u32) -> f64 {
    let end = |row: u32| (PI * f64::from(row) / f64::from(HEIGHT)).cos();
    TAU / f64::from(WIDTH) * (end(y) - end(y + 1))
}

/// The sun's disc over the texels of the picture, as far as it is over the horizon.
struct Discs {
    sun: DVec3,
    /// Solid angle of the points that the disc has.
    whole: f64,
}

impl Discs {
    fn new(sun: DVec3) -> Self {
        let all = (0..HEIGHT / 2).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
        let whole = all.map(|(x, y)| share(sun, x, y) * solid_angle(y)).sum();
        Self { sun, whole }
    }

    /// Density of the disc in a texel, per solid angle.
    fn density(&self, x: u32, y: u32) -> f64 {
        if self.whole > 0.0 { share(self.sun, x, y) / self.whole } else { 0.0 }
    }
}

/// The share of a texel that the disc covers.
fn share(sun: DVec3, x: u32, y: u32) -> f64 {
    let texel = PI / f64::from(HEIGHT);
    let middle = direction(f64::from(x) + 0.5, f64::from(y) + 0.5);
    if middle.dot(sun) < (SUN_RADIUS + texel).cos() {
        return 0.0;
    }
    let place = |k: u32| (f64::from(k) + 0.5) / f64::from(POINTS);
    let points = (0..POINTS).flat_map(|a| (0..POINTS).map(move |b| (place(a), place(b))));
    let covered = points
        .filter(|(a, b)| direction(f64::from(x) + a, f64::from(y) + b).dot(sun) > SUN_RADIUS.cos());
    covered.count() as f64 / f64::from(POINTS * POINTS)
}

/// The atmosphere under a sun.
struct Air {
    /// To the sun.
    sun: DVec3,
    /// The sun's angle from the zenith, in radians.
    theta: f64,
    turbidity: f64,
    /// Luminance in kcd/m2 and chromaticities x and y at the zenith.
    zenith: [f64; 3],
    /// How these are distributed.
    perez: [Perez; 3],
}

impl Air {
    fn new(elevation: f64, turbidity: f64) -> Self {
        let theta = FRAC_PI_2 - elevation.to_radians();
        let sun = DVec3::new(0.0, theta.cos(), -theta.sin());
        let t = turbidity;
        let perez = [
            Perez([
                0.1787 * t - 1.4630,
                -0.3554 * t + 0.4275,
                -0.0227 * t + 5.3251,
                0.1206 * t - 2.5771,
                -0.0670 * t + 0.3703,
            ]),
            Perez([
                -0.0193 * t - 0.2592,
                -0.0665 * t + 0.0008,
                -0.0004 * t + 0.2125,
                -0.0641 * t - 0.8989,
                -0.0033 * t + 0.0452,
            ]),
            Perez([
                -0.0167 * t - 0.2608,
                -0.0950 * t + 0.0092,
                -0.0079 * t + 0.2102,
                -0.0441 * t - 1.6537,
                -0.0109 * t + 0.0529,
            ]),
        ];
        let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * theta);
        let luminance = (4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192;
        let cubic = |c: [f64; 4]| ((c[0] * theta + c[1]) * theta + c[2]) * theta + c[3];
        let x = cubic([0.001_66, -0.003_75, 0.002_09, 0.0]) * t * t
            + cubic([-0.029_03, 0.063_77, -0.032_02, 0.003_94]) * t
            + cubic([0.116_93, -0.211_96, 0.060_52, 0.258_86]);
        let y = cubic([0.002_75, -0.006_10, 0.003_17, 0.0]) * t * t
            + cubic([-0.042_14, 0.089_70, -0.041_53, 0.005_16]) * t
            + cubic([0.153_46, -0.267_56, 0.066_70, 0.266_88]);
        Self { sun, theta, turbidity, zenith: [luminance.max(0.0), x, y], perez }
    }

    /// Radiance from a direction above the horizon, linear Rec.709.
    fn sky_radiance(&self, direction: DVec3) -> DVec3 {
        let gamma = direction.dot(self.sun).clamp(-1.0, 1.0).acos();
        let cosine = direction.y.max(1e-3);
        let [luminance, x, y] = [0, 1, 2].map(|k| {
            let at_zenith = self.perez[k].value(1.0, self.theta);
            self.zenith[k] * self.perez[k].value(cosine, gamma) / at_zenith
        });
        let luminance = luminance.max(0.0);
        rec709(DVec3::new(x / y, 1.0, (1.0 - x - y) / y) * luminance)
    }

    /// Irradiance by the sun of a surface that faces it, linear Rec.709.
    fn sun_irradiance(&self) -> DVec3 {
        let degrees = self.theta.to_degrees();
        let mass = 1.0 / (self.theta.cos().max(0.0) + 0.15 * (93.885 - degrees).powf(-1.253));
        let haze = 0.04608 * self.turbidity - 0.04586;
        let step = 5.0;
        let wavelengths = (0..=80).map(|k| 380.0 + step * f64::from(k));
        let xyz: DVec3 = wavelengths
            .map(|nm| {
                let um = nm * 1e-3;
                let rayleigh = (-0.008_735 * mass * um.powf(-4.08)).exp();
                let aerosol = (-haze * mass * um.powf(-1.3)).exp();
                observer(nm) * (sunlight(nm) * rayleigh * aerosol * step)
            })
            .sum();
        // Lumens by watt, and thousands of them.
        rec709(xyz * 0.683)
    }
}

/// Perez's distribution of light over a sky, by its five coefficients.
struct Perez([f64; 5]);

impl Perez {
    /// Under this cosine to the zenith and this angle to the sun.
    fn value(&self, cosine: f64, gamma: f64) -> f64 {
        let [a, b, c, d, e] = self.0;
        let around = 1.0 + c * (d * gamma).exp() + e * gamma.cos().powi(2);
        (1.0 + a * (b / cosine).exp()) * around
    }
}

/// Irradiance by the sun above the atmosphere, in W/(m2 nm), at a wavelength in nm: a black body of
/// 5778 K and the sun's size, which has 1361 W/m2 in all.
fn sunlight(nm: f64) -> f64 {
    const SOLID_ANGLE: f64 = 6.794e-5;
    let m = nm * 1e-9;
    // 2 h c^2 and h c / k.
    let radiance = 1.191_043e-16 / (m.powi(5) * ((1.438_777e-2 / (m * 5778.0)).exp() - 1.0));
    radiance * SOLID_ANGLE * 1e-9
}

/// The colour-matching functions of the CIE 1931 observer at a wavelength in nm, by Wyman, Sloan,
/// Shirley, "Simple Analytic Approximations to the CIE XYZ Color Matching Functions", JCGT 2(2),
/// 2013.
fn observer(nm: f64) -> DVec3 {
    let lobe = |middle: f64, below: f64, above: f64| {
        let distance = (nm - middle) * if nm < middle { below } else { above };
        (-0.5 * distance * distance).exp()
    };
    DVec3::new(
        0.362 * lobe(442.0, 0.0624, 0.0374) + 1.056 * lobe(599.8, 0.0264, 0.0323)
            - 0.065 * lobe(501.1, 0.0490, 0.0382),
        0.821 * lobe(568.8, 0.0213, 0.0247) + 0.286 * lobe(530.9, 0.0613, 0.0322),
        1.217 * lobe(437.0, 0.0845, 0.0278) + 0.681 * lobe(459.0, 0.0385, 0.0725),
    )
}

/// The colour of CIE XYZ in linear Rec.709; what is out of its gamut is brought to its edge.
fn rec709(xyz: DVec3) -> DVec3 {
    let rows = DMat3::from_cols_array(&[
        3.240_97, -1.537_383, -0.498_611, //
        -0.969_244, 1.875_968, 0.041_555, //
        0.055_63, -0.203_977, 1.056_972,
    ]);
    (rows.transpose() * xyz).max(DVec3::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luminance(colour: DVec3) -> f64 {
        colour.dot(DVec3::new(0.2126, 0.7152, 0.0722))
    }

    #[test]
    fn the_sun_is_as_bright_as_measured() {
        let total: f64 = (0..4000).map(|k| sunlight(100.0 + 2.0 * f64::from(k)) * 2.0).sum();
        assert!((total - 1361.0).abs() < 30.0, "{total} W/m2 above the atmosphere");
        // Some 100 klx on a clear day, and reddish when low.
        let high = Air::new(60.0, 2.5).sun_irradiance();
        assert!((80.0..120.0).contains(&luminance(high)), "{high}");
        let low = Air::new(5.0, 2.5).sun_irradiance();
        assert!(luminance(low) < 0.6 * luminance(high) && low.x / low.z > 1.5 * high.x / high.z);
    }

    #[test]
    fn the_sky_is_blue_overhead_and_brightest_at_the_sun() {
        let air = Air::new(40.0, 2.5);
        let zenith = air.sky_radiance(DVec3::Y);
        assert!(zenith.z > 1.5 * zenith.x, "{zenith}");
        // A clear sky has some 2 to 10 kcd/m2.
        assert!((1.0..15.0).contains(&luminance(zenith)), "{zenith}");
        assert!(luminance(air.sky_radiance(air.sun)) > 3.0 * luminance(zenith));
    }

    #[test]
    fn the_picture_holds_the_suns_light_where_it_stands() {
        for elevation in [0.0, 30.0, 90.0] {
            let with = Sky::new(elevation).environment();
            let without = Sky { has_sun: false, ..Sky::new(elevation) }.environment();
            let mut sun = DVec3::ZERO;
            let mut towards = DVec3::ZERO;
            for (index, (a, b)) in with.texels.iter().zip(&without.texels).enumerate() {
                let (x, y) = (index as u32 % WIDTH, index as u32 / WIDTH);
                if y < HEIGHT / 2 {
                    let light = (*a - *b).as_dvec3() * solid_angle(y);
                    sun += light;
                    let middle = direction(f64::from(x) + 0.5, f64::from(y) + 0.5);
                    towards += middle * luminance(light);
                }
            }
            let air = Air::new(elevation.into(), 3.0);
            let expected = air.sun_irradiance();
            let off = (sun - expected).abs().max_element() / expected.max_element();
            assert!(off < 1e-3, "{sun} {expected}");
            assert!(towards.normalize().dot(air.sun) > (2.0 * SUN_RADIUS).cos(), "{towards}");
            assert_eq!(with.check(), Ok(()));
        }
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        let bad = |sky: Sky| sky.check().unwrap_err().0;
        assert_eq!(bad(Sky::new(91.0)), "elevation");
        assert_eq!(bad(Sky { turbidity: 1.9, ..Sky::new(9.0) }), "turbidity");
        assert_eq!(bad(Sky { ground: Vec3::splat(2.0), ..Sky::new(9.0) }), "ground");
        assert_eq!(Sky::new(90.0).check(), Ok(()));
    }
}
