//! Launches: a kernel, its parameters, and the parts of buffers that it works on.

use super::kernels::Kernel;
use super::scene_buffers::SceneUses;
use super::{ExecError, Executor};
use bytemuck::Pod;
use std::marker::PhantomData;
use std::time::Duration;

/// A part of a buffer, as a launch holds it.
#[derive(Debug)]
pub struct RawView<'a, B> {
    pub(super) buffer: &'a B,
    pub(super) first_byte: u64,
    pub(super) bytes: u64,
}

impl<'a, B> RawView<'a, B> {
    /// The buffer.
    pub fn buffer(&self) -> &'a B {
        self.buffer
    }

    /// Where the part begins.
    pub fn first_byte(&self) -> u64 {
        self.first_byte
    }

    /// How long it is.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// Elements of `T` in a part of a buffer, as a kernel is given them.
pub struct View<'a, B, T> {
    raw: RawView<'a, B>,
    element: PhantomData<T>,
}

impl<'a, B, T: Pod> View<'a, B, T> {
    /// `len` elements of `buffer` from number `first` on.
    pub(super) fn new(buffer: &'a B, first: usize, len: usize) -> Self {
        let size = size_of::<T>() as u64;
        let raw = RawView { buffer, first_byte: first as u64 * size, bytes: len as u64 * size };
        Self { raw, element: PhantomData }
    }

    /// The same bytes as elements of another type, for a kernel that reads them in another way.
    pub fn cast<U: Pod>(self) -> View<'a, B, U> {
        View { raw: self.raw, element: PhantomData }
    }

    /// The part of the buffer.
    pub fn raw(self) -> RawView<'a, B> {
        self.raw
    }
}

/// One run of a kernel. The functions of [`kernels`](super::kernels) make them.
pub struct Launch<'a, B> {
    pub(super) kernel: &'static Kernel,
    pub(super) parameters: Vec<u8>,
    pub(super) views: Vec<RawView<'a, B>>,
    pub(super) scene: SceneUses<'a>,
}

impl<'a, B> Launch<'a, B> {
    /// The run of a `kernel` of another table than this project's, with its `parameters` and its
    /// other bindings in their order.
    ///
    /// # Panics
    /// If there are more or fewer `views` than bindings, or the parameters have no room for the
    /// number of threads that they begin with.
    pub fn new(
        kernel: &'static Kernel,
        parameters: &impl bytemuck::NoUninit,
        views: Vec<RawView<'a, B>>,
    ) -> Self {
        Self::on_scene(kernel, parameters, views, SceneUses::default())
    }

    /// The same on a `scene`, if there is one.
    pub(super) fn on_scene(
        kernel: &'static Kernel,
        parameters: &impl bytemuck::NoUninit,
        views: Vec<RawView<'a, B>>,
        scene: SceneUses<'a>,
    ) -> Self {
        assert_eq!(views.len() + 1, kernel.bindings.len(), "bindings of {}", kernel.name);
        assert!(size_of_val(parameters) >= size_of::<u32>(), "parameters of {}", kernel.name);
        Self { kernel, parameters: bytemuck::bytes_of(parameters).to_vec(), views, scene }
    }

    /// The same run, with each buffer replaced by what `buffer` makes of it.
    pub(super) fn with_buffers<C>(&self, buffer: impl Fn(&'a B) -> &'a C) -> Launch<'a, C> {
        let views = self.views.iter().map(|view| RawView {
            buffer: buffer(view.buffer),
            first_byte: view.first_byte,
            bytes: view.bytes,
        });
        Launch {
            kernel: self.kernel,
            parameters: self.parameters.clone(),
            views: views.collect(),
            scene: self.scene,
        }
    }

    /// The kernel.
    pub fn kernel(&self) -> &'static Kernel {
        self.kernel
    }

    /// The parameter block: binding 0, a uniform.
    pub fn parameters(&self) -> &[u8] {
        &self.parameters
    }

    /// The other bindings, from number 1 on, in their order.
    pub fn views(&self) -> &[RawView<'a, B>] {
        &self.views
    }

    /// The [abilities](raystream_shaders::scene::abilities) that the kernel is to be compiled for; 0
    /// without a scene.
    pub fn abilities(&self) -> u32 {
        self.scene.abilities
    }

    /// Lanes, before they are rounded up to whole workgroups.
    pub fn threads(&self) -> u32 {
        bytemuck::pod_read_unaligned(&self.parameters[..4])
    }
}

/// Runs launches on the executor whose own buffers `buffer` takes theirs for: what an executor that
/// is one of several does. They are copied for it: some hundred bytes each, which is little beside
/// what a launch costs anyway.
///
/// # Errors
/// Those of the executor.
pub fn run_over<'a, B, E: Executor>(
    executor: &E,
    parts: &[&[Launch<'a, B>]],
    buffer: fn(&B) -> &E::Buffer,
) -> Result<Vec<Duration>, ExecError> {
    let of_part = |part: &&[Launch<'a, B>]| -> Vec<_> {
        part.iter().map(|launch| launch.with_buffers(buffer)).collect()
    };
    let parts: Vec<Vec<_>> = parts.iter().map(of_part).collect();
    executor.run_parts(&parts.iter().map(Vec::as_slice).collect::<Vec<_>>())
}
