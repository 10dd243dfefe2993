//! What a comparison of devices finds: kernels that are as a driver might make them, or wrong in one
//! number.

use raystream::exec::cpu::CpuExecutor;
use raystream::exec::devices::OpenOptions;
use raystream::exec::kernels::SPIRV;
use raystream::exec::{Device, Paired, Parting, Table};
use raystream::render::{IntegratorKind, Settings};
use raystream::scene::{FilmSize, load_named};
use raystream_tests::{prepare, render_on, with_gpu};
use rspirv::binary::Assemble;
use rspirv::dr::{Instruction, Module, Operand, load_words};
use rspirv::spirv::{Op, Word};

/// The highest coefficient of the sine, which stands nowhere else.
const SINE: f32 = -1.951_529e-4;

/// The kernels' module, for changes.
struct Mutant {
    module: Module,
}

impl Mutant {
    fn new() -> Self {
        Self { module: load_words(bytemuck::pod_collect_to_vec::<u8, u32>(SPIRV)).unwrap() }
    }

    /// A table of the changed kernels.
    fn table(self) -> Table {
        let bytes: Vec<u8> = bytemuck::pod_collect_to_vec(&self.module.assemble());
        Table { spirv: bytes.leak(), kernels: &[] }
    }

    fn new_id(&mut self) -> Word {
        let header = self.module.header.as_mut().unwrap();
        header.bound += 1;
        header.bound - 1
    }

    /// The constant of a number with these bits.
    fn constant(&mut self, number: f32) -> &mut Instruction {
        let bits = [Operand::LiteralBit32(number.to_bits())];
        let mut globals = self.module.types_global_values.iter_mut();
        let constant =
            globals.find(|global| global.class.opcode == Op::Constant && global.operands == bits);
        constant.unwrap_or_else(|| panic!("no constant {number}"))
    }

    /// Puts for every instruction of a kernel what `of` makes of it.
    fn rewrite(
        &mut self,
        kernel: &str,
        mut of: impl FnMut(&mut Self, &[Instruction], Instruction) -> Vec<Instruction>,
    ) {
        let name = Operand::LiteralString(kernel.into());
        let entry = self.module.entry_points.iter().find(|entry| entry.operands[2] == name);
        let id = entry.unwrap().operands[1].id_ref_any();
        let place = self.module.functions.iter().position(|function| function.def_id() == id);
        let place = place.unwrap();
        for block in 0..self.module.functions[place].blocks.len() {
            let instructions = &mut self.module.functions[place].blocks[block].instructions;
            let before = std::mem::take(instructions);
            let mut after = Vec::new();
            for instruction in before {
                let changed = of(self, &after, instruction);
                after.extend(changed);
            }
            self.module.functions[place].blocks[block].instructions = after;
        }
    }
}

/// What a render by the mutant parts from the CPU in, with the rest of the module exact.
fn partings_of(table: Table) -> Vec<Parting> {
    let options = OpenOptions::default().with_exact(true).with_table(table);
    let gpu = match Device::open_with("gpu", options) {
        Ok(Device::Gpu(gpu)) => gpu,
        Ok(_) => unreachable!("the GPU that was asked for is the CPU"),
        Err(error) => panic!("{error}"),
    };
    let scene = load_named("cornell_ball").unwrap();
    let size = FilmSize { width: 12, height: 9 };
    // Its kernels are small.
    let integrator = IntegratorKind::Compaction;
    let settings = Settings { size, integrator, ..Settings::for_scene(&scene) };
    let pair = Paired::new(CpuExecutor, &*gpu);
    drop(render_on(&pair, &prepare(&scene), &settings, 4));
    pair.partings()
}

/// Asserts that the kernel `name` is the only one in which devices part, and that a lane of it is
/// named with what it reads.
fn assert_place(partings: &[Parting], name: &str) {
    let kernels: Vec<_> = partings.iter().map(|parting| parting.kernel).collect();
    assert_eq!(kernels, [name]);
    let parting = &partings[0];
    assert!(!parting.read.is_empty() && !parting.parameters.is_empty());
    let text = parting.to_string();
    assert!(text.contains(&format!("part in kernel {name}, launch ")), "{text}");
    assert!(text.contains("elements differ, first"), "{text}");
    for difference in &parting.differences {
        assert!(difference.differing > 0 && difference.after[0] != difference.after[1], "{text}");
    }
}

