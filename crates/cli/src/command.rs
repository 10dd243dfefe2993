//! Command lines that are kept with a render, to go on with it.

use raystream::film_file::Command;

/// The command of this process.
///
/// # Errors
/// If it cannot be written down: the working folder is gone, or arguments are not in UTF-8.
pub fn of_this_process() -> Result<Command, String> {
    let folder = std::env::current_dir()
        .map_err(|error| format!("--checkpoint: the working folder is not known: {error}"))?;
    let arguments = std::env::args_os().skip(1).map(|argument| {
        argument.into_string().map_err(|argument| {
            format!(
                "--checkpoint: {}: is not in UTF-8, which film files are; rename it",
                argument.display()
            )
        })
    });
    Ok(Command { folder, arguments: arguments.collect::<Result<_, _>>()? })
}

/// Takes out the option `name` and its value, wherever it is given.
pub fn remove_option(command: &mut Command, name: &str) {
    let mut is_value = false;
    command.arguments.retain(|argument| {
        let is_option = !is_value && argument == name;
        let rest = argument.strip_prefix(name);
        let has_value = rest.is_some_and(|rest| rest.starts_with('='));
        let is_kept = !(is_option || is_value || has_value);
        is_value = is_option;
        is_kept
    });
}

/// Gives the option `name`, of the `subcommand`, this value and no other.
pub fn set_option(command: &mut Command, subcommand: &str, name: &str, value: &str) {
    remove_option(command, name);
    let subcommand = command.arguments.iter().position(|argument| argument == subcommand);
    let place = subcommand.map_or(command.arguments.len(), |place| place + 1);
    command.arguments.insert(place, format!("{name}={value}"));
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    #[test]
    fn options_of_commands_are_replaced() {
        let words = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
        for (before, after) in [
            ("render a --spp 8 --part 3/8", "render --spp=64 a"),
            ("-v render --spp=4 --part=3/8 a --spp 3", "-v render --spp=64 a"),
            ("render a -o part --sppx 3", "render --spp=64 a -o part --sppx 3"),
        ] {
            let mut command = Command { folder: PathBuf::new(), arguments: words(before) };
            remove_option(&mut command, "--part");
            set_option(&mut command, "render", "--spp", "64");
            assert_eq!(command.arguments, words(after));
        }
    }
}
