//! The colours that a file means by red, green, blue and white.

use exr::meta::attribute::Chromaticities;
use glam::{DMat3, DVec3};
use std::fmt;

/// The CIE 1931 chromaticities (x, y) of red, green, blue and white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Primaries([[f64; 2]; 4]);

/// Spaces that have a name.
const NAMED: [(&str, Primaries); 6] = [
    ("ACES AP0", Primaries([[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077], [0.32168, 0.33767]])),
    ("ACES AP1", Primaries([[0.713, 0.293], [0.165, 0.83], [0.128, 0.044], [0.32168, 0.33767]])),
    ("Rec. 2020", Primaries([[0.708, 0.292], [0.17, 0.797], [0.131, 0.046], D65])),
    ("P3-D65", Primaries([[0.68, 0.32], [0.265, 0.69], [0.15, 0.06], D65])),
    ("Adobe RGB", Primaries([[0.64, 0.33], [0.21, 0.71], [0.15, 0.06], D65])),
    ("CIE XYZ", Primaries::XYZ),
];

const D65: [f64; 2] = [0.3127, 0.3290];

/// Chromaticities that differ by no more are the same: files give them to four digits.
const TOLERANCE: f64 = 1e-3;

impl Primaries {
    /// ITU-R BT.709, which a file means that says nothing else.
    pub(super) const REC_709: Self = Self([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06], D65]);

    /// CIE XYZ itself: no colours, but coordinates.
    const XYZ: Self = Self([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0 / 3.0, 1.0 / 3.0]]);

    /// What a file says, or means.
    pub(super) fn of(chromaticities: Option<Chromaticities>) -> Self {
        chromaticities.map_or(Self::REC_709, |c| {
            Self([c.red, c.green, c.blue, c.white].map(|xy| [xy.0.into(), xy.1.into()]))
        })
    }

    /// Whether they are those of Rec. 709 but for rounding.
    pub(super) fn are_rec_709(&self) -> bool {
        self.is(&Self::REC_709)
    }

    fn is(&self, other: &Self) -> bool {
        let pairs = self.0.as_flattened().iter().zip(other.0.as_flattened());
        pairs.into_iter().all(|(a, b)| (a - b).abs() <= TOLERANCE)
    }

    /// The colours of these primaries as linear Rec. 709, white as white (but for XYZ, where
    /// colours are what they are); none where these are not the primaries of a space of colours.
    pub(super) fn to_rec_709(self) -> Option<DMat3> {
        let from_xyz = Self::REC_709.to_xyz()?.inverse();
        if self.is(&Self::XYZ) {
            return Some(from_xyz);
        }
        Some(from_xyz * adaptation(self.white()?, Self::REC_709.white()?) * self.to_xyz()?)
    }

    /// What red, green and blue add to the luminance, 1 in all; none where
    /// [`to_rec_709`](Self::to_rec_709) has none.
    pub(super) fn luminance_weights(&self) -> Option<DVec3> {
        let weights = self.to_xyz()?.row(1);
        Some(weights / weights.element_sum())
    }

    /// XYZ of red, green and blue, of which all three make white of luminance 1 (SMPTE RP 177).
    fn to_xyz(self) -> Option<DMat3> {
        let [red, green, blue, _] = self.0.map(|[x, y]| DVec3::new(x, y, 1.0 - x - y));
        let primaries = DMat3::from_cols(red, green, blue);
        let is_space = primaries.is_finite() && primaries.determinant().abs() > 1e-4;
        let scale = primaries.inverse() * self.white()?;
        let matrix = primaries * DMat3::from_diagonal(scale);
        (is_space && scale.is_finite() && matrix.determinant().abs() > 1e-6).then_some(matrix)
    }

    /// XYZ of white, of luminance 1.
    fn white(&self) -> Option<DVec3> {
        let [x, y] = self.0[3];
        let white = DVec3::new(x, y, 1.0 - x - y) / y;
        (white.is_finite() && white.min_element() > 0.0).then_some(white)
    }
}

