//! The table of kernels: the one place that says what a kernel is called, how large its workgroup
//! is and what it binds.
//!
//! Each row of [`for_each_kernel!`](crate::for_each_kernel) is
//!
//! ```text
//! name[workgroup size] = function {
//!     uniform 0 parameters: P,
//!     read 1 slice: R, ...
//!     write 2 element: W, ...
//!     scatter 3 anywhere: S, ...
//!     atomic 4 words, ...
//! }
//! ```
//!
//! and stands for `function(lane, &P, &[R] ..., &mut W ..., &mut Scatter<S> ..., &mut Atomics
//! ...)`: binding 0 is a uniform, then come the storage buffers: the read-only ones, those of which
//! lane `lane` owns the element `lane`, and those that lanes write at places of their choice (see
//! [`crate::memory::access`]). The row becomes
//!
//! - here, compiled for the GPU, the entry point `name`, which binds, checks `lane < P.threads` and
//!   calls;
//! - in the host crate, a `Kernel`: the same facts as data, and a native loop over lanes for the
//!   CPU. It is safe Rust, because an element that a lane owns is an element of a parallel
//!   iterator.
//!
//! A row `name[workgroup size] phased(phases, Memory) = function { ... }` is a kernel whose lanes
//! cooperate, see [`crate::parallel::prefix`]: `function(phase, Lane, &P, ..., &mut Memory)` is
//! called for every phase, with the workgroup's memory as the last argument. The GPU calls it for
//! its own lane and puts a barrier after each phase; the CPU calls it for all lanes of a workgroup
//! in turn. Such a kernel has no `write` bindings.

