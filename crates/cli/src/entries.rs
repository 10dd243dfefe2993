//! Scenes to measure, each with the size of its picture, and the report on all of them.

use super::ending::CliError;
use super::options::{SettingsArguments, parse_size};
use super::output::print_line;
use super::render::file_stem;
use raystream::exec::device::Device;
use raystream::render::Settings;
use raystream::scene::{FilmSize, Scene};
use raystream_bench::{Folder, SceneReport};
use std::path::PathBuf;

/// A scene as it was named.
#[derive(Clone, Debug)]
pub struct Entry {
    scene: PathBuf,
    size: Option<FilmSize>,
}

/// A scene to measure.
pub struct Loaded {
    /// What to call it.
    pub label: String,
    /// The scene.
    pub scene: Scene,
    /// The settings for it.
    pub settings: Settings,
}

/// Loads all scenes.
pub fn load(
    entries: &[Entry],
    arguments: &SettingsArguments,
    quiet: bool,
) -> Result<Vec<Loaded>, CliError> {
    let mut scenes: Vec<Loaded> = Vec::new();
    for entry in entries {
        let mut scene = arguments.load_scene(&entry.scene, quiet)?;
        let settings = arguments.settings(&scene);
        let settings = Settings { size: entry.size.unwrap_or(settings.size), ..settings };
        scene.film = settings.size;
        let label = entry.label();
        if scenes.iter().any(|other| other.label == label) {
            return Err(format!(
                "the results of two scenes would go to {label}; name each scene once, or a copy \
                 under another name"
            )
            .into());
        }
        scenes.push(Loaded { label, scene, settings });
    }
    Ok(scenes)
}

/// Has `measure` measure all scenes, prints their tables, and writes the report, which begins with
/// `introduction`, to `output`. Returns where it is.
pub fn report(
    introduction: &str,
    scenes: Vec<Loaded>,
    output: &Folder,
    mut measure: impl FnMut(Loaded) -> Result<SceneReport, CliError>,
) -> Result<PathBuf, CliError> {
    const FILE: &str = "report.md";
    let mut report = introduction.to_owned();
    for loaded in scenes {
        let SceneReport { tables, section } = measure(loaded)?;
        report += &format!("\n{section}");
        // After each scene: the next may take long.
        output.write(FILE, report.as_bytes())?;
        print_line(&tables)?;
    }
    Ok(output.file(FILE))
}

/// What a report tells of a measurement beside its figures: device, scene and `size`, the plan, the
/// settings as `described` but for their integrator, and instead of that one those that were
/// measured.
pub fn facts(
    device: &Device,
    scene: &Scene,
    size: FilmSize,
    plan: [(&str, String); 2],
    described: Vec<(String, String)>,
    integrators: Option<(&str, String)>,
) -> Vec<(String, String)> {
    let named = |(name, value): (&str, String)| (name.to_owned(), value);
    let scene = [
        ("device", device.description()),
        ("triangles", scene.triangle_count().to_string()),
        ("size", format!("{}x{}", size.width, size.height)),
    ];
    let mut facts: Vec<_> = scene.into_iter().chain(plan).map(named).collect();
    facts.extend(described.into_iter().filter(|(name, _)| name != "integrator"));
    facts.extend(
        integrators
            .into_iter()
            .chain([("version", env!("CARGO_PKG_VERSION").to_owned())])
            .map(named),
    );
    facts
}

impl Entry {
    /// A name for folders and titles: `cornell_ball`, `cornell_ball@600x600`.
    fn label(&self) -> String {
        let stem = file_stem(&self.scene.file_stem().unwrap_or_default().to_string_lossy());
        match self.size {
            Some(size) => format!("{stem}@{}x{}", size.width, size.height),
            None => stem,
        }
    }
}

/// A scene's name or file, and what follows the last `@` if it looks like a size.
pub fn parse_entry(text: &str) -> Result<Entry, String> {
    let looks_like_size = |text: &str| {
        text.starts_with(|c: char| c.is_ascii_digit())
            && text.chars().all(|c| c.is_ascii_digit() || matches!(c, 'x' | 'X'))
    };
    match text.rsplit_once('@') {
        Some((scene, size)) if looks_like_size(size) => {
            Ok(Entry { scene: scene.into(), size: Some(parse_size(size)?) })
        }
        _ => Ok(Entry { scene: text.into(), size: None }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_may_have_a_size() {
        let entry = |text: &str| {
            parse_entry(text).map(|e| (e.label(), e.size.map(|s| (s.width, s.height))))
        };
        assert_eq!(entry("cornell_ball"), Ok(("cornell_ball".into(), None)));
        assert_eq!(entry("cornell_ball@60x50"), Ok(("cornell_ball@60x50".into(), Some((60, 50)))));
        assert_eq!(entry("a@b/my scene.json"), Ok(("my scene".into(), None)));
        assert_eq!(entry("a@b/c.json@1X2"), Ok(("c@1x2".into(), Some((1, 2)))));
        assert!(entry("cornell_ball@600").unwrap_err().contains("WIDTHxHEIGHT"));
        assert!(entry("cornell_ball@0x600").unwrap_err().contains("width"));
    }
}
