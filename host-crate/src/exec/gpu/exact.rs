//! The exact module, made of the fast one: no product is fused with a sum, and functions of the
//! project's own stand for those that drivers compute in ways of their own.
//!
//! [`raystream_shaders::math::exact`] has the functions and says what for.

use raystream_shaders::math::exact::{CALLED, Function as ExactFunction};
use rspirv::dr::{Function, Instruction, Module, Operand};
use rspirv::spirv::{Capability, Decoration, ExecutionMode, GlslStd450Op, Op};
use std::collections::HashMap;

/// The kernel that calls the functions.
const CALLER: &str = "calculate";

/// How kernels are made exact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exact {
    /// Whether quotients and roots are found by an `fma` that rounds once, or else by integers: on
    /// any device.
    pub by_fma: bool,
    /// Whether the device is asked to keep subnormal numbers, as only one may be that
    /// [can](super::float_controls::keeps_subnormals).
    pub keeps_subnormals: bool,
}

/// What is estimated by the device's own.
const ESTIMATED: [ExactFunction; 4] = [
    ExactFunction::Quotient,
    ExactFunction::Root,
    ExactFunction::FusedQuotient,
    ExactFunction::FusedRoot,
];

/// Makes `module`, of all kernels, exact.
///
/// # Errors
/// What in it has no exact counterpart.
pub fn make_exact(module: &mut Module, exact: Exact) -> Result<(), String> {
    let mut calls = Calls::of(module, exact.by_fma);
    let mut kept_apart = Vec::new();
    for function in &mut module.functions {
        let is_estimate = ESTIMATED.iter().any(|&of| calls.is_function(of, function));
        for instructions in function.blocks.iter_mut().map(|block| &mut block.instructions) {
            if !is_estimate {
                let mut exact = Vec::with_capacity(instructions.len());
                for instruction in instructions.drain(..) {
                    calls.rewrite(instruction, &mut exact)?;
                }
                *instructions = exact;
            }
            let rounded = instructions.iter().filter(|i| is_rounded(i.class.opcode));
            kept_apart.extend(rounded.filter_map(|instruction| instruction.result_id));
        }
    }
    module.annotations.extend(kept_apart.into_iter().map(|id| {
        let decoration = Operand::Decoration(Decoration::NoContraction);
        Instruction::new(Op::Decorate, None, None, vec![Operand::IdRef(id), decoration])
    }));
    if let Some(header) = &mut module.header {
        header.bound = calls.next_id;
    }
    control_floats(module, exact.keeps_subnormals);
    Ok(())
}

/// Asks for sums and products rounded to the nearest number, for zeros that keep their signs, and
/// for subnormal numbers if they are to be kept: float controls of Vulkan 1.2.
fn control_floats(module: &mut Module, keeps_subnormals: bool) {
    let mut controls = vec![
        (Capability::RoundingModeRTE, ExecutionMode::RoundingModeRTE),
        (Capability::SignedZeroInfNanPreserve, ExecutionMode::SignedZeroInfNanPreserve),
    ];
    if keeps_subnormals {
        controls.push((Capability::DenormPreserve, ExecutionMode::DenormPreserve));
    }
    let name = Operand::LiteralString("SPV_KHR_float_controls".into());
    module.extensions.push(Instruction::new(Op::Extension, None, None, vec![name]));
    for (capability, mode) in controls {
        let capability = vec![Operand::Capability(capability)];
        module.capabilities.push(Instruction::new(Op::Capability, None, None, capability));
        let modes = module.entry_points.iter().filter_map(|entry| {
            let id = entry.operands[1].id_ref_any()?;
            let mode = [Operand::IdRef(id), Operand::ExecutionMode(mode), BITS];
            Some(Instruction::new(Op::ExecutionMode, None, None, mode.to_vec()))
        });
        module.execution_modes.extend(modes);
    }
}

/// The width of the numbers that kernels compute with.
const BITS: Operand = Operand::LiteralBit32(32);

/// Whether an instruction's result is rounded, so that a driver may fuse it with another.
fn is_rounded(opcode: Op) -> bool {
    matches!(
        opcode,
        Op::FAdd | Op::FSub | Op::FMul | Op::FNegate | Op::VectorTimesScalar | Op::FDiv
    )
}

/// Calls of the functions that stand for a driver's.
struct Calls {
    /// The ids of the functions, in the order of [`CALLED`], if the module has them.
    ids: Option<[u32; CALLED.len()]>,
    /// The type of what they take and return.
    number: Option<u32>,
    /// The types of vectors of such numbers, and their lengths.
    vectors: HashMap<u32, u32>,
    next_id: u32,
    /// Whether quotients and roots are those by `fma`.
    fused: bool,
}

