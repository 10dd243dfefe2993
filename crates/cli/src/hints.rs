//! Errors of the library, with the options that help.

use raystream::exec::ExecError;
use raystream::render::RenderError;
use raystream::render::integrator::lvc;
use raystream::scene::SceneError;
use raystream_bench::BenchError;
use std::error::Error;

/// The error, and which options help, if any do.
pub fn with_hint(error: &(dyn Error + 'static)) -> String {
    match hint(error) {
        Some(hint) => format!("{error} ({hint})"),
        None => error.to_string(),
    }
}

fn hint(error: &(dyn Error + 'static)) -> Option<&'static str> {
    if let Some(SceneError::TooLong { .. } | SceneError::TooLarge { .. }) = error.downcast_ref() {
        return Some("--max-memory allows more");
    }
    match device_error(error)? {
        ExecError::NoSuchDevice { .. } => Some("`raystream devices` lists them"),
        ExecError::OutOfMemory { label, .. } | ExecError::TooLarge { label, .. }
            if *label == lvc::LABEL =>
        {
            Some("--light-paths and --max-depth make fewer light vertices; --device cpu")
        }
        ExecError::OutOfMemory { .. } => Some("--size, --device; `raystream devices` lists them"),
        ExecError::NoGpu
        | ExecError::Unsuitable { .. }
        | ExecError::TooLarge { .. }
        | ExecError::Device { .. } => Some("--device cpu"),
        _ => None,
    }
}

/// What went wrong on the device, if that is why `error` came about.
fn device_error<'a>(error: &'a (dyn Error + 'static)) -> Option<&'a ExecError> {
    let of_render = |error: &'a RenderError| match error {
        RenderError::Exec(error) => Some(error),
        _ => None,
    };
    if let Some(error) = error.downcast_ref::<BenchError>() {
        return match error {
            BenchError::Exec(error) => Some(error),
            BenchError::Render(error) => of_render(error),
            _ => None,
        };
    }
    error.downcast_ref::<RenderError>().and_then(of_render).or_else(|| error.downcast_ref())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn too_large(label: &'static str) -> ExecError {
        ExecError::TooLarge { device: "a GPU".into(), label, bytes: 2, limit: 1 }
    }

    #[test]
    fn errors_name_the_options_that_help() {
        let render = RenderError::Exec(too_large("the film"));
        assert!(with_hint(&render).ends_with("use the CPU (--device cpu)"));
        let bench = BenchError::Render(RenderError::Exec(too_large(lvc::LABEL)));
        assert!(with_hint(&bench).contains("--light-paths"), "{}", with_hint(&bench));
        let unknown = ExecError::NoSuchDevice { name: "x".into(), known: "cpu".into() };
        assert!(with_hint(&unknown).ends_with("cpu (`raystream devices` lists them)"));
        assert_eq!(with_hint(&std::fmt::Error), std::fmt::Error.to_string());
    }
}
