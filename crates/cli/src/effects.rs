//! Options that have no effect beside others: a warning says so.

use super::output::say;
use clap::ArgMatches;
use clap::parser::ValueSource;
use raystream::exec::Device;
use raystream::render::{AllocatorKind, Estimator, FilterKind, IntegratorKind, Sampling, Settings};
use raystream::scene::{Projection, Scene};

/// The options that stand on the command line, by their ids.
pub struct Given(Vec<String>);

/// What the options of a command depend on. By default everything is there that an option may need.
pub struct Facts {
    /// Integrators that render.
    pub integrators: Vec<IntegratorKind>,
    /// How samples are spent, in each render.
    pub samplings: Vec<Sampling>,
    /// Whether whole paths are traced.
    pub traces_paths: bool,
    /// Whether what `--integrator` names is used.
    pub uses_integrator: bool,
    /// The filters of pictures.
    pub filters: Vec<FilterKind>,
    /// Whether a GPU renders.
    pub on_gpu: bool,
    /// Whether a PNG is written.
    pub writes_png: bool,
    /// Whether there is a file to write.
    pub has_output: bool,
    /// How the camera sees, where there is one.
    pub projection: Option<Projection>,
}

impl Default for Facts {
    fn default() -> Self {
        Self {
            integrators: IntegratorKind::ALL.to_vec(),
            samplings: vec![Sampling::ADAPTIVE],
            traces_paths: true,
            uses_integrator: true,
            filters: Vec::new(),
            on_gpu: true,
            writes_png: true,
            has_output: true,
            projection: None,
        }
    }
}

impl Facts {
    /// Those that follow from the device; the others by default.
    pub fn of_device(device: &Device) -> Self {
        Self { on_gpu: !matches!(device, Device::Cpu(..)), ..Self::default() }
    }

    /// Those of a render that begins now.
    pub fn of_render(settings: &Settings, scene: &Scene, device: &Device) -> Self {
        Self {
            filters: settings.denoise.into_iter().collect(),
            integrators: vec![settings.integrator],
            samplings: vec![settings.sampling],
            projection: Some(scene.camera.projection),
            ..Self::of_device(device)
        }
    }

    fn is_adaptive(&self) -> bool {
        self.samplings.iter().any(|sampling| sampling.allocator != AllocatorKind::Uniform)
    }

    fn filters_bilaterally(&self) -> bool {
        self.filters.iter().any(|kind| [FilterKind::Auto, FilterKind::Bilateral].contains(kind))
            || self.estimate_by(&[Estimator::Auto, Estimator::Bilateral])
    }

    /// Whether errors are estimated by one of `estimators`.
    fn estimate_by(&self, estimators: &[Estimator]) -> bool {
        self.samplings.iter().any(|sampling| {
            let estimates =
                sampling.allocator != AllocatorKind::Uniform || sampling.noise.is_some();
            estimates && estimators.contains(&sampling.estimator)
        })
    }

    /// Whether the estimator decides about anything: errors, or how samples are split.
    fn uses_estimator(&self) -> bool {
        self.estimate_by(Estimator::ALL)
            || self.samplings.iter().any(|sampling| sampling.estimator.needs_halves())
    }

    /// Whether samples would be in halves only if somebody asked for that.
    fn has_no_halves(&self) -> bool {
        self.filters.is_empty()
            && self.samplings.iter().any(|sampling| {
                Sampling { halves: true, ..*sampling }.split()
                    != Sampling { halves: false, ..*sampling }.split()
            })
    }
}

/// Options that have an effect only sometimes.
struct Rule {
    options: &'static [&'static str],
    has_effect: fn(&Facts) -> bool,
    /// Why they have none, after "has no effect".
    why: &'static str,
}

/// Of several rules for an option all must hold.
const RULES: &[Rule] = &[
    Rule {
        options: &[
            "integrator",
            "max_depth",
            "rr_depth",
            "light_paths",
            "connections",
            "no_light_tracing",
            "pixel_filter",
            "pixel_filter_width",
        ],
        has_effect: |facts| facts.traces_paths,
        why: "where no paths are traced",
    },
    Rule {
        options: &["light_paths", "connections", "no_light_tracing"],
        has_effect: |facts| facts.integrators.contains(&IntegratorKind::Lvc),
        why: "without the integrator lvc (--integrator lvc)",
    },
    Rule {
        options: &["integrator"],
        has_effect: |facts| facts.uses_integrator,
        why: "beside --integrators and --reference-integrator",
    },
    Rule {
        options: &["relative", "initial_spp", "round_budget", "estimators", "errors"],
        has_effect: Facts::is_adaptive,
        why: "with --allocator uniform, which does not go by errors",
    },
    Rule {
        options: &["estimator"],
        has_effect: Facts::uses_estimator,
        why: "with --allocator uniform, unless --noise asks for errors",
    },
    Rule {
        options: &[
            "filter_radius",
            "filter_position",
            "filter_normal",
            "filter_albedo",
            "filter_features_only",
        ],
        has_effect: Facts::filters_bilaterally,
        why: "where neither the estimator nor a filter is bilateral, which auto has too",
    },
    Rule {
        options: &["no_smoothing"],
        has_effect: |facts| facts.estimate_by(&[Estimator::Halves, Estimator::Variance]),
        why: "where nothing asks for the errors of the estimators halves or variance",
    },
    Rule {
        options: &["halves"],
        has_effect: Facts::has_no_halves,
        why: "where samples are in halves anyway",
    },
    Rule {
        options: &["exposure", "tone_map"],
        has_effect: |facts| facts.writes_png,
        why: "without a .png picture (-o picture.png)",
    },
    Rule { options: &["naga", "validation"], has_effect: |facts| facts.on_gpu, why: "on the CPU" },
    Rule {
        options: &["exact"],
        has_effect: |facts| facts.on_gpu,
        why: "on the CPU, which is what GPUs are exact to",
    },
    Rule {
        options: &["aperture", "focus"],
        has_effect: |facts| {
            facts.projection.is_none_or(|p| matches!(p, Projection::Perspective { .. }))
        },
        why: "by a camera that is not perspective",
    },
    Rule {
        options: &["focus"],
        has_effect: |facts| facts.projection.is_none_or(|projection| projection.has_lens()),
        why: "without a lens (--aperture)",
    },
    Rule { options: &["gain"], has_effect: |facts| facts.has_output, why: "without -o" },
];

