//! A kernel's own part of the module of all kernels.
//!
//! NVIDIA's driver gives every pipeline the workgroup memory of all variables of its module,
//! whichever kernels use them, and with it go registers and cache. So each pipeline is made of a
//! module that has one entry point, the functions that it calls, and what these name: variables,
//! constants and types.
//!
//! In it the word of [abilities](raystream_shaders::scene::abilities) is no specialisation constant
//! any more but the scene's own. wgpu has no way to give one to a driver, and like this every
//! compiler on the way, naga too, knows the branches that are dead.

use super::exact::{Exact, make_exact};
use raystream_shaders::scene::abilities::ABILITIES;
use rspirv::binary::Assemble;
use rspirv::dr::{Function, Instruction, Module, Operand, load_words};
use rspirv::spirv::{Decoration, Op};
use std::collections::{HashMap, HashSet};

/// The module of all kernels, taken apart.
pub struct Kernels {
    module: Module,
    /// Where each function is, by its id.
    functions: HashMap<u32, usize>,
}

impl Kernels {
    /// Takes `words` apart, and makes what they compute [exact](super::exact) if it is to be.
    ///
    /// # Errors
    /// Why they are no SPIR-V, or what of them cannot be exact.
    pub fn parse(words: &[u32], exact: Option<Exact>) -> Result<Self, String> {
        let mut module = load_words(words).map_err(|error| format!("its kernels: {error}"))?;
        if let Some(exact) = exact {
            make_exact(&mut module, exact)?;
        }
        let functions = module.functions.iter().enumerate();
        let functions = functions.filter_map(|(place, f)| Some((f.def_id()?, place))).collect();
        Ok(Self { module, functions })
    }

    /// The module with the entry point `name` alone, for scenes that use `abilities`, as words.
    ///
    /// # Errors
    /// That there is none of that name.
    pub fn alone(&self, name: &str, abilities: u32) -> Result<Vec<u32>, String> {
        let text = Operand::LiteralString(name.into());
        let is_named = |entry: &&Instruction| entry.operands.get(2) == Some(&text);
        let missing = || format!("there is no kernel '{name}'");
        let entry = self.module.entry_points.iter().find(is_named).ok_or_else(missing)?;
        let main = entry.operands[1].id_ref_any().ok_or_else(missing)?;
        let kept = self.reached_from(main);
        let functions: Vec<Function> =
            kept.iter().map(|&place| self.module.functions[place].clone()).collect();
        let module = &self.module;
        let interface = entry.operands.iter().filter_map(Operand::id_ref_any);
        let globals = self.globals(interface.chain(functions.iter().flat_map(ids)), abilities);
        let mut there: HashSet<u32> = functions.iter().flat_map(results).collect();
        there.extend(globals.iter().filter_map(|global| global.result_id));
        let is_there = |about: &&Instruction| {
            let target = about.operands.first().and_then(Operand::id_ref_any);
            target.is_none_or(|id| there.contains(&id)) && !is_specialisation(about)
        };
        let modes = module.execution_modes.iter();
        let alone = Module {
            header: module.header.clone(),
            capabilities: module.capabilities.clone(),
            extensions: module.extensions.clone(),
            ext_inst_imports: module.ext_inst_imports.clone(),
            memory_model: module.memory_model.clone(),
            entry_points: vec![entry.clone()],
            execution_modes: modes
                .filter(|mode| mode.operands[0].id_ref_any() == Some(main))
                .cloned()
                .collect(),
            debug_string_source: module.debug_string_source.clone(),
            debug_module_processed: module.debug_module_processed.clone(),
            debug_names: module.debug_names.iter().filter(is_there).cloned().collect(),
            annotations: module.annotations.iter().filter(is_there).cloned().collect(),
            types_global_values: globals,
            functions,
        };
        Ok(alone.assemble())
    }

    /// The types, constants and variables with these ids, and those that they name, in the module's
    /// order; with `abilities` for the word of abilities.
    fn globals(&self, named: impl Iterator<Item = u32>, abilities: u32) -> Vec<Instruction> {
        let mut needed: HashSet<u32> = named.collect();
        let switches = self.switches();
        let mut kept = Vec::new();
        // What a global names stands before it.
        for global in self.module.types_global_values.iter().rev() {
            let Some(id) = global.result_id.filter(|id| needed.contains(id)) else { continue };
            needed.extend(ids_of(global));
            let is_switch = switches.contains(&id);
            kept.push(if is_switch { constant(global, abilities) } else { global.clone() });
        }
        kept.reverse();
        kept
    }

    /// The specialisation constants that hold the abilities: one for each kernel that asks for
    /// them, or one for all.
    fn switches(&self) -> HashSet<u32> {
        let is_switch = |about: &&Instruction| {
            is_specialisation(about)
                && about.operands.get(2) == Some(&Operand::LiteralBit32(ABILITIES))
        };
        let switches = self.module.annotations.iter().filter(is_switch);
        switches.filter_map(|about| about.operands[0].id_ref_any()).collect()
    }

