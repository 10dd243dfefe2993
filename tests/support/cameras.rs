//! Cameras of all kinds.

use raystream::scene::{Camera, Lens, Projection, Scene};

/// Each kind of camera that is no pinhole, with its name, where `camera` is, a perspective one: in
/// focus at its target, and about as wide there.
pub fn others(camera: Camera) -> Vec<(&'static str, Camera)> {
    let Projection::Perspective { fov_y, .. } = camera.projection else { return Vec::new() };
    let distance = (camera.target - camera.origin).length();
    let lens = |share: f32, blades| {
        let lens = Lens { radius: share * distance, focus_distance: 0.7 * distance, blades };
        Projection::Perspective { fov_y, lens: Some(lens) }
    };
    let width = 2.0 * distance * (0.5 * fov_y).to_radians().tan();
    let with = |projection| Camera { projection, ..camera };
    vec![
        ("a round lens", with(lens(0.05, 0))),
        ("a lens of five blades", with(lens(0.1, 5))),
        ("parallel rays", with(Projection::Orthographic { width })),
        ("a panorama", with(Projection::Panorama)),
    ]
}

/// The scene as each of these cameras sees it.
pub fn seen_by_others(scene: &Scene) -> Vec<(&'static str, Scene)> {
    let seen = |(name, camera)| (name, Scene { camera, ..scene.clone() });
    others(scene.camera).into_iter().map(seen).collect()
}
