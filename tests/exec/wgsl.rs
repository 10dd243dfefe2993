//! Every kernel is one that WebGPU takes: translated to WGSL, as a browser would be given it.

use naga::back::wgsl;
use naga::front::spv;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, Module};
use raystream::exec::kernels::table::ALL;

use super::uniformity::divergent_barriers;

const SPIRV: &[u8] = include_bytes!("../../host-crate/shaders/kernels.spv");

/// Storage buffers of a kernel that WebGPU promises on every device.
const STORAGE_BUFFERS: usize = 8;

fn kernels() -> Module {
    let options = spv::Options { strict_capabilities: true, ..spv::Options::default() };
    spv::parse_u8_slice(SPIRV, &options).expect("naga reads the kernels")
}

/// The module of one entry point alone.
fn alone(all: &Module, index: usize) -> Module {
    let mut module = all.clone();
    module.entry_points = vec![module.entry_points.swap_remove(index)];
    naga::compact::compact(&mut module, naga::compact::KeepUnused::No);
    module
}

/// What naga says of a module, with nothing but what every WebGPU device has. Barriers it does
/// not look at.
fn validated(module: &Module, what: &str) -> ModuleInfo {
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(module)
        .unwrap_or_else(|error| panic!("{what}: {}", error.emit_to_string("")))
}

/// A decimal literal that a reader of WGSL must refuse, if there is one: not finite, or above
/// `f32::MAX` before it is rounded.
fn refused_literal(text: &str) -> Option<&str> {
    text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '.')).find(|word| {
        let number = word.strip_suffix('f').unwrap_or(word);
        word.starts_with(|c: char| c.is_ascii_digit())
            && number.parse::<f64>().is_ok_and(|value| value > f64::from(f32::MAX))
    })
}

#[test]
fn every_kernel_becomes_wgsl_that_is_read_back() {
    let all = kernels();
    assert_eq!(all.entry_points.len(), ALL.len());
    for index in 0..all.entry_points.len() {
        let module = alone(&all, index);
        let name = &module.entry_points[0].name;
        let info = validated(&module, name);
        let flags = wgsl::WriterFlags::empty();
        let text = wgsl::write_string(&module, &info, flags).expect("WGSL can say it");
        assert_eq!(refused_literal(&text), None, "{name}");
        let read = naga::front::wgsl::parse_str(&text)
            .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(&text)));
        validated(&read, name);
        assert_eq!(divergent_barriers(&read), 0, "{name}: barriers that not all threads reach");
    }
}

#[test]
fn no_kernel_binds_more_than_webgpu_promises() {
    let all = kernels();
    for index in 0..all.entry_points.len() {
        let module = alone(&all, index);
        let is_storage = |space| matches!(space, AddressSpace::Storage { .. });
        let buffers = module.global_variables.iter().filter(|(_, v)| is_storage(v.space)).count();
        assert!(buffers <= STORAGE_BUFFERS, "{}: {buffers}", module.entry_points[0].name);
    }
    for kernel in ALL {
        let buffers = kernel.bindings.len() - 1;
        assert!(buffers <= STORAGE_BUFFERS, "{}: {buffers}", kernel.name);
    }
}

/// The tests can fail.
#[test]
fn what_a_browser_refuses_is_found() {
    assert_eq!(
        refused_literal("let x = 340282350000000000000000000000000000000f;"),
        Some("340282350000000000000000000000000000000f")
    );
    assert_eq!(refused_literal("let x = 100000000000000000000000000000000000000f; y = 3u;"), None);
    let barriers = |body: &str| {
        let text = format!(
            "@group(0) @binding(0) var<storage> data: array<u32>;
            var<private> copied: u32;
            @compute @workgroup_size(64) fn main(
                @builtin(workgroup_id) group: vec3u,
                @builtin(local_invocation_index) lane: u32,
            ) {{ {body} }}"
        );
        divergent_barriers(&naga::front::wgsl::parse_str(&text).expect("WGSL"))
    };
    assert_eq!(barriers("workgroupBarrier();"), 0);
    assert_eq!(barriers("if group.x < 3u { workgroupBarrier(); }"), 0);
    assert_eq!(barriers("if data[group.x] < 3u { workgroupBarrier(); }"), 0);
    assert_eq!(barriers("if data[lane] < 3u { workgroupBarrier(); }"), 1);
    assert_eq!(barriers("if lane < 3u { return; } workgroupBarrier();"), 1);
    assert_eq!(barriers("if lane < 3u {} workgroupBarrier();"), 0);
    assert_eq!(barriers("for (var i = 0u; i < 4u; i++) { workgroupBarrier(); }"), 0);
    assert_eq!(barriers("for (var i = 0u; i < lane; i++) { workgroupBarrier(); }"), 1);
    assert_eq!(
        barriers("loop { workgroupBarrier(); if lane < 3u { break; } } workgroupBarrier();"),
        1
    );
    assert_eq!(barriers("copied = group.x; if copied < 3u { workgroupBarrier(); }"), 1);
}
