//! Access to memory: of buffers, of a workgroup, of a lane.
//!
//! A kernel's `write` bindings hand each lane the element of its own number. Where a lane must
//! choose what it writes (compaction, streams), it is given a [`Scatter`], whose user answers for
//! what the type cannot show: that no two lanes of a launch touch the same element, unless all only
//! read it. [`Atomics`] may be hit by many lanes at once.
//!
//! On the GPU both are plain slices. On the CPU they are atomics with relaxed order, so that lanes
//! may run on any thread and a mistake would be a wrong number, not undefined behaviour.
//!
//! # Bounds
//!
//! On the CPU every index is checked. On the GPU none is, since checks cost a tenth of its speed:
//! all indexing of buffers goes through this file, and the host answers for what kernels find there
//! ("Bounds" in ARCHITECTURE.md). `cargo shaders --bounds-checks` compiles kernels that check, and
//! end the thread that is wrong.

#[cfg(not(target_arch = "spirv"))]
use core::{
    marker::PhantomData,
    sync::atomic::{AtomicU32, Ordering::Relaxed},
};

#[cfg(all(target_arch = "spirv", not(feature = "bounds-checks")))]
use spirv_std::arch::IndexUnchecked as _;

/// Element `index` of a buffer.
#[inline(always)]
pub fn at<T: Copy>(elements: &[T], index: u32) -> T {
    *at_ref(elements, index)
}

#[inline(always)]
fn at_ref<T>(elements: &[T], index: u32) -> &T {
    #[cfg(any(not(target_arch = "spirv"), feature = "bounds-checks"))]
    return &elements[index as usize];
    #[cfg(all(target_arch = "spirv", not(feature = "bounds-checks")))]
    // SAFETY: see the module's passage on bounds.
    return unsafe { elements.index_unchecked(index as usize) };
}

/// Element `index` of a buffer, to be changed.
#[inline(always)]
pub fn at_mut<T>(elements: &mut [T], index: u32) -> &mut T {
    #[cfg(any(not(target_arch = "spirv"), feature = "bounds-checks"))]
    return &mut elements[index as usize];
    #[cfg(all(target_arch = "spirv", not(feature = "bounds-checks")))]
    // SAFETY: see the module's passage on bounds.
    return unsafe { elements.index_unchecked_mut(index as usize) };
}

/// An array of a lane's own, of which it reads nothing that it has not written. On the GPU it is
/// not cleared, which for a traversal's stack would be as much work as some rays are.
#[inline(always)]
pub fn scratch<T: Copy + Default, const N: usize>() -> [T; N] {
    #[cfg(not(target_arch = "spirv"))]
    return [T::default(); N];
    #[cfg(target_arch = "spirv")]
    // SAFETY: SPIR-V's undefined values are values, and nobody looks at them.
    #[allow(clippy::uninit_assumed_init)]
    return unsafe { core::mem::MaybeUninit::uninit().assume_init() };
}

/// Element `index` of an array of a lane's own or of its workgroup's.
#[inline(always)]
pub fn local<T: Copy, const N: usize>(elements: &[T; N], index: u32) -> T {
    #[cfg(any(not(target_arch = "spirv"), feature = "bounds-checks"))]
    return elements[index as usize];
    #[cfg(all(target_arch = "spirv", not(feature = "bounds-checks")))]
    // SAFETY: see the module's passage on bounds.
    return unsafe { *elements.index_unchecked(index as usize) };
}

/// Element `index` of such an array, to be changed.
#[inline(always)]
pub fn local_mut<T, const N: usize>(elements: &mut [T; N], index: u32) -> &mut T {
    #[cfg(any(not(target_arch = "spirv"), feature = "bounds-checks"))]
    return &mut elements[index as usize];
    #[cfg(all(target_arch = "spirv", not(feature = "bounds-checks")))]
    // SAFETY: see the module's passage on bounds.
    return unsafe { elements.index_unchecked_mut(index as usize) };
}

/// What can lie in a buffer: whole words without padding.
#[cfg(not(target_arch = "spirv"))]
pub trait Element: bytemuck::Pod {}
#[cfg(not(target_arch = "spirv"))]
impl<T: bytemuck::Pod> Element for T {}
/// What can lie in a buffer: whole words without padding.
#[cfg(target_arch = "spirv")]
pub trait Element: Copy {}
#[cfg(target_arch = "spirv")]
impl<T: Copy> Element for T {}

