//! The table of kernels as data, made from [`raystream_shaders::for_each_kernel!`].

#[cfg(target_arch = "x86_64")]
use super::lanes;
use super::native::{Job, NativeArguments, NativeBinding, part_of, run_all};
use super::scene_buffers::SceneUses;
use super::{Launch, SceneBuffers, Table, View};
use bytemuck::Pod;
use raystream_shaders::levels::Level;
use raystream_shaders::memory::access::{Atomics, Scatter};
use raystream_shaders::parallel::prefix::Lane;
use raystream_shaders::scene::abilities::{self, Abilities, Fixed};
use raystream_shaders::scene::{SceneView, TracingParams};
use std::fmt::Debug;
use std::sync::atomic::AtomicU32;

/// The kernels as GPUs take them, compiled by `cargo shaders`.
pub static SPIRV: &[u8] = include_bytes!("../../shaders/kernels.spv");

/// A kernel, as both executors need to know it.
#[derive(Debug)]
pub struct Kernel {
    /// Name of the SPIR-V entry point.
    pub name: &'static str,
    /// Threads of one workgroup, along x.
    pub workgroup_size: u32,
    /// What it binds; the index is the binding's number in descriptor set 0.
    pub bindings: &'static [Binding],
    /// Runs all its threads on the CPU.
    pub(super) native: fn(NativeArguments<'_, u32>),
}

impl Kernel {
    /// A kernel of another table than this project's. Its entry point and `native` compute the
    /// same; the first of the `bindings` is a uniform block that begins with the number of threads,
    /// as u32, and all are in descriptor set 0, numbered from 0 on.
    pub const fn new(
        name: &'static str,
        workgroup_size: u32,
        bindings: &'static [Binding],
        native: fn(NativeArguments<'_, u32>),
    ) -> Self {
        Self { name, workgroup_size, bindings, native }
    }

    /// Whether it works on a scene, so that it is compiled for what that uses.
    pub fn has_scene(&self) -> bool {
        self.bindings.iter().any(|binding| binding.name == SCENE_NAMES[0])
    }
}

/// One binding of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct Binding {
    /// What the table calls it.
    pub name: &'static str,
    /// What the kernel does with it.
    pub access: Access,
    /// What it is made of.
    pub element: Element,
}

impl Binding {
    /// One of elements of `T`.
    pub const fn new<T: Pod + Debug>(name: &'static str, access: Access) -> Self {
        Self { name, access, element: Element::of::<T>() }
    }
}

/// What buffers are made of.
#[derive(Clone, Copy, Debug)]
pub struct Element {
    /// Its size.
    pub bytes: usize,
    /// Its fields in words, of as many bytes.
    pub describe: fn(&[u8]) -> String,
}

impl Element {
    const fn of<T: Pod + Debug>() -> Self {
        Self {
            bytes: size_of::<T>(),
            describe: |bytes| format!("{:?}", bytemuck::pod_read_unaligned::<T>(bytes)),
        }
    }
}

/// What a kernel does with a binding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// A uniform buffer that all threads read.
    Uniform,
    /// A storage buffer that any thread reads anywhere.
    Read,
    /// A storage buffer of which each thread writes the element of its own number.
    Write,
    /// A storage buffer in which each thread writes wherever no other does.
    Scatter,
    /// A storage buffer of words that threads change by atomics.
    Atomic,
}

impl Access {
    /// Whether the kernel may change what it binds.
    pub fn writes(self) -> bool {
        matches!(self, Self::Write | Self::Scatter | Self::Atomic)
    }
}