    /// The places of a function and of all that it calls, in the module's order.
    fn reached_from(&self, main: u32) -> Vec<usize> {
        let (mut reached, mut next) = (HashSet::new(), vec![main]);
        while let Some(id) = next.pop() {
            let Some(&place) = self.functions.get(&id) else { continue };
            if reached.insert(place) {
                let calls = self.module.functions[place].all_inst_iter();
                let calls = calls.filter(|call| call.class.opcode == Op::FunctionCall);
                next.extend(calls.filter_map(|call| call.operands[0].id_ref_any()));
            }
        }
        let mut places: Vec<usize> = reached.into_iter().collect();
        places.sort_unstable();
        places
    }
}

/// Whether an annotation makes a constant one for specialisation.
fn is_specialisation(annotation: &Instruction) -> bool {
    annotation.operands.get(1) == Some(&Operand::Decoration(Decoration::SpecId))
}

/// An ordinary constant of the value `word` in place of one for specialisation.
fn constant(special: &Instruction, word: u32) -> Instruction {
    let value = vec![Operand::LiteralBit32(word)];
    Instruction::new(Op::Constant, special.result_type, special.result_id, value)
}

/// All ids that an instruction names, its own aside.
fn ids_of(instruction: &Instruction) -> impl Iterator<Item = u32> {
    let operands = instruction.operands.iter().filter_map(Operand::id_ref_any);
    operands.chain(instruction.result_type)
}

/// All ids that a function's instructions name.
fn ids(function: &Function) -> Vec<u32> {
    function.all_inst_iter().flat_map(ids_of).collect()
}

/// All ids that a function's instructions define.
fn results(function: &Function) -> Vec<u32> {
    function.all_inst_iter().filter_map(|instruction| instruction.result_id).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exec::kernels::{SPIRV, table};

    fn kernels() -> Kernels {
        Kernels::parse(&bytemuck::pod_collect_to_vec(SPIRV), None).unwrap()
    }

    #[test]
    fn every_kernel_alone_is_a_module_with_one_entry_point_and_all_that_it_names() {
        let kernels = kernels();
        for kernel in table::ALL {
            let alone = load_words(kernels.alone(kernel.name, 0).unwrap()).unwrap();
            assert_eq!(alone.entry_points.len(), 1, "{}", kernel.name);
            let mut there: HashSet<u32> = alone.functions.iter().flat_map(results).collect();
            there.extend(alone.types_global_values.iter().filter_map(|global| global.result_id));
            there.extend(alone.ext_inst_imports.iter().filter_map(|import| import.result_id));
            there.extend(alone.debug_string_source.iter().filter_map(|text| text.result_id));
            let interface = alone.entry_points.iter().flat_map(|entry| &entry.operands);
            let named = alone.functions.iter().flat_map(ids);
            for id in named.chain(interface.filter_map(Operand::id_ref_any)) {
                assert!(there.contains(&id), "{}: %{id}", kernel.name);
            }
        }
    }

    #[test]
    fn a_kernel_whose_lanes_do_not_cooperate_has_no_workgroup_memory() {
        use rspirv::spirv::StorageClass::Workgroup;
        let kernels = kernels();
        let variables = |name: &str| {
            let alone = load_words(kernels.alone(name, 0).unwrap()).unwrap();
            let is_shared = |global: &&Instruction| {
                global.operands.first() == Some(&Operand::StorageClass(Workgroup))
                    && global.class.opcode == Op::Variable
            };
            alone.types_global_values.iter().filter(is_shared).count()
        };
        assert_eq!(variables("trace_paths"), 0);
        assert_eq!(variables("sum_blocks"), 1);
        assert!(kernels.alone("no such kernel", 0).is_err());
    }

    #[test]
    fn a_kernel_alone_has_the_abilities_of_its_scene_as_an_ordinary_constant() {
        let kernels = kernels();
        let is_special = |instruction: &Instruction| {
            matches!(
                instruction.class.opcode,
                Op::SpecConstant | Op::SpecConstantTrue | Op::SpecConstantFalse
            ) || instruction.operands.contains(&Operand::Decoration(Decoration::SpecId))
        };
        assert!(kernels.module.all_inst_iter().any(is_special), "some kernel asks for abilities");
        for kernel in table::ALL {
            let alone = |abilities| kernels.alone(kernel.name, abilities).unwrap();
            let [without, with] = [0, 0x5eed].map(alone);
            let module = load_words(&with).unwrap();
            assert!(!module.all_inst_iter().any(is_special), "{}", kernel.name);
            let changed: Vec<_> =
                without.iter().zip(&with).filter(|(without, with)| without != with).collect();
            assert_eq!(without.len(), with.len());
            assert!(changed.iter().all(|&change| change == (&0, &0x5eed)), "{}", kernel.name);
            let asks = ["trace_paths", "shade_queue", "first_hits", "trace_eye_paths"];
            assert!(!asks.contains(&kernel.name) || changed.len() == 1, "{}", kernel.name);
        }
    }
}
