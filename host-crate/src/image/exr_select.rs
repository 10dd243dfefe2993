//! Which channels of an EXR file are the picture.

use super::ImageError;
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
}

/// Red, green and blue: the plain channels if some part has them, else those of a layer.
pub(super) fn select_color(path: &Path, headers: &[Header]) -> Result<Selection, ImageError> {
    let mut best: Option<(u32, Selection)> = None;
    for (part, header) in headers.iter().enumerate() {
        let names: Vec<String> = header.channels.list.iter().map(|c| string(&c.name)).collect();
        for red in &names {
            let Some(layer) = red.strip_suffix('R').filter(|l| l.is_empty() || l.ends_with('.'))
            else {
                continue;
            };
            let find = |component: &str| {
                names.iter().position(|n| n.strip_prefix(layer) == Some(component))
            };
            let (Some(r), Some(g), Some(b)) = (find("R"), find("G"), find("B")) else { continue };
            let name = match layer.strip_suffix('.') {
                Some(layer) => layer.to_owned(),
                None => header.own_attributes.layer_name.as_ref().map(string).unwrap_or_default(),
            };
            let last = name.rsplit('.').next().unwrap_or_default().to_lowercase();
            let main = name.is_empty() || MAIN_LAYERS.contains(&last.as_str());
            let rank = 2 * u32::from(!main) + u32::from(!layer.is_empty());
            if best.as_ref().is_none_or(|(other, _)| rank < *other) {
                best = Some((rank, Selection { part, channels: vec![r, g, b] }));
            }
        }
    }
    best.map(|(_, selection)| selection).ok_or_else(|| {
        let names: Vec<String> =
            headers.iter().flat_map(|h| &h.channels.list).map(|c| string(&c.name)).collect();
        ImageError::NoColor { path: path.to_owned(), channels: names.join(", ") }
    })
}

/// A text of the file, as UTF-8.
pub(super) fn string(text: &Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}

#[cfg(test)]
mod tests {
    use super::super::{Channel, LayeredImage, read_color, write_layers};
    use super::*;
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
        write_layers(&path, &with_channels(&["Y", "x.R", "y.G", "y.B"]), &[]).unwrap();
        let error = read_color(&path).unwrap_err();
        assert!(
            matches!(error, ImageError::NoColor { .. }) && error.to_string().contains("x.R"),
            "{error}"
        );
    }
}
