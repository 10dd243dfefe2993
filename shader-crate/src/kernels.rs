//! The table of kernels: the one place that says what a kernel is called, how large its workgroup
//! is and what it binds.
//!
//! Each row of [`for_each_kernel!`](crate::for_each_kernel) is
//!
//! ```text
//! name[workgroup size] = function {
//!     uniform parameters: P,
//!     with scene,
//!     read slice: R, ...
//!     write element: W, ...
//!     scatter anywhere: S, ...
//!     atomic words, ...
//! }
//! ```
//!
//! and stands for `function(lane, &P, &SceneView, &[R] ..., &mut W ..., &mut Scatter<S> ..., &mut
//! Atomics ...)`. The uniform comes first. A row that says `with scene` binds all of the scene's
//! buffers, and its function gets one [`SceneView`](crate::scene::SceneView), which knows what the
//! scene [uses](crate::scene::abilities). Then come the storage buffers: the read-only ones, those
//! of which lane `lane` owns the element `lane`, and those that lanes write at places of their
//! choice (see [`crate::memory::access`]). Bindings are numbered in this order. The row becomes
//!
//! - here, compiled for the GPU, the entry point `name`, which binds, checks `lane < P.threads` and
//!   calls;
//! - in the host crate, a `Kernel`: the same facts as data, and a native loop over lanes for the
//!   CPU. It is safe Rust, because an element that a lane owns is an element of a parallel
//!   iterator;
//! - in the host crate, too, a function `name(&P, &SceneBuffers, View<R> ..., View<W> ...)` that
//!   makes a launch of it, so that the compiler checks what each binding is given.
//!
//! What a scene uses is known when its kernels are compiled for a device: the entry point has the
//! specialisation constant [`ABILITIES`](crate::scene::abilities::ABILITIES), the native function a
//! loop for each of the CPU's levels.
//!
//! A row `name[workgroup size] phased(phases, Memory) = function { ... }` is a kernel whose lanes
//! cooperate, see [`crate::parallel::prefix`]: `function(phase, Lane, &P, ..., &mut Memory)` is
//! called for every phase, with the workgroup's memory as the last argument. The GPU calls it for
//! its own lane and puts a barrier after each phase; the CPU calls it for all lanes of a workgroup
//! in turn. Such a kernel has no `write` bindings.

