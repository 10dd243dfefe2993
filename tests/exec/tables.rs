//! Kernels of other projects: they run on the executors, and are compared, as this project's are.

use bytemuck::{Pod, Zeroable};
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::devices::OpenOptions;
use raystream::exec::{
    Access, Array, Binding, Device, ExecError, Executor, Kernel, Launch, NativeArguments, Paired,
    Table,
};
use raystream_tests::with_gpu;
use rspirv::binary::Assemble;
use rspirv::dr::{Builder, Operand};
use rspirv::spirv;

/// The parameters of the kernels here.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Params {
    threads: u32,
    added: f32,
    pad: [u32; 2],
}

const BINDINGS: &[Binding] = &[
    Binding::new::<Params>("parameters", Access::Uniform),
    Binding::new::<f32>("numbers", Access::Read),
    Binding::new::<f32>("results", Access::Write),
];

/// `x * x + added` of each number.
static SQUARES: Kernel = Kernel::new("squares", 64, BINDINGS, |arguments| {
    map(arguments, |x, added| x * x + added);
});

/// `x / added` of each number.
static QUOTIENTS: Kernel = Kernel::new("quotients", 64, BINDINGS, |arguments| {
    map(arguments, |x, added| x / added);
});

static KERNELS: &[&Kernel] = &[&SQUARES, &QUOTIENTS];

fn map(arguments: NativeArguments<'_, u32>, of: impl Fn(f32, f32) -> f32) {
    let Params { threads, added, .. } = arguments.parameters();
    let mut views = arguments.views.into_iter();
    let numbers: &[f32] = views.next().unwrap().into_slice();
    let results: &mut [f32] = views.next().unwrap().into_slice_mut();
    for (result, &x) in results.iter_mut().zip(numbers).take(threads as usize) {
        *result = of(x, added);
    }
}

/// What stands in a kernel's loop: from the number and what is added, ids both, to the result's.
type Body = fn(&mut Builder, spirv::Word, [spirv::Word; 2]) -> spirv::Word;

/// A module with an entry point for each.
fn module(kernels: &[(&Kernel, Body)]) -> &'static [u8] {
    let mut b = Builder::new();
    b.set_version(1, 3);
    b.capability(spirv::Capability::Shader);
    b.memory_model(spirv::AddressingModel::Logical, spirv::MemoryModel::GLSL450);
    let names = Names::declare(&mut b);
    for (kernel, body) in kernels {
        let main = names.function(&mut b, *body).expect("a function's instructions");
        b.entry_point(spirv::ExecutionModel::GLCompute, main, kernel.name, [names.invocation]);
        b.execution_mode(main, spirv::ExecutionMode::LocalSize, [kernel.workgroup_size, 1, 1]);
    }
    bytemuck::pod_collect_to_vec::<u32, u8>(&b.module().assemble()).leak()
}

/// What the functions of a module name.
struct Names {
    uint: spirv::Word,
    float: spirv::Word,
    /// Pointers to members of the block: integers and numbers.
    in_block: [spirv::Word; 2],
    in_storage: spirv::Word,
    /// What is bound, by its number.
    bound: [spirv::Word; 3],
    invocation: spirv::Word,
}

impl Names {
    fn declare(b: &mut Builder) -> Self {
        use spirv::{BuiltIn, Decoration, StorageClass};
        let (uint, float) = (b.type_int(32, 0), b.type_float(32, None));
        let block = b.type_struct([uint, float, uint, uint]);
        for member in 0..4 {
            let offset = [Operand::LiteralBit32(4 * member)];
            b.member_decorate(block, member, Decoration::Offset, offset);
        }
        let numbers = b.type_runtime_array(float);
        b.decorate(numbers, Decoration::ArrayStride, [Operand::LiteralBit32(4)]);
        let storage = b.type_struct([numbers]);
        b.member_decorate(storage, 0, Decoration::Offset, [Operand::LiteralBit32(0)]);
        let bound = [block, storage, storage].map(|kind| {
            let is_block = kind == block;
            let class = if is_block { StorageClass::Uniform } else { StorageClass::StorageBuffer };
            let pointer = b.type_pointer(None, class, kind);
            b.variable(pointer, None, class, None)
        });
        for (variable, number) in bound.into_iter().zip(0..) {
            b.decorate(variable, Decoration::DescriptorSet, [Operand::LiteralBit32(0)]);
            b.decorate(variable, Decoration::Binding, [Operand::LiteralBit32(number)]);
        }
        b.decorate(block, Decoration::Block, []);
        b.decorate(storage, Decoration::Block, []);
        let uint3 = b.type_vector(uint, 3);
        let input = b.type_pointer(None, StorageClass::Input, uint3);
        let invocation = b.variable(input, None, StorageClass::Input, None);
        let built_in = [Operand::BuiltIn(BuiltIn::GlobalInvocationId)];
        b.decorate(invocation, Decoration::BuiltIn, built_in);
        let in_block = [uint, float].map(|kind| b.type_pointer(None, StorageClass::Uniform, kind));
        let in_storage = b.type_pointer(None, StorageClass::StorageBuffer, float);
        Self { uint, float, in_block, in_storage, bound, invocation }
    }

