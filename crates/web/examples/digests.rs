//! Prints what the CPU's kernels compute in small renders, as the page's question `digests` is
//! answered: to be compared with a browser's answer. Its argument is the name of a scene that
//! ships.

use raystream_web::studio::Studio;
use raystream_web::webgpu::NoGpu;

fn main() {
    let scene = std::env::args().nth(1).unwrap_or_else(|| "cornell_ball".to_owned());
    let question = serde_json::json!({ "ask": "digests", "scene": scene });
    println!("{}", Studio::new(None::<NoGpu>).answer(&question.to_string()));
}
