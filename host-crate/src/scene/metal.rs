//! Metals by name, with what has been measured of them.

use crate::names::named;
use glam::Vec3;

/// The complex index of refraction `eta - i k` of a metal, for red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    /// Index of refraction relative to the outside, each component in [0.001, 100].
    pub eta: Vec3,
    /// Coefficient of extinction relative to the outside, each component in [0, 100].
    pub k: Vec3,
}

/// Metals whose index of refraction is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metal {
    /// Silver, the whitest.
    Silver,
    /// Gold.
    Gold,
    /// Copper.
    Copper,
    /// Aluminium.
    Aluminium,
    /// Iron.
    Iron,
    /// Chromium.
    Chromium,
    /// Nickel.
    Nickel,
    /// Titanium.
    Titanium,
}

named! {
    Metal {
        Silver: "silver",
        Gold: "gold",
        Copper: "copper",
        Aluminium: "aluminium",
        Iron: "iron",
        Chromium: "chromium",
        Nickel: "nickel",
        Titanium: "titanium",
    }
}

impl Metal {
    /// Its index of refraction against air, as measured at room temperature, between the nearest
    /// wavelengths of the tables, at 612 nm, 549 nm and 465 nm, which have about the hues of
    /// Rec.709's primaries.
    ///
    /// Silver, gold, copper: Johnson, Christy, "Optical Constants of the Noble Metals", Phys. Rev.
    /// B 6, 1972. Iron, chromium, nickel, titanium: the same, "Optical Constants of Transition
    /// Metals", Phys. Rev. B 9, 1974. Aluminium: Rakić, Appl. Opt. 34, 1995.
    pub fn conductor(self) -> Conductor {
        let [eta, k] = match self {
            Self::Silver => [[0.059, 0.060, 0.047], [4.111, 3.589, 2.803]],
            Self::Gold => [[0.221, 0.428, 1.332], [3.215, 2.460, 1.869]],
            Self::Copper => [[0.355, 1.016, 1.247], [3.136, 2.579, 2.456]],
            Self::Aluminium => [[1.325, 1.011, 0.686], [7.318, 6.616, 5.635]],
            Self::Iron => [[2.889, 2.950, 2.646], [3.041, 2.930, 2.805]],
            Self::Chromium => [[3.177, 3.180, 2.456], [3.300, 3.330, 3.210]],
            Self::Nickel => [[1.986, 1.920, 1.765], [3.989, 3.610, 3.048]],
            Self::Titanium => [[2.660, 2.540, 2.305], [3.700, 3.430, 3.082]],
        };
        Conductor { eta: Vec3::from_array(eta), k: Vec3::from_array(k) }
    }
}

impl Conductor {
    /// What it reflects straight on, each component in [0, 1].
    pub fn normal_reflectance(&self) -> Vec3 {
        let k2 = self.k * self.k;
        let (below, above) = (self.eta - Vec3::ONE, self.eta + Vec3::ONE);
        (below * below + k2) / (above * above + k2)
    }
}
