//! How a run of a program ended.

use std::process::Output;

/// How a run of a program ended.
pub struct Run {
    /// Exit status; none after a signal.
    pub status: Option<i32>,
    /// All that it wrote there.
    pub stdout: String,
    /// All that it wrote there.
    pub stderr: String,
}

impl Run {
    /// That of a program whose output was taken.
    #[track_caller]
    pub fn new(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).expect("the program writes UTF-8");
        Self {
            status: output.status.code(),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        }
    }

    /// It ended well.
    #[track_caller]
    pub fn succeeded(self) -> Self {
        assert_eq!(self.status, Some(0), "stdout: {}\nstderr: {}", self.stdout, self.stderr);
        self
    }

    /// It failed with status 2 and an error; stderr says all of `parts`.
    #[track_caller]
    pub fn failed(self, parts: &[&str]) -> Self {
        assert_eq!(self.status, Some(2), "stdout: {}\nstderr: {}", self.stdout, self.stderr);
        assert!(self.errors().next().is_some(), "{}", self.stderr);
        assert!(!self.stderr.contains("a bug in raystream"), "{}", self.stderr);
        self.says(parts)
    }

    /// It failed with status 2 and one error, which says all of `parts`, however many processes it
    /// had.
    #[track_caller]
    pub fn failed_once(self, parts: &[&str]) -> Self {
        let failed = self.failed(&[]);
        let errors: Vec<_> = failed.errors().collect();
        assert_eq!(errors.len(), 1, "{}", failed.stderr);
        for part in parts {
            assert!(errors[0].contains(part), "{:?} does not say {part:?}", errors[0]);
        }
        failed
    }

    /// Stderr says all of `parts`.
    #[track_caller]
    pub fn says(self, parts: &[&str]) -> Self {
        for part in parts {
            assert!(self.stderr.contains(part), "{:?} does not say {part:?}", self.stderr);
        }
        self
    }

    fn errors(&self) -> impl Iterator<Item = &str> {
        self.stderr.lines().filter(|line| line.starts_with("error: "))
    }
}
