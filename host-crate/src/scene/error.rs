//! What can be wrong with a scene.

use std::path::PathBuf;

/// Why a scene could not be loaded. Every message names the file and the place in it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A file is there but cannot be read, or the scene file itself is not there.
    #[error("{}: cannot be read: {}", .path.display(), why(.source))]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file has more content than a scene may have.
    #[error(
        "{}: has more than {}, the most that is read of such a file within the memory that a scene \
         may take", .path.display(), amount(*.limit)
    )]
    TooLong {
        /// The file.
        path: PathBuf,
        /// The most bytes of it that are read.
        limit: u64,
    },
    /// A scene would take more memory than it may.
    #[error(
        "{}, {place}: up to here the scene takes more than {} of memory",
        .path.display(), amount(*.limit)
    )]
    TooLarge {
        /// The file of geometry.
        path: PathBuf,
        /// What is one too many, such as a line.
        place: String,
        /// The memory that it may take, in bytes.
        limit: u64,
    },
    /// A file is of another kind than it should be.
    #[error("{}: {what}", .path.display())]
    WrongKind {
        /// The file.
        path: PathBuf,
        /// What it is, and what it should be.
        what: String,
    },
    /// The scene file is not JSON, or a key is missing, unknown, of the wrong type or out of range.
    #[error("{}: {}{source}", .path.display(), in_key(.key))]
    Json {
        /// The scene file.
        path: PathBuf,
        /// The key, with those around it, as in `quads[2].radiance`; empty at the top level.
        key: String,
        /// What is wrong, with line and column.
        source: serde_json::Error,
    },
    /// The scene file has a format that this version does not read.
    #[error("{}: key `format`: this version reads formats 1 and 2, not {found}", .path.display())]
    Format {
        /// The scene file.
        path: PathBuf,
        /// Its format.
        found: u64,
    },
    /// A path in the scene file names an environment variable that is not set.
    #[error(
        "{}: key `{key}`: the environment variable {name} in `{text}` is not set; set it to the folder that the path \
         should start from, as in `export {name}=/path/to/folder`", .path.display()
    )]
    Variable {
        /// The scene file.
        path: PathBuf,
        /// The key.
        key: String,
        /// The variable.
        name: String,
        /// The path that names it.
        text: String,
    },
    /// The scene file names a file that is not there.
    #[error("{}: key `{key}`: no such file: {}", .path.display(), .wanted.display())]
    Missing {
        /// The scene file.
        path: PathBuf,
        /// The key.
        key: String,
        /// The file that it names.
        wanted: PathBuf,
    },
    /// The scene file names a folder where a file should be.
    #[error("{}: key `{key}`: {} is a folder; name a file in it", .path.display(), .folder.display())]
    Folder {
        /// The scene file.
        path: PathBuf,
        /// The key.
        key: String,
        /// The folder that it names.
        folder: PathBuf,
    },
    /// The scene file overrides materials that no face of the OBJ has.
    #[error("{}: key `{key}`: the OBJ has no face of {}; it uses {}", .path.display(), list(.names), list(.used))]
    UnknownMaterials {
        /// The scene file.
        path: PathBuf,
        /// The key.
        key: String,
        /// The names that are too many.
        names: Vec<String>,
        /// The names that the OBJ uses.
        used: Vec<String>,
    },
    /// A line of an OBJ file is malformed.
    #[error("{}, line {line}: {what}", .path.display())]
    Obj {
        /// The OBJ file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        what: String,
    },
    /// An OBJ file as a whole is of no use.
    #[error("{}: {what}", .path.display())]
    ObjContent {
        /// The OBJ file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// A part of a glTF or PLY file is missing, malformed or out of range.
    #[error("{}, {place}: {what}", .path.display())]
    Part {
        /// The file.
        path: PathBuf,
        /// The part, as in `accessors[3]`.
        place: String,
        /// What is wrong with it.
        what: String,
    },
    /// A file requires what this version does not read.
    #[error(
        "{}: requires {}, which this version does not read; {}", .path.display(), list(.names),
        remedy(.textures)
    )]
    Extensions {
        /// The glTF file.
        path: PathBuf,
        /// The names of the extensions.
        names: Vec<String>,
        /// The places of the textures whose pictures need one of them.
        textures: Vec<String>,
    },
    /// A scene has no camera of that name.
    #[error("no camera is called `{name}`; the scene has {}", list(.known))]
    UnknownCamera {
        /// The name.
        name: String,
        /// The names that there are.
        known: Vec<String>,
    },
    /// A scene has no variant of that name.
    #[error("{}: no variant is called `{name}`; the file has {}", .path.display(), list(.known))]
    UnknownVariant {
        /// The file.
        path: PathBuf,
        /// The name.
        name: String,
        /// The names that there are.
        known: Vec<String>,
    },
    /// A value of a material in an MTL file is malformed or out of range.
    #[error(
        "{}, line {line}: material `{material}`, {key}: {what}; correct it, or override the material in the scene file",
        .path.display()
    )]
    Mtl {
        /// The MTL file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The material.
        material: String,
        /// The key, in lower case.
        key: String,
        /// What is wrong.
        what: String,
    },
    /// A texture cannot be decoded.
    #[error("{}: not a usable texture: {source}", .path.display())]
    Texture {
        /// The picture file.
        path: PathBuf,
        /// What the decoder says.
        source: image::ImageError,
    },
    /// A texture is of no use.
    #[error("{}: not a usable texture: {what}", .path.display())]
    UnusableTexture {
        /// The picture file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// An environment is of no use.
    #[error("{}: not a usable environment: {what}", .path.display())]
    Environment {
        /// The picture file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// A picture that is read as other pictures are cannot be.
    #[error("{source}")]
    Picture {
        /// Which, and why.
        source: Box<crate::image::ImageError>,
    },
    /// All textures together are too large.
    #[error("{}: with this texture the scene has more than {limit} texels of 4 bytes (those of 16 bits a channel have 8, of floats 12); use smaller textures", .path.display())]
    TooManyTexels {
        /// The texture that was one too many.
        path: PathBuf,
        /// The most texels of 4 bytes that a scene may have.
        limit: usize,
    },
    /// No scene of that name ships with the program.
    #[error("no scene is called `{name}`; there are {}, or give the path of a scene file", list(.known))]
    UnknownName {
        /// The name.
        name: String,
        /// The names that there are.
        known: Vec<String>,
    },
}

/// What the system says; of a folder, what to do.
fn why(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::IsADirectory => "it is a folder; name a file in it".to_owned(),
        _ => error.to_string(),
    }
}

