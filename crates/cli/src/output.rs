//! Text for people.

use super::ending::CliError;
use raystream::film::Film;
use raystream::image::{Format, check_writable, written_file};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Writes a line to stdout. A reader that has gone away (`| head`) is not an error.
pub fn print_line(line: &str) -> io::Result<()> {
    match writeln!(io::stdout(), "{line}") {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => result
            .map_err(|error| io::Error::new(error.kind(), format!("standard output: {error}"))),
    }
}

/// Whether what the program says is said by another process.
static IS_SILENT: AtomicBool = AtomicBool::new(false);

/// From now on [`say`] says nothing: another process does.
pub fn silence() {
    IS_SILENT.store(true, Ordering::Relaxed);
}

/// Writes a line to stderr if anyone still reads it: `eprintln!` would panic, and a render be lost
/// for a message. Not after [`silence`].
pub fn say(line: &str) {
    if !IS_SILENT.load(Ordering::Relaxed) {
        complain(line);
    }
}

/// Writes a line to stderr likewise, in any case.
pub fn complain(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Whether two paths lead to one file, links followed.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    let resolved = |path: &Path| {
        let written = written_file(path).or_else(|| std::path::absolute(path).ok());
        path.canonicalize().ok().or(written)
    };
    a == b || resolved(a).is_some_and(|a| resolved(b) == Some(a))
}

/// Whether a path names a PNG.
pub fn is_png(path: &Path) -> bool {
    matches!(Format::of(path), Ok(Format::Png))
}

/// Fails where one of the pictures `-o` could not be written, or would replace another or the
/// picture `source` that they are made of.
pub fn check_outputs(paths: &[PathBuf], source: Option<&Path>) -> Result<(), CliError> {
    let refuse =
        |path: &Path, why: &str| Err(CliError::from(format!("{}: -o {why}", path.display())));
    for (index, path) in paths.iter().enumerate() {
        check_writable(path)?;
        if source.is_some_and(|source| is_same_file(source, path)) {
            return refuse(path, "would replace the picture; name another file");
        }
        if paths[..index].iter().any(|earlier| is_same_file(earlier, path)) {
            return refuse(path, "names this file twice; name each once");
        }
    }
    Ok(())
}

/// Samples per pixel; an average, to two digits after the point.
pub fn average_samples(film: &Film) -> f64 {
    let samples: u64 = film.radiance.iter().map(|pixel| u64::from(pixel.samples())).sum();
    (samples as f64 / film.radiance.len() as f64 * 100.0).round() / 100.0
}

/// A size in bytes, rounded: `1.5 GiB`.
pub fn bytes(count: u64) -> String {
    let units = ["bytes", "KiB", "MiB", "GiB", "TiB"];
    let mut value = count as f64;
    let mut unit = 0;
    while value >= 1024.0 && unit + 1 < units.len() {
        value /= 1024.0;
        unit += 1;
    }
    if count > 1 << 60 {
        "unlimited".into()
    } else if value.fract() < 0.05 {
        format!("{value:.0} {}", units[unit])
    } else {
        format!("{value:.1} {}", units[unit])
    }
}

/// A rate, with a unit's prefix: `12.3 M`.
pub fn rate(per_second: f64) -> String {
    match per_second {
        r if r >= 1e9 => format!("{:.2} G", r / 1e9),
        r if r >= 1e6 => format!("{:.1} M", r / 1e6),
        r if r >= 1e3 => format!("{:.0} k", r / 1e3),
        r => format!("{r:.0} "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(bytes(128 << 20), "128 MiB");
        assert_eq!(bytes(1_610_612_736), "1.5 GiB");
        assert_eq!(bytes(17), "17 bytes");
        assert_eq!(bytes(u64::MAX), "unlimited");
        assert_eq!(rate(2.5e9), "2.50 G");
        assert_eq!(rate(999.0), "999 ");
    }
}
