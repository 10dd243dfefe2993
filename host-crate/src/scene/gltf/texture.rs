//! Textures and the pictures that they show.

use super::document::Document;
use super::extensions::{WEBP, is_in_ktx2};
use crate::scene::error::SceneError;
use crate::scene::options::LoadOptions;
use crate::scene::picture::{self, Pictures};
use crate::scene::source::Source;
use crate::scene::summary::{Fate, Summary};
use crate::scene::texture::{TextureFilter, TextureId, Wrap};
use gltf::json::Value;
use gltf::json::texture::{MagFilter, Sampler, WrappingMode};
use gltf::json::validation::Checked::{self, Valid};
use std::path::PathBuf;

/// The textures of a file as they are read.
pub(super) struct Textures<'a> {
    pub pictures: Pictures,
    document: &'a Document<'a>,
    source: &'a dyn Source,
    options: LoadOptions,
}

impl<'a> Textures<'a> {
    pub(super) fn new(
        document: &'a Document<'a>,
        source: &'a dyn Source,
        options: &LoadOptions,
    ) -> Self {
        Self { pictures: Pictures::new(options), document, source, options: options.clone() }
    }

    /// The texture `index`, which `place` names for a `material`; none, with a note, if its picture
    /// is missing or cannot be read.
    pub(super) fn load(
        &mut self,
        index: usize,
        place: &str,
        material: &str,
        summary: &mut Summary,
    ) -> Result<Option<TextureId>, SceneError> {
        let document = self.document;
        let texture = document.get(&document.root.textures, index, "textures", place)?;
        let here = format!("textures[{index}]");
        let webp = texture.extensions.as_ref().and_then(|all| all.others.get(WEBP));
        let image = match webp.and_then(|webp| webp.get("source")).and_then(Value::as_u64) {
            Some(image) => usize::try_from(image).unwrap_or(usize::MAX),
            // So the crate says that there is none.
            None if texture.source.value() == u32::MAX as usize => {
                let kind = match is_in_ktx2(texture) {
                    true => "KTX2, which is not read: export PNG, JPEG or WebP",
                    false => "of a kind that is not read",
                };
                let thing = format!("{here} ({kind})");
                summary.note(document.path, 0, Fate::MissingTexture, &thing, material);
                return Ok(None);
            }
            None => texture.source.value(),
        };
        let sampler = match texture.sampler {
            Some(sampler) => {
                let place = format!("{here}.sampler");
                document.get(&document.root.samplers, sampler.value(), "samplers", &place)?.clone()
            }
            None => Sampler::default(),
        };
        let filter = match sampler.mag_filter {
            Some(Valid(MagFilter::Nearest)) => TextureFilter::Nearest,
            _ => TextureFilter::Linear,
        };
        let wrap = [sampler.wrap_s, sampler.wrap_t].map(|mode| self.wrap(mode, &here));
        let [across, down] = wrap;
        let sampler = picture::Sampler { wrap: [across?, down?], filter };
        self.picture(image, sampler, &here, material, summary)
    }

    fn wrap(&self, mode: Checked<WrappingMode>, place: &str) -> Result<Wrap, SceneError> {
        match mode {
            Valid(WrappingMode::Repeat) => Ok(Wrap::Repeat),
            Valid(WrappingMode::ClampToEdge) => Ok(Wrap::Clamp),
            Valid(WrappingMode::MirroredRepeat) => Ok(Wrap::Mirror),
            Checked::Invalid => {
                Err(self.document.wrong(place, "has a sampler of no known wrap mode"))
            }
        }
    }

    fn picture(
        &mut self,
        index: usize,
        sampler: picture::Sampler,
        place: &str,
        material: &str,
        summary: &mut Summary,
    ) -> Result<Option<TextureId>, SceneError> {
        let (document, source) = (self.document, self.source);
        let image = document.get(&document.root.images, index, "images", place)?;
        let here = format!("images[{index}]");
        let limit = self.options.picture_bytes();
        let mut missing = None;
        let read = || {
            if let Some(view) = image.buffer_view {
                return document.view(view.value(), &here).map(|(bytes, _)| bytes.to_vec());
            }
            let uri = image.uri.as_deref().unwrap_or_default();
            document.resource(source, uri, limit, &format!("{here}.uri"))?.map_err(|wanted| {
                missing = Some(wanted.clone());
                SceneError::Missing { path: document.path.to_owned(), key: here.clone(), wanted }
            })
        };
        let loaded = self.pictures.load_by(&self.name(index), sampler, read);
        let mut note = |fate, thing: &str| summary.note(document.path, 0, fate, thing, material);
        match (loaded, missing) {
            (Ok(texture), _) => Ok(Some(texture)),
            (Err(_), Some(wanted)) => {
                note(Fate::MissingTexture, &wanted.display().to_string());
                Ok(None)
            }
            (Err(error @ SceneError::TooManyTexels { .. }), None) => Err(error),
            (Err(error), None) => {
                note(Fate::UnreadableTexture, &error.to_string());
                Ok(None)
            }
        }
    }

    /// What a picture is called in messages.
    fn name(&self, index: usize) -> PathBuf {
        let uri = self.document.root.images[index].uri.as_deref();
        match uri.filter(|uri| !uri.starts_with("data:")) {
            Some(uri) => self.document.folder.join(uri),
            None => format!("{}, images[{index}]", self.document.path.display()).into(),
        }
    }
}