/// Calls the macro `$with` with all rows; see the [module](self).
#[macro_export]
macro_rules! for_each_kernel {
    ($with:ident) => {
        $with! {
            /// Fills the runs of a window of pixels.
            fill_runs[256] phased($crate::film::stream::PHASES, $crate::film::stream::Memory) = $crate::film::stream::fill_runs {
                uniform 0 parameters: $crate::film::stream::RunWindow,
                read 1 starts: u32,
                read 2 film: $crate::film::FilmPixel,
                scatter 3 slots: $crate::film::stream::Slot,
            }
            /// Empties a stream.
            clear_slots[256] = $crate::film::stream::clear_slots {
                uniform 0 parameters: $crate::film::stream::RunWindow,
                write 1 slots: $crate::film::stream::Slot,
            }
            /// Traces the paths of a stream, each to its end by one thread.
            trace_paths[128] = $crate::integrator::path::trace_paths {
                uniform 0 parameters: $crate::integrator::path::PathParams,
                read 1 slots: $crate::film::stream::Slot,
                read 2 nodes: $crate::glam::UVec4,
                read 3 triangles: $crate::glam::UVec4,
                read 4 attributes: $crate::scene::triangle::Attributes,
                read 5 materials: $crate::scene::bsdf::Material,
                read 6 lights: $crate::scene::light::Light,
                read 7 texels: u32,
                write 8 contributions: $crate::film::Contribution,
            }
            /// Traces the paths of a stream by threads that take slot after slot.
            regenerate_paths[128] = $crate::integrator::regeneration::regenerate_paths {
                uniform 0 parameters: $crate::integrator::path::PathParams,
                read 1 slots: $crate::film::stream::Slot,
                read 2 nodes: $crate::glam::UVec4,
                read 3 triangles: $crate::glam::UVec4,
                read 4 attributes: $crate::scene::triangle::Attributes,
                read 5 materials: $crate::scene::bsdf::Material,
                read 6 lights: $crate::scene::light::Light,
                read 7 texels: u32,
                scatter 8 contributions: $crate::film::Contribution,
                atomic 9 taken,
            }
            /// Finds what the rays of a pool's paths hit.
            trace_queue[128] = $crate::integrator::wavefront::trace_queue {
                uniform 0 parameters: $crate::integrator::wavefront::WavefrontParams,
                read 1 slots: $crate::film::stream::Slot,
                read 2 nodes: $crate::glam::UVec4,
                read 3 triangles: $crate::glam::UVec4,
                read 4 kept: u32,
                read 5 offsets: u32,
                scatter 6 rows: $crate::glam::UVec4,
                scatter 7 queues: $crate::integrator::wavefront::Queue,
            }
            /// Takes a pool's paths from what they hit to their next segments.
            shade_queue[128] = $crate::integrator::wavefront::shade_queue {
                uniform 0 parameters: $crate::integrator::wavefront::WavefrontParams,
                read 1 slots: $crate::film::stream::Slot,
                read 2 triangles: $crate::glam::UVec4,
                read 3 attributes: $crate::scene::triangle::Attributes,
                read 4 materials: $crate::scene::bsdf::Material,
                read 5 lights: $crate::scene::light::Light,
                read 6 texels: u32,
                read 7 kept: u32,
                read 8 queues: $crate::integrator::wavefront::Queue,
                write 9 goes_on: u32,
                scatter 10 rows: $crate::glam::UVec4,
                scatter 11 contributions: $crate::film::Contribution,
            }
            /// Tests whether light that a pool's paths have sampled is visible.
            shadow_queue[128] = $crate::integrator::wavefront::shadow_queue {
                uniform 0 parameters: $crate::integrator::wavefront::WavefrontParams,
                read 1 nodes: $crate::glam::UVec4,
                read 2 triangles: $crate::glam::UVec4,
                read 3 queues: $crate::integrator::wavefront::Queue,
                scatter 4 rows: $crate::glam::UVec4,
                scatter 5 contributions: $crate::film::Contribution,
            }
            /// Traces what is left of a pool's paths and slots.
            finish_queue[128] = $crate::integrator::wavefront::finish_queue {
                uniform 0 parameters: $crate::integrator::wavefront::WavefrontParams,
                read 1 slots: $crate::film::stream::Slot,
                read 2 nodes: $crate::glam::UVec4,
                read 3 triangles: $crate::glam::UVec4,
                read 4 attributes: $crate::scene::triangle::Attributes,
                read 5 materials: $crate::scene::bsdf::Material,
                read 6 lights: $crate::scene::light::Light,
                read 7 texels: u32,
                read 8 kept: u32,
                read 9 offsets: u32,
                read 10 queues: $crate::integrator::wavefront::Queue,
                scatter 11 rows: $crate::glam::UVec4,
                scatter 12 contributions: $crate::film::Contribution,
            }
            /// Traces light paths for the light vertex cache.
            trace_light_paths[128] = $crate::integrator::lvc::light_path::trace_light_paths {
                uniform 0 parameters: $crate::integrator::lvc::LvcParams,
                read 1 nodes: $crate::glam::UVec4,
                read 2 triangles: $crate::glam::UVec4,
                read 3 attributes: $crate::scene::triangle::Attributes,
                read 4 materials: $crate::scene::bsdf::Material,
                read 5 lights: $crate::scene::light::Light,
                read 6 texels: u32,
                write 7 counts: u32,
                scatter 8 scratch: $crate::glam::UVec4,
            }
            /// Puts the vertices of all light paths close together.
            gather_vertices[256] phased($crate::parallel::prefix::PHASES, $crate::parallel::prefix::Memory) = $crate::integrator::lvc::cache::gather_vertices {
                uniform 0 parameters: $crate::integrator::lvc::cache::GatherParams,
                read 1 counts: u32,
                read 2 offsets: u32,
                read 3 scratch: $crate::glam::UVec4,
                scatter 4 cache: $crate::glam::UVec4,
            }
            /// Traces the paths of a stream, which connect to the light vertex cache.
            trace_eye_paths[128] = $crate::integrator::lvc::eye_path::trace_eye_paths {
                uniform 0 parameters: $crate::integrator::lvc::LvcParams,
                read 1 slots: $crate::film::stream::Slot,
                read 2 nodes: $crate::glam::UVec4,
                read 3 triangles: $crate::glam::UVec4,
                read 4 attributes: $crate::scene::triangle::Attributes,
                read 5 materials: $crate::scene::bsdf::Material,
                read 6 lights: $crate::scene::light::Light,
                read 7 texels: u32,
                read 8 cache: $crate::glam::UVec4,
                write 9 contributions: $crate::film::Contribution,
            }
            /// Adds a window's contributions to the film, every pixel its own run.
            accumulate_runs[256] = $crate::film::accumulate::accumulate_runs {
                uniform 0 parameters: $crate::film::stream::RunWindow,
                read 1 starts: u32,
                read 2 contributions: $crate::glam::UVec4,
                write 3 film: $crate::film::FilmPixel,
            }
            /// Traces camera rays for the features that pixels lack.
            first_hits[128] = $crate::integrator::first_hits::first_hits {
                uniform 0 parameters: $crate::integrator::first_hits::FeatureParams,
                read 1 nodes: $crate::glam::UVec4,
                read 2 triangles: $crate::glam::UVec4,
                read 3 attributes: $crate::scene::triangle::Attributes,
                read 4 materials: $crate::scene::bsdf::Material,
                read 5 texels: u32,
                write 6 features: $crate::integrator::first_hits::FeaturePixel,
            }
            /// Counts the rays that the film's samples took.
            count_rays[256] = $crate::film::accumulate::count_rays {
                uniform 0 parameters: $crate::film::accumulate::CountParams,
                read 1 film: $crate::film::FilmPixel,
                write 2 rays: u32,
            }
            /// Adds up each block of numbers.
            sum_blocks[256] phased($crate::parallel::prefix::PHASES, $crate::parallel::prefix::Memory) = $crate::parallel::prefix::sum_blocks {
                uniform 0 parameters: $crate::parallel::prefix::BlockParams,
                read 1 values: u32,
                scatter 2 sums: u32,
            }
            /// Turns the sums of blocks into those of all blocks before each.
            scan_blocks[256] phased($crate::parallel::prefix::PHASES, $crate::parallel::prefix::Memory) = $crate::parallel::prefix::scan_blocks {
                uniform 0 parameters: $crate::parallel::prefix::BlockParams,
                scatter 1 sums: u32,
            }
            /// Writes the places of what is to be kept, close together.
            scatter_kept[256] phased($crate::parallel::prefix::PHASES, $crate::parallel::prefix::Memory) = $crate::parallel::compaction::scatter_kept {
                uniform 0 parameters: $crate::parallel::prefix::BlockParams,
                read 1 keep: u32,
                read 2 offsets: u32,
                scatter 3 kept: u32,
            }
            /// Finds the largest exponent and the sum of each block of errors.
            block_errors[256] phased($crate::allocator::error_scale::PHASES, $crate::allocator::error_scale::Memory) = $crate::allocator::error_scale::block_errors {
                uniform 0 parameters: $crate::parallel::prefix::BlockParams,
                read 1 errors: f32,
                scatter 2 blocks: $crate::allocator::error_scale::BlockErrors,
            }
            /// Puts the errors of all blocks together.
            add_block_errors[256] phased($crate::allocator::error_scale::PHASES, $crate::allocator::error_scale::Memory) = $crate::allocator::error_scale::add_block_errors {
                uniform 0 parameters: $crate::parallel::prefix::BlockParams,
                scatter 1 blocks: $crate::allocator::error_scale::BlockErrors,
            }
            /// Makes weights of errors.
            weigh_errors[256] phased($crate::parallel::prefix::PHASES, $crate::parallel::prefix::Memory) = $crate::allocator::runs::weigh_errors {
                uniform 0 parameters: $crate::allocator::runs::RunParams,
                read 1 errors: f32,
                read 2 totals: $crate::allocator::error_scale::BlockErrors,
                scatter 3 weights: u32,
                scatter 4 sums: u32,
            }
            /// Finds where the run of each pixel begins.
            run_starts[256] phased($crate::parallel::prefix::PHASES, $crate::parallel::prefix::Memory) = $crate::allocator::runs::run_starts {
                uniform 0 parameters: $crate::allocator::runs::RunParams,
                read 1 weights: u32,
                read 2 offsets: u32,
                scatter 3 starts: u32,
            }
            /// Zeroes the counter of slots.
            clear_counter[256] = $crate::allocator::atomic::clear_counter {
                uniform 0 parameters: $crate::film::stream::RunWindow,
                write 1 counter: u32,
            }
            /// Reserves slots for each pixel.
            reserve_slots[256] = $crate::allocator::atomic::reserve_slots {
                uniform 0 parameters: $crate::film::stream::RunWindow,
                read 1 starts: u32,
                write 2 reserved: u32,
                atomic 3 counter,
            }
            /// Fills the slots that pixels have reserved.
            fill_reserved[256] = $crate::allocator::atomic::fill_reserved {
                uniform 0 parameters: $crate::film::stream::RunWindow,
                read 1 starts: u32,
                read 2 reserved: u32,
                read 3 film: $crate::film::FilmPixel,
                scatter 4 slots: $crate::film::stream::Slot,
            }
            /// Adds contributions to the film by atomics.
            accumulate_atomic[256] = $crate::allocator::atomic::accumulate_atomic {
                uniform 0 parameters: $crate::film::stream::RunWindow,
                read 1 slots: $crate::film::stream::Slot,
                read 2 contributions: $crate::glam::UVec4,
                atomic 3 film,
            }
            /// Copies the film's sample counts.
            copy_counts[256] = $crate::allocator::paper::copy_counts {
                uniform 0 parameters: $crate::allocator::paper::PaperParams,
                read 1 film: $crate::film::FilmPixel,
                write 2 counts: u32,
            }
            /// Begins the bisection of thresholds.
            paper_begin[256] = $crate::allocator::paper::paper_begin {
                uniform 0 parameters: $crate::allocator::paper::PaperParams,
                scatter 1 states: $crate::allocator::paper::PaperState,
            }
            /// Selects the pixels of a stream.
            paper_select[256] = $crate::allocator::paper::paper_select {
                uniform 0 parameters: $crate::allocator::paper::PaperParams,
                read 1 errors: f32,
                read 2 totals: $crate::allocator::error_scale::BlockErrors,
                read 3 states: $crate::allocator::paper::PaperState,
                write 4 keep: u32,
            }
            /// Decides whether a stream is kept.
            paper_decide[256] = $crate::allocator::paper::paper_decide {
                uniform 0 parameters: $crate::allocator::paper::PaperParams,
                read 1 offsets: u32,
                scatter 2 states: $crate::allocator::paper::PaperState,
            }
            /// Appends a stream.
            paper_append[256] = $crate::allocator::paper::paper_append {
                uniform 0 parameters: $crate::allocator::paper::PaperParams,
                read 1 states: $crate::allocator::paper::PaperState,
                read 2 kept: u32,
                scatter 3 counts: u32,
                scatter 4 slots: $crate::film::stream::Slot,
            }
            /// Adds the contributions of a stream to the film.
            paper_accumulate[256] = $crate::allocator::paper::paper_accumulate {
                uniform 0 parameters: $crate::allocator::paper::PaperParams,
                read 1 states: $crate::allocator::paper::PaperState,
                read 2 slots: $crate::film::stream::Slot,
                read 3 contributions: $crate::glam::UVec4,
                scatter 4 film: $crate::film::FilmPixel,
            }
            /// Makes the rays through pixel centres.
            primary_rays[256] = $crate::probe::primary_rays {
                uniform 0 parameters: $crate::integrator::path::PathParams,
                read 1 slots: $crate::film::stream::Slot,
                write 2 rays: $crate::scene::ray::Ray,
            }
            /// Makes cosine-distributed rays from hits.
            bounce_rays[256] = $crate::probe::bounce_rays {
                uniform 0 parameters: $crate::integrator::path::PathParams,
                read 1 rays: $crate::scene::ray::Ray,
                read 2 hits: $crate::scene::ray::Hit,
                read 3 triangles: $crate::glam::UVec4,
                write 4 bounced: $crate::scene::ray::Ray,
            }
            /// Makes segments from hits to lights.
            shadow_rays[256] = $crate::probe::shadow_rays {
                uniform 0 parameters: $crate::integrator::path::PathParams,
                read 1 rays: $crate::scene::ray::Ray,
                read 2 hits: $crate::scene::ray::Hit,
                read 3 triangles: $crate::glam::UVec4,
                read 4 lights: $crate::scene::light::Light,
                write 5 shadow: $crate::scene::ray::Ray,
            }
            /// Finds the nearest hits of rays.
            closest_hits[128] = $crate::probe::closest_hits {
                uniform 0 parameters: $crate::probe::ProbeParams,
                read 1 rays: $crate::scene::ray::Ray,
                read 2 nodes: $crate::glam::UVec4,
                read 3 triangles: $crate::glam::UVec4,
                write 4 hits: $crate::scene::ray::Hit,
            }
            /// Finds whether rays hit anything.
            any_hits[128] = $crate::probe::any_hits {
                uniform 0 parameters: $crate::probe::ProbeParams,
                read 1 rays: $crate::scene::ray::Ray,
                read 2 nodes: $crate::glam::UVec4,
                read 3 triangles: $crate::glam::UVec4,
                write 4 occluded: u32,
            }
            /// Makes the guides of a band's pixels.
            make_guides[256] = $crate::estimator::guide::make_guides {
                uniform 0 parameters: $crate::estimator::guide::GuideParams,
                read 1 film: $crate::film::FilmPixel,
                read 2 features: $crate::integrator::first_hits::FeaturePixel,
                write 3 guides: $crate::estimator::guide::Guide,
            }
            /// Estimates errors by a joint bilateral filter.
            filter_errors[256] = $crate::estimator::bilateral::filter_errors {
                uniform 0 parameters: $crate::estimator::bilateral::FilterParams,
                read 1 guides: $crate::estimator::guide::Guide,
                write 2 estimates: $crate::estimator::Estimate,
                write 3 errors: f32,
            }
            /// Estimates errors by the variance of means.
            noise_errors[256] = $crate::estimator::noise_errors {
                uniform 0 parameters: $crate::estimator::NoiseParams,
                read 1 guides: $crate::estimator::guide::Guide,
                write 2 estimates: $crate::estimator::Estimate,
                write 3 errors: f32,
            }
            /// Adds up relative errors and counts pixels that have not converged.
            total_errors[256] = $crate::estimator::total_errors {
                uniform 0 parameters: $crate::estimator::TotalParams,
                read 1 estimates: $crate::estimator::Estimate,
                read 2 errors: f32,
                write 3 totals: $crate::estimator::ErrorTotal,
            }
        }
    };
}