fn binary(op: Op, kind: Option<Word>, result: Option<Word>, operands: [Word; 2]) -> Instruction {
    Instruction::new(op, kind, result, operands.map(Operand::IdRef).to_vec())
}

fn ids(instruction: &Instruction) -> Vec<Word> {
    instruction.operands.iter().filter_map(Operand::id_ref_any).collect()
}

/// The control of the others: a module that is taken apart and put together is as it was.
#[test]
fn a_module_without_a_mutation_is_the_cpus() {
    with_gpu(|_| assert!(partings_of(Mutant::new().table()).is_empty()));
}

/// As a driver that makes of `a / b` what `a` is times the reciprocal of `b`.
#[test]
fn a_quotient_that_is_a_drivers_own_is_found() {
    with_gpu(|_| {
        let mut mutant = Mutant::new();
        let one = mutant.constant(1.0).result_id.unwrap();
        mutant.rewrite("trace_queue", |mutant, _, instruction| {
            if instruction.class.opcode != Op::FDiv {
                return vec![instruction];
            }
            let [a, b] = ids(&instruction).try_into().unwrap();
            let kind = instruction.result_type;
            let reciprocal = mutant.new_id();
            vec![
                binary(Op::FDiv, kind, Some(reciprocal), [one, b]),
                binary(Op::FMul, kind, instruction.result_id, [a, reciprocal]),
            ]
        });
        assert_place(&partings_of(mutant.table()), "trace_queue");
    });
}

/// As a driver that fuses products with sums: `a * b + c` and what was rounded off `a * b`.
#[test]
fn a_product_that_is_fused_with_a_sum_is_found() {
    with_gpu(|_| {
        let mut mutant = Mutant::new();
        let split = mutant.new_id();
        let one = mutant.constant(1.0).clone();
        let number = one.result_type;
        // 2^12 + 1: halves of numbers, whose products are exact (Dekker 1971).
        let bits = vec![Operand::LiteralBit32(4097f32.to_bits())];
        mutant.module.types_global_values.push(Instruction::new(
            Op::Constant,
            number,
            Some(split),
            bits,
        ));
        mutant.rewrite("trace_queue", |mutant, before, instruction| {
            let product = ids(&instruction).first().and_then(|&first| {
                let product = before.iter().find(|i| i.result_id == Some(first))?;
                (product.class.opcode == Op::FMul).then(|| product.clone())
            });
            match product {
                Some(product)
                    if instruction.class.opcode == Op::FAdd
                        && instruction.result_type == number =>
                {
                    fused(mutant, &product, &instruction, split)
                }
                _ => vec![instruction],
            }
        });
        assert_place(&partings_of(mutant.table()), "trace_queue");
    });
}

/// `sum` with what its `product` leaves out.
fn fused(
    mutant: &mut Mutant,
    product: &Instruction,
    sum: &Instruction,
    split: Word,
) -> Vec<Instruction> {
    let number = sum.result_type;
    let mut all = Vec::new();
    let mut compute = |op, a, b| {
        let id = mutant.new_id();
        all.push(binary(op, number, Some(id), [a, b]));
        id
    };
    let [a, b] = ids(product).try_into().unwrap();
    let [[a, low_a], [b, low_b]] = [a, b].map(|x| {
        let scaled = compute(Op::FMul, split, x);
        let rest = compute(Op::FSub, scaled, x);
        let high = compute(Op::FSub, scaled, rest);
        [high, compute(Op::FSub, x, high)]
    });
    let high = compute(Op::FMul, a, b);
    let mut left = compute(Op::FSub, high, product.result_id.unwrap());
    for (a, b) in [(a, low_b), (low_a, b), (low_a, low_b)] {
        let part = compute(Op::FMul, a, b);
        left = compute(Op::FAdd, left, part);
    }
    let [_, c] = ids(sum).try_into().unwrap();
    let together = compute(Op::FAdd, left, c);
    let fused = [product.result_id.unwrap(), together];
    all.push(binary(Op::FAdd, number, sum.result_id, fused));
    all
}

/// A sine whose highest coefficient is off by a hundredth.
#[test]
fn a_coefficient_that_is_another_is_found() {
    with_gpu(|_| {
        let mut mutant = Mutant::new();
        mutant.constant(SINE).operands = vec![Operand::LiteralBit32((SINE * 1.01).to_bits())];
        assert_place(&partings_of(mutant.table()), "shade_queue");
    });
}
