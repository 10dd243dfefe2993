//! Says how to link a library that Python loads, where that takes saying: on macOS.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
