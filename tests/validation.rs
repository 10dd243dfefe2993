//! A render under the Vulkan validation layer says nothing, and naga takes the kernels too.

mod common;

use std::process::{Command, Output};

fn raystream(arguments: &[&str]) -> Output {
    let folder = std::env::temp_dir().join(format!("raystream-validation-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_raystream"))
        .args(arguments)
        .current_dir(&folder)
        // The layer and wgpu speak through the log; warnings are what a default run shows.
        .env("RUST_LOG", "warn")
        .output()
        .expect("the binary runs");
    std::fs::remove_dir_all(&folder).unwrap();
    output
}

const TINY_RENDER: [&str; 9] = ["render", "--size", "16x12", "--spp", "2", "--device", "gpu", "-o", "a.png"];

#[test]
fn a_render_under_the_validation_layer_is_clean() {
    if !common::has_gpu() {
        return;
    }
    let output = raystream(&[&TINY_RENDER[..], &["--validation"]].concat());
    let messages = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{messages}");
    if messages.contains("unable to find layer")
        || messages.contains("unable to find layer: VK_LAYER_KHRONOS_validation")
    {
        common::no_gpu("the layer VK_LAYER_KHRONOS_validation is not installed (package vulkan-validationlayers)");
        return;
    }
    for trouble in ["VALIDATION", "VUID", "ERROR", "WARN"] {
        assert!(!messages.contains(trouble), "{messages}");
    }
}

/// The test above can fail: wgpu does say so when the layer is missing.
#[test]
fn a_missing_layer_is_noticed() {
    if !common::has_gpu() {
        return;
    }
    let output = Command::new(env!("CARGO_BIN_EXE_raystream"))
        .args(["devices", "--validation"])
        .env("VK_LAYER_PATH", "/nonexistent")
        .output()
        .expect("the binary runs");
    let messages = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(messages.contains("unable to find layer"), "{messages}");
}

#[test]
fn naga_translates_the_kernels() {
    if !common::has_gpu() {
        return;
    }
    let output = raystream(&[&TINY_RENDER[..], &["--naga"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
