//! The network: two hidden layers, fully connected, in which a tenth is left of what is below 0.

use crate::glam::Vec4;
use crate::memory::access::{at, local, local_mut, scratch};

/// Numbers that describe a pixel.
pub const INPUTS: usize = 20;
/// Numbers of a hidden layer.
pub const HIDDEN: usize = 24;
/// Numbers that the network makes.
pub const OUTPUTS: usize = 8;

/// Where the weights of the second layer, and of the third, begin.
pub const SECOND: u32 = rows(INPUTS, HIDDEN);
/// See [`SECOND`].
pub const THIRD: u32 = SECOND + rows(HIDDEN, HIDDEN);
/// Rows of all weights.
pub const ROWS: u32 = THIRD + rows(HIDDEN, OUTPUTS);

/// What is left of a number below 0.
pub const LEAK: f32 = 0.1;

/// Rows of a layer's weights. Four outputs take one for what they are without inputs, and one for
/// each input.
const fn rows(inputs: usize, outputs: usize) -> u32 {
    (outputs / 4 * (inputs + 1)) as u32
}

/// What the network makes of a pixel's description.
pub fn evaluate(weights: &[Vec4], inputs: &[f32; INPUTS]) -> [Vec4; 2] {
    let (mut first, mut second) = (scratch::<f32, HIDDEN>(), scratch::<f32, HIDDEN>());
    hidden(weights, 0, inputs, &mut first);
    hidden(weights, SECOND, &first, &mut second);
    [group(weights, THIRD, &second, 0), group(weights, THIRD, &second, 1)]
}

/// A hidden layer whose weights begin at a row.
pub fn hidden<const I: usize>(
    weights: &[Vec4],
    start: u32,
    inputs: &[f32; I],
    outputs: &mut [f32; HIDDEN],
) {
    let mut four = 0;
    while four < (HIDDEN / 4) as u32 {
        let sum = group(weights, start, inputs, four);
        let sum = sum.max(sum * LEAK);
        *local_mut(outputs, 4 * four) = sum.x;
        *local_mut(outputs, 4 * four + 1) = sum.y;
        *local_mut(outputs, 4 * four + 2) = sum.z;
        *local_mut(outputs, 4 * four + 3) = sum.w;
        four += 1;
    }
}

/// Four outputs of a layer whose weights begin at a row.
pub fn group<const I: usize>(weights: &[Vec4], start: u32, inputs: &[f32; I], four: u32) -> Vec4 {
    let row = start + four * (I as u32 + 1);
    let mut sum = at(weights, row);
    let mut input = 0;
    while input < I as u32 {
        sum += at(weights, row + 1 + input) * local(inputs, input);
        input += 1;
    }
    sum
}
