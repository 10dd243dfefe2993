//! What the page asks and is answered, as JSON: a question is an object whose key `ask` says which
//! it is, an answer an object of its own for each, or `{"error": "..."}`.

use crate::method::Choice;
use crate::webgpu::Facts;
use raystream::names::UnknownName;
use raystream::scene::FilmSize;
use raystream_view::choices::{Choices, Stops};
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// A question.
#[derive(Debug, Deserialize)]
#[serde(tag = "ask", rename_all = "snake_case", deny_unknown_fields)]
pub enum Question {
    /// What can be chosen.
    Known,
    /// Puts a scene on the page: one that ships, or a file that was given before.
    Open {
        /// Its name.
        scene: String,
        /// How it is rendered.
        choices: Chosen,
    },
    /// Which of the files that were given is the scene.
    Found,
    /// Renders otherwise.
    Choose {
        /// How.
        choices: Chosen,
    },
    /// Moves the camera.
    Move(Motion),
    /// Ends a movement.
    Rest,
    /// Renders for a time.
    Render {
        /// How long, about.
        milliseconds: u32,
    },
    /// Paints a layer.
    Paint {
        /// Its name.
        layer: String,
        /// Brighter by so many stops.
        #[serde(default)]
        exposure: f32,
    },
    /// What is known of a pixel.
    Inspect {
        /// From the left.
        x: u32,
        /// From the top.
        y: u32,
    },
    /// Begins a render whose rounds are looked at, beside the page's.
    Method {
        /// The scene, as in [`Question::Open`].
        scene: String,
        /// How it is rendered.
        choices: MethodChosen,
    },
    /// Renders a round of it, and shows its stages.
    Round,
    /// Makes known a GPU that the page has opened.
    Gpu(Facts),
    /// Computes on another device from now on. What is open is closed.
    Device {
        /// Which.
        name: DeviceName,
    },
    /// What kernels compute in small renders, as digests.
    Digests {
        /// The scene, one that ships.
        scene: String,
    },
}

/// What there is to compute on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DeviceName {
    /// The CPU, by WebAssembly.
    Cpu,
    /// The GPU that was made known, by WebGPU.
    WebGpu,
}

/// A movement of the camera; those left out do nothing.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Motion {
    /// Around what is in the middle: to the right and down, in radians.
    pub orbit: [f64; 2],
    /// Across the view: to the right and down, in parts of the picture's height.
    pub pan: [f64; 2],
    /// So many times as near.
    pub zoom: Option<f64>,
    /// Back to the scene's own camera, before all else.
    pub reset: bool,
}

/// What a person chooses of a render, by names.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Chosen {
    /// Width of the picture in pixels, whose shape is the scene's; the scene's own without it.
    pub width: Option<u32>,
    /// Who decides which pixels are sampled.
    pub allocator: String,
    /// What the error of a pixel is taken to be.
    pub estimator: String,
    /// What takes the noise out, if anything.
    pub filter: Option<String>,
    /// How paths are computed.
    pub integrator: String,
    /// Whether dark places count as much as bright ones.
    pub relative: bool,
    /// Renders with different seeds are independent.
    pub seed: u32,
    /// Samples a pixel at which the render ends.
    pub samples: Option<u32>,
}

/// Pixels of a side at most: WebAssembly has 4 GiB of memory, and one thread.
pub const LARGEST_SIDE: u32 = 2048;

impl Chosen {
    /// The choices that these names mean.
    ///
    /// # Errors
    /// If a name is none; the message has all that there are.
    pub fn choices(&self) -> Result<Choices, UnknownName> {
        Ok(Choices {
            allocator: named(&self.allocator)?,
            estimator: named(&self.estimator)?,
            filter: self.filter.as_deref().map(named).transpose()?,
            integrator: named(&self.integrator)?,
            relative: self.relative,
            seed: self.seed,
        })
    }

    /// When the render ends.
    pub fn stops(&self) -> Stops {
        Stops { samples: self.samples.map(|samples| samples.max(1)), ..Stops::default() }
    }

    /// The size of the picture of a scene that would be `whole` by itself.
    ///
    /// # Errors
    /// If a side is 0 or longer than [`LARGEST_SIDE`].
    pub fn size(&self, whole: FilmSize) -> Result<FilmSize, String> {
        in_shape(self.width.unwrap_or(whole.width), whole, LARGEST_SIDE)
    }
}

/// What a reader chooses of a render whose rounds are looked at, by names.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MethodChosen {
    /// Width of the picture in pixels, whose shape is the scene's.
    pub width: u32,
    /// Who decides which pixels are sampled.
    pub allocator: String,
    /// What the error of a pixel is taken to be.
    pub estimator: String,
    /// Whether dark places count as much as bright ones.
    pub relative: bool,
    /// Samples of a round, on average over the pixels.
    pub budget: f32,
    /// Whether the CPU does beside a GPU what that does, to be compared.
    #[serde(default)]
    pub beside: bool,
}

/// Pixels of a side at most where rounds are looked at: all that kernels write is kept.
pub const LARGEST_SHOWN_SIDE: u32 = 512;
/// [`MethodChosen::budget`] at most: 2^22 slots fit a stream.
pub const LARGEST_BUDGET: f32 = 16.0;

