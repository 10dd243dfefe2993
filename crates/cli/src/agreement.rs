//! Whether two pictures show the same scene, for `raystream compare`.

use super::ending::CliError;
use glam::Vec3;
use raystream::image::{self, Agreement, ColorImage};
use raystream::render::{AllocatorKind, IntegratorKind};
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// Blocks of so many pixels, small enough to find a wrong corner, large enough to average noise
/// away.
const BLOCK: [u32; 2] = [40, 30];

/// What the test of agreement found.
pub struct Verdict {
    numbers: Agreement,
    /// Why these numbers do not mean what they say, a sentence each.
    pub caveats: Vec<String>,
}

/// The settings in a picture's header, by name.
type Header = BTreeMap<String, String>;

/// Tests a picture against a reference of `samples` per pixel; `paths` are those of both.
pub fn test(
    paths: [&Path; 2],
    test: &ColorImage,
    reference: &ColorImage,
    samples: u32,
) -> Result<Verdict, CliError> {
    let [path, reference_path] = paths;
    let layers = image::read_layers(path)?;
    let channel = |name: &str| {
        layers.channel(name).ok_or_else(|| {
            format!("{}: has no channel {name}; render it with raystream", path.display())
        })
    };
    let [r, g, b] = [channel("variance.R")?, channel("variance.G")?, channel("variance.B")?];
    let variance: Vec<Vec3> =
        r.iter().zip(g).zip(b).map(|((&r, &g), &b)| Vec3::new(r, g, b)).collect();
    let counts = channel("samples.N")?;
    let own_samples =
        counts.iter().map(|&n| f64::from(n)).sum::<f64>() / counts.len().max(1) as f64;
    let ratio = own_samples / f64::from(samples);
    let numbers = image::agreement(test, &variance, ratio, reference, BLOCK)?;
    let header = image::read_settings(path)?;
    // A PNG, or a file of another program, has none.
    let reference_header = image::read_settings(reference_path).unwrap_or_default();
    let mut caveats: Vec<String> = [(path, &header), (reference_path, &reference_header)]
        .into_iter()
        .flat_map(|(path, header)| of_sampling(path, header))
        .collect();
    caveats.extend(of_both([&header, &reference_header], samples));
    Ok(Verdict { numbers, caveats })
}

/// What the header of a picture says against its variance being that of independent samples.
fn of_sampling(path: &Path, header: &Header) -> Vec<String> {
    let mut caveats = Vec::new();
    let path = path.display();
    if let Some(allocator) = header.get("allocator")
        && allocator != AllocatorKind::Uniform.name()
    {
        caveats.push(format!(
            "{path}: was rendered with --allocator {allocator}: the variance and the mean of an \
             adaptive picture are not those of independent samples, and the test of agreement \
             cannot go by them; render it with --allocator uniform"
        ));
    }
    if header.get("integrator").is_some_and(|name| name == IntegratorKind::Lvc.name()) {
        caveats.push(format!(
            "{path}: was rendered with --integrator lvc, whose samples share light paths: its \
             errors are larger than its variance says"
        ));
    }
    caveats
}

/// What both headers say against two renders being independent, or of as many samples as was said.
fn of_both([test, reference]: [&Header; 2], samples: u32) -> Vec<String> {
    let mut caveats = Vec::new();
    let same = |key: &str| test.get(key).is_some_and(|value| reference.get(key) == Some(value));
    if same("seed") && same("sampler") && same("scene") {
        caveats.push(format!(
            "both pictures have the seed {}: their noise is not independent; render one with \
             another --seed",
            test["seed"]
        ));
    }
    let said = reference.get("samples").and_then(|text| text.parse::<f64>().ok());
    if let Some(said) = said
        && (said / f64::from(samples) - 1.0).abs() > 0.01
    {
        caveats.push(format!(
            "--reference-samples {samples}: the reference says that it has {said} per pixel"
        ));
    }
    caveats
}

impl Verdict {
    /// The verdict in words.
    fn words(&self) -> &'static str {
        if !self.caveats.is_empty() {
            return "not sure: see the warnings";
        }
        match self.numbers.is_same_scene() {
            Some(true) => "the same scene, as far as noise lets one tell",
            Some(false) => "not the same scene: they differ by more than noise",
            None => "not sure: too many pixels have fewer than two samples",
        }
    }

    /// The numbers, the limit and the verdict.
    pub fn json(&self) -> serde_json::Result<serde_json::Value> {
        let mut all = serde_json::to_value(&self.numbers)?;
        let known = self.caveats.is_empty();
        all["same_scene"] = self.numbers.is_same_scene().filter(|_| known).into();
        all["verdict"] = self.words().into();
        Ok(all)
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let n = &self.numbers;
        writeln!(
            f,
            "agreement       mean {:+.3} %, worst of {} blocks of {}x{} pixels {:.2} standard \
             errors at ({}, {}), {} fireflies aside",
            100.0 * (n.mean_ratio - 1.0),
            n.blocks,
            BLOCK[0],
            BLOCK[1],
            n.worst_block,
            n.worst_at[0],
            n.worst_at[1],
            n.fireflies
        )?;
        write!(
            f,
            "verdict         {} (in one of 1000 comparisons of one scene a block is beyond {:.2})",
            self.words(),
            n.limit
        )
    }
}
