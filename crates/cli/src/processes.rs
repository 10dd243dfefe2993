//! Several processes that render together.
//!
//! All run the same command. The first one has the film, says what there is to say and writes what
//! there is to write. The others load the scene and open their devices as it does, and trace for it.

use super::ending::CliError;
use raystream::render::Worker;
use serde::{Deserialize, Serialize};

/// What tells one render from another: processes that render together have it in common.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub struct Identity {
    /// Version of the program.
    pub version: String,
    /// Digest of what the kernels were compiled from.
    pub kernels: String,
    /// Digest of the scene.
    pub scene: String,
    /// The settings in words.
    pub settings: String,
}

impl Identity {
    /// What differs between this one, of the first process, and another's, and what to do about it.
    pub fn difference(&self, other: &Self) -> Option<String> {
        if self.version != other.version {
            let versions = (&other.version, &self.version);
            return Some(format!(
                "is version {}, and the first process {}; start the same program everywhere",
                versions.0, versions.1
            ));
        }
        let what = if self.kernels != other.kernels {
            "has other kernels; start the same program everywhere"
        } else if self.scene != other.scene {
            "has another scene: its files differ from those of the first process; use a folder \
             that all machines share, or copy them anew"
        } else if self.settings != other.settings {
            "renders by other settings; give all processes the same options, and devices that can \
             do the same"
        } else {
            return None;
        };
        Some(what.to_owned())
    }
}

/// A worker of another process.
pub struct Helper {
    /// What kind of device it is on.
    pub device: String,
    /// The worker.
    pub worker: Box<dyn Worker>,
}

/// The processes of a render, as one of them sees them.
pub trait Processes {
    /// Whether this one traces for the first one.
    fn is_helper(&self) -> bool;

    /// For the first process: the workers of all others, which render what has this identity.
    ///
    /// # Errors
    /// If one of them fails, or renders something else.
    fn workers(&self, identity: &Identity) -> Result<Vec<Helper>, CliError>;

    /// For a helper: has its workers do what the first process asks for, until the render's end.
    ///
    /// # Errors
    /// If the first process is gone.
    fn serve(&self, identity: &Identity, workers: Vec<Box<dyn Worker>>) -> Result<(), CliError>;
}

/// A process that renders by itself.
pub struct Alone;

impl Processes for Alone {
    fn is_helper(&self) -> bool {
        false
    }

    fn workers(&self, _: &Identity) -> Result<Vec<Helper>, CliError> {
        Ok(Vec::new())
    }

    fn serve(&self, _: &Identity, _: Vec<Box<dyn Worker>>) -> Result<(), CliError> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_named() {
        let identity = |version: &str, kernels: &str, scene: &str, settings: &str| Identity {
            version: version.to_owned(),
            kernels: kernels.to_owned(),
            scene: scene.to_owned(),
            settings: settings.to_owned(),
        };
        let own = identity("1", "k", "s", "t");
        assert_eq!(own.difference(&own.clone()), None);
        for (other, part) in [
            (identity("2", "x", "x", "x"), "is version 2, and the first process 1"),
            (identity("1", "x", "x", "x"), "other kernels"),
            (identity("1", "k", "x", "x"), "another scene"),
            (identity("1", "k", "s", "x"), "other settings"),
        ] {
            let difference = own.difference(&other).unwrap();
            assert!(difference.contains(part), "{difference}");
        }
    }
}
