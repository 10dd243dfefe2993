//! Tasks and answers as bytes.
//!
//! A message is a list of words, the first of which says what it is. What is long is made shorter
//! where that is cheap: slots are sent as runs, since those of a pixel are numbered one after the
//! other, and of sums the words that are 0 are left out, which most of their high ones are.

use super::member::{Answer, Task};
use super::{FilmTransfer, Peer};
use crate::render::allocator::Stream;
use rayon::prelude::*;
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::Slot;
use raystream_shaders::film::sums::{PIXEL_WORDS, PixelSums};

/// The first words of messages.
const BEGIN_ROUND: u32 = 1;
const SAMPLE: u32 = 2;
const TRACE: u32 = 3;
const TAKE_SUMS: u32 = 4;
const END: u32 = 5;
const DONE: u32 = 6;
const TRACED: u32 = 7;
const SUMS: u32 = 8;
const FAILED: u32 = 9;
const GIVE_FILM: u32 = 10;
const TAKE_FILM: u32 = 11;
const ADD_SUMS: u32 = 12;

/// What a worker's process is told.
pub(super) enum Order {
    /// Something to do.
    Do(Task),
    /// That nothing more will come.
    End,
}

/// What a worker's process says: what came of a task, or why nothing did.
pub(super) type Report = Result<Answer, String>;

/// An order as bytes.
pub(super) fn write_order(order: &Order) -> Vec<u8> {
    let words = match order {
        Order::Do(Task::BeginRound(number)) => vec![BEGIN_ROUND, *number],
        Order::Do(Task::Sample(Stream { pixels, uniform, first_sample, slots })) => {
            vec![SAMPLE, pixels.start, pixels.end, *uniform, *first_sample, *slots]
        }
        Order::Do(Task::Trace(slots)) => {
            let mut words = vec![TRACE, slots.len() as u32];
            words.extend(runs(slots).flat_map(|(first, count)| [first.rank, first.sample, count]));
            words
        }
        Order::Do(Task::TakeSums(ranks)) => vec![TAKE_SUMS, ranks.start, ranks.end],
        Order::Do(Task::AddSums(first, sums)) => {
            let mut words = vec![ADD_SUMS, *first];
            words.extend(
                write_sums(sums).as_chunks().0.iter().map(|&word| u32::from_ne_bytes(word)),
            );
            words
        }
        Order::Do(Task::GiveFilm(to, FilmTransfer { pixels, number })) => {
            vec![GIVE_FILM, to.process, to.worker, *pixels, *number]
        }
        Order::Do(Task::TakeFilm(from, FilmTransfer { pixels, number })) => {
            vec![TAKE_FILM, from.process, from.worker, *pixels, *number]
        }
        Order::End => vec![END],
    };
    bytemuck::cast_slice(&words).to_vec()
}

/// The order that is in `bytes`, if it is one.
pub(super) fn read_order(bytes: &[u8]) -> Option<Order> {
    let words: Vec<u32> = words(bytes)?;
    let (&kind, rest) = words.split_first()?;
    let task = match (kind, rest) {
        (BEGIN_ROUND, &[number]) => Task::BeginRound(number),
        (SAMPLE, &[start, end, uniform, first_sample, slots]) => {
            let stream = Stream { pixels: start..end, uniform, first_sample, slots };
            let pixels = end.checked_sub(start)?;
            let is_uniform = pixels.checked_mul(uniform) == Some(slots);
            is_uniform.then_some(Task::Sample(stream))?
        }
        (TRACE, [count, runs @ ..]) => Task::Trace(slots(*count as usize, runs)?),
        (TAKE_SUMS, &[start, end]) => (start <= end).then_some(Task::TakeSums(start..end))?,
        (ADD_SUMS, [first, sums @ ..]) => {
            Task::AddSums(*first, read_sums(bytemuck::cast_slice(sums))?)
        }
        (GIVE_FILM, &[process, worker, pixels, number]) => {
            Task::GiveFilm(Peer { process, worker }, FilmTransfer { pixels, number })
        }
        (TAKE_FILM, &[process, worker, pixels, number]) => {
            Task::TakeFilm(Peer { process, worker }, FilmTransfer { pixels, number })
        }
        (END, []) => return Some(Order::End),
        _ => return None,
    };
    Some(Order::Do(task))
}

/// A report as bytes.
pub(super) fn write_report(report: &Report) -> Vec<u8> {
    let (kind, rest) = match report {
        Ok(Answer::Done) => (DONE, Vec::new()),
        Ok(Answer::Traced(contributions)) => (TRACED, bytemuck::cast_slice(contributions).to_vec()),
        Ok(Answer::Sums(sums)) => (SUMS, write_sums(sums)),
        Err(reason) => (FAILED, reason.as_bytes().to_vec()),
    };
    let mut bytes = kind.to_ne_bytes().to_vec();
    bytes.extend(rest);
    bytes
}