impl fmt::Display for Primaries {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((name, _)) = NAMED.iter().find(|(_, named)| self.is(named)) {
            write!(f, "{name}: ")?;
        }
        for (index, (name, [x, y])) in
            ["red", "green", "blue", "white"].iter().zip(self.0).enumerate()
        {
            write!(f, "{}{name} ({x:.4}, {y:.4})", if index > 0 { ", " } else { "" })?;
        }
        Ok(())
    }
}

/// Colours under a white as they look under another, by the linear Bradford transform
/// (ICC.1:2022, annex E).
fn adaptation(from: DVec3, to: DVec3) -> DMat3 {
    let cones = DMat3::from_cols(
        DVec3::new(0.8951, -0.7502, 0.0389),
        DVec3::new(0.2664, 1.7135, -0.0685),
        DVec3::new(-0.1614, 0.0367, 1.0296),
    );
    cones.inverse() * DMat3::from_diagonal((cones * to) / (cones * from)) * cones
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str) -> Primaries {
        NAMED.into_iter().find(|(known, _)| *known == name).unwrap().1
    }

    #[test]
    fn white_stays_white() {
        for (name, primaries) in NAMED {
            // XYZ of the white of Rec. 709, where there is no white.
            let white =
                if name == "CIE XYZ" { Primaries::REC_709.white().unwrap() } else { DVec3::ONE };
            let converted = primaries.to_rec_709().unwrap() * white;
            assert!(converted.abs_diff_eq(DVec3::ONE, 1e-12), "{name}: {converted}");
        }
    }

    /// Matrices that other sources give.
    #[test]
    fn conversions_are_the_published_ones() {
        let row = |name: &str, row| named(name).to_rec_709().unwrap().row(row);
        // ITU-R BT.2087, and ACES to Rec. 709 as in the ACES utilities.
        let bt_2087 = DVec3::new(1.6605, -0.5876, -0.0728);
        assert!(row("Rec. 2020", 0).abs_diff_eq(bt_2087, 1e-4), "{}", row("Rec. 2020", 0));
        let aces = DVec3::new(2.5216, -1.1340, -0.3876);
        // They adapt by another transform of the cones, close to this one.
        assert!(row("ACES AP0", 0).abs_diff_eq(aces, 0.02), "{}", row("ACES AP0", 0));
        let weights = Primaries::REC_709.luminance_weights().unwrap();
        assert!(weights.abs_diff_eq(DVec3::new(0.2126, 0.7152, 0.0722), 1e-4), "{weights}");
        assert_eq!(named("CIE XYZ").luminance_weights().unwrap(), DVec3::Y);
    }

    #[test]
    fn what_is_no_space_of_colours_is_not_converted() {
        let [red, green, blue, white] = Primaries::REC_709.0;
        for strange in [
            [red, red, blue, white],
            [red, green, blue, [0.3, 0.0]],
            [red, green, [f64::NAN, 0.0], white],
            [[0.0; 2]; 4],
            [[1e30, 1.0], green, blue, white],
        ] {
            let strange = Primaries(strange);
            let matrix = strange.to_rec_709();
            assert!(matrix.is_none_or(|matrix| matrix.is_finite()), "{strange}: {matrix:?}");
        }
        assert_eq!(Primaries([red, red, blue, white]).to_rec_709(), None);
        assert_eq!(Primaries([red, green, blue, [0.3, 0.0]]).luminance_weights(), None);
    }

    #[test]
    fn rounded_primaries_are_the_same() {
        let mut rounded = Primaries::REC_709;
        rounded.0[3] = [0.3128, 0.3291];
        assert!(rounded.are_rec_709() && !named("P3-D65").are_rec_709());
        assert!(named("ACES AP0").to_string().starts_with("ACES AP0: red (0.7347, 0.2653), "));
        assert!(Primaries::REC_709.to_string().starts_with("red ("));
    }
}
