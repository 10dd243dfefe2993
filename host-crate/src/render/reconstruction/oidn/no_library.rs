//! Open Image Denoise where programs cannot load libraries: it is not there.

/// The environment variable that names the library, where programs can load one.
pub const VARIABLE: &str = "RAYSTREAM_OIDN";

/// The library, which nobody can have.
pub enum Oidn2 {}

/// A picture's images, each of as many pixels of three components.
#[expect(dead_code, reason = "nobody can have a library that reads them")]
pub struct Images<'a> {
    pub width: u32,
    pub height: u32,
    pub color: &'a [[f32; 3]],
    /// Albedo and normal.
    pub features: Option<[&'a [[f32; 3]]; 2]>,
}

impl Oidn2 {
    /// Says why it cannot be loaded.
    pub fn load() -> Result<Self, String> {
        Err("programs load no libraries on this platform".into())
    }

    pub fn filter(&self, _: &Images<'_>) -> Result<Vec<[f32; 3]>, String> {
        match *self {}
    }
}