impl Given {
    /// Those of the command, or command of a command, that was called.
    pub fn of(matches: &ArgMatches) -> Self {
        let mut matches = matches;
        while let Some((_, of_command)) = matches.subcommand() {
            matches = of_command;
        }
        let is_given = |id: &&str| matches.value_source(id) == Some(ValueSource::CommandLine);
        let ids = matches.ids().map(clap::Id::as_str);
        // Groups of options have ids too, and no source.
        let options = ids.filter(|id| RULES.iter().any(|rule| rule.options.contains(id)));
        Self(options.filter(is_given).map(str::to_owned).collect())
    }

    /// Warns of each that has no effect.
    pub fn warn(&self, facts: &Facts) {
        for warning in self.without_effect(facts) {
            say(&format!("warning: {warning}"));
        }
    }

    /// Says of each that has no effect, why.
    pub fn without_effect(&self, facts: &Facts) -> Vec<String> {
        let broken = |id: &str| {
            RULES.iter().find(|rule| rule.options.contains(&id) && !(rule.has_effect)(facts))
        };
        let warnings = self.0.iter().filter_map(|id| {
            Some(format!("--{} has no effect {}", id.replace('_', "-"), broken(id)?.why))
        });
        warnings.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::{Command, CommandFactory};

    /// Options that always do something.
    const ALWAYS: &[&str] = &[
        "allocator",
        "allocators",
        "arguments",
        "at",
        "bvh",
        "cache",
        "camera",
        "checkpoint",
        "checkpoint_every",
        "checks",
        "denoise",
        "device",
        "environment",
        "environment_rotation",
        "environment_strength",
        "film",
        "films",
        "filter",
        "filters",
        "fps",
        "frames",
        "help",
        "instances",
        "integrators",
        "json",
        "levels",
        "max_memory",
        "noise",
        "output",
        "panorama",
        "part",
        "picture",
        "png_layers",
        "quiet",
        "ray_offset",
        "reference",
        "reference_integrator",
        "reference_samples",
        "reference_spp",
        "renders",
        "repetitions",
        "sampler",
        "scene",
        "scenes",
        "seed",
        "size",
        "sky",
        "spp",
        "stream",
        "test",
        "tev",
        "threads",
        "time",
        "truth_spp",
        "variant",
        "verbose",
        "version",
    ];

    fn options(command: &Command) -> Vec<String> {
        let own = command.get_arguments().map(|argument| argument.get_id().to_string());
        own.chain(command.get_subcommands().flat_map(options)).collect()
    }

    /// Whoever adds an option says when it has an effect.
    #[test]
    fn every_option_is_here() {
        let ruled = |id: &str| RULES.iter().any(|rule| rule.options.contains(&id));
        let mut command = crate::Arguments::command();
        command.build();
        let options = options(&command);
        for id in &options {
            let known = ALWAYS.contains(&id.as_str()) || id == "subcommand";
            assert!(known != ruled(id), "--{id}: has it always an effect, or by a rule?");
        }
        for id in ALWAYS.iter().chain(RULES.iter().flat_map(|rule| rule.options)) {
            assert!(options.iter().any(|option| option == id), "no command has {id}");
        }
    }

    #[test]
    fn what_depends_on_the_sampling() {
        let warned = |id: &str, sampling: Sampling| {
            let facts = Facts { samplings: vec![sampling], ..Facts::default() };
            !Given(vec![id.into()]).without_effect(&facts).is_empty()
        };
        let (uniform, adaptive) = (Sampling::UNIFORM, Sampling::ADAPTIVE);
        let noise = Sampling { noise: Some(0.1), ..uniform };
        let paper = Sampling { allocator: AllocatorKind::Paper, ..adaptive };
        let halves = Sampling { estimator: Estimator::Halves, ..uniform };
        for (id, sampling, expected) in [
            ("relative", uniform, true),
            ("relative", noise, true),
            ("relative", adaptive, false),
            ("estimator", uniform, true),
            ("estimator", halves, false),
            ("estimator", noise, false),
            ("filter_radius", adaptive, false),
            ("filter_radius", noise, true),
            ("no_smoothing", noise, false),
            ("no_smoothing", adaptive, true),
            ("halves", adaptive, true),
            ("halves", paper, false),
            ("halves", uniform, false),
            ("halves", halves, true),
            ("light_paths", uniform, false),
        ] {
            assert_eq!(warned(id, sampling), expected, "{id} with {sampling:?}");
        }
    }
}
