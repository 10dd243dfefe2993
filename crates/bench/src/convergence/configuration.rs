//! What is measured against what: integrator, allocator, estimator, the error's measure, and the
//! filter of the picture.

use crate::each_once;
use raystream::render::{AllocatorKind, Estimator, FilterKind, IntegratorKind, Sampling, Settings};

/// One way to spend samples, and who computes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Configuration {
    /// Who turns samples into radiance.
    pub integrator: IntegratorKind,
    /// Who decides which pixels a round samples.
    pub allocator: AllocatorKind,
    /// What the error of a pixel is taken to be.
    pub estimator: Estimator,
    /// Whether errors are relative to the brightness of their pixel.
    pub relative: bool,
    /// What takes noise out of the picture, if anything.
    pub filter: Option<FilterKind>,
}

impl Configuration {
    /// Every pixel equally, and no filter: what the others with `integrator` are measured against.
    pub const fn uniform(integrator: IntegratorKind) -> Self {
        let Sampling { allocator, estimator, relative, .. } = Sampling::UNIFORM;
        Self { integrator, allocator, estimator, relative, filter: None }
    }

    /// For each integrator uniform sampling first, then every combination of the other three lists;
    /// all of these without a filter and with each of `filters`; each once. So the first of all is
    /// what all are measured against.
    pub fn combinations(
        integrators: &[IntegratorKind],
        allocators: &[AllocatorKind],
        estimators: &[Estimator],
        relative: &[bool],
        filters: &[FilterKind],
    ) -> Vec<Self> {
        let mut all = Vec::new();
        for &integrator in integrators {
            let uniform = Self::uniform(integrator);
            let mut ways = vec![uniform];
            for &allocator in allocators.iter().filter(|&&a| a != AllocatorKind::Uniform) {
                for &estimator in estimators {
                    let way = |&relative| Self { allocator, estimator, relative, ..uniform };
                    ways.extend(relative.iter().map(way));
                }
            }
            for way in ways {
                all.push(way);
                all.extend(filters.iter().map(|&filter| Self { filter: Some(filter), ..way }));
            }
        }
        each_once(all)
    }

    /// Whether this is uniform sampling, which asks no estimator.
    pub fn is_uniform(self) -> bool {
        self.allocator == AllocatorKind::Uniform
    }

    /// How samples are spent: `uniform`, `runs-bilateral`, `runs-bilateral-relative` ...; and what
    /// the picture is filtered with: `uniform+nlm`.
    fn sampling_name(self) -> String {
        let filter = self.filter.map_or_else(String::new, |filter| format!("+{filter}"));
        if self.is_uniform() {
            return format!("{}{filter}", self.allocator);
        }
        let measure = if self.relative { "-relative" } else { "" };
        format!("{}-{}{measure}{filter}", self.allocator.name(), self.estimator.name())
    }

    /// What it is called among `all`: `runs-bilateral` where all have one integrator, else
    /// `lvc-runs-bilateral`.
    pub fn name_among(self, all: &[Self]) -> String {
        if all.iter().all(|other| other.integrator == self.integrator) {
            return self.sampling_name();
        }
        format!("{}-{}", self.integrator.name(), self.sampling_name())
    }

    /// `settings` with this configuration's choices; `base` says what else there is to sampling.
    pub fn settings(self, settings: &Settings, base: Sampling) -> Settings {
        let sampling = Sampling {
            allocator: self.allocator,
            estimator: self.estimator,
            relative: self.relative,
            ..base
        };
        Settings { integrator: self.integrator, sampling, denoise: self.filter, ..*settings }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use AllocatorKind::{Atomic, Runs, Uniform};
    use Estimator::{Bilateral, Variance};
    use IntegratorKind::{Lvc, Megakernel, Streaming};

    fn names(all: &[Configuration]) -> Vec<String> {
        all.iter().map(|c| c.name_among(all)).collect()
    }

    #[test]
    fn uniform_comes_once_and_the_others_in_all_combinations() {
        let all = Configuration::combinations(
            &[Megakernel],
            &[Runs, Uniform, Atomic, Runs],
            &[Bilateral, Variance],
            &[false, true],
            &[],
        );
        assert_eq!(
            names(&all),
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
        assert!(all.iter().all(|c| c.integrator == Megakernel));
        assert_eq!(
            Configuration::combinations(&[Lvc], &[Uniform], &[Bilateral], &[true], &[]),
            [Configuration::uniform(Lvc)]
        );
    }

    #[test]
    fn every_integrator_has_its_own_and_is_named_where_there_are_several() {
        let all = Configuration::combinations(
            &[Streaming, Lvc, Streaming],
            &[Runs, Uniform],
            &[Bilateral, Variance],
            &[false],
            &[],
        );
        assert_eq!(
            names(&all),
            [
                "streaming-uniform",
                "streaming-runs-bilateral",
                "streaming-runs-variance",
                "lvc-uniform",
                "lvc-runs-bilateral",
                "lvc-runs-variance",
            ]
        );
        assert_eq!(all[0], Configuration::uniform(Streaming));
        assert_eq!(all[3], Configuration::uniform(Lvc));
        assert_eq!(
            names(&Configuration::combinations(&[Lvc, Lvc], &[Runs], &[Bilateral], &[true], &[])),
            ["uniform", "runs-bilateral-relative"]
        );
    }

    #[test]
    fn everything_is_measured_with_and_without_filters() {
        let filters = [FilterKind::Nlm, FilterKind::Bilateral, FilterKind::Nlm];
        let all =
            Configuration::combinations(&[Lvc], &[Uniform, Runs], &[Variance], &[false], &filters);
        assert_eq!(
            names(&all),
            [
                "uniform",
                "uniform+nlm",
                "uniform+bilateral",
                "runs-variance",
                "runs-variance+nlm",
                "runs-variance+bilateral",
            ]
        );
        assert_eq!(all[0], Configuration::uniform(Lvc));
    }
}
