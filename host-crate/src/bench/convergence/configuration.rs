//! What is measured against what: allocator, estimator, and the error's measure.

use crate::render::{AllocatorKind, Estimator, Sampling};
use clap::ValueEnum;

/// One way to spend samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Configuration {
    /// Who decides which pixels a round samples.
    pub allocator: AllocatorKind,
    /// What the error of a pixel is taken to be.
    pub estimator: Estimator,
    /// Whether errors are relative to the brightness of their pixel.
    pub relative: bool,
}

impl Configuration {
    /// Every pixel equally: what all others are measured against.
    pub const UNIFORM: Self = Self {
        allocator: Sampling::UNIFORM.allocator,
        estimator: Sampling::UNIFORM.estimator,
        relative: Sampling::UNIFORM.relative,
    };

    /// Uniform sampling first, then every combination of the three lists, each once.
    pub fn combinations(allocators: &[AllocatorKind], estimators: &[Estimator], relative: &[bool]) -> Vec<Self> {
        let mut all = vec![Self::UNIFORM];
        for &allocator in allocators.iter().filter(|&&a| a != AllocatorKind::Uniform) {
            for &estimator in estimators {
                for &relative in relative {
                    let configuration = Self { allocator, estimator, relative };
                    if !all.contains(&configuration) {
                        all.push(configuration);
                    }
                }
            }
        }
        all
    }

    /// Whether this is uniform sampling, which asks no estimator.
    pub fn is_uniform(self) -> bool {
        self.allocator == AllocatorKind::Uniform
    }

    /// `uniform`, `runs-bilateral`, `runs-bilateral-relative` ...
    pub fn name(self) -> String {
        if self.is_uniform() {
            return value_name(&self.allocator);
        }
        let measure = if self.relative { "-relative" } else { "" };
        format!("{}-{}{measure}", value_name(&self.allocator), value_name(&self.estimator))
    }

    /// `base` with this configuration's choices.
    pub fn sampling(self, base: Sampling) -> Sampling {
        Sampling { allocator: self.allocator, estimator: self.estimator, relative: self.relative, ..base }
    }
}

/// What the command line calls a value.
pub fn value_name(value: &impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniform_comes_once_and_the_others_in_all_combinations() {
        use AllocatorKind::{Atomic, Runs, Uniform};
        use Estimator::{Bilateral, Variance};
        let all = Configuration::combinations(&[Runs, Uniform, Atomic, Runs], &[Bilateral, Variance], &[false, true]);
        let names: Vec<_> = all.iter().map(|c| c.name()).collect();
        assert_eq!(
            names,
            [
                "uniform",
                "runs-bilateral",
                "runs-bilateral-relative",
                "runs-variance",
                "runs-variance-relative",
                "atomic-bilateral",
                "atomic-bilateral-relative",
                "atomic-variance",
                "atomic-variance-relative",
            ]
        );
        assert_eq!(Configuration::combinations(&[Uniform], &[Bilateral], &[true]), [Configuration::UNIFORM]);
    }
}
