//! The program as a user runs it, on the CPU with tiny pictures.

#[path = "command_line/adaptive.rs"]
mod adaptive;
#[path = "command_line/commands.rs"]
mod commands;
mod common;
#[path = "command_line/convergence.rs"]
mod convergence;
#[path = "command_line/integrators.rs"]
mod integrators;
#[path = "command_line/interrupt.rs"]
mod interrupt;
#[path = "command_line/memory.rs"]
mod memory;
#[path = "command_line/options.rs"]
mod options;
#[path = "command_line/outputs.rs"]
mod outputs;
#[path = "support/program.rs"]
mod program;
#[path = "command_line/renders.rs"]
mod renders;
#[path = "support/scene_folder.rs"]
mod scene_folder;
#[path = "command_line/scenes.rs"]
mod scenes;
