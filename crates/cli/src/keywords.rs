//! Options of the command line as keywords of another language: `max_depth` for `--max-depth`.

use super::loading::LoadArguments;
use super::render::RenderArguments;
use clap::{ArgAction, Args};

/// What another program does in a way of its own: files, words and processes.
const LEFT_OUT: &[&str] = &[
    "scene",
    "output",
    "png_layers",
    "exposure",
    "tone_map",
    "quiet",
    "verbose",
    "threads",
    "help",
    "version",
    "checkpoint",
    "checkpoint_every",
    "frames",
    "fps",
    "tev",
];

/// An option of a render.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CallOption {
    /// What it is called, such as `max_depth`.
    pub name: String,
    /// What it means.
    pub help: String,
    /// Whether it is there or not, and takes no value.
    pub is_flag: bool,
    /// Whether it may stand without its value.
    pub may_be_bare: bool,
    /// Whether it says how a scene is loaded.
    pub loads: bool,
}

/// All options of a render.
pub fn call_options() -> Vec<CallOption> {
    let loading = LoadArguments::augment_args(clap::Command::new("load"));
    let loading: Vec<&str> =
        loading.get_arguments().map(|argument| argument.get_id().as_str()).collect();
    let command = RenderArguments::augment_args(clap::Command::new("render"));
    let options = command.get_arguments().filter(|argument| {
        let id = argument.get_id().as_str();
        !LEFT_OUT.contains(&id)
    });
    let described = options.map(|argument| CallOption {
        name: argument.get_id().to_string(),
        help: in_keywords(&argument.get_help().map(ToString::to_string).unwrap_or_default()),
        is_flag: matches!(argument.get_action(), ArgAction::SetTrue),
        may_be_bare: argument.get_num_args().is_some_and(|range| range.min_values() == 0),
        loads: loading.contains(&argument.get_id().as_str()),
    });
    described.collect()
}

/// Words for users of a command line as those for users of keywords: `max_depth` for `--max-depth`,
/// and no place for a value.
pub fn in_keywords(text: &str) -> String {
    let mut words = text.to_owned();
    let mut from = 0;
    while let Some(start) = words[from..].find("--").map(|at| at + from) {
        let is_of_name = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        let rest = &words[start + 2..];
        let end = start + 2 + rest.find(|c| !is_of_name(c)).unwrap_or(rest.len());
        if end == start + 2 {
            from = end;
            continue;
        }
        let name = words[start + 2..end].replace('-', "_");
        let rest = &words[end..];
        // The place for a value: ` <NAME>`, `[=<NAME>]`.
        let place = rest.find('>').filter(|_| rest.starts_with(" <") || rest.starts_with("[=<"));
        let end = end + place.map_or(0, |at| at + 1 + usize::from(rest.starts_with('[')));
        from = start + name.len();
        words.replace_range(start..end, &name);
    }
    words
}

/// An option as it stands on a command line.
pub fn word(name: &str, value: Option<&str>) -> String {
    let name = name.replace('_', "-");
    value.map_or_else(|| format!("--{name}"), |value| format!("--{name}={value}"))
}

/// Fails where there is no such option.
pub fn check_names(
    options: &[(String, Option<String>)],
    known: &[CallOption],
) -> Result<(), String> {
    let is_known = |name: &str| known.iter().any(|option| option.name == name);
    match options.iter().find(|(name, _)| !is_known(name)) {
        Some((name, _)) => {
            let mut names: Vec<&str> = known.iter().map(|option| option.name.as_str()).collect();
            names.sort_unstable();
            Err(format!("there is no option '{name}'; there are: {}", names.join(", ")))
        }
        None => Ok(()),
    }
}

/// What the parser says, in a line, without what is for command lines.
pub fn said(error: &str) -> String {
    let lines = error.lines().map(str::trim);
    let told = lines.take_while(|line| {
        !line.starts_with("Usage:") && !line.starts_with("For more information")
    });
    let told: Vec<&str> = told.filter(|line| !line.is_empty()).collect();
    let told = told.join(" ");
    in_keywords(told.strip_prefix("error: ").unwrap_or(&told))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_called_by_keywords() {
        assert_eq!(in_keywords("use the CPU (--device cpu)"), "use the CPU (device cpu)");
        assert_eq!(
            in_keywords("--ray-offset and --no-light-tracing"),
            "ray_offset and no_light_tracing"
        );
        assert_eq!(in_keywords("for '--max-depth <D>': 0"), "for 'max_depth': 0");
        assert_eq!(in_keywords("for '--denoise[=<FILTER>]': x"), "for 'denoise': x");
        assert_eq!(in_keywords("nothing - to -- do"), "nothing - to -- do");
    }
}