/// Calls the macro `$with` with what follows its name and all rows; see the [module](self).
#[macro_export]
macro_rules! for_each_kernel {
    ($with:ident $($before:tt)*) => {
        $with! {
            $($before)*
            /// Fills the runs of a window of pixels.
            fill_runs[256] phased(
                $crate::film::stream::PHASES,
                $crate::film::stream::Memory
            ) = $crate::film::stream::fill_runs {
                uniform parameters: $crate::film::stream::RunWindow,
                read starts: u32,
                read film: $crate::film::sums::PixelSums,
                scatter slots: $crate::film::stream::Slot,
            }
            /// Empties a stream.
            clear_slots[256] = $crate::film::stream::clear_slots {
                uniform parameters: $crate::film::stream::RunWindow,
                write slots: $crate::film::stream::Slot,
            }
            /// Traces the paths of a stream, each to its end by one thread.
            trace_paths[128] = $crate::integrator::megakernel::trace_paths {
                uniform parameters: $crate::integrator::params::PathParams,
                with scene,
                read slots: $crate::film::stream::Slot,
                write contributions: $crate::film::Contribution,
            }
            /// Traces the paths of a stream by threads that take slot after slot.
            regenerate_paths[128] = $crate::integrator::regeneration::regenerate_paths {
                uniform parameters: $crate::integrator::params::PathParams,
                with scene,
                read slots: $crate::film::stream::Slot,
                scatter contributions: $crate::film::Contribution,
                atomic taken,
            }
            /// Finds what the rays of a pool's paths hit.
            trace_queue[128] = $crate::integrator::wavefront::trace_queue {
                uniform parameters: $crate::integrator::wavefront::WavefrontParams,
                with scene,
                read slots: $crate::film::stream::Slot,
                read kept: u32,
                read offsets: u32,
                scatter rows: $crate::glam::UVec4,
            }
            /// Takes a pool's paths from what they hit to their next segments.
            shade_queue[128] = $crate::integrator::wavefront::shade_queue {
                uniform parameters: $crate::integrator::wavefront::WavefrontParams,
                with scene,
                read slots: $crate::film::stream::Slot,
                read kept: u32,
                write goes_on: u32,
                scatter rows: $crate::glam::UVec4,
                scatter contributions: $crate::film::Contribution,
            }
            /// Tests whether light that a pool's paths have sampled is visible.
            shadow_queue[128] = $crate::integrator::wavefront::shadow_queue {
                uniform parameters: $crate::integrator::wavefront::WavefrontParams,
                with scene,
                scatter rows: $crate::glam::UVec4,
                scatter contributions: $crate::film::Contribution,
            }
            /// Traces what is left of a pool's paths and slots.
            finish_queue[128] = $crate::integrator::wavefront::finish_queue {
                uniform parameters: $crate::integrator::wavefront::WavefrontParams,
                with scene,
                read slots: $crate::film::stream::Slot,
                read kept: u32,
                read offsets: u32,
                scatter rows: $crate::glam::UVec4,
                scatter contributions: $crate::film::Contribution,
            }
            /// Traces light paths for the light vertex cache.
            trace_light_paths[128] = $crate::integrator::lvc::light_path::trace_light_paths {
                uniform parameters: $crate::integrator::lvc::LvcParams,
                with scene,
                write counts: u32,
                scatter scratch: $crate::glam::UVec4,
            }
            /// Puts the vertices of all light paths close together.
            gather_vertices[256] phased(
                $crate::parallel::prefix::PHASES,
                $crate::parallel::prefix::Memory
            ) = $crate::integrator::lvc::cache::gather_vertices {
                uniform parameters: $crate::integrator::lvc::cache::GatherParams,
                read counts: u32,
                read offsets: u32,
                read scratch: $crate::glam::UVec4,
                scatter cache: $crate::glam::UVec4,
            }
            /// Connects the vertices of the light vertex cache to the camera.
            connect_to_camera[128] = $crate::integrator::lvc::light_tracing::connect_to_camera {
                uniform parameters: $crate::integrator::lvc::LvcParams,
                with scene,
                read cache: $crate::glam::UVec4,
                scatter splats: $crate::glam::UVec4,
            }
            /// Adds splats to their film.
            add_splats[256] = $crate::film::splats::add_splats {
                uniform parameters: $crate::film::splats::SplatParams,
                read splats: $crate::glam::UVec4,
                atomic film,
            }
            /// Traces the paths of a stream, which connect to the light vertex cache.
            trace_eye_paths[128] = $crate::integrator::lvc::eye_path::trace_eye_paths {
                uniform parameters: $crate::integrator::lvc::LvcParams,
                with scene,
                read slots: $crate::film::stream::Slot,
                read cache: $crate::glam::UVec4,
                write contributions: $crate::film::Contribution,
            }
            /// Adds the contributions of a stream to the film.
            accumulate[256] = $crate::film::accumulate::accumulate {
                uniform parameters: $crate::film::accumulate::AccumulateParams,
                read slots: $crate::film::stream::Slot,
                read contributions: u32,
                atomic film,
            }
            /// Traces camera rays for the features that pixels lack.
            first_hits[128] = $crate::integrator::first_hits::first_hits {
                uniform parameters: $crate::integrator::first_hits::FeatureParams,
                with scene,
                write features: $crate::integrator::first_hits::FeaturePixel,
            }
            /// Counts the rays that the film's samples took.
            count_rays[256] = $crate::film::accumulate::count_rays {
                uniform parameters: $crate::film::accumulate::CountParams,
                read film: $crate::film::sums::PixelSums,
                write rays: u32,
            }
            /// Adds up each block of numbers.
            sum_blocks[256] phased(
                $crate::parallel::prefix::PHASES,
                $crate::parallel::prefix::Memory
            ) = $crate::parallel::prefix::sum_blocks {
                uniform parameters: $crate::parallel::prefix::BlockParams,
                read values: u32,
                scatter sums: u32,
            }
            /// Turns the sums of blocks into those of all blocks before each.
            scan_blocks[256] phased(
                $crate::parallel::prefix::PHASES,
                $crate::parallel::prefix::Memory
            ) = $crate::parallel::prefix::scan_blocks {
                uniform parameters: $crate::parallel::prefix::BlockParams,
                scatter sums: u32,
            }
            /// Writes the places of what is to be kept, close together.
            scatter_kept[256] phased(
                $crate::parallel::prefix::PHASES,
                $crate::parallel::prefix::Memory
            ) = $crate::parallel::compaction::scatter_kept {
                uniform parameters: $crate::parallel::prefix::BlockParams,
                read keep: u32,
                read offsets: u32,
                scatter kept: u32,
            }
            /// Finds the largest exponent and the sum of each block of errors.
            block_errors[256] phased(
                $crate::allocator::error_scale::PHASES,
                $crate::allocator::error_scale::Memory
            ) = $crate::allocator::error_scale::block_errors {
                uniform parameters: $crate::parallel::prefix::BlockParams,
                read errors: f32,
                scatter blocks: $crate::allocator::error_scale::BlockErrors,
            }
            /// Puts the errors of all blocks together.
            add_block_errors[256] phased(
                $crate::allocator::error_scale::PHASES,
                $crate::allocator::error_scale::Memory
            ) = $crate::allocator::error_scale::add_block_errors {
                uniform parameters: $crate::parallel::prefix::BlockParams,
                scatter blocks: $crate::allocator::error_scale::BlockErrors,
            }
            /// Makes weights of errors.
            weigh_errors[256] phased(
                $crate::parallel::prefix::PHASES,
                $crate::parallel::prefix::Memory
            ) = $crate::allocator::atomic::weigh_errors {
                uniform parameters: $crate::allocator::runs::RunParams,
                read errors: f32,
                read totals: $crate::allocator::error_scale::BlockErrors,
                scatter weights: u32,
                scatter sums: u32,
            }
            /// Raises the level to which pixels are filled up.
            raise_level[256] phased(
                $crate::allocator::deficits::PHASES,
                $crate::allocator::deficits::Memory
            ) = $crate::allocator::deficits::raise_level {
                uniform parameters: $crate::allocator::deficits::DeficitParams,
                read errors: f32,
                read counts: u32,
                read totals: $crate::allocator::error_scale::BlockErrors,
                atomic levels,
            }
            /// Makes weights of what pixels lack.
            weigh_deficits[256] phased(
                $crate::parallel::prefix::PHASES,
                $crate::parallel::prefix::Memory
            ) = $crate::allocator::deficits::weigh_deficits {
                uniform parameters: $crate::allocator::deficits::DeficitParams,
                read errors: f32,
                read counts: u32,
                read totals: $crate::allocator::error_scale::BlockErrors,
                read levels: u32,
                scatter weights: u32,
                scatter sums: u32,
            }
            /// Finds where the run of each pixel begins.
            run_starts[256] phased(
                $crate::parallel::prefix::PHASES,
                $crate::parallel::prefix::Memory
            ) = $crate::allocator::runs::run_starts {
                uniform parameters: $crate::allocator::runs::RunParams,
                read weights: u32,
                read offsets: u32,
                scatter starts: u32,
            }
            /// Zeroes counters.
            clear_counter[256] = $crate::allocator::atomic::clear_counter {
                uniform parameters: $crate::film::stream::RunWindow,
                write counter: u32,
            }
            /// Reserves slots for each pixel.
            reserve_slots[256] = $crate::allocator::atomic::reserve_slots {
                uniform parameters: $crate::film::stream::RunWindow,
                read starts: u32,
                write reserved: u32,
                atomic counter,
            }
            /// Fills the slots that pixels have reserved.
            fill_reserved[256] = $crate::allocator::atomic::fill_reserved {
                uniform parameters: $crate::film::stream::RunWindow,
                read starts: u32,
                read reserved: u32,
                read film: $crate::film::sums::PixelSums,
                scatter slots: $crate::film::stream::Slot,
            }
            /// Copies the film's sample counts.
            copy_counts[256] = $crate::film::accumulate::copy_counts {
                uniform parameters: $crate::film::accumulate::CountParams,
                read film: $crate::film::sums::PixelSums,
                write counts: u32,
            }
            /// Begins the bisection of thresholds.
            paper_begin[256] = $crate::allocator::paper::paper_begin {
                uniform parameters: $crate::allocator::paper::PaperParams,
                scatter states: $crate::allocator::paper::PaperState,
            }
            /// Selects the pixels of a stream.
            paper_select[256] = $crate::allocator::paper::paper_select {
                uniform parameters: $crate::allocator::paper::PaperParams,
                read errors: f32,
                read totals: $crate::allocator::error_scale::BlockErrors,
                read states: $crate::allocator::paper::PaperState,
                write keep: u32,
            }
            /// Decides whether a stream is kept.
            paper_decide[256] = $crate::allocator::paper::paper_decide {
                uniform parameters: $crate::allocator::paper::PaperParams,
                read offsets: u32,
                scatter states: $crate::allocator::paper::PaperState,
            }
            /// Appends a stream.
            paper_append[256] = $crate::allocator::paper::paper_append {
                uniform parameters: $crate::allocator::paper::PaperParams,
                read states: $crate::allocator::paper::PaperState,
                read kept: u32,
                scatter counts: u32,
                scatter slots: $crate::film::stream::Slot,
            }
            /// Finds what the control film differs by.
            control_differences[256] = $crate::film::control::control_differences {
                uniform parameters: $crate::film::control::ControlParams,
                read film: $crate::film::sums::PixelSums,
                scatter differences: $crate::glam::Vec4,
                scatter counts: $crate::glam::Vec4,
            }
            /// Makes the guides of a control film.
            control_guides[256] = $crate::film::control::control_guides {
                uniform parameters: $crate::film::control::ControlParams,
                read blurred: $crate::glam::Vec4,
                write differences: $crate::glam::Vec4,
                write counts: $crate::glam::Vec4,
                write guided: $crate::glam::Vec4,
            }
            /// Averages the standard errors around pixels.
            control_errors[256] = $crate::film::control::control_errors {
                uniform parameters: $crate::film::control::ControlParams,
                read errors: $crate::glam::Vec4,
                read blurred: $crate::glam::Vec4,
                write around: f32,
            }
            /// Blurs along rows or columns.
            blur[256] = $crate::film::control::blur {
                uniform parameters: $crate::film::control::ControlParams,
                read values: $crate::glam::Vec4,
                write sums: $crate::glam::Vec4,
            }
            /// Divides what a pixel gives.
            control_shares[256] = $crate::film::control::control_shares {
                uniform parameters: $crate::film::control::ControlParams,
                read guided: $crate::glam::Vec4,
                read blurred: $crate::glam::Vec4,
                read around: f32,
                write corrections: $crate::glam::Vec4,
                write shares: $crate::glam::Vec4,
            }
            /// Adds up what pixels are given.
            control_corrections[256] = $crate::film::control::control_corrections {
                uniform parameters: $crate::film::control::ControlParams,
                read guided: $crate::glam::Vec4,
                read blurred: $crate::glam::Vec4,
                write corrections: $crate::glam::Vec4,
            }
            /// Makes the rays through pixel centres.
            primary_rays[256] = $crate::probe::primary_rays {
                uniform parameters: $crate::integrator::params::PathParams,
                with scene,
                read slots: $crate::film::stream::Slot,
                write rays: $crate::scene::ray::Ray,
            }
            /// Makes cosine-distributed rays from hits.
            bounce_rays[256] = $crate::probe::bounce_rays {
                uniform parameters: $crate::integrator::params::PathParams,
                with scene,
                read rays: $crate::scene::ray::Ray,
                read hits: $crate::scene::ray::Hit,
                write bounced: $crate::scene::ray::Ray,
            }
            /// Makes segments from hits to lights.
            shadow_rays[256] = $crate::probe::shadow_rays {
                uniform parameters: $crate::integrator::params::PathParams,
                with scene,
                read rays: $crate::scene::ray::Ray,
                read hits: $crate::scene::ray::Hit,
                write shadow: $crate::scene::ray::Ray,
            }
            /// Finds the nearest hits of rays.
            closest_hits[128] = $crate::probe::closest_hits {
                uniform parameters: $crate::integrator::params::PathParams,
                with scene,
                read rays: $crate::scene::ray::Ray,
                write hits: $crate::scene::ray::Hit,
            }
            /// Finds the nearest hits of rays by testing all triangles.
            brute_force_hits[128] = $crate::probe::brute_force_hits {
                uniform parameters: $crate::probe::BruteForceParams,
                with scene,
                read rays: $crate::scene::ray::Ray,
                write hits: $crate::scene::ray::Hit,
            }
            /// Finds whether rays hit anything.
            any_hits[128] = $crate::probe::any_hits {
                uniform parameters: $crate::integrator::params::PathParams,
                with scene,
                read rays: $crate::scene::ray::Ray,
                write occluded: u32,
            }
            /// Computes every function that devices differ in.
            calculate[256] = $crate::math::exact::calculate {
                uniform parameters: $crate::math::exact::CalculateParams,
                read operands: $crate::math::exact::Operands,
                write results: $crate::math::exact::Results,
            }
            /// Makes the guides of a band's pixels.
            make_guides[256] = $crate::estimator::guide::make_guides {
                uniform parameters: $crate::estimator::guide::GuideParams,
                read film: $crate::film::sums::PixelSums,
                read features: $crate::integrator::first_hits::FeaturePixel,
                write guides: $crate::estimator::guide::Guide,
            }
            /// Estimates errors by a joint bilateral filter.
            filter_errors[256] = $crate::estimator::bilateral::filter_errors {
                uniform parameters: $crate::estimator::bilateral::FilterParams,
                read guides: $crate::estimator::guide::Guide,
                read film: $crate::film::sums::PixelSums,
                write estimates: $crate::estimator::Estimate,
                write errors: f32,
            }
            /// Filters a picture by a joint bilateral filter.
            filter_picture[256] = $crate::estimator::bilateral::filter_picture {
                uniform parameters: $crate::estimator::bilateral::FilterParams,
                read guides: $crate::estimator::guide::Guide,
                write picture: $crate::estimator::filtered::FilteredPixel,
            }
            /// Makes the means of the two halves of samples, with their variances.
            make_halves[256] = $crate::reconstruction::halves::make_halves {
                uniform parameters: $crate::reconstruction::halves::HalvesParams,
                read film: $crate::film::sums::PixelSums,
                write first: $crate::glam::Vec4,
                write second: $crate::glam::Vec4,
                scatter noise: $crate::glam::Vec4,
            }
            /// Scales variances to what is measured about pixels.
            calibrate[256] = $crate::reconstruction::halves::calibrate {
                uniform parameters: $crate::reconstruction::PictureParams,
                read noise: $crate::glam::Vec4,
                write guides: $crate::estimator::guide::Guide,
                write first: $crate::glam::Vec4,
                write second: $crate::glam::Vec4,
            }
            /// Puts one half of samples in rows.
            half_in_rows[256] = $crate::reconstruction::patches::half_in_rows {
                uniform parameters: $crate::reconstruction::PictureParams,
                read half: $crate::glam::Vec4,
                scatter rows: $crate::glam::Vec4,
            }
            /// Filters one half of samples by non-local means.
            filter_half[128] phased(
                $crate::reconstruction::nlm::PHASES,
                $crate::reconstruction::nlm::Memory
            ) = $crate::reconstruction::nlm::filter_half {
                uniform parameters: $crate::reconstruction::patches::PatchParams,
                read weighers: $crate::glam::Vec4,
                read values: $crate::glam::Vec4,
                scatter filtered: $crate::glam::Vec4,
            }
            /// Filters one half of samples by non-local means of colours and features.
            filter_half_by_features[128] phased(
                $crate::reconstruction::nlm::PHASES,
                $crate::reconstruction::nlm::Memory
            ) = $crate::reconstruction::nlm::filter_half_by_features {
                uniform parameters: $crate::reconstruction::patches::PatchParams,
                read features: $crate::reconstruction::features::Features,
                read weighers: $crate::glam::Vec4,
                read values: $crate::glam::Vec4,
                scatter filtered: $crate::glam::Vec4,
            }
            /// Makes what filters compare of the features.
            describe_features[256] = $crate::reconstruction::features::describe_features {
                uniform parameters: $crate::reconstruction::features::FeatureParams,
                read guides: $crate::estimator::guide::Guide,
                scatter features: $crate::reconstruction::features::Features,
            }
            /// Measures how alike the patches of all neighbours are.
            measure_patches[128] phased(
                $crate::reconstruction::patch_map::PHASES,
                $crate::reconstruction::patch_map::Memory
            ) = $crate::reconstruction::patch_map::measure_patches {
                uniform parameters: $crate::reconstruction::patches::PatchParams,
                read weighers: $crate::glam::Vec4,
                scatter map: u32,
            }
            /// Fits planes to one half of samples.
            fit_planes[64] = $crate::reconstruction::nfor::fit_planes {
                uniform parameters: $crate::reconstruction::nfor::PlaneParams,
                read features: $crate::reconstruction::features::Features,
                read map: u32,
                read values: $crate::glam::Vec4,
                scatter planes: $crate::glam::Vec4,
            }
            /// Makes one half of samples anew of the planes.
            collect_planes[64] = $crate::reconstruction::nfor::collect_planes {
                uniform parameters: $crate::reconstruction::nfor::PlaneParams,
                read features: $crate::reconstruction::features::Features,
                read map: u32,
                read values: $crate::glam::Vec4,
                read planes: $crate::glam::Vec4,
                write filtered: $crate::glam::Vec4,
            }
            /// Predicts the parameters of each pixel's own filter.
            predict_filters[64] = $crate::reconstruction::learned::description::predict_filters {
                uniform parameters: $crate::estimator::bilateral::FilterParams,
                read guides: $crate::estimator::guide::Guide,
                read first: $crate::glam::Vec4,
                read second: $crate::glam::Vec4,
                read weights: $crate::glam::Vec4,
                write smoothed: $crate::glam::Vec4,
                write filters: $crate::reconstruction::learned::PixelFilter,
            }
            /// Filters each pixel by its own filter.
            filter_by_pixel[256] = $crate::reconstruction::learned::filter::filter_by_pixel {
                uniform parameters: $crate::estimator::bilateral::FilterParams,
                read guides: $crate::estimator::guide::Guide,
                read smoothed: $crate::glam::Vec4,
                read filters: $crate::reconstruction::learned::PixelFilter,
                write filtered: $crate::estimator::filtered::FilteredPixel,
            }
            /// Puts two filtered halves together.
            join_halves[256] = $crate::reconstruction::nlm::join_halves {
                uniform parameters: $crate::reconstruction::PictureParams,
                read guides: $crate::estimator::guide::Guide,
                read first: $crate::glam::Vec4,
                read filtered_first: $crate::glam::Vec4,
                read filtered_second: $crate::glam::Vec4,
                write filtered: $crate::estimator::filtered::FilteredPixel,
            }
            /// Begins the choice among the scales of a picture.
            begin_scales[256] = $crate::reconstruction::gem::begin_scales {
                uniform parameters: $crate::reconstruction::PictureParams,
                read guides: $crate::estimator::guide::Guide,
                write filtered: $crate::estimator::filtered::FilteredPixel,
                write is_settled: u32,
                scatter colors: $crate::glam::Vec4,
                scatter variances: $crate::glam::Vec4,
            }
            /// Says where the step to a coarser scale does not pay.
            judge_scale[256] = $crate::reconstruction::gem::judge_scale {
                uniform parameters: $crate::reconstruction::gem::ScaleParams,
                read finer_colors: $crate::glam::Vec4,
                read finer_variances: $crate::glam::Vec4,
                read coarser_colors: $crate::glam::Vec4,
                read coarser_variances: $crate::glam::Vec4,
                write stop: $crate::glam::Vec4,
            }
            /// Takes pixels to a coarser scale, where that pays.
            take_scale[256] = $crate::reconstruction::gem::take_scale {
                uniform parameters: $crate::reconstruction::gem::ScaleParams,
                read stops: $crate::glam::Vec4,
                read blurred: $crate::glam::Vec4,
                read coarser_colors: $crate::glam::Vec4,
                write filtered: $crate::estimator::filtered::FilteredPixel,
                write is_settled: u32,
            }
            /// Finds how far what throws light or shadow is.
            find_occluders[64] = $crate::reconstruction::axis_aligned::find_occluders {
                uniform parameters: $crate::reconstruction::axis_aligned::AxisParams,
                read guides: $crate::estimator::guide::Guide,
                write occluders: $crate::reconstruction::axis_aligned::Occluders,
            }
            /// Says how many samples pixels need by how far occluders are.
            axis_rates[64] = $crate::reconstruction::axis_aligned::axis_rates {
                uniform parameters: $crate::reconstruction::axis_aligned::AxisParams,
                read guides: $crate::estimator::guide::Guide,
                read film: $crate::film::sums::PixelSums,
                write estimate: $crate::estimator::Estimate,
                write error: f32,
            }
            /// Filters as widely as occluders are far.
            filter_axis_aligned[64] = $crate::reconstruction::axis_aligned::filter_axis_aligned {
                uniform parameters: $crate::reconstruction::axis_aligned::AxisParams,
                read guides: $crate::estimator::guide::Guide,
                read occluders: $crate::reconstruction::axis_aligned::Occluders,
                write filtered: $crate::estimator::filtered::FilteredPixel,
            }
            /// Begins a sum over manifolds.
            begin_manifolds[256] = $crate::reconstruction::manifolds::begin_manifolds {
                uniform parameters: $crate::reconstruction::PictureParams,
                read guides: $crate::estimator::guide::Guide,
                scatter colors: $crate::glam::Vec4,
                scatter sums: $crate::glam::Vec4,
                scatter near: $crate::glam::Vec4,
                scatter clusters: u32,
            }
            /// Makes what a manifold is the blur of.
            begin_manifold[256] = $crate::reconstruction::manifolds::begin_manifold {
                uniform parameters: $crate::reconstruction::manifolds::ManifoldParams,
                read features: $crate::reconstruction::features::Features,
                read clusters: u32,
                read parent_low: $crate::glam::Vec4,
                read parent_high: $crate::glam::Vec4,
                write low: $crate::glam::Vec4,
                write high: $crate::glam::Vec4,
            }
            /// Blurs values along a manifold.
            blur_along[64] = $crate::reconstruction::manifolds::blur_along {
                uniform parameters: $crate::reconstruction::manifolds::ManifoldParams,
                read low: $crate::glam::Vec4,
                read high: $crate::glam::Vec4,
                scatter values: $crate::glam::Vec4,
            }
            /// Splats pixels onto a manifold.
            splat_pixels[256] = $crate::reconstruction::manifolds::splat_pixels {
                uniform parameters: $crate::reconstruction::manifolds::ManifoldParams,
                read features: $crate::reconstruction::features::Features,
                read colors: $crate::glam::Vec4,
                read low: $crate::glam::Vec4,
                read high: $crate::glam::Vec4,
                write splat: $crate::glam::Vec4,
            }
            /// Adds what lies on a manifold to the pixels near it.
            slice_manifold[256] = $crate::reconstruction::manifolds::slice_manifold {
                uniform parameters: $crate::reconstruction::manifolds::ManifoldParams,
                read features: $crate::reconstruction::features::Features,
                read low: $crate::glam::Vec4,
                read high: $crate::glam::Vec4,
                read blurred: $crate::glam::Vec4,
                write sum: $crate::glam::Vec4,
                write near: $crate::glam::Vec4,
            }
            /// Finds in which direction pixels are far from their manifold.
            find_direction[256] = $crate::reconstruction::manifolds::find_direction {
                uniform parameters: $crate::reconstruction::manifolds::ManifoldParams,
                read features: $crate::reconstruction::features::Features,
                read clusters: u32,
                read low: $crate::glam::Vec4,
                read high: $crate::glam::Vec4,
                write direction_low: $crate::glam::Vec4,
                write direction_high: $crate::glam::Vec4,
            }
            /// Puts a direction together.
            join_direction[64] = $crate::reconstruction::manifolds::join_direction {
                uniform parameters: $crate::reconstruction::manifolds::ManifoldParams,
                read parts_low: $crate::glam::Vec4,
                read parts_high: $crate::glam::Vec4,
                scatter direction: $crate::glam::Vec4,
            }
            /// Splits the pixels about a manifold in two.
            split_cluster[256] = $crate::reconstruction::manifolds::split_cluster {
                uniform parameters: $crate::reconstruction::manifolds::ManifoldParams,
                read features: $crate::reconstruction::features::Features,
                read low: $crate::glam::Vec4,
                read high: $crate::glam::Vec4,
                read direction: $crate::glam::Vec4,
                write cluster: u32,
            }
            /// Makes the picture of a sum over manifolds.
            finish_manifolds[256] = $crate::reconstruction::manifolds::finish_manifolds {
                uniform parameters: $crate::reconstruction::manifolds::ManifoldParams,
                read guides: $crate::estimator::guide::Guide,
                read sums: $crate::glam::Vec4,
                read near: $crate::glam::Vec4,
                write filtered: $crate::estimator::filtered::FilteredPixel,
            }
            /// Makes what the mixture of two filtered pictures averages.
            mixture_terms[256] = $crate::reconstruction::mixture::mixture_terms {
                uniform parameters: $crate::reconstruction::PictureParams,
                read guides: $crate::estimator::guide::Guide,
                read first: $crate::estimator::filtered::FilteredPixel,
                read second: $crate::estimator::filtered::FilteredPixel,
                scatter terms: $crate::glam::Vec4,
            }
            /// Mixes two filtered pictures.
            mix_filtered[256] = $crate::reconstruction::mixture::mix_filtered {
                uniform parameters: $crate::reconstruction::PictureParams,
                read first: $crate::estimator::filtered::FilteredPixel,
                read second: $crate::estimator::filtered::FilteredPixel,
                read blurred: $crate::glam::Vec4,
                write mixture: $crate::estimator::filtered::FilteredPixel,
            }
            /// Makes what the guard of a filter averages.
            guard_terms[256] = $crate::reconstruction::guard::guard_terms {
                uniform parameters: $crate::reconstruction::PictureParams,
                read guides: $crate::estimator::guide::Guide,
                read filtered: $crate::estimator::filtered::FilteredPixel,
                scatter terms: $crate::glam::Vec4,
            }
            /// Draws filtered pixels towards the measured ones.
            guard[256] = $crate::reconstruction::guard::guard {
                uniform parameters: $crate::reconstruction::PictureParams,
                read guides: $crate::estimator::guide::Guide,
                read filtered: $crate::estimator::filtered::FilteredPixel,
                read blurred: $crate::glam::Vec4,
                write picture: $crate::estimator::Estimate,
            }
            /// Finds what a filtered picture lacks.
            filtered_differences[256] = $crate::reconstruction::mean::filtered_differences {
                uniform parameters: $crate::reconstruction::mean::MeanParams,
                read guides: $crate::estimator::guide::Guide,
                read first: $crate::glam::Vec4,
                read picture: $crate::estimator::Estimate,
                scatter differences: $crate::glam::Vec4,
                scatter counts: $crate::glam::Vec4,
            }
            /// Estimates errors by what a filter makes of the picture.
            filtered_errors[256] = $crate::estimator::filtered::filtered_errors {
                uniform parameters: $crate::estimator::filtered::FilteredParams,
                read guides: $crate::estimator::guide::Guide,
                read filtered: $crate::estimator::filtered::FilteredPixel,
                read film: $crate::film::sums::PixelSums,
                write estimates: $crate::estimator::Estimate,
                write errors: f32,
            }
            /// Estimates errors by the variance of means.
            noise_errors[256] = $crate::estimator::noise_errors {
                uniform parameters: $crate::estimator::NoiseParams,
                read guides: $crate::estimator::guide::Guide,
                read film: $crate::film::sums::PixelSums,
                write estimates: $crate::estimator::Estimate,
                write errors: f32,
            }
            /// Adds up relative errors and counts pixels that have not converged.
            total_errors[256] = $crate::estimator::total_errors {
                uniform parameters: $crate::estimator::TotalParams,
                read estimates: $crate::estimator::Estimate,
                read errors: f32,
                write totals: $crate::estimator::ErrorTotal,
            }
        }
    };
}