impl Calls {
    /// Of those that `module` calls from [`CALLER`].
    fn of(module: &Module, fused: bool) -> Self {
        let name = Operand::LiteralString(CALLER.into());
        let entry = module.entry_points.iter().find(|entry| entry.operands.get(2) == Some(&name));
        let id = entry.and_then(|entry| entry.operands[1].id_ref_any());
        let caller = module.functions.iter().filter(|function| function.def_id() == id);
        let is_call = |call: &&Instruction| call.class.opcode == Op::FunctionCall;
        let calls: Vec<_> = caller.flat_map(Function::all_inst_iter).filter(is_call).collect();
        let ids: Vec<_> = calls.iter().filter_map(|call| call.operands[0].id_ref_any()).collect();
        let number = calls.first().and_then(|call| call.result_type);
        let vectors = module.types_global_values.iter().filter_map(|global| {
            match global.operands.as_slice() {
                [Operand::IdRef(of), Operand::LiteralBit32(length)]
                    if global.class.opcode == Op::TypeVector && Some(*of) == number =>
                {
                    Some((global.result_id?, *length))
                }
                _ => None,
            }
        });
        Self {
            ids: ids.try_into().ok(),
            number,
            vectors: vectors.collect(),
            next_id: module.header.as_ref().map_or(0, |header| header.bound),
            fused,
        }
    }

    /// The id of a function, if the module has it.
    fn id(&self, function: ExactFunction) -> Option<u32> {
        let place = CALLED.iter().position(|&called| called == function)?;
        self.ids.map(|ids| ids[place])
    }

    /// Whether this is the module's own function.
    fn is_function(&self, function: ExactFunction, of_module: &Function) -> bool {
        self.id(function).is_some_and(|id| of_module.def_id() == Some(id))
    }

    fn new_id(&mut self) -> u32 {
        self.next_id += 1;
        self.next_id - 1
    }

    /// Puts into `exact` what computes what `instruction` does: itself, or calls.
    fn rewrite(
        &mut self,
        instruction: Instruction,
        exact: &mut Vec<Instruction>,
    ) -> Result<(), String> {
        let Some((function, first)) = stands_for(&instruction)? else {
            exact.push(instruction);
            return Ok(());
        };
        let arguments: Vec<u32> =
            instruction.operands[first..].iter().filter_map(Operand::id_ref_any).collect();
        let function = self.called(function)?;
        let Instruction { result_type, result_id, .. } = instruction;
        if result_type == self.number {
            exact.push(self.call(function, result_id, &arguments));
            return Ok(());
        }
        let length = result_type.and_then(|kind| self.vectors.get(&kind).copied());
        let length = length.ok_or("an operation on other than numbers and vectors of them")?;
        let mut components = Vec::new();
        for component in 0..length {
            let of_component = arguments.iter().map(|&argument| {
                let id = self.new_id();
                let operands = vec![Operand::IdRef(argument), Operand::LiteralBit32(component)];
                let kind = self.number;
                exact.push(Instruction::new(Op::CompositeExtract, kind, Some(id), operands));
                id
            });
            let of_component: Vec<u32> = of_component.collect();
            let id = self.new_id();
            exact.push(self.call(function, Some(id), &of_component));
            components.push(Operand::IdRef(id));
        }
        exact.push(Instruction::new(Op::CompositeConstruct, result_type, result_id, components));
        Ok(())
    }

    /// The id of what is called for a function.
    fn called(&self, function: ExactFunction) -> Result<u32, String> {
        let function = match function {
            ExactFunction::Quotient if self.fused => ExactFunction::FusedQuotient,
            ExactFunction::Root if self.fused => ExactFunction::FusedRoot,
            other => other,
        };
        self.id(function).ok_or_else(|| {
            format!(
                "{function:?} must not be left to the driver, but the module lacks the kernel \
                 '{CALLER}' that calls what stands for it"
            )
        })
    }

    /// A call of the function with the id `function`; its result has the id `result`.
    fn call(&self, function: u32, result: Option<u32>, arguments: &[u32]) -> Instruction {
        let ids = std::iter::once(function).chain(arguments.iter().copied());
        let operands: Vec<_> = ids.map(Operand::IdRef).collect();
        Instruction::new(Op::FunctionCall, self.number, result, operands)
    }
}