impl MethodChosen {
    /// The choice that these names mean, for a scene whose picture would be `whole` by itself.
    ///
    /// # Errors
    /// What is no name, size or budget.
    pub fn choice(&self, whole: FilmSize) -> Result<Choice, String> {
        if !(self.budget > 0.0 && self.budget <= LARGEST_BUDGET) {
            let budget = self.budget;
            return Err(format!(
                "a budget of {budget} samples a pixel: above 0, at most {LARGEST_BUDGET}"
            ));
        }
        Ok(Choice {
            size: in_shape(self.width, whole, LARGEST_SHOWN_SIDE)?,
            allocator: named(&self.allocator).map_err(|error| error.to_string())?,
            estimator: named(&self.estimator).map_err(|error| error.to_string())?,
            relative: self.relative,
            budget: self.budget,
            seed: 0,
        })
    }
}

/// A size of this width in the shape of `whole`.
fn in_shape(width: u32, whole: FilmSize, largest: u32) -> Result<FilmSize, String> {
    let shape = f64::from(whole.height) / f64::from(whole.width);
    let height = (f64::from(width) * shape).round().max(1.0) as u32;
    if [width, height].iter().any(|side| !(1..=largest).contains(side)) {
        return Err(format!(
            "a picture of {width} x {height} pixels: sides are 1 to {largest} here"
        ));
    }
    Ok(FilmSize { width, height })
}

fn named<T: FromStr<Err = UnknownName>>(name: &str) -> Result<T, UnknownName> {
    name.parse()
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream::render::{AllocatorKind, FilterKind};

    fn chosen(text: &str) -> Chosen {
        serde_json::from_str(text).unwrap()
    }

    const TEXT: &str = r#"{"width": 32, "allocator": "paper", "estimator": "halves",
        "filter": "nlm", "integrator": "lvc", "relative": true, "seed": 3, "samples": 0}"#;

    #[test]
    fn choices_are_what_is_named() {
        let chosen = chosen(TEXT);
        let choices = chosen.choices().unwrap();
        assert_eq!(choices.allocator, AllocatorKind::Paper);
        assert_eq!(choices.filter, Some(FilterKind::Nlm));
        assert!(choices.relative);
        assert_eq!((choices.seed, chosen.stops().samples), (3, Some(1)));
        let whole = FilmSize { width: 80, height: 60 };
        assert_eq!(chosen.size(whole), Ok(FilmSize { width: 32, height: 24 }));
        assert_eq!(Chosen { width: None, ..chosen }.size(whole), Ok(whole));
    }

    #[test]
    fn what_is_no_name_or_size_is_an_error_that_says_so() {
        let wrong = Chosen { allocator: "fair".to_owned(), ..chosen(TEXT) };
        let message = wrong.choices().unwrap_err().to_string();
        assert!(message.contains("'fair'") && message.contains("uniform"), "{message}");
        let whole = FilmSize { width: 800, height: 600 };
        for width in [0, LARGEST_SIDE + 1, u32::MAX] {
            let wrong = Chosen { width: Some(width), ..chosen(TEXT) };
            assert!(wrong.size(whole).unwrap_err().contains("2048"), "{width}");
        }
        let tall = Chosen { width: Some(LARGEST_SIDE), ..chosen(TEXT) };
        assert!(tall.size(FilmSize { width: 1, height: 2 }).is_err());
    }

    #[test]
    fn a_choice_of_the_method_is_what_is_named_or_an_error() {
        let chosen = MethodChosen {
            width: 40,
            allocator: "paper".to_owned(),
            estimator: "halves".to_owned(),
            relative: true,
            budget: 0.5,
            beside: false,
        };
        let whole = FilmSize { width: 80, height: 60 };
        let choice = chosen.choice(whole).unwrap();
        assert_eq!(choice.size, FilmSize { width: 40, height: 30 });
        assert_eq!((choice.allocator, choice.budget), (AllocatorKind::Paper, 0.5));
        for budget in [0.0, -1.0, 17.0, f32::NAN, f32::INFINITY] {
            let wrong = MethodChosen { budget, ..chosen.clone() };
            assert!(wrong.choice(whole).unwrap_err().contains("budget"), "{budget}");
        }
        let wrong = MethodChosen { estimator: "guess".to_owned(), ..chosen.clone() };
        assert!(wrong.choice(whole).unwrap_err().contains("'guess'"));
        assert!(MethodChosen { width: 513, ..chosen }.choice(whole).unwrap_err().contains("512"));
    }

    #[test]
    fn questions_have_no_unknown_keys() {
        let question = |text: &str| serde_json::from_str::<Question>(text);
        assert!(matches!(question(r#"{"ask": "known"}"#), Ok(Question::Known)));
        let motion = question(r#"{"ask": "move", "orbit": [0.5, -1], "zoom": 2}"#);
        let Ok(Question::Move(Motion { orbit, zoom, reset, .. })) = motion else {
            panic!("{motion:?}")
        };
        assert_eq!((orbit, zoom, reset), ([0.5, -1.0], Some(2.0), false));
        for wrong in [r#"{"ask": "?"}"#, r#"{"ask": "move", "spin": 1}"#, "", "[]"] {
            assert!(question(wrong).is_err(), "{wrong}");
        }
    }
}
