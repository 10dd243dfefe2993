//! What the CPU has made of a stage beside a GPU.

use raystream::exec::Parting;
use serde::Serialize;

/// Whether the two have written the same bytes, in this round and those before.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Beside {
    /// Whether they have.
    pub same: bool,
    /// The same in words, with what differs.
    pub text: String,
}

impl Beside {
    /// Of what `kernels` have computed, where devices part in `partings`.
    pub fn of(kernels: &[&str], partings: &[Parting]) -> Self {
        let parted = partings.iter().filter(|parting| kernels.contains(&parting.kernel));
        let words: Vec<String> = parted.map(words).collect();
        if words.is_empty() {
            let text = "CPU and GPU have written the same bytes in all rounds so far.".to_owned();
            return Self { same: true, text };
        }
        let text = format!(
            "CPU and GPU differ: {}. GPUs round quotients, roots and products with sums in their \
             own ways. The CPU goes on with what the GPU has written.",
            words.join("; ")
        );
        Self { same: false, text }
    }
}

fn words(parting: &Parting) -> String {
    let first = parting.differences.iter().map(|difference| {
        format!("{} of {} {}", difference.differing, difference.of, difference.binding)
    });
    let differing = first.collect::<Vec<_>>().join(" and ");
    format!("{} in launch {}, {differing}", parting.kernel, parting.launch)
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream::exec::Difference;

    #[test]
    fn what_differs_is_told_of_the_stage_that_it_is_of() {
        let difference = Difference {
            binding: "errors",
            element: 3,
            is_lane: true,
            differing: 7,
            of: 40,
            before: String::new(),
            after: <[String; 2]>::default(),
        };
        let parting = Parting {
            devices: <[String; 2]>::default(),
            kernel: "filter_errors",
            launch: 12,
            launches: 1,
            threads: 40,
            parameters: String::new(),
            differences: vec![difference],
            read: Vec::new(),
        };
        let told = Beside::of(&["filter_errors"], std::slice::from_ref(&parting));
        assert!(!told.same && told.text.contains("filter_errors in launch 12, 7 of 40 errors"));
        assert!(Beside::of(&["run_starts"], &[parting]).same);
        assert!(Beside::of(&["run_starts"], &[]).same);
    }
}
