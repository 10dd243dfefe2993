//! Which layers of a file say what: those of Raystream, and what other renderers call theirs.

use crate::image::LayeredImage;
use glam::Vec3;

/// The picture, what is best first. Blender calls what it has not denoised `Noisy Image`.
const COLOR: &[&str] =
    &["noisyimage", "", "rgb", "rgba", "color", "colour", "beauty", "combined", "image", "main"];
/// Cycles: `Denoising Albedo`, `DiffCol`. pbrt: `Albedo`. Mitsuba: as the user says, by its types.
const ALBEDO: &[&str] = &["denoisingalbedo", "albedo", "diffcol"];
/// Cycles: `Denoising Normal`, `Normal`. pbrt: `Ns`, `N`. Mitsuba: `sh_normal`, in its examples
/// `nn`.
const NORMAL: &[&str] = &["denoisingnormal", "normal", "ns", "shnormal", "nn", "n", "geonormal"];
/// Cycles: `Denoising Depth`, `Depth`. Mitsuba: `depth`, in its examples `dd.y`.
const DEPTH: &[&str] = &["denoisingdepth", "depth", "dd", "z"];
/// Positions relative to the camera, as pbrt writes them by default.
const POSITION: &[&str] = &["p"];

/// The layers of a picture.
pub struct Layers<'a> {
    image: &'a LayeredImage,
}

impl<'a> Layers<'a> {
    /// Of `image`.
    pub fn of(image: &'a LayeredImage) -> Self {
        Self { image }
    }

    /// The picture: the mean over all samples, if the file has it apart.
    pub fn color(&self) -> Option<Vec<Vec3>> {
        self.own("plain").or_else(|| self.vectors(COLOR, &["RGB"]))
    }

    /// Mean reflectance of the first surface.
    pub fn albedo(&self) -> Option<Vec<Vec3>> {
        self.vectors(ALBEDO, &["RGB"])
    }

    /// Normals, of any length.
    pub fn normal(&self) -> Option<Vec<Vec3>> {
        self.vectors(NORMAL, &["XYZ", "RGB"])
    }

    /// Distance from the camera.
    pub fn depth(&self) -> Option<Vec<f32>> {
        let named = DEPTH.iter().find_map(|name| {
            ["Z", "V", "Y", "T", "R", ""].iter().find_map(|component| self.find(name, component))
        });
        let position = || {
            let positions = self.vectors(POSITION, &["XYZ"])?;
            Some(positions.into_iter().map(Vec3::length).collect())
        };
        named.map(<[f32]>::to_vec).or_else(position)
    }

    /// Three channels of a layer that Raystream writes.
    pub fn own(&self, layer: &str) -> Option<Vec<Vec3>> {
        let [r, g, b] = ["R", "G", "B"].map(|c| self.image.channel(&format!("{layer}.{c}")));
        zip(r?, g?, b?)
    }

    /// Samples of each pixel, as Raystream writes them.
    pub fn samples(&self) -> Option<&'a [f32]> {
        self.image.channel("samples.N")
    }

    fn vectors(&self, names: &[&str], components: &[&str]) -> Option<Vec<Vec3>> {
        names.iter().find_map(|name| {
            components.iter().find_map(|components| {
                let mut channels = components.split("").filter(|component| !component.is_empty());
                let mut next = || self.find(name, channels.next()?);
                zip(next()?, next()?, next()?)
            })
        })
    }

    /// The channel of a layer, in whichever view or group of layers it is; without a component the
    /// one of that name in none.
    fn find(&self, layer: &str, component: &str) -> Option<&'a [f32]> {
        let fits = |name: &str| {
            let (groups, last) = name.rsplit_once('.').unwrap_or(("", name));
            if component.is_empty() {
                return groups.is_empty() && plain(last) == layer;
            }
            let group = groups.rsplit('.').next().unwrap_or_default();
            last.eq_ignore_ascii_case(component) && plain(group) == layer
        };
        self.image.channels.iter().find(|c| fits(&c.name)).map(|c| c.values.as_slice())
    }
}

