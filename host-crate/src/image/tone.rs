//! From linear colours of any brightness to the 8 bits of a screen.

use crate::color::srgb_encode;
use crate::names::named;
use glam::Vec3;

/// How a picture is shown on a screen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Display {
    /// Exposure in stops: colours are multiplied by `2^exposure`. Finite.
    pub exposure: f32,
    /// What becomes of colours that are too bright for a screen.
    pub tone_map: ToneMap,
}

/// What becomes of colours that are too bright for a screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ToneMap {
    /// True colours up to 0.8; brighter ones are compressed and fade to white, keeping their hue.
    #[default]
    Soft,
    /// True colours up to 1, each component cut off there.
    Clip,
    /// The contrast of film: darker shadows, an S-curve (ACES, as fitted by Narkowicz).
    Aces,
}

named! {
    ToneMap {
        Soft: "soft",
        Clip: "clip",
        Aces: "aces",
    }
}

impl Display {
    /// The sRGB bytes of a linear Rec.709 colour. Not a number and negative components become 0,
    /// infinite ones as bright as can be.
    pub fn srgb8(&self, linear: Vec3) -> [u8; 3] {
        let mapped = self.mapped(linear);
        mapped.to_array().map(|c| (srgb_encode(c.clamp(0.0, 1.0)) * 255.0).round() as u8)
    }

    /// A linear colour after exposure and tone map, still linear; what is above 1 is white. Not a
    /// number and negative components become 0.
    pub(super) fn mapped(&self, linear: Vec3) -> Vec3 {
        // Finite, so that neither the scale nor the tone map can make a NaN of it.
        let scale = self.exposure.exp2().min(MAX);
        let exposed = linear.map(|c| if c > 0.0 { (c.min(MAX) * scale).min(MAX) } else { 0.0 });
        match self.tone_map {
            ToneMap::Soft => soft(exposed),
            ToneMap::Clip => exposed,
            ToneMap::Aces => exposed.map(aces),
        }
    }
}

/// Brighter than any screen, and its cube is finite.
const MAX: f32 = 1e12;

/// The shoulder of Khronos PBR Neutral, without that curve's toe, which would darken shadows.
fn soft(color: Vec3) -> Vec3 {
    const START: f32 = 0.8;
    const DESATURATION: f32 = 0.15;
    let peak = color.max_element();
    if peak <= START {
        return color;
    }
    let room = 1.0 - START;
    let new_peak = 1.0 - room * room / (peak + room - START);
    let white = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    (color * (new_peak / peak)).lerp(Vec3::splat(new_peak), white)
}

fn aces(c: f32) -> f32 {
    // The fit maps 1 to 0.8; the usual factor before it brings middle grey back to where it was.
    let c = 0.6 * c;
    c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::srgb_decode;

    const CLIP: Display = Display { exposure: 0.0, tone_map: ToneMap::Clip };

    #[test]
    fn known_values_of_the_srgb_curve() {
        assert_eq!(CLIP.srgb8(Vec3::new(0.0, 0.5, 1.0)), [0, 188, 255]);
        assert_eq!(CLIP.srgb8(Vec3::new(0.001, 0.18, 7.0)), [3, 118, 255]);
        let brighter = Display { exposure: 1.0, ..CLIP };
        assert_eq!(brighter.srgb8(Vec3::new(0.25, 0.09, 0.0)), [188, 118, 0]);
        let darker = Display { exposure: -2.0, ..CLIP };
        assert_eq!(darker.srgb8(Vec3::splat(2.0)), [188; 3]);
        for code in 0..=255_u8 {
            let linear = srgb_decode(f64::from(code) / 255.0) as f32;
            assert_eq!(CLIP.srgb8(Vec3::splat(linear)), [code; 3], "decoding undoes encoding");
        }
    }

    #[test]
    fn no_number_is_too_strange() {
        for tone_map in [ToneMap::Soft, ToneMap::Clip, ToneMap::Aces] {
            for exposure in [0.0, 1000.0, -1000.0] {
                let display = Display { exposure, tone_map };
                assert_eq!(display.srgb8(Vec3::new(f32::NAN, f32::NEG_INFINITY, -1.0)), [0; 3]);
            }
            let display = Display { exposure: 0.0, tone_map };
            assert_eq!(display.srgb8(Vec3::INFINITY), [255; 3], "{tone_map:?}");
            assert_eq!(display.srgb8(Vec3::MAX), [255; 3], "{tone_map:?}");
            let one_nan = display.srgb8(Vec3::new(0.5, f32::NAN, 0.5));
            assert_eq!(one_nan, display.srgb8(Vec3::new(0.5, 0.0, 0.5)));
        }
    }

    #[test]
    fn soft_is_true_below_its_shoulder_and_keeps_order_above() {
        let dim = Vec3::new(0.8, 0.3, 0.02);
        assert_eq!(soft(dim), dim);
        let mut last = 0.8;
        for i in 1..100 {
            let c = soft(Vec3::splat(0.8 + 0.1 * i as f32));
            assert!(c.x > last && c.x < 1.0, "{c}");
            last = c.x;
        }
        // A bright red stays red at first and is nearly white in the end.
        let (bright, blinding) =
            (soft(Vec3::new(2.0, 0.2, 0.2)), soft(Vec3::new(2000.0, 200.0, 200.0)));
        assert!(bright.x > 2.0 * bright.y && blinding.y > 0.95, "{bright} {blinding}");
        assert_eq!(bright.y, bright.z);
    }

    #[test]
    fn aces_at_known_points() {
        assert_eq!(aces(0.0), 0.0);
        // 0.6 * (2.51 * 0.6 + 0.03) / (0.6 * (2.43 * 0.6 + 0.59) + 0.14)
        assert!((aces(1.0) - 0.673_29).abs() < 1e-4, "{}", aces(1.0));
    }
}
