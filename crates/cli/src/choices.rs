//! Enums of the library as values of options.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use raystream::image::ToneMap;
use raystream::names::UnknownName;
use raystream::render::{
    AllocatorKind, BvhQuality, Estimator, FilterKind, IntegratorKind, PixelFilterShape,
};
use raystream::scene::Instancing;
use std::str::FromStr;

/// An enum of the library, with what `--help` says of each value.
pub trait Choice: FromStr<Err = UnknownName> + Copy + Send + Sync + 'static {
    /// Every value.
    const ALL: &'static [Self];

    /// What the value is called.
    fn name(self) -> &'static str;

    /// What the value means.
    fn help(self) -> &'static str;
}

/// Reads a value by its name.
pub fn choice<T: Choice>() -> impl TypedValueParser<Value = T> {
    let values = T::ALL.iter().map(|value| PossibleValue::new(value.name()).help(value.help()));
    PossibleValuesParser::new(values).try_map(|name| name.parse::<T>())
}

macro_rules! choices {
    ($kind:ident { $($value:ident: $help:literal,)+ }) => {
        impl Choice for $kind {
            const ALL: &'static [Self] = $kind::ALL;

            fn name(self) -> &'static str {
                $kind::name(self)
            }

            fn help(self) -> &'static str {
                match self {
                    $(Self::$value => $help,)+
                }
            }
        }
    };
}

choices! {
    Instancing {
        Auto: "Repeated while they have at most 2^20 triangles together, else kept once",
        Always: "Kept once in memory; rays take longer",
        Never: "Repeated",
    }
}

choices! {
    AllocatorKind {
        Uniform: "Every pixel equally",
        Paper: "Streams of pixels whose error exceeds random thresholds (Podee et al.)",
        Atomic: "In proportion to the error, slots and sums by atomics (Podee et al., equation 2)",
        Runs: "In proportion to the error, each pixel a run of consecutive slots",
    }
}

choices! {
    Estimator {
        Auto: "The squared difference from the picture after the filter auto",
        AxisAligned: "Rates that follow from how far what throws light or shadow on a pixel is \
                      (Mehta et al.)",
        Bilateral: "The squared difference from the picture after a joint bilateral filter (Podee \
                    et al.)",
        Features: "Likewise, after the filter features",
        Gem: "Likewise, after the filter gem",
        Halves: "The squared difference of the means over two halves of the samples",
        Learned: "Likewise, after the filter learned",
        Manifolds: "Likewise, after the filter manifolds",
        Nfor: "Likewise, after the filter nfor",
        Nlm: "Likewise, after the filter nlm",
        Variance: "The variance of the pixel's mean",
    }
}

choices! {
    FilterKind {
        Auto: "bilateral and learned, mixed in each pixel as an estimate of the error says is best",
        AxisAligned: "Gaussians in world distance, as wide as what throws light or shadow is far",
        Bilateral: "A joint bilateral filter: compares what the camera sees, and colours",
        Features: "Non-local means that compare patches and what the camera sees, in three ways, \
                   mixed likewise",
        Gem: "The widest Gaussian that pays in each pixel; by colours alone, fast",
        Learned: "A joint bilateral filter, whose parameters a small network sets for each pixel",
        Manifolds: "A wide joint bilateral filter, by a few manifolds: compares what the camera \
                    sees",
        Nfor: "Planes in what the camera sees, fitted with weights as of nlm; slow",
        Nlm: "Non-local means: compares patches of the picture's halves",
        Oidn: "Open Image Denoise 2, where it is installed (a library; RAYSTREAM_OIDN names it)",
    }
}

choices! {
    IntegratorKind {
        Auto: "The faster one of two that make the same picture: regeneration on a GPU, \
               megakernel on the CPU",
        Megakernel: "One thread walks one path to its end",
        Compaction: "All paths advance by a segment at a time; after each, stream compaction \
                     removes those that have ended",
        Regeneration: "A fixed number of threads, each of which takes the next sample as soon as \
                       its path has ended",
        Streaming: "A pool of paths that advance by a segment at a time; stream compaction \
                    removes those that have ended, and the next samples take their places",
        Lvc: "Bidirectional: paths from the lights leave vertices in a cache, to which paths from \
              the camera connect",
    }
}

choices! {
    PixelFilterShape {
        Box: "The pixel itself, or a larger square: the same everywhere in it",
        Tent: "Falls off in a straight line, along both axes",
        Gaussian: "A normal distribution, whose standard deviation is a sixth of the width",
        BlackmanHarris: "Blackman and Harris's window: sharper than gaussian, and as smooth",
    }
}

choices! {
    ToneMap {
        Soft: "True colours up to 0.8; brighter ones are compressed and fade to white, keeping \
               their hue",
        Clip: "True colours up to 1, each component cut off there",
        Aces: "The contrast of film: darker shadows, an S-curve (ACES, as fitted by Narkowicz)",
    }
}

choices! {
    BvhQuality {
        Fast: "Milliseconds",
        High: "Faster rays",
    }
}