/// A name in lower case, of letters and digits alone.
fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

fn zip(x: &[f32], y: &[f32], z: &[f32]) -> Option<Vec<Vec3>> {
    Some(x.iter().zip(y).zip(z).map(|((&x, &y), &z)| Vec3::new(x, y, z)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Channel;

    /// A picture of one pixel, whose channels have the values 0, 1, 2 ... in turn.
    fn image(names: &[&str]) -> LayeredImage {
        let channel =
            |(i, name): (usize, &&str)| Channel { name: (*name).into(), values: vec![i as f32] };
        LayeredImage {
            width: 1,
            height: 1,
            channels: names.iter().enumerate().map(channel).collect(),
        }
    }

    #[test]
    fn layers_of_other_renderers_are_found() {
        let cycles = image(&[
            "ViewLayer.Combined.R",
            "ViewLayer.Combined.G",
            "ViewLayer.Combined.B",
            "ViewLayer.Combined.A",
            "ViewLayer.Denoising Albedo.R",
            "ViewLayer.Denoising Albedo.G",
            "ViewLayer.Denoising Albedo.B",
            "ViewLayer.Denoising Normal.X",
            "ViewLayer.Denoising Normal.Y",
            "ViewLayer.Denoising Normal.Z",
            "ViewLayer.Depth.Z",
            "ViewLayer.Noisy Image.R",
            "ViewLayer.Noisy Image.G",
            "ViewLayer.Noisy Image.B",
        ]);
        let layers = Layers::of(&cycles);
        assert_eq!(layers.color(), Some(vec![Vec3::new(11.0, 12.0, 13.0)]));
        assert_eq!(layers.albedo(), Some(vec![Vec3::new(4.0, 5.0, 6.0)]));
        assert_eq!(layers.normal(), Some(vec![Vec3::new(7.0, 8.0, 9.0)]));
        assert_eq!(layers.depth(), Some(vec![10.0]));

        let pbrt = image(&[
            "R", "G", "B", "Albedo.R", "Albedo.G", "Albedo.B", "P.X", "P.Y", "P.Z", "Ns.X", "Ns.Y",
            "Ns.Z", "N.X", "N.Y", "N.Z", "u", "v",
        ]);
        let layers = Layers::of(&pbrt);
        assert_eq!(layers.color(), Some(vec![Vec3::new(0.0, 1.0, 2.0)]));
        assert_eq!(layers.albedo(), Some(vec![Vec3::new(3.0, 4.0, 5.0)]));
        assert_eq!(layers.normal(), Some(vec![Vec3::new(9.0, 10.0, 11.0)]));
        assert_eq!(layers.depth(), Some(vec![(36_f32 + 49.0 + 64.0).sqrt()]));

        let mitsuba = image(&[
            "color.R", "color.G", "color.B", "albedo.R", "albedo.G", "albedo.B", "dd.y", "nn.X",
            "nn.Y", "nn.Z",
        ]);
        let layers = Layers::of(&mitsuba);
        assert_eq!(layers.color(), Some(vec![Vec3::new(0.0, 1.0, 2.0)]));
        assert_eq!(layers.depth(), Some(vec![6.0]));
        assert_eq!(layers.normal(), Some(vec![Vec3::new(7.0, 8.0, 9.0)]));
    }

    #[test]
    fn what_is_not_there_is_not_made_up() {
        let layers = image(&["R", "G", "B", "depth", "x.normal"]);
        let layers = Layers::of(&layers);
        assert_eq!((layers.albedo(), layers.normal()), (None, None));
        assert_eq!(layers.depth(), Some(vec![3.0]));
        assert_eq!(Layers::of(&image(&["Y", "albedo.R"])).color(), None);
    }
}