    /// A function of one lane.
    fn function(&self, b: &mut Builder, body: Body) -> Result<spirv::Word, rspirv::dr::Error> {
        let Self { uint, float, in_block, in_storage, bound, invocation } = *self;
        let (void, truth) = (b.type_void(), b.type_bool());
        let uint3 = b.type_vector(uint, 3);
        let nothing = b.type_function(void, []);
        let [zero, one] = [0, 1].map(|value| b.constant_bit32(uint, value));
        let main = b.begin_function(void, None, spirv::FunctionControl::NONE, nothing)?;
        let (inside, end) = (b.id(), b.id());
        b.begin_block(None)?;
        let all = b.load(uint3, None, invocation, None, [])?;
        let lane = b.composite_extract(uint, None, all, [0])?;
        let place = b.access_chain(in_block[0], None, bound[0], [zero])?;
        let threads = b.load(uint, None, place, None, [])?;
        let is_inside = b.u_less_than(truth, None, lane, threads)?;
        b.selection_merge(end, spirv::SelectionControl::NONE)?;
        b.branch_conditional(is_inside, inside, end, [])?;
        b.begin_block(Some(inside))?;
        let place = b.access_chain(in_block[1], None, bound[0], [one])?;
        let added = b.load(float, None, place, None, [])?;
        let place = b.access_chain(in_storage, None, bound[1], [zero, lane])?;
        let x = b.load(float, None, place, None, [])?;
        let result = body(b, float, [x, added]);
        let place = b.access_chain(in_storage, None, bound[2], [zero, lane])?;
        b.store(place, result, None, [])?;
        b.branch(end)?;
        b.begin_block(Some(end))?;
        b.ret()?;
        b.end_function()?;
        Ok(main)
    }
}

fn square(b: &mut Builder, float: spirv::Word, [x, added]: [spirv::Word; 2]) -> spirv::Word {
    let product = b.f_mul(float, None, x, x).unwrap();
    b.f_add(float, None, product, added).unwrap()
}

/// As [`square`], but wrong.
fn negative(b: &mut Builder, float: spirv::Word, [x, added]: [spirv::Word; 2]) -> spirv::Word {
    let product = b.f_mul(float, None, x, x).unwrap();
    b.f_sub(float, None, product, added).unwrap()
}

fn quotient(b: &mut Builder, float: spirv::Word, [x, added]: [spirv::Word; 2]) -> spirv::Word {
    b.f_div(float, None, x, added).unwrap()
}

/// Runs [`SQUARES`] on a device of `spirv` and on the CPU at once.
fn run(spirv: &'static [u8], exact: bool) -> Result<Vec<String>, ExecError> {
    let table = Table { spirv, kernels: KERNELS };
    let options = OpenOptions::default().with_exact(exact).with_table(table);
    let Device::Gpu(gpu) = Device::open_with("gpu", options)? else { unreachable!() };
    let pair = Paired::new(CpuExecutor, &*gpu);
    let numbers: Vec<f32> = (0..100).map(|k| 1.0 + k as f32 * 0.37).collect();
    let results = Array::<_, f32>::zeroed(&pair, "results", numbers.len())?;
    let numbers = Array::from_slice(&pair, "numbers", &numbers)?;
    let params = Params { threads: 100, added: 0.1, ..Params::zeroed() };
    pair.run(&[Launch::new(&SQUARES, &params, vec![numbers.view().raw(), results.view().raw()])])?;
    let first = results.read(&pair)?[1];
    assert_eq!(first, 1.37 * 1.37 + 0.1);
    Ok(pair.partings().iter().map(ToString::to_string).collect())
}

#[test]
fn kernels_of_another_table_are_compared() {
    with_gpu(|_| {
        let right = module(&[(&SQUARES, square), (&QUOTIENTS, quotient)]);
        let found = run(right, false).unwrap();
        // A driver may fuse the product with the sum.
        assert!(found.len() <= 1, "{found:?}");
        let wrong = module(&[(&SQUARES, negative), (&QUOTIENTS, quotient)]);
        let [parting] = <[_; 1]>::try_from(run(wrong, false).unwrap()).unwrap();
        assert!(parting.contains("part in kernel squares, launch 1"), "{parting}");
        assert!(parting.contains("results: 100 of 100 elements differ, first that of lane 0"));
    });
}

/// Products and sums need no function of this project; a quotient does, and the message says so.
#[test]
fn kernels_of_another_table_can_be_exact() {
    with_gpu(|_| {
        let table = module(&[(&SQUARES, square), (&QUOTIENTS, square)]);
        assert_eq!(run(table, true).unwrap(), [""; 0]);
        let divides = module(&[(&SQUARES, square), (&QUOTIENTS, quotient)]);
        let error = run(divides, true).unwrap_err().to_string();
        assert!(error.contains("lacks the kernel 'calculate'"), "{error}");
    });
}

#[test]
fn kernels_that_a_module_lacks_are_named() {
    with_gpu(|_| {
        let error = run(module(&[(&SQUARES, square)]), false).unwrap_err().to_string();
        assert!(error.contains("there is no kernel 'quotients'"), "{error}");
    });
}
