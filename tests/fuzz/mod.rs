//! Inputs of all formats by chance: none panics, hangs, or takes memory without measure.
//!
//! CONTRIBUTING.md says how to try more of them. Those that found something lie in `corpus/`.

mod memory;
mod pictures;
mod scenes;

use raystream_tests::fuzz::Target;
use std::path::Path;

/// Feeds what `run` does with inputs made of `seeds`, and of the inputs that found something.
fn fuzz(
    name: &'static str,
    mut seeds: Vec<Vec<u8>>,
    words: &'static [&'static str],
    run: impl Fn(&[u8]) + Sync,
) {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(name);
    if let Ok(files) = corpus.read_dir() {
        let mut paths: Vec<_> = files.map(|file| file.unwrap().path()).collect();
        paths.sort();
        seeds.extend(paths.iter().map(|path| std::fs::read(path).unwrap()));
    }
    Target { name, seeds, words, run: &run, peak_memory: &memory::peak }.fuzz();
}
