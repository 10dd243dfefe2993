//! `raystream scenes`

use super::ending::{CliError, Ending};
use super::output::print_line;
use raystream::scene::{DEFAULT_SCENE, SceneGeometry, shipped};

/// Lists the scenes that ship.
pub fn run() -> Result<Ending, CliError> {
    for scene in shipped() {
        let default = if scene.name == DEFAULT_SCENE { " (the default)" } else { "" };
        print_line(&format!("{}{default}", scene.name))?;
        print_line(&format!("    {}", scene.description))?;
        if let SceneGeometry::Download { url, credits } = scene.geometry {
            print_line(&format!(
                "    geometry to be fetched from {url}: scenes/{}/README.md says how",
                scene.name
            ))?;
            print_line(&format!("    {credits}"))?;
        }
    }
    Ok(Ending::Done)
}
