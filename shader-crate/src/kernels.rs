//! The table of kernels: the one place that says what a kernel is called, how large its workgroup is and what it binds.
//!
//! Each row of [`for_each_kernel!`](crate::for_each_kernel) is
//!
//! ```text
//! name[workgroup size] = function {
//!     uniform 0 parameters: P,
//!     read 1 slice: R, ...
//!     write 2 element: W, ...
//! }
//! ```
//!
//! and stands for `function(lane, &P, &[R] ..., &mut W ...)`: binding 0 is a uniform, then come the read-only
//! storage buffers, then those of which lane `lane` owns the element `lane`. The row becomes
//!
//! - here, compiled for the GPU, the entry point `name`, which binds, checks `lane < P.threads` and calls;
//! - in the host crate, a `Kernel`: the same facts as data, and a native loop over lanes for the CPU. It is safe Rust, because
//!   an element that a lane owns is an element of a parallel iterator.

/// Calls the macro `$with` with all rows; see the [module](self).
#[macro_export]
macro_rules! for_each_kernel {
    ($with:ident) => {
        $with! {
            /// Fills a window of the sample stream with the same number of slots for every pixel.
            uniform_stream[64] = $crate::stream::uniform_stream {
                uniform 0 parameters: $crate::stream::UniformWindow,
                read 1 film: $crate::film::FilmPixel,
                write 2 slots: $crate::stream::Slot,
            }
            /// Traces the paths of a stream, each to its end by one thread.
            trace_paths[64] = $crate::path::trace_paths {
                uniform 0 parameters: $crate::path::PathParams,
                read 1 slots: $crate::stream::Slot,
                read 2 nodes: $crate::glam::UVec4,
                read 3 triangles: $crate::glam::UVec4,
                read 4 attributes: $crate::surface::Attributes,
                read 5 materials: $crate::material::Material,
                read 6 lights: $crate::light::Light,
                read 7 texels: u32,
                write 8 contributions: $crate::film::Contribution,
            }
            /// Adds a window's contributions to the film, every pixel its own run.
            accumulate_runs[64] = $crate::film::accumulate_runs {
                uniform 0 parameters: $crate::film::AccumulateWindow,
                read 1 contributions: $crate::film::Contribution,
                write 2 film: $crate::film::FilmPixel,
            }
            /// Traces camera rays for the features that pixels lack.
            first_hits[64] = $crate::features::first_hits {
                uniform 0 parameters: $crate::features::FeatureParams,
                read 1 nodes: $crate::glam::UVec4,
                read 2 triangles: $crate::glam::UVec4,
                read 3 attributes: $crate::surface::Attributes,
                read 4 materials: $crate::material::Material,
                read 5 lights: $crate::light::Light,
                read 6 texels: u32,
                write 7 features: $crate::features::FeaturePixel,
            }
            /// Counts the rays that the film's samples took.
            count_rays[64] = $crate::film::count_rays {
                uniform 0 parameters: $crate::film::CountParams,
                read 1 film: $crate::film::FilmPixel,
                write 2 rays: u32,
            }
            /// Makes the rays through pixel centres.
            primary_rays[64] = $crate::probe::primary_rays {
                uniform 0 parameters: $crate::path::PathParams,
                read 1 slots: $crate::stream::Slot,
                write 2 rays: $crate::ray::Ray,
            }
            /// Makes cosine-distributed rays from hits.
            bounce_rays[64] = $crate::probe::bounce_rays {
                uniform 0 parameters: $crate::path::PathParams,
                read 1 rays: $crate::ray::Ray,
                read 2 hits: $crate::ray::Hit,
                read 3 triangles: $crate::glam::UVec4,
                write 4 bounced: $crate::ray::Ray,
            }
            /// Makes segments from hits to lights.
            shadow_rays[64] = $crate::probe::shadow_rays {
                uniform 0 parameters: $crate::path::PathParams,
                read 1 rays: $crate::ray::Ray,
                read 2 hits: $crate::ray::Hit,
                read 3 triangles: $crate::glam::UVec4,
                read 4 lights: $crate::light::Light,
                write 5 shadow: $crate::ray::Ray,
            }
            /// Finds the nearest hits of rays.
            closest_hits[64] = $crate::probe::closest_hits {
                uniform 0 parameters: $crate::probe::ProbeParams,
                read 1 rays: $crate::ray::Ray,
                read 2 nodes: $crate::glam::UVec4,
                read 3 triangles: $crate::glam::UVec4,
                write 4 hits: $crate::ray::Hit,
            }
            /// Finds whether rays hit anything.
            any_hits[64] = $crate::probe::any_hits {
                uniform 0 parameters: $crate::probe::ProbeParams,
                read 1 rays: $crate::ray::Ray,
                read 2 nodes: $crate::glam::UVec4,
                read 3 triangles: $crate::glam::UVec4,
                write 4 occluded: u32,
            }
            /// Makes the guides of a band's pixels.
            make_guides[64] = $crate::guide::make_guides {
                uniform 0 parameters: $crate::guide::GuideParams,
                read 1 film: $crate::film::FilmPixel,
                read 2 features: $crate::features::FeaturePixel,
                write 3 guides: $crate::guide::Guide,
            }
            /// Estimates errors by a joint bilateral filter.
            filter_errors[64] = $crate::filter::filter_errors {
                uniform 0 parameters: $crate::filter::FilterParams,
                read 1 guides: $crate::guide::Guide,
                write 2 estimates: $crate::estimate::Estimate,
                write 3 errors: f32,
            }
            /// Estimates errors by the variance of means.
            noise_errors[64] = $crate::estimate::noise_errors {
                uniform 0 parameters: $crate::estimate::NoiseParams,
                read 1 guides: $crate::guide::Guide,
                write 2 estimates: $crate::estimate::Estimate,
                write 3 errors: f32,
            }
            /// Adds up relative errors and counts pixels that have not converged.
            total_errors[64] = $crate::estimate::total_errors {
                uniform 0 parameters: $crate::estimate::TotalParams,
                read 1 estimates: $crate::estimate::Estimate,
                read 2 errors: f32,
                write 3 totals: $crate::estimate::ErrorTotal,
            }
        }
    };
}

