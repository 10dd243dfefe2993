//! A render under the Vulkan validation layer says nothing, and naga takes the kernels too.

use std::process::{Command, Output};

fn raystream(arguments: &[&str]) -> Output {
    let folder = tempfile::tempdir().expect("a temporary folder");
    Command::new(env!("CARGO_BIN_EXE_raystream"))
        .args(arguments)
        .current_dir(&folder)
        // wgpu says only at this level that it misses the layer.
        .env("RUST_LOG", "debug")
        .output()
        .expect("the binary runs")
}

/// What wgpu says where the layer is not installed.
const MISSING_LAYER: &str = "unable to find layer";

/// Renders with every allocator, every estimator and every integrator: so every kernel of a render
/// runs, and again after others. Paths are so long that integrators that advance in step leave some
/// to the launch that finishes them.
fn renders() -> impl Iterator<Item = Vec<&'static str>> {
    let tiny = "render --size 16x12 --spp 8 --initial-spp 2 --round-budget 2 --noise 0.0001 \
                --device gpu -o a.png";
    [
        ("uniform", "bilateral", "compaction"),
        ("paper", "bilateral", "regeneration"),
        ("atomic", "halves", "streaming"),
        ("runs", "variance", "megakernel"),
        ("uniform", "bilateral", "lvc"),
        ("runs", "halves", "lvc"),
    ]
    .into_iter()
    .map(move |(allocator, estimator, integrator)| {
        let chosen =
            ["--allocator", allocator, "--estimator", estimator, "--integrator", integrator];
        tiny.split(' ').chain(["--max-depth", "30"]).chain(chosen).collect()
    })
}

#[test]
fn a_render_under_the_validation_layer_is_clean() {
    if !raystream_tests::has_gpu() {
        return;
    }
    for render in renders() {
        let output = raystream(&[&render[..], &["--validation"]].concat());
        let messages = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{messages}");
        if messages.contains(MISSING_LAYER) {
            raystream_tests::no_gpu(
                "the layer VK_LAYER_KHRONOS_validation is not installed (package \
                 vulkan-validationlayers)",
            );
            return;
        }
        // wgpu logs what the layer says with the severity that it gives; rules that were broken
        // have names that begin with VUID.
        for trouble in ["VUID", "ERROR", "WARN"] {
            assert!(!messages.contains(trouble), "{render:?}: {messages}");
        }
    }
}

/// The test above can fail: wgpu does say so when the layer is missing.
#[test]
fn a_missing_layer_is_noticed() {
    if !raystream_tests::has_gpu() {
        return;
    }
    let output = Command::new(env!("CARGO_BIN_EXE_raystream"))
        .args(["devices", "--validation"])
        .env("VK_LAYER_PATH", "/nonexistent")
        .env("RUST_LOG", "debug")
        .output()
        .expect("the binary runs");
    let messages = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(messages.contains(MISSING_LAYER), "{messages}");
}

/// Those of the first render and the last, by `lvc`; that it takes all of them is a test of its own
/// (`tests/exec/wgsl.rs`).
#[test]
fn naga_translates_the_kernels() {
    if !raystream_tests::has_gpu() {
        return;
    }
    for render in renders().step_by(5) {
        let output = raystream(&[&render[..], &["--naga"]].concat());
        assert!(output.status.success(), "{render:?}: {}", String::from_utf8_lossy(&output.stderr));
    }
}
