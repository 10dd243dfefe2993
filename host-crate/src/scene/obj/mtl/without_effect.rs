//! What an MTL says of a material and the picture does not show.

use super::library::{Entry, Value};
use super::rules::{BUMP_MAPS, EMISSION_MAPS, GLASS_MODELS, SHARPEST, Surface};
use crate::scene::summary::{Fate, Summary};

/// Keys of shares and strengths: 0 is as if they were not there.
const SHARES: [&str; 7] = ["ks", "pm", "ps", "pc", "pcr", "aniso", "anisor"];
/// What a physically based material reads, or what is there for programs that know none.
const OF_PRINCIPLED: [&str; 12] =
    ["kd", "map_kd", "ks", "ns", "pm", "pr", "ps", "pc", "pcr", "aniso", "anisor", "illum"];
const OPACITY_MAPS: [&str; 4] = ["map_d", "map_tr", "map_opacity", "map_alpha"];

const NO_HEIGHT: Fate =
    Fate::Becomes("bump maps that do not say by `-bm` how high they are are left out: ");

impl Entry {
    /// Notes what of the material has no effect, it being such a surface.
    pub(super) fn note_what_has_no_effect(&self, surface: Surface, summary: &mut Summary) {
        let mut keys: Vec<_> = self.keys.iter().collect();
        keys.sort_by_key(|(_, value)| value.line);
        for (key, value) in keys {
            if let Some(fate) = self.fate(key, surface) {
                let thing = shown(value, fate);
                summary.note(&self.path, value.line, fate, &thing, &self.name.to_string());
            }
        }
    }

    /// What becomes of the value of a key, if it has no effect and would have had one elsewhere.
    fn fate(&self, key: &str, surface: Surface) -> Option<Fate> {
        let values = self.hints(key);
        let is_zero = values.iter().all(|&value| value == 0.0);
        let is_one = values.iter().all(|&value| value == 1.0);
        let lost = |is_lost: bool, fate| is_lost.then_some(fate);
        let is_glass = surface == Surface::Glass;
        match key {
            "kd" if self.is_spectrum("kd") => Some(Fate::WithoutEffect),
            _ if surface == Surface::Principled && OF_PRINCIPLED.contains(&key) => None,
            "kd" => lost(
                matches!(surface, Surface::Mirror | Surface::Glass) && !is_zero,
                Fate::WithoutEffect,
            ),
            "ks" if surface == Surface::Mirror => None,
            "ke" => lost(self.is_spectrum("ke"), Fate::WithoutEffect),
            "ns" => lost(self.shines(surface), Fate::WithoutEffect),
            "d" => lost(!is_glass && values.last().is_some_and(|&d| d < 1.0), Fate::Opaque),
            "tr" => self.fate_of_transparency(&values).filter(|_| !is_glass),
            "tf" => lost(is_glass && !is_one, Fate::Unfiltered),
            "map_kd" => {
                lost(surface != Surface::Paint && !self.glows(surface), Fate::WithoutEffect)
            }
            "illum" => self.fate_of_model(surface),
            // The index of what is no glass only shapes a highlight; `sharpness` and `map_aat` say
            // how maps are filtered.
            "ni" | "sharpness" | "map_aat" => None,
            "ka" if is_zero => None,
            "ka" | "map_ka" => Some(Fate::Judged("light from everywhere is not added: ")),
            _ if SHARES.contains(&key) => lost(!is_zero, Fate::WithoutEffect),
            _ if OPACITY_MAPS.contains(&key) => lost(!is_glass, Fate::Opaque),
            _ if BUMP_MAPS.contains(&key) && surface.may_glow() => {
                lost(self.bump().is_none(), NO_HEIGHT)
            }
            _ if EMISSION_MAPS.contains(&key) => lost(!surface.may_glow(), Fate::Unlit),
            _ => Some(Fate::WithoutEffect),
        }
    }

    /// Whether there is a highlight that `Ns` would shape.
    fn shines(&self, surface: Surface) -> bool {
        let is_sharp = self.hints("ns").first().is_none_or(|&exponent| exponent >= SHARPEST);
        let reflects =
            self.hints("ks").iter().any(|&share| share != 0.0) || self.keys.contains_key("map_ks");
        reflects && !(is_sharp && surface != Surface::Paint)
    }

    /// What becomes of `Tr`: where `d` stands beside it, that counts.
    fn fate_of_transparency(&self, values: &[f64]) -> Option<Fate> {
        let transparency = *values.first()?;
        match self.hints("d").last() {
            None => (transparency > 0.0).then_some(Fate::Opaque),
            Some(opacity) => {
                ((opacity + transparency - 1.0).abs() > 0.01).then_some(Fate::WithoutEffect)
            }
        }
    }

    fn fate_of_model(&self, surface: Surface) -> Option<Fate> {
        let model = self.hints("illum").first().map_or(2, |&model| model as i64);
        let is_judged = match surface {
            Surface::Paint => GLASS_MODELS.contains(&model) || matches!(model, 0 | 3 | 5),
            Surface::Lamp => model > 2,
            Surface::Mirror | Surface::Glass | Surface::Principled => false,
        };
        is_judged.then_some(Fate::Judged("nothing else speaks for this model of light: "))
    }
}

/// How a value is called in a sentence: by its key alone where values differ from material to
/// material.
fn shown(value: &Value, fate: Fate) -> String {
    match fate {
        Fate::Judged(_) => format!("{} {}", value.key, value.text.escape_ascii()),
        _ => value.key.escape_default().to_string(),
    }
}