/// The report that is in `bytes`, if it is one.
pub(super) fn read_report(bytes: &[u8]) -> Option<Report> {
    let (kind, rest) = bytes.split_first_chunk()?;
    Some(match u32::from_ne_bytes(*kind) {
        DONE if rest.is_empty() => Ok(Answer::Done),
        TRACED => Ok(Answer::Traced(words::<Contribution>(rest)?)),
        SUMS => Ok(Answer::Sums(read_sums(rest)?)),
        FAILED => Err(String::from_utf8_lossy(rest).into_owned()),
        _ => return None,
    })
}

/// What is in bytes that need not be aligned.
fn words<T: bytemuck::Pod>(bytes: &[u8]) -> Option<Vec<T>> {
    let mut words = vec![T::zeroed(); bytes.len() / size_of::<T>()];
    let target: &mut [u8] = bytemuck::cast_slice_mut(&mut words);
    (target.len() == bytes.len()).then(|| target.copy_from_slice(bytes))?;
    Some(words)
}

/// Slots that are numbered one after the other: the first of each run, and how many there are.
fn runs(slots: &[Slot]) -> impl Iterator<Item = (Slot, u32)> {
    let follows = |a: &Slot, b: &Slot| a.rank == b.rank && a.sample.wrapping_add(1) == b.sample;
    slots.chunk_by(follows).map(|run| (run[0], run.len() as u32))
}

/// The `count` slots of runs.
fn slots(count: usize, runs: &[u32]) -> Option<Vec<Slot>> {
    let (runs, rest) = runs.as_chunks::<3>();
    let all: u64 = runs.iter().map(|run| u64::from(run[2])).sum();
    if !rest.is_empty() || all != count as u64 {
        return None;
    }
    let mut slots = Vec::with_capacity(count);
    for &[rank, first, length] in runs {
        let samples = (0..length).map(|index| first.wrapping_add(index));
        slots.extend(samples.map(|sample| Slot { rank, sample }));
    }
    Some(slots)
}

/// Pixels that are packed at once.
const CHUNK: usize = 1 << 12;

/// Sums as their number, the length of each chunk, and the chunks: of each pixel which words are
/// not 0, a bit each, and these words.
fn write_sums(sums: &[PixelSums]) -> Vec<u8> {
    let chunks: Vec<Vec<u8>> = sums.par_chunks(CHUNK).map(write_chunk).collect();
    let mut bytes = (sums.len() as u32).to_ne_bytes().to_vec();
    bytes.extend(chunks.iter().flat_map(|chunk| (chunk.len() as u32).to_ne_bytes()));
    chunks.iter().for_each(|chunk| bytes.extend(chunk));
    bytes
}

fn write_chunk(sums: &[PixelSums]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(size_of_val(sums) / 2);
    for pixel in sums {
        let words: &[u32] = bytemuck::cast_slice(std::slice::from_ref(pixel));
        let bit = |index: usize| u64::from(words[index] != 0) << index;
        let mask: u64 = (0..words.len()).map(bit).sum();
        bytes.extend_from_slice(&mask.to_ne_bytes()[..]);
        for word in words.iter().filter(|&&word| word != 0) {
            bytes.extend_from_slice(&word.to_ne_bytes());
        }
    }
    bytes
}

fn read_sums(bytes: &[u8]) -> Option<Vec<PixelSums>> {
    let (count, mut rest) = bytes.split_first_chunk()?;
    let count = u32::from_ne_bytes(*count) as usize;
    let chunks = count.div_ceil(CHUNK);
    let lengths: Vec<u32> = words(rest.split_off(..chunks * size_of::<u32>())?)?;
    let parts: Option<Vec<&[u8]>> =
        lengths.iter().map(|&length| rest.split_off(..length as usize)).collect();
    let mut sums = vec![PixelSums::default(); count];
    let pairs = sums.par_chunks_mut(CHUNK).zip(parts?);
    let are_whole = pairs.map(|(sums, bytes)| read_chunk(sums, bytes).is_some()).all(|whole| whole);
    (are_whole && rest.is_empty()).then_some(sums)
}

/// Fills `sums`, which are 0, from the bytes of their chunk.
fn read_chunk(sums: &mut [PixelSums], mut bytes: &[u8]) -> Option<()> {
    for pixel in sums {
        let words: &mut [u32] = bytemuck::cast_slice_mut(std::slice::from_mut(pixel));
        let (mask, rest) = bytes.split_first_chunk()?;
        let mut mask = u64::from_ne_bytes(*mask);
        bytes = rest;
        while mask != 0 {
            let (word, rest) = bytes.split_first_chunk()?;
            *words.get_mut(mask.trailing_zeros() as usize)? = u32::from_ne_bytes(*word);
            bytes = rest;
            mask &= mask - 1;
        }
    }
    bytes.is_empty().then_some(())
}

const _: () = assert!(PIXEL_WORDS <= u64::BITS, "a bit for each word of a pixel");

#[cfg(test)]
mod tests {
    use super::*;
    use raystream_shaders::math::random::hash;

