//! Layers of a picture as arrays, and back.

use crate::errors::value_error;
use numpy::ndarray::{Array2, Array3, ArrayD};
use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use raystream::image::{Channel, LayeredImage};

/// What the layer of the colours is called, whose channels have no prefix.
pub const COLOR: &str = "color";

/// A layer: its name, and its channels by their places in the picture.
struct Layer {
    name: String,
    channels: Vec<usize>,
}

/// The layers of a picture, in the order of their first channels. Channels that make no layer of
/// one or three numbers are layers by themselves, under their own names.
fn layers_of(image: &LayeredImage) -> Vec<Layer> {
    let mut layers: Vec<Layer> = Vec::new();
    for (index, channel) in image.channels.iter().enumerate() {
        let name = channel.name.rsplit_once('.').map_or(COLOR, |(layer, _)| layer);
        match layers.iter_mut().find(|layer| layer.name == name) {
            Some(layer) => layer.channels.push(index),
            None => layers.push(Layer { name: name.to_owned(), channels: vec![index] }),
        }
    }
    layers.into_iter().flat_map(|layer| whole(layer, image)).collect()
}

/// The layer with its channels in order, if they are what a layer has; else one for each channel.
fn whole(layer: Layer, image: &LayeredImage) -> Vec<Layer> {
    let suffix = |index: usize| {
        let name = image.channels[index].name.as_str();
        name.rsplit_once('.').map_or(name, |(_, suffix)| suffix)
    };
    let find = |wanted: &str| layer.channels.iter().copied().find(|&at| suffix(at) == wanted);
    for components in [["R", "G", "B"], ["X", "Y", "Z"]] {
        let found: Option<Vec<usize>> = components.iter().map(|wanted| find(wanted)).collect();
        if let Some(channels) = found.filter(|found| found.len() == layer.channels.len()) {
            return vec![Layer { channels, ..layer }];
        }
    }
    if layer.channels.len() == 1 && layer.name != COLOR {
        return vec![layer];
    }
    let alone = |&at: &usize| Layer { name: image.channels[at].name.clone(), channels: vec![at] };
    layer.channels.iter().map(alone).collect()
}

/// The names of a picture's layers.
pub fn names(image: &LayeredImage) -> Vec<String> {
    layers_of(image).into_iter().map(|layer| layer.name).collect()
}

/// A layer as an array: (height, width), or (height, width, 3).
pub fn array<'py>(
    py: Python<'py>,
    image: &LayeredImage,
    name: &str,
) -> Option<Bound<'py, PyArrayDyn<f32>>> {
    let layer = layers_of(image).into_iter().find(|layer| layer.name == name)?;
    Some(values(image, &layer).into_pyarray(py))
}

/// All layers by their names.
pub fn dictionary<'py>(py: Python<'py>, image: &LayeredImage) -> PyResult<Bound<'py, PyDict>> {
    let dictionary = PyDict::new(py);
    for layer in layers_of(image) {
        dictionary.set_item(&layer.name, values(image, &layer).into_pyarray(py))?;
    }
    Ok(dictionary)
}

fn values(image: &LayeredImage, layer: &Layer) -> ArrayD<f32> {
    let (height, width) = (image.height as usize, image.width as usize);
    let channels: Vec<&[f32]> =
        layer.channels.iter().map(|&at| image.channels[at].values.as_slice()).collect();
    if let [only] = channels[..] {
        return Array2::from_shape_fn((height, width), |(y, x)| only[y * width + x]).into_dyn();
    }
    let of = |(y, x, c): (usize, usize, usize)| channels[c][y * width + x];
    Array3::from_shape_fn((height, width, channels.len()), of).into_dyn()
}

/// The channels of a layer: an array of any numbers, (height, width) or (height, width, 3).
///
/// # Errors
/// If the array is of another shape, or of another size than `size`.
pub fn channels(
    name: &str,
    array: &Bound<'_, PyAny>,
    size: &mut Option<(usize, usize)>,
) -> PyResult<Vec<Channel>> {
    let numpy = array.py().import("numpy")?;
    let wrong = |what: String| value_error(format!("{name}: {what}"));
    let array = numpy.call_method1("asarray", (array, "float32"))?;
    let array: PyReadonlyArrayDyn<'_, f32> =
        array.cast::<PyArrayDyn<f32>>().map_err(|error| wrong(error.to_string()))?.readonly();
    let shape = array.shape();
    let (found, count) = match *shape {
        [height, width] => ((height, width), 1),
        [height, width, 3] => ((height, width), 3),
        _ => {
            let what = "should have the shape (height, width) or (height, width, 3)";
            return Err(wrong(format!("has the shape {shape:?}, but {what}")));
        }
    };
    if u32::try_from(found.0).is_err() || u32::try_from(found.1).is_err() {
        return Err(wrong("is too large for a picture".to_owned()));
    }
    let &mut whole = size.get_or_insert(found);
    if found != whole {
        let (height, width) = whole;
        return Err(wrong(format!(
            "is {} high and {} wide, but the other layers are {height} and {width}",
            found.0, found.1
        )));
    }
    let values: Vec<f32> = array.as_array().iter().copied().collect();
    let of = |component: usize| values.iter().skip(component).step_by(count).copied().collect();
    let named = channel_names(name, count).into_iter().enumerate();
    Ok(named.map(|(component, name)| Channel { name, values: of(component) }).collect())
}

/// What the channels of a layer are called, as Raystream's own files call them.
fn channel_names(layer: &str, count: usize) -> Vec<String> {
    let suffixes: &[&str] = match (layer, count) {
        ("normal" | "position", 3) => &["X", "Y", "Z"],
        (_, 3) => &["R", "G", "B"],
        ("depth", _) => &["Z"],
        ("samples", _) => &["N"],
        // A channel by itself has its own name.
        (_, _) if layer.contains('.') => return vec![layer.to_owned()],
        (_, _) => &["V"],
    };
    let prefix = if layer == COLOR { String::new() } else { format!("{layer}.") };
    suffixes.iter().map(|suffix| format!("{prefix}{suffix}")).collect()
}
