//! Buffers that lanes write at places of their choice.
//!
//! A kernel's `write` bindings hand each lane the element of its own number. Where a lane must choose (compaction, streams), it is given a
//! [`Scatter`], whose user answers for what the type cannot show: that no two lanes of a launch touch the same element, unless all
//! only read it. [`Atomics`] may be hit by many lanes at once.
//!
//! On the GPU both are plain slices. On the CPU they are atomics with relaxed order, so that lanes may run on any
//! thread and a mistake would be a wrong number, not undefined behaviour.

#[cfg(not(target_arch = "spirv"))]
use core::{
    marker::PhantomData,
    sync::atomic::{AtomicU32, Ordering::Relaxed},
};

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
        for (word, cell) in
            bytemuck::cast_slice_mut(core::slice::from_mut(&mut value)).iter_mut().zip(self.cells(index))
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
        self.elements[index as usize]
    }

    /// Replaces element `index`.
    pub fn set(&mut self, index: u32, value: T) {
        self.elements[index as usize] = value;
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

    /// The word `index`, as it is at some time during the call.
    pub fn load(&self, index: u32) -> u32 {
        self.words[index as usize].load(Relaxed)
    }

    /// Replaces a word by `new` if it is `expected`; what was there before.
    pub fn replace(&mut self, index: u32, expected: u32, new: u32) -> u32 {
        match self.words[index as usize].compare_exchange(expected, new, Relaxed, Relaxed) {
            Ok(before) | Err(before) => before,
        }
    }
}

/// Words that any lane may change at any time, each change whole.
#[cfg(target_arch = "spirv")]
pub struct Atomics<'a> {
    words: &'a mut [u32],
}

#[cfg(target_arch = "spirv")]
mod atomics {
    use super::Atomics;
    use spirv_std::arch::{atomic_compare_exchange, atomic_i_add, atomic_load};
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
            unsafe { atomic_i_add::<u32, SCOPE, RELAXED>(&mut self.words[index as usize], value) }
        }

        /// The word `index`, as it is at some time during the call.
        pub fn load(&self, index: u32) -> u32 {
            unsafe { atomic_load::<u32, SCOPE, RELAXED>(&self.words[index as usize]) }
        }

        /// Replaces a word by `new` if it is `expected`; what was there before.
        pub fn replace(&mut self, index: u32, expected: u32, new: u32) -> u32 {
            unsafe {
                atomic_compare_exchange::<u32, SCOPE, RELAXED, RELAXED>(&mut self.words[index as usize], new, expected)
            }
        }
    }
}

impl Atomics<'_> {
    /// Adds to a word that holds an `f32`. Vulkan has no such atomic without extensions: it tries until no other lane came between.
    pub fn add_float(&mut self, index: u32, value: f32) {
        let mut seen = self.load(index);
        loop {
            let before = self.replace(index, seen, (f32::from_bits(seen) + value).to_bits());
            if before == seen {
                return;
            }
            seen = before;
        }
    }
}