    fn sent_order(task: Task) -> Option<Task> {
        match read_order(&write_order(&Order::Do(task)))? {
            Order::Do(task) => Some(task),
            Order::End => None,
        }
    }

    #[test]
    fn slots_are_sent_as_runs() {
        let slot = |rank, sample| Slot { rank, sample };
        let mut slots: Vec<Slot> = (5..25).map(|sample| slot(7, sample)).collect();
        // The second half begins anew, a stream of single slots has runs of one, and a slot may stay
        // empty.
        slots.extend((0..4).map(|sample| slot(7, sample | 1 << 31)));
        slots.extend((0..9).map(|rank| slot(rank, 3)));
        slots.extend([slot(u32::MAX, 0), slot(u32::MAX, 0), slot(8, u32::MAX), slot(8, 0)]);
        let order = write_order(&Order::Do(Task::Trace(slots.clone())));
        assert_eq!(order.len(), 4 * (2 + 3 * (2 + 9 + 3)), "three words a run");
        let Some(Task::Trace(sent)) = sent_order(Task::Trace(slots.clone())) else { panic!() };
        assert!(sent == slots);
        let Some(Task::Trace(sent)) = sent_order(Task::Trace(Vec::new())) else { panic!() };
        assert!(sent.is_empty());
    }

    #[test]
    fn windows_are_sent_whole() {
        let window = Stream { pixels: 64..128, uniform: 3, first_sample: 9, slots: 192 };
        let Some(Task::Sample(sent)) = sent_order(Task::Sample(window.clone())) else { panic!() };
        assert_eq!(sent, window);
        let Some(Task::TakeSums(sent)) = sent_order(Task::TakeSums(3..8)) else { panic!() };
        assert_eq!(sent, 3..8);
        assert!(matches!(read_order(&write_order(&Order::End)), Some(Order::End)));
    }

    /// Sums whose words are 0 or not by chance.
    fn sums(count: u32) -> Vec<PixelSums> {
        let word = |index: u32| if hash(index) & 3 == 0 { hash(index ^ 0x5555) } else { 0 };
        let words: Vec<u32> = (0..count * PIXEL_WORDS).map(word).collect();
        bytemuck::cast_slice(&words).to_vec()
    }

    #[test]
    fn sums_are_sent_without_their_zeros() {
        for count in [0, 1, CHUNK as u32, 2 * CHUNK as u32 + 17] {
            let sums = sums(count);
            let bytes = write_report(&Ok(Answer::Sums(sums.clone())));
            let Some(Ok(Answer::Sums(sent))) = read_report(&bytes) else { panic!("{count}") };
            assert!(sent == sums, "{count}");
            let Some(Task::AddSums(5, sent)) = sent_order(Task::AddSums(5, sums.clone())) else {
                panic!("{count}")
            };
            assert!(sent == sums, "{count}");
            assert!(count < 2 || bytes.len() < size_of_val(&sums[..]) / 2, "{}", bytes.len());
        }
    }

    #[test]
    fn failures_are_sent_in_words() {
        let bytes = write_report(&Err("no room".to_owned()));
        assert!(matches!(read_report(&bytes), Some(Err(reason)) if reason == "no room"));
    }

    /// What is cut off, or of other lengths than it says, is no message.
    #[test]
    fn damaged_messages_are_refused() {
        let slots = vec![Slot { rank: 1, sample: 2 }; 3];
        let give =
            Task::GiveFilm(Peer { process: 1, worker: 2 }, FilmTransfer { pixels: 3, number: 4 });
        for task in [Task::BeginRound(1), Task::Trace(slots), Task::TakeSums(1..2), give] {
            let bytes = write_order(&Order::Do(task));
            for length in 0..bytes.len() {
                assert!(read_order(&bytes[..length]).is_none(), "{length} of {}", bytes.len());
            }
            assert!(read_order(&[&bytes[..], &[0; 4]].concat()).is_none());
        }
        let backwards = [TAKE_SUMS, 2, 1].map(u32::to_ne_bytes).concat();
        let other_length = [SAMPLE, 0, 64, 2, 0, 127].map(u32::to_ne_bytes).concat();
        for bytes in [backwards, other_length] {
            assert!(read_order(&bytes).is_none());
        }
        let bytes = write_order(&Order::Do(Task::AddSums(0, sums(2))));
        assert!((0..bytes.len()).all(|length| read_order(&bytes[..length]).is_none()));
        let bytes = write_report(&Ok(Answer::Sums(sums(2))));
        for length in 0..bytes.len() {
            assert!(read_report(&bytes[..length]).is_none(), "{length} of {}", bytes.len());
        }
        assert!(read_report(&[&bytes[..], &[0; 4]].concat()).is_none());
        let foreign_bit = [&SUMS.to_ne_bytes()[..], &[1, 0, 0, 0, 12, 0, 0, 0], &[0xff; 12]];
        assert!(read_report(&foreign_bit.concat()).is_none());
    }
}
