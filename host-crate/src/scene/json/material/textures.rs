//! The textures that a scene file gives a material.

use super::layout::Layout;
use crate::scene::json::values::{Colour, Height, Object, Slope, present};
use crate::scene::rule::{Slot, TextureFile};
use crate::scene::texture::{CoordinateSet, TextureFilter};
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
                    #[serde(default)]
                    transform: Object<Layout>,
                    #[serde(default)]
                    set: SetKey,
                }
                let keys = TextureKeys::deserialize(value::MapAccessDeserializer::new(keys))?;
                let TextureKeys { texture, filter, transform, set } = keys;
                let path = PathBuf::from(texture);
                Ok(Albedo::Texture(texture_file(Slot::Colour, path, (filter, transform, set))))
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
    #[serde(default, deserialize_with = "present")]
    coat: Option<Object<ChannelKeys>>,
    #[serde(default, deserialize_with = "present")]
    coat_roughness: Option<Object<ChannelKeys>>,
    #[serde(default, deserialize_with = "present")]
    coat_normal: Option<Object<NormalKeys>>,
    #[serde(default, deserialize_with = "present")]
    sheen: Option<Object<FileKeys>>,
    #[serde(default, deserialize_with = "present")]
    sheen_roughness: Option<Object<ChannelKeys>>,
    #[serde(default, deserialize_with = "present")]
    transmission: Option<Object<ChannelKeys>>,
    #[serde(default, deserialize_with = "present")]
    specular: Option<Object<ChannelKeys>>,
    #[serde(default, deserialize_with = "present")]
    specular_colour: Option<Object<FileKeys>>,
    #[serde(default, deserialize_with = "present")]
    anisotropy: Option<Object<FileKeys>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ChannelKeys {
    file: PathBuf,
    channel: TextureChannel,
    #[serde(default)]
    filter: FilterKey,
    #[serde(default)]
    transform: Object<Layout>,
    #[serde(default)]
    set: SetKey,
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
    #[serde(default)]
    transform: Object<Layout>,
    #[serde(default)]
    set: SetKey,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BumpKeys {
    file: PathBuf,
    height: Height,
    #[serde(default)]
    filter: FilterKey,
    #[serde(default)]
    transform: Object<Layout>,
    #[serde(default)]
    set: SetKey,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileKeys {
    file: PathBuf,
    #[serde(default)]
    filter: FilterKey,
    #[serde(default)]
    transform: Object<Layout>,
    #[serde(default)]
    set: SetKey,
}

/// What is seen between texels.
#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum FilterKey {
    #[default]
    Linear,
    Nearest,
}

/// The texture coordinates that a texture takes.
#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum SetKey {
    #[default]
    First,
    Second,
}

/// A texture that a scene file names.
fn texture_file(
    slot: Slot,
    path: PathBuf,
    (filter, Object(Layout(map)), set): (FilterKey, Object<Layout>, SetKey),
) -> TextureFile {
    let set = match set {
        SetKey::First => CoordinateSet::First,
        SetKey::Second => CoordinateSet::Second,
    };
    let filter = match filter {
        FilterKey::Linear => TextureFilter::Linear,
        FilterKey::Nearest => TextureFilter::Nearest,
    };
    TextureFile { slot, line: 0, path, filter, map, set }
}

/// The key within a material that names the file of a texture.
pub(in crate::scene::json) fn key_of(slot: Slot) -> &'static str {
    match slot {
        Slot::Colour | Slot::BaseColour => "reflectance.texture",
        Slot::Roughness(_) => "textures.roughness.file",
        Slot::Metallic(_) => "textures.metallic.file",
        Slot::Normal(_) => "textures.normal.file",
        Slot::Bump(_) => "textures.bump.file",
        Slot::Emission => "textures.emission.file",
        Slot::Coat(_) => "textures.coat.file",
        Slot::CoatRoughness(_) => "textures.coat_roughness.file",
        Slot::CoatNormal(_) => "textures.coat_normal.file",
        Slot::Sheen => "textures.sheen.file",
        Slot::SheenRoughness(_) => "textures.sheen_roughness.file",
        Slot::Transmission(_) => "textures.transmission.file",
        Slot::Specular(_) => "textures.specular.file",
        Slot::SpecularColour => "textures.specular_colour.file",
        Slot::Grain => "textures.anisotropy.file",
    }
}

impl TextureKeys {
    /// All of them.
    pub fn files(self) -> impl Iterator<Item = TextureFile> {
        let share = |slot: fn(u32) -> Slot| {
            move |Object(ChannelKeys { file, channel, filter, transform, set })| {
                texture_file(slot(channel as u32), file, (filter, transform, set))
            }
        };
        let normals = |slot: fn(f32) -> Slot| {
            move |Object(NormalKeys { file, scale, filter, transform, set })| {
                let scale = scale.map_or(1.0, |Slope(scale)| scale);
                texture_file(slot(scale), file, (filter, transform, set))
            }
        };
        let plain = |slot: Slot| {
            move |Object(FileKeys { file, filter, transform, set })| {
                texture_file(slot, file, (filter, transform, set))
            }
        };
        let bump = |Object(keys)| {
            let BumpKeys { file, height: Height(height), filter, transform, set } = keys;
            texture_file(Slot::Bump(height), file, (filter, transform, set))
        };
        [
            self.roughness.map(share(Slot::Roughness)),
            self.metallic.map(share(Slot::Metallic)),
            self.normal.map(normals(Slot::Normal)),
            self.bump.map(bump),
            self.emission.map(plain(Slot::Emission)),
            self.coat.map(share(Slot::Coat)),
            self.coat_roughness.map(share(Slot::CoatRoughness)),
            self.coat_normal.map(normals(Slot::CoatNormal)),
            self.sheen.map(plain(Slot::Sheen)),
            self.sheen_roughness.map(share(Slot::SheenRoughness)),
            self.transmission.map(share(Slot::Transmission)),
            self.specular.map(share(Slot::Specular)),
            self.specular_colour.map(plain(Slot::SpecularColour)),
            self.anisotropy.map(plain(Slot::Grain)),
        ]
        .into_iter()
        .flatten()
    }
}
