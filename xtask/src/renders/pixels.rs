//! The pixels of an EXR file, as a digest.

use crate::digest::hexadecimal;
use anyhow::{Context, Result};
use exr::prelude::{AnyChannel, FlatSamples, ReadChannels, ReadLayers, read};
use sha2::{Digest, Sha256};
use std::path::Path;

/// The SHA-256 of what every channel of every layer is called and of the bits of its values. The
/// header, which has times, and the way in which pixels are stored are not part of it.
pub fn sha256(path: &Path) -> Result<String> {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .non_parallel()
        .from_file(path)
        .with_context(|| format!("cannot read {}", path.display()))?;
    let mut channels = Vec::new();
    for layer in &image.layer_data {
        let name = layer.attributes.layer_name.as_ref().map(ToString::to_string);
        for channel in &layer.channel_data.list {
            channels.push((name.clone().unwrap_or_default(), layer.size, channel));
        }
    }
    channels.sort_by_key(|(layer, _, channel)| (layer.clone(), channel.name.to_string()));
    let mut hash = Sha256::new();
    for (layer, size, channel) in channels {
        hash.update(format!("{layer}\0{}\0{}x{}\0", channel.name, size.0, size.1));
        hash_values(&mut hash, channel);
    }
    Ok(hexadecimal(&hash.finalize()))
}

fn hash_values(hash: &mut Sha256, channel: &AnyChannel<FlatSamples>) {
    match &channel.sample_data {
        FlatSamples::F16(values) => {
            hash.update("f16");
            values.iter().for_each(|value| hash.update(value.to_bits().to_le_bytes()));
        }
        FlatSamples::F32(values) => {
            hash.update("f32");
            values.iter().for_each(|value| hash.update(value.to_bits().to_le_bytes()));
        }
        FlatSamples::U32(values) => {
            hash.update("u32");
            values.iter().for_each(|value| hash.update(value.to_le_bytes()));
        }
    }
}
