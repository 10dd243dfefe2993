//! The textures that a scene file gives a material.

use crate::scene::json::values::{Colour, Height, Object, Slope, present};
use crate::scene::rule::{Slot, TextureFile};
use crate::scene::texture::TextureFilter;
use serde::de::{MapAccess, SeqAccess, Visitor, value};
use serde::{Deserialize, Deserializer};
use std::path::PathBuf;

/// The reflectance of a diffuse material: one colour, or the picture in the given file.
#[derive(Debug)]
pub(super) enum Albedo {
    Colour(Colour),
    Texture(TextureFile),
}

impl<'de> Deserialize<'de> for Albedo {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ColourOrTexture;

        impl<'de> Visitor<'de> for ColourOrTexture {
            type Value = Albedo;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("[red, green, blue] or {\"texture\": file}")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Albedo, A::Error> {
                Colour::deserialize(value::SeqAccessDeserializer::new(values)).map(Albedo::Colour)
            }

            fn visit_map<A: MapAccess<'de>>(self, keys: A) -> Result<Albedo, A::Error> {
                #[derive(Deserialize)]
                #[serde(deny_unknown_fields)]
                struct TextureKeys {
                    texture: String,
                    #[serde(default)]
                    filter: FilterKey,
                }
                let keys = TextureKeys::deserialize(value::MapAccessDeserializer::new(keys))?;
                let path = PathBuf::from(keys.texture);
                Ok(Albedo::Texture(texture_file(Slot::Colour, path, keys.filter)))
            }
        }

        deserializer.deserialize_any(ColourOrTexture)
    }
}

/// The textures of a principled material beside that of its reflectance.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TextureKeys {
    #[serde(default, deserialize_with = "present")]
    roughness: Option<Object<ChannelKeys>>,
    #[serde(default, deserialize_with = "present")]
    metallic: Option<Object<ChannelKeys>>,
    #[serde(default, deserialize_with = "present")]
    normal: Option<Object<NormalKeys>>,
    #[serde(default, deserialize_with = "present")]
    bump: Option<Object<BumpKeys>>,
    #[serde(default, deserialize_with = "present")]
    emission: Option<Object<FileKeys>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ChannelKeys {
    file: PathBuf,
    channel: TextureChannel,
    #[serde(default)]
    filter: FilterKey,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum TextureChannel {
    Red,
    Green,
    Blue,
    Alpha,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NormalKeys {
    file: PathBuf,
    #[serde(default, deserialize_with = "present")]
    scale: Option<Slope>,
    #[serde(default)]
    filter: FilterKey,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BumpKeys {
    file: PathBuf,
    height: Height,
    #[serde(default)]
    filter: FilterKey,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileKeys {
    file: PathBuf,
    #[serde(default)]
    filter: FilterKey,
}

/// What is seen between texels.
#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum FilterKey {
    #[default]
    Linear,
    Nearest,
}

/// A texture that a scene file names.
fn texture_file(slot: Slot, path: PathBuf, filter: FilterKey) -> TextureFile {
    let filter = match filter {
        FilterKey::Linear => TextureFilter::Linear,
        FilterKey::Nearest => TextureFilter::Nearest,
    };
    TextureFile { slot, line: 0, path, filter }
}

/// The key within a material that names the file of a texture.
pub(in crate::scene::json) fn key_of(slot: Slot) -> &'static str {
    match slot {
        Slot::Colour => "reflectance.texture",
        Slot::Roughness(_) => "textures.roughness.file",
        Slot::Metallic(_) => "textures.metallic.file",
        Slot::Normal(_) => "textures.normal.file",
        Slot::Bump(_) => "textures.bump.file",
        Slot::Emission => "textures.emission.file",
    }
}

impl TextureKeys {
    /// All of them.
    pub fn files(self) -> impl Iterator<Item = TextureFile> {
        let channel = |slot: fn(u32) -> Slot| {
            move |Object(ChannelKeys { file, channel, filter })| {
                texture_file(slot(channel as u32), file, filter)
            }
        };
        let normal = self.normal.map(|Object(NormalKeys { file, scale, filter })| {
            texture_file(Slot::Normal(scale.map_or(1.0, |Slope(scale)| scale)), file, filter)
        });
        let bump = self.bump.map(|Object(BumpKeys { file, height: Height(height), filter })| {
            texture_file(Slot::Bump(height), file, filter)
        });
        let emission = self
            .emission
            .map(|Object(FileKeys { file, filter })| texture_file(Slot::Emission, file, filter));
        [
            self.roughness.map(channel(Slot::Roughness)),
            self.metallic.map(channel(Slot::Metallic)),
            normal,
            bump,
            emission,
        ]
        .into_iter()
        .flatten()
    }
}
