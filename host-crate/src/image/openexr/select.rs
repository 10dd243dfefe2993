//! Which channels of an EXR file are the picture.

use crate::image::ImageError;
use exr::meta::header::Header;
use exr::prelude::Text;
use std::path::Path;

/// Layers that hold the picture itself, should one be chosen among several.
const MAIN_LAYERS: [&str; 8] =
    ["rgb", "rgba", "color", "colour", "beauty", "combined", "image", "main"];

/// What to read of a file.
pub(super) struct Selection {
    /// Index of the part.
    pub part: usize,
    /// Indices into the part's channels.
    pub channels: Vec<usize>,
    /// What they are.
    pub colors: Colors,
}

/// What the selected channels of a picture are; what is read, the best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Colors {
    /// Red, green and blue.
    Rgb,
    /// Luminance, and its chroma channels RY and BY.
    LuminanceChroma,
    /// Luminance alone.
    Luminance,
}

impl Colors {
    const ALL: [Self; 3] = [Self::Rgb, Self::LuminanceChroma, Self::Luminance];

    /// The names of the channels within a layer.
    fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Rgb => &["R", "G", "B"],
            Self::LuminanceChroma => &["Y", "RY", "BY"],
            Self::Luminance => &["Y"],
        }
    }

    /// Names that a layer of such colours has not: where Y is a coordinate.
    fn never_with(self) -> &'static [&'static str] {
        match self {
            Self::Rgb | Self::LuminanceChroma => &[],
            Self::Luminance => &["X", "Z", "x", "z"],
        }
    }
}

/// The colours of the picture: the plain channels if some part has them, else those of a layer;
/// red, green and blue before luminance.
pub(super) fn select_color(path: &Path, headers: &[Header]) -> Result<Selection, ImageError> {
    let mut best: Option<(_, Selection)> = None;
    for (part, header) in headers.iter().enumerate() {
        let names: Vec<String> = header.channels.list.iter().map(|c| string(&c.name)).collect();
        for colors in Colors::ALL {
            for layer in names.iter().filter_map(|name| layer_of(name, colors.channels()[0])) {
                let find = |component: &&str| {
                    names.iter().position(|n| n.strip_prefix(layer) == Some(*component))
                };
                let Some(channels) = colors.channels().iter().map(find).collect() else { continue };
                if colors.never_with().iter().any(|component| find(component).is_some()) {
                    continue;
                }
                let rank = (!is_main(header, layer), colors, !layer.is_empty());
                if best.as_ref().is_none_or(|(other, _)| rank < *other) {
                    best = Some((rank, Selection { part, channels, colors }));
                }
            }
        }
    }
    best.map(|(_, selection)| selection).ok_or_else(|| {
        let names: Vec<String> =
            headers.iter().flat_map(|h| &h.channels.list).map(|c| string(&c.name)).collect();
        ImageError::NoColor { path: path.to_owned(), channels: names.join(", ") }
    })
}

/// What stands before the component in a channel's name: a layer with its dot, or nothing.
fn layer_of<'a>(channel: &'a str, component: &str) -> Option<&'a str> {
    channel.strip_suffix(component).filter(|layer| layer.is_empty() || layer.ends_with('.'))
}

/// Whether a layer is named as the picture usually is.
fn is_main(header: &Header, layer: &str) -> bool {
    let name = match layer.strip_suffix('.') {
        Some(layer) => layer.to_owned(),
        None => header.own_attributes.layer_name.as_ref().map(string).unwrap_or_default(),
    };
    let last = name.rsplit('.').next().unwrap_or_default().to_lowercase();
    name.is_empty() || MAIN_LAYERS.contains(&last.as_str())
}

/// A text of the file, as UTF-8.
pub(super) fn string(text: &Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Channel, LayeredImage, read_color, write_layers};
    use glam::Vec3;

    fn with_channels(names: &[&str]) -> LayeredImage {
        let channels = names.iter().enumerate();
        let channels = channels
            .map(|(i, n)| Channel { name: n.to_string(), values: vec![i as f32] })
            .collect();
        LayeredImage { width: 1, height: 1, channels }
    }

    #[test]
    fn the_main_layer_is_chosen() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        for (names, expected) in [
            (&["albedo.R", "albedo.G", "albedo.B", "R", "G", "B", "A"][..], [3.0, 4.0, 5.0]),
            (
                &["albedo.R", "albedo.G", "albedo.B", "color.R", "color.G", "color.B"],
                [3.0, 4.0, 5.0],
            ),
            (
                &["a.R", "a.G", "a.B", "View.Combined.R", "View.Combined.G", "View.Combined.B"],
                [3.0, 4.0, 5.0],
            ),
            (&["x.B", "x.G", "x.R"], [2.0, 1.0, 0.0]),
            (&["half.R", "whole.R", "whole.G", "whole.B"], [1.0, 2.0, 3.0]),
        ] {
            write_layers(&path, &with_channels(names), &[]).unwrap();
            assert_eq!(read_color(&path).unwrap().pixels, [Vec3::from(expected)], "{names:?}");
        }
        for (names, luminance) in [
            (&["Y"][..], 0.0),
            (&["A", "Y"], 1.0),
            (&["a.R", "a.G", "a.B", "Y"], 3.0),
            (&["albedo.Y", "beauty.Y"], 1.0),
            (&["N.X", "N.Y", "N.Z", "grey.Y"], 3.0),
        ] {
            write_layers(&path, &with_channels(names), &[]).unwrap();
            assert_eq!(read_color(&path).unwrap().pixels, [Vec3::splat(luminance)], "{names:?}");
        }
        for names in [&["Z", "x.R", "y.G", "y.B"][..], &["N.X", "N.Y", "N.Z", "x.R"]] {
            write_layers(&path, &with_channels(names), &[]).unwrap();
            let error = read_color(&path).unwrap_err();
            assert!(
                matches!(error, ImageError::NoColor { .. }) && error.to_string().contains("x.R"),
                "{error}"
            );
        }
    }
}
