//! Every kernel is one that WebGPU takes: translated to WGSL, as a browser would be given it.

use naga::back::wgsl;
use naga::front::spv;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, Module, Statement};
use raystream::exec::kernels::table::ALL;

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

/// What naga says of a module, with nothing but what every WebGPU device has: uniform control flow
/// at barriers is part of it.
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

/// For each barrier that a block leads to, whether it stands in a branch.
fn barriers(module: &Module, block: &[Statement], in_branch: bool, found: &mut Vec<bool>) {
    for statement in block {
        match statement {
            Statement::ControlBarrier(_) => found.push(in_branch),
            Statement::Call { function, .. } => {
                barriers(module, &module.functions[*function].body, in_branch, found);
            }
            Statement::Block(inner) => barriers(module, inner, in_branch, found),
            Statement::If { accept, reject, .. } => {
                barriers(module, accept, true, found);
                barriers(module, reject, true, found);
            }
            Statement::Switch { cases, .. } => {
                cases.iter().for_each(|case| barriers(module, &case.body, true, found));
            }
            Statement::Loop { body, continuing, .. } => {
                barriers(module, body, in_branch, found);
                barriers(module, continuing, in_branch, found);
            }
            _ => {}
        }
    }
}

/// Browsers see uniform control flow by structure: no barrier may stand in a branch. (naga itself
/// does not look.)
#[test]
fn barriers_stand_in_no_branch() {
    let all = kernels();
    let mut with_barriers = 0;
    for entry in &all.entry_points {
        let mut found = Vec::new();
        barriers(&all, &entry.function.body, false, &mut found);
        with_barriers += usize::from(!found.is_empty());
        assert!(!found.contains(&true), "{}: a barrier in a branch", entry.name);
    }
    assert!(with_barriers > 0, "phased kernels have barriers");
}

/// The tests can fail.
#[test]
fn what_a_browser_refuses_is_found() {
    assert_eq!(
        refused_literal("let x = 340282350000000000000000000000000000000f;"),
        Some("340282350000000000000000000000000000000f")
    );
    assert_eq!(refused_literal("let x = 100000000000000000000000000000000000000f; y = 3u;"), None);
    let divergent = "@compute @workgroup_size(4) fn f(@builtin(local_invocation_index) i: u32) {
        if i < 2u { workgroupBarrier(); } }";
    let module = naga::front::wgsl::parse_str(divergent).unwrap();
    let mut found = Vec::new();
    barriers(&module, &module.entry_points[0].function.body, false, &mut found);
    assert_eq!(found, [true]);
}