fn in_key(key: &str) -> String {
    if key.is_empty() { String::new() } else { format!("key `{key}`: ") }
}

/// A number of bytes, as people say it.
fn amount(bytes: u64) -> String {
    let units = [(30, "GiB"), (20, "MiB"), (10, "KiB")];
    let whole = units.into_iter().find(|(shift, _)| bytes >= 1 << shift);
    whole.map_or_else(
        || format!("{bytes} bytes"),
        |(shift, unit)| {
            let digits = usize::from(!bytes.is_multiple_of(1 << shift));
            format!("{:.digits$} {unit}", bytes as f64 / f64::from(1 << shift))
        },
    )
}

/// What to do with a file whose extensions are not read.
fn remedy(textures: &[String]) -> String {
    if textures.is_empty() {
        return "export it without".to_owned();
    }
    format!(
        "export it without: the pictures of {} are KTX2, take PNG, JPEG or WebP for them, or have \
         `gltf-transform ktxdecompress` make a file with PNGs",
        list(textures)
    )
}

/// At most this many names go into a message.
const LISTED: usize = 8;

/// The names in backquotes, the first few when there are many.
pub(super) fn list(names: &[String]) -> String {
    let shown: Vec<_> = names.iter().take(LISTED).map(|name| format!("`{name}`")).collect();
    match names.len().saturating_sub(LISTED) {
        0 if names.is_empty() => "none".to_owned(),
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}