/// The entry points of the SPIR-V module.
#[cfg(target_arch = "spirv")]
pub mod entry_points {
    use crate::glam::UVec3;
    use crate::memory::access::{Atomics, Scatter, at_mut};
    use crate::parallel::prefix::Lane;
    use spirv_std::arch::workgroup_memory_barrier_with_group_sync;
    use spirv_std::spirv;

    macro_rules! entry_points {
        ($(
            $(#[$doc:meta])*
            $name:ident[$workgroup:tt] $(phased($phases:expr, $Memory:ty))? = $function:path {
                uniform $uniform_binding:tt $parameters:ident: $Parameters:ty,
                $($bindings:tt)*
            }
        )*) => {$(
            entry_point! {
                [$($phases, $Memory)?]
                $(#[$doc])*
                $name[$workgroup] = $function {
                    uniform $uniform_binding $parameters: $Parameters,
                    $($bindings)*
                }
            }
        )*};
    }

    macro_rules! entry_point {
        (
            []
            $(#[$doc:meta])*
            $name:ident[$workgroup:tt] = $function:path {
                uniform $uniform_binding:tt $parameters:ident: $Parameters:ty,
                $(read $read_binding:tt $read:ident: $Read:ty,)*
                $(write $write_binding:tt $written:ident: $Written:ty,)*
                $(scatter $scatter_binding:tt $scattered:ident: $Scattered:ty,)*
                $(atomic $atomic_binding:tt $atomic:ident,)*
            }
        ) => {
            $(#[$doc])*
            #[spirv(compute(threads($workgroup)))]
            pub fn $name(
                #[spirv(global_invocation_id)] invocation: UVec3,
                #[spirv(num_workgroups)] workgroups: UVec3,
                #[spirv(uniform, descriptor_set = 0, binding = $uniform_binding)] $parameters: &$Parameters,
                $(#[spirv(storage_buffer, descriptor_set = 0, binding = $read_binding)] $read: &[$Read],)*
                $(#[spirv(storage_buffer, descriptor_set = 0, binding = $write_binding)] $written: &mut [$Written],)*
                $(#[spirv(storage_buffer, descriptor_set = 0, binding = $scatter_binding)] $scattered: &mut [$Scattered],)*
                $(#[spirv(storage_buffer, descriptor_set = 0, binding = $atomic_binding)] $atomic: &mut [u32],)*
            ) {
                // A dimension of the grid holds 65535 workgroups, so larger launches are folded
                // into rows.
                let lane = invocation.y * workgroups.x * $workgroup + invocation.x;
                if lane < $parameters.threads {
                    $function(
                        lane,
                        $parameters,
                        $($read,)*
                        $(at_mut($written, lane),)*
                        $(&mut Scatter::new($scattered),)*
                        $(&mut Atomics::new($atomic),)*
                    );
                }
            }
        };
        (
            [$phases:expr, $Memory:ty]
            $(#[$doc:meta])*
            $name:ident[$workgroup:tt] = $function:path {
                uniform $uniform_binding:tt $parameters:ident: $Parameters:ty,
                $(read $read_binding:tt $read:ident: $Read:ty,)*
                $(scatter $scatter_binding:tt $scattered:ident: $Scattered:ty,)*
            }
        ) => {
            $(#[$doc])*
            #[spirv(compute(threads($workgroup)))]
            pub fn $name(
                #[spirv(workgroup_id)] place: UVec3,
                #[spirv(local_invocation_index)] index: u32,
                #[spirv(num_workgroups)] workgroups: UVec3,
                #[spirv(uniform, descriptor_set = 0, binding = $uniform_binding)] $parameters: &$Parameters,
                $(#[spirv(storage_buffer, descriptor_set = 0, binding = $read_binding)] $read: &[$Read],)*
                $(#[spirv(storage_buffer, descriptor_set = 0, binding = $scatter_binding)] $scattered: &mut [$Scattered],)*
                #[spirv(workgroup)] memory: &mut $Memory,
            ) {
                let group = place.y * workgroups.x + place.x;
                // The same for all lanes of a workgroup, so that all or none meet the barriers.
                if group * $workgroup < $parameters.threads {
                    let mut phase = 0;
                    while phase < $phases {
                        $function(
                            phase,
                            Lane { group, index },
                            $parameters,
                            $($read,)*
                            $(&mut Scatter::new($scattered),)*
                            memory,
                        );
                        workgroup_memory_barrier_with_group_sync();
                        phase += 1;
                    }
                }
            }
        };
    }
    for_each_kernel!(entry_points);
}
