//! The checked-in SPIR-V is what the sources were compiled to, and is what the host's table of
//! kernels says.

#[path = "../../xtask/src/digest.rs"]
mod digest;

use raystream::exec::SceneBuffers;
use raystream::exec::kernels::{Access, table::ALL};
use rspirv::dr::{Instruction, Module, Operand, load_bytes};
use rspirv::spirv::{
    Capability, Decoration, ExecutionMode, ExecutionModel, MemoryModel, Op, StorageClass,
};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::fs;
use std::path::Path;

/// What the module and the table say of one kernel.
#[derive(Clone, Debug, PartialEq)]
struct Interface {
    local_size: [u32; 3],
    /// By descriptor set and binding number.
    bindings: BTreeMap<(u32, u32), Access>,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the crate lies in the repository")
}

fn module() -> Module {
    let bytes = fs::read(root().join(digest::MODULE)).expect("the compiled kernels are checked in");
    load_bytes(bytes).unwrap_or_else(|error| panic!("{} is not SPIR-V: {error}", digest::MODULE))
}

/// Comparing by lines lets a checkout have its system's line ends.
#[test]
fn sources_are_those_that_were_compiled() {
    let compiled =
        fs::read_to_string(root().join(digest::DIGEST)).expect("the digest is checked in");
    let current = digest::current(root()).expect("the sources are readable");
    let compiled: BTreeSet<_> = compiled.lines().collect();
    let current: BTreeSet<_> = current.lines().collect();
    let changed: Vec<_> = compiled.symmetric_difference(&current).collect();
    assert!(
        changed.is_empty(),
        "run `cargo shaders` and commit the result: these changed since it ran:\n{changed:#?}"
    );
}

#[test]
fn entry_points_are_the_table_of_kernels() {
    let table: BTreeMap<_, _> = ALL
        .iter()
        .map(|kernel| {
            let bindings = (0..)
                .zip(kernel.bindings)
                .map(|(number, binding)| ((0, number), as_declared(binding.access)))
                .collect();
            (
                kernel.name.to_owned(),
                Interface { local_size: [kernel.workgroup_size, 1, 1], bindings },
            )
        })
        .collect();
    assert_eq!(table.len(), ALL.len(), "two kernels of the table have the same name");
    let compiled = interfaces(&module());
    let names =
        |interfaces: &BTreeMap<String, Interface>| interfaces.keys().cloned().collect::<Vec<_>>();
    assert_eq!(
        names(&compiled),
        names(&table),
        "kernels of the module (left) and of the table (right)"
    );
    for kernel in ALL {
        let (compiled, mut expected) = (&compiled[kernel.name], table[kernel.name].clone());
        // The compiler drops the buffers of a scene that a kernel does not look at; any other
        // binding that only the table has is one too many.
        expected.bindings.retain(|place, _| {
            let name = kernel.bindings[place.1 as usize].name;
            compiled.bindings.contains_key(place) || !SceneBuffers::<()>::NAMES.contains(&name)
        });
        let name = kernel.name;
        assert_eq!(
            compiled, &expected,
            "kernel {name}, in the module (left) and in the table (right)"
        );
    }
}

#[test]
fn module_needs_no_more_than_wgpu_enables() {
    let module = module();
    let header = module.header.as_ref().expect("a module has a header");
    assert_eq!(header.version(), (1, 3));
    let operands = |instructions: &[Instruction]| {
        instructions.iter().flat_map(|i| i.operands.clone()).collect::<Vec<_>>()
    };
    assert_eq!(operands(&module.capabilities), [Operand::Capability(Capability::Shader)]);
    assert_eq!(operands(&module.extensions), []);
    let memory_model = module.memory_model.as_ref().expect("a module declares its memory model");
    assert_eq!(memory_model.operands[1], Operand::MemoryModel(MemoryModel::GLSL450));
}

#[test]
fn module_has_no_debug_information() {
    let is_debug = |instruction: &&Instruction| {
        let opcode = instruction.class.opcode;
        matches!(
            opcode,
            Op::String
                | Op::Source
                | Op::Name
                | Op::MemberName
                | Op::ModuleProcessed
                | Op::Line
                | Op::NoLine
        )
    };
    let module = module();
    let found: Vec<_> = module.all_inst_iter().filter(is_debug).collect();
    assert!(found.is_empty(), "{found:?}");
}

/// naga refuses such types. They come of closures that capture slices, and of those that call them.
#[test]
fn no_type_holds_a_pointer() {
    let mut pointers = HashSet::new();
    for global in &module().types_global_values {
        let mut parts = global.operands.iter().filter_map(Operand::id_ref_any);
        match global.class.opcode {
            Op::TypePointer => pointers.extend(global.result_id),
            Op::TypeStruct | Op::TypeArray | Op::TypeRuntimeArray => {
                assert!(!parts.any(|part| pointers.contains(&part)), "{global:?}");
            }
            _ => {}
        }
    }
}

