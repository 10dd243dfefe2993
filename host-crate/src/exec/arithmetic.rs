//! How a device computes: whether sums and products are those of the CPU, and what becomes of
//! subnormal numbers.

use super::cpu::CpuExecutor;
use super::{Array, ExecError, Executor, kernels};
use bytemuck::Zeroable;
use raystream_shaders::math::exact::{CalculateParams, Operands, Results};
use raystream_shaders::math::random::hash;
use std::fmt;

/// Operands drawn by chance: as many as show a function that is off once in some hundred times.
const DRAWN: u32 = 4096;

/// What a device makes of sums, products and functions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arithmetic {
    /// What it computes otherwise than the CPU, if anything: the function, the operands and both
    /// results.
    pub other: Option<String>,
    /// What becomes of subnormal numbers.
    pub subnormals: Subnormals,
}

/// What becomes of subnormal numbers, those below 2^-126.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subnormals {
    /// They are numbers like others, as on the CPU.
    Kept,
    /// They are taken for zero, at least in part.
    Flushed,
}

impl fmt::Display for Subnormals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Kept => "it keeps subnormal numbers",
            Self::Flushed => "it takes subnormal numbers for zero",
        })
    }
}

impl Arithmetic {
    /// That of `executor`, by what it makes of some thousand operands.
    ///
    /// # Errors
    /// If it cannot run kernels.
    pub fn of(executor: &impl Executor) -> Result<Self, ExecError> {
        Self::over(executor, &operands())
    }

    /// That of `executor`, by what it makes of these operands.
    ///
    /// # Errors
    /// If it cannot run kernels.
    pub fn over(executor: &impl Executor, operands: &[Operands]) -> Result<Self, ExecError> {
        let expected = calculate(&CpuExecutor, operands)?;
        let found = calculate(executor, operands)?;
        let mut arithmetic = Self { other: None, subnormals: Subnormals::Kept };
        for ((given, expected), found) in operands.iter().zip(&expected).zip(&found) {
            for (name, of) in FUNCTIONS {
                let results = [of(found), of(expected)].map(f32::from_bits);
                if is_same(results) {
                    continue;
                }
                if is_about_subnormals(given, results[1]) {
                    arithmetic.subnormals = Subnormals::Flushed;
                } else {
                    let what = describe(name, given, results);
                    arithmetic.other.get_or_insert(what);
                }
            }
        }
        Ok(arithmetic)
    }

    /// Fails where anything is computed otherwise than on the CPU.
    ///
    /// # Errors
    /// What that is.
    pub fn check(&self) -> Result<(), String> {
        match &self.other {
            Some(other) => Err(format!("it does not compute what the CPU does: {other}")),
            None => Ok(()),
        }
    }
}

/// What is compared.
type Of = fn(&Results) -> u32;

/// All of it, by name.
const FUNCTIONS: [(&str, Of); 9] = [
    ("a + b", |results| results.sum),
    ("a * b", |results| results.product),
    ("a * b + c", |results| results.product_sum),
    ("a / b", |results| results.quotient),
    ("the root of a", |results| results.root),
    ("e to the power a", |results| results.exponential),
    ("the logarithm of a", |results| results.logarithm),
    ("a to the power b", |results| results.power),
    ("the angle of (b, a)", |results| results.angle),
];

/// Pairs of numbers of all sizes, of like size, and those at the ends of the range.
fn operands() -> Vec<Operands> {
    let drawn = (0..DRAWN).map(|k| {
        let [a, b, c] = [0, 1, 2].map(|j| hash(3 * k + j));
        match k % 3 {
            0 => [a, b, c],
            // From 1 to 4: what is fused shows.
            1 => [a, b, c].map(|bits| bits & 0x00ff_ffff | 0x3f80_0000),
            // Exponents of some use: -20 to 20.
            _ => [a, b, c].map(|bits| (bits & 0x87ff_ffff) + 0x3c00_0000),
        }
    });
    let edges = [
        0.0,
        1.0,
        f32::MIN_POSITIVE,
        0.25 * f32::MIN_POSITIVE,
        f32::MAX,
        f32::INFINITY,
        f32::NAN,
        0.333,
        1e-30,
    ];
    let edges = edges.into_iter().flat_map(|x| [x, -x]).map(f32::to_bits).collect::<Vec<_>>();
    let pairs = edges.iter().flat_map(|&a| edges.iter().map(move |&b| [a, b, 0x3f80_0000]));
    let all = drawn.chain(pairs);
    all.map(|[a, b, c]| Operands { a, b, c, ..Operands::zeroed() }).collect()
}

/// What `executor` makes of `operands`.
fn calculate<E: Executor>(executor: &E, operands: &[Operands]) -> Result<Vec<Results>, ExecError> {
    let given = Array::from_slice(executor, "operands", operands)?;
    let results = Array::zeroed(executor, "results", operands.len())?;
    let params = CalculateParams { threads: operands.len() as u32, ..CalculateParams::zeroed() };
    executor.run(&[kernels::calculate(&params, given.view(), results.view())])?;
    results.read(executor)
}

/// Whether results are the same bits, or both no number.
fn is_same([found, expected]: [f32; 2]) -> bool {
    found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan())
}

/// Whether a subnormal number is among operands, products and result.
fn is_about_subnormals(given: &Operands, expected: f32) -> bool {
    let [a, b, c] = [given.a, given.b, given.c].map(f32::from_bits);
    [a, b, c, a * b, expected].into_iter().any(f32::is_subnormal)
}

fn describe(name: &str, given: &Operands, [found, expected]: [f32; 2]) -> String {
    let [a, b, c] = [given.a, given.b, given.c].map(f32::from_bits);
    format!("{name} of a = {a:e}, b = {b:e}, c = {c:e} is {found:e} there and {expected:e} here")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cpu_computes_what_the_cpu_does() {
        let arithmetic = Arithmetic::of(&CpuExecutor).unwrap();
        assert_eq!(arithmetic, Arithmetic { other: None, subnormals: Subnormals::Kept });
        arithmetic.check().unwrap();
    }
}