/// The entry points of the SPIR-V module.
#[cfg(target_arch = "spirv")]
pub mod entry_points {
    use crate::glam::{UVec3, UVec4};
    use crate::memory::access::{Atomics, Scatter, at_mut};
    use crate::parallel::prefix::Lane;
    use crate::scene::abilities::Specialised;
    use crate::scene::{SceneView, TracingParams};
    use spirv_std::arch::workgroup_memory_barrier_with_group_sync;
    use spirv_std::spirv;

    macro_rules! entry_points {
        ($(
            $(#[$doc:meta])*
            $name:ident[$workgroup:tt] $(phased($phases:expr, $Memory:ty))? = $function:path {
                uniform $parameters:ident: $Parameters:ty,
                $($bindings:tt)*
            }
        )*) => {$(
            bind! {
                lane $parameters
                {
                    [$($phases, $Memory)?]
                    $(#[$doc])*
                    $name[$workgroup] = $function, $Parameters
                }
                [1 2 3 4 5 6 7 8]
                [] []
                $($bindings)*
            }
        )*};
    }

    // Gives each binding of a row the next of the numbers; collects the entry point's parameters
    // and what its function is passed. Names come along so that all steps mean the same variables.
    macro_rules! bind {
        (
            $lane:ident $parameters:ident $kernel:tt
            [$a:tt $b:tt $c:tt $($numbers:tt)*] [$($bound:tt)*] [$($passed:tt)*]
            with $scene:ident, $($rest:tt)*
        ) => {
            bind! {
                $lane $parameters $kernel [$($numbers)*]
                [
                    $($bound)*
                    #[spirv(spec_constant(id = 0, default = 0))] abilities: u32,
                    #[spirv(storage_buffer, descriptor_set = 0, binding = $a)] geometry: &[UVec4],
                    #[spirv(storage_buffer, descriptor_set = 0, binding = $b)] surfaces: &[UVec4],
                    #[spirv(storage_buffer, descriptor_set = 0, binding = $c)] texels: &[u32],
                ]
                [
                    $($passed)*
                    &SceneView::new(
                        Specialised(abilities),
                        &$parameters.scene(),
                        geometry,
                        surfaces,
                        texels,
                    ),
                ]
                $($rest)*
            }
        };
        (
            $lane:ident $parameters:ident $kernel:tt
            [$n:tt $($numbers:tt)*] [$($bound:tt)*] [$($passed:tt)*]
            read $read:ident: $Read:ty, $($rest:tt)*
        ) => {
            bind! {
                $lane $parameters $kernel [$($numbers)*]
                [
                    $($bound)*
                    #[spirv(storage_buffer, descriptor_set = 0, binding = $n)] $read: &[$Read],
                ]
                [$($passed)* $read,]
                $($rest)*
            }
        };
        (
            $lane:ident $parameters:ident $kernel:tt
            [$n:tt $($numbers:tt)*] [$($bound:tt)*] [$($passed:tt)*]
            write $written:ident: $Written:ty, $($rest:tt)*
        ) => {
            bind! {
                $lane $parameters $kernel [$($numbers)*]
                [
                    $($bound)*
                    #[spirv(storage_buffer, descriptor_set = 0, binding = $n)]
                    $written: &mut [$Written],
                ]
                [$($passed)* at_mut($written, $lane),]
                $($rest)*
            }
        };
        (
            $lane:ident $parameters:ident $kernel:tt
            [$n:tt $($numbers:tt)*] [$($bound:tt)*] [$($passed:tt)*]
            scatter $scattered:ident: $Scattered:ty, $($rest:tt)*
        ) => {
            bind! {
                $lane $parameters $kernel [$($numbers)*]
                [
                    $($bound)*
                    #[spirv(storage_buffer, descriptor_set = 0, binding = $n)]
                    $scattered: &mut [$Scattered],
                ]
                [$($passed)* &mut Scatter::new($scattered),]
                $($rest)*
            }
        };
        (
            $lane:ident $parameters:ident $kernel:tt
            [$n:tt $($numbers:tt)*] [$($bound:tt)*] [$($passed:tt)*]
            atomic $atomic:ident, $($rest:tt)*
        ) => {
            bind! {
                $lane $parameters $kernel [$($numbers)*]
                [
                    $($bound)*
                    #[spirv(storage_buffer, descriptor_set = 0, binding = $n)] $atomic: &mut [u32],
                ]
                [$($passed)* &mut Atomics::new($atomic),]
                $($rest)*
            }
        };
        // All are bound: the entry point of a kernel whose lanes are alone.
        (
            $lane:ident $parameters:ident
            {
                []
                $(#[$doc:meta])*
                $name:ident[$workgroup:tt] = $function:path, $Parameters:ty
            }
            $numbers:tt [$($bound:tt)*] [$($passed:tt)*]
        ) => {
            $(#[$doc])*
            #[spirv(compute(threads($workgroup)))]
            pub fn $name(
                #[spirv(global_invocation_id)] invocation: UVec3,
                #[spirv(num_workgroups)] workgroups: UVec3,
                #[spirv(uniform, descriptor_set = 0, binding = 0)] $parameters: &$Parameters,
                $($bound)*
            ) {
                // A dimension of the grid holds 65535 workgroups, so larger launches are folded
                // into rows.
                let $lane = invocation.y * workgroups.x * $workgroup + invocation.x;
                if $lane < $parameters.threads {
                    $function($lane, $parameters, $($passed)*);
                }
            }
        };
        // The same of one whose lanes cooperate.
        (
            $lane:ident $parameters:ident
            {
                [$phases:expr, $Memory:ty]
                $(#[$doc:meta])*
                $name:ident[$workgroup:tt] = $function:path, $Parameters:ty
            }
            $numbers:tt [$($bound:tt)*] [$($passed:tt)*]
        ) => {
            $(#[$doc])*
            #[spirv(compute(threads($workgroup)))]
            pub fn $name(
                #[spirv(workgroup_id)] place: UVec3,
                #[spirv(local_invocation_index)] index: u32,
                #[spirv(num_workgroups)] workgroups: UVec3,
                #[spirv(uniform, descriptor_set = 0, binding = 0)] $parameters: &$Parameters,
                $($bound)*
                #[spirv(workgroup)] memory: &mut $Memory,
            ) {
                let group = place.y * workgroups.x + place.x;
                let is_active = group * $workgroup < $parameters.threads;
                let mut phase = 0;
                while phase < $phases {
                    if is_active {
                        let $lane = Lane { group, index };
                        $function(phase, $lane, $parameters, $($passed)* memory);
                    }
                    // All lanes meet it, whatever they do: WGSL must be able to see that.
                    workgroup_memory_barrier_with_group_sync();
                    phase += 1;
                }
            }
        };
    }
    for_each_kernel!(entry_points);
}