/// The entry points of the SPIR-V module.
#[cfg(target_arch = "spirv")]
pub mod entry_points {
    use crate::glam::UVec3;
    use spirv_std::spirv;

    macro_rules! entry_points {
        ($(
            $(#[$doc:meta])*
            $name:ident[$workgroup:tt] = $function:path {
                uniform $uniform_binding:tt $parameters:ident: $Parameters:ty,
                $(read $read_binding:tt $read:ident: $Read:ty,)*
                $(write $write_binding:tt $written:ident: $Written:ty,)*
            }
        )*) => {$(
            $(#[$doc])*
            #[spirv(compute(threads($workgroup)))]
            pub fn $name(
                #[spirv(global_invocation_id)] invocation: UVec3,
                #[spirv(num_workgroups)] workgroups: UVec3,
                #[spirv(uniform, descriptor_set = 0, binding = $uniform_binding)] $parameters: &$Parameters,
                $(#[spirv(storage_buffer, descriptor_set = 0, binding = $read_binding)] $read: &[$Read],)*
                $(#[spirv(storage_buffer, descriptor_set = 0, binding = $write_binding)] $written: &mut [$Written],)*
            ) {
                // A dimension of the grid holds 65535 workgroups, so larger launches are folded into rows.
                let lane = invocation.y * workgroups.x * $workgroup + invocation.x;
                if lane < $parameters.threads {
                    $function(lane, $parameters, $($read,)* $(&mut $written[lane as usize],)*);
                }
            }
        )*};
    }
    for_each_kernel!(entry_points);
}
