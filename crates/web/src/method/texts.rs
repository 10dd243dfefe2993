//! What a reader is told of each stage.

use super::Choice;
use raystream::render::{AllocatorKind, Estimator};

/// Of the film before the round.
pub fn film_before(round: u32) -> String {
    if round == 1 {
        return "Nothing has been measured yet, so the film is black. Nobody can say where samples \
                are needed: the first round gives every pixel alike, and later ones look at errors."
            .to_owned();
    }
    "The film has the sum of all samples of each pixel and their number; the picture is their \
     mean. Samples are random, so it is noisy, and noisier in some places than in others. The \
     round is to find these places and to sample them."
        .to_owned()
}

/// Of the guides.
pub fn guides(estimator: Estimator) -> String {
    let use_of_it = match estimator {
        Estimator::Bilateral => {
            "The filter that follows mixes pixels of like surfaces only, so that edges stay."
        }
        Estimator::AxisAligned => {
            "How far light must come past what throws shadows is known from rays of the features."
        }
        Estimator::Halves | Estimator::Variance => {
            "This estimator looks at the last of these pictures alone."
        }
        _ => "The filter that follows tells by them which pixels are alike.",
    };
    format!(
        "A guide is what an estimator sees of a pixel: its colour and the deviation of that, and \
         what the camera sees there without light: reflectance, normal and position of the first \
         surface, which settle long before the light does. {use_of_it}"
    )
}

/// Of the filtered picture.
pub fn filtered(estimator: Estimator) -> String {
    match estimator {
        Estimator::Bilateral => {
            "A joint bilateral filter takes for each pixel a mean over its neighbours, those that \
             look alike in the guides. What comes out is smoother than the film and serves as a \
             guess of the true picture. It need not be right: nothing of it gets into the film."
        }
        Estimator::Halves => {
            "This estimator filters nothing: its picture is the film's own. It compares the means \
             of two independent halves of the samples."
        }
        Estimator::Variance => {
            "This estimator filters nothing: its picture is the film's own. It goes by how far \
             apart the samples of a pixel are."
        }
        Estimator::AxisAligned => {
            "This estimator filters nothing: its picture is the film's own. It says from the \
             distances of what throws light or shadow how many samples a pixel deserves."
        }
        _ => {
            "One of the filters that also clean pictures says what each pixel would be without its \
             noise. It need not be right: nothing of it gets into the film."
        }
    }
    .to_owned()
}

/// Of the errors.
pub fn errors(choice: &Choice) -> String {
    let squared = match choice.estimator {
        Estimator::Halves => "the squared difference of the two halves' means",
        Estimator::Variance => "the variance of the pixel's mean",
        Estimator::AxisAligned => "a rate that follows from the distances of occluders",
        _ => "the squared difference of the film from the filtered picture",
    };
    let form = match choice.allocator {
        AllocatorKind::Runs => {
            "The allocator wants it as the deviation of one sample, by the root of its rays: \
             counts in proportion to that leave the least error that so many rays can."
        }
        _ => {
            "The allocator wants of it the part that the round would take away if the pixel got \
             its average share."
        }
    };
    let relative = if choice.relative {
        "It is relative to the pixel's brightness: dark places count as much as bright ones."
    } else {
        "It is absolute: an error in a bright place counts more."
    };
    format!(
        "What a pixel's error is taken to be: {squared}. {form} {relative} From here on all is \
         integers, which come out the same on every device."
    )
}

/// Of the weights.
pub fn weights(allocator: AllocatorKind) -> String {
    match allocator {
        AllocatorKind::Runs => {
            "There is a number of samples that each pixel deserves by its error, times a level \
             that is the same for all. A pixel's weight is what it lacks of that. The level is \
             raised until what all pixels lack is the budget; pixels that have had enough get \
             nothing."
        }
        _ => "A pixel's weight is its error, in proportion to the sum of all errors.",
    }
    .to_owned()
}

/// Of the runs.
pub const RUNS: &str = "The slots of a pixel follow each other: they are its run. The sum of the \
    weights of all pixels before it, scaled to the budget, says where a run begins. So runs leave \
    no gaps, their lengths add up to the budget exactly, and all is one prefix sum. A random phase \
    decides whether a pixel that is due 2.3 samples gets 2 or 3.";

/// Of the allocator's streams.
pub const STREAMS: &str = "The round is made of streams. Into each go the pixels whose error \
    exceeds a random threshold of their own, close together by stream compaction, one slot each: \
    so a pixel is in as many streams as its error makes likely. The range of the thresholds is \
    found by bisection: a stream that is too long is dropped, one that fits is kept, until the \
    budget is spent.";

/// Of the slots.
pub fn slots(allocator: AllocatorKind, is_adaptive: bool) -> String {
    let begin = "A slot is an order for one sample: which pixel, and which of the pixel's samples. \
                 All slots of the round are one stream, in which neighbours are neighbours in the \
                 picture, so that lanes that trace side by side read the same memory.";
    if !is_adaptive {
        return format!("{begin} In this round nobody looks at errors: all pixels get alike.");
    }
    let rest = match allocator {
        AllocatorKind::Runs => {
            "A part of the budget goes to every pixel alike, now and then: it bounds what a wrong \
             error can do, and its mean is right whatever the errors were."
        }
        AllocatorKind::Paper => "Within each of the streams that order holds.",
        AllocatorKind::Atomic => {
            "Pixels reserve their slots by an atomic counter, so the order is that in which lanes \
             came, and it is another one each time."
        }
        AllocatorKind::Uniform => "All pixels get alike.",
    };
    format!("{begin} {rest}")
}

/// Of the contributions.
pub const CONTRIBUTIONS: &str = "For each slot a path is traced from the camera through its pixel, \
    from surface to surface, and what light it brings is the slot's contribution. This is the only \
    stage that knows of light, and nearly all of the time goes into it. The allocator does not \
    know how paths are traced, nor does what traces them know why these pixels were chosen.";

/// Of the film after the round.
pub const FILM_AFTER: &str = "Each contribution is added to the sums of its pixel. Sums are \
    integers of 128 bits, so it does not matter who adds what first: film before and contributions \
    give the film after to the last bit. The next round looks at this film.";
