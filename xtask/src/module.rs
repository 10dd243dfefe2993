//! The last pass over the compiled module: makes it valid for Vulkan as wgpu sets it up, small, and
//! the same bytes on every machine.

use anyhow::{Context, Result, bail, ensure};
use rspirv::binary::Assemble;
use rspirv::dr::{Module, Operand, load_bytes};
use rspirv::spirv::{AddressingModel, Capability, MemoryModel, Op};
use std::collections::{HashMap, HashSet};

/// Turns what the compiler wrote into what the renderer embeds.
pub fn finish(compiled: &[u8]) -> Result<Vec<u8>> {
    // rspirv's error borrows nothing but is not Sync, so it cannot be a source.
    let mut module = load_bytes(compiled)
        .map_err(|error| anyhow::anyhow!("the compiler's SPIR-V cannot be read: {error}"))?;
    set_memory_model(&mut module)?;
    strip_debug_information(&mut module);
    shorten_entry_points(&mut module)?;
    renumber_ids(&mut module)?;
    Ok(module.assemble().into_iter().flat_map(u32::to_le_bytes).collect())
}

/// Declares the memory model `GLSL450`.
///
/// The backend offers two others. For its Vulkan targets it declares `Vulkan`, whose capability
/// VulkanMemoryModel is a device feature that wgpu does not enable, so that the module would be
/// invalid on every device that wgpu opens. For its generic targets it declares `Simple`, which
/// Vulkan does not allow. The kernels need neither: no lane reads what another lane of the same
/// dispatch writes to a buffer, and `GLSL450` is what barriers within a workgroup mean in every
/// GLSL shader.
fn set_memory_model(module: &mut Module) -> Result<()> {
    let vulkan = Operand::Capability(Capability::VulkanMemoryModel);
    ensure!(
        module.capabilities.iter().all(|capability| !capability.operands.contains(&vulkan)),
        "the compiled kernels need the capability VulkanMemoryModel, which wgpu does not enable"
    );
    let declaration =
        module.memory_model.as_mut().context("the compiled kernels declare no memory model")?;
    declaration.operands = vec![
        Operand::AddressingModel(AddressingModel::Logical),
        Operand::MemoryModel(MemoryModel::GLSL450),
    ];
    Ok(())
}

/// Drops names, sources and line numbers. They hold absolute paths and are most of the module's
/// size.
fn strip_debug_information(module: &mut Module) {
    module.debug_string_source.clear();
    module.debug_names.clear();
    module.debug_module_processed.clear();
    let is_line = |opcode: Op| matches!(opcode, Op::Line | Op::NoLine);
    module.types_global_values.retain(|instruction| !is_line(instruction.class.opcode));
    for block in module.functions.iter_mut().flat_map(|function| &mut function.blocks) {
        block.instructions.retain(|instruction| !is_line(instruction.class.opcode));
    }
}

/// Calls the entry points by their functions' names, without the path of modules that the compiler
/// puts before them.
fn shorten_entry_points(module: &mut Module) -> Result<()> {
    let mut names = HashSet::new();
    for entry_point in &mut module.entry_points {
        let Some(Operand::LiteralString(name)) = entry_point
            .operands
            .iter_mut()
            .find(|operand| matches!(operand, Operand::LiteralString(_)))
        else {
            bail!("the compiled kernels have an entry point without a name");
        };
        if let Some((_, function)) = name.rsplit_once("::") {
            *name = function.to_owned();
        }
        ensure!(names.insert(name.clone()), "two kernels are called {name}");
    }
    Ok(())
}

/// Numbers the ids from 1 in the order in which they appear. The compiler's numbers have gaps where
/// debug information was.
fn renumber_ids(module: &mut Module) -> Result<()> {
    let mut numbers = HashMap::new();
    let mut renumber = |id: &mut u32| {
        let next = numbers.len() as u32 + 1;
        *id = *numbers.entry(*id).or_insert(next);
    };
    for instruction in module.all_inst_iter_mut() {
        instruction.result_type.iter_mut().for_each(&mut renumber);
        instruction.result_id.iter_mut().for_each(&mut renumber);
        instruction.operands.iter_mut().filter_map(Operand::id_ref_any_mut).for_each(&mut renumber);
    }
    module.header.as_mut().context("the compiled kernels have no SPIR-V header")?.bound =
        numbers.len() as u32 + 1;
    Ok(())
}