macro_rules! kernels {
    ($(
        $(#[$doc:meta])*
        $name:ident[$workgroup:tt] $(phased($phases:expr, $Memory:ty))? = $function:path {
            uniform $parameters:ident: $Parameters:ty,
            $(with $scene:ident,)?
            $(read $read:ident: $Read:ty,)*
            $(write $written:ident: $Written:ty,)*
            $(scatter $scattered:ident: $Scattered:ty,)*
            $(atomic $atomic:ident,)*
        }
    )*) => {
        $(
            $(#[$doc])*
            #[allow(
                clippy::too_many_arguments,
                reason = "one for each binding, of types of their own"
            )]
            pub fn $name<'a, B>(
                $parameters: &$Parameters,
                $($scene: &'a SceneBuffers<B>,)?
                $($read: View<'a, B, $Read>,)*
                $($written: View<'a, B, $Written>,)*
                $($scattered: View<'a, B, $Scattered>,)*
                $($atomic: View<'a, B, u32>,)*
            ) -> Launch<'a, B> {
                let mut views = Vec::with_capacity(table::$name.bindings.len());
                $(views.extend($scene.views());)?
                $(views.push($read.raw());)*
                $(views.push($written.raw());)*
                $(views.push($scattered.raw());)*
                $(views.push($atomic.raw());)*
                let scene = scene_uses!($($scene)?);
                Launch::on_scene(&table::$name, $parameters, views, scene)
            }
        )*

        /// The kernels themselves.
        pub mod table {
            use super::*;

            $(
                $(#[$doc])*
                #[allow(non_upper_case_globals, reason = "it is called like its entry point")]
                pub static $name: Kernel = Kernel {
                    name: stringify!($name),
                    workgroup_size: $workgroup,
                    bindings: {
                        const BINDINGS: &[Binding] = &[
                            Binding::new::<$Parameters>(stringify!($parameters), Access::Uniform),
                            $(
                                scene_binding!($scene 0),
                                scene_binding!($scene 1),
                                scene_binding!($scene 2),
                            )?
                            $(Binding::new::<$Read>(stringify!($read), Access::Read),)*
                            $(Binding::new::<$Written>(stringify!($written), Access::Write),)*
                            $(Binding::new::<$Scattered>(stringify!($scattered), Access::Scatter),)*
                            $(Binding::new::<u32>(stringify!($atomic), Access::Atomic),)*
                        ];
                        BINDINGS
                    },
                    native: {
                        fn native<L: Level>(arguments: NativeArguments<'_, L>) {
                            let $parameters: $Parameters = arguments.parameters();
                            let mut views = arguments.views.into_iter();
                            $(
                                let $scene = &scene_view(
                                    arguments.abilities,
                                    &$parameters,
                                    &mut views,
                                    arguments.scene,
                                );
                            )?
                            $(let $read: &[$Read] = slice(views.next());)*
                            $(let $written: &mut [$Written] = slice_mut(views.next());)*
                            $(let $scattered = Scatter::<$Scattered>::new(atomics(views.next()));)*
                            $(let $atomic = Atomics::new(atomics(views.next()));)*
                            native_loop! {
                                [$($phases, $Memory)?] [$workgroup]
                                (function!([$($scene)?] $name $function)), $parameters,
                                ($($scene,)? $($read,)*)
                                ($($written)*) ($($scattered)*) ($($atomic)*)
                            }
                        }
                        by_level!([$($scene)?] $name native)
                    },
                };
            )*

            /// All of them.
            pub static ALL: &[&Kernel] = &[$(&$name),*];

            /// All of them, and their SPIR-V.
            pub static TABLE: Table = Table { spirv: SPIRV, kernels: ALL };
        }
    };
}

/// What a launch is told of its scene.
macro_rules! scene_uses {
    () => {
        SceneUses::default()
    };
    ($scene:ident) => {
        $scene.uses()
    };
}

/// One of the bindings that stand for a scene.
macro_rules! scene_binding {
    ($scene:ident $number:tt) => {
        Binding::new::<u32>(SCENE_NAMES[$number], Access::Read)
    };
}

/// What the bindings of a scene are called.
const SCENE_NAMES: [&str; 3] = SceneBuffers::<()>::NAMES;

/// Picks the lowest level that has the abilities that a launch's scene uses; of the megakernel the
/// paths in [`lanes`], where these can do it.
macro_rules! by_level {
    ([] $name:ident $native:ident) => {
        |arguments| $native(arguments.with_abilities(Fixed::<{ abilities::BASIC }>))
    };
    ([scene] trace_paths $native:ident) => {
        |arguments| {
            #[cfg(target_arch = "x86_64")]
            let Err(arguments) = lanes::trace_paths(arguments) else { return };
            by_level!(@of_scene arguments, $native);
        }
    };
    ([$scene:ident] $name:ident $native:ident) => {
        |arguments| by_level!(@of_scene arguments, $native)
    };
    (@of_scene $arguments:ident, $native:ident) => {
        if $arguments.abilities & !abilities::BASIC == 0 {
            $native($arguments.with_abilities(Fixed::<{ abilities::BASIC }>));
        } else {
            $native($arguments.with_abilities(Fixed::<{ abilities::ALL }>));
        }
    };
}

/// The function of a kernel that runs once for each lane.
macro_rules! function {
    ([] $name:ident $function:path) => {
        $function
    };
    ([$scene:ident] $name:ident $function:path) => {
        L::$name
    };
}

/// The view of a scene in the next bindings.
fn scene_view<'a, F: Abilities>(
    abilities: F,
    parameters: &impl TracingParams,
    views: &mut impl Iterator<Item = NativeBinding<'a>>,
    scene: SceneUses<'a>,
) -> SceneView<'a, F> {
    let (geometry, surfaces) = (slice(views.next()), slice(views.next()));
    SceneView::new(abilities, &parameters.scene(), geometry, surfaces, slice(views.next()))
        .with_wide(scene.wide)
}

pub(super) fn slice<T: Pod>(view: Option<NativeBinding<'_>>) -> &[T] {
    view.map_or(&[], NativeBinding::into_slice)
}

pub(super) fn slice_mut<T: Pod>(view: Option<NativeBinding<'_>>) -> &mut [T] {
    view.map_or(&mut [], NativeBinding::into_slice_mut)
}

fn atomics(view: Option<NativeBinding<'_>>) -> &[AtomicU32] {
    view.map_or(&[], NativeBinding::into_atomics)
}

/// Calls the function of a kernel for all lanes.
macro_rules! native_loop {
    (
        [] [$workgroup:tt] $function:expr, $parameters:ident,
        ($($passed:expr,)*) ($($written:ident)*) ($($scattered:ident)*) ($($atomic:ident)*)
    ) => {
        let threads = $parameters.threads;
        let part = part_of(threads);
        $(let mut $written = $written[..threads as usize].chunks_mut(part as usize);)*
        let mut jobs: Vec<Job<'_>> = Vec::new();
        for first in (0..threads).step_by(part as usize) {
            let lanes = first..threads.min(first + part);
            let parameters = &$parameters;
            $(let $written = $written.next().unwrap_or_default();)*
            jobs.push(Box::new(move || {
                $(let mut $written = $written.iter_mut();)*
                for lane in lanes {
                    $(let Some($written) = $written.next() else { return };)*
                    $function(
                        lane,
                        parameters,
                        $($passed,)*
                        $($written,)*
                        $(&mut { $scattered },)*
                        $(&mut { $atomic },)*
                    );
                }
            }));
        }
        run_all(jobs);
    };
    (
        [$phases:expr, $Memory:ty] [$workgroup:tt] $function:expr, $parameters:ident,
        ($($passed:expr,)*) () ($($scattered:ident)*) ($($atomic:ident)*)
    ) => {
        let groups = $parameters.threads.div_ceil($workgroup);
        let part = part_of(groups);
        let mut jobs: Vec<Job<'_>> = Vec::new();
        for first in (0..groups).step_by(part as usize) {
            let parameters = &$parameters;
            jobs.push(Box::new(move || {
                for group in first..groups.min(first + part) {
                    let mut memory: $Memory = [0; size_of::<$Memory>() / size_of::<u32>()];
                    for phase in 0..$phases {
                        for index in 0..$workgroup {
                            let lane = Lane { group, index };
                            $function(
                                phase,
                                lane,
                                parameters,
                                $($passed,)*
                                $(&mut { $scattered },)*
                                $(&mut { $atomic },)*
                                &mut memory,
                            );
                        }
                    }
                }
            }));
        }
        run_all(jobs);
    };
}
raystream_shaders::for_each_kernel!(kernels);