/// Reads the interfaces of all entry points, by name.
fn interfaces(module: &Module) -> BTreeMap<String, Interface> {
    let buffers = buffers(module);
    let interface = |entry_point: &Instruction| {
        let [
            Operand::ExecutionModel(model),
            Operand::IdRef(function),
            Operand::LiteralString(name),
            ..,
        ] = entry_point.operands.as_slice()
        else {
            panic!("unexpected operands: {entry_point:?}");
        };
        assert_eq!(*model, ExecutionModel::GLCompute, "{name}");
        let mut bindings = BTreeMap::new();
        for id in ids_used(module, *function) {
            if let Some((place, access)) = buffers.get(&id) {
                let other = bindings.insert(*place, *access);
                assert_eq!(other, None, "kernel {name} binds two variables at {place:?}");
            }
        }
        (name.clone(), Interface { local_size: local_size(module, *function), bindings })
    };
    let interfaces: BTreeMap<_, _> = module.entry_points.iter().map(interface).collect();
    assert_eq!(interfaces.len(), module.entry_points.len(), "two entry points have the same name");
    interfaces
}

/// What SPIR-V says of an access: not how lanes share what they write among themselves.
fn as_declared(access: Access) -> Access {
    if access.writes() { Access::Write } else { access }
}

/// The variables that are bound to buffers: their places and how they may be accessed.
///
/// A storage buffer is read-only when it is declared so: rust-gpu decorates a parameter `&[T]` with
/// NonWritable, and that, not whether a store happens to be there, is what a driver and a
/// validation layer go by.
fn buffers(module: &Module) -> HashMap<u32, ((u32, u32), Access)> {
    let mut decorations: HashMap<u32, HashMap<Decoration, Option<u32>>> = HashMap::new();
    for annotation in &module.annotations {
        if let [Operand::IdRef(target), Operand::Decoration(decoration), value @ ..] =
            annotation.operands.as_slice()
        {
            let value = match value {
                [Operand::LiteralBit32(value)] => Some(*value),
                _ => None,
            };
            decorations.entry(*target).or_default().insert(*decoration, value);
        }
    }
    let variables = module
        .types_global_values
        .iter()
        .filter(|instruction| instruction.class.opcode == Op::Variable);
    variables
        .filter_map(|variable| {
            let id = variable.result_id.expect("a variable has an id");
            let is =
                |decoration| decorations.get(&id).is_some_and(|all| all.contains_key(&decoration));
            let number = |decoration| *decorations.get(&id)?.get(&decoration)?;
            let access = match variable.operands[0] {
                Operand::StorageClass(StorageClass::Uniform) => Access::Uniform,
                Operand::StorageClass(StorageClass::StorageBuffer)
                    if is(Decoration::NonWritable) =>
                {
                    Access::Read
                }
                Operand::StorageClass(StorageClass::StorageBuffer) => Access::Write,
                Operand::StorageClass(
                    StorageClass::Input | StorageClass::Private | StorageClass::Workgroup,
                ) => {
                    return None;
                }
                _ => panic!("the executors bind no such variable: {variable:?}"),
            };
            let place = (number(Decoration::DescriptorSet), number(Decoration::Binding));
            let (Some(set), Some(binding)) = place else {
                panic!("a buffer that is not bound: {variable:?}")
            };
            Some((id, ((set, binding), access)))
        })
        .collect()
}

/// The size of an entry point's workgroups.
fn local_size(module: &Module, entry_point: u32) -> [u32; 3] {
    let of_entry_point = |mode: &&Instruction| mode.operands[0] == Operand::IdRef(entry_point);
    let modes: Vec<_> = module.execution_modes.iter().filter(of_entry_point).collect();
    let [mode] = modes.as_slice() else {
        panic!("other execution modes than LocalSize: {modes:?}")
    };
    let [
        _,
        Operand::ExecutionMode(ExecutionMode::LocalSize),
        Operand::LiteralBit32(x),
        Operand::LiteralBit32(y),
        Operand::LiteralBit32(z),
    ] = mode.operands.as_slice()
    else {
        panic!("another execution mode than LocalSize: {mode:?}");
    };
    [*x, *y, *z]
}

/// All ids that a function and the functions that it calls refer to.
fn ids_used(module: &Module, function: u32) -> HashSet<u32> {
    let functions: HashMap<_, _> =
        module.functions.iter().map(|function| (function.def_id(), function)).collect();
    let mut used = HashSet::new();
    let mut pending = vec![function];
    while let Some(id) = pending.pop() {
        if used.insert(id)
            && let Some(function) = functions.get(&Some(id))
        {
            let operands = function.all_inst_iter().flat_map(|instruction| &instruction.operands);
            pending.extend(operands.filter_map(Operand::id_ref_any));
        }
    }
    used
}
