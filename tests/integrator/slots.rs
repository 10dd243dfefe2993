//! Slot for slot.

use super::tracing::{Case, OTHERS, cases, integrator};
use raystream::exec::cpu::CpuExecutor;
use raystream::render::IntegratorKind::{self, Compaction, Streaming};
use raystream::render::Settings;
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::NO_PIXEL;

fn assert_same_bytes(found: &[Contribution], expected: &[Contribution], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let differs =
        |(a, b): (&Contribution, &Contribution)| bytemuck::bytes_of(a) != bytemuck::bytes_of(b);
    let wrong: Vec<_> = (0..found.len()).filter(|&k| differs((&found[k], &expected[k]))).collect();
    if let Some(&first) = wrong.first() {
        let (found, expected) = (found[first], expected[first]);
        panic!(
            "{what}: {} slots differ, first {first}: {found:?} is not {expected:?}",
            wrong.len()
        );
    }
}

/// Streams shorter than the pool, as long, longer by a multiple and by any number; pools of a lane,
/// of parts of a workgroup, beyond a block.
const POOLS: [u32; 7] = [1, 63, 100, 300, 600, 1199, SLOTS];
const SLOTS: u32 = 1200;

#[test]
fn contributions_are_the_megakernels_on_the_cpu() {
    for case in cases(SLOTS) {
        let expected = case.megakernel(&CpuExecutor, case.all());
        assert!(
            expected.iter().any(|c| c.radiance.max_element() > 0.0),
            "{}: there is light",
            case.name
        );
        for (slot, contribution) in case.slots.iter().zip(&expected) {
            assert_eq!(
                *contribution == Contribution::NOTHING,
                slot.rank == NO_PIXEL,
                "{}: empty slots",
                case.name
            );
        }
        for kind in OTHERS {
            for pool in POOLS {
                // One lane takes thousands of iterations: once is enough.
                if pool == 1 && (kind != Streaming || case.settings.max_depth > 2) {
                    continue;
                }
                let what = format!("{kind:?}, pool of {pool}, {}", case.name);
                let integrator = integrator(&CpuExecutor, kind, SLOTS, pool);
                assert_same_bytes(
                    &case.trace(&CpuExecutor, integrator.as_ref(), case.all()).0,
                    &expected,
                    &what,
                );
            }
        }
    }
}

/// A renderer traces a stream in parts; an integrator is used again and again, and what it left
/// behind must not matter.
#[test]
fn parts_of_a_stream_are_traced_alone() {
    let case = Case::new(
        "a room",
        raystream_tests::scenes::room(raystream_tests::scenes::glass(1.5), 1.0),
        2000,
    )
    .scrambled();
    let expected = case.megakernel(&CpuExecutor, case.all());
    for kind in OTHERS {
        let integrator = integrator(&CpuExecutor, kind, 2000, 300);
        for part in [0..2000, 64..65, 1984..2000, 192..1111, 0..299, 320..620, 0..301, 64..2000] {
            let what = format!("{kind:?}, {part:?}");
            let range = part.start as usize..part.end as usize;
            let found = case.trace(&CpuExecutor, integrator.as_ref(), part).0;
            assert_same_bytes(&found, &expected[range], &what);
        }
    }
}

/// The tests above can fail: another slot's contribution, another seed's and another depth's are
/// other bytes.
#[test]
fn other_paths_are_other_bytes() {
    let case = cases(300).swap_remove(0);
    let expected = case.megakernel(&CpuExecutor, case.all());
    let changes: [fn(&mut Settings); 3] =
        [|s| s.seed = 2, |s| s.max_depth = 3, |s| s.roulette_depth = 1];
    for change in changes {
        let case = cases(300).swap_remove(0);
        let other = case.with(change);
        let integrator = integrator(&CpuExecutor, Streaming, 300, 300);
        let found = other.trace(&CpuExecutor, integrator.as_ref(), other.all()).0;
        let same = found.iter().zip(&expected).filter(|(a, b)| a == b).count();
        assert!(same < 250, "{}: {same} of 300 alike", other.name);
    }
}

/// Paths per iteration: all at first, never more than the pool, each as often as it has segments,
/// none at the end.
#[test]
fn pools_are_full_until_the_stream_ends() {
    let case = Case::new(
        "a room",
        raystream_tests::scenes::room(raystream_tests::scenes::mirror(0.9), 1.0),
        1000,
    );
    let active = |kind: IntegratorKind, pool| {
        case.trace(&CpuExecutor, integrator(&CpuExecutor, kind, 1000, pool).as_ref(), case.all()).1
    };
    let all_at_once = active(Compaction, 1000);
    assert_eq!(all_at_once.len() as u32, case.settings.max_depth);
    assert_eq!(all_at_once[0], 1000);
    assert!(all_at_once.is_sorted_by(|a, b| a >= b), "{all_at_once:?}");
    let segments: u32 = all_at_once.iter().sum();
    let compaction = active(Compaction, 300);
    assert_eq!(compaction.iter().sum::<u32>(), segments);
    assert_eq!([0, 8, 16, 24].map(|first| compaction[first]), [300, 300, 300, 100]);
    let streaming = active(Streaming, 300);
    assert_eq!(streaming.iter().sum::<u32>(), segments);
    let full = streaming.iter().take_while(|&&paths| paths == 300).count() as u32;
    assert!(full >= (segments - 8 * 300) / 300, "{streaming:?}");
    let tail = &streaming[full as usize..];
    assert!(
        tail.is_sorted_by(|a, b| a >= b) && tail.iter().all(|&paths| paths < 300),
        "{streaming:?}"
    );
    assert!(tail.iter().filter(|&&paths| paths > 0).count() <= 8, "{streaming:?}");
    assert!(active(IntegratorKind::Megakernel, 300).is_empty());
}