/// The function that is to stand for an instruction, if any, and which of its operands is the first
/// argument.
fn stands_for(instruction: &Instruction) -> Result<Option<(ExactFunction, usize)>, String> {
    let function = match instruction.class.opcode {
        Op::FDiv => return Ok(Some((ExactFunction::Quotient, 0))),
        Op::ExtInst => {
            let Operand::LiteralExtInstInteger(number) = instruction.operands[1] else {
                return Ok(None);
            };
            match GlslStd450Op::from_u32(number) {
                Some(GlslStd450Op::Exp) => ExactFunction::Exponential,
                Some(GlslStd450Op::Log) => ExactFunction::Logarithm,
                Some(GlslStd450Op::Pow) => ExactFunction::Power,
                Some(GlslStd450Op::Atan2) => ExactFunction::Angle,
                Some(GlslStd450Op::Sqrt) => ExactFunction::Root,
                Some(
                    GlslStd450Op::FAbs
                    | GlslStd450Op::Floor
                    | GlslStd450Op::Ceil
                    | GlslStd450Op::FindILsb
                    | GlslStd450Op::FindUMsb,
                ) => {
                    return Ok(None);
                }
                other => return Err(format!("{other:?} has no exact function")),
            }
        }
        Op::FRem | Op::FMod | Op::Dot | Op::MatrixTimesVector => {
            return Err(format!("{} has no exact function", instruction.class.opname));
        }
        _ => return Ok(None),
    };
    Ok(Some((function, 2)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exec::kernels::SPIRV;
    use rspirv::dr::load_words;

    const BY_INTEGERS: Exact = Exact { by_fma: false, keeps_subnormals: false };

    fn module() -> Module {
        load_words(bytemuck::pod_collect_to_vec::<u8, u32>(SPIRV)).unwrap()
    }

    fn count(module: &Module, what: impl Fn(&Instruction) -> bool) -> usize {
        module.functions.iter().flat_map(Function::all_inst_iter).filter(|i| what(i)).count()
    }

    #[test]
    fn only_the_estimates_are_the_drivers_own() {
        let mut module = module();
        let divisions = |module: &Module| count(module, |i| i.class.opcode == Op::FDiv);
        let others = |module: &Module| count(module, |i| matches!(stands_for(i), Ok(Some((_, 2)))));
        let before = [divisions(&module), others(&module)];
        let functions = Calls::of(&module, false);
        make_exact(&mut module, BY_INTEGERS).unwrap();
        let estimates = module
            .functions
            .iter()
            .filter(|function| ESTIMATED.iter().any(|&of| functions.is_function(of, function)));
        let estimates: Vec<_> = estimates.flat_map(Function::all_inst_iter).collect();
        let is_own = |i: &&&Instruction| matches!(stands_for(i), Ok(Some(_)));
        let left =
            |op: Op| estimates.iter().filter(|i| i.class.opcode == op).filter(is_own).count();
        assert_eq!([divisions(&module), others(&module)], [Op::FDiv, Op::ExtInst].map(left));
        assert!(before[0] > 1000 && before[1] > 1000, "{before:?}");
        assert!(left(Op::FDiv) > 0 && left(Op::ExtInst) > 0);
    }

    #[test]
    fn nothing_that_is_rounded_may_be_fused() {
        let mut module = module();
        make_exact(&mut module, BY_INTEGERS).unwrap();
        let rounded = count(&module, |i| is_rounded(i.class.opcode));
        let contraction = Operand::Decoration(Decoration::NoContraction);
        let apart = module.annotations.iter().filter(|about| about.operands.contains(&contraction));
        assert_eq!(apart.count(), rounded);
    }

    #[test]
    fn what_has_no_exact_function_is_named() {
        let mut module = module();
        let division = module
            .functions
            .iter_mut()
            .flat_map(Function::all_inst_iter_mut)
            .find(|instruction| instruction.class.opcode == Op::FDiv)
            .unwrap();
        let Instruction { result_type, result_id, ref operands, .. } = *division;
        *division = Instruction::new(Op::FRem, result_type, result_id, operands.clone());
        assert!(make_exact(&mut module, BY_INTEGERS).unwrap_err().contains("FRem"));
    }

    /// Modules of others need not have the functions if they need none.
    #[test]
    fn functions_that_a_module_lacks_are_named() {
        let mut module = module();
        module
            .entry_points
            .retain(|entry| entry.operands[2] != Operand::LiteralString(CALLER.to_owned()));
        let error = make_exact(&mut module, BY_INTEGERS).unwrap_err();
        assert!(error.contains("lacks the kernel 'calculate'"), "{error}");
        let needs_none = |function: &Function| {
            function.all_inst_iter().all(|i| matches!(stands_for(i), Ok(None)))
        };
        module.functions.retain(needs_none);
        assert!(!module.functions.is_empty());
        make_exact(&mut module, BY_INTEGERS).unwrap();
    }
}