/// A buffer of which every element belongs to at most one lane of a launch, whichever that is.
#[cfg(not(target_arch = "spirv"))]
#[derive(Clone, Copy)]
pub struct Scatter<'a, T> {
    words: &'a [AtomicU32],
    element: PhantomData<T>,
}

#[cfg(not(target_arch = "spirv"))]
impl<'a, T: Element> Scatter<'a, T> {
    /// The elements in `words`.
    pub fn new(words: &'a [AtomicU32]) -> Self {
        Self { words, element: PhantomData }
    }

    /// Element `index`.
    pub fn get(&self, index: u32) -> T {
        let mut value = T::zeroed();
        for (word, cell) in bytemuck::cast_slice_mut(core::slice::from_mut(&mut value))
            .iter_mut()
            .zip(self.cells(index))
        {
            *word = cell.load(Relaxed);
        }
        value
    }

    /// Replaces element `index`.
    pub fn set(&mut self, index: u32, value: T) {
        let words: &[u32] = bytemuck::cast_slice(core::slice::from_ref(&value));
        for (word, cell) in words.iter().zip(self.cells(index)) {
            cell.store(*word, Relaxed);
        }
    }

    fn cells(&self, index: u32) -> &'a [AtomicU32] {
        let count = size_of::<T>() / size_of::<u32>();
        &self.words[index as usize * count..][..count]
    }
}

/// A buffer of which every element belongs to at most one lane of a launch, whichever that is.
#[cfg(target_arch = "spirv")]
pub struct Scatter<'a, T> {
    elements: &'a mut [T],
}

#[cfg(target_arch = "spirv")]
impl<'a, T: Element> Scatter<'a, T> {
    /// The elements of a slice.
    pub fn new(elements: &'a mut [T]) -> Self {
        Self { elements }
    }

    /// Element `index`.
    pub fn get(&self, index: u32) -> T {
        at(self.elements, index)
    }

    /// Replaces element `index`.
    pub fn set(&mut self, index: u32, value: T) {
        *at_mut(self.elements, index) = value;
    }
}

/// Words that any lane may change at any time, each change whole.
#[cfg(not(target_arch = "spirv"))]
#[derive(Clone, Copy)]
pub struct Atomics<'a> {
    words: &'a [AtomicU32],
}

#[cfg(not(target_arch = "spirv"))]
impl<'a> Atomics<'a> {
    /// The words of a slice.
    pub fn new(words: &'a [AtomicU32]) -> Self {
        Self { words }
    }

    /// Adds to a word, modulo 2^32; what was there before.
    pub fn add(&mut self, index: u32, value: u32) -> u32 {
        self.words[index as usize].fetch_add(value, Relaxed)
    }

    /// The word `index`, which no other lane of the launch changes.
    pub fn get(&self, index: u32) -> u32 {
        self.words[index as usize].load(Relaxed)
    }

    /// Replaces the word `index`, which no other lane of the launch looks at.
    pub fn set(&mut self, index: u32, value: u32) {
        self.words[index as usize].store(value, Relaxed);
    }
}

/// Words that any lane may change at any time, each change whole.
#[cfg(target_arch = "spirv")]
pub struct Atomics<'a> {
    words: &'a mut [u32],
}

#[cfg(target_arch = "spirv")]
mod atomics {
    use super::{Atomics, at, at_mut};
    use spirv_std::arch::atomic_i_add;
    use spirv_std::memory::{Scope, Semantics};

    const SCOPE: u32 = Scope::Device as u32;
    const RELAXED: u32 = Semantics::NONE.bits();

    impl<'a> Atomics<'a> {
        /// The words of a slice.
        pub fn new(words: &'a mut [u32]) -> Self {
            Self { words }
        }

        /// Adds to a word, modulo 2^32; what was there before.
        pub fn add(&mut self, index: u32, value: u32) -> u32 {
            unsafe { atomic_i_add::<u32, SCOPE, RELAXED>(at_mut(self.words, index), value) }
        }

        /// The word `index`, which no other lane of the launch changes.
        pub fn get(&self, index: u32) -> u32 {
            at(self.words, index)
        }

        /// Replaces the word `index`, which no other lane of the launch looks at.
        pub fn set(&mut self, index: u32, value: u32) {
            *at_mut(self.words, index) = value;
        }
    }
}
